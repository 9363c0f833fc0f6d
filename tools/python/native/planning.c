#include "tools/python/native/planning.h"

#include <math.h>
#include <stdlib.h>

#include "sim/base/error.h"
#include "sim/missions/plan_lattice.h"

static uint16_t level_of(double epsilon)
{
    const double units = rint(epsilon * JP_EPSILON_ONE);

    return units >= 0 && units <= UINT16_MAX ? (uint16_t)units : 0; /* which the planner refuses */
}

bool planning_begin(struct planning *planning, struct map_file *map, const struct jp_lattice *lattice,
                    enum jp_cost_kind cost, const double *epsilon, size_t levels, size_t memory)
{
    struct jp_planner_config config = {.lattice = lattice, .cost = cost};
    const size_t least = jp_planner_size(&map->terrain.config);
    const char *field = NULL;

    planning->map = map;
    planning->lattice = lattice;
    for (size_t i = 0; i < levels; i++) {
        config.epsilon[i] = level_of(epsilon[i]);
    }
    if (!plan_lattice_fits(map->name[0] == '\0' ? "map" : map->name, map, lattice)) {
        return false;
    }
    if (memory < least) {
        error_line("memory: %zu B are too little for this map; give at least %zu B", memory, least);
        return false;
    }
    planning->block = malloc(memory);
    if (planning->block == NULL) {
        error_line("memory: this computer has not %zu B; give less", memory);
        return false;
    }
    if (jp_planner_init(&planning->planner, &config, &map->terrain, planning->block, memory, &field) != JP_OK) {
        error_line("planner: %s is out of range", field != NULL ? field : "an argument");
        return false;
    }
    return true;
}

static bool accepts(const char *what, enum jp_status status)
{
    if (status != JP_OK) {
        error_line("%s: the robot does not fit there: obstacles or unknown ground; give another place", what);
    }
    return status == JP_OK;
}

static bool accepts_task(struct planning *planning)
{
    return accepts("start", jp_planner_set_start(&planning->planner, &planning->task.start)) &&
           accepts("goal", jp_planner_set_goal(&planning->planner, &planning->task.goal));
}

bool planning_set_task(struct planning *planning, const double start[3], const double *goal, size_t goal_count)
{
    const bool has_heading = goal_count == 3;
    const struct plan_place from = {start[0], start[1], start[2], true};
    const struct plan_place to = {goal[0], goal[1], has_heading ? goal[2] : 0, has_heading};

    return plan_task_set(planning->map, planning->lattice, &from, &to, &planning->task) && accepts_task(planning);
}

bool planning_choose_task(struct planning *planning)
{
    return plan_task_choose(planning->map, planning->lattice, &planning->task) && accepts_task(planning);
}

bool planning_work(struct planning *planning, unsigned expansions)
{
    planning->answer = jp_planner_work(&planning->planner, expansions);
    return jp_planner_is_idle(&planning->planner);
}

bool planning_read(const struct planning *planning, struct plan_route *route)
{
    if (!plan_route_read(&planning->planner, planning->lattice, &planning->map->terrain, &planning->task.start,
                         route)) {
        error_line("route: this computer has no memory for it");
        return false;
    }
    return true;
}

void planning_free(struct planning *planning)
{
    free(planning->block);
    planning->block = NULL;
}
