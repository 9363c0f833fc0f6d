/* Searches of a part of a map, from many places: what they find, and how much work they say that they did. */
#include "src/local/localiser_search.h"

#include "src/local/localiser_match.h"
#include "tests/support/localiser_rig.h"

enum { POINTS = 100 };

static struct jp_localiser_search search;
static struct jp_plane_point points[RIG_BEAMS];
static struct jp_localiser_cloud cloud = {.points = points};

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static void scan_from(float x, float y, float heading)
{
    static const struct jp_plane_pose none = {0.0f, 0.0f, 0.0f};

    robot = (struct jp_plane_pose){x, y, heading};
    rig_scan();
    jp_localiser_collect(&cloud, RIG_BEAMS, &input.scan, &none, RIG_RANGE);
}

static void begin(float dx, float dy, float turn, float distance, float sector)
{
    const struct jp_localiser_region region = {
        .centre = {robot.x + dx, robot.y + dy, jp_plane_wrap(robot.heading + turn)},
        .distance = distance,
        .turn = sector};

    jp_localiser_search_begin(&search, &cloud, &region);
}

static unsigned work(unsigned nodes)
{
    return jp_localiser_search_work(&search, &localiser.internal.field, &map, 0.035f, nodes);
}

static unsigned work_all(void)
{
    unsigned sum = 0;

    while (search.is_running) {
        sum += work(400);
    }
    return sum;
}

/* ---- Its beginning ---- */

static void test_it_takes_points_evenly(void)
{
    for (int count = 5; count < RIG_BEAMS; count += 19) {
        const int taken = count < JP_LOCALISER_SEARCH_POINTS ? count : JP_LOCALISER_SEARCH_POINTS;

        for (int i = 0; i < count; i++) {
            points[i] = (struct jp_plane_point){3.0f * (float)i, 4.0f * (float)i};
        }
        cloud.count = count;
        cloud.sensor = (struct jp_plane_point){0.3f, 0.1f};
        begin(0.0f, 0.0f, 0.0f, 1.0f, 1.0f);
        TEST_ASSERT_TRUE(search.is_running);
        TEST_ASSERT_EQUAL_INT32(taken, search.cloud.count);
        TEST_ASSERT_EQUAL_INT32(1, search.cloud.stride);
        TEST_ASSERT_NEAR(1.0e-6f, 0.3f, search.cloud.sensor.x);
        for (int i = 0; i < taken; i++) {
            TEST_ASSERT_NEAR(1.0e-3f, 5.0f * (float)(i * count / taken), search.ranges[i]);
            TEST_ASSERT_NEAR(1.0e-3f, 4.0f * (float)(i * count / taken), search.cloud.points[i].y);
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_NO_PLACE, jp_localiser_search_finding(&search));
}

/* ---- What it finds ---- */

static void expect_found(void)
{
    const struct jp_localiser_place *const place = &search.places[0];

    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_ONE_PLACE, jp_localiser_search_finding(&search));
    TEST_ASSERT_NEAR(0.06f, robot.x, place->pose.x);
    TEST_ASSERT_NEAR(0.06f, robot.y, place->pose.y);
    TEST_ASSERT_NEAR(0.03f, 0.0f, jp_plane_wrap(robot.heading - place->pose.heading));
    TEST_ASSERT_TRUE(place->score > 0.8f && place->score <= 1.0f);
}

/* All about the room, in all directions, the robot is found where it is in the region, at its rim too. */
static void test_it_finds_where_the_robot_is(void)
{
    static const struct jp_plane_pose poses[] = {{0.8f, 0.9f, 0.1f}, {6.0f, 5.1f, -2.9f}, {1.0f, 5.0f, -1.4f}};

    for (unsigned i = 0; i < sizeof poses / sizeof poses[0]; i++) {
        const float side = i % 2U == 0U ? 0.5f : -0.5f;

        scan_from(poses[i].x, poses[i].y, poses[i].heading);
        begin(side, -side, 0.6f * side, 0.55f, 0.35f);
        (void)work_all();
        expect_found();
    }
}

/* Where no cell is free there is no place. */
static void test_no_place_is_in_what_is_not_free(void)
{
    scan_from(3.0f, 2.4f, 0.4f);
    rig_fill(22, 16, 38, 32, JP_CELL_UNKNOWN);
    begin(0.0f, 0.0f, 0.0f, 0.4f, 0.3f);
    (void)work_all();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_NO_PLACE, jp_localiser_search_finding(&search));
    /* One that is free is enough. */
    rig_fill(30, 24, 31, 25, JP_CELL_FREE);
    scan_from(3.05f, 2.45f, 0.4f);
    begin(0.0f, 0.0f, 0.0f, 0.4f, 0.3f);
    (void)work_all();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_ONE_PLACE, jp_localiser_search_finding(&search));
}

/* ---- Its work ---- */

/* Slices find what one piece does; none looks at more than it was told, but for a closer look at a place. */
static void test_work_in_slices_is_the_same(void)
{
    struct jp_localiser_place whole;
    unsigned all;
    unsigned sum = 0;

    scan_from(3.0f, 2.4f, 0.4f);
    begin(0.3f, 0.2f, 0.1f, 0.5f, 0.3f);
    TEST_ASSERT_EQUAL_UINT(0, work(0));
    all = work(1000000);
    TEST_ASSERT_FALSE(search.is_running);
    TEST_ASSERT_EQUAL_UINT(0, work(10));
    whole = search.places[0];
    begin(0.3f, 0.2f, 0.1f, 0.5f, 0.3f);
    while (search.is_running) {
        const unsigned looked = work(7);

        TEST_ASSERT_TRUE(looked < 7U + 100U && (looked >= 7U || !search.is_running));
        sum += looked;
    }
    TEST_ASSERT_EQUAL_UINT(all, sum);
    TEST_ASSERT_NEAR(0.0f, whole.pose.x, search.places[0].pose.x);
    TEST_ASSERT_NEAR(0.0f, whole.score, search.places[0].score);
}
