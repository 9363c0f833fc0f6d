/* The patrol where there is little room: turns in place and the steps to where they are free. */
#include "src/local/patrol_room.h"
#include "src/local/patrol_turn.h"
#include "tests/support/patrol_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* ---- Stepping ---- */

/* Too narrow to turn, open to the east from x = 0.1 m on. */
static void stand_in_a_bay(void)
{
    rig_wall(-0.6f, 0.45f, 0.1f, 0.45f);
    rig_wall(-0.6f, -0.45f, 0.1f, -0.45f);
    rig_wall(-0.6f, -0.45f, -0.6f, 0.45f);
}

static void leave_the_bay(void)
{
    stand_in_a_bay();
    rig_straight(0.0f, 0.0f, 0.4f, 0.28f);
    rig_straight(0.5f, 0.3f, 2.0f, 0.3f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(2.0f, 0.3f, 0.0f, true));
    (void)rig_until(JP_PATROL_STEPPING, 3);
}

static void test_robot_steps_to_where_it_can_turn(void)
{
    leave_the_bay();
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.steps);
    while (patrol.state == JP_PATROL_STEPPING) {
        TEST_ASSERT_TRUE(jp_plane_length(rig_from_q24(twist.x), rig_from_q24(twist.y)) <= config.step_speed + 1e-5f);
        TEST_ASSERT_EQUAL_INT32(0, twist.turn_rate);
        rig_cycle();
    }
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(robot.x > 0.1f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_step_stops_for_what_comes_into_it(void)
{
    leave_the_bay();
    rig_cycles(3);
    rig_wall(robot.x + 0.45f, -0.4f, robot.x + 0.45f, 0.4f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    wall_count = 3;
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

/* What it steps for may have been them; a step at the goal is for the goal. */
static void test_a_step_that_stands_for_people_is_thought_over(void)
{
    for (unsigned i = 0; i < 3U; i++) {
        rig_reset();
        leave_the_bay();
        rig_sense();
        patrol.internal.is_yielding = i != 0U;
        patrol.internal.is_arriving = i == 1U;
        input.speed = (struct jp_plane_speed){0.0f, 0.0f};
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
        TEST_ASSERT_EQUAL_INT(i == 2U ? JP_PATROL_DRIVING : JP_PATROL_STEPPING, patrol.state);
    }
    rig_reset();
    leave_the_bay();
    rig_sense();
    patrol.internal.is_yielding = true;
    input.speed = (struct jp_plane_speed){0.2f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
}

/* It would not learn that they have if it only stood before a step. */
static void test_who_waits_for_people_steps_as_soon_as_they_have_made_way(void)
{
    rig_go(0.05f, 0.3f);
    patrol.movers.movers[0] = (struct jp_mover){.centre = {5.0f, 0.0f},
                                                .velocity = {1.0f, 0.0f},
                                                .walk = {1.0f, 0.0f},
                                                .pace = 1.0f,
                                                .radius = 0.2f,
                                                .sightings = 10};
    patrol.movers.count = 1;
    patrol.internal.is_yielding = true;
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_FALSE(patrol.internal.is_yielding);
    TEST_ASSERT_TRUE(rig_from_q24(twist.y) > 0.9f * config.step_speed);
    rig_cycles(3);
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(robot.y > 0.06f);
}

static void test_step_ends_when_the_robot_stands(void)
{
    leave_the_bay();
    patrol.internal.step_target = (struct jp_plane_point){0.0f, 0.0f};
    rig_sense();
    input.speed.forward = 0.2f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    input.speed.forward = 0.0f;
    input.speed.turn_rate = 0.2f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    rig_expect_stand();
    input.speed.turn_rate = 0.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
}

/* So near that it looks like a collision: away from it with the wheels across, and on. */
static void graze(float depth)
{
    rig_wall(-2.0f, 0.32f - depth, 3.0f, 0.32f - depth);
    rig_go(3.0f, -0.2f);
    rig_cycle();
}

static void test_robot_steps_away_from_what_it_grazes(void)
{
    graze(0.05f);
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_DRIVING, 20);
    TEST_ASSERT_TRUE(robot.y < -0.05f);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.steps);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_robot_that_grazes_in_motion_stops_first(void)
{
    rig_wall(-2.0f, 0.27f, 3.0f, 0.27f);
    rig_go(3.0f, -0.2f);
    rig_sense();
    input.speed.forward = 0.3f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
    input.speed.forward = 0.0f;
    (void)rig_until(JP_PATROL_STEPPING, 5);
}

static void test_plain_band_does_not_step(void)
{
    config.turns_in_place = false;
    rig_init();
    graze(0.05f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
}

static void test_robot_that_grazes_on_both_sides_waits(void)
{
    rig_wall(-3.0f, -0.27f, 3.0f, -0.27f);
    graze(0.05f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
}

static void test_step_waits_for_its_way(void)
{
    stand_in_a_bay();
    rig_wall(0.45f, -0.44f, 0.45f, 0.44f);
    rig_straight(0.0f, 0.0f, 0.4f, 0.28f);
    rig_straight(0.5f, 0.3f, 2.0f, 0.3f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(2.0f, 0.3f, 0.0f, true));
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    wall_count--;
    rig_cycles(2);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
}

static void test_goal_beside_the_robot_is_stepped_to(void)
{
    rig_go(0.05f, 0.3f);
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.04f, 0.3f, robot.y);
    TEST_ASSERT_NEAR(1e-4f, 0.0f, robot.heading);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

static void test_goal_close_behind_is_turned_to(void)
{
    rig_go(-0.3f, 0.1f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
}

static void test_goal_beside_the_robot_is_turned_to_if_no_step_is_free(void)
{
    rig_wall(-2.0f, 0.6f, 2.0f, 0.6f);
    rig_go(0.02f, 0.35f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
}

static void test_goal_in_a_slot_where_no_turn_fits(void)
{
    robot.heading = 0.5f * JP_PLANE_PI;
    rig_init();
    rig_wall(-0.42f, 0.7f, -0.42f, 4.0f);
    rig_wall(0.42f, 0.7f, 0.42f, 4.0f);
    rig_go_to_heading(0.0f, 2.0f, -0.5f * JP_PLANE_PI);
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
}

/* In a slot that the robot fits into lengthwise, but not across. */
static void face_the_slot(uint8_t strategy)
{
    config.strategy = strategy;
    rig_init();
    rig_wall(-0.4f, 0.55f, -0.4f, 1.5f);
    rig_wall(0.4f, 0.55f, 0.4f, 1.5f);
    rig_go_to_heading(0.0f, 0.5f, -0.5f * JP_PLANE_PI);
    rig_cycle();
}

static void test_robot_turns_before_it_steps_into_a_slot(void)
{
    face_the_slot((uint8_t)JP_PATROL_BY_COST);
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(1e-4f, -0.5f * JP_PLANE_PI, patrol.internal.turn_target);
    (void)rig_until(JP_PATROL_STEPPING, 60);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.05f, 0.5f, robot.y);
    TEST_ASSERT_NEAR(0.08f, -0.5f * JP_PLANE_PI, robot.heading);
}

static void test_by_the_fixed_angle_it_does_not_turn_before_a_step(void)
{
    face_the_slot((uint8_t)JP_PATROL_FIXED_ANGLE);
    TEST_ASSERT_FALSE(jp_patrol_turn_before_step(&patrol));
}

static void test_nothing_is_turned_to_at_a_goal_of_any_heading(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_go(0.0f, 0.5f);
    rig_cycle();
    TEST_ASSERT_FALSE(jp_patrol_turn_before_step(&patrol));
}

/* There is a step, but it has the heading. */
static void test_robot_with_the_heading_does_not_turn_before_a_step(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_go_to_heading(0.0f, 0.5f, 0.0f);
    rig_cycle();
    TEST_ASSERT_FALSE(jp_patrol_turn_before_step(&patrol));
}

static void test_robot_does_not_turn_before_a_step_that_would_not_be_free(void)
{
    rig_wall(-1.0f, 0.75f, 1.0f, 0.75f);
    face_the_slot((uint8_t)JP_PATROL_BY_COST);
    TEST_ASSERT_FALSE(jp_patrol_turn_before_step(&patrol));
}

static void test_robot_does_not_turn_before_a_step_where_it_has_no_room(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_wall(-1.0f, -0.35f, 1.0f, -0.35f);
    rig_wall(-1.0f, 0.35f, 1.0f, 0.35f);
    rig_go_to_heading(0.6f, 0.0f, 1.5f);
    rig_cycle();
    TEST_ASSERT_FALSE(jp_patrol_turn_before_step(&patrol));
}

/* ---- Making room ---- */

/* On a straight way east, among what it sees. */
static void be_under_way(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_go(4.0f, 0.0f);
    rig_cycle();
    patrol.state = JP_PATROL_DRIVING;
}

static void test_room_is_made_by_a_turn(void)
{
    be_under_way();
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.4f, true));
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(1e-4f, 0.4f, patrol.internal.turn_target);
}

/* Its corners would come nearer to the wall before it than it keeps. */
static void test_room_is_made_by_a_step_where_no_turn_keeps_clear(void)
{
    rig_wall(0.55f, -1.0f, 0.55f, 1.0f);
    be_under_way();
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.4f, true));
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.step_target.x < -0.03f);
}

static void test_a_turn_by_nothing_makes_no_room(void)
{
    be_under_way();
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.02f, true));
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
}

static void test_robot_that_drives_brakes_before_it_makes_room(void)
{
    be_under_way();
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.4f, false));
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(1e-6f, 0.0f, patrol.internal.command.forward);
    /* With what follows it is one. */
    TEST_ASSERT_EQUAL_UINT8(1, patrol.internal.rooms);
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.4f, true));
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    TEST_ASSERT_EQUAL_UINT8(1, patrol.internal.rooms);
}

static void test_no_room_is_made_where_there_is_none(void)
{
    rig_box(-0.47f, -0.37f, 0.47f, 0.37f);
    be_under_way();
    TEST_ASSERT_FALSE(jp_patrol_make_room(&patrol, 0.4f, true));
}

static void test_room_is_made_twice_without_progress(void)
{
    be_under_way();
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.4f, true));
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, -0.4f, true));
    TEST_ASSERT_FALSE(jp_patrol_make_room(&patrol, 0.4f, true));
}

/* Where it then has no room after all it drives on. */
static void test_room_that_is_gone_after_the_step_is_not_turned_in(void)
{
    rig_wall(0.55f, -1.0f, 0.55f, 1.0f);
    be_under_way();
    TEST_ASSERT_TRUE(jp_patrol_make_room(&patrol, 0.4f, true));
    rig_wall(-2.0f, 0.37f, 2.0f, 0.37f);
    rig_wall(-2.0f, -0.37f, 2.0f, -0.37f);
    (void)rig_until(JP_PATROL_DRIVING, 40);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

/* On a path that passes on one side of a box before it: the band slips aside, as its wheels cannot. */
static void be_before_a_box(void)
{
    config.turn_first = 2.0f;
    config.teb.weights.nonholonomic = 10.0f;
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_straight(0.0f, 0.0f, 0.6f, -0.5f);
    rig_straight(0.7f, -0.5f, 3.0f, -0.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(3.0f, -0.5f, 0.0f, true));
    is_stuck = true;
    rig_cycle();
    is_stuck = false;
    rig_box(0.54f, -0.05f, 1.0f, 0.8f);
}

static void test_robot_before_a_box_makes_room_and_passes_it(void)
{
    float least = RIG_RANGE;

    be_before_a_box();
    for (unsigned i = 0; i < RIG_LONG && patrol.state != JP_PATROL_ARRIVED; i++) {
        rig_cycle();
        least = jp_plane_smaller(least, jp_patrol_clearance(&patrol, &patrol.pose));
    }
    rig_expect(JP_PATROL_ARRIVED, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.counts.steps + patrol.counts.turns > 0U);
    TEST_ASSERT_TRUE(least > JP_PATROL_CLEARANCE - JP_PATROL_CLEARANCE_NOISE);
}

static void test_robot_whose_room_did_not_bring_it_on_creeps(void)
{
    be_before_a_box();
    patrol.internal.rooms = 2U;
    rig_cycles(15);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.steps + patrol.counts.turns);
    TEST_ASSERT_TRUE(robot.x > 0.0f);
}

/* Beside the robot, where a band that does not drive backwards cannot get. */
static void test_goal_that_no_band_leads_to_is_stepped_to(void)
{
    config.turn_first = 2.0f;
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_go_to_heading(0.0f, 0.3f, 0.0f);
    (void)rig_until(JP_PATROL_STEPPING, 60);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

/* What the latency leaves behind is no matter for the band, but for what is done until then. */
static void test_command_that_leads_into_something_is_not_given(void)
{
    config.latency = 1.0f;
    rig_init();
    rig_go(4.0f, 0.0f);
    rig_cycle();
    rig_wall(0.5f, -0.5f, 0.5f, 0.5f);
    rig_sense();
    patrol.internal.command.forward = 0.8f;
    input.speed.forward = 1.4f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
}

/* Beside a wall that leaves a hand's breadth in a turn; north of it is all the room there is. */
static void stand_beside_a_wall(void)
{
    rig_wall(-3.0f, -0.56f, 3.0f, -0.56f);
    rig_go(0.0f, 2.0f);
    rig_cycle();
}

static void test_robot_steps_to_where_it_can_turn_with_the_clearance_wanted(void)
{
    config.teb.clearance = 0.14f;
    rig_init();
    stand_beside_a_wall();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_TURNING, 30);
    TEST_ASSERT_TRUE(robot.y > 0.05f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_robot_turns_with_less_where_no_place_has_more(void)
{
    config.teb.clearance = 0.14f;
    rig_init();
    rig_wall(-3.0f, 0.56f, 3.0f, 0.56f);
    stand_beside_a_wall();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
}

static void test_no_room_to_turn_anywhere(void)
{
    rig_box(-0.45f, -0.35f, 0.45f, 0.35f);
    rig_go(0.0f, 2.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.infeasible);
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_BLOCKED);
}

/* Corners that pass a wall at less than laser and pose may be off by: there is room by the numbers, and it is not used.
 */
static void test_room_that_may_be_none_is_not_turned_in(void)
{
    rig_wall(-2.0f, 0.51f, 2.0f, 0.51f);
    rig_wall(-2.0f, -0.51f, 2.0f, -0.51f);
    rig_wall(0.51f, -2.0f, 0.51f, 2.0f);
    rig_wall(-0.51f, -2.0f, -0.51f, 2.0f);
    rig_go(0.0f, 2.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* Beside a goal, so near a wall that only at the goal itself there is room to turn. */
static void arrive_beside_the_goal(float x)
{
    config.position_tolerance = 0.3f;
    robot.x = x;
    rig_init();
    rig_wall(-0.54f, -2.0f, -0.54f, 2.0f);
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 1.5f, false));
    rig_cycle();
}

static void test_robot_steps_to_the_goal_to_turn_there(void)
{
    rig_wall(0.54f, -2.0f, 0.54f, 2.0f);
    rig_wall(-2.0f, 0.54f, 2.0f, 0.54f);
    rig_wall(-2.0f, -0.54f, 2.0f, -0.54f);
    arrive_beside_the_goal(-0.08f);
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_TURNING, 20);
    TEST_ASSERT_NEAR(0.035f, 0.0f, robot.x);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 1.5f, robot.heading);
}

static void test_robot_at_the_goal_without_room_to_turn_waits(void)
{
    rig_wall(0.45f, -2.0f, 0.45f, 2.0f);
    arrive_beside_the_goal(0.0f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

static void test_robot_beside_the_goal_with_no_way_there_waits(void)
{
    rig_wall(0.35f, -2.0f, 0.35f, 2.0f);
    arrive_beside_the_goal(-0.08f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* A way aside and back, where there is no room to turn at the goal itself. */
static void test_robot_turns_beside_the_goal_and_steps_in(void)
{
    rig_wall(-0.45f, -2.0f, -0.45f, 2.0f);
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 1.5f, false));
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_TURNING, 30);
    TEST_ASSERT_TRUE(robot.x > 0.1f);
    (void)rig_until(JP_PATROL_STEPPING, 60);
    TEST_ASSERT_NEAR(0.08f, 1.5f, robot.heading);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.05f, 0.0f, robot.x);
    TEST_ASSERT_NEAR(0.08f, 1.5f, robot.heading);
}

/* From beside it there is a way to turn, but none back in. */
static void test_robot_does_not_turn_where_it_cannot_step_in(void)
{
    rig_wall(-2.0f, -0.35f, 2.0f, -0.35f);
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 1.5f, false));
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* Within a gap, so that there is room to turn only half a metre farther on. */
static void test_robot_does_not_step_far_to_turn(void)
{
    rig_wall(-2.0f, 0.36f, 0.15f, 0.36f);
    rig_wall(-2.0f, -0.36f, 0.15f, -0.36f);
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 1.5f, false));
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* A long nose: a thing that is in the shorter way round, from beside the goal too, is not in the longer one. */
static void test_robot_turns_the_longer_way_round(void)
{
    float turned = 0.0f;

    config.teb.footprint = (struct jp_footprint){0.9f, 0.2f, 0.3f};
    rig_init();
    rig_box(0.4f, 0.4f, 0.45f, 0.45f);
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 0.5f * JP_PLANE_PI, false));
    while (patrol.state != JP_PATROL_ARRIVED) {
        rig_cycle();
        TEST_ASSERT_TRUE(twist.turn_rate <= 0 || turned < -4.0f);
        turned += rig_from_q24(twist.turn_rate) * RIG_PERIOD;
        TEST_ASSERT_TRUE(patrol.state != JP_PATROL_WAITING && patrol.counts.cycles < RIG_LONG);
    }
    TEST_ASSERT_NEAR(0.1f, -1.5f * JP_PLANE_PI, turned);
}

/* Where there is no room to turn at the goal the band itself leads into its heading. */
static void test_goal_without_room_is_reached_with_its_heading(void)
{
    rig_wall(3.47f, -3.0f, 3.47f, 3.0f);
    rig_straight(0.0f, 0.0f, 1.8f, 0.0f);
    rig_straight(1.9f, 0.02f, 2.6f, 0.7f);
    rig_straight(2.7f, 0.8f, 3.0f, 1.8f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(3.0f, 1.8f, 0.5f * JP_PLANE_PI, false));
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 0.5f * JP_PLANE_PI, robot.heading);
}

/* ---- Out of an aisle ---- */

/* Facing east in a dead end that is too narrow to turn in, with room to turn at its mouth in the west. */
static void stand_in_an_aisle(uint8_t strategy)
{
    config.strategy = strategy;
    rig_init();
    rig_wall(-2.5f, 0.45f, 0.6f, 0.45f);
    rig_wall(-2.5f, -0.45f, 0.6f, -0.45f);
    rig_wall(0.6f, -0.45f, 0.6f, 0.45f);
    rig_straight(0.0f, 0.0f, -5.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(-5.0f, 0.0f, JP_PLANE_PI, true));
}

static void test_robot_backs_out_of_an_aisle(void)
{
    float back = 0.0f;

    stand_in_an_aisle((uint8_t)JP_PATROL_BY_COST);
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    while (patrol.state != JP_PATROL_TURNING && patrol.counts.cycles < RIG_LONG) {
        rig_cycle();
        TEST_ASSERT_TRUE(twist.x <= 0 && twist.x >= -JP_Q24(0.201));
        back = jp_plane_smaller(back, robot.x);
    }
    TEST_ASSERT_TRUE(back < -2.0f);
    TEST_ASSERT_TRUE(patrol.counts.steps > 2U);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.1f, -5.0f, robot.x);
}

static void test_by_the_fixed_angle_it_does_not_back_out(void)
{
    stand_in_an_aisle((uint8_t)JP_PATROL_FIXED_ANGLE);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* As far as is free; then no step is worth it. */
static void test_robot_backs_out_as_far_as_is_free(void)
{
    stand_in_an_aisle((uint8_t)JP_PATROL_BY_COST);
    rig_wall(-0.9f, -0.4f, -0.9f, 0.4f);
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.step_target.x > -0.45f && patrol.internal.step_target.x < -0.05f);
    wall_count--;
    rig_wall(-0.5f, -0.4f, -0.5f, 0.4f);
    (void)rig_until(JP_PATROL_WAITING, 20);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    TEST_ASSERT_TRUE(robot.x > -0.1f);
}

/* Nor where its end is too near for a step, or not free. */
static void test_robot_that_cannot_step_along_its_path_waits(void)
{
    const float ends[] = {-0.02f, -0.2f};

    for (unsigned i = 0; i < 2U; i++) {
        rig_reset();
        config.strategy = (uint8_t)JP_PATROL_BY_COST;
        config.position_tolerance = 0.01f;
        rig_init();
        rig_box(-0.45f, -0.35f, 0.45f, 0.35f);
        rig_straight(0.0f, 0.0f, ends[i], 0.0f);
        TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(ends[i], 0.0f, JP_PLANE_PI, true));
        rig_cycle();
        rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    }
}

/* Where the path ends, no step along it is left. */
static void test_robot_at_the_end_of_its_path_does_not_back_out(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_box(-0.45f, -0.35f, 0.45f, 0.35f);
    rig_straight(0.0f, 0.0f, 0.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 1.5f, false));
    patrol.internal.is_arriving = true;
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* ---- Little room beside a step ---- */

/* Between a wall and two posts: to turn it must step out between these, sideways, with less beside it than a step whose
 * way is known keeps. */
static void stand_behind_posts(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_wall(-3.0f, 0.42f, 3.0f, 0.42f);
    rig_wall(0.41f, -0.36f, 0.7f, -0.36f);
    rig_wall(-0.41f, -0.36f, -0.7f, -0.36f);
    rig_straight(0.0f, 0.0f, -2.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(-2.0f, 0.0f, 0.0f, true));
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.step_clearance < jp_patrol_step_clearance(&config));
}

static void test_a_step_keeps_what_it_was_found_with(void)
{
    stand_behind_posts();
    (void)rig_until(JP_PATROL_TURNING, RIG_LONG);
    TEST_ASSERT_TRUE(robot.y < -0.6f);
}

/* Nor do scans that differ stop it, up to a centimetre. */
static void test_a_step_goes_on_where_scans_differ(void)
{
    stand_behind_posts();
    patrol.internal.step_clearance += 0.005f;
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    patrol.internal.step_clearance += 0.015f;
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* An aisle with a post on either side behind the robot, which leaves no more than a turn keeps. */
static void test_robot_backs_out_between_posts(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_wall(-1.2f, 0.42f, 0.6f, 0.42f);
    rig_wall(-1.2f, -0.42f, 0.6f, -0.42f);
    rig_wall(-0.6f, 0.42f, -0.6f, 0.31f);
    rig_wall(-0.6f, -0.42f, -0.6f, -0.31f);
    rig_straight(0.0f, 0.0f, -3.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(-3.0f, 0.0f, JP_PLANE_PI, true));
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(1.0e-6f, 0.75f * config.scan.tolerance, patrol.internal.step_clearance);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_TRUE(robot.x < -2.9f);
}

/* Beside a wall, behind a box: its path goes up behind that, where no step leads before it has got back. */
static void stand_beside_a_box(float right)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    rig_init();
    rig_wall(-3.0f, -0.36f, 3.0f, -0.36f);
    rig_box(-0.6f, 0.36f, right, 0.9f);
    rig_straight(0.0f, 0.0f, 0.4f, 0.3f);
    rig_straight(0.45f, 0.4f, 0.45f, 2.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.45f, 2.5f, 0.0f, true));
    robot.heading = JP_PLANE_PI;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&patrol, &robot));
    rig_cycle();
}

static void test_robot_steps_back_from_beside_a_box(void)
{
    stand_beside_a_box(0.0f);
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(patrol.internal.step_target.x > 0.1f);
    TEST_ASSERT_NEAR(0.001f, 0.0f, patrol.internal.step_target.y);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.1f, 2.5f, robot.y);
}

/* Where it does not get free of the box by that, it waits. */
static void test_robot_between_a_box_and_a_wall_waits(void)
{
    stand_beside_a_box(3.0f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
}

/* A wall beside the goal leaves less than a step whose way is known keeps. */
static void test_the_last_step_keeps_no_more_than_a_turn(void)
{
    const float gaps[] = {0.08f, 0.02f, -0.02f};

    for (unsigned i = 0; i < 3U; i++) {
        rig_reset();
        config.strategy = (uint8_t)JP_PATROL_BY_COST;
        rig_init();
        rig_wall(-1.0f, 0.5f + gaps[i], 1.0f, 0.5f + gaps[i]);
        rig_straight(0.0f, 0.0f, 0.0f, 0.2f);
        TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.2f, 0.0f, false));
        rig_sense();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
        TEST_ASSERT_EQUAL_INT(i == 0U, jp_patrol_find_step_to_goal(&patrol));
        TEST_ASSERT_EQUAL_INT(i < 2U, jp_patrol_find_last_step(&patrol));
    }
}
