/* Four steered wheels: the check, motions worked out by hand, flips and limits, and the ticks. */
#include <joulepath/four_wheel.h>
#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define DEGREES(x)      ((int32_t)JP_ANGLE_DEGREES(x))
#define ANGLE_TOLERANCE 400 /* 2⁻³² turn: one unit of the contacts' format at 0.1 m/s */
#define SPEED_TOLERANCE 2   /* 2⁻²⁴ m/s */

/* A 3-4-5 triangle: the contacts are 0.5 m from the centre, at 36.87° to the side. */
static const struct jp_four_wheel_config robot = {
    .wheelbase = JP_Q24(0.6),
    .track = JP_Q24(0.8),
    .steering_limit = DEGREES(100),
    .steering_step = DEGREES(2),
    .speed_max = JP_Q24(4),
    .speed_step = JP_Q24(0.05),
};

#define IN_PLACE_ANGLE DEGREES(36.86989765)

static struct jp_four_wheel_config config;
static const struct jp_wheels at_rest = {{0}, {0}};

void setUp(void)
{
}

void tearDown(void)
{
}

/* The check */

DEFINE_EXPECT_CONFIG_OF(jp_four_wheel_check, robot)

static void test_check_names_each_field_at_both_limits(void)
{
    config = robot;
    expect_config(NULL);
    RANGE("", wheelbase, JP_Q24(0.05), JP_Q24(4));
    RANGE("", track, JP_Q24(0.05), JP_Q24(4));
    RANGE("", steering_step, DEGREES(0.05), DEGREES(120));
    RANGE("", speed_max, JP_Q24(0.01), JP_Q24(16));
    RANGE("", speed_step, JP_WHEEL_HOLD_SPEED, JP_Q24(16));
    RANGE("", steering_limit, (int32_t)jp_atan2(robot.wheelbase, robot.track) - JP_ATAN2_ERROR, DEGREES(120));
}

/* No angle of the steering is computed of lengths that are none. */
static void test_check_of_lengths_without_an_angle(void)
{
    const char *field = "none";

    config = robot;
    config.wheelbase = 0;
    config.track = -1;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_four_wheel_check(&config, &field));
    TEST_ASSERT_EQUAL_STRING("wheelbase", field);
    config.wheelbase = INT32_MIN;
    config.track = INT32_MIN;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_four_wheel_check(&config, &field));
    TEST_ASSERT_EQUAL_STRING("wheelbase", field);
}

static void test_check_wants_pointers(void)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_check(&robot, NULL));
}

/* The least radius and the two-wheel model */

static jp_q24 radius_at(int32_t limit)
{
    config = robot;
    config.steering_limit = limit;
    return jp_four_wheel_radius_min(&config);
}

/* 0.4 + 0.3/tan(limit) */
static void test_least_radius(void)
{
    TEST_ASSERT_EQUAL_INT32(0, radius_at(DEGREES(90)));
    TEST_ASSERT_EQUAL_INT32(0, radius_at(DEGREES(120)));
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(0.7), radius_at(DEGREES(45)));
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(0.8), radius_at(IN_PLACE_ANGLE));
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(0.4), radius_at(DEGREES(90) - 1));
}

static void expect_two_wheels(jp_q24 speed, int32_t angle, jp_q24 turn_rate)
{
    struct jp_twist twist = {1, 1, 1};
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_four_wheel_twist(&robot, speed, angle, &twist));
    TEST_ASSERT_EQUAL_INT32(speed, twist.x);
    TEST_ASSERT_EQUAL_INT32(0, twist.y);
    TEST_ASSERT_INT32_WITHIN(4, turn_rate, twist.turn_rate);
}

/* 2 v tan(δ)/0.6 */
static void test_two_wheel_model(void)
{
    expect_two_wheels(JP_Q24(1), 0, 0);
    expect_two_wheels(JP_Q24(0.6), DEGREES(45), JP_Q24(2));
    expect_two_wheels(JP_Q24(0.6), DEGREES(-45), JP_Q24(-2));
    expect_two_wheels(JP_Q24(-0.6), DEGREES(45), JP_Q24(-2));
    expect_two_wheels(0, DEGREES(45), 0);
}

static void test_two_wheel_model_saturates(void)
{
    struct jp_twist twist;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_four_wheel_twist(&robot, JP_Q24(16), DEGREES(89), &twist));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, twist.turn_rate);
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, jp_four_wheel_twist(&robot, JP_Q24(-16), DEGREES(89), &twist));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, twist.turn_rate);
}

static void test_two_wheel_model_refuses(void)
{
    struct jp_twist twist = {7, 7, 7};
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_twist(NULL, 0, 0, &twist));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, 0, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, JP_Q24(16) + 1, 0, &twist));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, -JP_Q24(16) - 1, 0, &twist));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, 0, DEGREES(90), &twist));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, 0, DEGREES(-90), &twist));
    TEST_ASSERT_EQUAL_INT32(7, twist.x);
    TEST_ASSERT_EQUAL_INT32(7, twist.turn_rate);
}

/* Inverse */

static struct jp_wheels inverse_from(struct jp_wheels wheels, struct jp_twist twist)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_four_wheel_inverse(&robot, &twist, &wheels));
    return wheels;
}

static void expect_wheel(const struct jp_wheels *wheels, int wheel, int32_t angle, jp_q24 speed)
{
    TEST_ASSERT_INT32_WITHIN(ANGLE_TOLERANCE, angle, wheels->angle[wheel]);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, speed, wheels->speed[wheel]);
}

static void expect_all(const struct jp_wheels *wheels, int32_t angle, jp_q24 speed)
{
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        expect_wheel(wheels, wheel, angle, speed);
    }
}

static void test_straight(void)
{
    const struct jp_wheels ahead = inverse_from(at_rest, (struct jp_twist){.x = JP_Q24(1)});
    const struct jp_wheels back = inverse_from(at_rest, (struct jp_twist){.x = JP_Q24(-1)});
    expect_all(&ahead, 0, JP_Q24(1));
    expect_all(&back, 0, JP_Q24(-1));
}

/* To the left: a quarter turn either way is equally far, and rolling forward is taken. */
static void test_sideways(void)
{
    const struct jp_wheels wheels = inverse_from(at_rest, (struct jp_twist){.y = JP_Q24(0.5)});
    expect_all(&wheels, DEGREES(90), JP_Q24(0.5));
}

/* Radius 0.8 m to the left: the inner contacts move at (0.4, ±0.3) per rad/s, the outer ones at (1.2, ±0.3). */
static void test_left_turn(void)
{
    const struct jp_wheels wheels = inverse_from(at_rest, (struct jp_twist){.x = JP_Q24(0.8), .turn_rate = JP_Q24(1)});
    expect_wheel(&wheels, JP_FRONT_LEFT, DEGREES(36.86989765), JP_Q24(0.5));
    expect_wheel(&wheels, JP_REAR_LEFT, DEGREES(-36.86989765), JP_Q24(0.5));
    expect_wheel(&wheels, JP_FRONT_RIGHT, DEGREES(14.03624347), JP_Q24(1.2369316877));
    expect_wheel(&wheels, JP_REAR_RIGHT, DEGREES(-14.03624347), JP_Q24(1.2369316877));
}

/* All tangent to circles about the centre, the left ones reversed. */
static void test_turning_in_place(void)
{
    const struct jp_wheels wheels = inverse_from(at_rest, (struct jp_twist){.turn_rate = JP_Q24(2)});
    expect_wheel(&wheels, JP_FRONT_LEFT, -IN_PLACE_ANGLE, JP_Q24(-1));
    expect_wheel(&wheels, JP_FRONT_RIGHT, IN_PLACE_ANGLE, JP_Q24(1));
    expect_wheel(&wheels, JP_REAR_LEFT, IN_PLACE_ANGLE, JP_Q24(-1));
    expect_wheel(&wheels, JP_REAR_RIGHT, -IN_PLACE_ANGLE, JP_Q24(1));
}

/* 95° to the left is 5° from where a wheel stands at 90°, and 85° the other way round from one at 0°. */
static void test_flip_takes_the_nearer_way(void)
{
    const struct jp_twist twist = {.x = JP_Q24(-0.0871557427), .y = JP_Q24(0.9961946981)};
    struct jp_wheels wheels = at_rest;
    wheels.angle[JP_REAR_LEFT] = DEGREES(90);
    wheels = inverse_from(wheels, twist);
    expect_wheel(&wheels, JP_FRONT_LEFT, DEGREES(-85), JP_Q24(-1));
    expect_wheel(&wheels, JP_REAR_LEFT, DEGREES(95), JP_Q24(1));
}

/* From −100° the nearer way to 70° would be to −110°, beyond the limit. */
static void test_no_flip_beyond_the_limit(void)
{
    const struct jp_twist twist = {.x = JP_Q24(0.3420201433), .y = JP_Q24(0.9396926208)};
    struct jp_wheels wheels = at_rest;
    wheels.angle[JP_FRONT_RIGHT] = DEGREES(-100);
    wheels = inverse_from(wheels, twist);
    expect_wheel(&wheels, JP_FRONT_RIGHT, DEGREES(70), JP_Q24(1));
}

/* 110° is beyond the limit, and so the far way to −70° is taken. */
static void test_flip_within_the_limit(void)
{
    const struct jp_twist twist = {.x = JP_Q24(-0.3420201433), .y = JP_Q24(0.9396926208)};
    struct jp_wheels wheels = at_rest;
    wheels.angle[JP_FRONT_RIGHT] = DEGREES(100);
    wheels = inverse_from(wheels, twist);
    expect_wheel(&wheels, JP_FRONT_RIGHT, DEGREES(-70), JP_Q24(-1));
}

static void test_angles_are_held_at_zero_speed(void)
{
    const struct jp_wheels turned = {{DEGREES(10), DEGREES(20), DEGREES(-90), DEGREES(100)}, {5, 6, 7, 8}};
    const struct jp_wheels wheels = inverse_from(turned, (struct jp_twist){0, 0, 0});
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        TEST_ASSERT_EQUAL_INT32(turned.angle[wheel], wheels.angle[wheel]);
        TEST_ASSERT_EQUAL_INT32(0, wheels.speed[wheel]);
    }
}

/* Below the hold speed the component along the wheel is left: half of it at 60°. From it on the wheel is steered. */
static void test_slow_wheels_keep_their_angle(void)
{
    struct jp_wheels wheels = {{DEGREES(60), DEGREES(60), DEGREES(60), DEGREES(60)}, {0}};
    wheels = inverse_from(wheels, (struct jp_twist){.x = JP_WHEEL_HOLD_SPEED - 2});
    expect_all(&wheels, DEGREES(60), JP_WHEEL_HOLD_SPEED / 2 - 1);
    wheels = inverse_from(wheels, (struct jp_twist){.x = JP_WHEEL_HOLD_SPEED});
    expect_all(&wheels, 0, JP_WHEEL_HOLD_SPEED);
}

/* About the front left contact: it stands, and the others turn. */
static void test_a_wheel_on_the_centre_of_rotation_holds(void)
{
    const struct jp_twist twist = {.x = JP_Q24(0.4), .y = JP_Q24(-0.3), .turn_rate = JP_Q24(1)};
    struct jp_wheels wheels = at_rest;
    wheels.angle[JP_FRONT_LEFT] = DEGREES(33);
    wheels.angle[JP_REAR_LEFT] = DEGREES(-80);
    wheels = inverse_from(wheels, twist);
    expect_wheel(&wheels, JP_FRONT_LEFT, DEGREES(33), 0);
    expect_wheel(&wheels, JP_FRONT_RIGHT, 0, JP_Q24(0.8));
    expect_wheel(&wheels, JP_REAR_LEFT, DEGREES(-90), JP_Q24(0.6));
}

static void expect_refused(const struct jp_four_wheel_config *wheeled, struct jp_twist twist, enum jp_status expected)
{
    const struct jp_wheels before = {{1, 2, 3, 4}, {5, 6, 7, 8}};
    struct jp_wheels wheels = before;
    TEST_ASSERT_EQUAL_INT32(expected, jp_four_wheel_inverse(wheeled, &twist, &wheels));
    TEST_ASSERT_EQUAL_MEMORY(&before, &wheels, sizeof wheels);
}

static void test_twists_out_of_range(void)
{
    const jp_q24 most = JP_Q24(16);
    expect_refused(&robot, (struct jp_twist){most + 1, 0, 0}, JP_ERR_ARGUMENT);
    expect_refused(&robot, (struct jp_twist){-most - 1, 0, 0}, JP_ERR_ARGUMENT);
    expect_refused(&robot, (struct jp_twist){0, most + 1, 0}, JP_ERR_ARGUMENT);
    expect_refused(&robot, (struct jp_twist){0, -most - 1, 0}, JP_ERR_ARGUMENT);
    expect_refused(&robot, (struct jp_twist){0, 0, most + 1}, JP_ERR_ARGUMENT);
    expect_refused(&robot, (struct jp_twist){0, 0, -most - 1}, JP_ERR_ARGUMENT);
    expect_refused(&robot, (struct jp_twist){most, most, -most}, JP_ERR_INFEASIBLE);
}

static void test_inverse_wants_pointers(void)
{
    const struct jp_twist twist = {0, 0, 0};
    struct jp_wheels wheels = at_rest;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_inverse(NULL, &twist, &wheels));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_inverse(&robot, NULL, &wheels));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_inverse(&robot, &twist, NULL));
}

static void test_infeasible_twists(void)
{
    struct jp_four_wheel_config narrow = robot;
    narrow.steering_limit = DEGREES(45);
    expect_refused(&robot, (struct jp_twist){.x = JP_Q24(4) + 1}, JP_ERR_INFEASIBLE);
    expect_refused(&robot, (struct jp_twist){.x = JP_Q24(3.9), .turn_rate = JP_Q24(0.5)}, JP_ERR_INFEASIBLE);
    expect_refused(&narrow, (struct jp_twist){.y = JP_Q24(1)}, JP_ERR_INFEASIBLE);
    expect_refused(&narrow, (struct jp_twist){.x = JP_Q24(0.69), .turn_rate = JP_Q24(1)}, JP_ERR_INFEASIBLE);
}

/* At 1 m/s half a slip quantum is 2⁻²³ rad: 81 units. */
static void test_limit_gives_way_by_what_the_formats_tell(void)
{
    const struct jp_twist twist = {.x = JP_Q24(0.7071067812), .y = JP_Q24(0.7071067812)};
    struct jp_four_wheel_config narrow = robot;
    struct jp_wheels wheels = at_rest;
    narrow.steering_limit = DEGREES(45) - 70;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_four_wheel_inverse(&narrow, &twist, &wheels));
    expect_all(&wheels, narrow.steering_limit, JP_Q24(1));
    TEST_ASSERT_EQUAL_INT32(narrow.steering_limit, wheels.angle[JP_REAR_RIGHT]);
    narrow.steering_limit = DEGREES(45) - 130;
    expect_refused(&narrow, twist, JP_ERR_INFEASIBLE);
}

static void test_robot_turns_in_place_at_the_least_limit(void)
{
    struct jp_four_wheel_config narrow = robot;
    struct jp_wheels wheels = at_rest;
    narrow.steering_limit = (int32_t)jp_atan2(robot.wheelbase, robot.track);
    for (jp_q24 rate = JP_Q24(0.001); rate < JP_Q24(7); rate += rate / 3) {
        const struct jp_twist twist = {.turn_rate = rate};
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_four_wheel_inverse(&narrow, &twist, &wheels));
    }
}

/* Forward */

static jp_q24 forward(const struct jp_wheels *wheels, struct jp_twist *twist)
{
    jp_q24 slip = -1;
    jp_four_wheel_forward(&robot, wheels, twist, &slip);
    return slip;
}

static void expect_back(struct jp_twist twist)
{
    const struct jp_wheels wheels = inverse_from(at_rest, twist);
    struct jp_twist back;
    TEST_ASSERT_EQUAL_INT32(0, forward(&wheels, &back));
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, twist.x, back.x);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, twist.y, back.y);
    TEST_ASSERT_INT32_WITHIN(2 * SPEED_TOLERANCE, twist.turn_rate, back.turn_rate);
}

static void test_there_and_back(void)
{
    expect_back((struct jp_twist){0, 0, 0});
    expect_back((struct jp_twist){JP_Q24(1.5), 0, 0});
    expect_back((struct jp_twist){JP_Q24(-1.5), 0, JP_Q24(0.3)});
    expect_back((struct jp_twist){0, 0, JP_Q24(-7)});
    expect_back((struct jp_twist){JP_Q24(0.02), JP_Q24(-0.01), JP_Q24(0.07)});
    expect_back((struct jp_twist){JP_Q24(1), JP_Q24(2), JP_Q24(3)});
}

/* One wheel rolls 0.4 m/s faster: a quarter of it moves the chassis, and its lever of 0.4 m out of 0.5 m turns it:
 * 0.4 · (1 − 1/4 − 0.64/4) of the square is left, over four contacts. */
static void test_slip_of_a_fast_wheel(void)
{
    struct jp_wheels wheels = {{0}, {JP_Q24(1), JP_Q24(1.4), JP_Q24(1), JP_Q24(1)}};
    struct jp_twist twist;
    const jp_q24 slip = forward(&wheels, &twist);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(1.1), twist.x);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, 0, twist.y);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(0.16), twist.turn_rate);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(0.1536229150), slip);
}

/* Wheels that all roll towards the centre give no motion, only slip. */
static void test_slip_of_opposed_wheels(void)
{
    const struct jp_wheels wheels = {{DEGREES(45), DEGREES(-45), DEGREES(-45), DEGREES(45)},
                                     {JP_Q24(-1), JP_Q24(-1), JP_Q24(1), JP_Q24(1)}};
    struct jp_twist twist;
    const jp_q24 slip = forward(&wheels, &twist);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, 0, twist.x);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, 0, twist.y);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), 0, (int32_t)(twist.turn_rate / 1000));
    TEST_ASSERT_TRUE(slip > JP_Q24(0.98));
}

static void test_smallest_slip_that_is_told(void)
{
    struct jp_wheels wheels = {{0}, {JP_Q24(1), JP_Q24(1), JP_Q24(1), JP_Q24(1)}};
    struct jp_twist twist;
    wheels.speed[JP_REAR_LEFT] += 10; /* 3.8 units of slip */
    TEST_ASSERT_EQUAL_INT32(0, forward(&wheels, &twist));
    wheels.speed[JP_REAR_LEFT] += 10;
    TEST_ASSERT_INT32_WITHIN(1, 8, forward(&wheels, &twist));
}

static void test_forward_saturates(void)
{
    struct jp_four_wheel_config small = robot;
    struct jp_wheels wheels = {{0}, {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX}};
    struct jp_twist twist;
    jp_q24 slip = -1;
    small.wheelbase = small.track = JP_Q24(0.05);

    jp_four_wheel_forward(&small, &wheels, &twist, &slip);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(16), twist.x);
    TEST_ASSERT_EQUAL_INT32(0, slip);

    wheels.speed[JP_FRONT_LEFT] = wheels.speed[JP_REAR_LEFT] = INT32_MIN;
    jp_four_wheel_forward(&small, &wheels, &twist, &slip);
    TEST_ASSERT_EQUAL_INT32(0, twist.x);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, twist.turn_rate);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(11.3137085), slip); /* 8 m/s along and across */
}

/* Ticks */

static enum jp_steering tick_to(struct jp_wheels *wheels, struct jp_twist twist)
{
    enum jp_steering steering = JP_STEERING_LIMITED;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_four_wheel_tick(&robot, &twist, wheels, &steering));
    return steering;
}

static struct jp_wheels driving(struct jp_twist twist)
{
    return inverse_from(at_rest, twist);
}

static void test_tick_wants_pointers(void)
{
    const struct jp_twist twist = {0, 0, 0};
    struct jp_wheels wheels = at_rest;
    enum jp_steering steering = JP_STEERING_LIMITED;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_tick(NULL, &twist, &wheels, &steering));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_tick(&robot, NULL, &wheels, &steering));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_tick(&robot, &twist, NULL, &steering));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_four_wheel_tick(&robot, &twist, &wheels, NULL));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, steering);
}

static void test_straight_start_takes_the_speed_steps(void)
{
    const struct jp_twist twist = {.x = JP_Q24(0.12)};
    struct jp_wheels wheels = at_rest;
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, twist));
    expect_all(&wheels, 0, JP_Q24(0.05));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, twist));
    expect_all(&wheels, 0, JP_Q24(0.1));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_ALIGNED, tick_to(&wheels, twist));
    TEST_ASSERT_EQUAL_INT32(twist.x, wheels.speed[JP_REAR_LEFT]);
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_ALIGNED, tick_to(&wheels, twist));
}

/* Through 0 without a stop, because no wheel turns. */
static void test_straight_reversal(void)
{
    const struct jp_twist back = {.x = JP_Q24(-0.07)};
    struct jp_wheels wheels = driving((struct jp_twist){.x = JP_Q24(0.07)});
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, back));
    expect_all(&wheels, 0, JP_Q24(0.02));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, back));
    expect_all(&wheels, 0, JP_Q24(-0.03));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_ALIGNED, tick_to(&wheels, back));
    expect_all(&wheels, 0, JP_Q24(-0.07));
}

/* 36.9° in steps of 2°, the last of which already drives. */
static void test_standing_wheels_are_steered_first(void)
{
    const struct jp_twist twist = {.turn_rate = JP_Q24(0.04)};
    struct jp_wheels wheels = at_rest;
    for (int i = 1; i <= 18; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, twist));
        expect_wheel(&wheels, JP_FRONT_RIGHT, i * DEGREES(2), 0);
        expect_wheel(&wheels, JP_REAR_RIGHT, -i * DEGREES(2), 0);
    }
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_ALIGNED, tick_to(&wheels, twist));
    TEST_ASSERT_INT32_WITHIN(100000, IN_PLACE_ANGLE, wheels.angle[JP_FRONT_RIGHT]);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(0.02), wheels.speed[JP_FRONT_RIGHT]);
}

/* All wheels slow down in proportion and turn no more; then they are steered. */
static void test_large_turns_stop_first(void)
{
    const struct jp_twist aside = {.y = JP_Q24(0.1)};
    const struct jp_wheels before = driving((struct jp_twist){.x = JP_Q24(0.08), .turn_rate = JP_Q24(0.1)});
    struct jp_wheels wheels = before;
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, aside));
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        TEST_ASSERT_EQUAL_INT32(before.angle[wheel], wheels.angle[wheel]);
    }
    /* The outer wheels lose 0.05 of 0.12369 m/s, the inner ones as large a part of 0.05 m/s. */
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(0.0736931688), wheels.speed[JP_FRONT_RIGHT]);
    TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, JP_Q24(0.0297887059), wheels.speed[JP_REAR_LEFT]);
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, aside));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, aside));
    TEST_ASSERT_EQUAL_INT32(0, wheels.speed[JP_FRONT_RIGHT]);
    TEST_ASSERT_EQUAL_INT32(before.angle[JP_FRONT_RIGHT], wheels.angle[JP_FRONT_RIGHT]);
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, aside));
    TEST_ASSERT_EQUAL_INT32(before.angle[JP_FRONT_RIGHT] + DEGREES(2), wheels.angle[JP_FRONT_RIGHT]);
}

/* Backwards at another angle: no wheel could go there without slip, so all stop first. */
static void test_reversal_at_another_angle_stops_first(void)
{
    const struct jp_twist back = {.x = JP_Q24(-1), .turn_rate = JP_Q24(0.2)};
    struct jp_wheels wheels = driving((struct jp_twist){.x = JP_Q24(1)});
    for (int i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, back));
        TEST_ASSERT_EQUAL_INT32(0, wheels.angle[JP_FRONT_LEFT]);
    }
    TEST_ASSERT_EQUAL_INT32(0, wheels.speed[JP_FRONT_LEFT]);
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, tick_to(&wheels, back));
    TEST_ASSERT_EQUAL_INT32(DEGREES(-2), wheels.angle[JP_FRONT_LEFT]);
}

static void test_small_turns_are_driven(void)
{
    const struct jp_twist turn = {.x = JP_Q24(1), .turn_rate = JP_Q24(0.8)};
    struct jp_wheels wheels = driving((struct jp_twist){.x = JP_Q24(1)});
    struct jp_twist twist;
    enum jp_steering steering = JP_STEERING_LIMITED;
    int ticks = 0;
    while (steering == JP_STEERING_LIMITED) {
        const struct jp_wheels before = wheels;
        steering = tick_to(&wheels, turn);
        ticks++;
        TEST_ASSERT_TRUE(forward(&wheels, &twist) <= JP_SLIP_QUANTUM);
        TEST_ASSERT_INT32_WITHIN(DEGREES(2), before.angle[JP_FRONT_LEFT], wheels.angle[JP_FRONT_LEFT]);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.05), before.speed[JP_FRONT_LEFT], wheels.speed[JP_FRONT_LEFT]);
    }
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_ALIGNED, steering);
    TEST_ASSERT_TRUE(ticks >= 10 && ticks <= 14); /* the inner wheels turn by 19.4° and lose 0.28 m/s */
}

/* The same backwards: what is mirrored in time is mirrored in speed. */
static void test_small_turns_are_driven_backwards(void)
{
    const struct jp_twist turn = {.x = JP_Q24(-1), .turn_rate = JP_Q24(-0.8)};
    struct jp_wheels forwards = driving((struct jp_twist){.x = JP_Q24(1)});
    struct jp_wheels backwards = driving((struct jp_twist){.x = JP_Q24(-1)});
    for (int i = 0; i < 20; i++) {
        (void)tick_to(&forwards, (struct jp_twist){.x = JP_Q24(1), .turn_rate = JP_Q24(0.8)});
        (void)tick_to(&backwards, turn);
        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            TEST_ASSERT_INT32_WITHIN(ANGLE_TOLERANCE, forwards.angle[wheel], backwards.angle[wheel]);
            TEST_ASSERT_INT32_WITHIN(4 * SPEED_TOLERANCE, forwards.speed[wheel], -backwards.speed[wheel]);
        }
    }
}

/* The front left wheel stands on the centre of rotation and must turn by 10° first; the others wait. */
static void test_moving_wheels_wait_for_one_that_stands(void)
{
    const struct jp_twist about = {.x = JP_Q24(0.4), .y = JP_Q24(-0.3), .turn_rate = JP_Q24(1)};
    struct jp_twist next = about;
    struct jp_wheels wheels = driving(about);
    struct jp_wheels goal;
    next.x += JP_Q24(0.01);
    wheels.angle[JP_FRONT_LEFT] = DEGREES(10);
    goal = inverse_from(wheels, next);
    TEST_ASSERT_INT32_WITHIN(ANGLE_TOLERANCE, 0, goal.angle[JP_FRONT_LEFT]);
    for (int i = 1; i <= 4; i++) {
        const struct jp_wheels before = wheels;
        TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, next));
        TEST_ASSERT_EQUAL_INT32(DEGREES(10) - i * DEGREES(2), wheels.angle[JP_FRONT_LEFT]);
        TEST_ASSERT_INT32_WITHIN(SPEED_TOLERANCE, before.speed[JP_REAR_RIGHT], wheels.speed[JP_REAR_RIGHT]);
    }
    while (tick_to(&wheels, next) != JP_STEERING_ALIGNED) {
        TEST_ASSERT_INT32_WITHIN(DEGREES(2), 0, wheels.angle[JP_FRONT_LEFT]);
    }
}

static void test_zero_twist_stops_and_holds_the_angles(void)
{
    const struct jp_twist zero = {0, 0, 0};
    const struct jp_wheels before = driving((struct jp_twist){.x = JP_Q24(0.06), .turn_rate = JP_Q24(0.1)});
    struct jp_wheels wheels = before;
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, zero));
    TEST_ASSERT_EQUAL_INT32(JP_STEERING_LIMITED, tick_to(&wheels, zero));
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_STEERING_ALIGNED, tick_to(&wheels, zero));
        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            TEST_ASSERT_EQUAL_INT32(before.angle[wheel], wheels.angle[wheel]);
            TEST_ASSERT_EQUAL_INT32(0, wheels.speed[wheel]);
        }
    }
}

static void expect_hold(struct jp_twist twist, enum jp_status expected)
{
    const struct jp_wheels before = driving((struct jp_twist){.x = JP_Q24(0.06), .turn_rate = JP_Q24(0.1)});
    struct jp_wheels wheels = before;
    for (int i = 0; i < 5; i++) {
        enum jp_steering steering = JP_STEERING_ALIGNED;
        TEST_ASSERT_EQUAL_INT32(expected, jp_four_wheel_tick(&robot, &twist, &wheels, &steering));
        TEST_ASSERT_EQUAL_INT32(JP_STEERING_STANDSTILL, steering);
    }
    for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
        TEST_ASSERT_EQUAL_INT32(before.angle[wheel], wheels.angle[wheel]);
        TEST_ASSERT_EQUAL_INT32(0, wheels.speed[wheel]);
    }
}

static void test_refused_twists_stop_and_hold_the_angles(void)
{
    expect_hold((struct jp_twist){.x = JP_Q24(4) + 1}, JP_ERR_INFEASIBLE);
    expect_hold((struct jp_twist){.x = JP_Q24(16) + 1}, JP_ERR_ARGUMENT);
}

/* Garbage for wheels: nothing overflows, the limits of a tick hold, and it comes to order. */
static void test_any_wheels_come_to_order(void)
{
    const struct jp_twist twist = {.x = JP_Q24(1), .turn_rate = JP_Q24(0.5)};
    struct jp_wheels wheels = {{INT32_MAX, INT32_MIN, DEGREES(101), 0}, {INT32_MIN, INT32_MAX, JP_Q24(-2), 1}};
    enum jp_steering steering = JP_STEERING_LIMITED;
    int ticks = 0;
    while (steering != JP_STEERING_ALIGNED) {
        const struct jp_wheels before = wheels;
        steering = tick_to(&wheels, twist);
        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            const int64_t turn = (int64_t)wheels.angle[wheel] - before.angle[wheel];
            const int64_t change = (int64_t)wheels.speed[wheel] - before.speed[wheel];
            TEST_ASSERT_TRUE(turn <= robot.steering_step && -turn <= robot.steering_step);
            TEST_ASSERT_TRUE(change <= robot.speed_step && -change <= robot.speed_step);
        }
        ticks++;
        TEST_ASSERT_TRUE(ticks < 5000);
    }
}

static void test_garbage_for_wheels_and_a_refused_twist_brake(void)
{
    const struct jp_twist refused = {.x = JP_Q24(16) + 1};
    struct jp_wheels wheels = {{0}, {INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX}};
    enum jp_steering steering;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_tick(&robot, &refused, &wheels, &steering));
    TEST_ASSERT_EQUAL_INT(JP_STEERING_STANDSTILL, steering);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN + robot.speed_step, wheels.speed[0]);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - robot.speed_step, wheels.speed[3]);
}

static uint32_t hashed(uint32_t hash, int32_t value)
{
    return (hash ^ (uint32_t)value) * 16777619U; /* FNV-1a by words */
}

/* Over a drive with a new twist every ten ticks: the same bits on every core and compiler. */
static void test_same_bits_everywhere(void)
{
    struct jp_wheels wheels = at_rest;
    uint32_t hash = 2166136261U;
    uint32_t random = 1;
    for (int i = 0; i < 300; i++) {
        const jp_q24 x = (jp_q24)(random & 0x1FFFFFFU) - JP_Q24(1);
        const struct jp_twist wanted = {.x = x, .turn_rate = x / 2 + JP_Q24(0.3)};
        struct jp_twist twist;
        for (int tick = 0; tick < 10; tick++) {
            hash = hashed(hash, (int32_t)tick_to(&wheels, wanted));
            hash = hashed(hash, forward(&wheels, &twist));
            hash = hashed(hashed(hashed(hash, twist.x), twist.y), twist.turn_rate);
            for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
                hash = hashed(hashed(hash, wheels.angle[wheel]), wheels.speed[wheel]);
            }
        }
        random = random * 1664525U + 1013904223U;
    }
    TEST_ASSERT_EQUAL_HEX32(0xA832D981, hash);
}

static void test_a_twist_is_of_every_angle_below_a_quarter(void)
{
    const int32_t quarter = (int32_t)1 << 30;
    struct jp_twist twist;

    TEST_ASSERT_NOT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, JP_Q24(1), quarter - 1, &twist));
    TEST_ASSERT_NOT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, JP_Q24(1), 1 - quarter, &twist));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, JP_Q24(1), quarter, &twist));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_four_wheel_twist(&robot, JP_Q24(1), -quarter, &twist));
}

static void test_wheels_may_be_as_fast_as_they_can(void)
{
    const struct jp_twist fastest = {.x = robot.speed_max};
    const struct jp_twist faster = {.x = robot.speed_max + 1};
    struct jp_wheels wheels = at_rest;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_inverse(&robot, &fastest, &wheels));
    TEST_ASSERT_EQUAL_INT32(robot.speed_max, wheels.speed[0]);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_four_wheel_inverse(&robot, &faster, &wheels));
}

/* Whichever wheel it is that rolls, or that is too far from its direction. */
static void test_one_wheel_makes_all_stand(void)
{
    const struct jp_twist ahead = {.x = JP_Q24(0.5)};
    enum jp_steering steering;

    for (int k = 0; k < (int)JP_WHEELS; k++) {
        struct jp_wheels far = {{0}, {JP_Q24(0.5), JP_Q24(0.5), JP_Q24(0.5), JP_Q24(0.5)}};
        struct jp_wheels rolling = {{DEGREES(85), DEGREES(85), DEGREES(85), DEGREES(85)}, {0}};

        far.angle[k] = DEGREES(85);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&robot, &ahead, &far, &steering));
        TEST_ASSERT_EQUAL_INT(JP_STEERING_STANDSTILL, steering);
        TEST_ASSERT_EQUAL_INT32(DEGREES(85), far.angle[k]);
        rolling.speed[k] = JP_Q24(0.5);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&robot, &ahead, &rolling, &steering));
        TEST_ASSERT_EQUAL_INT(JP_STEERING_STANDSTILL, steering);
        TEST_ASSERT_EQUAL_INT32(DEGREES(85), rolling.angle[k]);
    }
}

static void test_one_wheel_off_its_goal_is_no_alignment(void)
{
    const struct jp_twist ahead = {.x = JP_Q24(0.5)};
    enum jp_steering steering;

    for (int k = 0; k < (int)JP_WHEELS; k++) {
        struct jp_wheels turned = {{0}, {JP_Q24(0.5), JP_Q24(0.5), JP_Q24(0.5), JP_Q24(0.5)}};
        struct jp_wheels slow = turned;
        struct jp_wheels there = turned;

        turned.angle[k] = DEGREES(5);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&robot, &ahead, &turned, &steering));
        TEST_ASSERT_EQUAL_INT(JP_STEERING_LIMITED, steering);
        slow.speed[k] = JP_Q24(0.3);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&robot, &ahead, &slow, &steering));
        TEST_ASSERT_EQUAL_INT(JP_STEERING_LIMITED, steering);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&robot, &ahead, &there, &steering));
        TEST_ASSERT_EQUAL_INT(JP_STEERING_ALIGNED, steering);
    }
}

/* About one of its wheels, which stands, the others roll: not at a stand. */
static void test_one_wheel_that_stands_is_no_stand(void)
{
    const jp_q24 rate = JP_Q24(0.8);
    enum jp_steering steering;

    for (int k = 0; k < (int)JP_WHEELS; k++) {
        const bool is_front = k == (int)JP_FRONT_LEFT || k == (int)JP_FRONT_RIGHT;
        const bool is_left = k == (int)JP_FRONT_LEFT || k == (int)JP_REAR_LEFT;
        const struct jp_twist about = {jp_q24_multiply(rate, is_left ? JP_Q24(0.4) : -JP_Q24(0.4)),
                                       jp_q24_multiply(rate, is_front ? -JP_Q24(0.3) : JP_Q24(0.3)), rate};
        struct jp_wheels wheels = at_rest;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_inverse(&robot, &about, &wheels));
        for (int i = 0; i < (int)JP_WHEELS; i++) {
            wheels.speed[i] = 0;
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_tick(&robot, &about, &wheels, &steering));
        TEST_ASSERT_INT32_WITHIN(JP_WHEEL_HOLD_SPEED, 0, wheels.speed[k]);
        TEST_ASSERT_EQUAL_INT(JP_STEERING_LIMITED, steering);
    }
}
