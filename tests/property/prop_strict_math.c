/* The simulator's elementary functions beside those of the C library in long double; and the bits of some thousand of
 * their values, which are the same on every machine. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include "sim/base/fingerprint.h"
#include "sim/base/random.h"
#include "sim/base/strict_math.h"
#include "tests/support/options.h"
#include "unity.h"

/* Of the arguments of each function and range. */
static struct options options = {.count = 20000, .seed = 22};
static struct random draws;

void setUp(void)
{
    random_init(&draws, options.seed);
}

void tearDown(void)
{
}

/* In units of the last place of the exact value. */
static double error_of(double value, long double exact)
{
    const double size = fabs((double)exact);

    return (double)(fabsl((long double)value - exact) / (long double)(nextafter(size, INFINITY) - size));
}

struct function {
    const char *name;
    double (*strict)(double);
    long double (*exact)(long double);
    double low;
    double high;
    double bound;
};

static const struct function functions[] = {
    {"sin", strict_sin, sinl, -7, 7, 1},          {"sin", strict_sin, sinl, -1e6, 1e6, 1},
    {"sin", strict_sin, sinl, -1e-4, 1e-4, 1},    {"cos", strict_cos, cosl, -7, 7, 1},
    {"cos", strict_cos, cosl, -1e6, 1e6, 1},      {"tan", strict_tan, tanl, -7, 7, 3},
    {"tan", strict_tan, tanl, -1e-4, 1e-4, 3},    {"asin", strict_asin, asinl, -1, 1, 3},
    {"asin", strict_asin, asinl, -1e-4, 1e-4, 3}, {"atan", strict_atan, atanl, -4, 4, 2},
    {"atan", strict_atan, atanl, -1e9, 1e9, 2},   {"atan", strict_atan, atanl, -1e-4, 1e-4, 2},
    {"exp", strict_exp, expl, -700, 700, 1},      {"exp", strict_exp, expl, -1, 1, 1},
    {"log", strict_log, logl, 0, 2, 1},           {"log", strict_log, logl, 0, 1e300, 1},
    {"tanh", strict_tanh, tanhl, -25, 25, 4},     {"tanh", strict_tanh, tanhl, -1, 1, 4},
    {"tanh", strict_tanh, tanhl, -1e-4, 1e-4, 4},
};

static void test_functions_of_one_number(void)
{
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        const struct function *function = &functions[i];
        double worst = 0;
        for (unsigned long k = 0; k < options.count; k++) {
            const double x = random_uniform(&draws, function->low, function->high);
            worst = fmax(worst, error_of(function->strict(x), function->exact((long double)x)));
        }
        printf("%-4s of %g…%g: %.3f last places\n", function->name, function->low, function->high, worst);
        TEST_ASSERT_TRUE(worst <= function->bound);
    }
}

static void test_functions_of_two_numbers(void)
{
    double angle = 0;
    double length = 0;

    for (unsigned long k = 0; k < options.count; k++) {
        const double shrink = k % 2 == 0 ? 1 : 1e-6;
        const double x = random_uniform(&draws, -9, 9) * (k % 4 < 2 ? 1 : shrink);
        const double y = random_uniform(&draws, -9, 9) * (k % 4 < 2 ? shrink : 1);
        angle = fmax(angle, error_of(strict_atan2(y, x), atan2l((long double)y, (long double)x)));
        length = fmax(length, error_of(strict_hypot(x, y), hypotl((long double)x, (long double)y)));
    }
    printf("atan2: %.3f, hypot: %.3f last places\n", angle, length);
    TEST_ASSERT_TRUE(angle <= 2 && length <= 2);
}

/* Where a sine is small its argument's digits count: the doubles next to multiples of π/2. */
static void test_beside_zeros(void)
{
    for (int quarters = 1; quarters < 600000; quarters += 7) {
        const double x = quarters * M_PI_2;
        const long double sine = sinl((long double)x);
        const long double cosine = cosl((long double)x);
        TEST_ASSERT_TRUE(fabsl((long double)strict_sin(x) - sine) <= 0x1p-90L + 0x1p-52L * fabsl(sine));
        TEST_ASSERT_TRUE(fabsl((long double)strict_cos(x) - cosine) <= 0x1p-90L + 0x1p-52L * fabsl(cosine));
    }
}

static void assert_same_bits(double one, double other)
{
    TEST_ASSERT_EQUAL_MEMORY(&one, &other, sizeof one);
}

/* Wherever it stands, and as often as it has turned. */
static void test_both_of_an_angle_are_those_of_each(void)
{
    static const double others[] = {0.0, -0.0, 5e-324, M_PI_2, -M_PI_2, 1e10, -1e16, 1e300};

    for (unsigned long k = 0; k < options.count; k++) {
        const double x = random_uniform(&draws, -9, 9) * (k % 2 == 0 ? 1 : 1e6);
        const struct strict_turn turn = strict_sin_cos(x);
        assert_same_bits(turn.sine, strict_sin(x));
        assert_same_bits(turn.cosine, strict_cos(x));
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        const struct strict_turn turn = strict_sin_cos(others[i]);
        assert_same_bits(turn.sine, strict_sin(others[i]));
        assert_same_bits(turn.cosine, strict_cos(others[i]));
    }
    TEST_ASSERT_TRUE(isnan(strict_sin_cos(NAN).sine) && isnan(strict_sin_cos(INFINITY).cosine));
}

static void assert_as_in_c(double value, double expected)
{
    TEST_ASSERT_TRUE(isnan(expected) ? isnan(value) : value == expected && !signbit(value) == !signbit(expected));
}

/* Where C says what a function gives, or the result is exact. */
static void test_special_values(void)
{
    static const double values[] = {0.0, -0.0, INFINITY, -INFINITY, NAN};
    static const double beyond[] = {2000, -2000, 1e300, -1e300};

    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        const double x = values[i];
        assert_as_in_c(strict_sin(x), sin(x));
        assert_as_in_c(strict_cos(x), cos(x));
        assert_as_in_c(strict_tan(x), tan(x));
        assert_as_in_c(strict_asin(x), asin(x));
        assert_as_in_c(strict_atan(x), atan(x));
        assert_as_in_c(strict_exp(x), exp(x));
        assert_as_in_c(strict_log(x), log(x));
        assert_as_in_c(strict_tanh(x), tanh(x));
    }
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        assert_as_in_c(strict_exp(beyond[i]), exp(beyond[i]));
        assert_as_in_c(strict_tanh(beyond[i]), tanh(beyond[i]));
        assert_as_in_c(strict_asin(beyond[i]), NAN);
    }
    assert_as_in_c(strict_log(-1), NAN);
    assert_as_in_c(strict_log(1), 0);
}

static void test_special_pairs(void)
{
    static const double values[] = {0.0, -0.0, 1, -1, NAN};

    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        for (size_t j = 0; j < sizeof values / sizeof *values; j++) {
            assert_as_in_c(strict_atan2(values[i], values[j]), atan2(values[i], values[j]));
        }
    }
    assert_as_in_c(strict_hypot(3, -4), 5);
    assert_as_in_c(strict_hypot(0, -0.7), 0.7);
    assert_as_in_c(strict_hypot(NAN, 1), NAN);
}

/* Subnormal ones are rounded once more. */
static void test_the_smallest_exponentials(void)
{
    for (unsigned long k = 0; k < options.count; k++) {
        const double x = random_uniform(&draws, -750, -708);
        TEST_ASSERT_TRUE(fabsl((long double)strict_exp(x) - expl((long double)x)) <= 0x1p-1074L);
    }
}

static void add(uint64_t *bits, double value)
{
    fingerprint_add(bits, &value, sizeof value);
}

/* Whatever the compiler, its flags and the processor. */
static void test_bits(void)
{
    uint64_t bits = FINGERPRINT_START;

    random_init(&draws, 1);
    for (int k = 0; k < 5000; k++) {
        const double x = random_uniform(&draws, -50, 50);
        const double y = random_uniform(&draws, -1, 1);
        add(&bits, strict_sin(x));
        add(&bits, strict_cos(x));
        add(&bits, strict_tan(x));
        add(&bits, strict_asin(y));
        add(&bits, strict_atan2(y, x));
        add(&bits, strict_exp(x));
        add(&bits, strict_log(fabs(x)));
        add(&bits, strict_tanh(y));
        add(&bits, strict_hypot(x, y));
    }
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xCA1989F3DAE3B875), bits);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
