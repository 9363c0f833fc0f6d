/* The patrol on its way: driving, a pause, the plain band, each reason to stand. */
#include "src/local/patrol_drive.h"
#include "tests/support/patrol_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static void see(struct jp_obstacle shape)
{
    jp_obstacles_clear(&patrol.obstacles, &(struct jp_plane_point){patrol.pose.x, patrol.pose.y});
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&patrol.obstacles, &shape));
}

/* ---- Driving ---- */

static void test_nothing_moves_without_a_path(void)
{
    rig_cycles(5);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
    rig_expect_stand();
    TEST_ASSERT_EQUAL_UINT32(5, patrol.counts.cycles);
}

static void test_straight_way(void)
{
    float top = 0.0f;

    rig_go(4.0f, 0.0f);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    while (patrol.state == JP_PATROL_DRIVING) {
        const float before = rig_from_q24(twist.x);

        rig_cycle();

        const float speed = rig_from_q24(twist.x);

        TEST_ASSERT_TRUE(speed >= 0.0f && speed <= 0.8f + 1e-5f);
        TEST_ASSERT_TRUE(speed <= before + 0.8f * RIG_PERIOD + 1e-5f);
        top = speed > top ? speed : top;
    }
    rig_expect(JP_PATROL_ARRIVED, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(top > 0.75f);
    TEST_ASSERT_NEAR(0.03f, 4.0f, robot.x);
    TEST_ASSERT_NEAR(0.02f, 0.0f, robot.y);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns + patrol.counts.steps + patrol.counts.waits);
    rig_cycles(5);
    rig_expect(JP_PATROL_ARRIVED, JP_PATROL_NONE);
    rig_expect_stand();
}

/* Beside the robot, where a band that does not drive backwards cannot get. */
static void test_a_band_that_stands_is_no_way(void)
{
    config.turns_in_place = false;
    rig_init();
    rig_straight(0.0f, 0.0f, 0.0f, 0.3f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.3f, 0.0f, false));
    TEST_ASSERT_TRUE(rig_until(JP_PATROL_WAITING, 60) > 5U);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
}

/* The same band, while something stands or walks elsewhere. */
static enum jp_patrol_state state_beside(float velocity)
{
    const struct jp_plane_speed still = {0.0f, 0.0f};

    config.turns_in_place = false;
    rig_init();
    rig_straight(0.0f, 0.0f, 0.0f, 0.3f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.3f, 0.0f, false));
    rig_cycle();
    see((struct jp_obstacle){
        .vertices = {{-4.0f, 0.0f}}, .vertex_count = 1, .radius = 0.2f, .velocity = {velocity, 0.0f}});
    for (unsigned i = 0; i < 20U && patrol.state != JP_PATROL_WAITING; i++) {
        jp_patrol_drive(&patrol, &still);
    }
    return patrol.state;
}

static void test_a_band_that_stands_for_who_walks_has_not_stalled(void)
{
    TEST_ASSERT_EQUAL_INT(JP_PATROL_WAITING, state_beside(0.0f));
    rig_reset();
    TEST_ASSERT_EQUAL_INT(JP_PATROL_DRIVING, state_beside(-0.5f));
}

/* They may have passed, which a band that stands does not tell. */
static void test_a_band_that_stands_for_who_walks_is_laid_anew(void)
{
    const struct jp_plane_speed still = {0.0f, 0.0f};
    unsigned cleared = 0;

    (void)state_beside(-0.5f);
    for (unsigned i = 0; i < 20U; i++) {
        jp_patrol_drive(&patrol, &still);
        cleared += patrol.teb.count == 0U ? 1U : 0U;
    }
    TEST_ASSERT_TRUE(cleared >= 2U && cleared <= 4U);
}

static void test_a_band_that_stands_for_people_is_waited_for(void)
{
    config.turns_in_place = false;
    rig_init();
    rig_straight(0.0f, 0.0f, 0.0f, 0.3f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.3f, 0.0f, false));
    for (unsigned i = 0; i < 60U; i++) {
        patrol.internal.is_yielding = true;
        rig_cycle();
        rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    }
}

static void test_robot_follows_a_bent_path(void)
{
    rig_straight(0.0f, 0.0f, 2.0f, 0.0f);
    rig_straight(2.0f, 0.1f, 2.0f, 2.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(2.0f, 2.5f, 0.0f, true));
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 2.0f, robot.x);
    TEST_ASSERT_NEAR(0.08f, 2.5f, robot.y);
}

static void test_robot_turns_in_place_before_it_drives(void)
{
    rig_go(-2.0f, 0.3f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);

    float before = jp_plane_magnitude(rig_from_q24(twist.turn_rate));

    TEST_ASSERT_NEAR(1e-5f, config.turn_acceleration * RIG_PERIOD, before);
    while (patrol.state == JP_PATROL_TURNING) {
        rig_cycle();

        const float rate = rig_from_q24(twist.turn_rate);

        TEST_ASSERT_EQUAL_INT32(0, twist.x);
        TEST_ASSERT_TRUE(jp_plane_magnitude(rate) <= config.turn_rate + 1e-5f);
        TEST_ASSERT_TRUE(jp_plane_magnitude(rate) <= before + config.turn_acceleration * RIG_PERIOD + 1e-5f);
        before = jp_plane_magnitude(rate);
    }
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(0.08f, jp_plane_bearing(-2.0f, 0.3f), robot.heading);
    TEST_ASSERT_NEAR(1e-3f, 0.0f, jp_plane_length(robot.x, robot.y));
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.turns);
}

static void test_robot_turns_to_the_right_too(void)
{
    rig_go(0.3f, -2.0f);
    rig_cycles(3);
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(twist.turn_rate < 0);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_robot_turns_at_the_goal(void)
{
    rig_go_to_heading(1.5f, 0.0f, -2.0f);
    (void)rig_until(JP_PATROL_TURNING, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 1.5f, robot.x);
    TEST_ASSERT_EQUAL_INT32(0, twist.x);
    TEST_ASSERT_NEAR(1e-5f, -config.turn_acceleration * RIG_PERIOD, rig_from_q24(twist.turn_rate));
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, -2.0f, robot.heading);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.turns);
}

static void test_robot_that_comes_with_the_heading_does_not_turn(void)
{
    rig_go_to_heading(1.5f, 0.0f, 0.05f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

static void test_robot_just_past_the_goal_has_arrived(void)
{
    rig_straight(-1.0f, 0.0f, -0.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(-0.05f, 0.0f, 0.0f, true));
    rig_cycle();
    rig_expect(JP_PATROL_ARRIVED, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(1e-6f, 0.0f, robot.x);
}

static void test_robot_that_stands_near_the_goal_has_arrived(void)
{
    rig_straight(-1.0f, 0.0f, 0.07f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.07f, 0.0f, 0.0f, true));
    rig_cycle();
    rig_expect(JP_PATROL_ARRIVED, JP_PATROL_NONE);
}

static void test_hold_forgets_the_path(void)
{
    rig_go(3.0f, 0.0f);
    rig_cycles(10);
    jp_patrol_hold(&patrol);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
    rig_cycle();
    rig_expect_stand();
    rig_cycles(5);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
}

/* ---- A pause ---- */

static void test_pause_stops_soon_along_the_path(void)
{
    rig_go_to_heading(5.0f, 0.0f, 2.0f);
    rig_cycles(15);

    const float from = robot.x;
    const float speed = rig_from_q24(twist.x);

    jp_patrol_pause(&patrol);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_TRUE(robot.x > from && robot.x < from + speed * speed / 0.8f + 0.6f);
    TEST_ASSERT_NEAR(0.1f, 0.0f, robot.heading);
}

static void test_pause_before_the_goal_ends_at_the_goal(void)
{
    rig_go(0.5f, 0.0f);
    rig_cycles(6);
    jp_patrol_pause(&patrol);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 0.5f, robot.x);
}

static void test_pause_of_what_does_not_drive_holds(void)
{
    jp_patrol_pause(&patrol);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
    rig_go(-2.0f, 0.0f);
    (void)rig_until(JP_PATROL_TURNING, 5);
    rig_cycles(5);
    jp_patrol_pause(&patrol);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
    rig_cycle();
    rig_expect_stand();
}

static void test_pause_of_a_robot_at_its_goal_holds(void)
{
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 2.0f, false));
    rig_sense();
    input.speed.forward = 0.5f; /* it has to stand first */
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    rig_expect_stand();
    jp_patrol_pause(&patrol);
    rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
}

static void test_pause_after_arrival_changes_nothing(void)
{
    rig_go(1.0f, 0.0f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    jp_patrol_pause(&patrol);
    rig_expect(JP_PATROL_ARRIVED, JP_PATROL_NONE);
}

/* ---- The plain band ---- */

static void be_plain(void)
{
    config.turns_in_place = false;
    config.teb.weights.no_reversing = 0.0f;
    config.teb.weights.wheel_odometry = 0.0f;
    config.teb.weights.laser_odometry = 0.0f;
    rig_init();
}

static void test_plain_band_does_not_need_the_laser(void)
{
    be_plain();
    laser_shift = 10.0f;
    rig_go_to_heading(3.0f, 0.0f, 0.0f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 3.0f, robot.x);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.laser_rejected);
}

static void test_plain_band_does_not_turn_in_place(void)
{
    be_plain();
    rig_go(0.0f, 2.0f);
    rig_cycles(10);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(twist.x != 0);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.turns);
}

static void test_plain_band_arrives_with_the_heading_only(void)
{
    be_plain();
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 1.0f, false));
    rig_cycle();
    TEST_ASSERT_TRUE(patrol.state != JP_PATROL_ARRIVED);
}

/* Brakes so weak that from any part of the band's speed the robot would come to its stop in what is beyond the goal. */
static void test_it_does_not_drive_where_it_could_not_stop(void)
{
    const struct jp_plane_speed speed = {0.4f, 0.0f};

    rig_reset();
    rig_init();
    rig_go(4.0f, 0.0f);
    rig_cycles(8);
    patrol.config.people.braking = 0.0001f;
    see((struct jp_obstacle){
        .vertices = {{patrol.pose.x + 5.5f, -0.8f}, {patrol.pose.x + 5.5f, 0.8f}}, .vertex_count = 2, .radius = 0.2f});
    jp_patrol_drive(&patrol, &speed);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_WAITING, patrol.state);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_BLOCKED, patrol.reason);
}

/* ---- Waiting ---- */

static void test_robot_waits_for_its_way(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(8);
    rig_wall_ahead();
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    TEST_ASSERT_TRUE(robot.x + 0.4f < 2.0f);
    rig_cycles(10);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    wall_count = 0;
    rig_cycles(2); /* a way for a moment is none */
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    rig_cycle();
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.waits);
    TEST_ASSERT_TRUE(patrol.counts.infeasible >= 10);
}

static void test_robot_gives_up_and_says_why(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(8);
    rig_wall_ahead();
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_BLOCKED);
    wall_count = 0;
    rig_cycles(10);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_BLOCKED);
    rig_expect_stand();
    rig_go(robot.x + 1.0f, 0.0f);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

/* A way that closes whenever the robot goes on: it takes twice as long each time. */
static void test_robot_does_not_try_again_and_again(void)
{
    unsigned wanted = 3;

    config.waits_max = 1000;
    rig_init();
    rig_go(4.0f, 0.0f);
    rig_cycle();
    is_stuck = true;
    for (unsigned try = 0; try < 11U; try++) {
        rig_wall(0.55f, -1.0f, 0.55f, 1.0f);
        (void)rig_until(JP_PATROL_WAITING, 5);
        wall_count = 0;
        TEST_ASSERT_EQUAL_UINT(wanted, rig_until(JP_PATROL_DRIVING, 1000));
        wanted *= try < 8U ? 2U : 1U;
        patrol.internal.unmoved = 0;
    }
    is_stuck = false;
    rig_cycles(10); /* it gets on: all is forgotten */
    rig_wall(robot.x + 0.55f, -1.0f, robot.x + 0.55f, 1.0f);
    (void)rig_until(JP_PATROL_WAITING, 5);
    wall_count = 0;
    TEST_ASSERT_EQUAL_UINT(3, rig_until(JP_PATROL_DRIVING, 10));
}

/* Within the footprint, in front of the scanner. */
static void put_inside(void)
{
    rig_box(robot.x + 0.3f, robot.y - 0.1f, robot.x + 0.35f, robot.y + 0.1f);
}

static void test_thing_inside_the_footprint_stops_the_robot_at_once(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(12);
    put_inside();
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
    rig_expect_stand();
    rig_cycles(5);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
    wall_count = 0;
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_start_in_collision(void)
{
    put_inside();
    rig_go(4.0f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_IN_COLLISION);
    TEST_ASSERT_NEAR(1e-6f, 0.0f, robot.x);
}

/* With the latency the robot will be in collision before anything helps. */
static void test_collision_within_the_latency(void)
{
    config.latency = 1.0f;
    rig_init();
    rig_go(4.0f, 0.0f);
    (void)rig_until(JP_PATROL_DRIVING, 1);
    while (input.speed.forward < 0.7f) {
        rig_cycle();
    }
    rig_wall(robot.x + 0.8f, -1.0f, robot.x + 0.8f, 1.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
}

static void test_turn_stops_for_what_comes_into_it(void)
{
    rig_go(0.0f, 2.0f);
    rig_cycles(5);
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);

    const struct jp_plane_point corner = jp_plane_direction(robot.heading + 0.95f);
    const float x = 0.47f * corner.x;
    const float y = 0.47f * corner.y;

    rig_box(x - 0.03f, y - 0.03f, x + 0.03f, y + 0.03f);
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    rig_expect_stand();
    wall_count = 0;
    (void)rig_until(JP_PATROL_TURNING, 10);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}

static void test_thing_inside_the_footprint_stops_a_turn(void)
{
    rig_go(0.0f, 2.0f);
    rig_cycles(5);
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    rig_box(0.2f, -0.05f, 0.25f, 0.05f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_IN_COLLISION);
    rig_expect_stand();
}

static void test_robot_far_off_its_path_stands(void)
{
    rig_straight(10.0f, 10.0f, 12.0f, 10.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(12.0f, 10.0f, 0.0f, true));
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_OFF_PATH);
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_OFF_PATH);
}

static void test_robot_whose_wheels_do_not_move_it_stalls(void)
{
    is_stuck = true;
    rig_go(4.0f, 0.0f);

    const unsigned cycles = rig_until(JP_PATROL_STOPPED, RIG_LONG);

    rig_expect(JP_PATROL_STOPPED, JP_PATROL_STALLED);
    rig_expect_stand();
    TEST_ASSERT_TRUE(cycles > config.waits_max && cycles <= 2U * config.waits_max + 1U);
}

static void test_wheels_that_cannot_do_it_are_not_asked_to(void)
{
    config.wheels.speed_max = JP_Q24(0.3);
    rig_init();
    rig_go(4.0f, 0.0f);

    while (patrol.state == JP_PATROL_DRIVING) {
        TEST_ASSERT_TRUE(twist.x <= JP_Q24(0.3));
        rig_cycle();
    }
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_INFEASIBLE);
    rig_expect_stand();
}

/* What comes of it after its turn is beside the goal by more than the tolerance. */
static void test_a_robot_that_stands_beside_its_goal_steps_to_it(void)
{
    rig_go_to_heading(2.0f, 0.0f, 2.5f);
    while (patrol.state != JP_PATROL_TURNING) {
        rig_cycle();
    }
    robot.x += 0.12f;
    (void)rig_until(JP_PATROL_STEPPING, RIG_LONG);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.05f, 2.0f, robot.x);
    TEST_ASSERT_NEAR(config.heading_tolerance, 0.0f, jp_plane_wrap(robot.heading - 2.5f));
}

/* Where a wall is in the way of that step it stays where it is. */
static void test_a_step_to_the_goal_that_is_not_free_is_not_taken(void)
{
    rig_go_to_heading(2.0f, 0.0f, 2.5f);
    while (patrol.state != JP_PATROL_TURNING) {
        rig_cycle();
    }
    robot.x += 0.12f;
    while (!(jp_plane_magnitude(jp_plane_wrap(robot.heading - 2.5f)) < 0.3f)) {
        rig_cycle();
    }
    rig_wall(1.57f, -1.0f, 1.57f, 1.0f);
    /* Where it stands is not the goal, and it says so. */
    (void)rig_until(JP_PATROL_WAITING, RIG_LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_BLOCKED);
    (void)rig_until(JP_PATROL_STOPPED, RIG_LONG);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_BLOCKED);
    TEST_ASSERT_NEAR(0.05f, 2.12f, robot.x);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.steps);
}

/* ---- Where the band stands ---- */

/* A goal before a wall, from which the band keeps away. */
static void go_to_a_wall(bool turns)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    config.turns_in_place = turns;
    config.position_tolerance = 0.05f;
    config.teb.weights.obstacle *= 1000.0f;
    config.teb.clearance = 0.4f;
    rig_init();
    rig_wall(1.45f, -1.0f, 1.45f, 1.0f);
    rig_go_to_heading(1.0f, 0.0f, 0.0f);
}

static void test_to_a_goal_before_a_wall_it_steps(void)
{
    go_to_a_wall(true);
    (void)rig_until(JP_PATROL_STEPPING, RIG_LONG);
    TEST_ASSERT_TRUE(robot.x < 0.95f);
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.05f, 1.0f, robot.x);
}

static void test_the_plain_band_does_not_step_to_a_goal(void)
{
    go_to_a_wall(false);
    for (unsigned i = 0; i < RIG_LONG; i++) {
        rig_cycle();
        TEST_ASSERT_TRUE(patrol.state != JP_PATROL_STEPPING);
    }
    TEST_ASSERT_TRUE(robot.x < 0.95f);
}

/* Where the goal is on the wall no step leads to it either. */
static void test_a_goal_in_a_wall_is_not_stepped_to(void)
{
    go_to_a_wall(true);
    walls[0].from.x = 1.35f;
    walls[0].to.x = 1.35f;
    for (unsigned i = 0; i < RIG_LONG; i++) {
        rig_cycle();
        TEST_ASSERT_TRUE(patrol.state != JP_PATROL_STEPPING);
    }
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_BLOCKED);
}
