/* The arc of the segment optimiser at the ends of its range; tests/property/prop_arc.c has all that is between. */
#include "src/trajectory/segment_arc.h"

#include "unity.h"

#define Q30_HALF       ((int32_t)1 << 30) /* x = 1/2 */
#define INVERSE_PI_Q30 ((int32_t)341782638)

/* Of sinc: 5e-8 in Q29. */
#define SINC_ERROR 27

void setUp(void)
{
}

void tearDown(void)
{
}

static int32_t sinc_at(int32_t x)
{
    struct jp_arc arc;
    jp_arc_at(x, &arc);
    return arc.sinc;
}

static void test_no_arc(void)
{
    struct jp_arc arc;
    jp_arc_at(0, &arc);
    TEST_ASSERT_EQUAL_INT32(0, arc.square);
    TEST_ASSERT_EQUAL_INT32(JP_SINC_ONE, arc.sinc);
    TEST_ASSERT_INT32_WITHIN(8, (int32_t)1 << 27, arc.shape); /* 1/16 */
    TEST_ASSERT_EQUAL_INT32(0, arc.stretch);
}

static void test_longest_arc(void)
{
    TEST_ASSERT_INT32_WITHIN(SINC_ERROR, JP_SINC_AT_HALF_ARC_MAX, sinc_at(JP_HALF_ARC_MAX));
    TEST_ASSERT_INT32_WITHIN(SINC_ERROR, JP_SINC_AT_HALF_ARC_MAX, sinc_at(-JP_HALF_ARC_MAX));
    TEST_ASSERT_INT32_WITHIN(1 << 8, JP_HALF_ARC_MAX, jp_arc_of_sinc(JP_SINC_AT_HALF_ARC_MAX));
    TEST_ASSERT_LESS_OR_EQUAL_INT32(JP_HALF_ARC_MAX, jp_arc_of_sinc(JP_SINC_AT_HALF_ARC_MAX - SINC_ERROR));
}

/* Where sinc is flat its inverse need not be exact, but the sinc of it is. */
static void test_arc_of_nearly_no_bend(void)
{
    for (int32_t bend = 0; bend < 2000; bend++) {
        const int32_t x = jp_arc_of_sinc(JP_SINC_ONE - bend);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, x);
        TEST_ASSERT_INT32_WITHIN(SINC_ERROR, JP_SINC_ONE - bend, sinc_at(x));
    }
}

static void test_chord_of_no_arc(void)
{
    TEST_ASSERT_INT32_WITHIN(1 << 6, 0, jp_arc_of_half_chord(0));
}

/* The widest chord is the diameter; one that rounding has made wider is taken for it. */
static void test_chord_of_half_a_circle(void)
{
    for (int32_t wider = -2; wider <= 2; wider++) {
        TEST_ASSERT_INT32_WITHIN(1 << 18, Q30_HALF, jp_arc_of_half_chord(INVERSE_PI_Q30 + wider));
    }
}

/* sin(πx)/(πx) and its derivative, by their series. */
static double sinc_series(double x, double *derivative)
{
    const double square = 9.8696044010893586 * x * x;
    double term = 1.0;
    double sum = 1.0;

    *derivative = 0.0;
    for (int n = 1; n < 24; n++) {
        term *= -square / (2 * n * (2 * n + 1));
        sum += term;
        *derivative += x == 0.0 ? 0.0 : 2 * n * term / x;
    }
    return sum;
}

static void test_an_arc_is_as_its_series_say(void)
{
    for (int i = -45; i <= 45; i++) {
        const int32_t x = i * (JP_HALF_ARC_MAX / 45);
        struct jp_arc arc;
        double derivative;
        const double sinc = sinc_series(x * 0x1p-31, &derivative);

        jp_arc_at(x, &arc);
        TEST_ASSERT_INT32_WITHIN(8, (int32_t)(sinc * 0x1p29), arc.sinc);
        TEST_ASSERT_INT32_WITHIN(8 + (int32_t)(1 / sinc / sinc), (int32_t)(0x1p27 / sinc), arc.shape);
        TEST_ASSERT_INT32_WITHIN(16 + (int32_t)(32 / sinc / sinc), (int32_t)(-derivative / sinc * 0x1p27), arc.stretch);
    }
}

/* Half the chord of an arc of radius 1/π, x sinc, and back. */
static void test_arcs_of_chords_and_of_shares(void)
{
    for (int i = 1; i < 45; i++) {
        const int32_t x = i * (JP_HALF_ARC_MAX / 45);
        double derivative;
        const double sinc = sinc_series(x * 0x1p-31, &derivative);

        TEST_ASSERT_INT32_WITHIN(1 << 8, x, jp_arc_of_sinc((int32_t)(sinc * 0x1p29)));
        if (i < 24) {
            TEST_ASSERT_INT32_WITHIN(1 << 8, x, jp_arc_of_half_chord((int32_t)(x * 0x1p-31 * sinc * 0x1p30)));
        }
    }
}
