/*
 * The planner against Dijkstra in double precision over the whole lattice: random edits of random small maps while it
 * searches, moving starts, new goals; memory that is too small; slices of any size; changes behind its back; and the
 * lower bounds that it lives on.
 *
 * prop_planner [--count N] [--seed S] [--json FILE]
 * --count is the number of edits; 100000 for the full check.
 */
#include "tests/support/options.h"
#include "tests/support/planner_trial.h"

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

static struct counts counts;
static struct options options = {.count = 1000, .seed = 1};

void setUp(void)
{
    problem[0] = '\0';
}

void tearDown(void)
{
}

/* Tests */

static void test_edits_keep_the_optimum(void)
{
    begin_random(options.seed, 1);
    while (counts.edits < options.count) {
        random_trial(&trial, AMPLE_BYTES);
        for (int i = 0; i < EDITS_PER_MAP && counts.edits < options.count; i++) {
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
    begin_random(options.seed, 2);
    while (counts.small < options.count / 2) {
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

/* The fields */

struct fields {
    struct jp_energy_field ground;
    struct jp_turn_field turn_field;
    struct jp_turns turns;
    struct jp_lattice_pose root;
};

/* Of the ground, and of the turns between the headings. */
static double plain_bound(const struct fields *fields, int x, int y, int heading)
{
    return (double)jp_energy_field_bound(&fields->ground, x, y) + fields->turns.cost[fields->root.heading][heading];
}

static double sum_of_fields(const struct fields *fields, int x, int y, int heading)
{
    return (double)jp_energy_field_bound(&fields->ground, x, y) +
           jp_turn_field_bound(&fields->turn_field, x, y, (unsigned)heading);
}

/* True when a bound is below the distances from the root, and no primitive overtakes it. */
static bool is_bound(const struct trial *t, const struct fields *fields,
                     double (*bound)(const struct fields *, int, int, int))
{
    for (int state = 0; state < t->map.width * t->map.height * JP_HEADINGS; state++) {
        const int heading = state % JP_HEADINGS;
        const int x = state / JP_HEADINGS % t->map.width;
        const int y = state / JP_HEADINGS / t->map.width;
        const double here = bound(fields, x, y, heading);
        if (oracle.distance[state] < here) {
            return note("bound above the truth", t, oracle.distance[state]);
        }
        for (int i = t->lattice->first_from[heading]; here < JP_COST_MAX && i < t->lattice->first_from[heading + 1];
             i++) {
            const struct jp_primitive *p = &t->lattice->primitives[i];
            const double cost = oracle_edge(&oracle, &t->map, i, x, y);
            if (!isinf(cost) && bound(fields, x + p->dx, y + p->dy, p->end) > here + cost) {
                return note("bound not consistent", t, cost);
            }
        }
    }
    return true;
}

/* Changes cells of the map and tells the fields of what may be cheaper. */
static void change_fields(struct trial *t, struct fields *fields)
{
    const int x = (int)below(t->config.width);
    const int y = (int)below(t->config.height);

    if (t->config.has_elevation && one_in(3)) {
        put_elevation(t, false, x, y, random_elevation(t));
    } else if (one_in(2)) {
        put_cell(t, false, x, y, JP_CELL_OCCUPIED);
        return;
    } else {
        put_cell(t, false, x, y, JP_CELL_FREE);
    }
    jp_energy_field_cell_changed(&fields->ground, x, y);
    jp_turn_field_cell_changed(&fields->turn_field, x, y);
}

/* In slices of random sizes, to the end or not. */
static void grow(struct fields *fields, unsigned slice_max, unsigned slices)
{
    bool is_ground_done = false;
    bool are_turns_done = false;

    for (unsigned i = 0; i < slices && !(is_ground_done && are_turns_done); i++) {
        unsigned cells = 1 + below(slice_max);
        unsigned looks = 1 + below(slice_max);
        is_ground_done = jp_energy_field_grow(&fields->ground, &cells);
        are_turns_done = jp_turn_field_grow(&fields->turn_field, &looks);
    }
}

static void begin_fields(struct trial *t, struct fields *fields)
{
    static uint64_t ground_block[(SIDE_MAX + 2) * SIDE_MAX];
    static uint64_t turn_block[SIDE_MAX * SIDE_MAX * JP_HEADINGS];
    const enum jp_wave_format format = below(2) == 0 ? JP_WAVE_2_BYTES : JP_WAVE_3_BYTES;
    const unsigned scale = JP_TURN_SCALE_MIN + below(4);
    const int32_t x = (int32_t)below(t->config.width);
    const int32_t y = (int32_t)below(t->config.height);

    fields->root = random_pose(t);
    TEST_ASSERT_TRUE(jp_energy_field_size(&t->config, format) <= sizeof ground_block);
    TEST_ASSERT_TRUE(jp_turn_field_size(&t->config, scale) <= sizeof turn_block);
    jp_lattice_turns(t->lattice, t->kind, &fields->turns);
    jp_energy_field_init(&fields->ground, t->lattice, t->kind, &t->terrain, format, random_word() >> (8 + below(20)),
                         ground_block);
    jp_energy_field_start(&fields->ground, fields->root.x, fields->root.y, x, y);
    jp_turn_field_init(&fields->turn_field, t->lattice, t->kind, &t->terrain, scale, turn_block);
    jp_turn_field_start(&fields->turn_field, &fields->turns, fields->root.x, fields->root.y, fields->root.heading, x, y,
                        below(JP_HEADINGS));
}

static void test_fields_are_bounds(void)
{
    struct fields fields;

    begin_random(options.seed, 3);
    while (counts.bounds < options.count / 4) {
        random_map(&trial);
        begin_fields(&trial, &fields);
        for (int i = 0; i < EDITS_PER_MAP / 5; i++) {
            grow(&fields, UINT16_MAX, UINT16_MAX);
            (void)oracle_shortest(&oracle, &trial.map, &fields.root, NULL);
            counts.bounds_wrong += !is_bound(&trial, &fields, plain_bound) || !is_bound(&trial, &fields, sum_of_fields);
            counts.bounds++;
            for (unsigned k = below(12); k > 0; k--) {
                change_fields(&trial, &fields);
                grow(&fields, 50, below(3));
            }
        }
    }
    printf("fields: %lu maps, wrong %lu\n", counts.bounds, counts.bounds_wrong);
    TEST_ASSERT_EQUAL_UINT64(0, counts.bounds_wrong);
}

/* Of the ground alone, and with the turning on top. */
static void test_straight_bound_is_below_the_truth(void)
{
    struct jp_straight straight;
    struct jp_turns turns;

    begin_random(options.seed, 4);
    for (unsigned long i = 0; i < options.count / 10; i++) {
        random_map(&trial);
        const struct jp_lattice_pose root = random_pose(&trial);
        const int elevation = trial.map.elevation[oracle_cell(root.x, root.y)];
        jp_lattice_straight(trial.lattice, trial.kind, &straight);
        jp_lattice_turns(trial.lattice, trial.kind, &turns);
        (void)oracle_shortest(&oracle, &trial.map, &root, NULL);
        for (int state = 0; state < trial.map.width * trial.map.height * JP_HEADINGS; state++) {
            const int x = state / JP_HEADINGS % trial.map.width;
            const int y = state / JP_HEADINGS / trial.map.width;
            if (isinf(oracle.distance[state])) {
                continue;
            }
            const jp_cost bound = jp_straight_bound(&straight, x - root.x, y - root.y,
                                                    trial.map.elevation[oracle_cell(x, y)] - elevation);
            if (bound + turns.cost[root.heading][state % JP_HEADINGS] > oracle.distance[state]) {
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
    struct jp_lattice_pose pose;

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

    for (unsigned long i = 0; i < options.count / 30; i++) {
        const bool is_ample = i % 2 == 0;
        for (int run = 0; run < 3; run++) {
            begin_random(options.seed, 1000 + i);
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
    begin_random(options.seed, 5);
    for (unsigned long i = 0; i < options.count / 30; i++) {
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

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", (double)counts.wrong, "", equal_to(0),
                "planner: edits on small maps whose plan differs from Dijkstra over the whole lattice, of %lu",
                counts.edits);
    figures_add(figures, "make figures", (double)counts.small_wrong, "", equal_to(0),
                "planner: wrong claims in too little memory, of %lu plans", counts.small);
    figures_add(figures, "make figures", (double)counts.bounds_wrong, "", equal_to(0),
                "planner: energy fields above the true cost of a state, of %lu", counts.bounds);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
