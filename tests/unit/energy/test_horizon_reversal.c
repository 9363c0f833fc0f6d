/* A change of direction: the rest between, and what comes after it. */
#include <joulepath/horizon.h>
#include <joulepath/tables.h>

#include <stddef.h>

#include "unity.h"

static const struct jp_energy_model *const model = &jp_energy_model_courier24;
static const struct jp_segment_command stand = {{0, 0}, 0, JP_Q16(1)};

static struct jp_horizon horizon;
static struct jp_energy_start start;
static struct jp_energy_start end;
static jp_q16 energy;

void setUp(void)
{
    horizon = jp_horizon_courier24;
    start = (struct jp_energy_start){.motion = {0, 0}};
    end = start;
    energy = 0;
}

void tearDown(void)
{
}

static enum jp_status forecast(const struct jp_horizon *table, struct jp_segment_command segment)
{
    return jp_energy_forecast(model, table, &start, &segment, &energy, &end);
}

static const struct jp_segment_command forward = {{JP_Q24(1), 0}, 0, JP_Q16(4)};
static const struct jp_segment_command back = {{JP_Q24(-1), JP_Q24(0.5)}, JP_Q24(0.25), JP_Q16(4)};

/** After four seconds forward. */
static void start_forward(double rest)
{
    horizon.reversal_rest = JP_Q16(rest);
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, forward));
    start = end;
}

static jp_q16 energy_of(struct jp_segment_command segment)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, segment));
    start = end;
    return energy;
}

static void expect_same_end(const struct jp_energy_start *expected)
{
    TEST_ASSERT_EQUAL_INT32(expected->motion.speed, end.motion.speed);
    TEST_ASSERT_EQUAL_INT32(expected->motion.turn_rate, end.motion.turn_rate);
    TEST_ASSERT_EQUAL_INT32(expected->reversal_rest, end.reversal_rest);
    TEST_ASSERT_EQUAL_INT32(expected->is_forward, end.is_forward);
    TEST_ASSERT_EQUAL_INT32_ARRAY(expected->transient.travel, end.transient.travel, JP_AXIS_MODES);
    TEST_ASSERT_EQUAL_INT32_ARRAY(expected->transient.yaw, end.transient.yaw, JP_AXIS_MODES);
}

static void test_the_rest_is_remembered(void)
{
    start_forward(1.5);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1.5), end.reversal_rest);
    TEST_ASSERT_TRUE(end.is_forward);
    (void)energy_of((struct jp_segment_command){{0, 0}, 0, JP_Q16(1)});
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.5), end.reversal_rest);
    TEST_ASSERT_TRUE(end.is_forward);
    (void)energy_of((struct jp_segment_command){{0, 0}, 0, JP_Q16(1)});
    TEST_ASSERT_EQUAL_INT32(0, end.reversal_rest);
    (void)energy_of(back);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1.5), end.reversal_rest);
    TEST_ASSERT_FALSE(end.is_forward);
}

static void test_a_change_of_direction_is_a_rest_and_what_is_left(void)
{
    start_forward(1.5);
    const struct jp_energy_start begin = start;
    const struct jp_segment_command resting = {{0, back.motion.turn_rate}, back.turn, JP_Q16(1.5)};
    const struct jp_segment_command driving = {back.motion, 0, JP_Q16(2.5)};
    const jp_q16 in_pieces = energy_of(resting) + energy_of(driving);
    const struct jp_energy_start expected = end;

    start = begin;
    TEST_ASSERT_INT32_WITHIN(2, in_pieces, energy_of(back));
    expect_same_end(&expected);
    TEST_ASSERT_FALSE(end.is_forward);
}

static void test_a_short_change_of_direction_only_rests(void)
{
    start_forward(10);
    const struct jp_energy_start begin = start;
    const struct jp_segment_command resting = {{0, back.motion.turn_rate}, back.turn, back.duration};
    const jp_q16 rested = energy_of(resting);
    const struct jp_energy_start expected = end;

    start = begin;
    TEST_ASSERT_EQUAL_INT32(rested, energy_of(back));
    expect_same_end(&expected);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(6), end.reversal_rest);
    TEST_ASSERT_TRUE(end.is_forward);
}

static void test_the_same_direction_and_a_stand_do_not_rest(void)
{
    start_forward(1.5);
    const struct jp_energy_start begin = start;
    const jp_q16 onward = energy_of(forward);

    start = begin;
    start.reversal_rest = 0;
    TEST_ASSERT_EQUAL_INT32(onward, energy_of(forward));
    start = begin;
    const jp_q16 stopped = energy_of(stand);

    start = begin;
    start.reversal_rest = 0;
    TEST_ASSERT_EQUAL_INT32(stopped, energy_of(stand));
}

static void test_without_a_horizon_nothing_rests(void)
{
    const struct jp_segment_command longer = {back.motion, back.turn, JP_Q16(8)};

    start_forward(1.5);
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(NULL, longer));
    TEST_ASSERT_EQUAL_INT32(0, end.reversal_rest);
    const jp_q16 at_once = energy;

    start = (struct jp_energy_start){.motion = forward.motion};
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(NULL, longer));
    TEST_ASSERT_EQUAL_INT32(at_once, energy);
}

/** What the rest leaves is limited; what comes after it fits. */
static void test_a_transient_is_limited_within_a_rest(void)
{
    const struct jp_segment_command reversal = {{JP_Q24(-0.1), 0}, 0, JP_Q16(4)};
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;

    horizon.travel.step[0][0] = -JP_Q16(512);
    horizon.reversal_rest = JP_Q16(0.5);
    start.motion.speed = JP_Q24(8);
    start.transient.travel[0] = JP_Q16(4096);
    start.reversal_rest = JP_Q16(0.5);
    start.is_forward = true;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW, forecast(&horizon, reversal));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_OVERFLOW,
                            jp_energy_regressors(model, &horizon, &start, &reversal, regressor, &rest));
    TEST_ASSERT_EQUAL_INT32(reversal.motion.speed, end.motion.speed);
}

static void test_a_rest_in_range(void)
{
    start.reversal_rest = JP_Q16(1000);
    TEST_ASSERT_EQUAL_INT32(JP_OK, forecast(&horizon, stand));
    start.reversal_rest = JP_Q16(1000) + 1;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, forecast(&horizon, stand));
    start.reversal_rest = -1;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, forecast(&horizon, stand));
}
