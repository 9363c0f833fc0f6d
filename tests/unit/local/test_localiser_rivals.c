/* A robot that is more uncertain than is allowed, among places that look alike: when it stands, when it goes on, and
 * how uncertain it says that it is. */
#include "tests/support/localiser_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* Two aisles side by side with a niche each; the scanner sees 2 m. The robot is in the western one. */
static void enter_alike(bool is_alike)
{
    rig_map();
    rig_fill(0, 0, RIG_WIDTH, RIG_HEIGHT, JP_CELL_OCCUPIED);
    rig_fill(10, 4, 20, 56, JP_CELL_FREE);
    rig_fill(40, 4, 50, 56, JP_CELL_FREE);
    rig_fill(6, 25, 10, 30, JP_CELL_FREE);
    rig_fill(36, is_alike ? 25 : 5, 40, is_alike ? 30 : 10, JP_CELL_FREE);
    config.range_max = 2.0f;
    config.start_distance = 1.5f;
    rig_init();
    robot = (struct jp_plane_pose){1.5f, 2.6f, 0.5f * JP_PLANE_PI};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
}

static void look_and_search(unsigned times)
{
    for (unsigned i = 0; i < times; i++) {
        rig_look();
        rig_search();
    }
}

/* ---- Places that look alike ---- */

static void test_a_place_that_may_be_another_is_told_as_uncertain(void)
{
    enter_alike(true);
    look_and_search(30);
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
    TEST_ASSERT_TRUE(localiser.covariance[0][0] < 0.01f && localiser.covariance[1][1] < 0.01f);
    TEST_ASSERT_TRUE(localiser.position_deviation > 1.4f);
    TEST_ASSERT_EQUAL_UINT32(0, localiser.counts.losses);
    TEST_ASSERT_TRUE(localiser.counts.searches > 1U);
}

/* It does not become more uncertain meanwhile, but for what the wheels tell of its way at the place. */
static void test_a_robot_that_tracks_a_place_gets_no_more_uncertain(void)
{
    float before;

    enter_alike(true);
    look_and_search(3);
    before = localiser.position_deviation;
    for (int i = 0; i < 20; i++) {
        rig_drive(0.01f, 0.0f, 1.1f);
        look_and_search(1);
        rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
        rig_expect_pose(0.03f, 0.02f);
    }
    TEST_ASSERT_NEAR(0.01f, before, localiser.position_deviation);
}

static void test_a_place_that_is_found_alone_is_the_one(void)
{
    enter_alike(false);
    look_and_search(30);
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
    TEST_ASSERT_TRUE(localiser.position_deviation < 0.1f);
    TEST_ASSERT_TRUE(localiser.heading_deviation < 0.05f);
}

/* Nor is a place that is found alone the one, where the robot follows another that explains the scan about as well. */
static void test_a_place_elsewhere_does_not_make_it_sure(void)
{
    enter_alike(true);
    look_and_search(3);
    TEST_ASSERT_TRUE(localiser.position_deviation > 1.4f);
    localiser.internal.has_place = true;
    localiser.internal.search.places[0].pose = localiser.pose;
    localiser.internal.search.places[0].pose.x += 3.0f;
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
    TEST_ASSERT_TRUE(localiser.position_deviation > 1.4f);
}

/* A new start knows what it is told. */
static void test_a_start_forgets_places_that_look_alike(void)
{
    enter_alike(true);
    look_and_search(3);
    localiser.config.start_distance = 0.1f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    TEST_ASSERT_NEAR(1.0e-5f, 0.1f, localiser.position_deviation);
    look_and_search(2);
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    TEST_ASSERT_TRUE(localiser.position_deviation < 0.1f);
}

/* By its heading alone it may be far off too. */
static void test_a_heading_that_is_not_known_has_rivals_too(void)
{
    enter_alike(true);
    config.start_distance = 0.1f;
    config.start_turn = 0.8f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    TEST_ASSERT_TRUE(localiser.heading_deviation > 0.7f);
    rig_search();
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
}

/* Along a corridor the scan leads it to no place: it is as uncertain along it as it was, and no more. */
static void test_along_a_corridor_there_is_no_place_to_be_led_to(void)
{
    rig_map();
    rig_fill(0, 20, RIG_WIDTH, 24, JP_CELL_OCCUPIED);
    rig_fill(0, 36, RIG_WIDTH, 40, JP_CELL_OCCUPIED);
    config.range_max = 2.0f;
    config.start_distance = 0.9f;
    rig_init();
    robot = (struct jp_plane_pose){3.0f, 2.9f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    for (int i = 0; i < 5; i++) {
        rig_look();
        rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
        TEST_ASSERT_NEAR(0.02f, 0.9f, localiser.position_deviation);
    }
    TEST_ASSERT_TRUE(localiser.covariance[1][1] < 0.01f);
}

/* ---- No place ---- */

/* Most of what it sees is not on the map, and its wheels tell next to nothing. */
static void drift(bool searches)
{
    config.wheels.distance = 1.0f;
    config.start_distance = 0.45f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    person = 4.5f;
    rig_look();
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_UNEXPLAINED);
    if (searches) {
        rig_search();
    }
    rig_drive(0.1f, 0.0f, 1.0f);
    rig_look();
}

static void test_where_no_search_tells_it_goes_on(void)
{
    drift(true);
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_DEGRADED, localiser.state);
    TEST_ASSERT_TRUE(localiser.position_deviation > config.lost_distance);
    TEST_ASSERT_EQUAL_UINT32(0, localiser.counts.losses);
    /* Without scans there is nothing to go by. */
    input.scan.ranges = NULL;
    rig_update();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_UNCERTAIN);
}

/* It stands for the search, and no longer. */
static void test_before_a_search_has_told_it_stands(void)
{
    drift(false);
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_LOST, localiser.state);
    rig_look();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_SEARCHING);
    rig_search();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_DEGRADED, localiser.state);
    TEST_ASSERT_TRUE(localiser.reason == JP_LOCALISER_NOWHERE || localiser.reason == JP_LOCALISER_AMBIGUOUS);
    rig_look();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_DEGRADED, localiser.state);
}

/* With the place that the search has found. */
static void test_after_a_search_it_goes_on_with_the_place(void)
{
    const struct jp_plane_pose told = {robot.x + 0.4f, robot.y + 0.4f, robot.heading + 0.3f};

    config.start_distance = 0.6f;
    config.start_turn = 0.25f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &told));
    person = 4.5f;
    rig_look();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_UNCERTAIN);
    person = 0.0f;
    rig_look();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_SEARCHING);
    rig_search();
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_SEARCHING);
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
    look_and_search(20);
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    TEST_ASSERT_TRUE(localiser.position_deviation < 0.1f);
}

/* Who is lost by more than its uncertainty stays so. */
static void test_a_robot_that_the_map_contradicts_stays_lost(void)
{
    rig_map();
    rig_fill(0, 0, RIG_WIDTH, RIG_HEIGHT, JP_CELL_OCCUPIED);
    rig_fill(4, 4, 30, 40, JP_CELL_FREE);
    rig_fill(36, 4, 62, 40, JP_CELL_FREE);
    rig_fill(10, 4, 14, 9, JP_CELL_OCCUPIED);
    rig_fill(42, 4, 46, 9, JP_CELL_OCCUPIED);
    rig_init();
    robot = (struct jp_plane_pose){1.9f, 2.3f, 0.4f};
    rig_look();
    rig_search();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_AMBIGUOUS);
    rig_drive(0.3f, 0.0f, 1.0f);
    rig_look();
    rig_drive(0.3f, 0.0f, 1.0f);
    rig_look();
    rig_search();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_LOST, localiser.state);
}
