/* The curve of linear curvature between two headings. */
#include "src/trajectory/clothoid.h"

#include "unity.h"

#define DEGREES(x) ((int32_t)JP_ANGLE_DEGREES(x))

/* Of a length of 1, Q30. */
#define TOLERANCE 4000

enum { PARTS = 512 };

static struct jp_clothoid curve;

void setUp(void)
{
}

void tearDown(void)
{
}

/* The heading against the chord at a share of the length, Q24. */
static jp_angle heading_at(int32_t from, jp_q24 share)
{
    const jp_q24 mean = curve.first + jp_q24_multiply((curve.last - curve.first) / 2, share);

    return (jp_angle)from + jp_angle_from_radians(jp_q24_multiply(mean, share));
}

/* From its begin to its end it goes along the chord, as far as it says, and has turned into the other heading. */
static void expect_curve(int32_t from, int32_t to)
{
    int64_t along = 0;
    int64_t across = 0;

    TEST_ASSERT_TRUE(jp_clothoid_fit(from, to, &curve));
    for (int32_t i = 0; i < PARTS; i++) {
        const jp_angle heading = heading_at(from, (2 * i + 1) * (JP_Q24_ONE / (2 * PARTS)));
        along += jp_cos(heading);
        across += jp_sin(heading);
    }
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, curve.chord_share, (int32_t)(along / (2 * PARTS)));
    TEST_ASSERT_INT32_WITHIN(TOLERANCE, 0, (int32_t)(across / (2 * PARTS)));
    TEST_ASSERT_INT32_WITHIN(64, 0, (int32_t)(heading_at(from, JP_Q24_ONE) - (jp_angle)to) / 16);
}

static void test_straight_line(void)
{
    TEST_ASSERT_TRUE(jp_clothoid_fit(3, -8, &curve));
    TEST_ASSERT_EQUAL_INT32(1 << 30, curve.chord_share);
    TEST_ASSERT_EQUAL_INT32(0, curve.first);
    TEST_ASSERT_EQUAL_INT32(0, curve.last);
}

/* A quarter of a circle: chord over length is √2/2 over π/4. */
static void test_arc(void)
{
    expect_curve(DEGREES(-45), DEGREES(45));
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1.5707963), curve.first);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1.5707963), curve.last);
    TEST_ASSERT_INT32_WITHIN(100, 966707286, curve.chord_share); /* 0.9003163 */
}

static void test_curves(void)
{
    static const int16_t degrees[][2] = {{0, 30}, {30, 0},   {10, 10},  {-10, -10}, {26, 19},  {-60, 20},
                                         {70, 5}, {40, -80}, {-80, 80}, {45, 45},   {90, -90}, {-60, -50}};

    for (unsigned i = 0; i < sizeof degrees / sizeof degrees[0]; i++) {
        expect_curve(degrees[i][0] * (DEGREES(90) / 90), degrees[i][1] * (DEGREES(90) / 90));
    }
}

static void test_mirrored_curve_bends_the_other_way(void)
{
    struct jp_clothoid other;

    TEST_ASSERT_TRUE(jp_clothoid_fit(DEGREES(20), DEGREES(-35), &curve));
    TEST_ASSERT_TRUE(jp_clothoid_fit(-DEGREES(20), -DEGREES(-35), &other));
    TEST_ASSERT_INT32_WITHIN(16, -curve.first, other.first);
    TEST_ASSERT_INT32_WITHIN(16, -curve.last, other.last);
    TEST_ASSERT_INT32_WITHIN(16, curve.chord_share, other.chord_share);
}

static void test_one_heading_along_the_chord_is_no_straight_line(void)
{
    expect_curve(0, DEGREES(20));
    expect_curve(DEGREES(20), 0);
    TEST_ASSERT_TRUE(curve.first < 0 && curve.last > 0);
}

static void test_headings_of_a_detour(void)
{
    TEST_ASSERT_FALSE(jp_clothoid_fit(DEGREES(-150), DEGREES(140), &curve));
    TEST_ASSERT_FALSE(jp_clothoid_fit(DEGREES(178), DEGREES(-142), &curve));
}
