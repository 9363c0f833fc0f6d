/* Tracking on a map, what degrades it, how a robot is lost and finds itself again, and what is refused. */
#include "tests/support/localiser_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

/* ---- Tracking ---- */

static void test_it_starts_where_it_is_told(void)
{
    const struct jp_plane_pose told = {robot.x + 0.1f, robot.y - 0.08f, robot.heading + 0.05f};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &told));
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_NO_SCAN);
    TEST_ASSERT_NEAR(1.0e-5f, 0.1f, localiser.position_deviation);
    TEST_ASSERT_NEAR(1.0e-5f, 0.05f, localiser.heading_deviation);
    rig_look();
    rig_search();
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.02f, 0.01f);
    TEST_ASSERT_FALSE(localiser.is_new_place);
    TEST_ASSERT_TRUE(localiser.position_deviation < 0.04f);
    TEST_ASSERT_TRUE(localiser.view.explained > 9U * localiser.view.beams / 10U);
}

static void test_it_tracks_over_wheels_that_err(void)
{
    rig_start();
    for (int i = 0; i < 40; i++) {
        rig_drive(0.05f, i < 20 ? 0.08f : -0.06f, 1.1f);
        rig_look();
        rig_search();
        rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
        rig_expect_pose(0.03f, 0.02f);
        TEST_ASSERT_FALSE(localiser.is_new_place);
    }
    TEST_ASSERT_TRUE(localiser.counts.fits >= 41U);
    TEST_ASSERT_EQUAL_UINT32(localiser.counts.scans, localiser.counts.fits);
    TEST_ASSERT_EQUAL_UINT32(0, localiser.counts.losses);
}

static void test_the_scanner_may_be_anywhere_on_the_robot(void)
{
    const struct jp_plane_pose mount = {0.3f, -0.2f, 0.7f};
    const struct jp_plane_pose base = robot;

    input.sensor = mount;
    robot = jp_plane_compose(&base, &mount);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &base));
    rig_look();
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    robot = base;
    rig_expect_pose(0.03f, 0.02f);
}

static void test_a_person_beside_it_does_no_harm(void)
{
    rig_start();
    person = 2.0f;
    for (int i = 0; i < 10; i++) {
        rig_drive(0.05f, 0.03f, 0.95f);
        rig_look();
        rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
        rig_expect_pose(0.03f, 0.02f);
    }
}

/* ---- Along a corridor ---- */

static void enter_corridor(void)
{
    rig_map();
    rig_fill(0, 20, RIG_WIDTH, 24, JP_CELL_OCCUPIED);
    rig_fill(0, 36, RIG_WIDTH, 40, JP_CELL_OCCUPIED);
    config.range_max = 2.0f;
    rig_init();
    robot = (struct jp_plane_pose){3.0f, 2.9f, 0.0f};
}

static void test_along_a_corridor_the_wheels_tell_and_the_uncertainty_grows(void)
{
    float before;

    enter_corridor();
    rig_start();
    before = localiser.position_deviation;
    for (int i = 0; i < 16; i++) {
        rig_drive(0.05f, 0.0f, 1.1f);
        rig_look();
        rig_search();
        rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
        TEST_ASSERT_TRUE(localiser.position_deviation > before);
        before = localiser.position_deviation;
    }
    TEST_ASSERT_NEAR(0.03f, 3.88f, localiser.pose.x);
    TEST_ASSERT_NEAR(0.02f, robot.y, localiser.pose.y);
    TEST_ASSERT_NEAR(0.01f, 0.0f, localiser.pose.heading);
    TEST_ASSERT_TRUE(localiser.covariance[1][1] < 0.01f * localiser.covariance[0][0]);
}

/* ---- Scans that do not tell ---- */

static void test_without_scans_the_wheels_tell_until_it_is_lost(void)
{
    unsigned cycles = 0;

    rig_start();
    input.scan.ranges = NULL;
    while (localiser.state != JP_LOCALISER_LOST && cycles < 200U) {
        rig_drive(0.05f, 0.0f, 1.0f);
        rig_update();
        TEST_ASSERT_TRUE(localiser.state == JP_LOCALISER_LOST || localiser.reason == JP_LOCALISER_NO_SCAN);
        cycles++;
    }
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_UNCERTAIN);
    TEST_ASSERT_TRUE(cycles > 40U);
    TEST_ASSERT_FALSE(jp_localiser_work(&localiser, 100));
}

static void test_turns_without_scans_lose_it_too(void)
{
    rig_start();
    input.scan.ranges = NULL;
    for (int i = 0; i < 70; i++) {
        rig_drive(0.0f, 0.1f, 1.0f);
        rig_update();
    }
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_UNCERTAIN);
}

static void test_after_a_gap_it_goes_on(void)
{
    rig_start();
    input.scan.ranges = NULL;
    for (int i = 0; i < 15; i++) {
        rig_drive(0.06f, 0.03f, 0.9f);
        rig_update();
        rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_NO_SCAN);
    }
    for (int i = 0; i < 3; i++) {
        rig_look();
        rig_search();
    }
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
}

static void test_a_crowd_around_it_is_not_a_place(void)
{
    rig_start();
    person = 7.0f;
    rig_look();
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_UNEXPLAINED);
    rig_expect_pose(0.03f, 0.02f);
    for (int i = 0; i < 20; i++) {
        rig_look();
    }
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_UNEXPLAINED);
    person = 0.0f;
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    person = 7.0f;
    for (int i = 0; i < 60; i++) {
        rig_look();
    }
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_LOST, localiser.state);
}

static void look_until(enum jp_localiser_state state, int most)
{
    for (int i = 0; i < most && localiser.state != state; i++) {
        rig_look();
        rig_search();
    }
    TEST_ASSERT_EQUAL_INT(state, localiser.state);
}

static void test_wheels_that_jump_are_not_believed_for_long(void)
{
    rig_start();
    input.wheels.x += 0.25f;
    rig_look();
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_JUMPED);
    look_until(JP_LOCALISER_LOST, 5);
    look_until(JP_LOCALISER_TRACKING, 40);
    TEST_ASSERT_TRUE(localiser.is_new_place);
    rig_expect_pose(0.03f, 0.02f);
}

/* ---- In the open ---- */

/* A wall in the south-west; the scanner sees 1.5 m, and what is left of `person` stands at 0.6 m. */
static void enter_the_open(void)
{
    rig_map();
    rig_fill(0, 0, 10, 20, JP_CELL_OCCUPIED);
    config.range_max = 1.5f;
    rig_init();
    robot = (struct jp_plane_pose){4.5f, 3.5f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
}

/* What is not on the map stands beside the robot, which sees nothing where the map shows nothing. */
static void test_in_the_open_what_it_sees_is_not_strange(void)
{
    enter_the_open();
    person = 1.0f;
    for (int i = 0; i < 80; i++) {
        rig_look();
        rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_UNEXPLAINED);
    }
    TEST_ASSERT_TRUE(localiser.view.empty > 80U);
    TEST_ASSERT_EQUAL_UINT16(localiser.view.empty, localiser.view.open);
}

static void test_in_the_open_it_goes_on_however_uncertain(void)
{
    enter_the_open();
    for (int i = 0; i < 40; i++) {
        rig_drive(0.0f, i < 20 ? 0.3f : -0.3f, 1.0f);
        rig_look();
        rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_NO_SCAN);
    }
    TEST_ASSERT_TRUE(localiser.heading_deviation > config.lost_turn);
}

/* Where the map shows walls in sight, seeing nothing does not say that it is in the open. */
static void test_seeing_nothing_among_walls_is_not_the_open(void)
{
    rig_start();
    for (int i = 0; i < 70; i++) {
        rig_drive(0.0f, 0.1f, 1.0f);
        rig_scan();
        for (int k = 0; k < RIG_BEAMS; k++) {
            ranges[k] = 0.0f;
        }
        rig_update();
    }
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_UNCERTAIN);
    TEST_ASSERT_EQUAL_UINT16(RIG_BEAMS / 3, localiser.view.empty);
    TEST_ASSERT_EQUAL_UINT16(0, localiser.view.open);
}

/* Nor do beams that failed. */
static void test_beams_that_failed_are_not_empty(void)
{
    enter_the_open();
    for (int i = 0; i < 40; i++) {
        rig_drive(0.0f, 0.3f, 1.0f);
        rig_scan();
        for (int k = 0; k < RIG_BEAMS; k++) {
            ranges[k] = k % 2 == 0 ? -1.0f : __builtin_inff();
        }
        rig_update();
    }
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_UNCERTAIN);
    TEST_ASSERT_EQUAL_UINT16(0, localiser.view.empty);
}

/* ---- Lost ---- */

static void test_carried_away_it_finds_itself(void)
{
    const struct jp_plane_pose elsewhere = {5.6f, 4.2f, -2.0f};
    int scans = 0;

    rig_start();
    robot = elsewhere;
    while (localiser.state != JP_LOCALISER_LOST && scans < 80) {
        rig_look();
        scans++;
    }
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_LOST, localiser.state);
    TEST_ASSERT_EQUAL_UINT32(1, localiser.counts.losses);
    look_until(JP_LOCALISER_TRACKING, 40);
    TEST_ASSERT_TRUE(localiser.is_new_place);
    rig_expect_pose(0.05f, 0.03f);
    rig_look();
    TEST_ASSERT_FALSE(localiser.is_new_place);
    TEST_ASSERT_TRUE(localiser.counts.nodes > 100U);
}

static void test_started_anywhere_it_finds_itself_while_it_moves(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, NULL));
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_NO_SCAN);
    rig_look();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_SEARCHING);
    TEST_ASSERT_TRUE(jp_localiser_work(&localiser, 10));
    TEST_ASSERT_EQUAL_UINT32(10, localiser.counts.nodes);
    rig_drive(0.1f, 0.1f, 1.0f);
    rig_look();
    rig_search();
    rig_drive(0.1f, 0.1f, 1.0f);
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.05f, 0.03f);
}

static void test_where_two_places_are_alike_it_stays_lost(void)
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
    rig_look();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_AMBIGUOUS);
    TEST_ASSERT_EQUAL_UINT32(1, localiser.counts.searches);
    rig_drive(0.3f, 0.0f, 1.0f);
    rig_look();
    rig_drive(0.3f, 0.0f, 1.0f);
    rig_look();
    TEST_ASSERT_EQUAL_UINT32(2, localiser.counts.searches);
    rig_search();
    rig_drive(0.0f, 0.3f, 1.0f);
    rig_look();
    rig_drive(0.0f, 0.3f, 1.0f);
    rig_look();
    TEST_ASSERT_EQUAL_UINT32(3, localiser.counts.searches);
}

static void enter_closet(void)
{
    rig_map();
    rig_fill(0, 0, RIG_WIDTH, RIG_HEIGHT, JP_CELL_OCCUPIED);
    rig_fill(20, 20, 40, 38, JP_CELL_FREE);
    rig_init();
    robot = (struct jp_plane_pose){3.0f, 2.8f, 0.0f};
}

static void test_a_place_that_is_not_on_the_map_is_nowhere(void)
{
    enter_closet();
    person = 7.0f;
    rig_look();
    rig_search();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_NOWHERE);
}

/* The next scan does not fit where the search found the one before. */
static void test_a_place_must_be_confirmed(void)
{
    rig_look();
    rig_search();
    person = 7.0f;
    rig_look();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_NOWHERE);
}

static void test_with_too_few_beams_there_is_no_search(void)
{
    rig_scan();
    for (int i = 0; i < RIG_BEAMS; i++) {
        ranges[i] = i % 6 == 0 ? ranges[i] : -1.0f;
    }
    rig_update();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_NO_SCAN);
    TEST_ASSERT_EQUAL_UINT32(0, localiser.counts.searches);
}

/* A door that the map shows closed is open: what is behind it is on the map. */
static void test_through_a_door_that_is_open_now(void)
{
    rig_fill(44, 2, 46, 30, JP_CELL_OCCUPIED);
    rig_init();
    rig_fill(44, 16, 46, 28, JP_CELL_FREE);
    robot = (struct jp_plane_pose){3.0f, 2.2f, 0.0f};
    rig_start();
    for (int i = 0; i < 50; i++) {
        rig_drive(0.05f, 0.0f, 1.05f);
        rig_look();
        rig_search();
        rig_expect_pose(0.06f, 0.03f);
    }
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    TEST_ASSERT_EQUAL_UINT32(0, localiser.counts.losses);
}

/* ---- What is refused ---- */

static void expect_field(const char *name)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_localiser_init(&localiser, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    config = rig_config();
}

static void test_configurations_out_of_range(void)
{
    config.map = NULL;
    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(&config));
    expect_field("map");
    config.range_max = 0.0f;
    expect_field("range_max");
    config.noise = 0.0f;
    expect_field("noise");
    config.wheels.distance = 2.0f;
    expect_field("wheels.distance");
    config.wheels.turn = 0.0f;
    expect_field("wheels.turn");
    config.wheels.deviation = -1.0f;
    expect_field("wheels.deviation");
    config.start_distance = 11.0f;
    expect_field("start_distance");
    config.start_turn = 2.0f;
    expect_field("start_turn");
    config.lost_distance = 0.0f;
    expect_field("lost_distance");
    config.lost_turn = 0.0f;
    expect_field("lost_turn");
}

static void test_blocks(void)
{
    const size_t size = jp_localiser_size(&config);
    const char *field;

    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(NULL));
    TEST_ASSERT_EQUAL_UINT(RIG_CELLS + RIG_HEIGHT + 8 * JP_LOCALISER_POINTS_MAX, size);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_init(&localiser, &config, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_localiser_init(&localiser, &config, block, size - 1U, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_localiser_init(&localiser, &config, (char *)block + 4, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_init(NULL, &config, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_init(&localiser, NULL, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_init(&localiser, &config, NULL, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_init(&localiser, &config, block, size, NULL));
}

static void test_maps_out_of_range(void)
{
    struct jp_terrain wrong = map;
    const struct jp_terrain_config sound = map.config;

    config.map = &wrong;
    wrong.config.width = 0;
    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(&config));
    wrong.config = sound;
    wrong.config.height = 0;
    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(&config));
    wrong.config = sound;
    wrong.config.resolution = 0;
    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(&config));
    wrong.config = sound;
    wrong.config.width = JP_TERRAIN_SIDE_MAX + 1;
    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(&config));
    wrong.config = sound;
    wrong.config.height = JP_TERRAIN_SIDE_MAX + 1;
    TEST_ASSERT_EQUAL_UINT(0, jp_localiser_size(&config));
}

static void test_wrong_arguments_change_nothing(void)
{
    const struct jp_plane_pose far = {40000.0f, 0.0f, 0.0f};

    rig_start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_start(NULL, &robot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_start(&localiser, &far));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_update(NULL, &input));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_update(&localiser, NULL));
    input.scan.count = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_update(&localiser, &input));
    rig_scan();
    input.wheels = far;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_update(&localiser, &input));
    input.wheels = robot;
    input.sensor = far;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_localiser_update(&localiser, &input));
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
}

/* ---- How sure it must be ---- */

static void test_from_far_off_a_search_leads_there(void)
{
    const struct jp_plane_pose told = {robot.x + 0.4f, robot.y + 0.4f, robot.heading + 0.5f};

    config.start_distance = 0.3f;
    config.start_turn = 0.25f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &told));
    rig_look();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_DEGRADED, localiser.state);
    rig_search();
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    TEST_ASSERT_TRUE(localiser.is_new_place);
    rig_expect_pose(0.03f, 0.02f);
}

static void test_an_uncertain_pose_needs_more_of_the_scan(void)
{
    config.start_distance = 0.3f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    person = 4.2f;
    rig_look();
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_UNEXPLAINED);
    rig_search();
    person = 1.0f;
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
}

/* A search that leads out of where the robot may be is not followed. */
static void test_a_place_beyond_the_region_is_not_taken(void)
{
    const struct jp_plane_pose told = {robot.x + 0.4f, robot.y + 0.4f, robot.heading + 0.5f};

    config.start_distance = 0.3f;
    config.start_turn = 0.25f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &told));
    rig_look();
    rig_search();
    localiser.internal.search.places[0].pose.heading += JP_PLANE_PI;
    localiser.internal.search.places[0].score = 1.0f;
    rig_look();
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_DEGRADED, localiser.state);
}

/* Beams that pass through a wall and end where the map shows none. */
static void test_a_map_of_another_place_contradicts(void)
{
    rig_fill(44, 2, 46, 58, JP_CELL_OCCUPIED);
    rig_fill(2, 30, 44, 32, JP_CELL_OCCUPIED);
    rig_init();
    rig_start();
    rig_fill(44, 2, 46, 58, JP_CELL_FREE);
    rig_fill(2, 30, 44, 32, JP_CELL_FREE);
    rig_fill(50, 2, 60, 9, JP_CELL_FREE);
    rig_fill(2, 38, 50, 40, JP_CELL_OCCUPIED);
    rig_fill(52, 2, 54, 40, JP_CELL_OCCUPIED);
    rig_look();
    rig_expect(JP_LOCALISER_DEGRADED, JP_LOCALISER_CONTRADICTED);
    for (int i = 0; i < 4; i++) {
        rig_look();
    }
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_LOST, localiser.state);
}

/* Places along the corridor are alike: the one that is searched out serves to begin a match only. */
static void test_where_along_a_corridor_is_not_searched_out(void)
{
    enter_corridor();
    config.start_distance = 0.4f;
    rig_init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    rig_look();
    rig_search();
    TEST_ASSERT_TRUE(localiser.counts.nodes > 0U);
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    TEST_ASSERT_NEAR(0.1f, robot.x, localiser.pose.x);
    TEST_ASSERT_TRUE(localiser.position_deviation > 0.3f);
}

static void test_a_place_in_unknown_cells_is_none(void)
{
    enter_closet();
    rig_fill(30, 20, 31, 24, JP_CELL_OCCUPIED);
    robot = (struct jp_plane_pose){3.05f, 2.85f, 0.3f};
    rig_scan();
    rig_fill(28, 26, 33, 31, JP_CELL_UNKNOWN);
    rig_init();
    rig_update();
    rig_search();
    rig_expect(JP_LOCALISER_LOST, JP_LOCALISER_NOWHERE);
}

static void test_a_motion_that_cannot_be_is_none(void)
{
    rig_start();
    input.wheels.x += 1.0f;
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
    rig_expect_pose(0.03f, 0.02f);
    TEST_ASSERT_TRUE(localiser.is_new_place);
    rig_look();
    TEST_ASSERT_FALSE(localiser.is_new_place);
}
