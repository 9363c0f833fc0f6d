/* The way back to the path: nothing on it, the first steps beside it, the lead where it bends, limits, wraps and
 * extremes. */
#include "src/balancer/path_error.h"

#include <joulepath/tables.h>

#include "unity.h"

static struct jp_trajectory_config config;
static struct jp_reference reference;
static struct jp_path_error error;
static struct jp_motion_state motion;

static void begin(jp_phase wheel, jp_phase yaw)
{
    jp_reference_start(&reference, &jp_robot_gao2018.reference, wheel, yaw);
    jp_path_error_start(&error);
    motion = (struct jp_motion_state){.wheel = wheel, .yaw = yaw};
}

void setUp(void)
{
    config = jp_robot_gao2018.trajectory;
    begin(0, 0);
}

void tearDown(void)
{
}

static jp_q24 turns(jp_phase phase)
{
    return jp_phase_difference(phase, 0);
}

/* With a robot that is `lead` ahead of the reference. */
static void drive(unsigned set_points, jp_q24 wheel_rate, jp_q24 yaw_rate, jp_q24 lead)
{
    const struct jp_set_point at = {.wheel_rate = wheel_rate, .yaw_rate = yaw_rate};

    motion.wheel_rate = wheel_rate;
    for (unsigned i = 0; i < set_points; i++) {
        for (unsigned k = 0; k < JP_TICKS_PER_SET_POINT; k++) {
            jp_reference_track(&reference, &at);
        }
        motion.wheel = reference.wheel.angle + ((jp_phase)lead << 32);
        motion.yaw = reference.yaw.angle;
        jp_path_error_correct(&error, &config, &at, &motion, &reference);
    }
}

static void test_on_the_path_nothing_changes(void)
{
    drive(500, JP_Q24(1), JP_Q24(0.1), 0);
    TEST_ASSERT_EQUAL_UINT64(0, error.across);
    TEST_ASSERT_EQUAL_UINT64(0, error.along);
    TEST_ASSERT_EQUAL_UINT64(0, error.turned);
    TEST_ASSERT_EQUAL_UINT64(motion.wheel, reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64(motion.yaw, reference.yaw.angle);
}

/* A quarter turn to the left by one that is a tenth of a wheel's turn late: so much to its left, and as much behind
 * less. */
static void test_who_is_late_turns_at_another_place(void)
{
    config.steering = 0;
    drive(500, JP_Q24(1), JP_Q24(0.25), -JP_Q24(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0005), JP_Q24(0.1), turns(error.across));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0005), JP_Q24(0.1), turns(error.along));
    TEST_ASSERT_EQUAL_UINT64(0, error.turned);
}

/* To the right of one that stands to the left, and back along it. */
static void test_turns_and_rolls_back(void)
{
    const jp_q24 aim = jp_q24_multiply(config.aim, JP_Q24(0.1));

    error.across = JP_PHASE_TURN / 10;
    error.along = JP_PHASE_TURN / 10;
    drive(1, 0, 0, 0);
    TEST_ASSERT_INT32_WITHIN(1, -jp_multiply_shift(config.steering, aim, 32), turns(error.turned));
    TEST_ASSERT_INT32_WITHIN(1, -jp_multiply_shift(config.steering, JP_Q24(0.1), 32), turns(reference.wheel.angle));
    TEST_ASSERT_EQUAL_UINT64(error.turned, reference.yaw.angle);
    TEST_ASSERT_INT32_WITHIN(1, JP_Q24(0.1) - jp_multiply_shift(config.steering, JP_Q24(0.1), 32), turns(error.along));
}

/* An eighth of a turn for each of the wheels, to the left or to the right. */
static jp_q24 bend_until(jp_q24 wheel_lead, int side)
{
    return side * (wheel_lead + turns(error.along)) / 8;
}

/* A tenth of a wheel's turn further than the set-point, and what it is ahead by curves until then. */
static void test_who_is_early_leads_where_the_path_bends(void)
{
    jp_path_error_begin_leg(&error, JP_Q24(2));
    drive(500, JP_Q24(2), JP_Q24(0.25), JP_Q24(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), bend_until(JP_Q24(0.1), 1), turns(error.lead));
    drive(500, JP_Q24(2), JP_Q24(-0.25), JP_Q24(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), bend_until(JP_Q24(0.1), -1), turns(error.lead));
    drive(500, JP_Q24(2), 0, JP_Q24(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), 0, turns(error.lead));
}

/* Backwards a robot that is further on has a lower wheel angle. */
static void test_leads_backwards_too(void)
{
    jp_path_error_begin_leg(&error, -JP_Q24(2));
    drive(500, -JP_Q24(2), JP_Q24(0.25), -JP_Q24(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), bend_until(-JP_Q24(0.1), -1), turns(error.lead));
}

/* The reference turns with the lead, and the controller with the reference. */
static void test_the_reference_turns_by_the_lead(void)
{
    const jp_q24 path = JP_Q24(0.25 * 500 * JP_TICKS_PER_SET_POINT / 1000);

    jp_path_error_begin_leg(&error, JP_Q24(2));
    drive(500, JP_Q24(2), JP_Q24(0.25), JP_Q24(0.1));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), path + turns(error.turned), turns(reference.yaw.angle));
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q24(0.01), turns(error.lead));
}

/* A leg whose middle stands leads nowhere. */
static void test_no_lead_where_nothing_moves(void)
{
    const jp_turns_per_s rates[] = {0, 1, 1023};

    for (unsigned i = 0; i < sizeof rates / sizeof *rates; i++) {
        jp_path_error_begin_leg(&error, rates[i]);
        drive(100, JP_Q24(1), JP_Q24(0.25), JP_Q24(0.1));
        TEST_ASSERT_EQUAL_UINT64(0, error.lead);
        TEST_ASSERT_EQUAL_INT32(0, reference.yaw_lead);
    }
}

/* However far ahead. */
static void test_no_lead_before_a_leg_begins(void)
{
    error.cruise = JP_Q24(2);
    begin(0, 0);
    drive(100, JP_Q24(1), JP_Q24(0.25), JP_Q24(100));
    TEST_ASSERT_EQUAL_UINT64(0, error.lead);
}

/* It takes the steering to turn. */
static void test_no_lead_without_steering(void)
{
    config.steering = 0;
    jp_path_error_begin_leg(&error, JP_Q24(1));
    drive(1, JP_Q24(1), JP_Q24(0.25), JP_Q24(100));
    TEST_ASSERT_EQUAL_INT32(0, reference.yaw_lead);
}

/* What it is ahead, turned by a path's turn, is beside the path: by 2π to a part in a thousand millions. */
static void test_radians_are_exact(void)
{
    const struct jp_set_point at = {.yaw_rate = -JP_Q24(1)};

    config.steering = 0;
    reference.phase_per_rate = 160000000; /* a tick of 1/27 s; × 4π: 2 010 619 298.3 */
    motion.wheel = JP_PHASE_TURN;
    jp_path_error_correct(&error, &config, &at, &motion, &reference);
    TEST_ASSERT_EQUAL_INT64((int64_t)2010619298 * JP_Q24_ONE, (int64_t)error.across);
}

/* 1/8 turn, however far ahead; and never turns faster with it than the robot may. */
static void test_the_lead_is_limited(void)
{
    for (int side = -1; side <= 1; side += 2) {
        begin(0, 0);
        jp_path_error_begin_leg(&error, JP_Q24(0.1));
        for (int i = 0; i < 2000; i++) {
            drive(1, JP_Q24(0.1), JP_Q24(0.3), side * JP_Q24(50));
            TEST_ASSERT_LESS_OR_EQUAL_INT32(config.turn_rate, JP_Q24(0.3) + side * reference.yaw_lead);
        }
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), side * JP_Q24(0.125), turns(error.lead));
    }
}

static void test_wraps_change_nothing(void)
{
    struct jp_path_error expected;

    drive(2000, JP_Q24(1.3), JP_Q24(0.2), -JP_Q24(0.15));
    expected = error;
    begin((jp_phase)-1000, JP_PHASE_TURN * 127);
    drive(2000, JP_Q24(1.3), JP_Q24(0.2), -JP_Q24(0.15));
    TEST_ASSERT_EQUAL_MEMORY(&expected, &error, sizeof error);
}

/* 1/32 turn, however far. */
static void test_the_aim_is_limited(void)
{
    for (int side = -1; side <= 1; side += 2) {
        begin(0, 0);
        error.across = side < 0 ? 0U - 100U * JP_PHASE_TURN : 100U * JP_PHASE_TURN;
        drive(5000, JP_Q24(1.3), 0, 0);
        TEST_ASSERT_INT32_WITHIN(20, -side * JP_Q24(1.0 / 32), turns(error.turned));
        TEST_ASSERT_LESS_THAN_INT32(JP_Q24(100), side * turns(error.across));
        TEST_ASSERT_GREATER_THAN_INT32(JP_Q24(90), side * turns(error.across));
    }
}

/* Products that leave their format saturate: the aim keeps its limit. */
static void test_extremes_do_not_overflow(void)
{
    const struct jp_set_point at = {.wheel_rate = INT32_MAX, .yaw_rate = INT32_MIN};

    config.steering = (int32_t)1 << 30;
    config.aim = JP_Q24(16);
    motion.wheel_rate = INT32_MAX;
    motion.wheel = (jp_phase)INT32_MAX << 32;
    motion.yaw = JP_PHASE_TURN * 128;
    for (int i = 0; i < 100; i++) {
        error.across = JP_PHASE_TURN * 127;
        error.along = 0U - JP_PHASE_TURN * 128;
        jp_path_error_correct(&error, &config, &at, &motion, &reference);
    }
    TEST_ASSERT_INT32_WITHIN(1, -JP_Q24(1.0 / 32), turns(error.turned));
}
