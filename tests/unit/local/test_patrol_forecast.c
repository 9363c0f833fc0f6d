/* What a leg is planned to take, and how much more legs take than that. */
#include <joulepath/patrol_forecast.h>
#include <stddef.h>

#include "src/local/patrol_glide.h"
#include "src/local/patrol_price.h"
#include "tests/support/patrol_rig.h"

/* 25 W standing, 100 W a wheel's metre a second of 1000 N; steering 1 J/rad. */
static const struct jp_four_wheel_energy_model model = {
    .wheelbase = JP_Q24(0.5),
    .track = JP_Q24(0.44),
    .weight = JP_Q16(1000),
    .rolling = JP_Q24(0.01),
    .inertia = 0,
    .driving = JP_Q24_ONE,
    .braking = JP_Q24_ONE,
    .steering = JP_Q16_ONE,
    .contact = JP_Q24(0.01),
    .electronics_power = JP_Q16(25),
};

static struct jp_four_wheel_drive drive;
static float duration;

static void expect_within(float tolerance, float expected, float actual)
{
    TEST_ASSERT_TRUE(jp_plane_magnitude(actual - expected) <= tolerance);
}

void setUp(void)
{
    rig_reset();
    config.teb.speed_max = 1.0f;
    config.teb.acceleration = 0.5f;
    drive = (struct jp_four_wheel_drive){0};
    duration = 0.0f;
}

void tearDown(void)
{
}

static struct jp_patrol_plan plan_to(float x, float y, float heading, bool is_heading_free)
{
    path_count = 0;
    rig_straight(0.0f, 0.0f, x, y);
    return (struct jp_patrol_plan){.start = {0.0f, 0.0f, 0.0f},
                                   .path = path,
                                   .path_count = path_count,
                                   .goal = {{x, y, heading}, is_heading_free},
                                   .tick_rate = 100};
}

/* What is asked acts late, as the robot sets off and as it stops. */
static float delays(void)
{
    return 2.0f * config.latency + config.period;
}

/* A turn is asked for and seen to have ended. */
static float turn_delay(void)
{
    return config.latency + config.period;
}

/* Beside the delays, in which it stands. */
static void expect_leg(const struct jp_patrol_plan *plan, float drive_seconds, float drive_joules)
{
    const float seconds = drive_seconds + delays();
    const float joules = drive_joules + 25.0f * delays();

    drive = (struct jp_four_wheel_drive){0};
    duration = 0.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, plan, &drive, &duration));
    expect_within(0.02f * seconds + 0.01f, seconds, duration);
    expect_within(0.03f * joules + 0.1f, joules, (float)drive.energy / 65536.0f);
}

/* 2 s up, 2 m at 1 m/s, 2 s down; 10 N over 4 m. */
static void test_a_straight_leg(void)
{
    const struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 0.0f, true);

    expect_leg(&plan, 6.0f, 6.0f * 25.0f + 40.0f);
}

static void test_legs_add_up(void)
{
    const struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 0.0f, true);

    expect_leg(&plan, 6.0f, 190.0f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(0.2f, 12.0f + 2.0f * delays(), duration);
}

/* Ground that rises eastward by a tenth from the middle of its first cell to that of its last. */
static const struct jp_terrain *make_slope(void)
{
    enum { SIDE = 8 };
    static struct jp_terrain ground;
    static uint64_t block[SIDE * SIDE];
    const struct jp_terrain_config terrain = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16_ONE, .has_elevation = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&ground, &terrain, block, sizeof block, &field));
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        const jp_elevation elevation = (jp_elevation)(i % SIDE * JP_ELEVATION_ONE / 10);

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&ground, i % SIDE, i / SIDE, elevation));
    }
    return &ground;
}

/* Up by 0.35 m of 1 000 N, for beside the first cell's middle it is level; and down again. */
static void test_a_leg_on_a_slope(void)
{
    struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 0.0f, true);

    plan.ground = make_slope();
    expect_leg(&plan, 6.0f, 190.0f + 350.0f);
    path_count = 0;
    rig_straight(4.0f, 0.0f, 0.0f, 0.0f);
    plan.start = (struct jp_plane_pose){4.0f, 0.0f, JP_PLANE_PI};
    plan.goal.pose = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    drive = (struct jp_four_wheel_drive){0};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(5.0f, 190.0f - 350.0f + 25.0f * delays(), (float)(int32_t)drive.energy / 65536.0f);
}

/* The rest of the way into a goal is up, too. */
static void test_driving_in_on_a_slope(void)
{
    struct jp_patrol_plan plan = plan_to(2.0f, 0.0f, 0.0f, true);
    float level;

    plan.goal.pose.x = 4.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    level = (float)(int32_t)drive.energy;
    plan.ground = make_slope();
    drive = (struct jp_four_wheel_drive){0};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(8.0f, 350.0f, ((float)(int32_t)drive.energy - level) / 65536.0f);
}

/* Half a turn at 1 rad/s with a ramp of 2/3 s; the wheels by 48.7° before and after, at 200°/s. */
static void test_turning_first(void)
{
    const struct jp_patrol_plan plan = plan_to(-4.0f, 0.0f, 0.0f, true);
    const float steering = 2.0f * 0.8491f;
    const float seconds = 3.1416f + 0.667f + steering / 3.4907f + turn_delay();

    expect_leg(&plan, 6.0f + seconds, 190.0f + seconds * 25.0f + 4.0f * steering + 3.1416f * 0.333f * 10.0f);
}

/* A quarter is glided but for what a glide cannot. */
static void test_gliding_takes_less_than_turning_first(void)
{
    const struct jp_patrol_plan plan = plan_to(0.0f, 4.0f, 0.0f, false);
    struct jp_four_wheel_drive first = {0};
    float seconds = 0.0f;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &first, &seconds));
    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    TEST_ASSERT_TRUE(duration < seconds);
    TEST_ASSERT_TRUE(drive.energy < first.energy);
}

/* All of it. */
static void test_a_small_turn_is_glided(void)
{
    const struct jp_patrol_plan plan = plan_to(3.0f, 3.0f, 0.7854f, false);
    const float seconds = 2.0f + 4.2426f + 0.7854f / 3.4907f;

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    expect_leg(&plan, seconds, seconds * 25.0f + 42.4f + 4.0f * 0.7854f);
}

/* Of two points: 2 s up, 8 m at 1 m/s, 2 s down; 10 N over 10 m. */
static void test_a_long_piece_is_driven_at_the_greatest_speed(void)
{
    struct jp_patrol_plan plan = plan_to(10.0f, 0.0f, 0.0f, true);

    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(10.0f, 0.0f);
    plan.path_count = path_count;
    expect_leg(&plan, 12.0f, 12.0f * 25.0f + 100.0f);
}

/* From 1 m/s a bend of a right angle within 0.2 m is come to too fast: what speed it ends with is the bend's. */
static void test_a_sharp_bend_at_full_speed(void)
{
    struct jp_patrol_plan plan = plan_to(4.0f, 4.0f, 0.0f, true);

    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(4.0f, 0.0f);
    rig_point(4.0f, 0.2f);
    rig_point(4.0f, 4.0f);
    plan.path_count = path_count;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    TEST_ASSERT_TRUE(duration > 8.0f / 1.0f + 2.0f && duration < 16.0f);
}

/* In one piece, from stand to stand. */
static void test_a_path_of_two_points(void)
{
    struct jp_patrol_plan plan = plan_to(0.5f, 0.0f, 0.0f, true);

    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(0.5f, 0.0f);
    plan.path_count = path_count;
    expect_leg(&plan, 2.0f, 55.0f);
}

static void test_a_point_that_comes_twice_counts_once(void)
{
    struct jp_patrol_plan plan = plan_to(0.5f, 0.0f, 0.0f, true);

    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(0.0f, 0.0f);
    rig_point(0.5f, 0.0f);
    plan.path_count = path_count;
    expect_leg(&plan, 2.0f, 55.0f);
}

static void test_a_small_angle_is_driven(void)
{
    const struct jp_patrol_plan plan = plan_to(4.0f, 1.0f, 0.245f, false);

    expect_leg(&plan, 6.12f, 6.12f * 25.0f + 41.2f);
}

/* Its wheels stay as they are. */
static void test_turning_to_the_goal(void)
{
    const struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 3.1416f, false);
    const float steering = 0.8491f;
    const float seconds = 3.1416f + 0.667f + steering / 3.4907f + turn_delay();

    expect_leg(&plan, 6.0f + seconds, 190.0f + seconds * 25.0f + 4.0f * steering + 3.1416f * 0.333f * 10.0f);
    config.turns_in_place = false;
    expect_leg(&plan, 6.0f, 190.0f);
}

/* Of 1 m radius at 0.5 rad/s: half as fast. */
static void test_bends_are_driven_slower(void)
{
    struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 0.0f, true);

    config.teb.turn_rate_max = 0.5f;
    path_count = 0;
    for (int i = 0; i <= 31; i++) {
        const float angle = 0.1f * (float)i;
        rig_point(jp_plane_sine(angle), 1.0f - jp_plane_cosine(angle));
    }
    plan.path_count = path_count;
    plan.goal.pose.x = jp_plane_sine(3.1f);
    plan.goal.pose.y = 1.0f - jp_plane_cosine(3.1f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(0.6f, 7.0f + delays(), duration);
}

/* The path ends 0.9 m before the goal, with a stop: 0.9 m from stand to stand take 2·√(0.9/0.5) s. */
static void test_drives_in_from_where_the_path_ends(void)
{
    struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 0.0f, false);
    const float in = 2.0f * jp_plane_square_root(0.9f / 0.5f) + delays();

    plan.goal.pose.x = 4.9f;
    expect_leg(&plan, 6.0f + in, (6.0f + in) * 25.0f + 49.0f);
    plan.goal.pose.x = 4.0f + config.position_tolerance / 2.0f;
    expect_leg(&plan, 6.0f, 190.0f);
}

/* It turns before it, and its wheels go to it and back. */
static void test_turns_before_it_drives_in(void)
{
    struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 3.1416f, false);
    const float steering = 2.0f * 0.8491f;
    const float turn = 3.1416f + 0.667f + steering / 3.4907f + turn_delay();
    const float in = 2.0f * jp_plane_square_root(0.9f / 0.5f) + delays();

    plan.goal.pose.x = 3.1f;
    expect_leg(&plan, 6.0f + turn + in,
               (6.0f + turn + in) * 25.0f + 49.0f + 4.0f * steering + 3.1416f * 0.333f * 10.0f);
}

static float seconds_of(const struct jp_patrol_plan *plan)
{
    duration = 0.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, plan, &drive, &duration));
    return duration;
}

/* A quarter, in which no glide takes part; the wheels stay as they are. */
static void test_turning_on_the_spot(void)
{
    struct jp_patrol_plan plan = plan_to(0.0f, 0.0f, 1.5708f, false);
    const float seconds = 1.5708f + 0.667f + 0.8491f / 3.4907f + turn_delay();
    const float joules = seconds * 25.0f + 4.0f * 0.8491f + 1.5708f * 0.333f * 10.0f;

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(0.0f, 0.0f);
    plan.path_count = path_count;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(0.02f, seconds, duration);
    expect_within(1.0f, joules, (float)drive.energy / 65536.0f);
    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(0.0f, 0.9f * config.position_tolerance);
    expect_within(0.02f, seconds, seconds_of(&plan));
    plan.start.heading = 1.5f;
    drive = (struct jp_four_wheel_drive){0};
    duration = 0.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(1.0e-6f, 0.0f, duration);
}

/* 1 rad is glided on a way of 3 m, and half of it on one of 0.3 m. */
static void test_a_glide_into_the_goal_needs_a_way(void)
{
    const struct jp_patrol_plan from_afar = plan_to(3.0f, 0.0f, 1.0f, false);

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    expect_leg(&from_afar, 5.0f, 25.0f * 5.0f + 30.0f);

    const struct jp_patrol_plan near = plan_to(0.3f, 0.0f, 1.0f, false);
    const float turn = 2.0f * jp_plane_square_root(0.5f / 1.5f) + (0.8491f + 0.5f) / 3.4907f + turn_delay();

    expect_within(0.05f, delays() + 2.0f * jp_plane_square_root(0.3f / 0.5f) + turn, seconds_of(&near));
}

/* Where a glide sets off that takes the whole way, all is left to turn at the goal. */
static void test_no_glide_into_the_goal_behind_another(void)
{
    const struct jp_patrol_plan any_heading = plan_to(0.35f, 0.45f, 0.0f, true);
    const float before = seconds_of(&any_heading);
    const struct jp_patrol_plan plan = plan_to(0.35f, 0.45f, 2.5f, false);
    const float rest = 2.5f - jp_plane_bearing(0.35f, 0.45f);

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    config.step_speed = 0.05f;
    TEST_ASSERT_TRUE(seconds_of(&any_heading) < before);
    expect_within(0.1f,
                  seconds_of(&any_heading) + jp_patrol_turn_seconds(&config, rest) + 0.8491f / 3.4907f + turn_delay(),
                  seconds_of(&plan));
}

/* A goal at the robot's side that wants its heading: the wheels across, at 0.2 m/s. */
static void test_a_step_to_the_goal(void)
{
    const struct jp_patrol_plan plan = plan_to(0.0f, 0.4f, 0.0f, false);
    const struct jp_patrol_plan at_any_heading = plan_to(0.0f, 0.4f, 0.0f, true);
    const float seconds = 0.4f / 0.2f + 1.5708f / 3.4907f;

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    expect_leg(&plan, seconds, seconds * 25.0f + 4.0f * 1.5708f + 4.0f);
    expect_leg(&at_any_heading, seconds, seconds * 25.0f + 4.0f * 1.5708f + 4.0f);
    config.turns_in_place = false;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
}

/* What is left to the goal's heading is turned after the step, from the angles of its wheels. */
static void test_a_step_and_a_turn(void)
{
    const struct jp_patrol_plan plan = plan_to(-0.2f, 0.05f, 0.9f, false);
    const float askew = jp_plane_bearing(0.2f, 0.05f);
    const float turn = 2.0f * jp_plane_square_root(0.9f / 1.5f) + (askew + 0.8491f) / 3.4907f + turn_delay();

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    config.turn_first = 1.5f;
    config.heading_tolerance = 1.0f;

    const float step = seconds_of(&plan);

    config.heading_tolerance = 0.08f;
    expect_within(0.05f, step + turn, seconds_of(&plan));
}

/* What is not a straight way to the goal is not stepped. */
static void test_no_step_round_a_corner_or_before_the_last_leg(void)
{
    struct jp_patrol_plan plan = plan_to(0.0f, 0.4f, 0.0f, false);

    config.strategy = (uint8_t)JP_PATROL_BY_COST;

    const float step = seconds_of(&plan);

    plan.goal.pose.y = 0.6f;
    TEST_ASSERT_TRUE(seconds_of(&plan) > step + 1.0f);
    plan = plan_to(0.0f, 0.4f, 0.0f, false);
    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(-0.1f, 0.2f);
    rig_point(0.0f, 0.4f);
    plan.path_count = path_count;
    TEST_ASSERT_TRUE(seconds_of(&plan) > step + 1.0f);
}

/* Ten degrees beyond what a glide takes are turned first, three are not. */
static void test_little_is_not_turned_before_a_glide(void)
{
    float seconds[2];

    config.strategy = (uint8_t)JP_PATROL_BY_COST;
    config.heading_tolerance = 0.02f;
    for (unsigned i = 0; i < 2U; i++) {
        const float angle = jp_patrol_askew_max(&config) + (i == 0U ? 0.17f : 0.05f);
        const struct jp_patrol_plan plan =
            plan_to(4.0f * jp_plane_cosine(angle), 4.0f * jp_plane_sine(angle), 0.0f, true);

        seconds[i] = seconds_of(&plan);
    }
    TEST_ASSERT_TRUE(seconds[0] > seconds[1] + 0.5f);
}

static void test_a_leg_on_the_spot(void)
{
    struct jp_patrol_plan plan = plan_to(0.0f, 0.0f, 0.0f, true);

    path_count = 0;
    rig_point(0.0f, 0.0f);
    rig_point(0.0f, 0.0f);
    plan.path_count = path_count;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(1e-6f, 0.0f, duration);
}

/* A turn so slow that it exceeds a piece's format. */
static void test_a_piece_that_does_not_fit_is_limited(void)
{
    struct jp_patrol_plan plan = plan_to(0.0f, 4.0f, 0.0f, true);

    config.turn_rate = 0.001f;
    config.turn_acceleration = 1000.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    expect_within(3.0f * 25.0f, 262.0f * 25.0f, (float)drive.energy / 65536.0f);
}

/* Steered so far that no piece can hold it. */
static void test_a_piece_out_of_range_is_left_out(void)
{
    struct jp_patrol_plan plan = plan_to(0.0f, 4.0f, 0.0f, true);

    plan.tick_rate = 1U << 30;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    TEST_ASSERT_TRUE(duration > 6.0f);
}

static void test_bad_arguments(void)
{
    struct jp_patrol_plan plan = plan_to(4.0f, 0.0f, 0.0f, true);

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(NULL, &model, &plan, &drive, &duration));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, NULL, &plan, &drive, &duration));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, &model, NULL, &drive, &duration));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, &model, &plan, NULL, &duration));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, &model, &plan, &drive, NULL));
    plan.path_count = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    plan = plan_to(4.0f, 0.0f, 0.0f, true);
    plan.path = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
    plan = plan_to(4.0f, 0.0f, 0.0f, true);
    plan.tick_rate = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_plan_energy(&config, &model, &plan, &drive, &duration));
}

/* 100 J, of which 20 are of rolling and 50 of electronics. */
static void test_a_plan_follows_what_is_learned_of_the_robot(void)
{
    static const jp_q16 before[JP_FOUR_WHEEL_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16(2), JP_Q16(0.5)};
    static const jp_q16 least[JP_FOUR_WHEEL_FACTORS] = {1, 1, 1, 1};
    struct jp_four_wheel_drive plan = {.energy = JP_Q16(100)};
    jp_q16 after[JP_FOUR_WHEEL_FACTORS] = {JP_Q16_ONE, JP_Q16_ONE, JP_Q16(2), JP_Q16(0.5)};

    plan.change[0] = JP_Q16(20);
    plan.change[3] = JP_Q16(50);
    expect_within(1e-6f, 1.0f, jp_patrol_plan_ratio(&plan, before, after));
    after[0] = JP_Q16(1.5);
    after[2] = JP_Q16(4);
    expect_within(1e-6f, 1.1f, jp_patrol_plan_ratio(&plan, before, after));
    after[3] = JP_Q16(0.75);
    expect_within(1e-6f, 1.35f, jp_patrol_plan_ratio(&plan, before, after));
    plan.change[3] = JP_Q16(80);
    expect_within(1e-6f, 0.25f, jp_patrol_plan_ratio(&plan, before, least));
    plan.energy = 0;
    expect_within(1e-6f, 1.0f, jp_patrol_plan_ratio(&plan, before, after));
}

/* ---- Pace ---- */

static void test_nothing_is_known_at_first(void)
{
    const struct jp_patrol_pace pace = {0};

    expect_within(1e-6f, 1.2f, jp_patrol_pace_factor(&pace, 1.2f));
    expect_within(1e-6f, 0.2f, jp_patrol_pace_deviation(&pace));
}

static void test_a_factor_is_learned(void)
{
    struct jp_patrol_pace pace = {0};

    for (int i = 0; i < 60; i++) {
        jp_patrol_pace_learn(&pace, 1.0f, 100.0f, 125.0f);
    }
    expect_within(0.04f, 1.25f, jp_patrol_pace_factor(&pace, 1.0f));
    TEST_ASSERT_TRUE(jp_patrol_pace_deviation(&pace) < 0.1f);
    TEST_ASSERT_EQUAL_UINT32(60, pace.legs);
}

static void test_legs_count_by_their_energy(void)
{
    struct jp_patrol_pace pace = {0};

    for (int i = 0; i < 100; i++) {
        jp_patrol_pace_learn(&pace, 1.0f, i % 2 == 0 ? 300.0f : 100.0f, i % 2 == 0 ? 300.0f : 120.0f);
    }
    expect_within(0.03f, 1.05f, jp_patrol_pace_factor(&pace, 1.0f));
    expect_within(0.05f, 0.11f, jp_patrol_pace_deviation(&pace));
}

/* Somebody was in the way. */
static void test_a_leg_far_off_counts_little(void)
{
    struct jp_patrol_pace pace = {0};

    for (int i = 0; i < 20; i++) {
        jp_patrol_pace_learn(&pace, 1.0f, 100.0f, 101.0f);
    }
    jp_patrol_pace_learn(&pace, 1.0f, 100.0f, 1000.0f);
    expect_within(0.03f, 1.03f, jp_patrol_pace_factor(&pace, 1.0f));
    jp_patrol_pace_learn(&pace, 1.0f, 100.0f, 1.0f);
    expect_within(0.03f, 1.01f, jp_patrol_pace_factor(&pace, 1.0f));
}

static void test_the_count_saturates(void)
{
    struct jp_patrol_pace pace = {.planned = 1.0f, .driven = 1.0f, .legs = UINT32_MAX};

    jp_patrol_pace_learn(&pace, 1.0f, 1.0f, 1.0f);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, pace.legs);
}
