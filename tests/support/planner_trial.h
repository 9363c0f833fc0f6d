/** A random map, a task and a planner that are edited and compared with Dijkstra, for property tests of the planner. */
#ifndef JOULEPATH_TESTS_SUPPORT_PLANNER_TRIAL_H
#define JOULEPATH_TESTS_SUPPORT_PLANNER_TRIAL_H

#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/planner_oracle.h"
#include "tests/support/random.h"
#include "tests/support/toy_lattice.h"
#include "unity.h"

enum {
    SIDE_MIN = 12,
    SIDE_MAX = 32,
    EDITS_PER_MAP = 50,
    AMPLE_BYTES = 1 << 19, /* all states of the largest map, and the fields */
    ROUTE_MAX = 4096,
    WORK_MAX = 1 << 22, /* expansions after which a planner hangs */
    ROUGHNESS_MAX = 50, /* units of elevation between neighbours */
    UNREACHABLE_MAX_PERCENT = 40,
    TRIES = 400
};

/** A map, a lattice, a task and its planner. */
struct trial {
    struct toy_lattice toy;
    const struct jp_lattice *lattice;
    enum jp_cost_kind kind;
    struct jp_terrain terrain;
    struct jp_terrain_config config;
    uint64_t terrain_block[1024];
    struct oracle_map map;
    int blocked_percent; /* that the edits keep to, about */
    int blocked_count;
    int roughness;
    int door_x; /* a gap in a wall across the map; below 0: there is no wall */
    int door_y;
    int door_height;
    struct jp_lattice_pose start;
    struct jp_goal goal;
    struct jp_planner planner;
    _Alignas(8) uint8_t block[AMPLE_BYTES];
};

static struct trial trial;
static struct oracle oracle;
static char problem[200]; /* the first that was found */

/** Maps */

/** Cells of a map that is told of every change, or of a planner that hears of it. */
static inline void put_cell(struct trial *t, bool tell, int x, int y, enum jp_cell cell)
{
    const bool is_blocked = cell == JP_CELL_OCCUPIED || (cell == JP_CELL_UNKNOWN && !t->config.unknown_is_free);
    bool *entry = &t->map.is_blocked[oracle_cell(x, y)];

    TEST_ASSERT_EQUAL_INT(JP_OK, tell ? jp_planner_set_cell(&t->planner, x, y, cell)
                                      : jp_terrain_set_cell(&t->terrain, x, y, cell));
    t->blocked_count += is_blocked - *entry;
    *entry = is_blocked;
}

static inline void put_elevation(struct trial *t, bool tell, int x, int y, int elevation)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, tell ? jp_planner_set_elevation(&t->planner, x, y, (jp_elevation)elevation)
                                      : jp_terrain_set_elevation(&t->terrain, x, y, (jp_elevation)elevation));
    t->map.elevation[oracle_cell(x, y)] = elevation;
}

static inline bool has_wall(const struct trial *t)
{
    return t->door_x >= 0;
}

static inline void put_door(struct trial *t, bool tell, enum jp_cell cell)
{
    for (int y = t->door_y; y < t->door_y + t->door_height; y++) {
        put_cell(t, tell, t->door_x, y, cell);
    }
}

/** A wall from side to side, with a door that is open half of the time. */
static inline void put_wall(struct trial *t)
{
    t->door_x = t->config.width / 3 + (int)below(t->config.width / 3U);
    t->door_y = (int)below(t->config.height - 1U);
    t->door_height = 1 + (int)below((uint32_t)(t->config.height - t->door_y));
    for (int y = 0; y < t->config.height; y++) {
        put_cell(t, false, t->door_x, y, JP_CELL_OCCUPIED);
    }
    put_door(t, false, one_in(2) ? JP_CELL_FREE : JP_CELL_OCCUPIED);
}

static inline int random_elevation(const struct trial *t)
{
    return (int)below((uint32_t)t->roughness + 1);
}

static inline const struct jp_lattice *random_lattice(struct trial *t)
{
    const char *field = NULL;

    switch (below(4)) {
    case 0:
        return &jp_lattice_zhang2018;
    case 1:
        return &jp_lattice_gao2018;
    default:
        toy_lattice_make(&t->toy, jp_lattice_zhang2018.resolution);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&t->toy.lattice, &field));
        return &t->toy.lattice;
    }
}

static inline void random_map(struct trial *t)
{
    const char *field = NULL;

    t->lattice = random_lattice(t);
    t->kind = one_in(3) ? (enum jp_cost_kind)below(JP_COST_KINDS) : JP_COST_PHYSICAL;
    t->config = (struct jp_terrain_config){.width = (uint16_t)(SIDE_MIN + below(SIDE_MAX - SIDE_MIN + 1)),
                                           .height = (uint16_t)(SIDE_MIN + below(SIDE_MAX - SIDE_MIN + 1)),
                                           .resolution = t->lattice->resolution,
                                           .has_elevation = !one_in(8),
                                           .unknown_is_free = one_in(2)};
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_terrain_init(&t->terrain, &t->config, t->terrain_block, sizeof t->terrain_block, &field));
    oracle_map_clear(&t->map, t->config.width, t->config.height);
    oracle_init(&oracle, t->lattice, t->kind);
    t->blocked_count = t->config.width * t->config.height;
    t->blocked_percent = (int)below(t->lattice == &jp_lattice_zhang2018 ? 4 : t->lattice == &t->toy.lattice ? 25 : 8);
    t->roughness = (int)below(ROUGHNESS_MAX);
    for (int y = 0; y < t->config.height; y++) {
        for (int x = 0; x < t->config.width; x++) {
            put_cell(t, false, x, y, below(100) < (uint32_t)t->blocked_percent ? JP_CELL_OCCUPIED : JP_CELL_FREE);
            if (t->config.has_elevation) {
                put_elevation(t, false, x, y, random_elevation(t));
            }
        }
    }
    t->door_x = -1;
    if (one_in(4)) {
        put_wall(t);
    }
}

static inline struct jp_lattice_pose random_pose(const struct trial *t)
{
    return (struct jp_lattice_pose){(int16_t)below(t->config.width), (int16_t)below(t->config.height),
                                    (uint8_t)below(JP_HEADINGS)};
}

/** Planner */

/** Steps of the last ε of which the optimum is proved. */
static inline void random_schedule(uint16_t *epsilon)
{
    static const uint16_t schedules[][JP_EPSILON_LEVELS] = {
        {256, 0, 0, 0}, {512, 256, 0, 0}, {1024, 350, 256, 0}, {768, 640, 300, 256}};

    memcpy(epsilon, schedules[below(sizeof schedules / sizeof schedules[0])], sizeof schedules[0]);
}

static inline void init_planner(struct trial *t, size_t size)
{
    struct jp_planner_config config = {.lattice = t->lattice, .cost = t->kind};
    const char *field = NULL;

    random_schedule(config.epsilon);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&t->planner, &config, &t->terrain, t->block, size, &field));
}

static inline bool put_start(struct trial *t, struct jp_lattice_pose start)
{
    if (jp_planner_set_start(&t->planner, &start) != JP_OK) {
        return false;
    }
    t->start = start;
    return true;
}

static inline bool put_goal(struct trial *t, struct jp_goal goal)
{
    if (jp_planner_set_goal(&t->planner, &goal) != JP_OK) {
        return false;
    }
    t->goal = goal;
    return true;
}

static inline bool put_random_start(struct trial *t)
{
    for (int i = 0; i < TRIES; i++) {
        if (put_start(t, random_pose(t))) {
            return true;
        }
    }
    return false;
}

static inline bool put_random_goal(struct trial *t)
{
    for (int i = 0; i < TRIES; i++) {
        const struct jp_lattice_pose pose = random_pose(t);
        const uint32_t one = 1U << pose.heading;
        const uint32_t headings = one_in(3) ? JP_ANY_HEADING : one_in(4) ? one | (1 + below(UINT16_MAX)) : one;
        if (put_goal(t, (struct jp_goal){pose.x, pose.y, (uint16_t)headings})) {
            return true;
        }
    }
    return false;
}

/** A map with a start and a goal, all of it in t. */
static inline void random_trial(struct trial *t, size_t size)
{
    do {
        random_map(t);
        init_planner(t, size == 0 ? jp_planner_size(&t->config) + below(below(60000) + 1) : size);
    } while (!put_random_start(t) || !put_random_goal(t));
}

/** Notes what is wrong, and with what, unless something was before. */
static inline bool note(const char *what, const struct trial *t, double expected)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);

    if (problem[0] == '\0') {
        snprintf(problem, sizeof problem,
                 "%s (%d): %s, %d x %d, start %d %d %d, cost %u bound %u answer %d; optimum %.0f", what,
                 (int)t->planner.internal.answer, t->lattice->name, t->config.width, t->config.height, t->start.x,
                 t->start.y, t->start.heading, plan->cost, plan->bound, plan->answer, expected);
        printf("%s\n", problem);
    }
    return false;
}

/** Checks */

/** True when the plan leads over the map as it is, from the start to its end, at its cost. */
static inline bool is_drivable(const struct trial *t)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);
    struct jp_lattice_pose pose = plan->start;
    double cost = 0;

    if (pose.x != t->start.x || pose.y != t->start.y || pose.heading != t->start.heading) {
        return note("starts elsewhere", t, 0);
    }
    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *primitive = jp_planner_step(&t->planner, i, &pose);
        if (primitive == NULL || primitive->start != from.heading || pose.x != from.x + primitive->dx ||
            pose.y != from.y + primitive->dy || pose.heading != primitive->end) {
            return note("steps do not join", t, i);
        }
        cost += oracle_edge(&oracle, &t->map, (int)(primitive - t->lattice->primitives), from.x, from.y);
    }
    if (pose.x != plan->end.x || pose.y != plan->end.y || pose.heading != plan->end.heading) {
        return note("ends elsewhere", t, 0);
    }
    return cost == plan->cost ? true : note("steps add up to another cost", t, cost);
}

static inline bool is_at_goal(const struct trial *t)
{
    const struct jp_lattice_pose *end = &jp_planner_plan(&t->planner)->end;

    return end->x == t->goal.x && end->y == t->goal.y && (t->goal.headings >> end->heading & 1) != 0;
}

static inline bool is_right_route(const struct trial *t, double optimum)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);

    if (!is_drivable(t)) {
        return false;
    }
    if (!is_at_goal(t) || plan->cost_left != 0) {
        return note("not at the goal", t, optimum);
    }
    if (plan->bound < JP_EPSILON_ONE || (plan->step_count == 0) != (optimum == 0)) {
        return note("bound or steps", t, optimum);
    }
    const bool is_proved = plan->bound != JP_BOUND_NONE;
    if (plan->cost < optimum || (is_proved && plan->cost * 256.0 > plan->bound * optimum)) {
        return note("cost", t, optimum);
    }
    return plan->answer != JP_ANSWER_OPTIMAL || plan->cost == optimum ? true : note("not optimal", t, optimum);
}

static inline bool is_right_partial(const struct trial *t)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);

    if (plan->cost_left == 0 || plan->bound != 0 || is_at_goal(t)) {
        return note("partial that says it is not", t, 0);
    }
    return is_drivable(t);
}

/** True when what the planner says is true. */
static inline bool is_right(const struct trial *t, enum jp_answer answer, double optimum)
{
    switch (answer) {
    case JP_ANSWER_OPTIMAL:
    case JP_ANSWER_WITHIN_BOUND:
        return answer == jp_planner_plan(&t->planner)->answer ? is_right_route(t, optimum)
                                                              : note("plan of another answer", t, optimum);
    case JP_ANSWER_PARTIAL:
        return answer == jp_planner_plan(&t->planner)->answer ? is_right_partial(t)
                                                              : note("plan of another answer", t, optimum);
    case JP_ANSWER_UNREACHABLE:
        return isinf(optimum) ? true : note("claims that there is no route", t, optimum);
    case JP_ANSWER_OUT_OF_BUDGET:
    case JP_ANSWER_STALE:
    default:
        return note("no answer", t, optimum);
    }
}

/** Works until nothing is left to do; every answer on the way is checked. */
static inline bool is_right_when_idle(struct trial *t, uint32_t slice_max)
{
    const double optimum = oracle_shortest(&oracle, &t->map, &t->start, &t->goal);
    enum jp_answer answer = jp_planner_work(&t->planner, 0);

    for (unsigned long work = 0; !jp_planner_is_idle(&t->planner);) {
        const uint32_t slice = 1 + below(slice_max);
        answer = jp_planner_work(&t->planner, slice);
        work += slice;
        if (answer != JP_ANSWER_OUT_OF_BUDGET && !is_right(t, answer, optimum)) {
            return false;
        }
        if (work > WORK_MAX) {
            return note("hangs", t, optimum);
        }
    }
    return is_right(t, answer, optimum);
}

/** Edits */

static inline bool find_blocked(const struct trial *t, int *x, int *y)
{
    for (int i = 0; i < TRIES; i++) {
        *x = (int)below(t->config.width);
        *y = (int)below(t->config.height);
        if (t->map.is_blocked[oracle_cell(*x, *y)]) {
            return true;
        }
    }
    return false;
}

/** Sets a cell so that about as many are blocked as before; now and then it hits the planner at work. */
static inline void change_cell(struct trial *t, int x, int y, bool block)
{
    if (t->config.has_elevation && one_in(4)) {
        put_elevation(t, true, x, y, random_elevation(t));
    } else if (one_in(5)) {
        put_cell(t, true, x, y, JP_CELL_UNKNOWN);
    } else {
        put_cell(t, true, x, y, block ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    if (one_in(4)) {
        (void)jp_planner_work(&t->planner, below(below(60) + 1));
    }
}

static inline bool wants_blocked(const struct trial *t)
{
    return t->blocked_count * 100 < t->blocked_percent * t->config.width * t->config.height ? one_in(2) : one_in(8);
}

static inline void change_cluster(struct trial *t, int cells)
{
    const bool block = wants_blocked(t);
    int x = (int)below(t->config.width);
    int y = (int)below(t->config.height);

    if (!block) {
        (void)find_blocked(t, &x, &y);
    }
    for (int i = 0; i < cells; i++) {
        const int nx = x + (i == 0 ? 0 : (int)below(3) - 1);
        const int ny = y + (i == 0 ? 0 : (int)below(3) - 1);
        if (jp_terrain_contains(&t->terrain, nx, ny)) {
            change_cell(t, nx, ny, block);
        }
    }
}

static inline void change_map(struct trial *t)
{
    if (has_wall(t) && one_in(4)) {
        put_door(t, true, one_in(3) ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        return;
    }
    switch (below(16)) {
    case 0: /* more than are repaired together */
        for (unsigned i = 0; i < JP_PLANNER_CHANGES + below(JP_PLANNER_CHANGES); i++) {
            change_cluster(t, 1);
        }
        break;
    case 1:
    case 2:
    case 3:
    case 4: /* far apart */
        for (unsigned i = 0; i < 2 + below(8); i++) {
            change_cluster(t, 1);
        }
        break;
    case 5:
    case 6:
    case 7:
    case 8:
        change_cluster(t, 2 + (int)below(8));
        break;
    default:
        change_cluster(t, 1);
        break;
    }
}

/** Drives on along the plan. */
static inline void drive(struct trial *t)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);
    struct jp_lattice_pose pose = plan->start;
    const unsigned steps = 1 + below(4);

    for (unsigned i = 0; i < steps && jp_planner_step(&t->planner, i, &pose) != NULL; i++) {
    }
    if (plan->answer != JP_ANSWER_OUT_OF_BUDGET) {
        (void)put_start(t, pose);
    }
}

static inline void change_task(struct trial *t)
{
    if (one_in(4)) {
        drive(t);
    } else if (one_in(12)) {
        (void)put_random_start(t);
    } else if (one_in(16)) {
        (void)put_random_goal(t);
    }
    if (one_in(3)) {
        (void)jp_planner_work(&t->planner, below(below(200) + 1));
    }
}

static inline void edit(struct trial *t)
{
    if (one_in(2)) {
        change_task(t);
        change_map(t);
    } else {
        change_map(t);
        change_task(t);
    }
}

static inline void move_task_if_unreachable(struct trial *t, bool is_reachable)
{
    if (!is_reachable && one_in(2)) {
        (void)put_random_start(t);
        (void)put_random_goal(t);
    }
}

#endif
