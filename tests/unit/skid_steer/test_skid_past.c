/* What is learned of bias and scale moves the pose as if it had been known before: against the way driven anew, in
 * double precision. */
#include "src/skid_steer/skid_arithmetic.h"
#include "src/skid_steer/skid_past.h"
#include "tests/support/random.h"
#include "unity.h"

#define IN_Q24 16777216.0
#define IN_Q30 1073741824.0
#define IN_Q32 4294967296.0
#define TWO_PI 6.283185307179586

#define STEPS 400

static struct jp_skid_odometry odometry;

void setUp(void)
{
    odometry = (struct jp_skid_odometry){.internal = {.is_moving = true}};
    begin_random(17, 0);
}

void tearDown(void)
{
}

/** How the pose moves by a turn that every heading before was wrong by: m by turn and by 1, and turns. */
struct lever {
    double x;
    double y;
    double turn;
};

/** Sums of a drive whose headings are wrong by the steps so far, and by what the gyro has turned so far. */
static struct lever by_bias;
static struct lever by_scale;

/** A drive of random steps, in which nothing is learned. */
static void drive(void)
{
    struct jp_skid_step *step = &odometry.internal.step;

    by_bias = (struct lever){0};
    by_scale = (struct lever){0};
    for (int i = 0; i < STEPS; i++) {
        step->way_x = (int32_t)uniform(-2e8, 4e8);
        step->way_y = (int32_t)uniform(-1e8, 4e8);
        const int32_t turned = (int32_t)uniform(-0.01 * IN_Q24, 0.02 * IN_Q24);

        by_bias.x += TWO_PI * by_bias.turn * step->way_y / IN_Q32;
        by_bias.y -= TWO_PI * by_bias.turn * step->way_x / IN_Q32;
        odometry.internal.past.turned += turned;
        by_scale.turn = odometry.internal.past.turned / IN_Q24;
        by_scale.x -= TWO_PI * by_scale.turn * step->way_y / IN_Q32;
        by_scale.y += TWO_PI * by_scale.turn * step->way_x / IN_Q32;
        jp_skid_past_correct(&odometry);
        by_bias.turn += 1;
    }
    TEST_ASSERT_EQUAL_INT64(0, odometry.x);
    TEST_ASSERT_EQUAL_INT64(0, odometry.y);
    TEST_ASSERT_TRUE(odometry.heading == 0);
}

/** Within 0.1 %. */
static void expect_near(double expected, int64_t actual)
{
    const int64_t size = (int64_t)(expected < 0 ? -expected : expected);

    TEST_ASSERT_TRUE(size > 1000000);
    TEST_ASSERT_INT64_WITHIN(size / 1000, (int64_t)expected, actual);
}

/** The next step has learned so much: each heading was wrong by it. */
static void expect_correction(int32_t bias_change, int32_t scale_change)
{
    const double bias = bias_change / IN_Q30 / 1024; /* turn in a step */
    const double scale = scale_change / IN_Q30;

    drive();
    odometry.internal.gyro.bias_change = bias_change;
    odometry.internal.gyro.scale_change = scale_change;
    jp_skid_past_correct(&odometry);
    expect_near((by_bias.x * bias + by_scale.x * scale) * IN_Q32, odometry.x);
    expect_near((by_bias.y * bias + by_scale.y * scale) * IN_Q32, odometry.y);
    expect_near((by_scale.turn * scale - by_bias.turn * bias) * (double)JP_PHASE_TURN, (int64_t)odometry.heading);
}

static void test_a_bias_that_is_learned_was_there_from_the_start(void)
{
    expect_correction(2000000, 0);
    setUp();
    expect_correction(-3000000, 0);
}

static void test_a_scale_that_is_learned_was_there_from_the_start(void)
{
    expect_correction(0, JP_SKID_ONE / 200);
    setUp();
    expect_correction(0, -JP_SKID_ONE / 100);
}

static void test_both_are_learned_at_once(void)
{
    expect_correction(2000000, JP_SKID_ONE / 50);
}

/* Of 2¹⁷ steps as many are forgotten as come; a quarter of that forgets a quarter of each. */
static void test_steps_of_long_ago_count_less(void)
{
    odometry.internal.past.steps = ((int32_t)1 << 17) * 256;
    jp_skid_past_correct(&odometry);
    TEST_ASSERT_EQUAL_INT32(((int32_t)1 << 17) * 256, odometry.internal.past.steps);
    odometry.internal.past.steps = ((int32_t)1 << 15) * 256;
    jp_skid_past_correct(&odometry);
    TEST_ASSERT_EQUAL_INT32(((int32_t)1 << 15) * 256 + 192, odometry.internal.past.steps);
}

/* Way and turn of either sign. */
static void test_it_adds_up_what_was_driven(void)
{
    for (int i = 0; i < 8; i++) {
        odometry.internal.step.way = (i % 2 == 0 ? 1 : -1) * ((int32_t)3 << 24);
        odometry.internal.step.turn = (i < 4 ? 1 : -1) * ((int32_t)5 << 20);
        jp_skid_past_correct(&odometry);
    }
    TEST_ASSERT_EQUAL_INT32(8 * (3 << 8), odometry.internal.past.way);
    TEST_ASSERT_EQUAL_INT32(8 * (5 << 4), odometry.internal.past.turn);
}

/* It still learns the bias, which corrects what was driven before. */
static void test_a_stand_is_no_part_of_the_past(void)
{
    drive();
    const struct jp_skid_past before = odometry.internal.past;

    odometry.internal.is_moving = false;
    odometry.internal.gyro.bias_change = 1000000;
    jp_skid_past_correct(&odometry);
    TEST_ASSERT_EQUAL_MEMORY(&before, &odometry.internal.past, sizeof before);
    TEST_ASSERT_TRUE(odometry.x != 0);
    TEST_ASSERT_TRUE(odometry.y != 0);
    TEST_ASSERT_TRUE(odometry.heading != 0);
}
