/* The patrol: what is refused. */
#include "tests/support/patrol_rig.h"

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
    check_limits(&config.price.second, least, 1.0e9f, "price.second");
    check_limits(&config.price.worth, 0.0f, 1024.0f, "price.worth");
    check_limits(&config.price.turning, 0.0f, 1.0e9f, "price.turning");
    check_limits(&config.price.steering, 0.0f, 1.0e9f, "price.steering");
    check_limits(&config.glide_clearance, 0.0f, most, "glide_clearance");
    config.heading_tolerance = least;
    check_limits(&config.turn_first, least, JP_PLANE_PI, "turn_first");
    check_limits(&config.turn_rate, least, 16.0f, "turn_rate");
    check_limits(&config.turn_acceleration, least, most, "turn_acceleration");
    check_limits(&config.steering_rate, least, most, "steering_rate");
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

static void test_only_known_strategies(void)
{
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    expect_config(JP_OK, NULL);
    config.strategy = (uint8_t)JP_PATROL_BY_COST + 1U;
    expect_config(JP_ERR_CONFIG, "strategy");
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
    config.scan.beams_min = 1;
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
    patrol.internal.jumps = 9;
    patrol.internal.blind = 3.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&patrol, &robot));
    TEST_ASSERT_EQUAL_UINT32(0, patrol.internal.jumps);
    TEST_ASSERT_NEAR(0.0f, 0.0f, patrol.internal.blind);
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
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_NEAR(0.08f, 3.0f, robot.x);
}

static void test_goal_may_be_off_the_end_of_the_path_by_the_tolerance(void)
{
    const struct jp_patrol_goal goal = {{2.0f, 0.07f, 0.0f}, true};

    rig_straight(0.0f, 0.0f, 2.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_follow(&patrol, path, path_count, &goal));
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
    TEST_ASSERT_TRUE(jp_plane_length(robot.x - 2.0f, robot.y - 0.07f) < 0.08f);
}

static void test_path_of_two_points(void)
{
    rig_point(0.0f, 0.0f);
    rig_point(2.0f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, rig_follow(2.0f, 0.0f, 0.0f, true));
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
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
                             &input.sensor.x,        &input.sensor.y, &input.sensor.heading, &input.deviation};

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
    (void)rig_until(JP_PATROL_ARRIVED, RIG_LONG);
}
