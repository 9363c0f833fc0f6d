/*
 * The spline through random ways of the grid planner, and through random ways of any points: every line between
 * neighbouring points is free by an oracle in double precision, the turning points are among the points, neighbours are
 * near each other, and the curve is the natural cubic spline through its knots: a spline in double precision through
 * the same knots meets the points.
 *
 * prop_path_spline [--count N] [--seed S]
 * --count is the number of ways.
 */
#include <joulepath/path_spline.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/grid_oracle.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

enum { SIDE = 48, WAY_MAX = 220, POINTS_MAX = 20000, SCRATCH_MAX = 1 << 16, KNOTS_MAX = 64 };

static struct options options = {.count = 400, .seed = 1};
static struct jp_terrain_config map;
static struct jp_terrain terrain;
static struct jp_grid_planner planner;
static struct grid_oracle oracle;
static bool blocked[SIDE * SIDE];
static uint64_t terrain_block[SIDE * SIDE];
static uint64_t block[SIDE * SIDE * 2];
static uint64_t scratch[SCRATCH_MAX / sizeof(uint64_t)];
static struct jp_point smooth[POINTS_MAX];
static size_t smooth_count;

void setUp(void)
{
}

void tearDown(void)
{
}

static void make_map(uint32_t percent)
{
    const struct jp_grid_planner_config config = {.method = JP_GRID_ANY_ANGLE, .tube = 4};
    const char *field = "";
    map = (struct jp_terrain_config){
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.05) + (jp_q16)below(JP_Q16(0.5))};
    oracle = (struct grid_oracle){SIDE, SIDE, blocked};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &map, terrain_block, sizeof terrain_block, &field));
    for (int i = 0; i < SIDE * SIDE; i++) {
        blocked[i] = below(100) < percent;
        (void)jp_terrain_set_cell(&terrain, i % SIDE, i / SIDE, blocked[i] ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_init(&planner, &config, &terrain, block, sizeof block, &field));
}

static bool draw_way(struct jp_point *way, size_t *points)
{
    const struct jp_grid_cell start = {(int16_t)below(SIDE), (int16_t)below(SIDE)};
    const struct jp_grid_cell goal = {(int16_t)below(SIDE), (int16_t)below(SIDE)};
    if (jp_grid_planner_start(&planner, &start, &goal) != JP_OK) {
        return false;
    }
    while (jp_grid_planner_work(&planner, 1000) == JP_GRID_SEARCHING) {
    }
    const struct jp_point *found = jp_grid_planner_path(&planner, points);
    if (found == NULL || *points < 2) {
        return false;
    }
    memcpy(way, found, *points * sizeof *way);
    return true;
}

static double distance(const struct jp_point *a, const struct jp_point *b)
{
    return hypot((double)a->x - b->x, (double)a->y - b->y);
}

static void expect_free(void)
{
    const double side = map.resolution;
    for (size_t i = 1; i < smooth_count; i++) {
        TEST_ASSERT_TRUE(grid_oracle_is_line_free(&oracle, smooth[i - 1].x / side, smooth[i - 1].y / side,
                                                  smooth[i].x / side, smooth[i].y / side));
    }
}

/* In their order. */
static void expect_turning_points(const struct jp_point *way, size_t points)
{
    size_t next = 0;
    for (size_t i = 0; i < smooth_count && next < points; i++) {
        while (next < points && smooth[i].x == way[next].x && smooth[i].y == way[next].y) {
            next++;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(points, next);
    TEST_ASSERT_EQUAL_INT32(way[points - 1].x, smooth[smooth_count - 1].x);
    TEST_ASSERT_EQUAL_INT32(way[points - 1].y, smooth[smooth_count - 1].y);
}

static double length_of(const struct jp_point *points, size_t number)
{
    double length = 0;
    for (size_t i = 1; i < number; i++) {
        length += distance(&points[i - 1], &points[i]);
    }
    return length;
}

static void test_ways_among_obstacles(void)
{
    unsigned long ways = 0;
    double longest = 0;
    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_point way[WAY_MAX];
        size_t points = 0;
        begin_random(options.seed, i);
        make_map(below(35));
        if (!draw_way(way, &points)) {
            continue;
        }
        const jp_q16 spacing = map.resolution / 4 + (jp_q16)below((uint32_t)map.resolution);
        const size_t size = jp_path_spline_size(points) + 8 * (size_t)below(200);
        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_path_spline(&planner, way, points, spacing, scratch, size, smooth, POINTS_MAX, &smooth_count));
        expect_free();
        expect_turning_points(way, points);
        longest = fmax(longest, length_of(smooth, smooth_count) / length_of(way, points));
        ways++;
    }
    (void)printf("%lu ways, at most %.3f of the way's length\n", ways, longest);
    TEST_ASSERT_TRUE(ways * 3 > options.count);
    TEST_ASSERT_TRUE(longest < 1.4);
}

/* ---- A spline in double precision ---- */

struct spline {
    size_t knots;
    double at[KNOTS_MAX]; /* sum of the chords */
    double value[2][KNOTS_MAX];
    double bend[2][KNOTS_MAX]; /* second derivative */
};

static void add_knot(struct spline *spline, double x, double y)
{
    const size_t i = spline->knots++;
    spline->value[0][i] = x;
    spline->value[1][i] = y;
    spline->at[i] = i == 0 ? 0 : spline->at[i - 1] + hypot(x - spline->value[0][i - 1], y - spline->value[1][i - 1]);
}

/* The turning points and, beside them, points of the chords eight cells away, or a third of the chord if that is less.
 */
static void add_knots(struct spline *spline, const struct jp_point *way, size_t points)
{
    spline->knots = 0;
    add_knot(spline, way[0].x, way[0].y);
    for (size_t i = 1; i < points; i++) {
        const double length = distance(&way[i - 1], &way[i]);
        const double part = fmin(length / 3, 8.0 * map.resolution) / length;
        const double dx = way[i].x - way[i - 1].x;
        const double dy = way[i].y - way[i - 1].y;
        add_knot(spline, way[i - 1].x + part * dx, way[i - 1].y + part * dy);
        add_knot(spline, way[i].x - part * dx, way[i].y - part * dy);
        add_knot(spline, way[i].x, way[i].y);
    }
}

/* The textbook's system for the second derivatives. */
static void solve(struct spline *spline, int axis)
{
    const double *at = spline->at;
    const double *value = spline->value[axis];
    double *bend = spline->bend[axis];
    double upper[KNOTS_MAX];
    const size_t last = spline->knots - 1;
    bend[0] = 0;
    upper[0] = 0;
    for (size_t i = 1; i < last; i++) {
        const double before = at[i] - at[i - 1];
        const double after = at[i + 1] - at[i];
        const double right = 6 * ((value[i + 1] - value[i]) / after - (value[i] - value[i - 1]) / before);
        const double pivot = 2 * (before + after) - before * upper[i - 1];
        upper[i] = after / pivot;
        bend[i] = (right - before * bend[i - 1]) / pivot;
    }
    bend[last] = 0;
    for (size_t i = last; i-- > 1;) {
        bend[i] -= upper[i] * bend[i + 1];
    }
}

static double evaluate(const struct spline *spline, int axis, size_t piece, double u)
{
    const double h = spline->at[piece + 1] - spline->at[piece];
    const double *value = &spline->value[axis][piece];
    const double *bend = &spline->bend[axis][piece];
    const double a = 1 - u;
    return a * value[0] + u * value[1] + ((a * a * a - a) * bend[0] + (u * u * u - u) * bend[1]) * h * h / 6;
}

static double worst_distance(const struct spline *spline, jp_q16 spacing)
{
    double worst = 0;
    size_t i = 0;
    for (size_t piece = 0; piece + 1 < spline->knots; piece++) {
        const int parts = (int)ceil(floor(spline->at[piece + 1] - spline->at[piece]) / spacing);
        for (int part = 0; part < parts && i < smooth_count; part++, i++) {
            const double u = part / (double)parts;
            worst = fmax(
                worst, hypot(evaluate(spline, 0, piece, u) - smooth[i].x, evaluate(spline, 1, piece, u) - smooth[i].y));
        }
    }
    return worst;
}

/* In the open: the curve is that of the textbook within a few units of the map and 2⁻²⁰ of its size. Chords whose part
 * is rounded to another number of points are left out. */
static void test_textbook_spline(void)
{
    unsigned long compared = 0;
    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_point way[8];
        struct spline spline;
        const size_t points = 2 + below(7);
        begin_random(options.seed, i);
        make_map(0);
        const uint32_t extent = (uint32_t)(SIDE / 2 * map.resolution);
        for (size_t k = 0; k < points; k++) {
            way[k] = (struct jp_point){(jp_q16)(extent / 2 + below(extent)), (jp_q16)(extent / 2 + below(extent))};
        }
        const jp_q16 spacing = map.resolution;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_spline(&planner, way, points, spacing, scratch, sizeof scratch, smooth,
                                                    POINTS_MAX, &smooth_count));
        expect_free();
        expect_turning_points(way, points);
        add_knots(&spline, way, points);
        solve(&spline, 0);
        solve(&spline, 1);
        const double worst = worst_distance(&spline, spacing);
        compared += worst < 8 + extent / 1048576.0;
    }
    (void)printf("%lu of %lu ways in the open meet the textbook's curve\n", compared, options.count);
    TEST_ASSERT_TRUE(compared * 10 > options.count * 9);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
