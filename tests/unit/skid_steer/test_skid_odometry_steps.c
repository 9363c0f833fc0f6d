/* Odometry of skid steer step by step: when the wheels stand, what is done in which tick, and where the robot is
 * between the steps. */
#include <joulepath/skid_odometry.h>

#include "unity.h"

#define STEP_TICKS 8
/* Of 40 ms each: the first ones that last a quarter of a second. */
#define STAND_STEPS 7
#define DEGREE      ((int32_t)(JP_Q24_ONE / 360))

static struct jp_skid_odometry_config config;
static struct jp_skid_odometry odometry;
static struct jp_sensors sensors;

static void start(void)
{
    jp_skid_odometry_start(&odometry, &config, &sensors);
}

void setUp(void)
{
    config = (struct jp_skid_odometry_config){
        .tick_rate = 200,
        .step_ticks = STEP_TICKS,
        .way_per_count = (int32_t)1 << 24,
        .turn_per_count = (int32_t)1 << 23,
        .ratio = JP_Q24(0.5),
        .ratio_deviation = JP_Q24(0.1),
        .scale_deviation = JP_Q24(0.01),
        .bias_deviation = JP_Q24(0.003),
        .bias_memory = 1000000,
        .gyro_noise = JP_Q24(0.0003),
        .way_noise = JP_Q24(0.005),
        .turn_noise = JP_Q24(0.03),
        .tilt_deviation = JP_Q24(0.1),
        .tilt_change = JP_Q24(0.08),
        .accel_noise = JP_Q24(0.005),
        .turn_slide_most = JP_Q24(4),
        .efficiency = JP_Q24(0.5),
    };
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE};
    start();
}

void tearDown(void)
{
}

static void tick(int32_t left, int32_t right)
{
    sensors.encoder_left += (uint32_t)left;
    sensors.encoder_right += (uint32_t)right;
    jp_skid_odometry_update(&odometry, &config, &sensors);
}

static void run(int ticks, int32_t left, int32_t right)
{
    for (int i = 0; i < ticks; i++) {
        tick(left, right);
    }
}

static void expect_stand(void)
{
    TEST_ASSERT_FALSE(odometry.internal.is_moving);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.way);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.side_way);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.wheel_turn);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.turn);
}

/* Of wheels that moved by so many counts: a quarter of a second later they stand, with every increment 0. */
static void expect_stand_after(int32_t left, int32_t right)
{
    start();
    run(STEP_TICKS, left, right);
    TEST_ASSERT_TRUE(odometry.internal.is_moving);
    for (int step = 1; step < STAND_STEPS; step++) {
        run(STEP_TICKS, 0, 0);
        TEST_ASSERT_TRUE(odometry.internal.is_moving);
    }
    for (int step = 0; step < 3; step++) {
        run(STEP_TICKS, 0, 0);
        expect_stand();
    }
}

static void test_wheels_that_stay_for_a_quarter_of_a_second_stand(void)
{
    sensors.yaw_rate = DEGREE;
    expect_stand_after(100, 300);
    expect_stand_after(-100, 0);
    expect_stand_after(0, 50);
}

/* A count that comes and goes is no motion, though it is in the increments of a step. */
static void test_a_stand_has_no_increments(void)
{
    sensors.yaw_rate = JP_Q24(0.1);
    run(STEP_TICKS - 1, 0, 0);
    tick(1, -1);
    expect_stand();
}

/* Nor is the count left that came in the last step before. */
static void test_a_stand_forgets_the_last_increments(void)
{
    run(STEP_TICKS, 100, 300);
    run((STAND_STEPS - 1) * STEP_TICKS - 1, 0, 0);
    tick(0, 1);
    TEST_ASSERT_TRUE(odometry.internal.is_moving);
    TEST_ASSERT_TRUE(odometry.internal.step.way != 0);
    run(STEP_TICKS, 0, 0);
    TEST_ASSERT_FALSE(odometry.internal.is_moving);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.way);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.side_way);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.step.wheel_turn);
}

static void test_a_step_begins_with_empty_sums(void)
{
    sensors.yaw_rate = JP_Q24(0.1);
    sensors.pitch_rate = JP_Q24(0.2);
    sensors.accel_x = JP_Q24(0.3);
    run(STEP_TICKS - 1, 100, 200);
    TEST_ASSERT_TRUE(odometry.internal.yaw_angle != 0);
    TEST_ASSERT_TRUE(odometry.internal.pitch_angle != 0);
    TEST_ASSERT_TRUE(odometry.internal.accel_sum != 0);
    tick(100, 200);
    TEST_ASSERT_TRUE(odometry.internal.yaw_angle == 0);
    TEST_ASSERT_TRUE(odometry.internal.pitch_angle == 0);
    TEST_ASSERT_EQUAL_INT32(0, odometry.internal.accel_sum);
}

/* The last tick of a step and the next five take a part of it each. */
static void test_each_tick_does_one_part_of_a_step(void)
{
    static const enum jp_skid_odometry_part parts[] = {
        JP_SKID_SLIP, JP_SKID_MOVE, JP_SKID_FILTER_HEADING, JP_SKID_CORRECT_POSE, JP_SKID_FILTER_TILT, JP_SKID_ADD_UP,
    };

    run(STEP_TICKS - 1, 100, 200);
    for (unsigned i = 0; i < sizeof parts / sizeof *parts; i++) {
        tick(100, 200);
        TEST_ASSERT_EQUAL_INT(parts[i], odometry.internal.next);
        TEST_ASSERT_EQUAL_INT(i >= 2U, odometry.x != 0);
    }
}

static void test_readings_of_the_accelerometer_are_limited_to_2_g(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        sensors.accel_x = sign * JP_Q24(1.5);
        start();
        TEST_ASSERT_EQUAL_INT32(sign * JP_Q24(1.5), odometry.internal.tilt.state[JP_SKID_TILT_AHEAD]);
        sensors.accel_x = sign * JP_Q24(3);
        start();
        TEST_ASSERT_INT32_WITHIN(1, sign * JP_Q24(2), odometry.internal.tilt.state[JP_SKID_TILT_AHEAD]);
        run(STEP_TICKS, 100, 100);
        TEST_ASSERT_INT32_WITHIN(16, sign * JP_Q24(2), odometry.internal.step.force);
        sensors.accel_x = sign * JP_Q24(1.5);
        run(STEP_TICKS, 100, 100);
        TEST_ASSERT_INT32_WITHIN(16, sign * JP_Q24(1.5), odometry.internal.step.force);
    }
}

/* Seen from above a turn on a slope is Δθ (1 + p²/2 − q²/2). */
static void test_a_slope_turns_the_heading_on_the_map(void)
{
    sensors.yaw_rate = JP_Q24(0.5);
    run(STEP_TICKS, -300, 300);
    odometry.internal.tilt.state[JP_SKID_TILT_AHEAD] = JP_Q24(0.2);
    odometry.internal.tilt.state[JP_SKID_TILT_LEFT] = JP_Q24(0.4);
    const int32_t turn = odometry.internal.step.turn;

    tick(-300, 300);
    TEST_ASSERT_TRUE(turn > 10000000);
    TEST_ASSERT_INT32_WITHIN(8, turn + (int32_t)(turn * (0.02 - 0.08)), odometry.internal.step.heading_turn);
}

/* Headed to the left on the map, what goes sideways to the left goes back along x. */
static void test_what_goes_sideways_goes_across_the_heading(void)
{
    odometry.heading = JP_PHASE_TURN / 4;
    run(STEP_TICKS + 1, 200, 200);
    odometry.internal.step.sideways = 1 << 24;
    const int32_t plan = odometry.internal.step.plan;

    tick(200, 200);
    TEST_ASSERT_INT64_WITHIN(8, -(1 << 24), odometry.x);
    TEST_ASSERT_INT64_WITHIN(8, plan, odometry.y);
}

/* ---- Between the steps ---- */

static void test_a_stand_is_where_it_is(void)
{
    struct jp_point now;
    jp_angle heading;

    odometry.heading = JP_PHASE_TURN / 8;
    odometry.x = (int64_t)3 << 32;
    sensors.yaw_rate = JP_Q24(0.5);
    run(STEP_TICKS + 3, 0, 0);
    jp_skid_odometry_now(&odometry, &config, &now, &heading);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(3), now.x);
    TEST_ASSERT_EQUAL_INT32(0, now.y);
    TEST_ASSERT_EQUAL_HEX32(jp_phase_angle(odometry.heading), heading);
}

/* From the pose on, along the mean heading of what it turned since. */
static void test_a_bend_goes_on_between_the_steps(void)
{
    struct jp_point now;
    jp_angle heading;

    sensors.yaw_rate = JP_Q24(1.5);
    for (int step = 0; step < 6; step++) {
        run(STEP_TICKS, 1000, 3000);
        run(4, 1000, 3000);
        const double turned = odometry.turn_rate / 16777216.0 * 4 / 200;
        const double ahead = odometry.speed / 16777216.0 * 4 / 200;
        const jp_angle before = jp_phase_angle(odometry.heading);
        const jp_angle middle = before + (jp_angle)(turned / 2 * 4294967296.0);
        const double x = (double)odometry.x / 4294967296.0 + ahead * (jp_cos(middle) / 2147483648.0);
        const double y = (double)odometry.y / 4294967296.0 + ahead * (jp_sin(middle) / 2147483648.0);

        jp_skid_odometry_now(&odometry, &config, &now, &heading);
        TEST_ASSERT_TRUE(turned > 0.02 && ahead > 0.05);
        TEST_ASSERT_INT32_WITHIN(4, (int32_t)(x * 65536), now.x);
        TEST_ASSERT_INT32_WITHIN(4, (int32_t)(y * 65536), now.y);
        TEST_ASSERT_INT32_WITHIN(4096, (int32_t)(turned * 4294967296.0), (int32_t)(heading - before));
        run(4, 1000, 3000);
    }
}

static void test_the_slide_of_a_turn_has_its_reciprocal(void)
{
    struct jp_path_slide slide;

    jp_skid_odometry_slide(&odometry, &config, &slide);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(0.25), slide.per_most);
    config.turn_slide_most = JP_Q24(0.5);
    start();
    jp_skid_odometry_slide(&odometry, &config, &slide);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(2), slide.per_most);
}

/* The least deviation is knowledge; none is none. */
static void test_a_scale_is_known_by_its_deviation(void)
{
    struct jp_gyro_scale told;

    jp_skid_odometry_know_scale(&odometry, &config, &(struct jp_gyro_scale){1 << 20, 1});
    jp_skid_odometry_scale(&odometry, &config, &told);
    TEST_ASSERT_EQUAL_INT32(1 << 20, told.error);
    jp_skid_odometry_know_scale(&odometry, &config, &(struct jp_gyro_scale){1 << 20, 0});
    jp_skid_odometry_scale(&odometry, &config, &told);
    TEST_ASSERT_EQUAL_INT32(0, told.error);
}
