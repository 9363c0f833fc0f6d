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
