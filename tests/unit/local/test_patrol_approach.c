/* Where a robot turns into a blind corridor: by the room that a disc around it needs, whatever the corridor's length,
 * width and direction. */
#include "src/local/patrol_approach.h"

#include "src/base/plane.h"
#include "tests/support/near.h"

enum { SIDE = 64 };

#define CELL 0.125f

static struct jp_terrain map;
static uint64_t block[SIDE * 16 / 8];
static const struct jp_footprint footprint = {0.4f, 0.4f, 0.3f};
static const float distances[] = {0.6f, 0.8f, 1.0f, 1.3f, 1.6f, 2.0f};
static unsigned quarter; /* turns of all of it, to the left */

void setUp(void)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.125), .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &config, block, sizeof block, &field));
    quarter = 0;
}

void tearDown(void)
{
}

/* ---- A map that is turned ---- */

static void occupy(int x, int y)
{
    for (unsigned i = 0; i < quarter; i++) {
        const int old = x;

        x = SIDE - 1 - y;
        y = old;
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, JP_CELL_OCCUPIED));
}

static struct jp_plane_pose turned(float x, float y)
{
    const float side = CELL * (float)SIDE;
    struct jp_plane_pose pose = {x, y, 0.0f};

    for (unsigned i = 0; i < quarter; i++) {
        const float old = pose.x;

        pose.x = side - pose.y;
        pose.y = old;
        pose.heading += 0.5f * JP_PLANE_PI;
    }
    return pose;
}

/* From x = 4 m on there is wall but for a corridor of so many cells to the east, north of y = 4 m. */
static void make_corridor(int width)
{
    for (int y = 0; y < SIDE; y++) {
        for (int x = 32; x < SIDE; x++) {
            if (y < 32 || y >= 32 + width) {
                occupy(x, y);
            }
        }
    }
}

static bool choose(float x, float y, struct jp_plane_pose *approach)
{
    const struct jp_plane_pose goal = turned(x, y);

    return jp_patrol_choose_approach(&map, &footprint, &goal, approach);
}

/* ---- How far ---- */

/* So far before the corridor the disc of a robot that is larger by a margin keeps off its corners. */
static float least_before(float half_width, float margin)
{
    const float radius = jp_plane_length(0.4f + margin, 0.3f + margin);

    return jp_plane_square_root(radius * radius - half_width * half_width);
}

/* The first that is far enough. */
static float distance_from(float depth)
{
    unsigned i = 0;

    while (distances[i] - depth < least_before(0.375f, 0.10f)) {
        i++;
    }
    return distances[i];
}

/* Not where the disc just does not fit: the footprint is tried at headings 10 degrees apart. */
static bool is_clear_cut(float depth)
{
    bool is_clear = true;

    for (unsigned i = 0; i < 6U; i++) {
        const float off = distances[i] - depth - least_before(0.375f, 0.10f);

        is_clear = is_clear && (off < -0.06f || off > 0.006f);
    }
    return is_clear;
}

static void test_the_nearest_place_before_a_corridor_with_room_to_turn(void)
{
    unsigned judged = 0;

    make_corridor(6);
    for (unsigned i = 0; i < 70U; i++) {
        const float depth = 0.02f + 0.02f * (float)i;

        if (is_clear_cut(depth)) {
            struct jp_plane_pose approach;

            judged++;
            TEST_ASSERT_TRUE(choose(4.0f + depth, 4.375f, &approach));
            TEST_ASSERT_NEAR(1.0e-5f, 4.0f + depth - distance_from(depth), approach.x);
            TEST_ASSERT_NEAR(1.0e-5f, 4.375f, approach.y);
            TEST_ASSERT_NEAR(1.0e-5f, 0.0f, approach.heading);
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT(40, judged);
}

/* Beyond 2 m it does not look, nor where it has less than 3 cm. */
static void test_deep_in_a_corridor_there_is_no_approach(void)
{
    struct jp_plane_pose approach;

    make_corridor(6);
    TEST_ASSERT_TRUE(choose(4.0f + 2.0f - least_before(0.375f, 0.03f) - 0.01f, 4.375f, &approach));
    TEST_ASSERT_NEAR(1.0e-4f, 4.0f - least_before(0.375f, 0.03f) - 0.01f, approach.x);
    TEST_ASSERT_FALSE(choose(4.0f + 2.0f - least_before(0.375f, 0.03f) + 0.06f, 4.375f, &approach));
}

static void test_an_approach_turns_with_the_map(void)
{
    for (unsigned turns = 0; turns < 4U; turns++) {
        struct jp_plane_pose approach;
        struct jp_plane_pose expected;

        setUp();
        quarter = turns;
        make_corridor(6);
        TEST_ASSERT_TRUE(choose(4.5f, 4.375f, &approach));
        expected = turned(4.5f - 1.0f, 4.375f);
        TEST_ASSERT_NEAR(1.0e-5f, expected.x, approach.x);
        TEST_ASSERT_NEAR(1.0e-5f, expected.y, approach.y);
        TEST_ASSERT_NEAR(1.0e-5f, 0.0f, jp_plane_wrap(approach.heading - expected.heading));
    }
}

/* ---- The way in ---- */

/* It keeps 2 cm from the walls: in 0.625 m a robot of 0.6 m has less. */
static void test_the_way_in_keeps_off_its_walls(void)
{
    struct jp_plane_pose approach;

    make_corridor(5);
    TEST_ASSERT_FALSE(choose(4.5f, 4.3125f, &approach));
    setUp();
    make_corridor(6);
    TEST_ASSERT_TRUE(choose(4.5f, 4.375f, &approach));
    TEST_ASSERT_TRUE(choose(4.5f, 4.375f + 0.05f, &approach));
    TEST_ASSERT_FALSE(choose(4.5f, 4.375f + 0.06f, &approach));
    TEST_ASSERT_TRUE(choose(4.5f, 4.375f - 0.05f, &approach));
    TEST_ASSERT_FALSE(choose(4.5f, 4.375f - 0.06f, &approach));
}

/* Whatever stands on the way in, wherever on it. */
static void test_all_of_the_way_in_must_be_free(void)
{
    for (int x = 36; x < 42; x++) {
        struct jp_plane_pose approach;

        setUp();
        make_corridor(6);
        TEST_ASSERT_TRUE(choose(4.9f, 4.375f, &approach));
        occupy(x, 34);
        TEST_ASSERT_FALSE(choose(4.9f, 4.375f, &approach));
    }
}

/* ---- How much room ---- */

/* Between two walls from x = 3 m on: with a margin of 0.1 m a turn needs 0.64 m to each side, with 0.06 m 0.584 m, with
 * 0.03 m 0.542 m. */
static void test_it_turns_where_there_is_most_room(void)
{
    struct jp_plane_pose approach;

    for (int x = 24; x < SIDE; x++) {
        occupy(x, 20);
        occupy(x, 31);
    }
    TEST_ASSERT_TRUE(choose(4.5f, 3.25f, &approach));
    TEST_ASSERT_NEAR(1.0e-5f, 4.5f - 2.0f, approach.x);
    TEST_ASSERT_FALSE(choose(6.5f, 3.25f, &approach));
    TEST_ASSERT_FALSE(choose(6.5f, 3.25f - 0.075f, &approach));
    for (int x = 40; x < SIDE; x++) {
        occupy(x, 21);
        occupy(x, 30);
    }
    /* Where it goes in it has 0.06 m. */
    TEST_ASSERT_TRUE(choose(6.2f, 3.25f, &approach));
    TEST_ASSERT_NEAR(1.0e-5f, 6.2f - 1.6f, approach.x);
    TEST_ASSERT_TRUE(choose(6.2f, 3.25f + 0.075f, &approach));
    TEST_ASSERT_FALSE(choose(6.2f, 3.25f + 0.09f, &approach));
}
