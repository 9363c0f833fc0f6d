/*
 * What more memory does to a plan: in blocks of powers of two it is never dearer, where the schedule ends with a proof.
 * And plans while a planner searches in smaller parts of its block: what it says of them holds, whatever changes.
 *
 * prop_planner_memory [--count N] [--seed S] [--json FILE]
 */
#include "src/search/planner_rehearsal.h"
#include "tests/support/options.h"
#include "tests/support/planner_trial.h"

#define COMMAND "make figures"

enum {
    SMALLEST = 1 << 11,
    LARGEST = 1 << 17,
    PLANS_MAX = 16, /* while the rehearsals of one map go on */
};

static struct options options = {.count = 200, .seed = 1};
static unsigned long pairs;
static unsigned long dearer;

void setUp(void)
{
    problem[0] = '\0';
}

void tearDown(void)
{
}

static enum jp_answer work_to_end(void)
{
    while (!jp_planner_is_idle(&trial.planner)) {
        (void)jp_planner_work(&trial.planner, 1 + below(40));
    }
    return jp_planner_work(&trial.planner, 1);
}

static bool is_whole(enum jp_answer answer)
{
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND;
}

/* The same task in a block of another size. */
static enum jp_answer plan_in(size_t size, const uint16_t *epsilon)
{
    struct jp_planner_config config = {.lattice = trial.lattice, .cost = trial.kind};
    const char *field = NULL;

    memcpy(config.epsilon, epsilon, sizeof config.epsilon);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&trial.planner, &config, &trial.terrain, trial.block, size, &field));
    TEST_ASSERT_TRUE(put_start(&trial, trial.start) && put_goal(&trial, trial.goal));
    return work_to_end();
}

static void compare_blocks(void)
{
    uint16_t epsilon[JP_EPSILON_LEVELS];
    jp_cost least = JP_COST_MAX;

    random_schedule(epsilon);
    for (size_t size = SMALLEST; size <= (size_t)LARGEST; size *= 2U) {
        if (size < jp_planner_size(&trial.config) || !is_whole(plan_in(size, epsilon))) {
            continue;
        }
        const jp_cost cost = jp_planner_plan(&trial.planner)->cost;
        pairs += least != JP_COST_MAX;
        if (cost > least) {
            dearer++;
            (void)note("dearer in more memory", &trial, least);
        }
        least = cost;
    }
}

static void test_more_memory_is_never_dearer(void)
{
    begin_random(options.seed, 1);
    for (unsigned long i = 0; i < options.count; i++) {
        random_trial(&trial, LARGEST);
        compare_blocks();
    }
    printf("%lu pairs of blocks, dearer in the larger %lu\n", pairs, dearer);
    TEST_ASSERT_TRUE(pairs > options.count / 4U);
    TEST_ASSERT_EQUAL_UINT64(0, dearer);
}

static void change_something(void)
{
    const int x = (int)below(trial.config.width);
    const int y = (int)below(trial.config.height);
    struct jp_lattice_pose pose = jp_planner_plan(&trial.planner)->start;

    switch (below(4)) {
    case 0:
        put_cell(&trial, true, x, y, JP_CELL_OCCUPIED);
        break;
    case 1:
        put_cell(&trial, true, x, y, JP_CELL_FREE);
        break;
    case 2:
        if (jp_planner_step(&trial.planner, 0, &pose) != NULL) {
            (void)put_start(&trial, pose);
        }
        break;
    default:
        (void)put_random_start(&trial);
        break;
    }
}

/* Into a rehearsal, if there is one, or to the end. */
static void work_into_rehearsal(void)
{
    while (!jp_planner_is_idle(&trial.planner) && !jp_rehearsal_is_on(&trial.planner.internal)) {
        (void)jp_planner_work(&trial.planner, 1 + below(10));
    }
    for (unsigned slices = below(60); slices > 0U; slices--) {
        (void)jp_planner_work(&trial.planner, 1 + below(10));
    }
}

/* Returns how many plans were looked at in the midst of a rehearsal. */
static unsigned plan_with_changes(void)
{
    unsigned rehearsals = 0;

    for (unsigned i = 0; i < (unsigned)PLANS_MAX; i++) {
        work_into_rehearsal();
        rehearsals += jp_rehearsal_is_on(&trial.planner.internal);
        const enum jp_answer answer = jp_planner_work(&trial.planner, 1);
        const double optimum = oracle_shortest(&oracle, &trial.map, &trial.start, &trial.goal);
        TEST_ASSERT_TRUE_MESSAGE(answer == JP_ANSWER_OUT_OF_BUDGET || is_right(&trial, answer, optimum), problem);
        change_something();
    }
    return rehearsals;
}

static void test_changes_during_rehearsals(void)
{
    unsigned long rehearsals = 0;

    begin_random(options.seed, 2);
    for (unsigned long i = 0; i < options.count / 4U; i++) {
        random_trial(&trial, 0);
        rehearsals += plan_with_changes();
        (void)work_to_end();
    }
    printf("%lu changes during rehearsals\n", rehearsals);
    TEST_ASSERT_TRUE(rehearsals > options.count / 4U);
}

/* True when the planner has come to a rehearsal that searches from the robot. */
static bool work_into_forward_rehearsal(void)
{
    const struct jp_planner_internal *internal = &trial.planner.internal;

    while (!jp_planner_is_idle(&trial.planner)) {
        if (jp_rehearsal_is_on(internal) && internal->search.direction == JP_PLANNER_FROM_ROBOT) {
            return true;
        }
        (void)jp_planner_work(&trial.planner, 1);
    }
    return false;
}

/* What such a rehearsal has begun with is gone when the robot drives on: the plan goes on. */
static void test_robot_drives_on_during_rehearsals(void)
{
    unsigned drives = 0;

    begin_random(options.seed, 3);
    for (unsigned long i = 0; i < options.count; i++) {
        random_trial(&trial, 0);
        struct jp_lattice_pose pose = trial.start;
        if (!work_into_forward_rehearsal() || jp_planner_step(&trial.planner, 0, &pose) == NULL) {
            continue;
        }
        TEST_ASSERT_TRUE(put_start(&trial, pose));
        const enum jp_answer answer = work_to_end();
        const double optimum = oracle_shortest(&oracle, &trial.map, &trial.start, &trial.goal);
        TEST_ASSERT_TRUE_MESSAGE(is_right(&trial, answer, optimum), problem);
        drives++;
    }
    printf("%u drives\n", drives);
    TEST_ASSERT_TRUE(drives > 0);
}

static void add_figures(json_t *figures)
{
    figures_add(figures, COMMAND, (double)dearer, "", equal_to(0),
                "planner: dearer plans in blocks of twice the memory, of %lu pairs", pairs);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
