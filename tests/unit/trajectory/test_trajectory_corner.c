/* Where two legs meet: which of them is slowed down and how far, and how the waypoint between them is passed. */
#include "src/trajectory/trajectory_corner.h"

#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "src/base/integer.h"
#include "src/trajectory/trajectory_blend.h"
#include "unity.h"

enum { TARGETS = 2 };

static struct jp_trajectory_config robot;
static struct jp_trajectory_task task;
static struct jp_passage passages[TARGETS];
static struct jp_chord slow;
static struct jp_chord fast;

void setUp(void)
{
    static const struct jp_point targets[TARGETS] = {{JP_Q16(2), 0}, {JP_Q16(4), JP_Q16(1)}};

    robot = jp_robot_courier24.trajectory;
    task = (struct jp_trajectory_task){.config = &robot, .cruise = JP_Q24(0.8), .targets = targets, .count = TARGETS};
    slow = (struct jp_chord){.direction = JP_ANGLE_DEGREES(10), .speed = JP_Q24(0.1), .blend = 40};
    fast = (struct jp_chord){.direction = JP_ANGLE_DEGREES(40), .speed = JP_Q24(0.8), .blend = 60};
    for (unsigned i = 0; i < TARGETS; i++) {
        passages[i] = (struct jp_passage){.given = 0};
    }
    task.passages = passages;
}

void tearDown(void)
{
}

/* Whether the faster one could be as fast, by the motion between them. */
static bool could_be(jp_q24 speed, jp_angle heading, bool is_corner)
{
    const struct jp_waypoint_motion motion = {.heading = heading, .turn_rate = is_corner ? 1 : 0, .speed = slow.speed};
    struct jp_chord faster = fast;

    faster.speed = speed;
    return jp_chord_can_meet(&robot, &faster, &motion, jp_blend_beside(fast.blend, slow.blend));
}

/* As fast as the voltage allows, to a 2⁸th of the difference; the slower one stays. */
static void expect_as_fast_as_it_can(jp_angle heading, bool is_corner)
{
    const jp_q24 before = fast.speed;
    const jp_q24 slower = slow.speed;
    const jp_q24 part = (before - slower) / 256 + 1;

    jp_chords_meet(&task, 0, &slow, &fast);
    TEST_ASSERT_EQUAL_INT32(slower, slow.speed);
    TEST_ASSERT_GREATER_THAN_INT32(slower, fast.speed);
    TEST_ASSERT_LESS_THAN_INT32(before, fast.speed);
    TEST_ASSERT_TRUE(could_be(fast.speed, heading, is_corner));
    TEST_ASSERT_FALSE(could_be(fast.speed + part, heading, is_corner));
}

/* Blends in which what there is does for a part of the change. */
static void be_short(void)
{
    const jp_angle mean = slow.direction + (fast.direction - slow.direction) / 2U;

    for (slow.blend = 200; slow.blend > 1U && could_be(fast.speed, mean, true); slow.blend--) {
        fast.blend = slow.blend;
    }
    fast.blend = slow.blend;
}

static void test_the_faster_of_two_legs_is_slowed_as_far_as_it_must(void)
{
    be_short();
    expect_as_fast_as_it_can(JP_ANGLE_DEGREES(25), true);
}

static void test_the_faster_leg_keeps_to_a_heading_that_is_given(void)
{
    const jp_angle heading = JP_ANGLE_DEGREES(20);

    passages[0] = (struct jp_passage){.given = JP_GIVEN_HEADING, .heading = heading};
    for (slow.blend = 200; slow.blend > 1U && could_be(fast.speed, heading, false); slow.blend--) {
        fast.blend = slow.blend;
    }
    fast.blend = slow.blend;
    expect_as_fast_as_it_can(heading, false);
}

static void test_which_leg_comes_first_is_the_same(void)
{
    struct jp_chord first;
    struct jp_chord second;

    be_short();
    first = fast;
    second = slow;
    jp_chords_meet(&task, 0, &first, &second);
    jp_chords_meet(&task, 0, &slow, &fast);
    TEST_ASSERT_EQUAL_INT32(fast.speed, first.speed);
    TEST_ASSERT_EQUAL_INT32(slow.speed, second.speed);
}

static void test_no_leg_is_slowed_that_need_not_be(void)
{
    const jp_q24 before = fast.speed;

    slow.blend = 2000;
    fast.blend = 2000;
    jp_chords_meet(&task, 0, &slow, &fast);
    TEST_ASSERT_EQUAL_INT32(before, fast.speed);
}

/* Each of them then meets the speed that is given instead. */
static void test_legs_beside_a_given_speed_do_not_meet(void)
{
    const jp_q24 before = fast.speed;

    be_short();
    passages[0] = (struct jp_passage){.given = JP_GIVEN_SPEED, .speed = JP_Q24(0.3)};
    jp_chords_meet(&task, 0, &slow, &fast);
    TEST_ASSERT_EQUAL_INT32(before, fast.speed);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.1), slow.speed);
}

/* ---- Corners ---- */

static struct jp_waypoint_motion corner(int before, int after, int heading, unsigned given)
{
    slow.direction = (jp_angle)before * JP_ANGLE_DEGREES(1);
    fast.direction = (jp_angle)after * JP_ANGLE_DEGREES(1);
    passages[0] = (struct jp_passage){.given = (uint8_t)given, .heading = (jp_angle)heading * JP_ANGLE_DEGREES(1)};
    return jp_corner_between(&task, 0, &slow, &fast);
}

static void test_a_corner_is_passed_in_the_mean_heading_turning_its_way(void)
{
    for (int turn = -170; turn <= 170; turn += 20) {
        const struct jp_waypoint_motion motion = corner(33, 33 + turn, 0, 0);

        TEST_ASSERT_EQUAL_INT32((int32_t)(fast.direction - slow.direction) / 2,
                                (int32_t)(motion.heading - slow.direction));
        TEST_ASSERT_TRUE(turn < 0 ? motion.turn_rate < 0 : motion.turn_rate > 0);
    }
}

static void test_corners_to_the_left_and_to_the_right_are_mirror_images(void)
{
    for (int turn = -160; turn <= 160; turn += 40) {
        for (int heading = -90; heading <= 90; heading += 30) {
            for (unsigned given = 0; given <= 1U; given++) {
                const unsigned bits = given * (unsigned)JP_GIVEN_HEADING;
                const struct jp_waypoint_motion left = corner(0, turn, heading, bits);
                const struct jp_waypoint_motion right = corner(0, -turn, -heading, bits);

                TEST_ASSERT_INT32_WITHIN(1, 0, (int32_t)(left.heading + right.heading));
                TEST_ASSERT_INT32_WITHIN(1, 0, left.turn_rate + right.turn_rate);
                TEST_ASSERT_EQUAL_INT32(left.speed, right.speed);
            }
        }
    }
}

/* A heading that is not between the two lines is turned to and back. */
static void test_a_heading_beside_both_lines_is_passed_without_turning(void)
{
    TEST_ASSERT_EQUAL_INT32(0, corner(0, 40, 60, JP_GIVEN_HEADING).turn_rate);
    TEST_ASSERT_EQUAL_INT32(0, corner(0, 40, -20, JP_GIVEN_HEADING).turn_rate);
    TEST_ASSERT_GREATER_THAN_INT32(0, corner(0, 40, 20, JP_GIVEN_HEADING).turn_rate);
    TEST_ASSERT_EQUAL_UINT32(20U * JP_ANGLE_DEGREES(1), corner(0, 40, 20, JP_GIVEN_HEADING).heading);
}
