/* Where nothing was a while ago, by what a synthetic scanner saw, and who is known to walk by it. */
#include <math.h>

#include "src/local/movers_past.h"

#include "tests/support/movers_rig.h"

static struct jp_scan_view view;
static struct jp_mover_thing thing;

void setUp(void)
{
    movers_rig_start();
    memset(&thing, 0, sizeof thing);
}

void tearDown(void)
{
}

static void keep(float period)
{
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
    jp_movers_keep_scan(&movers, &view, period);
}

/* A scan of now, and one of a second later. */
static void keep_two(void)
{
    keep(PERIOD);
    keep(1.0f);
}

/* What is seen of it from the west, half a metre from end to end. */
static void put_thing(float x, float y)
{
    for (unsigned i = 0; i < JP_MOVER_POINTS; i++) {
        thing.seen[i] = (struct jp_plane_point){x, y + 0.25f * ((float)i - 1.0f)};
    }
}

static bool has_come(float x, float y)
{
    put_thing(x, y);
    return jp_movers_has_come(&movers, &scan_config, &thing);
}

/* ---- Where nothing was ---- */

static void test_nothing_is_known_at_first(void)
{
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
    keep(PERIOD);
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
}

static void test_what_is_in_the_open_has_come(void)
{
    keep_two();
    TEST_ASSERT_TRUE(has_come(2.0f, 0.0f));
    TEST_ASSERT_TRUE(has_come(9.5f, 0.0f));
    TEST_ASSERT_FALSE(has_come(9.9f, 0.0f)); /* at the end of the range */
}

static void test_what_was_there_has_not_come(void)
{
    (void)put_disc(2.0f, 0.0f, RADIUS);
    keep_two();
    TEST_ASSERT_FALSE(has_come(1.75f, 0.0f));
    TEST_ASSERT_FALSE(has_come(4.0f, 0.0f)); /* behind it */
    TEST_ASSERT_TRUE(has_come(1.0f, 0.0f));
    TEST_ASSERT_TRUE(has_come(2.0f, 1.0f));
}

/* All of it has to be where nothing was: from each end on. */
static void test_what_was_there_in_part_has_not_come(void)
{
    (void)put_disc(2.0f, 0.0f, RADIUS);
    keep_two();
    TEST_ASSERT_FALSE(has_come(2.0f, 0.45f));
    TEST_ASSERT_FALSE(has_come(2.0f, -0.45f));
    TEST_ASSERT_TRUE(has_come(2.0f, 0.65f));
    TEST_ASSERT_TRUE(has_come(2.0f, -0.65f));
}

static void test_beams_that_did_not_work_tell_nothing(void)
{
    const float broken[] = {-1.0f, INFINITY};

    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        take_scan();
        ranges[BEAMS / 2] = broken[i];
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
        jp_movers_keep_scan(&movers, &view, PERIOD);
        keep(1.0f);
        TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
        TEST_ASSERT_TRUE(has_come(2.0f, 1.0f));
    }
}

/* Where fewer directions are remembered than there are beams, the nearest of their ranges is. */
static void test_a_thing_of_few_beams_is_remembered(void)
{
    (void)put_disc(2.0f, 0.0f, 0.02f);
    keep_two();
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_PAST_BEAMS, movers.past[0].count);

    setUp();
    scan.count = BEAMS - 1;
    (void)put_disc(2.0f, 0.0f, 0.02f);
    keep_two();
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_PAST_BEAMS, movers.past[0].count);

    setUp();
    scan.count = JP_MOVERS_PAST_BEAMS / 2U;
    scan.angle_step = 4.0f * JP_PLANE_PI / (float)JP_MOVERS_PAST_BEAMS;
    keep_two();
    TEST_ASSERT_TRUE(has_come(2.0f, 0.0f));
    TEST_ASSERT_EQUAL_UINT(JP_MOVERS_PAST_BEAMS / 2U, movers.past[0].count);
}

/* From another place and heading the same place is meant. */
static void test_places_are_those_of_the_fixed_frame(void)
{
    (void)put_disc(2.0f, 0.0f, RADIUS);
    sensor = (struct jp_plane_pose){1.0f, -2.0f, 1.0f};
    keep_two();
    sensor = (struct jp_plane_pose){0.0f, 0.0f, 0.0f};
    TEST_ASSERT_FALSE(has_come(1.9f, 0.0f));
    TEST_ASSERT_FALSE(has_come(2.6f, 1.2f)); /* behind it, from there */
    TEST_ASSERT_TRUE(has_come(3.5f, 0.0f));
}

/* A scan is one to two seconds old when it is asked. */
static void test_a_scan_is_kept_every_second(void)
{
    struct disc *const disc = put_disc(2.0f, 0.0f, RADIUS);

    keep(PERIOD);
    disc->centre.y = 3.0f;
    for (unsigned i = 0; i < 9U; i++) {
        keep(PERIOD);
        TEST_ASSERT_EQUAL_UINT(0, movers.past[1].count);
    }
    keep(1.5f * PERIOD);
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
    for (unsigned i = 0; i < 9U; i++) {
        keep(PERIOD);
        TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
    }
    keep(1.5f * PERIOD);
    TEST_ASSERT_TRUE(has_come(2.0f, 0.0f));
    TEST_ASSERT_FALSE(has_come(2.0f, 3.0f));
}

static void test_a_scan_is_forgotten_with_the_tracks(void)
{
    keep_two();
    jp_movers_clear(&movers);
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
    keep(PERIOD);
    TEST_ASSERT_FALSE(has_come(2.0f, 0.0f));
}

/* ---- Who walks by it ---- */

static bool is_anybody_known(void)
{
    bool is_known = false;

    for (unsigned i = 0; i < movers.count; i++) {
        is_known = is_known || has_walked(i);
    }
    return is_known;
}

/* Three abreast are as wide as a shelf, and a wall hides one side of them all the while. */
static void test_a_group_that_is_half_hidden_is_known_to_walk(void)
{
    struct disc *const group[] = {put_disc(6.0f, -0.1f, 0.2f), put_disc(6.1f, 0.4f, 0.2f), put_disc(6.0f, 0.9f, 0.2f)};

    see_coarsely();
    put_wall(1.5f, -3.0f, 1.5f, 0.0f);
    for (unsigned i = 0; i < 30U; i++) {
        look();
        for (unsigned k = 0; k < 3U; k++) {
            group[k]->centre.x -= PERIOD * 0.8f;
        }
    }
    TEST_ASSERT_TRUE(is_anybody_known());
}

/* What is there from the first scan on may have been there before; what is seen later where nothing was has come. */
static void test_a_track_knows_whether_it_has_come(void)
{
    (void)put_disc(3.0f, 0.0f, RADIUS);
    for (unsigned i = 0; i < 25U; i++) {
        look();
    }
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_FALSE(movers.movers[0].has_come);
    (void)put_disc(0.0f, 3.0f, RADIUS);
    look();
    TEST_ASSERT_EQUAL_UINT(2, movers.count);
    TEST_ASSERT_TRUE(movers.movers[1].has_come);
}

/* Past a shelf that stands other parts of it are seen, but none where nothing was. */
static void test_a_shelf_that_is_passed_is_not(void)
{
    see_coarsely();
    put_box(3.0f, 1.0f, 3.4f, 2.2f);
    for (unsigned i = 0; i < 60U; i++) {
        look();
        sensor.x += PERIOD * 0.8f;
        TEST_ASSERT_FALSE(is_anybody_known());
    }
}
