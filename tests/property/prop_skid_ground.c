/* The ground of the plant of skid steer and differential drive: planes, and maps between their cells. */
#include <stdio.h>

#include "tests/support/check.h"
#include "tests/support/options.h"
#include "tests/support/skid_hills.h"
#include "unity.h"

static const struct options defaults = {.count = 2000, .seed = 2018};
static struct options options;
static struct random noise;
static struct jp_terrain map;
static struct skid_hills hills;
static struct skid_ground ground;

/* Cells of maps are wholes of 2⁻¹⁶ m. */
static double cell;

void setUp(void)
{
    random_init(&noise, options.seed);
    hills = skid_random_hills(&noise, 0.4);
    skid_make_map(&map, &hills);
    ground = skid_ground_map(&map);
    cell = map.config.resolution / 65536.0;
}

void tearDown(void)
{
}

static double somewhere(void)
{
    return random_uniform(&noise, cell, (SKID_MAP_SIDE - 1) * cell);
}

static struct skid_ground_point at(double x, double y)
{
    return ground.at(ground.context, x, y);
}

static double stored(int32_t x, int32_t y)
{
    return (double)jp_terrain_elevation(&map, x, y) / JP_ELEVATION_ONE;
}

/* ---- Slopes ---- */

static void test_slope_rises_towards_its_heading(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double degrees = random_uniform(&noise, -60, 60);
        const double heading = random_uniform(&noise, -M_PI, M_PI);
        const struct skid_slope slope = skid_slope_towards(degrees, heading);
        const double way = random_uniform(&noise, -50, 50);
        const double aside = random_uniform(&noise, -50, 50);
        ground = skid_ground_slope(&slope);
        const struct skid_ground_point point =
            at(way * cos(heading) - aside * sin(heading), way * sin(heading) + aside * cos(heading));
        check_near(way * tan(degrees * M_PI / 180), point.elevation, 1e-9, "elevation, m");
        check_near(fabs(tan(degrees * M_PI / 180)), hypot(point.slope_x, point.slope_y), 1e-12, "slope");
        check_near(tan(degrees * M_PI / 180), point.slope_x * cos(heading) + point.slope_y * sin(heading), 1e-12,
                   "slope along the heading");
    }
}

static void test_level_slope_is_level(void)
{
    const struct skid_slope slope = skid_slope_towards(0, 1);
    ground = skid_ground_slope(&slope);
    const struct skid_ground_point point = at(17, -3);
    check_near(0, point.elevation, 0, "elevation");
    check_near(0, hypot(point.slope_x, point.slope_y), 0, "slope");
}

/* ---- Maps ---- */

static void test_middles_of_cells_have_their_elevation(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const int32_t x = (int32_t)random_uniform(&noise, 0, SKID_MAP_SIDE);
        const int32_t y = (int32_t)random_uniform(&noise, 0, SKID_MAP_SIDE);
        check_near(stored(x, y), at((x + 0.5) * cell, (y + 0.5) * cell).elevation, 1e-9, "elevation, m");
    }
}

/* An oracle of its own: the weights of the four middles around a place. */
static void test_between_middles_it_is_bilinear(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double x = somewhere();
        const double y = somewhere();
        double expected = 0;
        double weights = 0;
        for (int32_t row = 0; row < SKID_MAP_SIDE; row++) {
            const double up = 1 - fabs((row + 0.5) - y / cell);
            for (int32_t column = 0; up > 0 && column < SKID_MAP_SIDE; column++) {
                const double across = 1 - fabs((column + 0.5) - x / cell);
                if (across > 0) {
                    expected += up * across * stored(column, row);
                    weights += up * across;
                }
            }
        }
        check_near(1, weights, 1e-9, "weights");
        check_near(expected, at(x, y).elevation, 1e-9, "elevation, m");
    }
}

static void test_slopes_are_what_the_elevation_changes_by(void)
{
    const double step = 1e-6;

    for (unsigned long run = 0; run < options.count; run++) {
        /* Not across a middle, where slopes jump. */
        const double x =
            (floor(random_uniform(&noise, 0, SKID_MAP_SIDE - 1)) + random_uniform(&noise, 0.51, 1.49)) * cell;
        const double y =
            (floor(random_uniform(&noise, 0, SKID_MAP_SIDE - 1)) + random_uniform(&noise, 0.51, 1.49)) * cell;
        const struct skid_ground_point point = at(x, y);
        check_near((at(x + step, y).elevation - at(x - step, y).elevation) / (2 * step), point.slope_x, 1e-6,
                   "slope along x");
        check_near((at(x, y + step).elevation - at(x, y - step).elevation) / (2 * step), point.slope_y, 1e-6,
                   "slope along y");
    }
}

static void test_elevation_has_no_jumps(void)
{
    const double step = 1e-7;

    for (unsigned long run = 0; run < options.count; run++) {
        const double x = random_uniform(&noise, -2, SKID_MAP_SIDE * cell + 2);
        const double y = (floor(random_uniform(&noise, 0, SKID_MAP_SIDE)) + 0.5) * cell;
        check_near(at(x, y - step).elevation, at(x, y + step).elevation, 1e-6, "m across a row's middle");
        check_near(at(y - step, x).elevation, at(y + step, x).elevation, 1e-6, "m across a column's middle");
    }
}

static void test_beyond_the_outermost_middles_it_goes_on_level(void)
{
    const double last = (SKID_MAP_SIDE - 0.5) * cell;

    for (unsigned long run = 0; run < options.count; run++) {
        const double beyond = random_uniform(&noise, 0, 1000);
        const double along = somewhere();
        check_near(at(0.5 * cell, along).elevation, at(0.5 * cell - beyond, along).elevation, 1e-9, "west");
        check_near(at(last, along).elevation, at(last + beyond, along).elevation, 1e-9, "east");
        check_near(at(along, 0.5 * cell).elevation, at(along, 0.5 * cell - beyond).elevation, 1e-9, "south");
        check_near(at(along, last).elevation, at(along, last + beyond).elevation, 1e-9, "north");
        check_near(0, at(last + beyond, along).slope_x, 0, "level beyond the east");
        check_near(0, at(along, -beyond).slope_y, 0, "level beyond the south");
    }
}

static void test_map_follows_the_hills(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const double x = somewhere();
        const double y = somewhere();
        const struct skid_ground_point exact = skid_on_hills(&hills, x, y);
        const struct skid_ground_point point = at(x, y);
        check_near(exact.elevation, point.elevation, 0.005, "elevation, m");
        check_near(exact.slope_x, point.slope_x, 0.08, "slope");
        check_near(exact.slope_y, point.slope_y, 0.08, "slope");
    }
}

static void test_map_of_one_cell_is_level(void)
{
    static uint64_t block[8];
    const struct jp_terrain_config config = {.width = 1, .height = 1, .resolution = JP_Q16(0.5), .has_elevation = true};
    const char *field = "";
    struct jp_terrain one;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&one, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&one, 0, 0, 3 * JP_ELEVATION_ONE));
    ground = skid_ground_map(&one);
    for (int i = -3; i <= 3; i++) {
        const struct skid_ground_point point = at(i, -i);
        check_near(3, point.elevation, 0, "elevation, m");
        check_near(0, hypot(point.slope_x, point.slope_y), 0, "slope");
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
