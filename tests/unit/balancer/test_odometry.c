/* Odometry: straight, circle, turning in place, wraps, limits. */
#include <joulepath/odometry.h>

#include "unity.h"

#define METRE ((int64_t)1 << 32)

static struct jp_odometry odometry;
static struct jp_motion_state state;

void setUp(void)
{
    state = (struct jp_motion_state){0};
    jp_odometry_start(&odometry, JP_Q24(0.5), &state);
}

void tearDown(void)
{
}

static void move(int64_t wheel, int64_t yaw)
{
    state.wheel += (jp_phase)wheel;
    state.yaw += (jp_phase)yaw;
    jp_odometry_update(&odometry, &state);
}

static const int64_t turn = (int64_t)JP_PHASE_TURN;

static void test_straight_along_x(void)
{
    for (int i = 0; i < 1024; i++) {
        move(turn / 256, 0);
    }
    TEST_ASSERT_INT64_WITHIN(1024 * 8, 2 * METRE, odometry.x);
    TEST_ASSERT_EQUAL_INT64(0, odometry.y);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2), jp_odometry_position(&odometry).x);
    for (int i = 0; i < 1024; i++) {
        move(-turn / 256, 0);
    }
    TEST_ASSERT_INT64_WITHIN(1024 * 8, 0, odometry.x);
}

static void test_left_is_along_y(void)
{
    move(0, turn / 4);
    TEST_ASSERT_EQUAL_INT64(0, odometry.x);
    move(turn / 16, 0);
    TEST_ASSERT_INT64_WITHIN(8, 0, odometry.x);
    TEST_ASSERT_INT64_WITHIN(32, METRE / 32, odometry.y);
}

static void test_the_mean_heading_of_a_tick_counts(void)
{
    move(turn / 16, turn / 2 - turn / 128); /* along nearly y */
    TEST_ASSERT_GREATER_THAN_INT64(METRE / 32 - METRE / 1000, odometry.y);

    setUp();
    move(turn / 16, -(turn / 2 - turn / 128));
    TEST_ASSERT_LESS_THAN_INT64(-METRE / 32 + METRE / 1000, odometry.y);
}

static void test_circle_closes(void)
{
    for (int i = 0; i < 4096; i++) {
        move(turn / 1024, turn / 4096);
    }
    TEST_ASSERT_INT64_WITHIN(METRE / 100000, 0, odometry.x);
    TEST_ASSERT_INT64_WITHIN(METRE / 100000, 0, odometry.y);
    TEST_ASSERT_EQUAL_HEX32(0, odometry.heading);
}

static void test_start_angles_do_not_matter(void)
{
    struct jp_odometry expected;

    for (int i = 0; i < 500; i++) {
        move(turn / 300, turn / 1000);
    }
    expected = odometry;
    state = (struct jp_motion_state){.wheel = (jp_phase)0 - JP_PHASE_TURN, .yaw = 0};
    state.wheel -= 3 * JP_PHASE_TURN;
    state.yaw -= 256 * (JP_PHASE_TURN - 1) + 256; /* whole turns through the 64-bit wrap */
    jp_odometry_start(&odometry, JP_Q24(0.5), &state);
    for (int i = 0; i < 500; i++) {
        move(turn / 300, turn / 1000);
    }
    TEST_ASSERT_EQUAL_INT64(expected.x, odometry.x);
    TEST_ASSERT_EQUAL_INT64(expected.y, odometry.y);
}

static void test_way_of_a_tick_is_limited(void)
{
    jp_odometry_start(&odometry, JP_Q24(4), &state);
    move(-turn / 8, 0);
    TEST_ASSERT_INT64_WITHIN(8, -METRE / 2, odometry.x);
    move(-turn / 4, 0);
    TEST_ASSERT_INT64_WITHIN(8, -METRE, odometry.x);
    move(turn / 8, 0); /* 2⁻³² turn too much */
    TEST_ASSERT_INT64_WITHIN(16, -METRE / 2, odometry.x);
    move(turn / 4, 0);
    TEST_ASSERT_INT64_WITHIN(16, 0, odometry.x);
}

static void test_position_saturates(void)
{
    odometry.x = 40000 * METRE;
    odometry.y = -40000 * METRE;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_odometry_position(&odometry).x);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_odometry_position(&odometry).y);
    odometry.x = 32768;
    odometry.y = -32769;
    TEST_ASSERT_EQUAL_INT32(1, jp_odometry_position(&odometry).x);
    TEST_ASSERT_EQUAL_INT32(-1, jp_odometry_position(&odometry).y);
}

static void test_standing_does_not_drift(void)
{
    move(turn / 10, turn / 10);

    struct jp_odometry before = odometry;

    for (int i = 0; i < 10000; i++) {
        move(0, 0);
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &odometry, sizeof before);
}
