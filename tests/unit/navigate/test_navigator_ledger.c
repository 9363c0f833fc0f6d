/* What drives of the navigator take beyond their first courses: a new robot's belief, and what it learns of each. */
#include "src/navigate/navigator_ledger.h"
#include "tests/support/navigator_rig.h"
#include "tests/target/random.h"

/* Of the fake's forecasts: two joules a leg, ± ¼ J; from (4, 4) to (18, 4) it is one leg. */
#define LEG       JP_Q16(2)
#define DEVIATION JP_Q16(0.25)

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static struct jp_forecast left(void)
{
    struct jp_progress progress;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_navigator_progress(&navigator, &progress));
    return progress.energy;
}

/* Until it has a course. */
static void go(int16_t x, jp_q16 a_slice)
{
    robot.takes = a_slice;
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(x, 4, JP_ANY_HEADING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
}

/* J from its first course to the goal. */
static jp_q16 taken_by_drive(int16_t x, jp_q16 a_slice)
{
    go(x, a_slice);

    const uint32_t before = (uint32_t)robot.view.spent;

    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    return (jp_q16)((uint32_t)robot.view.spent - before);
}

static void test_a_new_robot_expects_its_course_and_is_not_sure(void)
{
    init();
    TEST_ASSERT_EQUAL_UINT16(0, navigator.stand.stands);
    go(18, 0);
    TEST_ASSERT_EQUAL_INT32(LEG, left().energy);
    TEST_ASSERT_EQUAL_INT32(0, navigator.stand.mean);
    TEST_ASSERT_EQUAL_INT32(LEG / 20, navigator.stand.deviation);
    /* Of one stand, as its mean is known by one: √2 of it, beside the forecast's own. */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(0.287228), left().deviation);
}

/* The mean of what it believed first and of the drive, which were a stand each. Also where the meter overflows. */
static void test_it_learns_what_a_drive_takes(void)
{
    const jp_q16 starts[] = {0, JP_Q16(123), INT32_MAX - JP_Q16(3)};

    for (unsigned i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        setUp();
        init();
        robot.view.spent = starts[i];

        const jp_q16 more = taken_by_drive(18, JP_Q16(0.1)) - LEG;

        TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(5), more);
        TEST_ASSERT_INT32_WITHIN(2, more / 2, navigator.stand.mean);
        /* Half the variance of before, and of the innovation, half of which was the mean's. */
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), more / 2, navigator.stand.deviation);
        TEST_ASSERT_EQUAL_UINT16(2, navigator.stand.stands);
        TEST_ASSERT_EQUAL_UINT16(2, navigator.stand.drives);
    }
}

/* The same drive again and again: so its forecast becomes what it takes, and surer. */
static void test_forecasts_become_what_drives_take(void)
{
    struct jp_forecast early;
    jp_q16 taken = 0;

    init();
    (void)taken_by_drive(18, JP_Q16(0.06));
    go(4, JP_Q16(0.06));
    early = left();
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    for (unsigned i = 0; i < 100; i++) {
        taken = taken_by_drive(i % 2 == 0 ? 18 : 4, JP_Q16(0.06));
    }
    TEST_ASSERT_EQUAL_UINT16(64, navigator.stand.stands);
    TEST_ASSERT_EQUAL_UINT16(15, navigator.stand.drives);
    go(18, JP_Q16(0.06));
    TEST_ASSERT_INT32_WITHIN(taken / 50, taken, left().energy);
    TEST_ASSERT_GREATER_THAN_INT32(taken / 10, taken - early.energy);
    TEST_ASSERT_LESS_THAN_INT32(early.deviation / 2, left().deviation);
}

/* By drives that differ: the deviation is theirs. */
static void test_the_deviation_is_that_of_drives(void)
{
    uint32_t state = 20261127;
    double sum = 0;
    double squares = 0;

    init();
    for (unsigned i = 0; i < 200; i++) {
        const jp_q16 a_slice = JP_Q16(0.05) + (jp_q16)(target_random(&state) % (uint32_t)JP_Q16(0.02));
        const double taken = (double)taken_by_drive(i % 2 == 0 ? 18 : 4, a_slice) / JP_Q16_ONE;

        sum += taken;
        squares += taken * taken;
    }
    const double mean = sum / 200;
    const double variance = squares / 200 - mean * mean;
    const double told = (double)navigator.stand.deviation / JP_Q16_ONE;

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.3), (jp_q16)((mean - 2) * JP_Q16_ONE), navigator.stand.mean);
    TEST_ASSERT_TRUE(told * told > 0.25 * variance && told * told < 2.25 * variance);
}

/* ---- One drive of any robot ---- */

/* At random, at most this. */
static jp_q16 up_to(uint32_t *state, jp_q16 most)
{
    return (jp_q16)(target_random(state) % ((uint32_t)most + 1U));
}

static struct jp_stand_energy any_stand(uint32_t *state)
{
    return (struct jp_stand_energy){up_to(state, JP_Q16(20)) - JP_Q16(10), up_to(state, JP_Q16(5)),
                                    (uint16_t)(1U + target_random(state) % 64U),
                                    (uint16_t)(1U + target_random(state) % 15U)};
}

/* A drive whose first course had so many stands, and that took so much more or less than it was forecast to take. */
static void end_drive_of(uint16_t stands, jp_q16 forecast, jp_q16 taken)
{
    navigator.internal.drive = (struct jp_navigator_drive){forecast, robot.view.spent, stands};
    robot.view.spent = (jp_q16)((uint32_t)robot.view.spent + (uint32_t)taken);
    jp_ledger_end(&navigator);
}

/* A root of whole numbers, rounded once or twice on the way. */
static void expect_root(double square, jp_q16 root)
{
    const double low = root > 2 ? (double)root - 2 : 0;
    const double high = (double)root + 2;

    TEST_ASSERT_TRUE(low * low <= square && square <= high * high);
}

/* The mean moves by the new stands' part of all that it is known by then; the variance of one stand is the mean of the
 * drives', and a drive's is what it was off by, squared, as the sum of its stands and the error of the mean explain it.
 */
static void test_each_drive_moves_mean_and_variance_by_its_weight(void)
{
    uint32_t state = 7;

    init();
    for (unsigned i = 0; i < 300; i++) {
        const struct jp_stand_energy before = any_stand(&state);
        const uint16_t stands = (uint16_t)(1U + target_random(&state) % (i % 2U == 0U ? 4U : 400U));
        const jp_q16 forecast = up_to(&state, JP_Q16(2000));
        const jp_q16 taken = 1 + up_to(&state, JP_Q16(2000));
        const double known = before.stands;
        const double off = (double)taken - forecast - (double)stands * before.mean;
        const double of_drive = off * off * known / (stands * (known + stands));
        const double variance = (double)before.deviation * before.deviation;

        navigator.stand = before;
        end_drive_of(stands, forecast, taken);
        TEST_ASSERT_INT32_WITHIN(1, (jp_q16)(before.mean + off / (known + stands)), navigator.stand.mean);
        expect_root((variance * before.drives + of_drive) / (before.drives + 1), navigator.stand.deviation);
        TEST_ASSERT_EQUAL_UINT16(before.stands + stands < 64 ? before.stands + stands : 64, navigator.stand.stands);
        TEST_ASSERT_EQUAL_UINT16(before.drives < 15 ? before.drives + 1 : 15, navigator.stand.drives);
    }
}

/* However little a vehicle counts: it does. */
static void test_the_least_that_is_counted_teaches(void)
{
    for (jp_q16 taken = -1; taken <= 1; taken++) {
        init();
        navigator.stand = (struct jp_stand_energy){JP_Q16(1), JP_Q16(1), 2, 1};
        end_drive_of(1, JP_Q16(1), taken);
        TEST_ASSERT_EQUAL_UINT16(taken > 0 ? 2 : 1, navigator.stand.drives);
    }
}

/* ---- What is left ---- */

static void test_what_is_left_falls_with_the_stands(void)
{
    init();
    put_column(12, 0, 14, JP_CELL_OCCUPIED);
    navigator.stand = (struct jp_stand_energy){JP_Q16(10), JP_Q16(0.5), 64, 15};
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(19, 4, JP_ANY_HEADING));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));

    jp_q16 before = left().energy;
    const jp_q16 at_first = before;

    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(12), before);
    while (navigator.state == JP_NAVIGATOR_TURNING || navigator.state == JP_NAVIGATOR_DRIVING) {
        TEST_ASSERT_LESS_OR_EQUAL_INT32(before + JP_Q16(0.1), left().energy);
        before = left().energy;
        (void)jp_navigator_work(&navigator);
    }
    TEST_ASSERT_EQUAL_INT(JP_NAVIGATOR_ARRIVED, navigator.state);
    TEST_ASSERT_LESS_THAN_INT32(at_first / 10, before);
}

static void test_a_drive_that_does_not_arrive_teaches_nothing(void)
{
    init();
    go(18, JP_Q16(1));

    const struct jp_stand_energy before = navigator.stand;

    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    jp_navigator_stop(&navigator);
    for (unsigned i = 0; i < 20; i++) {
        (void)jp_navigator_work(&navigator);
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &navigator.stand, sizeof before);
    /* Nor does it count for the next one. */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(2), taken_by_drive(4, JP_Q16(0.01)) / 2, navigator.stand.mean + LEG);
}

/* A goal where it is has no course, nor has a turn there. */
static void test_a_goal_on_the_spot_teaches_nothing(void)
{
    init();
    robot.takes = JP_Q16(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, go_to(4, 4, 1U << 4));
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_TURNING));
    TEST_ASSERT_EQUAL_INT32(0, left().energy);
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_UINT16(0, navigator.stand.stands);
}

/* As a vehicle that does not count looks, and one whose count was set back. */
static void test_a_drive_that_takes_nothing_teaches_nothing(void)
{
    struct jp_stand_energy before;

    init();
    go(18, 0);
    before = navigator.stand;
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_MEMORY(&before, &navigator.stand, sizeof before);
    robot.view.spent = JP_Q16(500);
    go(4, 0);
    robot.view.spent = 0;
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_EQUAL_MEMORY(&before, &navigator.stand, sizeof before);
}

/* What it forecast before it saw what is in its way: that is what a drive takes more than. */
static void test_of_a_drive_that_is_planned_anew_the_first_course_counts(void)
{
    init();
    go(18, JP_Q16(0.06));

    const jp_q16 before = robot.view.spent;

    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_DRIVING));
    for (int32_t y = 1; y < 8; y++) {
        occupy(12, y);
    }
    TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
    TEST_ASSERT_GREATER_THAN_UINT16(0, navigator.replans);
    TEST_ASSERT_INT32_WITHIN(2, (robot.view.spent - before - LEG) / 2, navigator.stand.mean);
}

/* Stands that take less than a turn was thought to: nothing is left of what would be below nothing. */
static void test_less_than_nothing_is_nothing(void)
{
    init();
    go(18, 0);
    for (jp_q16 sum = -3; sum <= 3; sum++) {
        navigator.stand = (struct jp_stand_energy){sum - LEG, JP_Q16(0.1), 64, 15};
        TEST_ASSERT_EQUAL_INT32(sum > 0 ? sum : 0, left().energy);
    }
    navigator.stand.mean = JP_Q16(-30);
    TEST_ASSERT_EQUAL_INT32(0, left().energy);
}

/* Energies at the end of their format. */
static void test_extremes(void)
{
    const jp_q16 extremes[] = {INT32_MIN, -1, 0, 1, INT32_MAX};

    for (unsigned i = 0; i < sizeof extremes / sizeof extremes[0]; i++) {
        for (uint16_t stands = 1; stands <= 64; stands = (uint16_t)(stands + 63U)) {
            setUp();
            init();
            navigator.stand = (struct jp_stand_energy){extremes[i], INT32_MAX, stands, 15};
            go(18, JP_Q16(300));
            TEST_ASSERT_TRUE(left().energy >= 0 && left().deviation > 0);
            TEST_ASSERT_TRUE(work_until(JP_NAVIGATOR_ARRIVED));
            TEST_ASSERT_TRUE(navigator.stand.deviation >= 0);
        }
    }
}
