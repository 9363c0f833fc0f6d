/* What a piece of a path is like, so far on it: against double precision. */
#include "src/trajectory/path_piece.h"

#include "tests/target/random.h"
#include "unity.h"

static uint32_t state;
static struct jp_path_piece piece;
static struct jp_path_piece next;

void setUp(void)
{
    state = 31;
    piece = (struct jp_path_piece){.kind = JP_PIECE_CURVE, .length = JP_Q24(2)};
    next = (struct jp_path_piece){.kind = JP_PIECE_CURVE, .length = JP_Q24(1)};
}

void tearDown(void)
{
}

static double random_between(double low, double high)
{
    return low + (high - low) * (double)(target_random(&state) >> 8) * 0x1p-24;
}

static double of_q24(int64_t value)
{
    return (double)value * 0x1p-24;
}

/* ---- Kinds ---- */

static void test_what_is_straight(void)
{
    TEST_ASSERT_TRUE(jp_piece_is_straight(&piece));
    piece.bend = 1;
    TEST_ASSERT_FALSE(jp_piece_is_straight(&piece));
    piece.bend = 0;
    piece.bend_rate = -1;
    TEST_ASSERT_FALSE(jp_piece_is_straight(&piece));
    piece.bend_rate = 0;
    piece.kind = JP_PIECE_TURN_LEFT;
    TEST_ASSERT_FALSE(jp_piece_is_straight(&piece));
}

static void test_grounds_are_alike_where_all_of_them_are(void)
{
    TEST_ASSERT_TRUE(jp_piece_is_on_the_same(&piece, &next));
    next.ground_left = 1;
    TEST_ASSERT_FALSE(jp_piece_is_on_the_same(&piece, &next));
    next.ground_left = 0;
    next.ground_right = 2;
    TEST_ASSERT_FALSE(jp_piece_is_on_the_same(&piece, &next));
    piece.ground_right = 2;
    TEST_ASSERT_TRUE(jp_piece_lies_alike(&piece, &next));
    next.is_at_edge = true;
    TEST_ASSERT_FALSE(jp_piece_is_on_the_same(&piece, &next));
    TEST_ASSERT_FALSE(jp_piece_lies_alike(&piece, &next));
}

static void test_the_grade_is_rise_over_run(void)
{
    for (int i = 0; i < 100; i++) {
        const double rise = random_between(-0.9, 0.9);
        const double length = random_between(1.0, 5.0);

        piece.rise = JP_Q16(rise);
        piece.length = JP_Q24(length);
        TEST_ASSERT_INT32_WITHIN(2, (int32_t)((double)piece.rise * 0x1p8 / length), jp_piece_grade(&piece));
    }
}

/* Up to a spread of 1/32, whichever is the steeper. */
static void test_grades_are_alike_within_their_spread(void)
{
    for (int32_t rise = 0; rise < 4000; rise += 13) {
        int64_t spread;

        next.rise = rise;
        piece.rise = 700;
        spread = (int64_t)jp_piece_grade(&piece) - jp_piece_grade(&next);
        spread = spread < 0 ? -spread : spread;
        TEST_ASSERT_EQUAL_INT(spread <= JP_Q24(0.03125), jp_piece_lies_alike(&piece, &next));
        TEST_ASSERT_EQUAL_INT(spread <= JP_Q24(0.03125), jp_piece_lies_alike(&next, &piece));
    }
}

static void test_a_piece_is_lengthened_by_what_the_next_is(void)
{
    piece.rise = 30;
    next.rise = -70;
    jp_piece_lengthen(&piece, &next);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(3), piece.length);
    TEST_ASSERT_EQUAL_INT32(-40, piece.rise);
}

/* ---- Curvature ---- */

/* It is linear; from half of the jump before the border to half of it after it goes over to the next piece's. */
static void test_the_curvature_jumps_evenly(void)
{
    for (int i = 0; i < 200; i++) {
        const double into_this = random_between(0.05, 0.4);
        const double into_next = random_between(0.05, 0.4);
        const double rate_here = random_between(-3.0, 3.0);
        const double rate_there = random_between(-3.0, 3.0);
        const double way = random_between(0.0, 2.0);
        const bool has_next = i % 3 != 0;
        double bend;
        double rate;
        struct jp_path_bend found;

        setUp();
        state += (uint32_t)i;
        piece.bend = JP_Q24(0.4);
        piece.bend_rate = JP_Q16(-0.3);
        piece.speed.blend = JP_Q24(into_this);
        piece.speed.blend_rate = JP_Q16(rate_here);
        next.speed.blend = JP_Q24(into_next);
        next.speed.blend_rate = JP_Q16(rate_there);
        bend = 0.4 - 0.3 * way;
        rate = -0.3;
        if (way < into_this) {
            bend -= rate_here * (into_this - way);
            rate += rate_here;
        }
        if (has_next && way > 2.0 - into_next) {
            bend += rate_there * (way - (2.0 - into_next));
            rate += rate_there;
        }
        found = jp_piece_bend_at(&piece, has_next ? &next : NULL, JP_Q24(way));
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), JP_Q24(bend), found.bend);
        TEST_ASSERT_INT32_WITHIN(4, JP_Q16(rate), found.rate);
    }
}

/* ---- Speeds ---- */

/* v² rises by 2 a s up to the cruise, and falls likewise from where it brakes. */
static void test_the_speed_on_the_way(void)
{
    for (int i = 0; i < 300; i++) {
        const double begin = random_between(0.0, 1.0);
        const double cruise = begin + random_between(0.01, 1.0);
        const double acceleration = random_between(0.1, 2.0);
        const double brake_from = random_between(0.2, 3.0);
        const double way = random_between(0.0, brake_from + 0.45 * cruise * cruise / acceleration);
        const struct jp_piece_speed speed = {
            .cruise = JP_Q24(cruise), .acceleration = JP_Q24(acceleration), .brake_from = JP_Q24(brake_from)};
        const double gained = begin * begin + 2.0 * acceleration * way;
        const double lost = cruise * cruise - 2.0 * acceleration * (way - brake_from);
        const double up = gained < cruise * cruise ? gained : cruise * cruise;
        const double exact = way <= brake_from ? up : lost;
        const double found = of_q24(jp_piece_speed_after(&speed, JP_Q24(begin), JP_Q24(way)));

        TEST_ASSERT_INT32_WITHIN(20, (int32_t)(exact * 1.0e6), (int32_t)(found * found * 1.0e6));
    }
    TEST_ASSERT_EQUAL_INT64((int64_t)JP_Q24(3) * JP_Q24(1), jp_piece_change_of_square(JP_Q24(0.5), JP_Q24(3)));
}
