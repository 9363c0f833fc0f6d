/* The field of distances against integers, and what is read of it against double precision, on and off the map. */
#include "src/local/wall_field.h"

#include "src/base/plane.h"
#include "tests/support/near.h"
#include "tests/target/random.h"

enum { WIDTH = 38, HEIGHT = 35, CAP = 16 };

#define CELL 0.25f

static struct jp_terrain map;
static uint64_t map_block[HEIGHT * 2];
static int8_t cells[WIDTH * HEIGHT + 1];
static int8_t column[HEIGHT + 1];
static struct jp_wall_field field;
static uint32_t state;

static void occupy(int x, int y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, JP_CELL_OCCUPIED));
}

static void clear(void)
{
    const struct jp_terrain_config config = {.width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.25)};
    const char *name;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &config, map_block, sizeof map_block, &name));
    field = (struct jp_wall_field){cells, WIDTH, HEIGHT, CELL};
}

static void make(void)
{
    cells[WIDTH * HEIGHT] = 99;
    column[HEIGHT] = 99;
    jp_wall_field_make(&field, &map, column);
    TEST_ASSERT_EQUAL_INT8(99, cells[WIDTH * HEIGHT]);
    TEST_ASSERT_EQUAL_INT8(99, column[HEIGHT]);
}

static void occupy_some(unsigned count)
{
    clear();
    for (unsigned i = 0; i < count; i++) {
        occupy((int)(target_random(&state) % WIDTH), (int)(target_random(&state) % HEIGHT));
    }
    make();
}

void setUp(void)
{
    state = 11;
    clear();
}

void tearDown(void)
{
}

static bool is_wall(int x, int y)
{
    return jp_terrain_cell(&map, x, y) == JP_CELL_OCCUPIED;
}

/* ---- What cells hold ---- */

/* The nearest cell of the other kind; off the map all is wall. */
static int32_t least_square(int x, int y)
{
    int32_t best = CAP * CAP;

    for (int j = y - CAP; j <= y + CAP; j++) {
        for (int i = x - CAP; i <= x + CAP; i++) {
            const int32_t square = (i - x) * (i - x) + (j - y) * (j - y);

            best = square < best && is_wall(i, j) != is_wall(x, y) ? square : best;
        }
    }
    return best;
}

/* Eighths of a cell to the edge, which is half a cell before the other one's middle, to the nearest: what is in a wall
 * is below 0. */
static void expect_cell(int x, int y)
{
    const int32_t square = least_square(x, y);
    const int32_t held = cells[y * WIDTH + x];
    const int32_t size = held < 0 ? -held : held;

    TEST_ASSERT_EQUAL_INT(is_wall(x, y), held < 0);
    if (square == CAP * CAP) {
        TEST_ASSERT_EQUAL_INT32(127, size);
    } else {
        TEST_ASSERT_TRUE((2 * size + 7) * (2 * size + 7) <= 256 * square);
        TEST_ASSERT_TRUE((2 * size + 9) * (2 * size + 9) > 256 * square);
    }
}

static void expect_cells(int step)
{
    for (int i = 0; i < WIDTH * HEIGHT; i += step) {
        expect_cell(i % WIDTH, i / WIDTH);
    }
}

static void test_an_empty_map_has_its_rim(void)
{
    make();
    expect_cells(1);
}

static void test_cells_are_rounded_to_the_nearest_eighth(void)
{
    for (unsigned run = 0; run < 4U; run++) {
        occupy_some(1U + 3U * run);
        expect_cells(3);
    }
}

static void test_walls_at_the_rim_go_on_beyond_it(void)
{
    for (int i = 0; i < 12; i++) {
        occupy(0, 2 * i + 3);
        occupy(WIDTH - 1, 2 * i + 4);
        occupy(3 * i + 1, 0);
        occupy(3 * i, HEIGHT - 1);
    }
    make();
    expect_cells(1);
}

static void test_the_depth_of_walls_is_held_likewise(void)
{
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        if (i % WIDTH != 19 || i / WIDTH != 17) {
            occupy(i % WIDTH, i / WIDTH);
        }
    }
    make();
    expect_cells(1);
}

/* ---- What is read of it ---- */

static double middle(int x, int y)
{
    const bool is_inside = x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT;

    return (is_inside ? (double)cells[y * WIDTH + x] / 8.0 : -0.5) * (double)CELL;
}

static double part(double from, int to)
{
    const double away = from > (double)to ? from - (double)to : (double)to - from;

    return away < 1.0 ? 1.0 - away : 0.0;
}

/* Of the four middles around a point, each by how near it is. */
static double between(struct jp_plane_point point)
{
    const double u = (double)point.x / (double)CELL - 0.5;
    const double v = (double)point.y / (double)CELL - 0.5;
    const int x = (int)(u + 8.0) - 8;
    const int y = (int)(v + 8.0) - 8;
    double sum = 0.0;

    for (int j = y; j <= y + 1; j++) {
        for (int i = x; i <= x + 1; i++) {
            sum += part(u, i) * part(v, j) * middle(i, j);
        }
    }
    return sum;
}

/* Up to half a cell off the map. */
static struct jp_plane_point point_about(void)
{
    const float x = (float)(target_random(&state) % 4096U) / 4096.0f;
    const float y = (float)(target_random(&state) % 4096U) / 4096.0f;

    return (struct jp_plane_point){CELL * (-0.45f + x * ((float)WIDTH + 0.9f)),
                                   CELL * (-0.45f + y * ((float)HEIGHT + 0.9f))};
}

static double slope(struct jp_plane_point point, float x, float y)
{
    const struct jp_plane_point back = {point.x - x, point.y - y};
    const struct jp_plane_point on = {point.x + x, point.y + y};

    return (between(on) - between(back)) / (2.0 * (double)(x + y));
}

/* Whether the four middles around a point and around what is a little beside it are the same. */
static bool is_off_seams(float at)
{
    const double u = (double)at / (double)CELL + 7.5;
    const double rest = u - (double)(int)u;

    return rest > 0.01 && rest < 0.99;
}

static void test_distances_are_read_between_the_middles_of_four_cells(void)
{
    occupy_some(9);
    for (unsigned i = 0; i < 400U; i++) {
        const struct jp_plane_point point = point_about();
        struct jp_wall_distance found;
        const double exact = between(point);
        const bool is_held = exact < 15.8 * (double)CELL && exact > -15.8 * (double)CELL;

        TEST_ASSERT_EQUAL_INT(is_held, jp_wall_field_find(&field, point, &found));
        TEST_ASSERT_NEAR(2.0e-6f * 20.0f, (float)exact, found.distance);
        if (is_off_seams(point.x) && is_off_seams(point.y)) {
            TEST_ASSERT_NEAR(1.0e-3f, (float)slope(point, 0.001f, 0.0f), found.gradient.x);
            TEST_ASSERT_NEAR(1.0e-3f, (float)slope(point, 0.0f, 0.001f), found.gradient.y);
        }
    }
}

/* Half a cell about a map is read; what is farther off is a wall of which nothing is known. */
static void test_off_the_map_is_a_wall_whose_edge_is_the_maps(void)
{
    struct jp_wall_distance found;

    make();
    for (int side = 0; side < 4; side++) {
        const bool is_far = side % 2 == 1;
        const float length = CELL * (float)(side < 2 ? WIDTH : HEIGHT);
        const float out = is_far ? 1.0f : -1.0f;
        const float rim = is_far ? length : 0.0f;
        const float inner = rim + out * 0.45f * CELL;
        const float outer = rim + out * 0.55f * CELL;
        const struct jp_plane_point near = {side < 2 ? inner : 1.0f, side < 2 ? 1.0f : inner};
        const struct jp_plane_point far = {side < 2 ? outer : 1.0f, side < 2 ? 1.0f : outer};

        TEST_ASSERT_TRUE(jp_wall_field_find(&field, near, &found));
        TEST_ASSERT_NEAR(1.0e-5f, -0.45f * CELL, found.distance);
        TEST_ASSERT_NEAR(1.0e-5f, side < 2 ? -out : 0.0f, found.gradient.x);
        TEST_ASSERT_NEAR(1.0e-5f, side < 2 ? 0.0f : -out, found.gradient.y);
        TEST_ASSERT_FALSE(jp_wall_field_find(&field, far, &found));
        TEST_ASSERT_NEAR(1.0e-5f, -0.5f * CELL, found.distance);
        TEST_ASSERT_NEAR(0.0f, 0.0f, found.gradient.x);
    }
}

static void test_the_cell_around_a_point_tells_how_near_walls_are(void)
{
    occupy_some(9);
    for (unsigned i = 0; i < 400U; i++) {
        const struct jp_plane_point point = point_about();
        const int x = (int)(point.x / CELL + 8.0f) - 8;
        const int y = (int)(point.y / CELL + 8.0f) - 8;
        const double exact = middle(x, y);

        TEST_ASSERT_NEAR(1.0e-5f, (float)(exact < 0.0 ? -exact : exact), jp_wall_field_near(&field, point));
    }
}

/* A cell has its western and southern edge. */
static void test_an_edge_between_cells_is_the_eastern_and_northern_ones(void)
{
    occupy(10, 10);
    make();
    for (int i = 6; i < 14; i++) {
        const struct jp_plane_point corner = {CELL * (float)i, CELL * (float)(20 - i)};
        const double exact = middle(i, 20 - i);

        TEST_ASSERT_NEAR(1.0e-5f, (float)(exact < 0.0 ? -exact : exact), jp_wall_field_near(&field, corner));
    }
}

static void test_a_map_of_the_largest_width_is_read_to_its_end(void)
{
    static int8_t row[JP_TERRAIN_SIDE_MAX];
    const struct jp_wall_field longest = {row, (int32_t)(sizeof row), 1, CELL};

    for (size_t i = 0; i < sizeof row; i++) {
        row[i] = i + 1U < sizeof row ? 4 : 12;
    }
    TEST_ASSERT_NEAR(1.0e-5f, 1.5f * CELL,
                     jp_wall_field_near(&longest, (struct jp_plane_point){CELL * ((float)sizeof row - 0.5f), 0.1f}));
}

/* ---- Rays ---- */

/* To where it is a fifth of a cell deep in a wall, in small steps. */
static float way_to_wall(struct jp_plane_point from, struct jp_plane_point along, float most)
{
    float way = 0.0f;

    while (way < most &&
           between((struct jp_plane_point){from.x + way * along.x, from.y + way * along.y}) >= -0.2 * (double)CELL) {
        way += 0.02f * CELL;
    }
    return way < most ? way : most;
}

/* A ray is no shorter than the way to the wall, nor longer by more than half a cell, its least step; one that grazes a
 * wall may miss it. */
static void test_rays_end_in_the_first_wall(void)
{
    unsigned longer = 0;

    for (unsigned run = 0; run < 6U; run++) {
        occupy_some(run);
        for (unsigned i = 0; i < 20U; i++) {
            const struct jp_plane_point from = point_about();
            const struct jp_plane_point along = jp_plane_direction(0.31f * (float)(i + 20U * run));
            const float exact = way_to_wall(from, along, 6.0f);
            const float way = jp_wall_field_ray(&field, from, along, 6.0f);

            TEST_ASSERT_TRUE(way >= exact - 0.02f * CELL);
            longer += way > exact + 0.51f * CELL ? 1U : 0U;
        }
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT(0, longer);
}

static void test_a_ray_from_within_a_wall_has_no_length(void)
{
    occupy(10, 10);
    make();
    TEST_ASSERT_NEAR(0.0f, 0.0f,
                     jp_wall_field_ray(&field, (struct jp_plane_point){10.5f * CELL, 10.5f * CELL},
                                       (struct jp_plane_point){1.0f, 0.0f}, 3.0f));
    /* What is less than a fifth of a cell deep may be the noise of a range. */
    TEST_ASSERT_TRUE(jp_wall_field_ray(&field, (struct jp_plane_point){11.0f * CELL - 0.1f * CELL, 10.5f * CELL},
                                       (struct jp_plane_point){1.0f, 0.0f}, 3.0f) > 2.9f);
}
