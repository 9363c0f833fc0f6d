/* The spline through ways on drawn maps: what it refuses, that it passes the turning points smoothly, stays free, and
 * what it does where a curve does not fit. */
#include <joulepath/path_spline.h>
#include <string.h>

#include "tests/support/level_map.h"
#include "unity.h"

enum {
    BLOCK_BYTES = 5 * 1024,
    TURNS = 12,
    SCRATCH_BYTES = 2048,
    POINTS_MAX = 200,
};

#define CELL    JP_Q16(0.25)
#define SPACING JP_Q16(0.1)

static struct jp_terrain_config map;
static struct jp_grid_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];
static uint64_t scratch[SCRATCH_BYTES / sizeof(uint64_t)];
static struct jp_point smooth[POINTS_MAX];
static size_t count;

static void start_planner(void)
{
    const struct jp_grid_planner_config config = {.method = JP_GRID_ANY_ANGLE, .tube = 1};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_init(&planner, &config, &terrain, block, sizeof block, &field));
}

void setUp(void)
{
    map = (struct jp_terrain_config){.width = 16, .height = 16, .resolution = CELL};
    make_level_map(&map);
    start_planner();
    memset(scratch, 0x5A, sizeof scratch);
}

void tearDown(void)
{
}

/* In m. */
#define POINT(x, y)                                                                                                    \
    {                                                                                                                  \
        JP_Q16(x), JP_Q16(y)                                                                                           \
    }

static enum jp_status make(const struct jp_point *way, size_t points, size_t scratch_size, size_t smooth_max)
{
    return jp_path_spline(&planner, way, points, SPACING, scratch, scratch_size, smooth, smooth_max, &count);
}

static void smooth_all(const struct jp_point *way, size_t points)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, make(way, points, sizeof scratch, POINTS_MAX));
}

static bool is_same(const struct jp_point *a, const struct jp_point *b)
{
    return a->x == b->x && a->y == b->y;
}

static bool passes(const struct jp_point *point)
{
    for (size_t i = 0; i < count; i++) {
        if (is_same(&smooth[i], point)) {
            return true;
        }
    }
    return false;
}

static jp_q16 distance(const struct jp_point *a, const struct jp_point *b)
{
    const int64_t dx = a->x - b->x;
    const int64_t dy = a->y - b->y;

    return (jp_q16)jp_square_root((uint64_t)(dx * dx + dy * dy));
}

/* All lines are free, and the turning points are on them. */
static void expect_free(const struct jp_point *way, size_t points)
{
    TEST_ASSERT_TRUE(is_same(&smooth[0], &way[0]));
    TEST_ASSERT_TRUE(is_same(&smooth[count - 1], &way[points - 1]));
    for (size_t i = 0; i < points; i++) {
        TEST_ASSERT_TRUE(passes(&way[i]));
    }
    for (size_t i = 1; i < count; i++) {
        TEST_ASSERT_TRUE(jp_grid_planner_line_is_free(&planner, &smooth[i - 1], &smooth[i]));
    }
}

/* Sharpest turn between neighbouring points. */
static int32_t sharpest_turn(void)
{
    int32_t sharpest = 0;

    for (size_t i = 2; i < count; i++) {
        const jp_angle before = jp_atan2(smooth[i - 1].y - smooth[i - 2].y, smooth[i - 1].x - smooth[i - 2].x);
        const jp_angle after = jp_atan2(smooth[i].y - smooth[i - 1].y, smooth[i].x - smooth[i - 1].x);
        const int32_t turn = (int32_t)(after - before);
        const int32_t size = turn < 0 ? -turn : turn;
        sharpest = size > sharpest ? size : sharpest;
    }
    return sharpest;
}

/* ---- What is refused ---- */

static void test_arguments(void)
{
    static const struct jp_point way[] = {POINT(1, 1), POINT(3, 1)};
    const size_t size = jp_path_spline_size(2);

#define REFUSED(planner_of, way_of, points, spacing, scratch_of, smooth_of, count_of)                                  \
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_path_spline(planner_of, way_of, points, spacing, scratch_of, size,       \
                                                          smooth_of, POINTS_MAX, count_of))
    REFUSED(NULL, way, 2, SPACING, scratch, smooth, &count);
    REFUSED(&planner, NULL, 2, SPACING, scratch, smooth, &count);
    REFUSED(&planner, way, 2, SPACING, NULL, smooth, &count);
    REFUSED(&planner, way, 2, SPACING, scratch, NULL, &count);
    REFUSED(&planner, way, 2, SPACING, scratch, smooth, NULL);
    count = 7;
    REFUSED(&planner, way, 1, SPACING, scratch, smooth, &count);
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)count);
    REFUSED(&planner, way, 2, 255, scratch, smooth, &count);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_path_spline(&planner, way, 2, SPACING, (uint8_t *)scratch + 4, size,
                                                           smooth, POINTS_MAX, &count));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, make(way, 2, size - 1, POINTS_MAX));
    TEST_ASSERT_EQUAL_INT(JP_OK, make(way, 2, size, POINTS_MAX));
}

static void test_sizes(void)
{
    TEST_ASSERT_EQUAL_UINT32(28 * 8, (uint32_t)jp_path_spline_size(0));
    TEST_ASSERT_EQUAL_UINT32(28 * (5 * 100 + 8), (uint32_t)jp_path_spline_size(100));
    TEST_ASSERT_TRUE(jp_path_spline_size(TURNS) <= sizeof scratch);
}

static void test_blocked_way(void)
{
    static const struct jp_point way[] = {POINT(1, 1), POINT(1, 3), POINT(3, 3)};

    put_column(8, 0, 15, JP_CELL_OCCUPIED);
    count = 7;
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, make(way, 3, sizeof scratch, POINTS_MAX));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)count);
}

static void test_way_off_the_map(void)
{
    static const struct jp_point way[] = {{INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX}};

    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, make(way, 2, sizeof scratch, POINTS_MAX));
}

static void test_points_coincide(void)
{
    static const struct jp_point way[] = {POINT(1, 1), POINT(1, 1), POINT(1, 1)};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, make(way, 3, sizeof scratch, POINTS_MAX));
}

static void test_too_many_points(void)
{
    static const struct jp_point way[] = {POINT(1, 1), POINT(3, 1)};

    smooth_all(way, 2);
    const size_t needed = count;

    TEST_ASSERT_EQUAL_INT(JP_OK, make(way, 2, sizeof scratch, needed));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, make(way, 2, sizeof scratch, needed - 1));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)count);
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, make(way, 2, sizeof scratch, 0));
}

/* ---- Curves ---- */

static void test_straight_way_stays_straight(void)
{
    static const struct jp_point way[] = {POINT(0.5, 1), POINT(1.5, 1), POINT(3.5, 1)};

    smooth_all(way, 3);
    expect_free(way, 3);
    for (size_t i = 1; i < count; i++) {
        TEST_ASSERT_EQUAL_INT32(JP_Q16(1), smooth[i].y);
        TEST_ASSERT_TRUE(smooth[i].x > smooth[i - 1].x);
        TEST_ASSERT_TRUE(smooth[i].x - smooth[i - 1].x <= SPACING + 8);
    }
}

static void test_repeated_points_are_left_out(void)
{
    static const struct jp_point way[] = {POINT(0.5, 1), POINT(0.5, 1), POINT(2, 1), POINT(2, 1), POINT(3, 1)};

    smooth_all(way, 5);
    expect_free(way, 5);
    for (size_t i = 1; i < count; i++) {
        TEST_ASSERT_TRUE(smooth[i].x > smooth[i - 1].x);
    }
}

/* A right angle is rounded: no turn of 0.1 m is sharper than a third of it, and no chord is much longer. */
static void test_right_angle_is_round(void)
{
    static const struct jp_point way[] = {POINT(0.5, 1), POINT(2.5, 1), POINT(2.5, 3)};

    smooth_all(way, 3);
    expect_free(way, 3);
    TEST_ASSERT_TRUE(sharpest_turn() < (int32_t)JP_ANGLE_DEGREES(30));
    for (size_t i = 1; i < count; i++) {
        TEST_ASSERT_TRUE(distance(&smooth[i], &smooth[i - 1]) < SPACING * 5 / 4);
    }
}

/* The curve through (−1, 0), (0, 0), (0, 1) with its knots is symmetric about the diagonal. */
static void test_symmetric_way_gives_a_symmetric_curve(void)
{
    static const struct jp_point way[] = {POINT(0.5, 2), POINT(2, 2), POINT(2, 0.5)};

    smooth_all(way, 3);
    for (size_t i = 0; i < count; i++) {
        TEST_ASSERT_INT32_WITHIN(16, smooth[i].x, smooth[count - 1 - i].y);
    }
}

/* Second derivatives are continuous: the second difference of points changes little from one to the next, also at
 * knots.
 */
static void test_curvature_is_continuous(void)
{
    static const struct jp_point way[] = {POINT(0.5, 0.5), POINT(2, 0.75), POINT(3, 2), POINT(2.5, 3.5)};
    int32_t largest = 0;

    smooth_all(way, 4);
    for (size_t i = 3; i < count; i++) {
        const int32_t third = smooth[i].x - 3 * smooth[i - 1].x + 3 * smooth[i - 2].x - smooth[i - 3].x;
        const int32_t size = third < 0 ? -third : third;
        largest = size > largest ? size : largest;
    }
    TEST_ASSERT_TRUE(largest < JP_Q16(0.035));
}

static void test_short_pieces(void)
{
    static const struct jp_point way[] = {{65536, 65536}, {65540, 65537}, {65571, 65537}, POINT(2, 1)};

    smooth_all(way, 4);
    expect_free(way, 4);
}

/* ---- Obstacles ---- */

static jp_q16 farthest_east(void)
{
    jp_q16 farthest = 0;

    for (size_t i = 0; i < count; i++) {
        farthest = smooth[i].x > farthest ? smooth[i].x : farthest;
    }
    return farthest;
}

/* The wall beyond the turn is hit by the curve that swings out, and no longer once its knots are near. */
static void test_knots_keep_the_curve_free(void)
{
    static const struct jp_point way[] = {POINT(0.5, 1.125), POINT(2.2, 1.125), POINT(2.2, 3.5)};

    smooth_all(way, 3);
    TEST_ASSERT_TRUE(farthest_east() > JP_Q16(2.25));
    put_column(9, 0, 15, JP_CELL_OCCUPIED);
    smooth_all(way, 3);
    expect_free(way, 3);
    TEST_ASSERT_TRUE(farthest_east() <= JP_Q16(2.25));
    TEST_ASSERT_TRUE(farthest_east() > JP_Q16(2.2));
}

/* The turn is in the inner corner of a wall: no curve can pass it, so the pieces beside it stay straight. */
static void test_straight_where_no_curve_fits(void)
{
    static const struct jp_point way[] = {
        {JP_Q16(0.5), JP_Q16(1)}, {JP_Q16(2.25) - 1, JP_Q16(1)}, {JP_Q16(2.25) - 1, JP_Q16(3.5)}};

    put_column(9, 0, 15, JP_CELL_OCCUPIED);
    for (int32_t x = 0; x < 9; x++) {
        put_column(x, 3, 3, JP_CELL_OCCUPIED);
    }
    smooth_all(way, 3);
    expect_free(way, 3);
    TEST_ASSERT_TRUE(sharpest_turn() > (int32_t)JP_ANGLE_DEGREES(40));
}

/* Past two corners on its two sides there is but one line: no knot off it by a rounding is free, so it has none. */
static void test_line_between_two_corners(void)
{
    enum { DX = 7, DY = 5 }; /* of its slope; places on it are as far apart, in units of the map */
    static const struct jp_point way[] = {{4 * CELL - 1000 * DX, 4 * CELL - 1000 * DY},
                                          {11 * CELL + 1005 * DX, 9 * CELL + 1005 * DY},
                                          {11 * CELL + 1005 * DX, 14 * CELL}};

    put_column(4, 3, 3, JP_CELL_OCCUPIED);
    put_column(10, 9, 9, JP_CELL_OCCUPIED);
    smooth_all(way, 3);
    expect_free(way, 3);
    TEST_ASSERT_TRUE(is_same(&smooth[1], &way[1]));
}

/* With no room for more knots the pieces that are not free stay straight. */
static void test_scratch_is_full(void)
{
    static const struct jp_point way[] = {
        {JP_Q16(0.5), JP_Q16(1)}, {JP_Q16(2.25) - 1, JP_Q16(1)}, {JP_Q16(2.25) - 1, JP_Q16(3.5)}};

    put_column(9, 0, 15, JP_CELL_OCCUPIED);
    for (int32_t x = 0; x < 9; x++) {
        put_column(x, 3, 3, JP_CELL_OCCUPIED);
    }
    smooth_all(way, 3);
    const size_t ample_count = count;
    TEST_ASSERT_EQUAL_INT(JP_OK, make(way, 3, jp_path_spline_size(3), POINTS_MAX));
    expect_free(way, 3);
    TEST_ASSERT_TRUE(count < ample_count);
}

/* Three pieces: none has a point more than it needs. */
static void test_no_more_points_than_the_spacing_asks_for(void)
{
    static const struct jp_point way[] = {POINT(0.5, 1), POINT(3.5, 1)};

    smooth_all(way, 2);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(30 + 3 + 1, (uint32_t)count);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(30 + 1, (uint32_t)count);
}

/* The curve out of the turn hits the wall, so that its chord, a third of the way up, gets a knot in its middle. */
static void test_a_piece_that_is_not_free_gets_a_knot_in_its_middle(void)
{
    static const struct jp_point way[] = {POINT(0.5, 1.125), POINT(2.2, 1.125), POINT(2.2, 3.5)};
    const jp_q16 middle = way[1].y + (way[2].y - way[1].y) / 6;
    bool is_passed = false;

    put_column(9, 0, 15, JP_CELL_OCCUPIED);
    smooth_all(way, 3);
    for (size_t i = 0; i < count; i++) {
        const int32_t off = smooth[i].y - middle;
        is_passed = is_passed || (smooth[i].x == way[1].x && off >= -2 && off <= 2);
    }
    TEST_ASSERT_TRUE(is_passed);
}
