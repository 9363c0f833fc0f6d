/* Prices that follow what a skid-steered robot has learned: by hand, at their limits, what is refused. */
#include <joulepath/skid_tariff.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "unity.h"

enum { VERSION = 3 };

static const struct jp_skid_steer_config *const priced = &jp_skid_steer_zhang2018;
static const struct jp_motion usual = {JP_Q24(0.5), JP_Q24(0.39269908)};
static struct jp_skid_energy_model learned;
static struct jp_tariff_factors factors;

void setUp(void)
{
    learned = jp_skid_energy_zhang2018;
    factors = (struct jp_tariff_factors){0, 0, 0, 0};
}

void tearDown(void)
{
}

static void find(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_tariff_factors(priced, &learned, &usual, VERSION, &factors));
    TEST_ASSERT_EQUAL_UINT32(VERSION, factors.version);
}

/* The formulas say too little of turning only. */
static void test_the_identified_robot_turns_for_more(void)
{
    find();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16_ONE, factors.straight);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), JP_Q16_ONE, factors.mass);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.4), JP_Q16(1.6), factors.turning);
}

/* A model that is the formulas' own: turning by eq. 7 on the spot, no slip. */
static void test_equal_models_give_factors_of_one(void)
{
    const struct jp_motion on_the_spot = {JP_Q24(0.0001), JP_Q24(0.39269908)};

    learned.half_track = priced->width / 2;
    learned.weight = priced->weight;
    learned.rolling = priced->rolling;
    learned.friction = priced->friction;
    learned.turning = JP_Q24(0.5 / (4 * 0.925 * 0.7));
    learned.yielding = 0;
    learned.scrub = 0;
    learned.easing = 0;
    learned.driving = JP_Q24(1 / 0.78);
    learned.copper_driving = JP_Q16(532.534);
    learned.electronics_power = priced->electronics_power;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_tariff_factors(priced, &learned, &on_the_spot, VERSION, &factors));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16_ONE, factors.straight);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.002), JP_Q16_ONE, factors.turning);
}

static void test_each_factor_follows_its_cause(void)
{
    struct jp_tariff_factors before;

    find();
    before = factors;
    learned.rolling += learned.rolling / 2;
    find();
    TEST_ASSERT_TRUE(factors.straight > before.straight + JP_Q16(0.2));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), before.mass, factors.mass);
    setUp();
    learned.friction -= learned.friction / 4;
    find();
    TEST_ASSERT_TRUE(factors.turning < before.turning - JP_Q16(0.1));
    TEST_ASSERT_EQUAL_INT32(before.straight, factors.straight);
    setUp();
    learned.weight += learned.weight / 4;
    find();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), before.mass + before.mass / 4, factors.mass);
}

/* ---- Against the powers of which they are made ---- */

enum { FORMULAS, LEARNED };

static jp_q16 power(int of, jp_q24 speed, jp_q24 turn_rate, jp_q24 grade)
{
    const struct jp_motion motion = {speed, turn_rate};
    jp_q16 watts = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, of == LEARNED ? jp_skid_energy_power(&learned, &motion, grade, &watts)
                                               : jp_skid_steer_power(priced, JP_COST_PHYSICAL, &motion, grade, &watts));
    return watts;
}

static double climbing(int of, const struct jp_motion *at)
{
    return (double)power(of, at->speed, 0, JP_Q24(0.125)) - power(of, at->speed, 0, 0);
}

static double turning(int of, const struct jp_motion *at)
{
    return (double)power(of, 0, at->turn_rate, 0) + power(of, at->speed, at->turn_rate, 0) - power(of, at->speed, 0, 0);
}

static void expect_factor(double by_model, double by_formulas, jp_q16 factor)
{
    const double ratio = by_model / by_formulas * JP_Q16_ONE;
    const double limited = ratio < JP_TARIFF_FACTOR_MIN ? JP_TARIFF_FACTOR_MIN : ratio;

    TEST_ASSERT_INT32_WITHIN(1, (int32_t)(limited > JP_TARIFF_FACTOR_MAX ? JP_TARIFF_FACTOR_MAX : limited), factor);
}

/* However slow the usual motion is. */
static void test_factors_are_ratios_of_powers(void)
{
    static const struct jp_motion motions[] = {
        {JP_Q24(0.5), JP_Q24(0.4)}, {JP_Q24(0.5), 1}, {JP_Q24(2), JP_Q24(0.1)},
        {1, JP_Q24(0.4)},           {1, 1},           {JP_Q24(0.001), JP_Q24(4)}};

    learned.friction -= learned.friction / 8;
    for (unsigned i = 0; i < sizeof motions / sizeof *motions; i++) {
        const struct jp_motion *at = &motions[i];

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_tariff_factors(priced, &learned, at, VERSION, &factors));
        expect_factor(power(LEARNED, at->speed, 0, 0), power(FORMULAS, at->speed, 0, 0), factors.straight);
        expect_factor(climbing(LEARNED, at), climbing(FORMULAS, at), factors.mass);
        expect_factor(turning(LEARNED, at), turning(FORMULAS, at), factors.turning);
    }
}

/* Level ground: without rolling resistance and electronics the formulas take nothing, and the least is more. */
static void test_what_the_formulas_have_for_nothing_is_dear(void)
{
    struct jp_skid_steer_config free_of_charge = *priced;

    free_of_charge.weight = JP_Q16(16384);
    free_of_charge.rolling = 0;
    free_of_charge.electronics_power = 0;
    learned.rolling = 0;
    learned.electronics_power = JP_Q16(0.01);
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_skid_tariff_factors(&free_of_charge, &learned, &(struct jp_motion){JP_Q24(8), JP_Q24(0.4)},
                                                 VERSION, &factors));
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MAX, factors.straight);
}

static void test_factors_keep_their_range(void)
{
    learned.weight = JP_Q16(16384);
    find();
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MAX, factors.straight);
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MAX, factors.turning);
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MAX, factors.mass);
    learned.weight = JP_Q16(1);
    learned.copper_driving = 0;
    learned.electronics_power = 0;
    find();
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MIN, factors.straight);
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MIN, factors.turning);
    TEST_ASSERT_EQUAL_INT32(JP_TARIFF_FACTOR_MIN, factors.mass);
}

static void expect_refused(enum jp_status status, const struct jp_motion *motion)
{
    TEST_ASSERT_EQUAL_INT(status, jp_skid_tariff_factors(priced, &learned, motion, VERSION, &factors));
    TEST_ASSERT_EQUAL_UINT32(0, factors.version);
}

static void test_what_is_refused(void)
{
    struct jp_motion motion = usual;
    struct jp_skid_steer_config heavy = *priced;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_tariff_factors(NULL, &learned, &usual, VERSION, &factors));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_tariff_factors(priced, NULL, &usual, VERSION, &factors));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_tariff_factors(NULL, NULL, &usual, VERSION, &factors));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_skid_tariff_factors(priced, &learned, &usual, VERSION, NULL));
    expect_refused(JP_ERR_ARGUMENT, NULL);
    motion.speed = 0;
    expect_refused(JP_ERR_ARGUMENT, &motion);
    motion = (struct jp_motion){JP_Q24(0.5), 0};
    expect_refused(JP_ERR_ARGUMENT, &motion);
    motion = (struct jp_motion){JP_Q24(8) + 1, JP_Q24(0.4)};
    expect_refused(JP_ERR_ARGUMENT, &motion);
    learned.weight = JP_Q16(16384);
    learned.driving = JP_Q24(10);
    expect_refused(JP_ERR_OVERFLOW, &(struct jp_motion){JP_Q24(4), JP_Q24(0.4)});
    heavy.weight = JP_Q16(16384);
    heavy.rolling = JP_Q24(0.5);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW,
                          jp_skid_tariff_factors(&heavy, &jp_skid_energy_zhang2018,
                                                 &(struct jp_motion){JP_Q24(8), JP_Q24(0.4)}, VERSION, &factors));
}
