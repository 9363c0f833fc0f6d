/* What home learns of drives: by which factor they take more than their forecasts, and how far they differ. */
#include <joulepath/home.h>
#include <stddef.h>

#include "tests/target/random.h"
#include "unity.h"

static struct jp_home_factor factor;
static uint32_t random_state = 1;

void setUp(void)
{
    factor = jp_home_learned_new.out;
    random_state = 20261126;
}

void tearDown(void)
{
}

/** Of drives as long as ten steps. */
static void learn(jp_q16 taken, jp_q16 energy, jp_q16 deviation)
{
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_home_factor_learn(&factor, taken, &(struct jp_forecast){energy, deviation}, energy));
}

static void test_refuses_what_teaches_nothing(void)
{
    const struct jp_forecast good = {JP_Q16(10), JP_Q16(1)};
    const struct jp_forecast nothing = {0, JP_Q16(1)};
    const struct jp_forecast wrong = {JP_Q16(10), -1};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_factor_learn(NULL, JP_Q16(10), &good, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_factor_learn(&factor, JP_Q16(10), NULL, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_factor_learn(&factor, 0, &good, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_factor_learn(&factor, JP_Q16(10), &nothing, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_factor_learn(&factor, JP_Q16(10), &wrong, JP_Q16(1)));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_home_factor_learn(&factor, JP_Q16(10), &good, 0));
    TEST_ASSERT_EQUAL_INT32(jp_home_learned_new.out.mean, factor.mean);
}

static void test_a_new_robot_takes_what_is_forecast_give_or_take(void)
{
    /* Of 100 J, of which ten steps take 25: 10 by the mean, 44.5 by a drive of 0.89, beside 5.5 J of the learner. */
    const struct jp_forecast way =
        jp_home_factor_way(&factor, &(struct jp_forecast){JP_Q16(100), JP_Q16(5)}, JP_Q16(25));

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.01), JP_Q16(110), way.energy);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16(45.941), way.deviation);
}

static void test_drives_home_are_surer_than_drives_out(void)
{
    const struct jp_forecast forecast = {JP_Q16(100), 0};
    const struct jp_forecast out = jp_home_factor_way(&jp_home_learned_new.out, &forecast, JP_Q16(25));
    const struct jp_forecast back = jp_home_factor_way(&jp_home_learned_new.back, &forecast, JP_Q16(25));

    TEST_ASSERT_TRUE(back.energy < out.energy && back.deviation < out.deviation);
}

/* Four times as far is twice as uncertain by what disturbs drives. */
static void test_what_disturbs_a_drive_adds_up(void)
{
    factor.deviation = 1;
    const struct jp_forecast once = jp_home_factor_way(&factor, &(struct jp_forecast){JP_Q16(100), 0}, JP_Q16(25));
    const struct jp_forecast four = jp_home_factor_way(&factor, &(struct jp_forecast){JP_Q16(400), 0}, JP_Q16(25));

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), 2 * once.deviation, four.deviation);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16(44.5), once.deviation);
}

/* And so a long drive that takes a tenth more tells more of the noise than a short one. */
static void test_a_long_drive_that_differs_tells_more(void)
{
    struct jp_home_factor of_long = factor;

    factor.noise = JP_Q16(0.2);
    of_long.noise = JP_Q16(0.2);
    learn(JP_Q16(130), JP_Q16(100), 0);
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_home_factor_learn(&of_long, JP_Q16(1300), &(struct jp_forecast){JP_Q16(1000), 0}, JP_Q16(100)));
    TEST_ASSERT_TRUE(of_long.noise > factor.noise);
    TEST_ASSERT_TRUE(of_long.deviation < factor.deviation);
}

static void test_nothing_takes_nothing(void)
{
    const struct jp_forecast way = jp_home_factor_way(&factor, &(struct jp_forecast){0, 0}, JP_Q16(10));

    TEST_ASSERT_EQUAL_INT32(0, way.energy);
    TEST_ASSERT_EQUAL_INT32(0, way.deviation);
}

/* Drives that all take a quarter more: that is the factor, and soon the drives are known not to differ. */
static void test_learns_a_factor_that_all_drives_have(void)
{
    jp_q16 before = factor.noise;

    for (unsigned i = 0; i < 80; i++) {
        learn(JP_Q16(125), JP_Q16(100), 0);
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.02), JP_Q16(1.25), factor.mean);
    TEST_ASSERT_TRUE(factor.noise < before / 2);
    TEST_ASSERT_TRUE(factor.deviation < jp_home_learned_new.out.deviation / 2);
}

/* Evenly between 0.8 and 1.2: a deviation of 0.4/√12. */
static void test_learns_how_far_drives_differ(void)
{
    int64_t sum = 0;

    factor.noise = JP_Q16(0.03);
    for (unsigned i = 0; i < 400; i++) {
        learn(JP_Q16(80) + (jp_q16)(target_random(&random_state) % (uint32_t)JP_Q16(40)), JP_Q16(100), 0);
        sum += i >= 100U ? factor.noise : 0;
    }
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.06), JP_Q16(1), factor.mean);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.03), JP_Q16(0.1155), (int32_t)(sum / 300));
}

/* One drive in eight takes half as much again: most of the time nothing happens, and yet it must be reckoned with. */
static void test_rare_drives_that_take_far_more_are_not_forgotten(void)
{
    jp_q16 least = JP_Q16_ONE;

    for (unsigned i = 0; i < 200; i++) {
        learn(i % 8U == 0U ? JP_Q16(150) : JP_Q16(100), JP_Q16(100), 0);
        least = i > 40U && factor.noise < least ? factor.noise : least;
    }
    /* Above their mean they deviate by 0.219. */
    TEST_ASSERT_TRUE(least > JP_Q16(0.13));
    TEST_ASSERT_TRUE(factor.noise < JP_Q16(0.3));
}

static void test_a_forecast_that_is_not_sure_teaches_little(void)
{
    struct jp_home_factor sure;

    factor.noise = JP_Q16(0.1);
    sure = factor;
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_home_factor_learn(&sure, JP_Q16(120), &(struct jp_forecast){JP_Q16(100), JP_Q16(1)}, JP_Q16(100)));
    learn(JP_Q16(120), JP_Q16(100), JP_Q16(40));
    TEST_ASSERT_TRUE(factor.mean > jp_home_learned_new.out.mean);
    TEST_ASSERT_TRUE(factor.mean - jp_home_learned_new.out.mean < (sure.mean - jp_home_learned_new.out.mean) / 4);
    TEST_ASSERT_TRUE(factor.deviation > sure.deviation);
    learn(JP_Q16(120), JP_Q16(100), INT32_MAX);
    TEST_ASSERT_TRUE(factor.mean < sure.mean);
}

static void expect_in_range(void)
{
    TEST_ASSERT_TRUE(factor.mean >= JP_Q16(0.5) && factor.mean <= JP_Q16(2));
    TEST_ASSERT_TRUE(factor.deviation > 0 && factor.deviation <= jp_home_learned_new.out.deviation);
    TEST_ASSERT_TRUE(factor.noise >= JP_Q16(0.015625) && factor.noise <= JP_Q16(2));
}

static void test_stays_in_its_ranges_whatever_drives_take(void)
{
    for (unsigned i = 0; i < 3000; i++) {
        const jp_q16 taken =
            (jp_q16)(1U + (target_random(&random_state) >> (1U + target_random(&random_state) % 31U)) % INT32_MAX);
        const jp_q16 energy =
            (jp_q16)(1U + (target_random(&random_state) >> (1U + target_random(&random_state) % 31U)) % INT32_MAX);
        const jp_q16 deviation = (jp_q16)(target_random(&random_state) >> (1U + target_random(&random_state) % 31U));
        const struct jp_forecast forecast = {energy, deviation};

        learn(taken, energy, deviation);
        expect_in_range();
        TEST_ASSERT_TRUE(jp_home_factor_way(&factor, &forecast, energy / 3).deviation >= 0);
    }
}

static void test_limits_what_no_drive_takes(void)
{
    for (unsigned i = 0; i < 400; i++) {
        learn(JP_Q16(1000), JP_Q16(1), 0);
    }
    expect_in_range();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(2), factor.mean);
    for (unsigned i = 0; i < 200; i++) {
        learn(1, JP_Q16(1000), 0);
    }
    expect_in_range();
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(0.5), factor.mean);
}

static void test_a_forecast_as_unsure_as_its_format_holds_is_as_unsure_with_the_drive(void)
{
    const struct jp_forecast forecast = {INT32_MAX, INT32_MAX};
    const struct jp_home_factor wide = {.mean = JP_Q16(2), .deviation = JP_Q16(0.1), .noise = JP_Q16(2)};
    const struct jp_forecast way = jp_home_factor_way(&wide, &forecast, INT32_MAX);

    TEST_ASSERT_EQUAL_INT32(INT32_MAX, way.energy);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, way.deviation);
}
