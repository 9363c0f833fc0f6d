/*
 * The planner against Dijkstra in double precision over the whole lattice: random edits of random small maps while it
 * searches, moving starts, new goals; memory that is too small; slices of any size; changes behind its back; and the
 * lower bounds that it lives on.
 *
 * prop_planner [--count N] [--seed S] [--json FILE]
 * --count is the number of edits; 100000 for the full check.
 */
#include <joulepath/planner.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options.h"
#include "planner_oracle.h"
#include "toy_lattice.h"
#include "unity.h"

extern const struct jp_lattice jp_lattice_zhang2018;
extern const struct jp_lattice jp_lattice_gao2018;

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

/* A map, a lattice, a task and its planner. */
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
    struct jp_pose start;
    struct jp_goal goal;
    struct jp_planner planner;
    _Alignas(8) uint8_t block[AMPLE_BYTES];
};

struct counts {
    unsigned long edits;
    unsigned long reachable;
    unsigned long wrong;
    unsigned long bounds;
    unsigned long bounds_wrong;
    unsigned long small;
    unsigned long small_wrong;
    unsigned long by_answer[JP_ANSWER_STALE + 1];
};

static uint64_t seed = 1;
static uint64_t random_state;
static unsigned long count = 2000;
static struct counts counts;
static struct trial trial;
static struct oracle oracle;
static char problem[200]; /* the first that was found */

void setUp(void)
{
    problem[0] = '\0';
}

void tearDown(void)
{
}

static uint64_t random_bits(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return random_state * UINT64_C(2685821657736338717);
}

static uint32_t below(uint32_t n)
{
    return (uint32_t)((random_bits() >> 32) * n >> 32);
}

static bool one_in(uint32_t n)
{
    return below(n) == 0;
}

static void begin_random(uint64_t stream)
{
    random_state = seed * 1000003 + stream * 7919 + 1;
    (void)random_bits();
}

/* Maps */

/* Cells of a map that is told of every change, or of a planner that hears of it. */
static void put_cell(struct trial *t, bool tell, int x, int y, enum jp_cell cell)
{
    const bool is_blocked = cell == JP_CELL_OCCUPIED || (cell == JP_CELL_UNKNOWN && !t->config.unknown_is_free);
    bool *entry = &t->map.is_blocked[oracle_cell(x, y)];

    TEST_ASSERT_EQUAL_INT(JP_OK, tell ? jp_planner_set_cell(&t->planner, x, y, cell)
                                      : jp_terrain_set_cell(&t->terrain, x, y, cell));
    t->blocked_count += is_blocked - *entry;
    *entry = is_blocked;
}

static void put_elevation(struct trial *t, bool tell, int x, int y, int elevation)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, tell ? jp_planner_set_elevation(&t->planner, x, y, (jp_elevation)elevation)
                                      : jp_terrain_set_elevation(&t->terrain, x, y, (jp_elevation)elevation));
    t->map.elevation[oracle_cell(x, y)] = elevation;
}

static bool has_wall(const struct trial *t)
{
    return t->door_x >= 0;
}

static void put_door(struct trial *t, bool tell, enum jp_cell cell)
{
    for (int y = t->door_y; y < t->door_y + t->door_height; y++) {
        put_cell(t, tell, t->door_x, y, cell);
    }
}

/* A wall from side to side, with a door that is open half of the time. */
static void put_wall(struct trial *t)
{
    t->door_x = t->config.width / 3 + (int)below(t->config.width / 3U);
    t->door_y = (int)below(t->config.height - 1U);
    t->door_height = 1 + (int)below((uint32_t)(t->config.height - t->door_y));
    for (int y = 0; y < t->config.height; y++) {
        put_cell(t, false, t->door_x, y, JP_CELL_OCCUPIED);
    }
    put_door(t, false, one_in(2) ? JP_CELL_FREE : JP_CELL_OCCUPIED);
}

static int random_elevation(const struct trial *t)
{
    return (int)below((uint32_t)t->roughness + 1);
}

static const struct jp_lattice *random_lattice(struct trial *t)
{
    const char *field = NULL;

    switch (below(4)) {
    case 0:
        return &jp_lattice_zhang2018;
    case 1:
        return &jp_lattice_gao2018;
    default:
        toy_lattice_make(&t->toy, jp_lattice_zhang2018.resolution, below);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&t->toy.lattice, &field));
        return &t->toy.lattice;
    }
}

static void random_map(struct trial *t)
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

static struct jp_pose random_pose(const struct trial *t)
{
    return (struct jp_pose){(int16_t)below(t->config.width), (int16_t)below(t->config.height),
                            (uint8_t)below(JP_HEADINGS)};
}

/* Planner */

/* Steps of the last ε of which the optimum is proved. */
static void random_schedule(uint16_t *epsilon)
{
    static const uint16_t schedules[][JP_EPSILON_LEVELS] = {
        {256, 0, 0, 0}, {512, 256, 0, 0}, {1024, 350, 256, 0}, {768, 640, 300, 256}};

    memcpy(epsilon, schedules[below(sizeof schedules / sizeof schedules[0])], sizeof schedules[0]);
}

static void init_planner(struct trial *t, size_t size)
{
    struct jp_planner_config config = {.lattice = t->lattice, .cost = t->kind};
    const char *field = NULL;

    random_schedule(config.epsilon);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&t->planner, &config, &t->terrain, t->block, size, &field));
}

static bool put_start(struct trial *t, struct jp_pose start)
{
    if (jp_planner_set_start(&t->planner, &start) != JP_OK) {
        return false;
    }
    t->start = start;
    return true;
}

static bool put_goal(struct trial *t, struct jp_goal goal)
{
    if (jp_planner_set_goal(&t->planner, &goal) != JP_OK) {
        return false;
    }
    t->goal = goal;
    return true;
}

static bool put_random_start(struct trial *t)
{
    for (int i = 0; i < TRIES; i++) {
        if (put_start(t, random_pose(t))) {
            return true;
        }
    }
    return false;
}

static bool put_random_goal(struct trial *t)
{
    for (int i = 0; i < TRIES; i++) {
        const struct jp_pose pose = random_pose(t);
        const uint32_t one = 1U << pose.heading;
        const uint32_t headings = one_in(3) ? JP_ANY_HEADING : one_in(4) ? one | (1 + below(UINT16_MAX)) : one;
        if (put_goal(t, (struct jp_goal){pose.x, pose.y, (uint16_t)headings})) {
            return true;
        }
    }
    return false;
}

/* A map with a start and a goal, all of it in t. */
static void random_trial(struct trial *t, size_t size)
{
    do {
        random_map(t);
        init_planner(t, size == 0 ? jp_planner_size_min(&t->config) + below(below(60000) + 1) : size);
    } while (!put_random_start(t) || !put_random_goal(t));
}

/* Notes what is wrong, and with what, unless something was before. */
static bool note(const char *what, const struct trial *t, double expected)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);

    if (problem[0] == '\0') {
        snprintf(problem, sizeof problem,
                 "%s (%d): %s, %d x %d, start %d %d %d, cost %u bound %u answer %d; optimum %.0f", what,
                 (int)t->planner.answer, t->lattice->name, t->config.width, t->config.height, t->start.x, t->start.y,
                 t->start.heading, plan->cost, plan->bound, plan->answer, expected);
        printf("%s\n", problem);
    }
    return false;
}

/* Checks */

/* True when the plan leads over the map as it is, from the start to its end, at its cost. */
static bool is_drivable(const struct trial *t)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);
    struct jp_pose pose = plan->start;
    double cost = 0;

    if (pose.x != t->start.x || pose.y != t->start.y || pose.heading != t->start.heading) {
        return note("starts elsewhere", t, 0);
    }
    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_pose from = pose;
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

static bool is_at_goal(const struct trial *t)
{
    const struct jp_pose *end = &jp_planner_plan(&t->planner)->end;

    return end->x == t->goal.x && end->y == t->goal.y && (t->goal.headings >> end->heading & 1) != 0;
}

static bool is_right_route(const struct trial *t, double optimum)
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

static bool is_right_partial(const struct trial *t)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);

    if (plan->cost_left == 0 || plan->bound != 0 || is_at_goal(t)) {
        return note("partial that says it is not", t, 0);
    }
    return is_drivable(t);
}

/* True when what the planner says is true. */
static bool is_right(const struct trial *t, enum jp_answer answer, double optimum)
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

/* Works until nothing is left to do; every answer on the way is checked. */
static bool is_right_when_idle(struct trial *t, uint32_t slice_max)
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

/* Edits */

static bool find_blocked(const struct trial *t, int *x, int *y)
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

/* Sets a cell so that about as many are blocked as before; now and then it hits the planner at work. */
static void change_cell(struct trial *t, int x, int y, bool block)
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

static bool wants_blocked(const struct trial *t)
{
    return t->blocked_count * 100 < t->blocked_percent * t->config.width * t->config.height ? one_in(2) : one_in(8);
}

static void change_cluster(struct trial *t, int cells)
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

static void change_map(struct trial *t)
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

/* Drives on along the plan. */
static void drive(struct trial *t)
{
    const struct jp_plan *plan = jp_planner_plan(&t->planner);
    struct jp_pose pose = plan->start;
    const unsigned steps = 1 + below(4);

    for (unsigned i = 0; i < steps && jp_planner_step(&t->planner, i, &pose) != NULL; i++) {
    }
    if (plan->answer != JP_ANSWER_OUT_OF_BUDGET) {
        (void)put_start(t, pose);
    }
}

static void change_task(struct trial *t)
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

static void edit(struct trial *t)
{
    if (one_in(2)) {
        change_task(t);
        change_map(t);
    } else {
        change_map(t);
        change_task(t);
    }
}

static void move_task_if_unreachable(struct trial *t, bool is_reachable)
{
    if (!is_reachable && one_in(2)) {
        (void)put_random_start(t);
        (void)put_random_goal(t);
    }
}

/* Tests */

static void test_edits_keep_the_optimum(void)
{
    begin_random(1);
    while (counts.edits < count) {
        random_trial(&trial, AMPLE_BYTES);
        for (int i = 0; i < EDITS_PER_MAP && counts.edits < count; i++) {
            edit(&trial);
            const bool is_right_now = is_right_when_idle(&trial, 1 + below(300));
            const enum jp_answer answer = jp_planner_work(&trial.planner, 1);
            const bool is_final = answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_UNREACHABLE;
            counts.wrong += !is_right_now || !is_final;
            counts.edits++;
            counts.reachable += answer == JP_ANSWER_OPTIMAL;
            if (!is_right_now || !is_final) {
                (void)note("neither optimal nor unreachable", &trial, 0);
                break;
            }
            move_task_if_unreachable(&trial, answer == JP_ANSWER_OPTIMAL);
        }
    }
    printf("edits %lu, reachable %lu, wrong %lu\n", counts.edits, counts.reachable, counts.wrong);
    TEST_ASSERT_EQUAL_UINT64(0, counts.wrong);
    TEST_ASSERT_TRUE((counts.edits - counts.reachable) * 100 <= counts.edits * UNREACHABLE_MAX_PERCENT);
}

/* Any memory: every claim is true. */
static void test_small_memory_never_lies(void)
{
    begin_random(2);
    while (counts.small < count / 2) {
        random_trial(&trial, 0);
        for (int i = 0; i < EDITS_PER_MAP / 5; i++) {
            const bool is_right_now = is_right_when_idle(&trial, 1 + below(300));
            counts.small++;
            counts.by_answer[jp_planner_work(&trial.planner, 1)]++;
            counts.small_wrong += !is_right_now;
            if (!is_right_now) {
                break;
            }
            move_task_if_unreachable(&trial, jp_planner_work(&trial.planner, 1) != JP_ANSWER_UNREACHABLE);
            edit(&trial);
        }
    }
    printf(
        "small memory: %lu plans, wrong %lu; optimal %lu, within a bound %lu, partial %lu, unreachable %lu, none %lu\n",
        counts.small, counts.small_wrong, counts.by_answer[JP_ANSWER_OPTIMAL], counts.by_answer[JP_ANSWER_WITHIN_BOUND],
        counts.by_answer[JP_ANSWER_PARTIAL], counts.by_answer[JP_ANSWER_UNREACHABLE],
        counts.by_answer[JP_ANSWER_OUT_OF_BUDGET]);
    TEST_ASSERT_EQUAL_UINT64(0, counts.small_wrong);
}

/* The energy field */

static double turned(const struct jp_turns *turns, int from, int to)
{
    return turns->cost[from][to];
}

/* True when the field is below the distances from a root pose, and no primitive overtakes it. */
static bool is_bound(const struct trial *t, const struct jp_energy_field *field, const struct jp_turns *turns,
                     const struct jp_pose *root)
{
    (void)oracle_shortest(&oracle, &t->map, root, NULL);
    for (int state = 0; state < t->map.width * t->map.height * JP_HEADINGS; state++) {
        const int heading = state % JP_HEADINGS;
        const int x = state / JP_HEADINGS % t->map.width;
        const int y = state / JP_HEADINGS / t->map.width;
        const jp_cost here = jp_energy_field_bound(field, x, y);
        if (oracle.distance[state] < here + turned(turns, root->heading, heading)) {
            return note("energy field above the truth", t, oracle.distance[state]);
        }
        for (int i = t->lattice->first_from[heading]; here < JP_COST_MAX && i < t->lattice->first_from[heading + 1];
             i++) {
            const struct jp_primitive *p = &t->lattice->primitives[i];
            const double cost = oracle_edge(&oracle, &t->map, i, x, y);
            if (!isinf(cost) &&
                jp_energy_field_bound(field, x + p->dx, y + p->dy) + turned(turns, root->heading, p->end) >
                    here + turned(turns, root->heading, heading) + cost) {
                return note("energy field not consistent", t, cost);
            }
        }
    }
    return true;
}

/* Changes cells of the map and tells the field of what may be cheaper. */
static void change_field(struct trial *t, struct jp_energy_field *field)
{
    const int x = (int)below(t->config.width);
    const int y = (int)below(t->config.height);

    if (t->config.has_elevation && one_in(3)) {
        put_elevation(t, false, x, y, random_elevation(t));
        jp_energy_field_cell_changed(field, x, y);
    } else if (one_in(2)) {
        put_cell(t, false, x, y, JP_CELL_OCCUPIED);
    } else {
        put_cell(t, false, x, y, JP_CELL_FREE);
        jp_energy_field_cell_changed(field, x, y);
    }
}

static void grow(struct jp_energy_field *field, unsigned slice_max, unsigned slices)
{
    for (unsigned i = 0; i < slices; i++) {
        unsigned cells = 1 + below(slice_max);
        if (jp_energy_field_grow(field, &cells)) {
            return;
        }
    }
}

static void test_energy_field_is_a_bound(void)
{
    static uint64_t block[(SIDE_MAX + 2) * SIDE_MAX];
    struct jp_energy_field field;
    struct jp_turns turns;

    begin_random(3);
    while (counts.bounds < count / 4) {
        random_map(&trial);
        const struct jp_pose root = random_pose(&trial);
        TEST_ASSERT_TRUE(jp_energy_field_size(&trial.config) <= sizeof block);
        jp_lattice_turns(trial.lattice, trial.kind, &turns);
        jp_energy_field_init(&field, trial.lattice, trial.kind, &trial.terrain, block);
        jp_energy_field_start(&field, root.x, root.y, (int32_t)below(trial.config.width),
                              (int32_t)below(trial.config.height));
        for (int i = 0; i < EDITS_PER_MAP / 5; i++) {
            grow(&field, UINT16_MAX, UINT16_MAX);
            counts.bounds_wrong += !is_bound(&trial, &field, &turns, &root);
            counts.bounds++;
            for (unsigned k = below(12); k > 0; k--) {
                change_field(&trial, &field);
                grow(&field, 50, below(3));
            }
        }
    }
    printf("energy field: %lu maps, wrong %lu\n", counts.bounds, counts.bounds_wrong);
    TEST_ASSERT_EQUAL_UINT64(0, counts.bounds_wrong);
}

/* Of the ground alone, and with the turning on top. */
static void test_straight_bound_is_below_the_truth(void)
{
    struct jp_turns turns;

    begin_random(4);
    for (unsigned long i = 0; i < count / 10; i++) {
        random_map(&trial);
        const struct jp_pose root = random_pose(&trial);
        const int elevation = trial.map.elevation[oracle_cell(root.x, root.y)];
        jp_lattice_turns(trial.lattice, trial.kind, &turns);
        (void)oracle_shortest(&oracle, &trial.map, &root, NULL);
        for (int state = 0; state < trial.map.width * trial.map.height * JP_HEADINGS; state++) {
            const int x = state / JP_HEADINGS % trial.map.width;
            const int y = state / JP_HEADINGS / trial.map.width;
            if (isinf(oracle.distance[state])) {
                continue;
            }
            const jp_cost bound = jp_lattice_straight_bound(trial.lattice, trial.kind, x - root.x, y - root.y,
                                                            trial.map.elevation[oracle_cell(x, y)] - elevation);
            if (bound + turned(&turns, root.heading, state % JP_HEADINGS) > oracle.distance[state]) {
                (void)note("straight bound above the truth", &trial, oracle.distance[state]);
            }
        }
    }
    TEST_ASSERT_EQUAL_STRING("", problem);
}

/* Slices */

struct outcome {
    struct jp_plan plan;
    enum jp_answer answer;
    uint32_t expansions;
    uint8_t route[ROUTE_MAX];
};

static void work_in_slices(struct trial *t, uint32_t slice, struct outcome *outcome)
{
    struct jp_pose pose;

    memset(outcome, 0, sizeof *outcome);
    while (!jp_planner_is_idle(&t->planner)) {
        (void)jp_planner_work(&t->planner, slice == 0 ? below(50) : slice);
    }
    outcome->answer = jp_planner_work(&t->planner, 1);
    outcome->plan = *jp_planner_plan(&t->planner);
    outcome->expansions = jp_planner_statistics(&t->planner)->expansions;
    pose = outcome->plan.start;
    TEST_ASSERT_TRUE(outcome->plan.step_count <= ROUTE_MAX);
    for (unsigned i = 0; i < outcome->plan.step_count; i++) {
        outcome->route[i] = (uint8_t)(jp_planner_step(&t->planner, i, &pose) - t->lattice->primitives);
    }
}

static void expect_same(const struct outcome *a, const struct outcome *b)
{
    TEST_ASSERT_EQUAL_INT(a->answer, b->answer);
    TEST_ASSERT_EQUAL_UINT32(a->plan.cost, b->plan.cost);
    TEST_ASSERT_EQUAL_UINT32(a->plan.cost_left, b->plan.cost_left);
    TEST_ASSERT_EQUAL_UINT32(a->plan.bound, b->plan.bound);
    TEST_ASSERT_EQUAL_UINT32(a->plan.step_count, b->plan.step_count);
    TEST_ASSERT_EQUAL_UINT32(a->expansions, b->expansions);
    TEST_ASSERT_EQUAL_MEMORY(a->route, b->route, sizeof a->route);
}

/* The same edits, worked through in one go, one by one, and in random slices. */
static void test_slices_change_nothing(void)
{
    static struct outcome outcomes[3][EDITS_PER_MAP / 10];
    static const uint32_t slices[3] = {1 << 20, 1, 0};

    for (unsigned long i = 0; i < count / 30; i++) {
        const bool is_ample = i % 2 == 0;
        for (int run = 0; run < 3; run++) {
            begin_random(1000 + i);
            random_trial(&trial, is_ample ? AMPLE_BYTES : 0);
            for (int k = 0; k < EDITS_PER_MAP / 10; k++) {
                const uint64_t before = random_state;
                work_in_slices(&trial, slices[run], &outcomes[run][k]);
                random_state = before;
                expect_same(&outcomes[0][k], &outcomes[run][k]);
                const int x = (int)below(trial.config.width);
                const int y = (int)below(trial.config.height);
                put_cell(&trial, true, x, y, one_in(2) ? JP_CELL_OCCUPIED : JP_CELL_FREE);
                drive(&trial);
            }
        }
    }
}

/* Changes behind the planner's back */

static void test_stale_until_restarted(void)
{
    begin_random(5);
    for (unsigned long i = 0; i < count / 30; i++) {
        random_trial(&trial, AMPLE_BYTES);
        (void)jp_planner_work(&trial.planner, one_in(2) ? WORK_MAX : below(500));
        const struct jp_plan before = *jp_planner_plan(&trial.planner);
        put_cell(&trial, false, (int)below(trial.config.width), (int)below(trial.config.height), JP_CELL_OCCUPIED);
        const uint32_t expansions = jp_planner_statistics(&trial.planner)->expansions;
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_STALE, jp_planner_work(&trial.planner, 100));
        TEST_ASSERT_EQUAL_INT(JP_ANSWER_STALE, jp_planner_work(&trial.planner, 0));
        TEST_ASSERT_EQUAL_UINT32(expansions, jp_planner_statistics(&trial.planner)->expansions);
        TEST_ASSERT_EQUAL_MEMORY(&before, jp_planner_plan(&trial.planner), sizeof before);
        /* A change that it is told of does not heal that, unless it makes the planner begin anew. */
        const uint32_t restarts = jp_planner_statistics(&trial.planner)->restarts;
        put_cell(&trial, true, 0, 0, JP_CELL_OCCUPIED);
        TEST_ASSERT_TRUE(jp_planner_work(&trial.planner, 1) == JP_ANSWER_STALE ||
                         jp_planner_statistics(&trial.planner)->restarts > restarts);
        jp_planner_restart(&trial.planner);
        TEST_ASSERT_TRUE_MESSAGE(is_right_when_idle(&trial, 100), problem);
    }
}

static void write_figure(FILE *file, const char *name, unsigned long wrong)
{
    static const char *separator = "[\n";

    fprintf(file,
            "%s{\"name\": \"%s\", \"value\": %lu, \"unit\": \"\", \"bound\": {\"op\": \"==\", \"value\": 0}, "
            "\"command\": \"make figures\"}",
            separator, name, wrong);
    separator = ",\n";
}

/* For tools/figures.py. */
static void write_json(const char *path)
{
    char name[120];
    FILE *file = fopen(path, "w");

    if (!file) {
        perror(path);
        exit(1);
    }
    snprintf(name, sizeof name,
             "planner: edits on small maps whose plan differs from Dijkstra over the whole lattice, of %lu",
             counts.edits);
    write_figure(file, name, counts.wrong);
    snprintf(name, sizeof name, "planner: wrong claims in too little memory, of %lu plans", counts.small);
    write_figure(file, name, counts.small_wrong);
    snprintf(name, sizeof name, "planner: energy fields above the true cost of a state, of %lu", counts.bounds);
    write_figure(file, name, counts.bounds_wrong);
    fprintf(file, "\n]\n");
    if (fclose(file) != 0) {
        perror(path);
        exit(1);
    }
}

int main(int argc, char **argv)
{
    const struct options options = parse_options(argc, argv, (struct options){.count = count, .seed = 1});
    const char *json = options.json;

    count = options.count;
    seed = options.seed;
    printf("seed %llu\n", (unsigned long long)seed);
    UNITY_BEGIN();
    RUN_TEST(test_edits_keep_the_optimum);
    RUN_TEST(test_small_memory_never_lies);
    RUN_TEST(test_energy_field_is_a_bound);
    RUN_TEST(test_straight_bound_is_below_the_truth);
    RUN_TEST(test_slices_change_nothing);
    RUN_TEST(test_stale_until_restarted);
    int failures = UNITY_END();
    if (json) {
        write_json(json);
    }
    return failures;
}
