/* What scans add to a map and take from it again, and where a footprint fits on it. */
#include "src/local/patrol_marks.h"

#include "src/base/plane.h"
#include "src/local/patrol_approach.h"
#include "tests/support/near.h"

enum { SIDE = 60, BEAMS = 4 };

#define TOLERANCE 0.04f /* m */

static struct jp_terrain given;
static struct jp_terrain marked;
static uint64_t blocks[2][SIDE * 16 / 8];
static float ranges[BEAMS];
static const struct jp_scan scan = {ranges, BEAMS, 0.0f, 0.5f * JP_PLANE_PI};
static const struct jp_footprint footprint = {0.4f, 0.4f, 0.3f};

static void make_map(struct jp_terrain *map, uint64_t *block)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.125), .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(map, &config, block, sizeof blocks[0], &field));
}

void setUp(void)
{
    make_map(&given, blocks[0]);
    make_map(&marked, blocks[1]);
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = 0.0f;
    }
}

void tearDown(void)
{
}

static void occupy(struct jp_terrain *map, int x, int y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(map, x, y, JP_CELL_OCCUPIED));
}

static bool is_marked(int x, int y)
{
    return jp_terrain_cell(&marked, x, y) == JP_CELL_OCCUPIED;
}

/* In two parts. */
static void mark(const struct jp_plane_pose *scanner, float tolerance)
{
    jp_patrol_clear_ways(&given, &marked, &scan, scanner, tolerance, 0, 1);
    jp_patrol_clear_ways(&given, &marked, &scan, scanner, tolerance, 1, BEAMS);
    jp_patrol_mark_ends(&given, &marked, &scan, scanner, tolerance);
}

static void test_cells_of_coordinates(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_patrol_cell_at(&given, 0.0f));
    TEST_ASSERT_EQUAL_INT32(7, jp_patrol_cell_at(&given, 0.99f));
    TEST_ASSERT_EQUAL_INT32(8, jp_patrol_cell_at(&given, 1.0f));
    TEST_ASSERT_EQUAL_INT32(-1, jp_patrol_cell_at(&given, -0.01f));
    TEST_ASSERT_EQUAL_INT32(-8, jp_patrol_cell_at(&given, -1.0f));
    TEST_ASSERT_TRUE(jp_patrol_cell_at(&given, 32000.0f) > SIDE);
    TEST_ASSERT_TRUE(jp_patrol_cell_at(&given, -32000.0f) < 0);
}

/* A localiser's map may be as long as any, with a cell for each of its coordinates. */
static void test_cells_of_the_largest_map(void)
{
    for (int32_t i = 1000; i < JP_TERRAIN_SIDE_MAX; i += 100) {
        TEST_ASSERT_EQUAL_INT32(i, jp_patrol_cell_at(&given, 0.125f * ((float)i + 0.5f)));
    }
    TEST_ASSERT_TRUE(jp_patrol_cell_at(&given, 32000.0f) >= JP_TERRAIN_SIDE_MAX);
}

/* A pose off the map has no room, to whatever side. */
static void test_nothing_fits_off_the_map(void)
{
    for (int i = 0; i < 8; i++) {
        const struct jp_plane_point along = jp_plane_direction(0.25f * JP_PLANE_PI * (float)i);
        const struct jp_plane_pose pose = {3.75f + 20000.0f * along.x, 3.75f + 20000.0f * along.y, 0.3f};

        TEST_ASSERT_FALSE(jp_patrol_fits(&marked, &footprint, &pose, 0.1f));
    }
}

static void test_ends_of_beams_are_marked(void)
{
    const struct jp_plane_pose scanner = {3.0f, 3.0f, 0.0f};

    ranges[0] = 1.07f;
    ranges[1] = 2.07f;
    ranges[2] = 1.57f;
    ranges[3] = 0.57f;
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_TRUE(is_marked(32, 24));
    TEST_ASSERT_TRUE(is_marked(24, 40) || is_marked(23, 40));
    TEST_ASSERT_TRUE(is_marked(11, 24) || is_marked(11, 23));
    TEST_ASSERT_TRUE(is_marked(24, 19) || is_marked(23, 19));
}

/* What stands on the given map stays there. */
static void test_a_beam_clears_what_it_goes_through(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    occupy(&given, 28, 24);
    occupy(&marked, 27, 24);
    occupy(&marked, 30, 24);
    occupy(&marked, 27, 25);
    ranges[0] = 1.0f;
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_FALSE(is_marked(27, 24));
    TEST_ASSERT_TRUE(is_marked(28, 24));
    TEST_ASSERT_TRUE(is_marked(27, 25));
    TEST_ASSERT_TRUE(is_marked(32, 24));
    /* Where it may end by its error it does not say. */
    ranges[0] = 0.96f;
    occupy(&marked, 31, 24);
    mark(&scanner, 0.1f);
    TEST_ASSERT_TRUE(is_marked(31, 24));
    TEST_ASSERT_TRUE(is_marked(32, 24));
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_FALSE(is_marked(31, 24));
    TEST_ASSERT_TRUE(is_marked(32, 24));
}

/* A face on the border of a cell: what noise puts before it would close the gap beside it. */
static void test_a_thing_is_marked_behind_its_face(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    for (int i = -3; i <= 3; i++) {
        const float noise = 0.01f * (float)i;

        ranges[0] = 4.0f - 3.06f + noise;
        ranges[1] = 4.0f - 3.06f + noise;
        ranges[2] = 3.06f - 2.0f + noise;
        ranges[3] = 3.06f - 2.0f + noise;
        mark(&scanner, TOLERANCE);
        TEST_ASSERT_TRUE(is_marked(32, 24) && is_marked(24, 32) && is_marked(15, 24) && is_marked(24, 15));
        TEST_ASSERT_FALSE(is_marked(31, 24) || is_marked(24, 31) || is_marked(16, 24) || is_marked(24, 16));
    }
}

/* What was marked before a face from where the robot thought that it was goes with the first scan that shows it free.
 */
static void test_a_mark_before_a_face_goes(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    occupy(&marked, 31, 24);
    occupy(&marked, 33, 24);
    ranges[0] = 4.01f - 3.06f;
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_FALSE(is_marked(31, 24));
    TEST_ASSERT_TRUE(is_marked(32, 24));
    TEST_ASSERT_TRUE(is_marked(33, 24));
}

static void test_beams_that_hit_nothing_say_nothing(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    occupy(&marked, 27, 24);
    occupy(&marked, 24, 27);
    occupy(&marked, 21, 24);
    occupy(&marked, 24, 21);
    ranges[1] = -1.0f;
    ranges[2] = __builtin_inff();
    ranges[3] = __builtin_nanf("");
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_TRUE(is_marked(27, 24));
    TEST_ASSERT_TRUE(is_marked(24, 27));
    TEST_ASSERT_TRUE(is_marked(21, 24));
    TEST_ASSERT_TRUE(is_marked(24, 21));
}

/* The noise of a range, which would close an aisle, is not marked beside the walls of the map. */
static void test_an_end_beside_what_is_known_is_that(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    occupy(&given, 32, 24); /* from x = 4 m on */
    occupy(&given, 24, 32);
    occupy(&given, 15, 24); /* up to x = 2 m */
    occupy(&given, 24, 15);
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = i < 2 ? 0.91f : 1.03f;
    }
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_FALSE(is_marked(31, 24) || is_marked(24, 31) || is_marked(16, 24) || is_marked(24, 16));
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = i < 2 ? 0.88f : 1.0f;
    }
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_TRUE(is_marked(31, 24) && is_marked(24, 31) && is_marked(16, 24) && is_marked(24, 16));
}

static void test_what_stands_more_than_a_cell_from_it_is_marked(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    occupy(&given, 32, 24);
    ranges[0] = 0.79f; /* 0.15 m before it; the cell is of 0.125 m */
    mark(&scanner, 1000.0f);
    TEST_ASSERT_TRUE(is_marked(31, 24)); /* a cell behind its face, and no more */
    TEST_ASSERT_FALSE(is_marked(30, 24));
}

static void test_a_beam_beyond_the_map(void)
{
    const struct jp_plane_pose scanner = {3.06f, 3.06f, 0.0f};

    occupy(&marked, 50, 24);
    ranges[0] = 1.0e30f;
    mark(&scanner, TOLERANCE);
    TEST_ASSERT_FALSE(is_marked(50, 24));
}

static void test_where_the_footprint_fits(void)
{
    const struct jp_footprint behind = {0.1f, 0.7f, 0.3f};
    struct jp_plane_pose pose = {3.0f, 3.0f, 0.0f};

    occupy(&marked, 28, 24);
    TEST_ASSERT_TRUE(jp_patrol_fits(&marked, &footprint, &pose, 0.09f));
    TEST_ASSERT_FALSE(jp_patrol_fits(&marked, &footprint, &pose, 0.11f));
    TEST_ASSERT_TRUE(jp_patrol_fits(&marked, &behind, &pose, 0.39f));
    TEST_ASSERT_FALSE(jp_patrol_fits(&marked, &behind, &pose, 0.41f));
    pose.heading = 0.5f * JP_PLANE_PI;
    TEST_ASSERT_TRUE(jp_patrol_fits(&marked, &footprint, &pose, 0.19f));
    TEST_ASSERT_FALSE(jp_patrol_fits(&marked, &footprint, &pose, 0.21f));
    pose.x = -20000.0f;
    TEST_ASSERT_FALSE(jp_patrol_fits(&marked, &footprint, &pose, 0.0f));
}

/* An end is what stands on the map within the tolerance of it, and beyond that it is not, to all sides. */
static void test_an_end_is_what_stands_within_the_tolerance_of_it(void)
{
    for (int side = 0; side < 8; side++) {
        const int dx = side % 3 - 1;
        const int dy = side / 3 - 1;
        const struct jp_plane_pose scanner = {2.1875f, 3.0625f + 0.001f, 0.0f};

        for (int near = 0; near < 2; near++) {
            const float reach = near == 1 ? 0.08f : 0.05f;

            setUp();
            occupy(&given, 24 + (dx == 0 && dy == 0 ? 1 : dx), 24 + dy);
            ranges[0] = 24.5f * 0.125f - 2.1875f;
            mark(&scanner, reach);
            TEST_ASSERT_EQUAL_INT(near == 0, is_marked(24, 24) || is_marked(25, 24));
        }
    }
}

/* Beams clear the cells that they pass from the scanner on, its own too. */
static void test_a_beam_clears_all_of_its_way(void)
{
    const struct jp_plane_pose scanner = {3.0625f, 3.0625f, 0.25f * JP_PLANE_PI};

    for (int i = -8; i <= 8; i++) {
        occupy(&marked, 24 + i, 24 + i);
        occupy(&marked, 24 + i, 24 - i);
    }
    for (int i = 0; i < BEAMS; i++) {
        ranges[i] = 1.0f;
    }
    mark(&scanner, TOLERANCE);
    for (int i = -8; i <= 8; i++) {
        const bool is_free = i >= -5 && i <= 5;
        const bool is_kept = i <= -7 || i >= 7;

        TEST_ASSERT_TRUE(!is_free || (!is_marked(24 + i, 24 + i) && !is_marked(24 + i, 24 - i)));
        TEST_ASSERT_TRUE(!is_kept || (is_marked(24 + i, 24 + i) && is_marked(24 + i, 24 - i)));
    }
}

/* ---- Approaches ---- */

static const struct jp_plane_pose goal = {4.5f, 3.0f, 0.0f};
static struct jp_plane_pose approach;

static bool choose(void)
{
    return jp_patrol_choose_approach(&marked, &footprint, &goal, &approach);
}

static void test_where_it_can_turn_it_needs_no_approach(void)
{
    TEST_ASSERT_FALSE(choose());
}

/* An obstacle 0.4 m beside the goal. */
static void test_the_nearest_place_to_turn_is_the_approach(void)
{
    for (int x = 34; x < 40; x++) {
        occupy(&marked, x, 20);
    }
    TEST_ASSERT_TRUE(choose());
    TEST_ASSERT_NEAR(1.0e-5f, 4.5f - 0.8f, approach.x);
    TEST_ASSERT_NEAR(1.0e-5f, 3.0f, approach.y);
    TEST_ASSERT_NEAR(1.0e-5f, 0.0f, approach.heading);
    /* Nearer to it the way in is blocked. */
    occupy(&marked, 32, 26);
    TEST_ASSERT_FALSE(choose());
}

/* Between two walls 1.25 m apart it can turn with 0.06 m to spare. */
static void test_little_room_is_taken_where_there_is_no_more(void)
{
    for (int x = 0; x < SIDE; x++) {
        occupy(&marked, x, 18);
        occupy(&marked, x, 29);
    }
    for (int x = 34; x < 40; x++) {
        occupy(&marked, x, 20);
        if (x > 35) {
            occupy(&marked, x, 28);
        }
    }
    TEST_ASSERT_TRUE(choose());
    TEST_ASSERT_TRUE(approach.x < goal.x - 0.5f);
}
