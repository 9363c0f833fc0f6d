/* The reference: configuration, steps, exact integration across wraps, the critically damped tracker. */
#include <joulepath/reference.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/support/config_check.h"
#include "unity.h"

static struct jp_reference_config config;
static struct jp_reference reference;

void setUp(void)
{
    config = jp_robot_courier24.reference;
}

void tearDown(void)
{
}

static void start(jp_phase wheel, jp_phase yaw)
{
    jp_reference_start(&reference, &config, wheel, yaw);
}

static void step(jp_q24 speed, jp_q24 turn_rate, jp_q24 turn)
{
    const struct jp_motion motion = {speed, turn_rate};
    const struct jp_reference_step to = jp_reference_step_to(&config, &motion, turn);

    jp_reference_apply(&reference, &to);
}

static void run(int32_t ticks)
{
    for (int32_t i = 0; i < ticks; i++) {
        jp_reference_update(&reference, &config);
    }
}

DEFINE_EXPECT_CONFIG(reference)

static void test_checks_every_field_at_its_limits(void)
{
    expect_config(NULL);
    RANGE("reference.", tick_rate, 100, 10000);
    RANGE("reference.", turns_per_metre, JP_Q24(0.1), JP_Q24(16));
    AT_MOST("reference.", rest_ticks, 10000000);
    AT_LEAST("reference.", travel_bandwidth, 0);
    FIELD(travel_bandwidth, 1, "reference.travel_bandwidth");
    RANGE("reference.", travel_bandwidth, JP_Q16(0.016), JP_Q16(100));
    AT_LEAST("reference.", yaw_bandwidth, 0);
    FIELD(yaw_bandwidth, 1, "reference.yaw_bandwidth");
    RANGE("reference.", yaw_bandwidth, JP_Q16(0.016), JP_Q16(100));
}

static void test_refuses_a_bandwidth_beyond_a_quarter_of_the_tick_rate(void)
{
    config.tick_rate = 100;
    config.travel_bandwidth = JP_Q16(25);
    config.yaw_bandwidth = JP_Q16(25) + 1;
    expect_config("reference.yaw_bandwidth");
    config = jp_robot_courier24.reference;
    config.tick_rate = 100;
    config.travel_bandwidth = JP_Q16(25) + 1;
    expect_config("reference.travel_bandwidth");
    config.tick_rate = 100;
    config.travel_bandwidth = JP_Q16(25);
    expect_config(NULL);
}

static void test_stands_where_it_starts(void)
{
    start(12345, (jp_phase)0 - 77);
    run(1000);
    TEST_ASSERT_EQUAL_UINT64(12345, reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64((jp_phase)0 - 77, reference.yaw.angle);
    TEST_ASSERT_EQUAL_INT32(0, reference.wheel.rate);
    TEST_ASSERT_EQUAL_INT32(0, reference.yaw.rate);
}

static void test_step_converts_to_turns(void)
{
    start(0, 0);
    step(JP_Q24(1), JP_Q24(6.283185307179586), JP_Q24(-3.141592653589793));
    TEST_ASSERT_EQUAL_INT32(config.turns_per_metre, reference.wheel.target_rate);
    TEST_ASSERT_INT32_WITHIN(3, JP_Q24_ONE, reference.yaw.target_rate);
    TEST_ASSERT_INT32_WITHIN(2, -JP_Q24_ONE / 2, jp_phase_difference(reference.yaw.target, 0));
    TEST_ASSERT_EQUAL_UINT64(0, reference.wheel.target);

    config.turns_per_metre = JP_Q24(16); /* 8 m/s just leaves the format */
    step(JP_Q24(8), JP_Q24(-8), 0);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, reference.wheel.target_rate);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(-1.2732395447351628), reference.yaw.target_rate);
    step(JP_Q24(-8), 0, 0);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, reference.wheel.target_rate);
    TEST_ASSERT_EQUAL_INT32(0, reference.yaw.target_rate);
}

static void test_without_shaping_steps_pass_through(void)
{
    config = jp_robot_gao2018.reference;
    start(0, 0);
    step(JP_Q24(1), 0, JP_Q24(1));
    run(1);
    TEST_ASSERT_EQUAL_INT32(config.turns_per_metre, reference.wheel.rate);
    TEST_ASSERT_EQUAL_UINT64(reference.wheel.target, reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64((jp_phase)((int64_t)config.turns_per_metre * reference.phase_per_rate),
                             reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64(reference.yaw.target, reference.yaw.angle);
    TEST_ASSERT_EQUAL_INT32(0, reference.yaw.rate);
}

static void test_integration_is_exact_through_the_wrap(void)
{
    start((jp_phase)0 - 1000, 0);
    step(JP_Q24(-8), 0, 0);
    run(20000);
    TEST_ASSERT_EQUAL_UINT64((jp_phase)0 - 1000 +
                                 (jp_phase)((int64_t)reference.wheel.target_rate * reference.phase_per_rate) * 20000U,
                             reference.wheel.target);
}

static void test_speed_step_is_followed_without_lag_or_overshoot(void)
{
    start(0, 0);
    step(JP_Q24(1), JP_Q24(-0.35), 0);
    for (int32_t i = 0; i < 15000; i++) {
        jp_q24 before = reference.wheel.rate;

        run(1);
        /* 2/τ of the step at first: no step in the rate. */
        TEST_ASSERT_INT32_WITHIN(config.turns_per_metre / 350, before, reference.wheel.rate);
    }
    TEST_ASSERT_INT32_WITHIN(400, reference.wheel.target_rate, reference.wheel.rate);
    /* Each tick moves the target first: the tracker is ahead of it by the way of one tick. */
    TEST_ASSERT_INT32_WITHIN(400, -reference.wheel.target_rate / 1000,
                             jp_phase_difference(reference.wheel.target, reference.wheel.angle));
    TEST_ASSERT_INT32_WITHIN(400, reference.yaw.target_rate, reference.yaw.rate);
    TEST_ASSERT_INT32_WITHIN(400, -reference.yaw.target_rate / 1000,
                             jp_phase_difference(reference.yaw.target, reference.yaw.angle));
}

static void test_turn_is_followed_without_overshoot(void)
{
    start(0, 0);
    step(0, 0, JP_Q24(1.3962634));

    jp_q24 turn = jp_phase_difference(reference.yaw.target, 0);

    /* Below half a step of rate a tick nothing pulls: 500 steps of turn/s² are 125 of angle at 2 rad/s. */
    for (int32_t i = 0; i < 10000; i++) {
        run(1);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(turn + 130, jp_phase_difference(reference.yaw.angle, 0));
    }
    TEST_ASSERT_INT32_WITHIN(200, turn, jp_phase_difference(reference.yaw.angle, 0));
    TEST_ASSERT_EQUAL_UINT64(0, reference.wheel.angle);
}

static void test_start_angle_does_not_matter_to_the_bit(void)
{
    const jp_phase offset = (jp_phase)0 - 12345678901234567U;

    start(0, 0);
    step(JP_Q24(1), JP_Q24(0.3), JP_Q24(0.5));

    struct jp_reference other = reference;

    other.wheel.angle += offset;
    other.wheel.target += offset;
    other.yaw.angle += offset;
    other.yaw.target += offset;
    for (int32_t i = 0; i < 5000; i++) {
        run(1);
        jp_reference_update(&other, &config);
    }
    TEST_ASSERT_EQUAL_UINT64(reference.wheel.angle + offset, other.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64(reference.yaw.angle + offset, other.yaw.angle);
    TEST_ASSERT_EQUAL_INT32(reference.wheel.rate, other.wheel.rate);
    TEST_ASSERT_EQUAL_INT32(reference.yaw.rate, other.yaw.rate);
}

/* What the target's rate is, so many ticks after each other. */
static void expect_rate(jp_q24 rate, int32_t ticks)
{
    for (int32_t i = 0; i < ticks; i++) {
        run(1);
        TEST_ASSERT_EQUAL_INT32(rate, reference.wheel.target_rate);
    }
}

static void test_a_change_of_direction_rests(void)
{
    const jp_q24 rate = config.turns_per_metre;

    config.rest_ticks = 20;
    start(0, 0);
    step(-JP_Q24(1), 0, 0); /* from a stand at once */
    expect_rate(-rate, 5);
    step(JP_Q24(1), JP_Q24(0.5), 0);
    TEST_ASSERT_NOT_EQUAL_INT32(0, reference.yaw.target_rate);
    expect_rate(0, 19);
    expect_rate(rate, 30);
    step(JP_Q24(0.5), 0, 0);
    expect_rate(rate / 2, 1);
    step(0, 0, 0);
    expect_rate(0, 15);
    step(JP_Q24(1), 0, 0); /* the old direction needs no rest */
    expect_rate(rate, 1);
    step(0, 0, 0);
    expect_rate(0, 15);
    step(-JP_Q24(1), 0, 0); /* what was rested counts */
    expect_rate(0, 4);
    expect_rate(-rate, 1);
    step(0, 0, 0);
    expect_rate(0, 30);
    step(JP_Q24(1), 0, 0);
    expect_rate(rate, 1);
}

static void test_a_slow_robot_rests_for_minutes(void)
{
    config.rest_ticks = 100000;
    start(0, 0);
    step(JP_Q24(1), 0, 0);
    run(5);
    step(-JP_Q24(1), 0, 0);
    expect_rate(0, 99999);
    expect_rate(-config.turns_per_metre, 1);
}

static void test_a_step_that_waits_is_replaced_by_the_next(void)
{
    config.rest_ticks = 20;
    start(0, 0);
    step(JP_Q24(1), 0, 0);
    run(5);
    step(-JP_Q24(1), 0, 0);
    expect_rate(0, 10);
    step(0, 0, 0);
    expect_rate(0, 40);
    step(JP_Q24(1), 0, 0);
    run(1);
    step(-JP_Q24(1), 0, 0);
    run(5);
    step(JP_Q24(0.5), 0, 0);
    expect_rate(config.turns_per_metre / 2, 40);
}

/* The least rate is a direction. */
static void test_the_slowest_motion_has_a_direction(void)
{
    const struct jp_reference_step forward = {.wheel_rate = 1};
    const struct jp_reference_step backward = {.wheel_rate = -1};

    config.rest_ticks = 20;
    start(0, 0);
    jp_reference_apply(&reference, &forward);
    run(5);
    step(JP_Q24(1), 0, 0);
    TEST_ASSERT_GREATER_THAN_INT32(0, reference.wheel.target_rate);
    run(5);
    jp_reference_apply(&reference, &forward);
    TEST_ASSERT_EQUAL_INT32(1, reference.wheel.target_rate);
    jp_reference_apply(&reference, &backward);
    TEST_ASSERT_EQUAL_INT32(0, reference.wheel.target_rate);
    run(20);
    TEST_ASSERT_EQUAL_INT32(-1, reference.wheel.target_rate);
    jp_reference_apply(&reference, &forward);
    TEST_ASSERT_EQUAL_INT32(0, reference.wheel.target_rate);
}

static void test_without_a_rest_the_direction_changes_at_once(void)
{
    config.rest_ticks = 0;
    start(0, 0);
    step(JP_Q24(1), 0, 0);
    run(5);
    step(-JP_Q24(1), 0, 0);
    expect_rate(-config.turns_per_metre, 5);
}

static void test_far_target_saturates(void)
{
    config.travel_bandwidth = JP_Q16(100);
    start(0, 0);
    reference.wheel.target = JP_PHASE_TURN * 127;
    run(1);
    /* INT32_MAX turn/s² for one tick. */
    TEST_ASSERT_INT32_WITHIN(2, INT32_MAX / 1000, reference.wheel.rate);
    run(5000);
    TEST_ASSERT_TRUE(reference.wheel.rate != 0);
}

/* A robot that moves when the reference starts */

static void coast(jp_q24 wheel_rate, jp_q24 yaw_rate)
{
    jp_reference_coast(&reference, &config, wheel_rate, yaw_rate);
}

static void test_without_shaping_coasting_changes_nothing(void)
{
    struct jp_reference before;

    config.travel_bandwidth = 0;
    config.yaw_bandwidth = 0;
    start(12345, 678);
    before = reference;
    coast(JP_Q24(1), JP_Q24(-1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &reference, sizeof before);
}

static void test_coasting_begins_at_the_rates_of_the_robot(void)
{
    start(12345, 678);
    coast(JP_Q24(1), JP_Q24(-0.5));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(1), reference.wheel.rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(-0.5), reference.yaw.rate);
    TEST_ASSERT_EQUAL_UINT64(12345, reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64(678, reference.yaw.angle);
    run(1); /* 2/τ of the rate a second */
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(1 - 2 * 0.001), reference.wheel.rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0001), JP_Q24(-0.5 + 8 * 0.0005), reference.yaw.rate);
}

/* Of a critically damped tracker that starts with rate r: r t exp(−t/τ), most at τ. */
static void check_coasting(jp_q24 rate)
{
    jp_q24 farthest = 0;

    start(0, 0);
    coast(rate, -rate);
    for (int32_t i = 1; i <= 10000; i++) {
        jp_q24 way;

        run(1);
        way = jp_phase_difference(reference.wheel.angle, 0);
        farthest = rate > 0 ? (way > farthest ? way : farthest) : (way < farthest ? way : farthest);
        if (i == 250) { /* τ of the yaw */
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), -rate / 1000 * 92, jp_phase_difference(reference.yaw.angle, 0));
        }
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), rate / 10000 * 3679, farthest);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), 0, reference.wheel.rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), 0, reference.yaw.rate);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), 0, jp_phase_difference(reference.wheel.angle, 0));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), 0, jp_phase_difference(reference.yaw.angle, 0));
}

static void test_coasting_ends_at_rest_where_it_began(void)
{
    check_coasting(JP_Q24(1));
    check_coasting(-JP_Q24(0.7));
}

/* A trajectory */

static void track(jp_q24 wheel_rate, jp_q24 yaw_rate)
{
    const struct jp_set_point point = {wheel_rate, yaw_rate, JP_Q24(0.01), JP_Q24(-0.02), JP_Q16(3), JP_Q16(-4)};

    jp_reference_track(&reference, &point);
}

static void test_tracking_integrates_by_the_mean_rate(void)
{
    const int64_t tick = jp_phase_per_rate(config.tick_rate);

    start((jp_phase)0 - 1000, 1000);
    track(JP_Q24(1), JP_Q24(-0.5));
    TEST_ASSERT_EQUAL_UINT64((jp_phase)0 - 1000 + (jp_phase)(JP_Q24(1) * tick / 2), reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64((jp_phase)1000 - (jp_phase)(JP_Q24(0.5) * tick / 2), reference.yaw.angle);
    track(JP_Q24(3), JP_Q24(-0.25));
    TEST_ASSERT_EQUAL_UINT64((jp_phase)0 - 1000 + (jp_phase)(JP_Q24(2.5) * tick), reference.wheel.angle);
    TEST_ASSERT_EQUAL_UINT64((jp_phase)1000 - (jp_phase)(JP_Q24(0.625) * tick), reference.yaw.angle);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(3), reference.wheel.rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(-0.25), reference.yaw.rate);
}

static void test_tracking_takes_the_set_point_as_it_is(void)
{
    start(0, 0);
    track(JP_Q24(1), JP_Q24(0.5));
    TEST_ASSERT_EQUAL_UINT64(reference.wheel.angle, reference.wheel.target);
    TEST_ASSERT_EQUAL_UINT64(reference.yaw.angle, reference.yaw.target);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(1), reference.wheel.target_rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.5), reference.yaw.target_rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.01), reference.pitch);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(-0.02), reference.pitch_rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(3), reference.common);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-4), reference.difference);
}

static void test_the_lead_adds_to_the_set_points_turn_rate(void)
{
    start(0, 0);
    reference.yaw_lead = JP_Q24(0.125);
    track(JP_Q24(1), JP_Q24(0.5));
    TEST_ASSERT_EQUAL_INT32(JP_Q24(0.625), reference.yaw.rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(1), reference.wheel.rate);
    reference.yaw_lead = INT32_MAX;
    track(JP_Q24(1), JP_Q24(0.5));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, reference.yaw.rate);
}

static void test_a_step_ends_the_tracking(void)
{
    start(0, 0);
    reference.yaw_lead = JP_Q24(0.125);
    track(JP_Q24(1), JP_Q24(0.5));
    step(0, 0, 0);
    jp_reference_leave_track(&reference);
    TEST_ASSERT_EQUAL_INT32(0, reference.pitch);
    TEST_ASSERT_EQUAL_INT32(0, reference.pitch_rate);
    TEST_ASSERT_EQUAL_INT32(0, reference.yaw_lead);
    TEST_ASSERT_EQUAL_INT32(0, reference.common);
    TEST_ASSERT_EQUAL_INT32(0, reference.difference);
    /* It slows down from the rate that it had. */
    TEST_ASSERT_EQUAL_INT32(JP_Q24(1), reference.wheel.rate);
    run(1);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(0.998), reference.wheel.rate);
    run(15000);
    TEST_ASSERT_INT32_WITHIN(400, 0, reference.wheel.rate);
}
