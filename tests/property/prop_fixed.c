/*
 * Largest error of each function of fixed.h against floating point.
 *
 * prop_fixed [--count N] [--seed S] [--json FILE]
 * --count is the number of inputs of the functions of one argument, evenly among all 4294967296 (minutes).
 */
#include <joulepath/fixed.h>

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define TURN         4294967296.0
#define PI           3.14159265358979323846
#define PI_LONG      3.14159265358979323846264338328L
#define RANDOM_TESTS 1000000
#define THREADS      2

struct result {
    const char *name;
    const char *unit;
    double bound;
    double worst;
    uint64_t inputs;
};

static struct result results[16];
static size_t result_count;
static struct options options = {.count = 2106408, .seed = 1};

void setUp(void)
{
}

void tearDown(void)
{
}

static void record(const char *name, const char *unit, double bound, double worst, uint64_t inputs)
{
    results[result_count++] = (struct result){name, unit, bound, worst, inputs};
    TEST_ASSERT_TRUE_MESSAGE(worst <= bound, name);
}

/* Sweeps over 32-bit inputs */

typedef double error_function(uint32_t input);

struct sweep {
    error_function *error;
    uint64_t first, end, stride;
    double worst;
};

static void *run_sweep(void *argument)
{
    struct sweep *sweep = argument;
    for (uint64_t i = sweep->first; i < sweep->end; i += sweep->stride) {
        double error = sweep->error((uint32_t)i);
        if (!(error <= sweep->worst)) {
            sweep->worst = error;
        }
    }
    return NULL;
}

/** Largest error next to the borders of the octants and of the signed range. */
static double worst_at_borders(error_function *error)
{
    double worst = 0;
    for (uint32_t octant = 0; octant < 8; octant++) {
        for (uint32_t offset = 0; offset < 8192; offset++) {
            worst = fmax(worst, error((octant << 29) + offset - 4096u));
        }
    }
    return worst;
}

static void measure(const char *name, const char *unit, double bound, error_function *error)
{
    struct sweep sweeps[THREADS];
    pthread_t threads[THREADS];
    const uint64_t share = (uint64_t)TURN / THREADS;
    const uint64_t stride = ((uint64_t)TURN + options.count - 1) / options.count;
    for (unsigned i = 0; i < THREADS; i++) {
        sweeps[i] = (struct sweep){error, i * share, (i + 1) * share, stride, 0};
        TEST_ASSERT_EQUAL_INT(0, pthread_create(&threads[i], NULL, run_sweep, &sweeps[i]));
    }
    double worst = worst_at_borders(error);
    for (unsigned i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        worst = fmax(worst, sweeps[i].worst);
    }
    record(name, unit, bound, worst, (uint64_t)TURN / stride);
}

static double sine_error(uint32_t angle)
{
    double exact = fmin(sin(angle * (2 * PI / TURN)) * 0x1p31, INT32_MAX);
    return fabs(jp_sin(angle) - exact);
}

static double cosine_error(uint32_t angle)
{
    double exact = fmin(cos(angle * (2 * PI / TURN)) * 0x1p31, INT32_MAX);
    return fabs(jp_cos(angle) - exact);
}

static double square_root_error(uint32_t x)
{
    return fabs(jp_square_root(x) - floor(sqrt(x)));
}

static double q16_square_root_error(uint32_t x)
{
    int32_t value = (int32_t)x;
    double exact = value > 0 ? sqrt(value * 65536.0) : 0;
    return fabs(jp_q16_square_root(value) - exact);
}

/** Distance of an angle from an exact value in units of 2⁻³² turn, around the circle. */
static double angle_error(jp_angle angle, double exact)
{
    double whole = floor(exact);
    return fabs((int32_t)(angle - (uint32_t)(int64_t)whole) - (exact - whole));
}

static double from_radians_error(uint32_t bits)
{
    int32_t radians = (int32_t)bits;
    return angle_error(jp_angle_from_radians(radians), (double)(radians * (256 / (2 * PI_LONG))));
}

static double to_radians_error(uint32_t angle)
{
    int64_t units = angle > 0x80000000u ? (int64_t)angle - (int64_t)TURN : (int64_t)angle;
    return (double)fabsl(jp_angle_to_radians(angle) - units * (2 * PI_LONG / 256));
}

static double atan2_error(int32_t y, int32_t x)
{
    return angle_error(jp_atan2(y, x), atan2(y, x) * (TURN / (2 * PI)));
}

static double atan2_error_on_an_edge(uint32_t y)
{
    return atan2_error((int32_t)y, INT32_MAX);
}

static void test_sine(void)
{
    measure("jp_sin", "ulp of Q31", JP_SIN_ERROR_ULP, sine_error);
}

static void test_cosine(void)
{
    measure("jp_cos", "ulp of Q31", JP_SIN_ERROR_ULP, cosine_error);
}

static void test_square_root(void)
{
    measure("jp_square_root", "ulp", 0, square_root_error);
}

static void test_q16_square_root(void)
{
    measure("jp_q16_square_root", "ulp of Q16", 0.5, q16_square_root_error);
}

static void test_angle_from_radians(void)
{
    measure("jp_angle_from_radians", "2^-32 turn", 1, from_radians_error);
}

static void test_angle_to_radians(void)
{
    measure("jp_angle_to_radians", "ulp of Q24", 0.5, to_radians_error);
}

static void test_atan2_along_an_edge(void)
{
    measure("jp_atan2_along_edge", "2^-32 turn", JP_ATAN2_ERROR, atan2_error_on_an_edge);
}

/* Random inputs */

/** Random bits of a random magnitude. */
static int64_t random_int64(void)
{
    unsigned shift = (unsigned)(random_bits() % 64);
    return (int64_t)random_bits() >> shift;
}

static int32_t random_int32(void)
{
    unsigned shift = (unsigned)(random_bits() % 32);
    return (int32_t)(uint32_t)random_bits() >> shift;
}

static unsigned random_shift(void)
{
    return 1 + (unsigned)(random_bits() % 62);
}

static int32_t clamp(long double x)
{
    return (int32_t)fminl(fmaxl(x, INT32_MIN), INT32_MAX);
}

/** Error in ulp where the result is not saturated. */
static double rounding_error(int32_t result, long double exact)
{
    bool saturated = exact > INT32_MAX || exact < INT32_MIN;
    return saturated ? 0 : (double)fabsl(result - exact);
}

static void test_atan2(void)
{
    begin_random(options.seed, 0);
    double worst = 0;
    for (int i = 0; i < RANDOM_TESTS; i++) {
        int32_t y = random_int32();
        int32_t x = random_int32();
        worst = fmax(worst, atan2_error(y, x));
    }
    record("jp_atan2", "2^-32 turn", JP_ATAN2_ERROR, worst, RANDOM_TESTS);
}

/** Largest error of (y, x) in the eight octants. */
static double atan2_error_all_round(int32_t y, int32_t x)
{
    double worst = 0;
    for (int i = 0; i < 4; i++) {
        worst = fmax(worst, fmax(atan2_error(y, x), atan2_error(x, y)));
        int32_t turned = y;
        y = x;
        x = turned == INT32_MIN ? INT32_MAX : -turned;
    }
    return worst;
}

static void test_atan2_beside_octant_borders(void)
{
    begin_random(options.seed, 1);
    double worst = 0;
    for (int i = 0; i < RANDOM_TESTS / 64; i++) {
        int32_t size = jp_sub(random_int32(), 8);
        for (int32_t offset = -4; offset <= 4; offset++) {
            worst = fmax(worst, atan2_error_all_round(jp_add(size, offset), size));
            worst = fmax(worst, atan2_error_all_round(offset, size));
        }
    }
    record("jp_atan2_at_borders", "2^-32 turn", JP_ATAN2_ERROR, worst, (uint64_t)(RANDOM_TESTS / 64) * 18 * 8);
}

static void test_square_root_beside_squares(void)
{
    begin_random(options.seed, 2);
    for (int i = 0; i < RANDOM_TESTS; i++) {
        uint32_t root = (uint32_t)random_bits() >> (random_bits() % 32);
        uint64_t square = (uint64_t)root * root;
        TEST_ASSERT_EQUAL_UINT32(root, jp_square_root(square));
        TEST_ASSERT_EQUAL_UINT32(root, jp_square_root(square + 2 * (uint64_t)root));
        if (root > 0) {
            TEST_ASSERT_EQUAL_UINT32(root - 1, jp_square_root(square - 1));
        }
    }
}

static void test_multiply_shift(void)
{
    begin_random(options.seed, 3);
    double worst = 0;
    for (int i = 0; i < RANDOM_TESTS; i++) {
        int32_t a = random_int32();
        int32_t b = random_int32();
        unsigned shift = random_shift();
        long double exact = ldexpl((long double)a * b, -(int)shift);
        int32_t result = jp_multiply_shift(a, b, shift);
        TEST_ASSERT_EQUAL_INT32(clamp(floorl(exact + 0.5L)), result);
        worst = fmax(worst, rounding_error(result, exact));
    }
    record("jp_multiply_shift", "ulp", 0.5, worst, RANDOM_TESTS);
}

static void test_round_shift(void)
{
    begin_random(options.seed, 4);
    double worst = 0;
    for (int i = 0; i < RANDOM_TESTS; i++) {
        int64_t x = random_int64();
        unsigned shift = random_shift();
        long double exact = ldexpl((long double)x, -(int)shift);
        int32_t result = jp_round_shift(x, shift);
        TEST_ASSERT_EQUAL_INT32(clamp(floorl(exact + 0.5L)), result);
        worst = fmax(worst, rounding_error(result, exact));
    }
    record("jp_round_shift", "ulp", 0.5, worst, RANDOM_TESTS);
}

static void test_divide(void)
{
    begin_random(options.seed, 5);
    double worst = 0;
    for (int i = 0; i < RANDOM_TESTS; i++) {
        int64_t numerator = random_int64();
        int32_t denominator = random_int32();
        if (denominator == 0) {
            continue;
        }
        long double exact = (long double)numerator / denominator;
        int32_t result = jp_divide(numerator, denominator);
        TEST_ASSERT_EQUAL_INT32(clamp(roundl(exact)), result);
        worst = fmax(worst, rounding_error(result, exact));
    }
    record("jp_divide", "ulp", 0.5, worst, RANDOM_TESTS);
}

static void test_sums_saturate(void)
{
    begin_random(options.seed, 6);
    for (int i = 0; i < RANDOM_TESTS; i++) {
        int32_t a = random_int32();
        int32_t b = random_int32();
        int64_t accumulator = random_int64();
        int64_t sum;
        if (__builtin_add_overflow(accumulator, (int64_t)a * b, &sum)) {
            sum = accumulator > 0 ? INT64_MAX : INT64_MIN;
        }
        TEST_ASSERT_EQUAL_INT64(sum, jp_multiply_accumulate(accumulator, a, b));
        TEST_ASSERT_EQUAL_INT32(clamp((long double)a + b), jp_add(a, b));
        TEST_ASSERT_EQUAL_INT32(clamp((long double)a - b), jp_sub(a, b));
    }
}

/* Report */

static void print_table(void)
{
    printf("\n%-22s %10s %7s  %-11s %11s\n", "function", "max error", "bound", "unit", "inputs");
    for (size_t i = 0; i < result_count; i++) {
        const struct result *r = &results[i];
        printf("%-22s %10.6f %7.1f  %-11s %11llu\n", r->name, r->worst, r->bound, r->unit,
               (unsigned long long)r->inputs);
    }
}

static void add_figures(json_t *figures)
{
    for (size_t i = 0; i < result_count; i++) {
        const struct result *r = &results[i];
        figures_add(figures, "make figures", r->worst, r->unit, at_most(r->bound),
                    "fixed point: %s, worst of %llu inputs", r->name, (unsigned long long)r->inputs);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);

    const int failures = RUN_PROPERTY(options, add_figures);

    print_table();
    return failures;
}
