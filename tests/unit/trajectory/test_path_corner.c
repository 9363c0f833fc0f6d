/* Corners that become arcs where that costs less. */
#include <joulepath/path_corner.h>
#include <stddef.h>

#include "unity.h"

enum { PLACES = 3 };

static const struct jp_path_limits limits = {
    .speed = JP_Q24(1),
    .turn_rate = JP_Q24(1),
    .side_speed = JP_Q24(2),
    .width = JP_Q24(0.5),
    .acceleration = JP_Q24(1),
    .turn_acceleration = JP_Q24(40),
};

static struct jp_path_piece pieces[PLACES];
static struct jp_path_piece before[PLACES];
static struct jp_lattice_path path;

/* W, more on the spot. */
struct model {
    jp_q16 driving;
    jp_q16 turning;
    jp_q16 bending; /* besides, by the speed, J/m */
};

static struct model model;

static jp_q16 power(const void *context, const struct jp_motion *motion, jp_q24 grade)
{
    const struct model *of = context;

    (void)grade;
    const bool bends = motion->speed != 0 && motion->turn_rate != 0;

    return motion->speed == 0 ? of->turning : of->driving + (bends ? jp_q24_multiply(of->bending, motion->speed) : 0);
}

static struct jp_motion_price price = {.power = power, .model = &model};

/* 2 m along x, a turn in place, 1 m on. */
static void make_path(enum jp_piece_kind kind, double turn)
{
    const jp_angle angle = jp_angle_from_radians(JP_Q24(turn));

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&path, pieces, PLACES));
    path.count = PLACES;
    pieces[0] = (struct jp_path_piece){
        .begin = {JP_Q16(1), JP_Q16(2)}, .length = JP_Q24(2), .rise = JP_Q16(0.2), .kind = JP_PIECE_CURVE};
    pieces[1] = (struct jp_path_piece){.begin = {JP_Q16(3), JP_Q16(2)}, .length = JP_Q24(turn), .kind = kind};
    pieces[2] = (struct jp_path_piece){.begin = {JP_Q16(3), JP_Q16(2)},
                                       .heading = kind == JP_PIECE_TURN_LEFT ? angle : 0U - angle,
                                       .length = JP_Q24(1),
                                       .rise = JP_Q16(-0.1),
                                       .kind = JP_PIECE_CURVE};
    for (int i = 0; i < PLACES; i++) {
        before[i] = pieces[i];
    }
}

void setUp(void)
{
    model = (struct model){JP_Q16(10), JP_Q16(10), 0};
    price.time = 0;
    make_path(JP_PIECE_TURN_LEFT, 1.5707963);
}

void tearDown(void)
{
}

static bool round_by(double clearance, double radius_min)
{
    const struct jp_corner_room room = {JP_Q24(clearance), JP_Q24(radius_min)};

    return jp_path_round_corner(&path, 1, &room, &limits, &price);
}

static bool round_corner(double clearance)
{
    return round_by(clearance, 0);
}

static void expect_unchanged(void)
{
    for (int i = 0; i < PLACES; i++) {
        TEST_ASSERT_EQUAL_INT32(before[i].kind, pieces[i].kind);
        TEST_ASSERT_EQUAL_INT32(before[i].length, pieces[i].length);
        TEST_ASSERT_EQUAL_INT32(before[i].begin.x, pieces[i].begin.x);
        TEST_ASSERT_EQUAL_INT32(before[i].begin.y, pieces[i].begin.y);
        TEST_ASSERT_EQUAL_INT32(before[i].bend, pieces[i].bend);
        TEST_ASSERT_EQUAL_INT32(before[i].rise, pieces[i].rise);
    }
}

static void expect_near(double expected, jp_q24 value)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0002), JP_Q24(expected), value);
}

static void expect_point(double x, double y, struct jp_point point)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0002), JP_Q16(x), point.x);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0002), JP_Q16(y), point.y);
}

static void test_refuses(void)
{
    const struct jp_corner_room room = {JP_Q24(1), 0};

    TEST_ASSERT_FALSE(jp_path_round_corner(NULL, 1, &room, &limits, &price));
    TEST_ASSERT_FALSE(jp_path_round_corner(&path, 1, NULL, &limits, &price));
    TEST_ASSERT_FALSE(jp_path_round_corner(&path, 1, &room, NULL, &price));
    TEST_ASSERT_FALSE(jp_path_round_corner(&path, 1, &room, &limits, NULL));
    TEST_ASSERT_FALSE(jp_path_round_corner(&path, 0, &room, &limits, &price));
    TEST_ASSERT_FALSE(jp_path_round_corner(&path, 2, &room, &limits, &price));
    expect_unchanged();
}

/* Half of the last line is 0.5 m: a quarter of a circle of 0.5 m. */
static void test_by_the_room_of_the_lines(void)
{
    TEST_ASSERT_TRUE(round_corner(1));
    TEST_ASSERT_EQUAL_INT32(JP_PIECE_CURVE, pieces[1].kind);
    expect_near(2, pieces[1].bend);
    expect_near(0.7853982, pieces[1].length);
    expect_near(1.5, pieces[0].length);
    expect_near(0.5, pieces[2].length);
    expect_point(2.5, 2, pieces[1].begin);
    expect_point(3, 2.5, pieces[2].begin);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(0.15), pieces[0].rise);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(0), pieces[1].rise);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(-0.05), pieces[2].rise);
}

/* R (√2 − 1) = 0.1 m. */
static void test_by_the_clearance_to_the_right(void)
{
    make_path(JP_PIECE_TURN_RIGHT, 1.5707963);
    TEST_ASSERT_TRUE(round_corner(0.1));
    expect_near(-1 / 0.2414214, pieces[1].bend);
    expect_near(2 - 0.2414214, pieces[0].length);
    expect_point(3, 2 - 0.2414214, pieces[2].begin);
}

static void test_the_shorter_line_gives_the_room(void)
{
    pieces[0].length = JP_Q24(0.8);
    TEST_ASSERT_TRUE(round_corner(1));
    expect_near(0.4, pieces[0].length);
    expect_near(0.6, pieces[2].length);
}

/* Driving is so dear that turning on the spot, with less of the lines gone, costs less. */
static void test_on_the_spot_where_that_is_cheaper(void)
{
    model = (struct model){JP_Q16(100), JP_Q16(-200), 0};
    TEST_ASSERT_FALSE(round_corner(1));
    expect_unchanged();
}

static void test_time_has_a_price(void)
{
    model = (struct model){JP_Q16(1), JP_Q16(-4), 0};
    TEST_ASSERT_FALSE(round_corner(1));
    price.time = JP_Q16(200);
    TEST_ASSERT_TRUE(round_corner(1));
}

static void test_no_room(void)
{
    TEST_ASSERT_FALSE(round_corner(0));
    TEST_ASSERT_FALSE(round_corner(-0.1));
    TEST_ASSERT_FALSE(round_corner(0.004));
    expect_unchanged();
}

/* Half of the last line lets it have a radius of 0.5 m. */
static void test_arcs_are_no_tighter_than_they_may(void)
{
    TEST_ASSERT_FALSE(round_by(1, 0.501));
    expect_unchanged();
    TEST_ASSERT_TRUE(round_by(1, 0.499));
    expect_near(2, pieces[1].bend);
}

/* Bends are so dear that the shortest arc is the cheapest. */
static void test_of_the_arcs_that_may_be_the_cheapest(void)
{
    model = (struct model){JP_Q16(10), JP_Q16(10000), JP_Q16(500)};
    TEST_ASSERT_TRUE(round_by(1, 0));
    const jp_q24 tightest = pieces[1].bend;
    make_path(JP_PIECE_TURN_LEFT, 1.5707963);
    TEST_ASSERT_TRUE(round_by(1, 0.37));
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.001), JP_Q24(1 / 0.375), pieces[1].bend);
    TEST_ASSERT_GREATER_THAN_INT32(pieces[1].bend, tightest);
}

static void test_what_is_no_corner(void)
{
    make_path(JP_PIECE_TURN_LEFT, 2.7);
    TEST_ASSERT_FALSE(round_corner(1));
    expect_unchanged();
    make_path(JP_PIECE_TURN_LEFT, 1);
    pieces[1].kind = before[1].kind = JP_PIECE_CURVE;
    TEST_ASSERT_FALSE(round_corner(1));
    make_path(JP_PIECE_TURN_LEFT, 1);
    pieces[0].bend = before[0].bend = 1;
    TEST_ASSERT_FALSE(round_corner(1));
    make_path(JP_PIECE_TURN_LEFT, 1);
    pieces[2].bend_rate = before[2].bend_rate = 1;
    TEST_ASSERT_FALSE(round_corner(1));
    make_path(JP_PIECE_TURN_LEFT, 1);
    pieces[2].kind = before[2].kind = JP_PIECE_TURN_LEFT;
    TEST_ASSERT_FALSE(round_corner(1));
    expect_unchanged();
}

/* What cannot be priced stays. */
static void test_price_out_of_its_range(void)
{
    price.time = -1;
    TEST_ASSERT_FALSE(round_corner(1));
    expect_unchanged();
}

/* A nearly straight line needs hardly any clearance; the arc takes as much of it as its radius may be long, 100 m. */
static void test_slight_corners(void)
{
    make_path(JP_PIECE_TURN_LEFT, 0.02);
    TEST_ASSERT_TRUE(round_corner(0.01));
    expect_near(0.5, pieces[2].length);
    expect_near(1, pieces[1].length);
    make_path(JP_PIECE_TURN_RIGHT, 0.002);
    TEST_ASSERT_TRUE(round_corner(0.01));
    expect_near(1.9, pieces[0].length);
    expect_near(0.2, pieces[1].length);
    expect_near(0.9, pieces[2].length);
    TEST_ASSERT_INT32_WITHIN(2, JP_Q24(-0.01), pieces[1].bend);
}

/* What is even straighter has no arc of 1 cm on each line: it would end short of the line after it. */
static void test_corners_of_hardly_any_angle(void)
{
    make_path(JP_PIECE_TURN_LEFT, 0.00019);
    TEST_ASSERT_FALSE(round_corner(0.35));
    expect_unchanged();
    make_path(JP_PIECE_TURN_LEFT, 0.0000002);
    TEST_ASSERT_FALSE(round_corner(0.35));
    expect_unchanged();
    make_path(JP_PIECE_TURN_LEFT, 0.00021);
    TEST_ASSERT_TRUE(round_corner(0.35));
    expect_near(0.021, pieces[1].length);
}

/* At the edge of the format, on ground as steep as it holds: places and rise stay within it. */
static void test_saturates_at_the_edge_of_the_format(void)
{
    model.turning = JP_Q16(1000);
    make_path(JP_PIECE_TURN_LEFT, 0.5);
    pieces[0].begin.x = INT32_MAX - JP_Q16(2);
    pieces[0].rise = INT32_MAX;
    pieces[1].begin.x = INT32_MAX;
    pieces[2].begin.x = INT32_MAX;
    pieces[2].rise = INT32_MAX;
    TEST_ASSERT_TRUE(round_corner(8));
    TEST_ASSERT_TRUE(pieces[1].begin.x < INT32_MAX);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, pieces[2].begin.x);
    TEST_ASSERT_TRUE(pieces[1].rise > 0);
}
