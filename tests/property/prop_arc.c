/* The arc of src/trajectory/segment_arc.c against double: shape, derivative and both inverses, over the whole range of
 * x. */
#include <math.h>
#include <stdio.h>

#include "src/trajectory/segment_arc.h"
#include "unity.h"

#define PI     3.14159265358979323846
#define STRIDE 10007
#define Q27    134217728.0
#define Q29    536870912.0
#define Q30    1073741824.0
#define Q31    2147483648.0

void setUp(void)
{
}

void tearDown(void)
{
}

static double sinc(double x)
{
    return x == 0 ? 1 : sin(PI * x) / (PI * x);
}

/** (dr/dx)/r with r = 1/sinc. */
static double stretch(double x)
{
    return fabs(x) < 1e-4 ? PI * PI * x / 3 : 1 / x - PI / tan(PI * x);
}

static void test_sinc_and_shape(void)
{
    double worst_sinc = 0;
    double worst_shape = 0;

    for (int64_t x = -JP_HALF_ARC_MAX; x <= JP_HALF_ARC_MAX; x += STRIDE) {
        struct jp_arc arc;
        double exact = sinc((double)x / Q31);

        jp_arc_at((int32_t)x, &arc);
        worst_sinc = fmax(worst_sinc, fabs(arc.sinc / Q29 / exact - 1));
        worst_shape = fmax(worst_shape, fabs(16 * (arc.shape / Q31) * exact - 1));
    }
    printf("sinc %.2e, shape %.2e of the value\n", worst_sinc, worst_shape);
    TEST_ASSERT_TRUE(worst_sinc <= 5e-8); /* the polynomial's 6e-9 and the format's step at the smallest value */
    TEST_ASSERT_TRUE(worst_shape <= 6e-8);
}

static void test_stretch(void)
{
    double worst = 0;

    for (int64_t x = -JP_HALF_ARC_MAX; x <= JP_HALF_ARC_MAX; x += STRIDE) {
        struct jp_arc arc;
        double exact = stretch((double)x / Q31);

        jp_arc_at((int32_t)x, &arc);
        worst = fmax(worst, fabs(arc.stretch / Q27 - exact) / (1 + fabs(exact)));
    }
    printf("stretch %.2e of 1 + the value\n", worst);
    TEST_ASSERT_TRUE(worst <= 2e-7);
}

static void test_arc_of_sinc(void)
{
    double worst = 0;

    for (int64_t value = JP_SINC_AT_HALF_ARC_MAX; value < JP_SINC_ONE; value += STRIDE) {
        double x = jp_arc_of_sinc((int32_t)value) / Q31;

        worst = fmax(worst, fabs(sinc(x) - (double)value / Q29));
    }
    printf("sinc of its inverse %.2e\n", worst);
    TEST_ASSERT_TRUE(worst <= 5e-8);
}

static void test_arc_of_half_chord(void)
{
    double worst = 0;

    for (int64_t value = 0; value <= (int64_t)(Q30 / PI); value += STRIDE) {
        double x = jp_arc_of_half_chord((int32_t)value) / Q31;

        worst = fmax(worst, fabs(x * sinc(x) - (double)value / Q30));
    }
    printf("half chord of its inverse %.2e\n", worst);
    TEST_ASSERT_TRUE(worst <= 5e-8);
}
