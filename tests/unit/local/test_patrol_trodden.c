/* Where people have walked: what is noted, for how long, and what it occupies on a map. */
#include "src/local/patrol_trodden.h"

#include "tests/support/patrol_rig.h"

enum { SIDE = 80 };

#define CELL   0.1f
#define RADIUS 0.3f

static struct jp_terrain given;
static struct jp_terrain marked;
static uint64_t given_block[2 * SIDE * SIDE / 64 + 2 * SIDE];
static uint64_t marked_block[2 * SIDE * SIDE / 64 + 2 * SIDE];
static const struct jp_plane_pose far_goal = {7.5f, 7.5f, 0.0f};

static void make(struct jp_terrain *map, uint64_t *block, size_t size)
{
    const struct jp_terrain_config terrain = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.1), .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(map, &terrain, block, size, &field));
    for (int32_t y = 0; y < SIDE; y++) {
        for (int32_t x = 0; x < SIDE; x++) {
            (void)jp_terrain_set_cell(map, x, y, JP_CELL_FREE);
        }
    }
}

void setUp(void)
{
    rig_reset();
    make(&given, given_block, sizeof given_block);
    make(&marked, marked_block, sizeof marked_block);
    patrol.pose = (struct jp_plane_pose){0.5f, 0.5f, 0.0f};
}

void tearDown(void)
{
}

static struct jp_mover *put_walker(float x, float y)
{
    struct jp_mover *const mover = &patrol.movers.movers[patrol.movers.count];

    *mover = (struct jp_mover){.centre = {x, y}, .radius = RADIUS, .pace = 1.0f};
    patrol.movers.count++;
    return mover;
}

static unsigned noted(void)
{
    unsigned count = 0;

    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        count += patrol.internal.trodden[i].radius > 0.0f ? 1U : 0U;
    }
    return count;
}

static float widest(void)
{
    float radius = 0.0f;

    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        radius = jp_plane_larger(patrol.internal.trodden[i].radius, radius);
    }
    return radius;
}

static void walk(float x, float y, float dx, float dy, unsigned steps)
{
    struct jp_mover *const mover = put_walker(x, y);

    for (unsigned i = 0; i < steps; i++) {
        jp_patrol_note_steps(&patrol);
        mover->centre.x += dx;
        mover->centre.y += dy;
    }
    patrol.movers.count = 0;
}

static enum jp_cell cell_at(float x, float y)
{
    return jp_terrain_cell(&marked, (int32_t)(x / CELL), (int32_t)(y / CELL));
}

static unsigned occupied(void)
{
    unsigned count = 0;

    for (int32_t y = 0; y < SIDE; y++) {
        for (int32_t x = 0; x < SIDE; x++) {
            count += jp_terrain_cell(&marked, x, y) == JP_CELL_OCCUPIED ? 1U : 0U;
        }
    }
    return count;
}

/* ---- What is noted ---- */

static void test_who_walks_is_noted_once_a_step(void)
{
    walk(2.0f, 4.0f, 0.1f, 0.0f, 30);
    TEST_ASSERT_TRUE(noted() >= 8U && noted() <= 12U);
}

static void test_the_way_back_is_not_noted_again(void)
{
    unsigned there;

    walk(2.0f, 4.0f, 0.1f, 0.0f, 30);
    there = noted();
    walk(5.0f, 4.0f, -0.1f, 0.0f, 30);
    TEST_ASSERT_TRUE(noted() <= there + 1U);
}

static void test_who_stands_never_walked_or_is_hidden_is_not_noted(void)
{
    put_walker(1.0f, 4.0f)->standing = 1.0f;
    put_walker(2.0f, 4.0f)->pace = 0.0f;
    put_walker(3.0f, 4.0f)->misses = 1;
    jp_patrol_note_steps(&patrol);
    TEST_ASSERT_EQUAL_UINT(0, noted());
}

static void test_the_widest_who_came_by_counts(void)
{
    put_walker(4.0f, 4.0f)->radius = 0.1f;
    jp_patrol_note_steps(&patrol);
    TEST_ASSERT_NEAR(1.0e-5f, 0.25f, widest());
    patrol.movers.movers[0].radius = 0.6f;
    jp_patrol_note_steps(&patrol);
    patrol.movers.movers[0].radius = 0.3f;
    jp_patrol_note_steps(&patrol);
    TEST_ASSERT_EQUAL_UINT(1, noted());
    TEST_ASSERT_NEAR(1.0e-5f, 0.6f, widest());
}

/* The oldest note gives way. */
static void test_more_places_than_are_remembered(void)
{
    for (unsigned i = 0; i <= JP_PATROL_TRODDEN_MAX; i++) {
        walk(100.0f + (float)i, 0.0f, 0.0f, 0.0f, 1);
    }
    TEST_ASSERT_EQUAL_UINT(JP_PATROL_TRODDEN_MAX, noted());
    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        TEST_ASSERT_TRUE(patrol.internal.trodden[i].place.x > 100.5f);
    }
}

/* ---- On a map ---- */

static void test_where_somebody_walked_is_occupied(void)
{
    walk(3.0f, 4.0f, 0.1f, 0.0f, 20);
    jp_patrol_occupy_trodden(&patrol, &far_goal, 0.0f, &marked);
    for (unsigned i = 0; i < 18U; i++) {
        TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(3.05f + 0.1f * (float)i, 4.05f));
    }
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(4.0f, 4.55f));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(2.35f, 4.05f));
}

static void test_a_clearance_around_it_too(void)
{
    walk(4.0f, 4.0f, 0.0f, 0.0f, 1);
    jp_patrol_occupy_trodden(&patrol, &far_goal, 0.5f, &marked);
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(4.65f, 4.05f));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(4.95f, 4.05f));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(4.75f, 4.75f));
}

static void test_around_the_robot_and_the_goal_it_is_free(void)
{
    patrol.pose = (struct jp_plane_pose){2.0f, 4.0f, 0.0f};
    walk(1.0f, 4.0f, 0.1f, 0.0f, 60);
    jp_patrol_occupy_trodden(&patrol, &(struct jp_plane_pose){6.0f, 4.0f, 0.0f}, 0.0f, &marked);
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(2.0f, 4.05f));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(2.95f, 4.05f));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, cell_at(4.0f, 4.05f));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, cell_at(5.05f, 4.05f));
}

static void test_what_is_long_ago_is_forgotten(void)
{
    walk(4.0f, 4.0f, 0.0f, 0.0f, 1);
    for (unsigned i = 0; i < 395U; i++) {
        jp_patrol_note_steps(&patrol);
    }
    jp_patrol_occupy_trodden(&patrol, &far_goal, 0.0f, &marked);
    TEST_ASSERT_TRUE(occupied() > 0U);
    jp_patrol_clear_trodden(&patrol, &given, 0.0f, &marked);
    for (unsigned i = 0; i < 10U; i++) {
        jp_patrol_note_steps(&patrol);
    }
    jp_patrol_occupy_trodden(&patrol, &far_goal, 0.0f, &marked);
    TEST_ASSERT_EQUAL_UINT(0, occupied());
    walk(5.0f, 5.0f, 0.0f, 0.0f, 1);
    TEST_ASSERT_EQUAL_UINT(1, noted());
}

/* Also where the robot has come to stand meanwhile. */
static void test_cleared_it_is_as_given(void)
{
    (void)jp_terrain_set_cell(&given, 40, 40, JP_CELL_OCCUPIED);
    walk(3.0f, 4.0f, 0.1f, 0.0f, 20);
    jp_patrol_occupy_trodden(&patrol, &far_goal, 0.3f, &marked);
    patrol.pose = (struct jp_plane_pose){4.0f, 4.0f, 0.0f};
    jp_patrol_clear_trodden(&patrol, &given, 0.3f, &marked);
    TEST_ASSERT_EQUAL_UINT(1, occupied());
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&marked, 40, 40));
}

static void test_beyond_the_map_nothing_happens(void)
{
    walk(-3.0f, 9.0f, 0.0f, 0.0f, 1);
    walk(0.0f, 8.0f, 0.0f, 0.0f, 1);
    jp_patrol_occupy_trodden(&patrol, &far_goal, 0.0f, &marked);
    TEST_ASSERT_TRUE(occupied() > 0U && occupied() < 12U);
}

/* ---- Each cell, each note ---- */

/* By how far the middle of a cell is from a place. */
static bool is_within(int32_t x, int32_t y, float at_x, float at_y, float radius)
{
    const float cell = (float)JP_Q16(0.1) / (float)JP_Q16_ONE;

    return jp_plane_length(((float)x + 0.5f) * cell - at_x, ((float)y + 0.5f) * cell - at_y) <= radius;
}

/* Places at the map's rims too; what is around the robot and the goal stays free. */
static void test_each_cell_near_where_somebody_walked_is_occupied(void)
{
    static const struct jp_plane_point places[] = {{3.02f, 4.07f}, {0.11f, 5.96f}, {7.93f, 3.03f}, {4.51f, 0.04f},
                                                   {5.55f, 7.98f}, {1.27f, 1.31f}, {6.49f, 6.52f}};
    const float kept = 0.7f + jp_plane_length(jp_plane_larger(config.teb.footprint.front, config.teb.footprint.rear),
                                              config.teb.footprint.half_width);

    for (unsigned i = 0; i < sizeof places / sizeof places[0]; i++) {
        const float radius = RADIUS + 0.153f;

        setUp();
        (void)put_walker(places[i].x, places[i].y);
        jp_patrol_note_steps(&patrol);
        jp_patrol_occupy_trodden(&patrol, &far_goal, 0.153f, &marked);
        for (int32_t k = 0; k < SIDE * SIDE; k++) {
            const int32_t x = k % SIDE;
            const int32_t y = k / SIDE;
            const bool is_occupied = is_within(x, y, places[i].x, places[i].y, radius) &&
                                     !is_within(x, y, 0.5f, 0.5f, kept) && !is_within(x, y, 7.5f, 7.5f, kept);

            TEST_ASSERT_EQUAL_INT(is_occupied, jp_terrain_cell(&marked, x, y) == JP_CELL_OCCUPIED);
        }
        /* All of it goes again, and what the given map has there comes back. */
        (void)jp_terrain_set_cell(&given, (int32_t)(places[i].x / CELL), (int32_t)(places[i].y / CELL),
                                  JP_CELL_UNKNOWN);
        jp_patrol_clear_trodden(&patrol, &given, 0.153f, &marked);
        for (int32_t k = 0; k < SIDE * SIDE; k++) {
            TEST_ASSERT_EQUAL_INT(jp_terrain_cell(&given, k % SIDE, k / SIDE),
                                  jp_terrain_cell(&marked, k % SIDE, k / SIDE));
        }
    }
}

static const struct jp_patrol_trodden *note_at(float x, float y)
{
    for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
        const struct jp_patrol_trodden *const place = &patrol.internal.trodden[i];

        if (place->radius > 0.0f && jp_plane_length(place->place.x - x, place->place.y - y) < 1.0e-3f) {
            return place;
        }
    }
    return NULL;
}

/* Within 0.3 m it is the same place, which keeps the larger radius and is new again. */
static void test_near_a_note_it_is_renewed(void)
{
    struct jp_mover *const mover = put_walker(3.0f, 3.0f);

    jp_patrol_note_steps(&patrol);
    patrol.movers.count = 0;
    jp_patrol_note_steps(&patrol);
    TEST_ASSERT_NEAR(1.0e-5f, RIG_PERIOD, note_at(3.0f, 3.0f)->age);
    patrol.movers.count = 1;
    mover->centre = (struct jp_plane_point){3.2f, 3.21f};
    mover->radius = 0.1f;
    jp_patrol_note_steps(&patrol);
    TEST_ASSERT_EQUAL_UINT(1, noted());
    TEST_ASSERT_NEAR(1.0e-5f, 0.0f, note_at(3.0f, 3.0f)->age);
    TEST_ASSERT_NEAR(1.0e-5f, RADIUS, note_at(3.0f, 3.0f)->radius);
    mover->centre = (struct jp_plane_point){3.22f, 3.22f};
    jp_patrol_note_steps(&patrol);
    TEST_ASSERT_EQUAL_UINT(2, noted());
    TEST_ASSERT_NEAR(1.0e-5f, 0.25f, note_at(3.22f, 3.22f)->radius);
}

/* Who stands, is not seen or never walked is not noted. */
static void test_who_does_not_walk_now_is_not_noted(void)
{
    for (int i = 0; i < 4; i++) {
        struct jp_mover *mover;

        setUp();
        mover = put_walker(3.0f, 3.0f);
        mover->standing = i == 0 ? 0.16f : 0.14f;
        mover->misses = (uint8_t)(i == 1);
        mover->pace = i == 2 ? 0.0f : 1.0f;
        jp_patrol_note_steps(&patrol);
        TEST_ASSERT_EQUAL_UINT(i == 3 ? 1U : 0U, noted());
    }
}

/* Where there is no place left the oldest goes, be it the first, the last or in between. */
static void test_the_oldest_note_goes(void)
{
    for (unsigned oldest = 0; oldest < JP_PATROL_TRODDEN_MAX; oldest++) {
        setUp();
        for (unsigned i = 0; i < JP_PATROL_TRODDEN_MAX; i++) {
            patrol.internal.trodden[i].place = (struct jp_plane_point){1.0f + (float)i, 2.0f};
            patrol.internal.trodden[i].radius = 0.3f;
            patrol.internal.trodden[i].age = i == oldest ? 30.0f : 10.0f + 0.1f * (float)(i % 7U);
        }
        (void)put_walker(3.0f, 6.0f);
        jp_patrol_note_steps(&patrol);
        TEST_ASSERT_NULL(note_at(1.0f + (float)oldest, 2.0f));
        TEST_ASSERT_NOT_NULL(note_at(3.0f, 6.0f));
        TEST_ASSERT_EQUAL_UINT(JP_PATROL_TRODDEN_MAX, noted());
    }
}

/* After 40 s a note is none: it occupies nothing, and its place is free for another one. */
static void test_notes_are_remembered_for_forty_seconds(void)
{
    for (int i = 0; i < 2; i++) {
        setUp();
        (void)put_walker(3.0f, 4.0f);
        jp_patrol_note_steps(&patrol);
        patrol.movers.count = 0;
        for (unsigned k = 0; k < JP_PATROL_TRODDEN_MAX; k++) {
            patrol.internal.trodden[k].age = i == 0 ? 39.75f : 39.95f;
        }
        jp_patrol_note_steps(&patrol);
        jp_patrol_occupy_trodden(&patrol, &far_goal, 0.1f, &marked);
        TEST_ASSERT_EQUAL_INT(i == 0, jp_terrain_cell(&marked, 30, 40) == JP_CELL_OCCUPIED);
        /* What it occupied before is cleared all the same. */
        (void)jp_terrain_set_cell(&marked, 30, 40, JP_CELL_OCCUPIED);
        jp_patrol_clear_trodden(&patrol, &given, 0.1f, &marked);
        TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, jp_terrain_cell(&marked, 30, 40));
        (void)put_walker(3.1f, 4.0f);
        jp_patrol_note_steps(&patrol);
        TEST_ASSERT_EQUAL_INT(i == 1, note_at(3.1f, 4.0f) != NULL);
    }
}
