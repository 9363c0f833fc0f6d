/* The patrol: what is refused, each way from state to state, each reason to stand, and what it keeps off. */
#include "tests/float/patrol_rig.h"

#define LONG 400U /* cycles within which a drive of some metres ends */

static const char *field;
static float not_a_number;

void setUp(void)
{
    const float zero = 0.0f;

    field = NULL;
    not_a_number = zero / zero;
    rig_reset();
}

void tearDown(void)
{
}

/* ---- Configuration ---- */

static void test_init_refuses_null_pointers(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_init(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_init(&patrol, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_init(&patrol, &config, NULL));
}

static void expect_config(enum jp_status status, const char *name)
{
    field = NULL;
    TEST_ASSERT_EQUAL_INT_MESSAGE(status, jp_patrol_init(&patrol, &config, &field), name);
    if (status == JP_OK) {
        TEST_ASSERT_NULL(field);
    } else {
        TEST_ASSERT_EQUAL_STRING(name, field);
    }
}

/* Not below `low`, not above `high`, and nothing that is not a number. */
static void check_limits(float *value, float low, float high, const char *name)
{
    const float before = *value;
    const float refused[] = {low - 1.0e-3f - 1.0e-3f * jp_plane_magnitude(low), high * 1.001f, -1.0f, not_a_number};

    *value = low;
    expect_config(JP_OK, name);
    *value = high;
    expect_config(JP_OK, name);
    for (unsigned i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        *value = refused[i];
        expect_config(JP_ERR_CONFIG, name);
    }
    *value = before;
}

static void test_limits_of_each_field(void)
{
    const float least = 1.0e-3f;
    const float most = 1000.0f;

    check_limits(&config.scan.range_max, least, most, "scan.range_max");
    check_limits(&config.scan.gap, least, most, "scan.gap");
    check_limits(&config.scan.tolerance, least, most, "scan.tolerance");
    check_limits(&config.teb.speed_max, least, 16.0f, "teb.speed_max");
    check_limits(&config.teb.reverse_max, least, 16.0f, "teb.reverse_max");
    check_limits(&config.teb.turn_rate_max, least, 16.0f, "teb.turn_rate_max");
    config.heading_tolerance = least;
    check_limits(&config.turn_first, least, JP_PLANE_PI, "turn_first");
    check_limits(&config.turn_rate, least, 16.0f, "turn_rate");
    check_limits(&config.turn_acceleration, least, most, "turn_acceleration");
    check_limits(&config.turn_clearance, 0.0f, most, "turn_clearance");
    check_limits(&config.step_speed, least, 16.0f, "step_speed");
    check_limits(&config.horizon, least, most, "horizon");
    check_limits(&config.position_tolerance, least, most, "position_tolerance");
    check_limits(&config.heading_tolerance, least, config.turn_first, "heading_tolerance");
    check_limits(&config.period, least, most, "period");
    check_limits(&config.latency, 0.0f, 1.0f, "latency");
    check_limits(&config.jump, least, most, "jump");
    check_limits(&config.blind_max, 0.0f, most, "blind_max");
    check_limits(&config.movers.extent, least, most, "movers.extent");
    config.movers.speed_max = most;
    check_limits(&config.movers.speed_min, least, most, "movers.speed_min");
    check_limits(&config.movers.speed_max, config.movers.speed_min, most, "movers.speed_max");
    check_limits(&config.movers.margin, 0.0f, most, "movers.margin");
}

static void test_limits_of_counts(void)
{
    config.scan.beams_min = 0;
    expect_config(JP_ERR_CONFIG, "scan.beams_min");
    config.scan.beams_min = 1001;
    expect_config(JP_ERR_CONFIG, "scan.beams_min");
    config.scan.beams_min = 1000;
    config.waits_max = 0;
    expect_config(JP_ERR_CONFIG, "waits_max");
    config.waits_max = 10001;
    expect_config(JP_ERR_CONFIG, "waits_max");
    config.waits_max = 10000;
    config.dropouts_max = 10001;
    expect_config(JP_ERR_CONFIG, "dropouts_max");
    config.dropouts_max = 10000;
    expect_config(JP_OK, "");
    config.waits_max = 1;
    config.dropouts_max = 0;
    expect_config(JP_OK, "");
}

static void test_wheels_and_band_are_checked(void)
{
    config.wheels.steering_limit = JP_ANGLE_DEGREES(30);
    expect_config(JP_ERR_CONFIG, "steering_limit");
    config = rig_config();
    config.teb.rounds = 0;
    expect_config(JP_ERR_CONFIG, "rounds");
}

/* ---- Poses and paths ---- */

static void test_pose_is_taken(void)
{
    const struct jp_plane_pose pose = {3.0f, -4.0f, 2.0f * JP_PLANE_PI + 1.0f};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&patrol, &pose));
    TEST_ASSERT_NEAR(1e-6f, 3.0f, patrol.pose.x);
    TEST_ASSERT_NEAR(1e-6f, -4.0f, patrol.pose.y);
    TEST_ASSERT_NEAR(1e-5f, 1.0f, patrol.pose.heading);
}

static void test_new_pose_ends_what_was_held_against_the_laser(void)
{
    patrol.jumps = 9;
    patrol.blind = 3.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&patrol, &robot));
    TEST_ASSERT_EQUAL_UINT32(0, patrol.jumps);
    TEST_ASSERT_NEAR(0.0f, 0.0f, patrol.blind);
}

static void test_wrong_poses_are_refused(void)
{
    const float infinity = 1.0f / (not_a_number != not_a_number ? 0.0f : 1.0f);
    const struct jp_plane_pose poses[] = {
        {not_a_number, 0.0f, 0.0f}, {32768.0f, 0.0f, 0.0f},     {-32768.0f, 0.0f, 0.0f}, {0.0f, not_a_number, 0.0f},
        {0.0f, infinity, 0.0f},     {0.0f, 0.0f, not_a_number}, {0.0f, 0.0f, 1001.0f},   {0.0f, 0.0f, -1001.0f},
    };

    for (unsigned i = 0; i < sizeof poses / sizeof poses[0]; i++) {
        const struct jp_patrol_goal goal = {poses[i], false};

        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_set_pose(&patrol, &poses[i]));
        TEST_ASSERT_NEAR(1e-6f, 0.0f, patrol.pose.x);
        path_count = 0;
        rig_straight(0.0f, 0.0f, 1.0f, 0.0f);
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(&patrol, path, path_count, &goal));
        rig_expect(JP_PATROL_HELD, JP_PATROL_NONE);
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_set_pose(NULL, &robot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_set_pose(&patrol, NULL));
}

static void test_wrong_paths_are_refused_and_the_old_one_stays(void)
{
    const struct jp_patrol_goal goal = {{3.0f, 0.0f, 0.0f}, true};
    const struct jp_patrol_goal beside = {{3.0f, 0.09f, 0.0f}, true};

    rig_go(3.0f, 0.0f);
    rig_cycles(5);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(NULL, path, path_count, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(&patrol, NULL, path_count, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(&patrol, path, path_count, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(&patrol, path, 1, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(&patrol, path, 0, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_follow(&patrol, path, path_count, &beside));
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_NEAR(0.08f, 3.0f, robot.x);
}

static void test_goal_may_be_off_the_end_of_the_path_by_the_tolerance(void)
{
    const struct jp_patrol_goal goal = {{2.0f, 0.07f, 0.0f}, true};

    rig_straight(0.0f, 0.0f, 2.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_follow(&patrol, path, path_count, &goal));
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_TRUE(jp_plane_length(robot.x - 2.0f, robot.y - 0.07f) < 0.08f);
}

static void test_path_of_two_points(void)
{
    rig_point(0.0f, 0.0f);
    rig_point(2.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(2.0f, 0.0f, 0.0f, true));
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_NEAR(0.08f, 2.0f, robot.x);
}

/* ---- Bad input ---- */

static void test_cycle_refuses_null_pointers(void)
{
    rig_go(3.0f, 0.0f);
    rig_cycles(3);

    const struct jp_twist before = twist;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_cycle(NULL, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_cycle(&patrol, NULL, &twist));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_cycle(&patrol, &input, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &twist, sizeof twist);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
}

static void check_bad_value(float *value, float bad)
{
    rig_reset();
    rig_go(3.0f, 0.0f);
    rig_cycles(8);
    TEST_ASSERT_TRUE(twist.x > 0);
    rig_sense();
    *value = bad;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_LOST);
    rig_expect_stand();
}

static void test_values_that_are_not_finite_stop_the_robot(void)
{
    float *const values[] = {&input.wheels.x,        &input.wheels.y, &input.wheels.heading, &input.speed.forward,
                             &input.speed.turn_rate, &input.laser.x,  &input.laser.y,        &input.laser.heading,
                             &input.sensor.x,        &input.sensor.y, &input.sensor.heading};

    for (unsigned i = 0; i < sizeof values / sizeof values[0]; i++) {
        check_bad_value(values[i], not_a_number);
        check_bad_value(values[i], 1.0e9f);
        check_bad_value(values[i], -1.0e9f);
    }
}

static void test_pose_of_a_laser_that_has_none_does_not_matter(void)
{
    rig_go(3.0f, 0.0f);
    rig_cycles(3);
    rig_sense();
    input.has_laser = false;
    input.laser.x = not_a_number;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.laser_missing);
}

static void test_robot_that_was_stopped_takes_a_new_path(void)
{
    check_bad_value(&input.wheels.x, not_a_number);
    input.wheels.x = 0.0f;
    rig_cycles(5);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_LOST);
    rig_expect_stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&patrol, &robot));
    rig_go(2.0f, 0.0f);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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

static void test_robot_follows_a_bent_path(void)
{
    rig_straight(0.0f, 0.0f, 2.0f, 0.0f);
    rig_straight(2.0f, 0.1f, 2.0f, 2.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(2.0f, 2.5f, 0.0f, true));
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_NEAR(0.08f, 2.0f, robot.x);
    TEST_ASSERT_NEAR(0.08f, 2.5f, robot.y);
}

static void test_robot_turns_in_place_before_it_drives(void)
{
    rig_go(-2.0f, 0.3f);
    rig_cycle();
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);

    float before = 0.0f;

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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.turns);
}

static void test_robot_turns_to_the_right_too(void)
{
    rig_go(0.3f, -2.0f);
    rig_cycles(3);
    rig_expect(JP_PATROL_TURNING, JP_PATROL_NONE);
    TEST_ASSERT_TRUE(twist.turn_rate < 0);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
}

static void test_robot_turns_at_the_goal(void)
{
    rig_go_to_heading(1.5f, 0.0f, -2.0f);
    (void)rig_until(JP_PATROL_TURNING, LONG);
    TEST_ASSERT_NEAR(0.08f, 1.5f, robot.x);
    rig_expect_stand();
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_NEAR(0.08f, -2.0f, robot.heading);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.turns);
}

static void test_robot_that_comes_with_the_heading_does_not_turn(void)
{
    rig_go_to_heading(1.5f, 0.0f, 0.05f);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_TRUE(robot.x > from && robot.x < from + speed * speed / 0.8f + 0.6f);
    TEST_ASSERT_NEAR(0.1f, 0.0f, robot.heading);
}

static void test_pause_before_the_goal_ends_at_the_goal(void)
{
    rig_go(0.5f, 0.0f);
    rig_cycles(6);
    jp_patrol_pause(&patrol);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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

/* ---- Waiting ---- */

static void wall_ahead(void)
{
    rig_wall(2.0f, -3.0f, 2.0f, 3.0f);
}

static void test_robot_waits_for_its_way(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(8);
    wall_ahead();
    (void)rig_until(JP_PATROL_WAITING, LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
    TEST_ASSERT_TRUE(robot.x + 0.4f < 2.0f);
    rig_cycles(10);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    wall_count = 0;
    rig_cycles(2); /* a way for a moment is none */
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
    rig_cycle();
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.waits);
    TEST_ASSERT_TRUE(patrol.counts.infeasible >= 10);
}

static void test_robot_gives_up_and_says_why(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(8);
    wall_ahead();
    (void)rig_until(JP_PATROL_WAITING, LONG);
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_NO_WAY);
    wall_count = 0;
    rig_cycles(10);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_NO_WAY);
    rig_expect_stand();
    rig_go(robot.x + 1.0f, 0.0f);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
        patrol.unmoved = 0;
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
    (void)rig_until(JP_PATROL_WAITING, LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
    wall_count = 0;
    (void)rig_until(JP_PATROL_TURNING, 10);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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

    const unsigned cycles = rig_until(JP_PATROL_STOPPED, LONG);

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

/* ---- Scans that are missing ---- */

static void test_nothing_is_driven_before_the_first_scan(void)
{
    is_blind = true;
    rig_go(4.0f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
    rig_expect_stand();
    is_blind = false;
    rig_cycles(3);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
}

static void test_few_missing_scans_do_no_harm(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    is_blind = true;
    rig_cycles(config.dropouts_max);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_EQUAL_UINT32(config.dropouts_max, patrol.counts.scans_missing);
    is_blind = false;
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.waits);
}

static void test_obstacles_stay_while_scans_are_missing(void)
{
    wall_ahead();
    rig_cycle();

    const uint8_t count = patrol.obstacles.count;

    TEST_ASSERT_TRUE(count > 0);
    is_blind = true;
    rig_cycles(2);
    TEST_ASSERT_EQUAL_UINT8(count, patrol.obstacles.count);
}

static void test_too_many_missing_scans_stop_the_robot(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    is_blind = true;
    rig_cycles(config.dropouts_max + 1U);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
    rig_expect_stand();
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_NO_SCAN);
}

static void test_scan_of_beams_that_dropped_out_is_missing(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    for (unsigned i = 0; i <= config.dropouts_max; i++) {
        rig_sense();
        for (unsigned k = 0; k < RIG_BEAMS; k++) {
            ranges[k] = k % 5U == 0U ? 3.0f : -1.0f;
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    }
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
}

static void test_gap_of_hours_is_not_taken_for_a_short_one(void)
{
    is_blind = true;
    laser_shift = 5.0f;
    rig_sense();
    for (unsigned i = 0; i < 65536U + 2U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    }
    rig_go(4.0f, 0.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
    laser_shift = 0.0f;
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_SCAN);
}

/* More shapes than fit: the nearest are kept, the others counted. */
static void test_more_obstacles_than_fit(void)
{
    config.scan.gap = 0.12f;
    rig_init();
    for (unsigned i = 0; i < 30U; i++) {
        const struct jp_plane_point along = jp_plane_direction((float)i * 2.0f * JP_PLANE_PI / 30.0f);
        const float distance = i % 3U == 0U ? 3.0f : 2.0f + 0.01f * (float)i;
        const float x = distance * along.x;
        const float y = distance * along.y;

        rig_wall(x - 0.12f * along.y, y + 0.12f * along.x, x + 0.12f * along.y, y - 0.12f * along.x);
    }
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT8(JP_OBSTACLES_MAX, patrol.obstacles.count);
    TEST_ASSERT_EQUAL_UINT32(10, patrol.counts.shapes_dropped);
    for (unsigned i = 0; i < JP_OBSTACLES_MAX; i++) {
        TEST_ASSERT_TRUE(patrol.obstacles.distance[i] < 2.5f);
    }
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT32(20, patrol.counts.shapes_dropped);
}

/* ---- Poses of the laser ---- */

static void test_laser_corrects_the_wheels(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(3);
    input.wheels.x += 0.2f; /* they slip */
    rig_cycles(4);
    TEST_ASSERT_NEAR(0.01f, robot.x - input.speed.forward * RIG_PERIOD, patrol.pose.x);
}

static void test_jump_is_rejected(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    laser_shift = 0.5f;
    rig_cycles(config.dropouts_max);
    rig_expect(JP_PATROL_DRIVING, JP_PATROL_NONE);
    TEST_ASSERT_NEAR(0.02f, robot.x - input.speed.forward * RIG_PERIOD, patrol.pose.x);
    TEST_ASSERT_EQUAL_UINT32(config.dropouts_max, patrol.counts.laser_rejected);
    laser_shift = 0.0f;
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_EQUAL_UINT32(0, patrol.counts.waits);
}

static void test_jump_of_the_heading_is_rejected(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    laser_turn = -0.5f;
    rig_cycle();
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.laser_rejected);
    TEST_ASSERT_NEAR(0.02f, 0.0f, patrol.pose.heading);
}

static void test_lasting_jump_stops_the_robot(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);
    laser_shift = 0.5f;
    rig_cycles(config.dropouts_max + 1U);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
    rig_expect_stand();
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_LOST);
}

static void test_robot_drives_some_way_without_the_laser(void)
{
    rig_go(4.0f, 0.0f);
    rig_cycles(5);

    const float from = robot.x;

    is_lost = true;
    (void)rig_until(JP_PATROL_WAITING, LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_LOST);
    TEST_ASSERT_NEAR(0.15f, from + config.blind_max, robot.x);
    is_lost = false;
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.waits);
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
}

static void test_step_stops_for_what_comes_into_it(void)
{
    leave_the_bay();
    rig_cycles(3);
    rig_wall(robot.x + 0.45f, -0.4f, robot.x + 0.45f, 0.4f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
    wall_count = 3;
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
}

static void test_step_ends_when_the_robot_stands(void)
{
    leave_the_bay();
    patrol.step_target = (struct jp_plane_point){0.0f, 0.0f};
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    wall_count--;
    rig_cycles(2);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
}

static void test_goal_beside_the_robot_is_stepped_to(void)
{
    rig_go(0.05f, 0.3f);
    rig_cycle();
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
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
    (void)rig_until(JP_PATROL_WAITING, LONG);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
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
    patrol.command.forward = 0.8f;
    input.speed.forward = 1.4f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_cycle(&patrol, &input, &twist));
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    rig_expect_stand();
}

static void test_no_room_to_turn_anywhere(void)
{
    rig_box(-0.45f, -0.35f, 0.45f, 0.35f);
    rig_go(0.0f, 2.0f);
    rig_cycle();
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
    TEST_ASSERT_EQUAL_UINT32(1, patrol.counts.infeasible);
    (void)rig_until(JP_PATROL_STOPPED, config.waits_max + 1U);
    rig_expect(JP_PATROL_STOPPED, JP_PATROL_NO_WAY);
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
    arrive_beside_the_goal(-0.08f);
    rig_expect(JP_PATROL_STEPPING, JP_PATROL_NONE);
    (void)rig_until(JP_PATROL_TURNING, 20);
    TEST_ASSERT_NEAR(0.035f, 0.0f, robot.x);
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_NEAR(0.08f, 1.5f, robot.heading);
}

static void test_robot_at_the_goal_without_room_to_turn_waits(void)
{
    rig_wall(0.45f, -2.0f, 0.45f, 2.0f);
    arrive_beside_the_goal(0.0f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
}

static void test_robot_beside_the_goal_with_no_way_there_waits(void)
{
    rig_wall(0.35f, -2.0f, 0.35f, 2.0f);
    arrive_beside_the_goal(-0.08f);
    rig_expect(JP_PATROL_WAITING, JP_PATROL_NO_WAY);
}

/* A long nose: a thing that is in the shorter way round is not in the longer one. */
static void test_robot_turns_the_longer_way_round(void)
{
    float turned = 0.0f;

    config.teb.footprint = (struct jp_footprint){0.6f, 0.2f, 0.3f};
    rig_init();
    rig_box(0.36f, 0.36f, 0.41f, 0.41f);
    rig_straight(-1.0f, 0.0f, 0.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(0.0f, 0.0f, 0.5f * JP_PLANE_PI, false));
    while (patrol.state != JP_PATROL_ARRIVED) {
        rig_cycle();
        TEST_ASSERT_TRUE(twist.turn_rate <= 0 || turned < -4.0f);
        turned += rig_from_q24(twist.turn_rate) * RIG_PERIOD;
        TEST_ASSERT_TRUE(patrol.state != JP_PATROL_WAITING && patrol.counts.cycles < LONG);
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
    (void)rig_until(JP_PATROL_ARRIVED, LONG);
    TEST_ASSERT_NEAR(0.08f, 0.5f * JP_PLANE_PI, robot.heading);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_refuses_null_pointers);
    RUN_TEST(test_limits_of_each_field);
    RUN_TEST(test_limits_of_counts);
    RUN_TEST(test_wheels_and_band_are_checked);
    RUN_TEST(test_pose_is_taken);
    RUN_TEST(test_new_pose_ends_what_was_held_against_the_laser);
    RUN_TEST(test_wrong_poses_are_refused);
    RUN_TEST(test_wrong_paths_are_refused_and_the_old_one_stays);
    RUN_TEST(test_goal_may_be_off_the_end_of_the_path_by_the_tolerance);
    RUN_TEST(test_path_of_two_points);
    RUN_TEST(test_cycle_refuses_null_pointers);
    RUN_TEST(test_values_that_are_not_finite_stop_the_robot);
    RUN_TEST(test_pose_of_a_laser_that_has_none_does_not_matter);
    RUN_TEST(test_robot_that_was_stopped_takes_a_new_path);
    RUN_TEST(test_nothing_moves_without_a_path);
    RUN_TEST(test_straight_way);
    RUN_TEST(test_robot_follows_a_bent_path);
    RUN_TEST(test_robot_turns_in_place_before_it_drives);
    RUN_TEST(test_robot_turns_to_the_right_too);
    RUN_TEST(test_robot_turns_at_the_goal);
    RUN_TEST(test_robot_that_comes_with_the_heading_does_not_turn);
    RUN_TEST(test_robot_just_past_the_goal_has_arrived);
    RUN_TEST(test_robot_that_stands_near_the_goal_has_arrived);
    RUN_TEST(test_hold_forgets_the_path);
    RUN_TEST(test_pause_stops_soon_along_the_path);
    RUN_TEST(test_pause_before_the_goal_ends_at_the_goal);
    RUN_TEST(test_pause_of_what_does_not_drive_holds);
    RUN_TEST(test_pause_of_a_robot_at_its_goal_holds);
    RUN_TEST(test_pause_after_arrival_changes_nothing);
    RUN_TEST(test_plain_band_does_not_need_the_laser);
    RUN_TEST(test_plain_band_does_not_turn_in_place);
    RUN_TEST(test_plain_band_arrives_with_the_heading_only);
    RUN_TEST(test_robot_waits_for_its_way);
    RUN_TEST(test_robot_gives_up_and_says_why);
    RUN_TEST(test_robot_does_not_try_again_and_again);
    RUN_TEST(test_thing_inside_the_footprint_stops_the_robot_at_once);
    RUN_TEST(test_start_in_collision);
    RUN_TEST(test_collision_within_the_latency);
    RUN_TEST(test_turn_stops_for_what_comes_into_it);
    RUN_TEST(test_thing_inside_the_footprint_stops_a_turn);
    RUN_TEST(test_robot_far_off_its_path_stands);
    RUN_TEST(test_robot_whose_wheels_do_not_move_it_stalls);
    RUN_TEST(test_wheels_that_cannot_do_it_are_not_asked_to);
    RUN_TEST(test_nothing_is_driven_before_the_first_scan);
    RUN_TEST(test_few_missing_scans_do_no_harm);
    RUN_TEST(test_obstacles_stay_while_scans_are_missing);
    RUN_TEST(test_too_many_missing_scans_stop_the_robot);
    RUN_TEST(test_scan_of_beams_that_dropped_out_is_missing);
    RUN_TEST(test_gap_of_hours_is_not_taken_for_a_short_one);
    RUN_TEST(test_more_obstacles_than_fit);
    RUN_TEST(test_laser_corrects_the_wheels);
    RUN_TEST(test_jump_is_rejected);
    RUN_TEST(test_jump_of_the_heading_is_rejected);
    RUN_TEST(test_lasting_jump_stops_the_robot);
    RUN_TEST(test_robot_drives_some_way_without_the_laser);
    RUN_TEST(test_robot_steps_to_where_it_can_turn);
    RUN_TEST(test_step_stops_for_what_comes_into_it);
    RUN_TEST(test_step_ends_when_the_robot_stands);
    RUN_TEST(test_robot_steps_away_from_what_it_grazes);
    RUN_TEST(test_robot_that_grazes_in_motion_stops_first);
    RUN_TEST(test_plain_band_does_not_step);
    RUN_TEST(test_robot_that_grazes_on_both_sides_waits);
    RUN_TEST(test_step_waits_for_its_way);
    RUN_TEST(test_goal_beside_the_robot_is_stepped_to);
    RUN_TEST(test_goal_close_behind_is_turned_to);
    RUN_TEST(test_goal_beside_the_robot_is_turned_to_if_no_step_is_free);
    RUN_TEST(test_goal_in_a_slot_where_no_turn_fits);
    RUN_TEST(test_command_that_leads_into_something_is_not_given);
    RUN_TEST(test_no_room_to_turn_anywhere);
    RUN_TEST(test_robot_steps_to_the_goal_to_turn_there);
    RUN_TEST(test_robot_at_the_goal_without_room_to_turn_waits);
    RUN_TEST(test_robot_beside_the_goal_with_no_way_there_waits);
    RUN_TEST(test_robot_turns_the_longer_way_round);
    RUN_TEST(test_goal_without_room_is_reached_with_its_heading);
    return UNITY_END();
}
