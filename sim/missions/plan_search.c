#include "sim/missions/plan_search.h"

#include <stdlib.h>
#include <time.h>

#include "sim/base/error.h"

/** Of the planner's block. */
#define ALIGNMENT 8

/** Expansions of one call of the planner. */
#define SLICE 1000

/** Of the processor, so that a machine's other work does not count. */
static double seconds_taken(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool begin(struct jp_planner *planner, struct map_file *map, const struct jp_lattice *lattice,
                  enum jp_cost_kind cost, void *block, size_t memory)
{
    const struct jp_planner_config config = {lattice, cost, {JP_EPSILON(2), JP_EPSILON_ONE}};
    const char *field;

    if (jp_planner_init(planner, &config, &map->terrain, block, memory, &field) == JP_OK) {
        return true;
    }
    const size_t least = jp_planner_size(&map->terrain.config);
    if (least == 0) {
        error_line("%s: more than %u cells; import a window of it", map->name, (unsigned)JP_PLANNER_CELLS_MAX);
    } else {
        error_line("--memory %zu: too little for %s; give at least %zu KiB", memory / 1024, map->name,
                   (least + 1023) / 1024);
    }
    return false;
}

static bool accept(const char *what, enum jp_status status, const struct map_file *map,
                   const struct jp_lattice *lattice)
{
    if (status != JP_OK) {
        error_line("%s: %s does not fit there on %s: obstacles or unknown ground; give another place", what,
                   lattice->name, map->name);
    }
    return status == JP_OK;
}

static void work(struct jp_planner *planner, struct plan_search *search)
{
    const double begun = seconds_taken();

    while (!jp_planner_is_idle(planner)) {
        search->answer = jp_planner_work(planner, SLICE);
    }
    search->planning_s = seconds_taken() - begun;
    search->plan = *jp_planner_plan(planner);
    search->statistics = *jp_planner_statistics(planner);
}

static bool run(struct jp_planner *planner, const struct map_file *map, const struct jp_lattice *lattice,
                const struct plan_task *task, struct plan_search *search)
{
    if (!accept("--start", jp_planner_set_start(planner, &task->start), map, lattice) ||
        !accept("--goal", jp_planner_set_goal(planner, &task->goal), map, lattice)) {
        return false;
    }
    work(planner, search);
    if (!plan_route_read(planner, lattice, &map->terrain, &task->start, &search->route)) {
        error_line("%s: no memory for the route", map->name);
        return false;
    }
    return true;
}

bool plan_search(struct map_file *map, const struct jp_lattice *lattice, enum jp_cost_kind cost,
                 const struct plan_task *task, size_t memory, struct plan_search *search)
{
    const double begun = seconds_taken();
    struct jp_planner planner;
    void *block = aligned_alloc(ALIGNMENT, memory);

    *search = (struct plan_search){.cost = cost};
    if (block == NULL) {
        error_line("--memory %zu: this computer has not that much; give less", memory / 1024);
        return false;
    }
    const bool done = begin(&planner, map, lattice, cost, block, memory) && run(&planner, map, lattice, task, search);

    search->whole_s = seconds_taken() - begun;
    free(block);
    return done;
}

bool plan_search_arrives(const struct plan_search *search)
{
    return search->answer == JP_ANSWER_OPTIMAL || search->answer == JP_ANSWER_WITHIN_BOUND;
}
