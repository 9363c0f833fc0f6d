/* The laser scanner against its geometry: random maps, shapes and beams, each by another way of reckoning. */
#include <math.h>
#include <stdio.h>

#include "sim/four_wheel/laser.h"
#include "tests/support/options.h"
#include "unity.h"

#define SHAPES 6
#define RANGE  8.0 /* m */
#define SIDE   60  /* cells of the random maps */
#define CELL   0.05

static struct options options = {.count = 40, .seed = 20};
static struct random noise;

static struct jp_terrain terrain;
static _Alignas(8) uint32_t block[2 * SIDE * ((SIDE + 31) / 32)];
static struct solid_map map;
static struct planar_shape shapes[SHAPES];
static struct laser_scan scan;

static void check(bool holds, const char *what, double expected, double actual)
{
    char message[160];
    (void)snprintf(message, sizeof message, "%s: expected %.9g, is %.9g", what, expected, actual);
    TEST_ASSERT_TRUE_MESSAGE(holds, message);
}

static void check_near(double expected, double actual, double bound, const char *what)
{
    check(expected == actual || fabs(actual - expected) <= bound, what, expected, actual);
}

/* A map of free ground with this share of other cells. */
static void make_map(double share, enum jp_cell other, bool unknown_is_free)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(CELL), .unknown_is_free = unknown_is_free};
    const char *field;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            const enum jp_cell cell = random_uniform(&noise, 0, 1) < share ? other : JP_CELL_FREE;
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, cell));
        }
    }
    solid_map_free(&map);
    TEST_ASSERT_TRUE(solid_map_init(&map, &terrain));
}

void setUp(void)
{
    random_init(&noise, options.seed);
    make_map(0, JP_CELL_OCCUPIED, false);
}

void tearDown(void)
{
    solid_map_free(&map);
}

/* ---- The map of distances ---- */

static int distance_by_search(int x, int y)
{
    for (int r = 0;; r++) {
        for (int dy = -r; dy <= r; dy++) {
            for (int dx = -r; dx <= r; dx++) {
                if (jp_terrain_cell(&terrain, x + dx, y + dy) == JP_CELL_OCCUPIED) {
                    return r;
                }
            }
        }
    }
}

static void test_distances_of_cells(void)
{
    for (int run = 0; run < 6; run++) {
        make_map(run * run * 0.004, JP_CELL_OCCUPIED, false);
        for (int y = -1; y <= SIDE; y++) {
            for (int x = -1; x <= SIDE; x++) {
                TEST_ASSERT_EQUAL_INT(distance_by_search(x, y), solid_map_distance(&map, x, y));
            }
        }
    }
}

/* ---- Rays over cells ---- */

/* Where a ray enters a rectangle, m; infinity: it does not. */
static double slab(const struct planar_point *from, double bearing, double x, double y, double size)
{
    const double along[2] = {cos(bearing), sin(bearing)};
    const double low[2] = {x - from->x, y - from->y};
    double enters = 0;
    double leaves = INFINITY;
    for (int i = 0; i < 2; i++) {
        const double a = low[i] / along[i];
        const double b = (low[i] + size) / along[i];
        enters = fmax(enters, fmin(a, b));
        leaves = fmin(leaves, fmax(a, b));
    }
    return enters < leaves ? enters : INFINITY;
}

/* All cells, and the border around the map. */
static double ray_by_search(const struct planar_point *from, double bearing)
{
    const double cell = map.cell;
    double least = INFINITY;
    for (int y = -1; y <= SIDE; y++) {
        for (int x = -1; x <= SIDE; x++) {
            if (jp_terrain_cell(&terrain, x, y) == JP_CELL_OCCUPIED) {
                least = fmin(least, slab(from, bearing, x * cell, y * cell, cell));
            }
        }
    }
    return least;
}

static struct planar_point free_point(void)
{
    for (;;) {
        const struct planar_point point = {random_uniform(&noise, 0, SIDE * CELL),
                                           random_uniform(&noise, 0, SIDE * CELL)};
        if (solid_map_distance(&map, (int)floor(point.x / map.cell), (int)floor(point.y / map.cell)) > 0) {
            return point;
        }
    }
}

/* A ray may pass a corner on either side, by rounding: then a neighbouring bearing must agree. */
static bool agrees(const struct planar_point *from, double bearing, double distance)
{
    for (int i = -1; i <= 1; i++) {
        if (fabs(ray_by_search(from, bearing + i * 1e-9) - distance) < 1e-6) {
            return true;
        }
    }
    return false;
}

static void test_rays_end_at_the_first_solid_cell(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        make_map(random_uniform(&noise, 0, 0.1), JP_CELL_OCCUPIED, false);
        for (int ray = 0; ray < 50; ray++) {
            const struct planar_point from = free_point();
            const double bearing = random_uniform(&noise, -M_PI, M_PI);
            const double distance = laser_ray(&map, NULL, 0, &from, bearing, RANGE);
            check(agrees(&from, bearing, distance), "ray, m", ray_by_search(&from, bearing), distance);
        }
    }
}

/* Along the axes, on the lines between cells and through corners nothing hangs or leaves the map. */
static void test_rays_along_grid_lines(void)
{
    make_map(0.05, JP_CELL_OCCUPIED, false);
    for (int i = 0; i < 2000; i++) {
        const struct planar_point from = {floor(random_uniform(&noise, 1, SIDE - 1)) * map.cell,
                                          floor(random_uniform(&noise, 1, SIDE - 1)) * map.cell};
        const double bearing = M_PI / 4 * (i % 8);
        const double distance = laser_ray(&map, NULL, 0, &from, bearing, RANGE);
        check(distance >= 0 && distance <= SIDE * map.cell * sqrt(2) + 1e-6, "within the map, m", 0, distance);
    }
    make_map(0, JP_CELL_OCCUPIED, false);
    const struct planar_point from = {1, 1};
    const double end = SIDE * map.cell;
    check_near(end - 1, laser_ray(&map, NULL, 0, &from, 0, RANGE), 1e-9, "east");
    check_near(end - 1, laser_ray(&map, NULL, 0, &from, M_PI / 2, RANGE), 1e-9, "north");
    check_near(1, laser_ray(&map, NULL, 0, &from, M_PI, RANGE), 1e-9, "west");
    check_near(1, laser_ray(&map, NULL, 0, &from, -M_PI / 2, RANGE), 1e-9, "south");
}

static void test_range_limit(void)
{
    const struct planar_point from = {1, 1.02};
    const double wall = SIDE * map.cell - 1;
    check_near(wall, laser_ray(&map, NULL, 0, &from, 0, wall + 1e-6), 1e-9, "within range");
    check_near(INFINITY, laser_ray(&map, NULL, 0, &from, 0, wall - 1e-6), 0, "beyond range");
}

static void test_unknown_cells_are_solid_unless_they_may_be_driven_over(void)
{
    const struct planar_point from = {1.02, 1.02};
    make_map(0, JP_CELL_OCCUPIED, false);
    (void)jp_terrain_set_cell(&terrain, 40, 20, JP_CELL_UNKNOWN);
    solid_map_free(&map);
    TEST_ASSERT_TRUE(solid_map_init(&map, &terrain));
    check_near(40 * map.cell - 1.02, laser_ray(&map, NULL, 0, &from, 0, RANGE), 1e-9, "unknown cell");
    make_map(1, JP_CELL_UNKNOWN, true);
    check_near(SIDE * map.cell - 1.02, laser_ray(&map, NULL, 0, &from, 0, RANGE), 1e-9, "edge of the map");
}

/* ---- Rays over shapes ---- */

static struct planar_shape random_shape(void)
{
    return (struct planar_shape){
        .kind = random_uniform(&noise, 0, 1) < 0.5 ? PLANAR_DISC : PLANAR_BOX,
        .pose = {random_uniform(&noise, 0, SIDE * CELL), random_uniform(&noise, 0, SIDE * CELL),
                 random_uniform(&noise, -M_PI, M_PI)},
        .radius = random_uniform(&noise, 0.05, 0.4),
        .half_length = random_uniform(&noise, 0.05, 0.6),
        .half_width = random_uniform(&noise, 0.05, 0.3),
    };
}

/* How far a point is outside of a shape: 0 on its surface, negative within. */
static double outside(const struct planar_shape *shape, double x, double y)
{
    const double dx = x - shape->pose.x;
    const double dy = y - shape->pose.y;
    if (shape->kind == PLANAR_DISC) {
        return hypot(dx, dy) - shape->radius;
    }
    const double u = dx * cos(shape->pose.heading) + dy * sin(shape->pose.heading);
    const double v = dy * cos(shape->pose.heading) - dx * sin(shape->pose.heading);
    return fmax(fabs(u) - shape->half_length, fabs(v) - shape->half_width);
}

/* The ray ends on a surface, or at the map alone, and no point before lies within a shape. */
static void check_shape_ray(const struct planar_point *from, double bearing)
{
    const double bare = laser_ray(&map, NULL, 0, from, bearing, RANGE);
    const double distance = laser_ray(&map, shapes, SHAPES, from, bearing, RANGE);
    double nearest = INFINITY;
    check(distance <= bare, "shapes only shorten, m", bare, distance);
    for (int i = 0; i < SHAPES; i++) {
        const double end =
            fabs(outside(&shapes[i], from->x + distance * cos(bearing), from->y + distance * sin(bearing)));
        nearest = fmin(nearest, end);
        if (outside(&shapes[i], from->x, from->y) < 0) {
            continue;
        }
        for (double at = 0; at < distance - 1e-6; at += 0.01) {
            const double within = outside(&shapes[i], from->x + at * cos(bearing), from->y + at * sin(bearing));
            check(within > -1e-9, "nothing before the end, m", 0, within);
        }
    }
    check(distance == bare || nearest < 1e-9, "end on a surface, m", 0, nearest);
}

static void test_rays_end_on_shapes(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        for (int i = 0; i < SHAPES; i++) {
            shapes[i] = random_shape();
        }
        for (int ray = 0; ray < 50; ray++) {
            const struct planar_point from = free_point();
            check_shape_ray(&from, random_uniform(&noise, -M_PI, M_PI));
        }
    }
}

static void test_known_shapes(void)
{
    const struct planar_point from = {0.5, 1.5};
    const struct planar_shape disc = {.kind = PLANAR_DISC, .pose = {2, 1.5, 0}, .radius = 0.3};
    const struct planar_shape box = {
        .kind = PLANAR_BOX, .pose = {2, 1.5, M_PI / 4}, .half_length = 0.2, .half_width = 0.2};
    check_near(1.2, laser_ray(&map, &disc, 1, &from, 0, RANGE), 1e-12, "disc");
    check_near(1.5 - 0.2 * sqrt(2), laser_ray(&map, &box, 1, &from, 0, RANGE), 1e-12, "corner of a box");
    check_near(0.5, laser_ray(&map, &disc, 1, &from, M_PI, RANGE), 1e-9, "nothing behind");
}

/* ---- Scans ---- */

static struct laser_config ideal(void)
{
    return laser_config_of(360, 2 * M_PI, RANGE, 0);
}

static void test_beams_of_a_field(void)
{
    const struct laser_config all = ideal();
    check_near(-M_PI, all.first, 1e-12, "first of a full turn");
    check_near(M_PI / 180, all.step, 1e-12, "step of a full turn");
    const struct laser_config half = laser_config_of(181, M_PI, RANGE, 0);
    check_near(-M_PI / 2, half.first, 1e-12, "first of half a turn");
    check_near(M_PI / 2, half.first + 180 * half.step, 1e-12, "last of half a turn");
}

/* Without noise a scan is its rays, also where a shape stands across the back, and around the scanner. */
static void test_scan_is_made_of_rays(void)
{
    for (unsigned long run = 0; run < options.count; run++) {
        const struct laser_config config = run % 2 == 0 ? ideal() : laser_config_of(91, M_PI, RANGE, 0);
        const struct planar_point from = free_point();
        const struct planar_pose scanner = {from.x, from.y, random_uniform(&noise, -10, 10)};
        make_map(0.01, JP_CELL_OCCUPIED, false);
        for (int i = 0; i < SHAPES; i++) {
            shapes[i] = random_shape();
        }
        laser_take(&config, &map, shapes, SHAPES, &scanner, &noise, &scan);
        TEST_ASSERT_EQUAL_INT(config.beams, scan.beams);
        for (int i = 0; i < scan.beams; i++) {
            const double bearing = scanner.heading + scan.first + i * scan.step;
            const double distance = laser_ray(&map, shapes, SHAPES, &from, bearing, RANGE);
            check_near(isinf(distance) ? 0 : distance, (double)scan.ranges[i], 1e-5, "beam, m");
        }
    }
}

static void test_scanner_within_a_wall_sees_nothing(void)
{
    const struct laser_config config = laser_config_of(360, 2 * M_PI, RANGE, 0.01);
    const struct planar_pose scanner = {-0.5, 1, 0};
    laser_take(&config, &map, NULL, 0, &scanner, &noise, &scan);
    for (int i = 0; i < scan.beams; i++) {
        check_near(0, (double)scan.ranges[i], 0, "range, m");
    }
}

static void test_noise_and_dropouts_are_as_asked(void)
{
    struct laser_config config = laser_config_of(720, 2 * M_PI, RANGE, 0.01);
    const struct planar_pose scanner = {1.513, 1.487, 0.3};
    const struct planar_point from = {scanner.x, scanner.y};
    double sum = 0;
    double squares = 0;
    int seen = 0;
    int dropped = 0;
    config.dropout = 0.2;
    for (int run = 0; run < 50; run++) {
        laser_take(&config, &map, NULL, 0, &scanner, &noise, &scan);
        for (int i = 0; i < scan.beams; i++) {
            dropped += scan.ranges[i] == LASER_DROPPED;
            if (scan.ranges[i] > 0) {
                const double bearing = scanner.heading + scan.first + i * scan.step;
                const double error = (double)scan.ranges[i] - laser_ray(&map, NULL, 0, &from, bearing, RANGE);
                sum += error;
                squares += error * error;
                seen++;
            }
        }
    }
    check_near(0.8, seen / (50.0 * 720), 0.01, "share of beams");
    check_near(0.2, dropped / (50.0 * 720), 0.01, "share of dropouts");
    check_near(0, sum / seen, 3e-4, "mean of the noise, m");
    check_near(0.01, sqrt(squares / seen), 2e-4, "deviation of the noise, m");
}

static void test_same_seed_same_scan(void)
{
    static struct laser_scan again;
    const struct laser_config config = laser_config_of(360, 2 * M_PI, RANGE, 0.01);
    const struct planar_pose scanner = {1.5, 1.5, 0.3};
    struct random first;
    random_init(&first, 7);
    laser_take(&config, &map, NULL, 0, &scanner, &first, &scan);
    random_init(&first, 7);
    laser_take(&config, &map, NULL, 0, &scanner, &first, &again);
    TEST_ASSERT_EQUAL_MEMORY(scan.ranges, again.ranges, 360 * sizeof scan.ranges[0]);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
