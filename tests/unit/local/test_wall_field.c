/* Distances from the walls of a small map, against the nearest cell by brute force, and rays. */
#include "src/local/wall_field.h"

#include "src/base/plane.h"
#include "tests/support/near.h"
#include "tests/target/random.h"

enum { WIDTH = 40, HEIGHT = 24 };

#define CELL 0.125f

static struct jp_terrain map;
static uint64_t map_block[HEIGHT * 2];
static int8_t cells[WIDTH * HEIGHT];
static int8_t column[HEIGHT];
static struct jp_wall_field field;
static struct jp_wall_distance found;

void setUp(void)
{
    const struct jp_terrain_config config = {.width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.125)};
    const char *name;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &config, map_block, sizeof map_block, &name));
    field = (struct jp_wall_field){cells, WIDTH, HEIGHT, CELL};
}

void tearDown(void)
{
}

static void occupy(int x0, int y0, int x1, int y1)
{
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, JP_CELL_OCCUPIED));
        }
    }
}

static void make(void)
{
    jp_wall_field_make(&field, &map, column);
}

static bool is_wall(int x, int y)
{
    return jp_terrain_cell(&map, x, y) == JP_CELL_OCCUPIED;
}

/* Square of the distance to the nearest cell of the other kind; off the map all is wall. */
static int least_square(int x, int y)
{
    int best = 16 * 16;

    for (int j = y - 16; j <= y + 16; j++) {
        for (int i = x - 16; i <= x + 16; i++) {
            const int square = (i - x) * (i - x) + (j - y) * (j - y);

            if (is_wall(i, j) != is_wall(x, y) && square < best) {
                best = square;
            }
        }
    }
    return best;
}

static void check_cell(int x, int y)
{
    const int square = least_square(x, y);
    const float distance = jp_plane_square_root((float)square) - 0.5f;
    const float expected = square == 16 * 16 ? 127.0f / 8.0f : distance;

    TEST_ASSERT_NEAR(0.0626f, is_wall(x, y) ? -expected : expected, (float)cells[y * WIDTH + x] / 8.0f);
}

static void test_cells_hold_the_distance_to_the_nearest_edge(void)
{
    uint32_t state = 7;

    for (int run = 0; run < 3; run++) {
        setUp();
        for (int i = 0; i < 2 + 4 * run; i++) {
            const int x = (int)(target_random(&state) % (WIDTH - 4U));
            const int y = (int)(target_random(&state) % (HEIGHT - 4U));

            occupy(x, y, x + 1 + (int)(target_random(&state) % 4U), y + 1 + (int)(target_random(&state) % 4U));
        }
        make();
        for (int y = 0; y < HEIGHT; y += 3) {
            for (int x = 0; x < WIDTH; x += 2) {
                check_cell(x, y);
            }
        }
    }
}

static void test_a_map_of_walls_has_no_edge(void)
{
    occupy(0, 0, WIDTH, HEIGHT);
    make();
    TEST_ASSERT_EQUAL_INT8(-127, cells[0]);
    TEST_ASSERT_EQUAL_INT8(-127, cells[WIDTH * HEIGHT - 1]);
    TEST_ASSERT_FALSE(jp_wall_field_find(&field, (struct jp_plane_point){2.0f, 1.5f}, &found));
    TEST_ASSERT_NEAR(
        1.0e-4f, 0.0f,
        jp_wall_field_ray(&field, (struct jp_plane_point){2.0f, 1.5f}, (struct jp_plane_point){1.0f, 0.0f}, 1.0f));
}

static void test_edges_are_where_cells_end(void)
{
    occupy(20, 0, 24, HEIGHT);
    make();
    for (int i = -3; i <= 3; i++) {
        const float off = 0.03f * (float)i;

        TEST_ASSERT_TRUE(jp_wall_field_find(&field, (struct jp_plane_point){2.5f + off, 1.5f}, &found));
        TEST_ASSERT_NEAR(1.0e-4f, -off, found.distance);
        TEST_ASSERT_NEAR(1.0e-4f, -1.0f, found.gradient.x);
        TEST_ASSERT_NEAR(1.0e-4f, 0.0f, found.gradient.y);
    }
    TEST_ASSERT_NEAR(1.0e-4f, 0.4375f, jp_wall_field_near(&field, (struct jp_plane_point){2.01f, 1.5f}));
    TEST_ASSERT_NEAR(1.0e-4f, 0.0625f, jp_wall_field_near(&field, (struct jp_plane_point){2.51f, 1.5f}));
}

static void test_the_edge_of_the_map_is_one(void)
{
    make();
    TEST_ASSERT_TRUE(jp_wall_field_find(&field, (struct jp_plane_point){0.02f, 1.5f}, &found));
    TEST_ASSERT_NEAR(1.0e-4f, 0.02f, found.distance);
    TEST_ASSERT_TRUE(jp_wall_field_find(&field, (struct jp_plane_point){5.02f, 1.5f}, &found));
    TEST_ASSERT_NEAR(1.0e-4f, -0.02f, found.distance);
    TEST_ASSERT_FALSE(jp_wall_field_find(&field, (struct jp_plane_point){-0.2f, 1.5f}, &found));
    TEST_ASSERT_FALSE(jp_wall_field_find(&field, (struct jp_plane_point){5.2f, 1.5f}, &found));
    TEST_ASSERT_FALSE(jp_wall_field_find(&field, (struct jp_plane_point){1.0f, -0.2f}, &found));
    TEST_ASSERT_FALSE(jp_wall_field_find(&field, (struct jp_plane_point){1.0f, 3.2f}, &found));
    TEST_ASSERT_FALSE(jp_wall_field_find(&field, (struct jp_plane_point){-30000.0f, 30000.0f}, &found));
    TEST_ASSERT_NEAR(1.0e-4f, -0.0625f, found.distance);
}

static void test_unknown_cells_are_no_walls(void)
{
    make();
    TEST_ASSERT_TRUE(cells[5 * WIDTH + 10] > 0);
}

static void test_rays_end_at_the_first_wall(void)
{
    const struct jp_plane_point from = {1.0f, 1.5f};
    const struct jp_plane_point east = {1.0f, 0.0f};
    const struct jp_plane_point aslant = jp_plane_direction(0.3f);

    occupy(24, 0, 25, HEIGHT);
    make();
    TEST_ASSERT_NEAR(0.09f, 2.05f, jp_wall_field_ray(&field, from, east, 5.0f));
    TEST_ASSERT_NEAR(0.09f, 2.13f, jp_wall_field_ray(&field, from, aslant, 5.0f));
    TEST_ASSERT_NEAR(1.0e-4f, 1.5f, jp_wall_field_ray(&field, from, east, 1.5f));
}
