/* What digital sensors, converters, counters and timers make of exact values. */
#include <math.h>
#include <stdio.h>

#include "sim/base/digital.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "unity.h"

static const struct options defaults = {.count = 20000, .seed = 2018};
static struct options options;
static struct random noise;

void setUp(void)
{
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

/* ---- Fixed point ---- */

static void test_fixed_rounds_to_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(0, digital_fixed(0, 65536));
    TEST_ASSERT_EQUAL_INT32(65536, digital_fixed(1, 65536));
    TEST_ASSERT_EQUAL_INT32(1, digital_fixed(0.5, 1));
    TEST_ASSERT_EQUAL_INT32(0, digital_fixed(-0.5, 1));
    TEST_ASSERT_EQUAL_INT32(-1, digital_fixed(-0.6, 1));
    for (unsigned long run = 0; run < options.count; run++) {
        const double value = random_uniform(&noise, -100, 100);
        check_near(value, digital_fixed(value, 16777216) / 16777216.0, 0.5 / 16777216, "value");
    }
}

static void test_fixed_saturates(void)
{
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, digital_fixed(40000, 65536));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, digital_fixed(-40000, 65536));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, digital_fixed(1e300, 65536));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, digital_fixed(-1e300, 65536));
}

/* ---- Digital sensors ---- */

static void test_sensor_without_errors_is_exact_and_draws_nothing(void)
{
    const struct random before = noise;

    check_near(1.2345, digital_sense(1.2345, 0, 0, 0, &noise), 0, "value");
    TEST_ASSERT_TRUE(before.state == noise.state);
}

static void test_sensor_has_steps(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double step = random_uniform(&noise, 0.001, 1);
        const double value = random_uniform(&noise, -50, 50);
        const double read = digital_sense(value, 0, step, 0, &noise);
        check_near(value, read, step / 2 * (1 + 1e-9), "within half a step");
        check_near(round(read / step), read / step, 1e-6, "whole steps");
    }
}

static void test_sensor_stays_within_its_full_scale(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double full_scale = random_uniform(&noise, 0.1, 10);
        const double value = random_uniform(&noise, -20, 20);
        const double read = digital_sense(value, 0, 0, full_scale, &noise);
        check_below(fabs(read), full_scale, "full scale");
        check_near(fmin(fmax(value, -full_scale), full_scale), read, 0, "value");
    }
}

static void test_sensor_has_noise_of_its_deviation(void)
{
    double sum = 0;
    double squares = 0;

    for (unsigned long run = 0; run < options.count; run++) {
        const double read = digital_sense(3, 0.5, 0, 0, &noise);
        sum += read - 3;
        squares += (read - 3) * (read - 3);
    }
    const double n = (double)options.count;
    check_near(0, sum / n, 5 * 0.5 / sqrt(n), "mean");
    check_near(0.5, sqrt(squares / n), 5 * 0.5 / sqrt(2 * n), "deviation");
}

/* ---- Converters ---- */

static void test_converter_without_bits_is_exact(void)
{
    check_near(123, digital_convert(123, -1, 1, 0), 0, "value");
}

static void test_converter_has_its_codes(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const int bits = 1 + (int)random_uniform(&noise, 0, 16);
        const double low = random_uniform(&noise, -10, 0);
        const double high = random_uniform(&noise, 1, 10);
        const double step = (high - low) / ldexp(1, bits);
        const double value = random_uniform(&noise, low - 3, high + 3);
        const double read = digital_convert(value, low, high, bits);
        const double inside = fmin(fmax(value, low), high - step);
        check_near(inside, read, step / 2 * (1 + 1e-9), "within half a code");
        check_near(round((read - low) / step), (read - low) / step, 1e-6, "a code");
        TEST_ASSERT_TRUE(read >= low && read < high);
    }
}

/* ---- Counters ---- */

static void test_counter_counts_down_to_the_whole(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double turns = random_uniform(&noise, -1000, 1000);
        const int32_t counted = (int32_t)digital_count(turns * 2 * M_PI, 4096, 0);
        TEST_ASSERT_TRUE(counted <= turns * 4096 + 1e-6 && counted > turns * 4096 - 1 - 1e-6);
    }
}

static void test_counter_wraps_and_starts_anywhere(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, digital_count(1e-6, 100, 0));
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFFu, digital_count(-1e-6, 100, 0));
    TEST_ASSERT_EQUAL_UINT32(4, digital_count(2 * M_PI * 1.0001, 5, 0xFFFFFFFFu));
    for (unsigned long run = 0; run < options.count; run++) {
        const double angle = random_uniform(&noise, -1e6, 1e6);
        const uint32_t start = (uint32_t)random_uniform(&noise, 0, 4294967295.0);
        TEST_ASSERT_EQUAL_UINT32(digital_count(angle, 125099, 0) + start, digital_count(angle, 125099, start));
    }
}

/* ---- Timers ---- */

static void test_duty_without_bits_is_exact(void)
{
    check_near(0.5, digital_duty(1 << 30, 0), 0, "half");
    check_near(-1, digital_duty(INT32_MIN, 0), 0, "full");
    check_near(1 - ldexp(1, -31), digital_duty(INT32_MAX, 0), 0, "full");
}

static void test_duty_has_the_steps_of_the_timer(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const int bits = 1 + (int)random_uniform(&noise, 0, 24);
        const double wanted = random_uniform(&noise, -1, 1);
        const double duty = digital_duty((jp_q31)(wanted * 2147483647.0), bits);
        const double steps = duty * ldexp(1, bits);
        check_near(wanted, duty, ldexp(0.5, -bits) + 1e-9, "within half a step");
        check_near(round(steps), steps, 0, "whole steps");
        check_near(-duty, digital_duty(-(jp_q31)(wanted * 2147483647.0), bits), 0, "both ways alike");
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
