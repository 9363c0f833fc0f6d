#include "tests/bench/plan_peers.h"

#include <math.h>

#include "sim/base/progress.h"
#include "tests/bench/figures.h"
#include "tests/bench/igraph_peer.h"
#include "tests/bench/ompl_peer.h"
#include "tests/bench/plain_search.h"
#include "tests/bench/plan_runs.h"
#include "tests/bench/statistics.h"

enum { IGRAPH_SCENES = 3 }; /* its graph of a scene has some million edges */

static const char *const ompl_names[OMPL_PLANNERS] = {"RRT*", "BIT*"};

/* ---- Searches of the same graph ---- */

static void add_times(json_t *figures, const char *what, double *times, size_t count)
{
    figures_add(figures, COMMAND, median(times, count), "×", no_bar, "planner, %zu scenes: %s, median", count, what);
    figures_add(figures, COMMAND, least(times, count), "×", no_bar, "planner, %zu scenes: %s, least", count, what);
}

static void check_cost(const struct scene *scene, double cost)
{
    if (!(fabs(scene->optimum / cost - 1) <= ROUNDING_TOLERANCE)) {
        fail("a peer's optimum is not the planner's");
    }
}

static void beside_searches(const struct scene *scenes, json_t *figures)
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, SCHEDULE};
    double first[SCENE_BENCH_COUNT];
    double total[SCENE_BENCH_COUNT];
    double igraph[IGRAPH_SCENES];

    for (size_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        const struct task *task = &scenes[i].task;
        const struct outcome outcome = plan(&config, task, FULL_KIB * KIB);
        double begin = now_s();
        check_cost(&scenes[i], plain_astar(lattice, task->terrain, &task->start, &task->goal));
        first[i] = (now_s() - begin) / outcome.first_s;
        total[i] = (now_s() - begin) / outcome.total_s;
        if (i < IGRAPH_SCENES) {
            begin = now_s();
            check_cost(&scenes[i], igraph_cost(lattice, task->terrain, &task->start, &task->goal));
            igraph[i] = (now_s() - begin) / outcome.total_s;
        }
        progress_show("plain A*, igraph", i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    add_times(figures, "first route, times faster than a plain A*", first, SCENE_BENCH_COUNT);
    add_times(figures, "proved optimum, times faster than a plain A*", total, SCENE_BENCH_COUNT);
    add_times(figures, "proved optimum, times faster than igraph's Dijkstra and its graph", igraph, IGRAPH_SCENES);
}

/* ---- Shortest paths ---- */

struct shortest {
    double length; /* m */
    double seconds;
};

static struct shortest plan_shortest(const struct task *task)
{
    const struct jp_planner_config config = {lattice, JP_COST_DISTANCE, SCHEDULE};
    struct jp_planner planner;
    struct shortest shortest = {0};
    void *block = allocate(FULL_KIB * KIB);

    memset(block, 0, FULL_KIB * KIB);
    const double begin = now_s();
    start_planner(&planner, &config, task, block, FULL_KIB * KIB);
    (void)work_until_idle(&planner);
    shortest.seconds = now_s() - begin;
    struct jp_lattice_pose pose = jp_planner_plan(&planner)->start;
    for (unsigned i = 0; i < jp_planner_plan(&planner)->step_count; i++) {
        shortest.length += 1e-3 * jp_planner_step(&planner, i, &pose)->length;
    }
    free(block);
    return shortest;
}

static void add_length_figures(json_t *figures, const char *name, double *ratios, size_t count)
{
    figures_add(figures, COMMAND, (double)count, "", no_bar,
                "planner, 20 scenes by length: routes of OMPL's %s in the time of our proof", name);
    if (count > 0) {
        figures_add(figures, COMMAND, median(ratios, count), "×", no_bar,
                    "planner, 20 scenes by length: OMPL's %s in the time of our proof against us, median", name);
        figures_add(figures, COMMAND, least(ratios, count), "×", no_bar,
                    "planner, 20 scenes by length: OMPL's %s in the time of our proof against us, least", name);
    }
}

static void beside_ompl(const struct scene *scenes, json_t *figures)
{
    double ratios[OMPL_PLANNERS][SCENE_BENCH_COUNT];
    size_t counts[OMPL_PLANNERS] = {0};

    for (size_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        const struct task *task = &scenes[i].task;
        const struct shortest shortest = plan_shortest(task);
        for (unsigned peer = 0; peer < OMPL_PLANNERS; peer++) {
            const double length = ompl_length((enum ompl_planner)peer, lattice, task->terrain, &task->start,
                                              &task->goal, shortest.seconds);
            if (isfinite(length)) {
                ratios[peer][counts[peer]++] = length / shortest.length;
            }
        }
        progress_show("OMPL", i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    for (unsigned peer = 0; peer < OMPL_PLANNERS; peer++) {
        add_length_figures(figures, ompl_names[peer], ratios[peer], counts[peer]);
    }
}

void plan_peers(const struct scene *scenes, json_t *figures)
{
    beside_searches(scenes, figures);
    beside_ompl(scenes, figures);
}
