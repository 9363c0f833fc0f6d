/* Discs and walls that a synthetic scanner sees: which of them are things. */
#include "tests/support/movers_rig.h"

void setUp(void)
{
    movers_rig_start();
}

void tearDown(void)
{
}

static void test_nothing_is_seen_on_an_empty_plane(void)
{
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

static void test_disc_is_a_thing_in_its_place(void)
{
    (void)put_disc(2.0f, 1.0f, RADIUS);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(PLACE_ERROR, 2.0f, movers.movers[0].centre.x);
    TEST_ASSERT_NEAR(PLACE_ERROR, 1.0f, movers.movers[0].centre.y);
    TEST_ASSERT_NEAR(0.03f, RADIUS, movers.movers[0].radius);
    TEST_ASSERT_EQUAL_UINT(1, movers.movers[0].sightings);
    TEST_ASSERT_EQUAL_UINT(0, movers.movers[0].misses);
}

/* A quarter of a turn from the sensor's right to its front; the disc lies across one end or the other. */
static void test_what_the_end_of_a_scan_cuts_is_seen_in_part(void)
{
    scan.first_angle = -0.5f * JP_PLANE_PI;
    scan.count = BEAMS / 4;

    struct disc *const disc = put_disc(0.0f, -2.0f, RADIUS);

    look();
    TEST_ASSERT_TRUE(ranges[0] > 0.0f);
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(movers.movers[0].radius < 0.7f * RADIUS);

    jp_movers_clear(&movers);
    disc->centre = (struct jp_plane_point){2.0f, 0.0f};
    look();
    TEST_ASSERT_TRUE(ranges[scan.count - 1U] > 0.0f);
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_TRUE(movers.movers[0].radius < 0.7f * RADIUS);
}

/* All of a scan of a sixth of a turn lies on the disc. */
static void test_what_is_cut_at_both_ends_is_not_a_thing(void)
{
    scan.first_angle = -JP_PLANE_PI / 12.0f;
    scan.count = BEAMS / 12;
    (void)put_disc(1.2f, 0.0f, 0.44f);
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

/* Beams that drop out beside a disc tell nothing: the next ones do. */
static void test_dropouts_beside_a_thing_are_skipped(void)
{
    (void)put_disc(14.0f, 0.0f, 8.0f); /* nearly a wall, too wide to be a thing */
    (void)put_disc(3.0f, 0.0f, RADIUS);
    take_scan();

    unsigned first = 0;

    while (!(ranges[first] > 0.0f && ranges[first] < 4.0f)) {
        first++;
    }
    ranges[first - 1U] = -1.0f;
    ranges[first - 2U] = -1.0f;
    update();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);

    /* Within it, beside its end. */
    jp_movers_clear(&movers);
    ranges[first + 1U] = -1.0f;
    ranges[first + 2U] = -1.0f;
    update();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);

    /* Dropouts to the end of the scan: on that side it may be hidden. */
    jp_movers_clear(&movers);
    for (unsigned i = 0; i < first; i++) {
        ranges[i] = -1.0f;
    }
    update();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
}

/* The front one hides the right or the left of the one behind it: the middle of the rest is not its own. */
static void test_what_is_half_hidden_is_a_thing_less_exactly(void)
{
    const float beside[] = {-0.25f, 0.25f};

    for (unsigned i = 0; i < 2U; i++) {
        setUp();
        (void)put_disc(4.0f, 0.0f, 0.4f);
        for (unsigned k = 0; k < SETTLED; k++) {
            look();
        }
        TEST_ASSERT_EQUAL_UINT(1, movers.count);
        TEST_ASSERT_NEAR(0.2f, 4.0f, movers.movers[0].centre.x);
        TEST_ASSERT_NEAR(0.02f, 0.0f, movers.movers[0].centre.y);

        (void)put_disc(2.0f, beside[i], RADIUS);
        look();
        TEST_ASSERT_EQUAL_UINT(2, movers.count);
        TEST_ASSERT_EQUAL_UINT(0, movers.movers[0].misses);
        TEST_ASSERT_TRUE(jp_plane_magnitude(movers.movers[0].centre.y) < 0.35f);
    }
}

static void test_thing_stands_in_front_of_what_is_behind_it(void)
{
    (void)put_disc(14.0f, 0.0f, 8.0f); /* nearly a wall, too wide to be a thing */
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
    (void)put_disc(3.0f, 0.0f, RADIUS);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    TEST_ASSERT_NEAR(PLACE_ERROR, 3.0f, movers.movers[0].centre.x);
}

static void test_width_of_a_thing_is_limited(void)
{
    (void)put_disc(3.0f, 0.0f, 0.44f);
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
    jp_movers_clear(&movers);
    config.extent = 0.6f;
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}

static void test_few_points_are_noise(void)
{
    (void)put_disc(4.0f, 0.0f, 0.05f);
    scan_config.beams_min = 4;
    look();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
    scan_config.beams_min = 2;
    look();
    TEST_ASSERT_EQUAL_UINT(1, movers.count);
}

/* It does not tell how its surface goes on. */
static void test_a_single_point_is_no_thing(void)
{
    (void)put_disc(4.0f, 0.0f, 0.05f);
    scan_config.beams_min = 1;
    take_scan();
    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = i == BEAMS / 2 ? 4.0f : 0.0f;
    }
    update();
    TEST_ASSERT_EQUAL_UINT(0, movers.count);
}
