/* Objects that stand free, by where their walls are: of flat things that a scanner looks at from any side and place. */
#include "src/local/movers_things.h"

#include "tests/support/movers_rig.h"

static struct jp_scan_view view;
static struct jp_mover_thing thing;
static struct jp_plane_pose frame; /* of all walls and the sensor */

void setUp(void)
{
    movers_rig_start();
    frame = origin;
}

void tearDown(void)
{
}

/* ---- Things in a frame ---- */

static struct jp_plane_point placed(float x, float y)
{
    const struct jp_plane_pose there = {x, y, 0.0f};
    const struct jp_plane_pose pose = jp_plane_compose(&frame, &there);

    return (struct jp_plane_point){pose.x, pose.y};
}

static void put(float x1, float y1, float x2, float y2)
{
    const struct jp_plane_point a = placed(x1, y1);
    const struct jp_plane_point b = placed(x2, y2);

    put_wall(a.x, a.y, b.x, b.y);
}

/* Of the scanner at the frame's origin. */
static void open_scan(void)
{
    sensor = frame;
    sensor.heading = jp_plane_wrap(frame.heading + 0.3f);
    take_scan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
}

/* The run that has a point nearest to a place. */
static struct jp_scan_run run_at(float x, float y)
{
    const struct jp_plane_point place = placed(x, y);
    const unsigned beam = jp_scan_beam_towards(&view, place);
    struct jp_scan_run run = {0, 0, 0};
    unsigned from = 0;

    while (jp_scan_next_run(&view, from, &run) && run.last < beam) {
        from = run.last + 1U;
    }
    return run;
}

static bool find(float x, float y, float extent)
{
    const struct jp_scan_run run = run_at(x, y);

    return jp_mover_find_thing(&view, &run, extent, &thing);
}

static void expect_point(float x, float y, struct jp_plane_point point)
{
    const struct jp_plane_point place = placed(x, y);

    TEST_ASSERT_NEAR(0.02f, place.x, point.x);
    TEST_ASSERT_NEAR(0.02f, place.y, point.y);
}

/* Nothing, and walls, behind it; turned and moved. */
static void in_all_frames(void (*check)(void))
{
    for (unsigned i = 0; i < 6U; i++) {
        movers_rig_start();
        frame = (struct jp_plane_pose){0.7f * (float)i, -0.4f * (float)i, jp_plane_wrap(1.1f * (float)i)};
        if (i % 2U == 1U) {
            put(6.0f, -4.0f, 6.0f, 4.0f);
        }
        check();
    }
}

/* ---- What is seen of it ---- */

static void check_board(void)
{
    put(2.0f, -0.25f, 2.0f, 0.15f);
    open_scan();
    TEST_ASSERT_TRUE(find(2.0f, -0.05f, 0.9f));
    TEST_ASSERT_TRUE(jp_mover_thing_is_whole(&thing));
    TEST_ASSERT_FALSE(thing.has_come);
    expect_point(2.0f, -0.05f, thing.centre);
    TEST_ASSERT_NEAR(0.02f, 0.2f, thing.radius);

    const struct jp_plane_point along = jp_plane_direction(frame.heading + 0.5f * JP_PLANE_PI);

    TEST_ASSERT_NEAR(0.01f, along.x, thing.across.x);
    TEST_ASSERT_NEAR(0.01f, along.y, thing.across.y);
    TEST_ASSERT_NEAR(1.0e-5f, 1.0f, jp_plane_length(thing.across.x, thing.across.y));
    expect_point(2.0f, -0.15f, thing.seen[0]);
    expect_point(2.0f, -0.05f, thing.seen[1]);
    expect_point(2.0f, 0.05f, thing.seen[2]);
}

static void test_a_board_is_as_wide_as_it_is_and_its_points_are_even(void)
{
    in_all_frames(check_board);
}

/* Something nearer hides one rim, or both. */
static void check_hidden(void)
{
    put(2.0f, -0.3f, 2.0f, 0.3f);
    put(1.0f, -0.6f, 1.0f, -0.1f);
    open_scan();
    TEST_ASSERT_TRUE(find(2.0f, 0.05f, 0.9f));
    TEST_ASSERT_FALSE(thing.is_free[0]);
    TEST_ASSERT_TRUE(thing.is_free[1]);
    expect_point(2.0f, 0.05f, thing.centre);
    put(1.0f, 0.1f, 1.0f, 0.6f);
    open_scan();
    TEST_ASSERT_FALSE(find(2.0f, 0.0f, 0.9f));
}

static void test_a_rim_that_is_hidden_is_not_free(void)
{
    in_all_frames(check_hidden);
}

static void check_hidden_left(void)
{
    put(2.0f, -0.3f, 2.0f, 0.3f);
    put(1.0f, 0.6f, 1.0f, 0.1f);
    open_scan();
    TEST_ASSERT_TRUE(find(2.0f, -0.05f, 0.9f));
    TEST_ASSERT_TRUE(thing.is_free[0]);
    TEST_ASSERT_FALSE(thing.is_free[1]);
    TEST_ASSERT_FALSE(jp_mover_thing_is_whole(&thing));
    expect_point(2.0f, -0.05f, thing.centre);
}

static void test_either_rim_may_be_the_free_one(void)
{
    in_all_frames(check_hidden_left);
}

/* A wall along which the scanner looks goes on where its points lie far apart: it ends where beams see what is clearly
 * behind it. */
static void check_along(void)
{
    const unsigned before = wall_count;

    for (int side = 0; side < 2; side++) {
        const float y = side == 0 ? -0.2f : 0.2f;

        wall_count = before;
        put(1.0f, y, 9.0f, y);
        open_scan();

        const struct jp_scan_run run = run_at(2.0f, y);

        TEST_ASSERT_TRUE(run.last - run.first + 1U == run.points && run.points > 10U);
        (void)jp_mover_find_thing(&view, &run, 10.0f, &thing);
        TEST_ASSERT_FALSE(thing.is_free[side == 0 ? 1 : 0]);
        TEST_ASSERT_TRUE(thing.is_free[side == 0 ? 0 : 1]);
        /* One that ends at 2 m has a rim. */
        wall_count = before;
        put(1.0f, y, 2.0f, y);
        open_scan();
        TEST_ASSERT_TRUE(find(1.6f, y, 10.0f));
        TEST_ASSERT_TRUE(jp_mover_thing_is_whole(&thing));
    }
}

static void test_a_wall_that_is_looked_along_goes_on(void)
{
    in_all_frames(check_along);
}

/* What is behind it by less than pose and laser err may be it. */
static void test_what_is_just_behind_a_rim_may_be_the_same(void)
{
    for (int i = 0; i < 2; i++) {
        movers_rig_start();
        scan_config.gap = 0.05f;
        put(2.0f, -0.2f, 2.0f, 0.2f);
        put(i == 0 ? 2.1f : 2.3f, -3.0f, i == 0 ? 2.1f : 2.3f, 3.0f);
        open_scan();
        TEST_ASSERT_EQUAL_INT(i == 1, find(2.0f, 0.0f, 0.9f));
    }
}

/* ---- What is none ---- */

static void test_what_is_too_large_or_of_too_few_beams_is_none(void)
{
    unsigned points;

    put(2.0f, -0.25f, 2.0f, 0.15f);
    open_scan();
    TEST_ASSERT_TRUE(find(2.0f, -0.05f, 0.41f));
    TEST_ASSERT_FALSE(find(2.0f, -0.05f, 0.37f));
    points = run_at(2.0f, -0.05f).points;
    scan_config.beams_min = (uint16_t)points;
    TEST_ASSERT_TRUE(find(2.0f, -0.05f, 0.9f));
    scan_config.beams_min = (uint16_t)(points + 1U);
    TEST_ASSERT_FALSE(find(2.0f, -0.05f, 0.9f));
}

/* Of two points the direction is known, of one it is not. */
static void test_two_points_are_the_least(void)
{
    scan_config.beams_min = 1;
    for (unsigned count = 1; count <= 2U; count++) {
        for (unsigned i = 0; i < BEAMS; i++) {
            ranges[i] = i >= 400U && i < 400U + count ? 2.0f : 0.0f;
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));

        const struct jp_scan_run run = {400U, 399U + count, count};

        TEST_ASSERT_EQUAL_INT(count == 2U, jp_mover_find_thing(&view, &run, 0.9f, &thing));
    }
}

/* ---- Places ---- */

/* Empty where both beams beside it end clearly behind it. */
static void check_places(void)
{
    put(4.0f, -3.0f, 4.0f, 3.0f);
    open_scan();
    for (int i = -3; i <= 3; i++) {
        const float y = 0.5f * (float)i;
        const float length = jp_plane_length(4.0f, y);

        for (int k = 0; k < 2; k++) {
            const float share = (length - (k == 0 ? 0.2f : 0.1f)) / length;

            TEST_ASSERT_EQUAL_INT(k == 0, jp_mover_is_empty(&view, placed(4.0f * share, y * share)));
        }
        TEST_ASSERT_FALSE(jp_mover_is_empty(&view, placed(4.5f, y)));
    }
}

static void test_a_place_before_a_wall_is_empty(void)
{
    in_all_frames(check_places);
}

/* Either beam beside it may be stopped. */
static void test_a_place_beside_which_a_beam_is_stopped_is_not_empty(void)
{
    for (unsigned stopped = 398; stopped < 404U; stopped++) {
        for (unsigned i = 0; i < BEAMS; i++) {
            ranges[i] = i == stopped ? 1.0f : 5.0f;
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));

        const struct jp_plane_point along = jp_plane_direction(scan.first_angle + 400.5f * scan.angle_step);
        const struct jp_plane_point place = {3.0f * along.x, 3.0f * along.y};

        TEST_ASSERT_EQUAL_INT(stopped != 400U && stopped != 401U, jp_mover_is_empty(&view, place));
    }
}

/* Beside the last beam there is none. */
static void test_beyond_the_scan_nothing_is_known_to_be_empty(void)
{
    scan.count = 100;
    for (unsigned i = 0; i < BEAMS; i++) {
        ranges[i] = 5.0f;
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_scan_open(&view, &scan_config, &scan, &sensor));
    for (unsigned beam = 96; beam < 103U; beam++) {
        const struct jp_plane_point along =
            jp_plane_direction(scan.first_angle + ((float)beam + 0.5f) * scan.angle_step);
        const struct jp_plane_point place = {3.0f * along.x, 3.0f * along.y};

        TEST_ASSERT_EQUAL_INT(beam + 1U < 100U, jp_mover_is_empty(&view, place));
    }
}
