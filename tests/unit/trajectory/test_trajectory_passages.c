/* The rule: legs that are driven slower than the cruise, and what is given at a waypoint. */
#include "tests/support/rule_rig.h"

/* ---- Slower ---- */

static void test_short_legs_are_driven_slower_with_less_voltage(void)
{
    targets[0] = (struct jp_point){JP_Q16(0.5), 0};
    targets[1] = (struct jp_point){JP_Q16(0.5), JP_Q16(0.5)};
    targets[2] = (struct jp_point){JP_Q16(3), JP_Q16(0.5)};
    task.count = 3;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_EQUAL_INT32(task.cruise, legs[1].speed);
    config.voltage = JP_Q16(5);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[0].speed);
    TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[1].speed);
    TEST_ASSERT_EQUAL_INT32(legs[1].speed, legs[1].next.speed);
    TEST_ASSERT_EQUAL_INT32(legs[1].speed, legs[2].speed); /* nor has its blend the voltage for more */
}

/* Between two long legs a short one that is driven slowly: they are slow enough for their blends. */
static void drive_beside_a_slow_leg(jp_q24 pitch)
{
    targets[0] = (struct jp_point){JP_Q16(0.8), 0};
    targets[1] = (struct jp_point){JP_Q16(0.75), JP_Q16(0.05)};
    targets[2] = (struct jp_point){JP_Q16(0.75), JP_Q16(0.85)};
    task.count = 3;
    task.cruise = JP_Q24(0.9);
    config.pitch = pitch;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_LESS_THAN_INT32(JP_Q24(0.4), legs[1].speed);
    TEST_ASSERT_EQUAL_INT32(legs[1].speed, legs[0].next.speed);
    TEST_ASSERT_EQUAL_INT32(legs[1].speed, legs[1].next.speed);
}

static void test_neighbours_of_a_slow_leg_lean_no_more_than_they_may(void)
{
    drive_beside_a_slow_leg(JP_Q24(0.125));

    const jp_q24 first = legs[0].speed;
    const jp_q24 last = legs[2].speed;

    drive_beside_a_slow_leg(JP_Q24(0.01));
    TEST_ASSERT_LESS_THAN_INT32(first, legs[0].speed);
    TEST_ASSERT_LESS_THAN_INT32(last, legs[2].speed);
}

static void test_neighbours_of_a_slow_leg_with_a_heading_between(void)
{
    give(0, 10, 0);
    drive_beside_a_slow_leg(JP_Q24(0.01));
    TEST_ASSERT_EQUAL_HEX32(passages[0].heading, legs[0].next.heading);
}

/* Each of the legs is much slower than the one before it: what is slowed down for the third asks too much of the first.
 */
static unsigned refused_of_shorter_and_shorter_legs(void)
{
    unsigned refused = 0;

    task.count = 4;
    task.cruise = JP_Q24(0.9);
    for (int32_t i = 1; i <= 20; i++) {
        config.pitch = JP_Q24(0.0005) * i;
        targets[0] = (struct jp_point){JP_Q16(0.6), 0};
        targets[1] = (struct jp_point){JP_Q16(0.6), JP_Q16(0.15)};
        targets[2] = (struct jp_point){JP_Q16(0.57), JP_Q16(0.15)};
        targets[3] = (struct jp_point){JP_Q16(0.57), JP_Q16(0.17)};
        refused += plan() == JP_ERR_INFEASIBLE ? 1U : 0U;
    }
    return refused;
}

static void test_legs_that_are_shorter_and_shorter(void)
{
    TEST_ASSERT_GREATER_THAN_UINT32(0, refused_of_shorter_and_shorter_legs());
}

/* A leg that could begin at the speed that is given, but is slow because of the one after it. */
static void test_a_leg_between_a_speed_that_is_given_and_a_slow_leg(void)
{
    unsigned refused = 0;

    task.count = 3;
    task.cruise = JP_Q24(0.9);
    targets[0] = (struct jp_point){JP_Q16(3), 0};
    targets[1] = (struct jp_point){JP_Q16(3.3), 0};
    targets[2] = (struct jp_point){JP_Q16(3.3), JP_Q16(0.02)};
    for (int32_t i = 1; i <= 40; i++) {
        config.pitch = JP_Q24(0.001) * i;
        give(0, 0, JP_Q24(0.7));
        refused += plan() == JP_ERR_INFEASIBLE ? 1U : 0U;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, refused);
}

static void test_a_robot_that_may_not_lean_does_not_stop(void)
{
    config.pitch = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
    task.to_stand = false;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
}

/* ---- What is given ---- */

/* Headings and speeds without the bit that gives them. */
static void test_what_is_not_given_changes_nothing(void)
{
    struct jp_trajectory_leg before[3];

    task.count = 3;
    targets[1].y = JP_Q16(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    for (int i = 0; i < 3; i++) {
        before[i] = legs[i];
        passages[i] = (struct jp_passage){.heading = JP_ANGLE_DEGREES(77), .speed = JP_Q24(99)};
    }
    task.passages = passages;
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_EQUAL_MEMORY(before, legs, sizeof before);
}

static void expect_passed(const struct jp_trajectory_leg *leg, int degrees, jp_q24 speed)
{
    TEST_ASSERT_EQUAL_INT32(degrees * (int32_t)JP_ANGLE_DEGREES(1), (int32_t)leg->next.heading);
    TEST_ASSERT_EQUAL_INT32(speed, leg->next.speed);
}

static void test_heading_and_speed_at_a_corner(void)
{
    targets[1] = (struct jp_point){JP_Q16(3), JP_Q16(3)};
    task.count = 2;
    give(0, 30, JP_Q24(0.3));
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    expect_passed(&legs[0], 30, JP_Q24(0.3));
    TEST_ASSERT_EQUAL_INT32(task.cruise, legs[0].speed);
    TEST_ASSERT_EQUAL_INT32(task.cruise, legs[1].speed);
    /* A quarter more than by the lesser turn of both, here that of the first leg, in either blend. */
    TEST_ASSERT_INT32_WITHIN(2000, jp_multiply_shift(config.turn_pace, JP_Q16(75.0 / 360), 16), legs[0].next.turn_rate);
    give(0, 75, JP_Q24(0.6));
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    expect_passed(&legs[0], 75, JP_Q24(0.6));
    TEST_ASSERT_INT32_WITHIN(2000, jp_multiply_shift(config.turn_pace, JP_Q16(37.5 / 360), 16), legs[0].next.turn_rate);
    /* Where they are less unlike, by the whole turn, as if no heading were given. */
    give(0, 50, JP_Q24(0.6));
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    TEST_ASSERT_INT32_WITHIN(2000, jp_multiply_shift(config.turn_pace, JP_Q16(90.0 / 360), 16), legs[0].next.turn_rate);
}

static void test_a_heading_beyond_both_legs_is_passed_without_turning(void)
{
    targets[1] = (struct jp_point){JP_Q16(3), JP_Q16(3)};
    task.count = 2;
    give(0, -20, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    expect_passed(&legs[0], -20, task.cruise);
    TEST_ASSERT_EQUAL_INT32(0, legs[0].next.turn_rate);
}

static void test_a_stand_in_a_heading(void)
{
    for (int degrees = -90; degrees <= 90; degrees += 45) {
        give(0, degrees, 0);
        TEST_ASSERT_EQUAL_INT(JP_OK, plan());
        expect_passed(&legs[0], degrees, 0);
        TEST_ASSERT_EQUAL_INT32(0, legs[0].next.turn_rate);
    }
}

static void test_a_last_target_that_is_passed_as_is_given(void)
{
    task.to_stand = false;
    give(0, 20, JP_Q24(0.25));
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    expect_passed(&legs[0], 20, JP_Q24(0.25));
    TEST_ASSERT_EQUAL_UINT32(legs[0].begin.set_points, legs[0].end.set_points);
}

static void test_what_cannot_be_given(void)
{
    give(0, 0, JP_Q24(0.01) - 1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());
    give(0, 0, JP_Q24(8) + 1);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());
    give(0, 0, JP_Q24(0.01));
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    passages[0].given = 4;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, plan());
}

/* It has not the time to become so fast. */
static void test_a_speed_that_a_leg_is_too_short_for(void)
{
    targets[0].x = JP_Q16(0.1);
    task.count = 2;
    give(0, 0, JP_Q24(2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, plan());
}

static void test_a_leg_slows_down_for_a_speed_that_is_given(void)
{
    targets[0].x = JP_Q16(0.3);
    task.count = 2;
    give(0, 0, JP_Q24(0.05));
    config.pitch = JP_Q24(0.01);
    TEST_ASSERT_EQUAL_INT(JP_OK, plan());
    expect_passed(&legs[0], 0, JP_Q24(0.05));
    TEST_ASSERT_LESS_THAN_INT32(task.cruise, legs[0].speed);
}
