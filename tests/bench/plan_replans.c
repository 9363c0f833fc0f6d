#include "tests/bench/plan_replans.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"

enum {
    REPLANS = 10, /* a scene */
    AHEAD = 12,   /* primitives from the robot to the change */
    NEAR_CELLS = 15,
    UNDER_CELLS = 6, /* from the robot's middle to cells that it does not cover */
    SEED = 1,
};

/* In percent of a fresh search to the proved optimum. */
struct replan {
    double expansions;
    double time;
    double first_expansions; /* until there is a route again */
    double first_time;
};

/* The robot stands at the start of the planner, which has its route; then something changes. */
static struct replan replan_after_change(struct jp_planner *planner, const struct task *task,
                                         struct jp_lattice_pose place)
{
    static const struct jp_planner_config config = {&jp_lattice_zhang2018, JP_COST_PHYSICAL, {JP_EPSILON_ONE}};
    const uint32_t expanded = jp_planner_statistics(planner)->expansions;
    const double begin = now_s();

    toggle_square(planner, task->terrain, place);
    while (jp_planner_work(planner, SLICE) == JP_ANSWER_OUT_OF_BUDGET && !jp_planner_is_idle(planner)) {
    }
    const double first_s = now_s() - begin;
    const uint32_t first = jp_planner_statistics(planner)->expansions - expanded;
    (void)work_until_idle(planner);
    const double repaired_s = now_s() - begin;
    const uint32_t repaired = jp_planner_statistics(planner)->expansions - expanded;
    const struct outcome fresh = plan(&config, task, FULL_KIB * KIB);

    if (fresh.plan.cost != jp_planner_plan(planner)->cost || fresh.answer != JP_ANSWER_OPTIMAL) {
        fail("a replan is not what a fresh search finds");
    }
    const double percent = 100 / (double)fresh.statistics.expansions;
    return (struct replan){percent * repaired, 100 * repaired_s / fresh.total_s, percent * first,
                           100 * first_s / fresh.total_s};
}

/* On the route, some primitives ahead of the robot. */
static struct jp_lattice_pose place_on_route(const struct jp_planner *planner, struct random *random)
{
    (void)random;
    return pose_after(planner, AHEAD);
}

/* Anywhere near the robot but under it. */
static struct jp_lattice_pose place_near(const struct jp_planner *planner, struct random *random)
{
    const struct jp_lattice_pose robot = jp_planner_plan(planner)->start;
    struct jp_lattice_pose place;
    double distance = 0;

    do {
        const double x = random_uniform(random, -NEAR_CELLS, NEAR_CELLS);
        const double y = random_uniform(random, -NEAR_CELLS, NEAR_CELLS);
        place = (struct jp_lattice_pose){(int16_t)(robot.x + x), (int16_t)(robot.y + y), 0};
        distance = hypot(x, y);
    } while (distance < UNDER_CELLS || distance > NEAR_CELLS);
    return place;
}

struct replans {
    double expansions[SCENE_BENCH_COUNT * REPLANS];
    double times[SCENE_BENCH_COUNT * REPLANS];
    double first_expansions[SCENE_BENCH_COUNT * REPLANS];
    double first_times[SCENE_BENCH_COUNT * REPLANS];
    size_t count;
};

/* The robot drives a step between changes, for as long as there is a route. */
static void replan_scene(const struct scene *scene, struct replans *replans, struct random *random,
                         struct jp_lattice_pose (*choose)(const struct jp_planner *, struct random *))
{
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    void *block = allocate(FULL_KIB * KIB);
    struct jp_planner planner;

    start_planner(&planner, &config, &scene->task, block, FULL_KIB * KIB);
    (void)work_until_idle(&planner);
    for (unsigned n = 0; n < REPLANS && jp_planner_plan(&planner)->step_count > AHEAD; n++) {
        const struct jp_lattice_pose robot = pose_after(&planner, 1);
        if (jp_planner_set_start(&planner, &robot) != JP_OK) {
            break;
        }
        (void)work_until_idle(&planner);
        const struct task task = {scene->task.name, scene->task.terrain, robot, scene->task.goal};
        const struct replan replan = replan_after_change(&planner, &task, choose(&planner, random));
        replans->expansions[replans->count] = replan.expansions;
        replans->times[replans->count] = replan.time;
        replans->first_expansions[replans->count] = replan.first_expansions;
        replans->first_times[replans->count++] = replan.first_time;
    }
    free(block);
}

static void add_figures(struct replans *replans, const char *what, bool has_bar, json_t *figures)
{
    figures_add(figures, COMMAND, median(replans->expansions, replans->count), "%", has_bar ? at_most(3) : no_bar,
                "planner, %s: expansions against a fresh search, median of %zu", what, replans->count);
    figures_add(figures, COMMAND, median(replans->times, replans->count), "%", has_bar ? at_most(5) : no_bar,
                "planner, %s: time against a fresh search, median", what);
    figures_add(figures, COMMAND, mean(replans->expansions, replans->count), "%", no_bar,
                "planner, %s: expansions against a fresh search, mean", what);
    figures_add(figures, COMMAND, median(replans->first_expansions, replans->count), "%", no_bar,
                "planner, %s: expansions until there is a route, median", what);
    figures_add(figures, COMMAND, median(replans->first_times, replans->count), "%", no_bar,
                "planner, %s: time until there is a route, median", what);
}

static void measure(struct scene *scenes, const char *what, bool has_bar,
                    struct jp_lattice_pose (*choose)(const struct jp_planner *, struct random *), json_t *figures)
{
    static struct replans replans;
    struct random random;

    replans.count = 0;
    random_init(&random, SEED);
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        free(scenes[i].block);
        make_scene(&scenes[i], SCENE_BENCH_FIRST + i);
        replan_scene(&scenes[i], &replans, &random, choose);
        progress_show(what, i + 1, SCENE_BENCH_COUNT);
    }
    progress_end();
    add_figures(&replans, what, has_bar, figures);
}

void plan_replans(struct scene *scenes, json_t *figures)
{
    measure(scenes, "replan after a change within 3 m of the robot", true, place_near, figures);
    measure(scenes, "replan after an obstacle appeared on the route", false, place_on_route, figures);
}
