/* What a metre costs on a grid, by a model worked out by hand. */
#include <joulepath/grid_prices.h>
#include <stddef.h>

#include "unity.h"

/* 0.02 J */
#define TOLERANCE 1311

enum { LEVEL = 16, STEEPEST_UP = 32 };

/* On level ground at 1 m/s each wheel pushes with 0.01 of the weight. */
static const struct jp_four_wheel_energy_model round_numbers = {
    .wheelbase = JP_Q24(0.6),
    .track = JP_Q24(0.8),
    .weight = JP_Q16(1000),
    .rolling = JP_Q24(0.02),
    .drag = JP_Q24(0.005),
    .driving = JP_Q24(2),
    .braking = JP_Q24(0.5),
    .copper_driving = JP_Q16(4000),
    .copper_braking = JP_Q16(1000),
    .electronics_power = JP_Q16(20),
};

static struct jp_four_wheel_energy_model model;
static struct jp_grid_prices prices;

void setUp(void)
{
    model = round_numbers;
    prices = (struct jp_grid_prices){.metre = 7};
}

void tearDown(void)
{
}

static void test_level_ground(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&model, JP_Q24_ONE, 0, &prices));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(101.6), prices.metre);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&model, JP_Q24(0.5), JP_Q16(10), &prices));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, JP_Q16(40 + 61.8 + 20), prices.metre);
    TEST_ASSERT_TRUE(prices.ring > 0);
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        TEST_ASSERT_EQUAL_INT32(0, prices.near[i]);
    }
}

/* The rise is 2 G and the windings' derivative; what is left are the windings by the square of the grade, and downhill
 * what brakes do not give back. */
static void test_slopes(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&model, JP_Q24_ONE, 0, &prices));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(2080), prices.rise);
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, 0, prices.slope[LEVEL]);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(250), prices.slope[STEEPEST_UP]);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(781.3), prices.slope[0]);
}

/* Whatever the model: no slope is below 0, and with the rise it is the energy of the model. */
static void test_slopes_are_convex(void)
{
    jp_q16 energy = 0;

    model.rolling = 0; /* the motors begin to brake on level ground */
    model.drag = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&model, JP_Q24_ONE, 0, &prices));
    for (int i = 0; i <= STEEPEST_UP; i++) {
        const int64_t whole = (int64_t)prices.metre + prices.slope[i] + (i - LEVEL) * (int64_t)prices.rise / 32;

        TEST_ASSERT_EQUAL_INT(JP_OK,
                              jp_four_wheel_energy_metre(&model, JP_Q24_ONE, (i - LEVEL) * (JP_Q24_ONE / 32), &energy));
        TEST_ASSERT_TRUE(prices.slope[i] >= 0);
        TEST_ASSERT_INT32_WITHIN(TOLERANCE, energy, (int32_t)whole);
    }
}

static void test_arguments(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_prices_set(NULL, JP_Q24_ONE, 0, &prices));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_prices_set(&model, JP_Q24_ONE, 0, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_prices_set(&model, JP_Q24(1.0 / 256) - 1, 0, &prices));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_prices_set(&model, JP_Q24(8) + 1, 0, &prices));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_prices_set(&model, JP_Q24_ONE, -1, &prices));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_prices_set(&model, JP_Q24_ONE, JP_Q16(1024) + 1, &prices));
    TEST_ASSERT_EQUAL_INT32(7, prices.metre);
}

static void test_too_dear(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_grid_prices_set(&model, JP_Q24(1.0 / 256), JP_Q16(64), &prices));
    TEST_ASSERT_EQUAL_INT32(7, prices.metre);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&model, JP_Q24(1.0 / 256), JP_Q16(40), &prices));
    model.weight = JP_Q16(16384);
    model.driving = JP_Q24(10);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&model, JP_Q24_ONE, 0, &prices));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, prices.rise);
}
