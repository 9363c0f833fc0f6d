/* A patrol robot that drives by itself in a room: scans, wheels and twists through the control tick. */
#include <joulepath/patrol_pilot.h>
#include <joulepath/tables.h>

#include "tests/support/patrol_room.h"
#include "unity.h"

#define BLOCK      262144U
#define SCAN_TICKS 10U
#define MAP_WORDS  1024U
#define PATIENCE   6000U /* ticks */

static uint64_t map_block[MAP_WORDS];
static uint64_t block[BLOCK / 8U];
static struct jp_terrain map;
static struct patrol_room room;
static struct jp_four_wheel_robot robot;
static struct jp_patrol_pilot pilot;
static struct jp_patrol_pilot_config config;
static enum jp_status written;
static uint32_t ticks;
static bool is_blind;
static unsigned scan_delay; /* ticks from a scan's begin until it is whole */
static const char *field;

static const struct jp_plane_pose start = {1.5f, 1.5f, 0.0f};
static const struct jp_plane_pose goal = {4.0f, 2.5f, 0.0f};

static void draw(void)
{
    const struct jp_terrain_config size = {.width = ROOM_WIDTH, .height = ROOM_HEIGHT, .resolution = JP_Q16(0.05)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &size, map_block, sizeof map_block, &field));
    patrol_room_draw(&map);
}

void setUp(void)
{
    config = (struct jp_patrol_pilot_config){.patrol = &jp_patrol_config_patrol,
                                             .localiser = &jp_localiser_config_patrol,
                                             .scanner = &jp_patrol_scanner_patrol,
                                             .energy = &jp_four_wheel_energy_patrol,
                                             .learning = &jp_four_wheel_learning_patrol,
                                             .points_max = 256,
                                             .turns_max = 32};
    draw();
    patrol_room_start(&room, &start);
    ticks = 0;
    is_blind = false;
    scan_delay = 0;
    written = JP_OK;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_init(&robot, &jp_four_wheel_robot_patrol, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_init(&pilot, &config, &robot, &field));
}

void tearDown(void)
{
}

static void tick(void)
{
    static struct jp_four_wheel_odometry begun;

    jp_four_wheel_robot_control(&robot, written, &room.sensors, &room.actuation);
    jp_four_wheel_robot_account(&robot);
    if (ticks % SCAN_TICKS == 0U && !is_blind) {
        patrol_room_scan(&room, &jp_patrol_scanner_patrol);
        begun = jp_four_wheel_robot_shown(&robot)->odometry;
    }
    if (ticks % SCAN_TICKS == scan_delay && !is_blind) {
        jp_patrol_pilot_see(&pilot, room.ranges, &begun);
    }
    jp_patrol_pilot_work(&pilot);
    patrol_room_tick(&room, &jp_four_wheel_robot_patrol);
    ticks++;
}

static void pass(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        tick();
    }
}

static enum jp_status take_map(void)
{
    return jp_patrol_pilot_take_map(&pilot, &map, &start, block, sizeof block, &field);
}

/* Its drives are on, and it has a map. */
static void stand(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, take_map());
    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    pass(30);
}

static void drive(void)
{
    for (unsigned i = 0; i < PATIENCE && jp_patrol_pilot_is_under_way(&pilot); i++) {
        tick();
    }
    TEST_ASSERT_FALSE(jp_patrol_pilot_is_under_way(&pilot));
}

static float distance_to(const struct jp_plane_pose *place)
{
    return jp_plane_length(room.pose.x - place->x, room.pose.y - place->y);
}

static bool is_at_rest(void)
{
    return jp_four_wheel_robot_state_now(&robot) == JP_FOUR_WHEEL_ROBOT_STANDING;
}

/* Preparation. */

static void expect_refusal(const char *name)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_patrol_pilot_init(&pilot, &config, &robot, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

static void test_its_tables_are_checked(void)
{
    struct jp_patrol_config patrol = jp_patrol_config_patrol;
    struct jp_four_wheel_energy_model energy = jp_four_wheel_energy_patrol;
    struct jp_factor_learning learning = jp_four_wheel_learning_patrol;
    struct jp_patrol_scanner scanner = jp_patrol_scanner_patrol;

    config.scanner = &scanner;
    scanner.beams = 1;
    expect_refusal("scanner.beams");
    scanner = jp_patrol_scanner_patrol;
    scanner.first_angle = -7.1f;
    expect_refusal("scanner.first_angle");
    scanner = jp_patrol_scanner_patrol;
    scanner.angle_step = 0.0f;
    expect_refusal("scanner.angle_step");
    scanner.angle_step = 0.02f;
    expect_refusal("scanner.angle_step");
    scanner = jp_patrol_scanner_patrol;
    scanner.place.x = 40000.0f;
    expect_refusal("scanner.place");
    config.learning = &learning;
    learning.memory = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_patrol_pilot_init(&pilot, &config, &robot, &field));
    config.energy = &energy;
    energy.weight = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_patrol_pilot_init(&pilot, &config, &robot, &field));
    config.patrol = &patrol;
    patrol.period = 0.0f;
    expect_refusal("period");
}

static void test_null_pointers_are_refused(void)
{
    const void **members[] = {(const void **)&config.patrol, (const void **)&config.localiser,
                              (const void **)&config.scanner, (const void **)&config.energy,
                              (const void **)&config.learning};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_init(NULL, &config, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_init(&pilot, NULL, &robot, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_init(&pilot, &config, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_init(&pilot, &config, &robot, NULL));
    for (unsigned i = 0; i < sizeof members / sizeof members[0]; i++) {
        const void *const member = *members[i];

        *members[i] = NULL;
        TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_init(&pilot, &config, &robot, &field));
        *members[i] = member;
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_take_map(NULL, &map, &start, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_take_map(&pilot, NULL, &start, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_take_map(&pilot, &map, NULL, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_take_map(&pilot, &map, &start, NULL, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_take_map(&pilot, &map, &start, block, sizeof block, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_go(NULL, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_go(&pilot, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_follow(NULL, &(struct jp_point){0, 0}, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_follow(&pilot, NULL, 1));
}

static void test_a_map_needs_its_memory(void)
{
    const struct jp_plane_pose nowhere = {40000.0f, 0.0f, 0.0f};
    const size_t size = jp_patrol_pilot_size(&pilot, &map);

    TEST_ASSERT_TRUE(size > 0U && size < sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_patrol_pilot_take_map(&pilot, &map, &start, block, 1000, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_patrol_pilot_take_map(&pilot, &map, &start, block, size - 8U, &field));
    TEST_ASSERT_FALSE(pilot.has_map);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_take_map(&pilot, &map, &start, block, size, &field));
    TEST_ASSERT_TRUE(pilot.has_map);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_take_map(&pilot, &map, &nowhere, block, size, &field));
    map.config.resolution = 1;
    TEST_ASSERT_EQUAL_UINT(0, jp_patrol_pilot_size(&pilot, &map));
    config.turns_max = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_init(&pilot, &config, &robot, &field));
    draw();
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, take_map());
}

static void test_the_odometry_before_the_map_counts(void)
{
    const struct jp_twist ahead = {.x = JP_Q24(0.5)};

    tick();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_enable(&robot));
    tick();
    for (unsigned i = 0; i < 100; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_four_wheel_robot_drive(&robot, &ahead));
        tick();
    }
    pass(150);
    TEST_ASSERT_EQUAL_INT(JP_OK, take_map());
    const struct jp_plane_pose pose = jp_patrol_pilot_pose(&pilot);

    TEST_ASSERT_TRUE(jp_plane_magnitude(pose.x - room.pose.x) < 0.02f);
    TEST_ASSERT_TRUE(pose.x > start.x + 0.3f);
}

/* Goals. */

static void test_goals_are_judged(void)
{
    const struct jp_plane_pose outside[] = {
        {-0.1f, 1.0f, 0.0f}, {1.0f, -0.1f, 0.0f}, {6.1f, 1.0f, 0.0f}, {1.0f, 4.1f, 0.0f}};
    const struct jp_plane_pose in_wall = {0.1f, 1.0f, 0.0f};
    const struct jp_plane_pose no_pose = {1.0f, 1.0f, 2000.0f};
    const struct jp_point points[2] = {{JP_Q16(1), 0}, {JP_Q16(9), 0}};

    TEST_ASSERT_FALSE(jp_patrol_pilot_is_under_way(&pilot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_go(&pilot, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_follow(&pilot, points, 1));
    TEST_ASSERT_FALSE(jp_patrol_pilot_can_stand(&pilot, &goal));
    TEST_ASSERT_EQUAL_INT(JP_OK, take_map());
    TEST_ASSERT_TRUE(jp_patrol_pilot_can_stand(&pilot, &goal));
    TEST_ASSERT_FALSE(jp_patrol_pilot_can_stand(&pilot, &outside[0]));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_patrol_pilot_go(&pilot, &goal));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_patrol_pilot_follow(&pilot, points, 1));
    stand();
    for (unsigned i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_patrol_pilot_go(&pilot, &outside[i]));
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, jp_patrol_pilot_go(&pilot, &in_wall));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_go(&pilot, &no_pose));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_patrol_pilot_follow(&pilot, points, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_follow(&pilot, points, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_pilot_follow(&pilot, points, JP_PATROL_PILOT_GOALS + 1U));
    TEST_ASSERT_FALSE(jp_patrol_pilot_is_under_way(&pilot));
}

static void test_it_drives_to_a_goal_and_learns_from_it(void)
{
    struct jp_patrol_leg_forecast left;
    float length;
    uint16_t of;

    stand();
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_progress(&pilot, &length, &left));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    TEST_ASSERT_TRUE(jp_patrol_pilot_is_under_way(&pilot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_progress(&pilot, &length, &left));
    pass(300);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_progress(&pilot, &length, &left));
    TEST_ASSERT_TRUE(length < 2.7f && left.energy < pilot.ledger.forecast.energy && left.duration > 0.0f);
    drive();
    TEST_ASSERT_EQUAL_UINT16(1, jp_patrol_pilot_reached(&pilot, &of));
    TEST_ASSERT_EQUAL_UINT16(1, of);
    TEST_ASSERT_TRUE(distance_to(&goal) < 0.15f);
    TEST_ASSERT_TRUE(jp_plane_magnitude(jp_plane_wrap(room.pose.heading)) < 0.2f);
    TEST_ASSERT_EQUAL_UINT16(0, pilot.ledger.ended); /* its last piece is still to come */
    pass(60);
    TEST_ASSERT_TRUE(is_at_rest());
    TEST_ASSERT_EQUAL_UINT16(1, pilot.ledger.ended);
    TEST_ASSERT_EQUAL_UINT32(1, pilot.ledger.learned_from);
    TEST_ASSERT_TRUE(pilot.ledger.result.energy > 0);
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_TRACKING, pilot.localiser.state);
}

/* It sees what was around it then, and drives from where it is. */
static void test_it_knows_where_it_is_however_late_its_scan_comes(void)
{
    float fastest = 0.0f;

    scan_delay = 8;
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    for (unsigned i = 0; i < PATIENCE && jp_patrol_pilot_is_under_way(&pilot); i++) {
        const struct jp_plane_pose before = room.pose;
        const uint32_t cycles = pilot.mission.patrol.counts.cycles;

        tick();
        fastest = jp_plane_larger(fastest, 100.0f * jp_plane_length(room.pose.x - before.x, room.pose.y - before.y));
        if (pilot.mission.patrol.counts.cycles != cycles) {
            const struct jp_plane_pose believed = jp_patrol_pilot_pose(&pilot);

            TEST_ASSERT_TRUE(jp_plane_length(believed.x - before.x, believed.y - before.y) < 0.02f);
            TEST_ASSERT_TRUE(jp_plane_magnitude(jp_plane_wrap(believed.heading - before.heading)) < 0.03f);
        }
    }
    TEST_ASSERT_TRUE(fastest > 0.8f);
    TEST_ASSERT_TRUE(distance_to(&goal) < 0.05f);
}

static void test_it_follows_waypoints_one_after_the_other(void)
{
    const struct jp_point points[2] = {{JP_Q16(1.5), JP_Q16(0.5)}, {JP_Q16(2.5), JP_Q16(1.2)}};
    const struct jp_plane_pose last = {start.x + 2.5f, start.y + 1.2f, 0.0f};
    uint16_t of;

    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_follow(&pilot, points, 2));
    drive();
    TEST_ASSERT_EQUAL_UINT16(2, jp_patrol_pilot_reached(&pilot, &of));
    TEST_ASSERT_EQUAL_UINT16(2, of);
    TEST_ASSERT_TRUE(distance_to(&last) < 0.15f);
    pass(60);
    TEST_ASSERT_EQUAL_UINT16(2, pilot.ledger.ended);
}

static void test_it_does_nothing_in_the_middle_of_a_tick(void)
{
    stand();
    const uint32_t cycles = pilot.mission.patrol.counts.cycles;

    jp_four_wheel_robot_control(&robot, JP_OK, &room.sensors, &room.actuation);
    for (unsigned i = 0; i < 20; i++) {
        jp_patrol_pilot_work(&pilot);
    }
    TEST_ASSERT_EQUAL_UINT32(cycles, pilot.mission.patrol.counts.cycles);
    jp_four_wheel_robot_account(&robot);
}

static void test_told_to_stop_it_stops(void)
{
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    pass(250);
    TEST_ASSERT_FALSE(is_at_rest());
    jp_patrol_pilot_stop(&pilot);
    pass(150);
    TEST_ASSERT_TRUE(is_at_rest());
    TEST_ASSERT_FALSE(jp_patrol_pilot_is_under_way(&pilot));
    TEST_ASSERT_EQUAL_UINT32(1, pilot.ledger.left_out);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    drive();
    TEST_ASSERT_TRUE(distance_to(&goal) < 0.15f);
}

static void test_without_drives_it_forgets_its_goal(void)
{
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    pass(200);
    jp_four_wheel_robot_disable(&robot);
    pass(2);
    TEST_ASSERT_FALSE(jp_patrol_pilot_is_under_way(&pilot));
}

static void test_without_a_map_it_has_none(void)
{
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    pass(200);
    jp_patrol_pilot_forget_map(&pilot);
    pass(150);
    TEST_ASSERT_TRUE(is_at_rest());
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_patrol_pilot_go(&pilot, &goal));
}

static void test_it_gives_up_where_no_way_leads(void)
{
    uint16_t of;

    for (int32_t y = 0; y < ROOM_HEIGHT; y++) {
        (void)jp_terrain_set_cell(&map, ROOM_WIDTH / 2, y, JP_CELL_OCCUPIED);
    }
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    drive();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_GIVEN_UP, pilot.mission.state);
    TEST_ASSERT_EQUAL_UINT16(0, jp_patrol_pilot_reached(&pilot, &of));
    TEST_ASSERT_EQUAL_UINT16(0, pilot.ledger.begun);
}

static void test_blind_it_stops(void)
{
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    pass(200);
    is_blind = true;
    drive();
    TEST_ASSERT_EQUAL_INT(JP_PATROL_NO_SCAN, pilot.mission.patrol.reason);
    pass(100);
    TEST_ASSERT_TRUE(is_at_rest());
    TEST_ASSERT_TRUE(distance_to(&goal) > 0.3f);
}

static void test_at_its_goal_another_one_ends_the_leg_before(void)
{
    stand();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &goal));
    drive();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &start));
    TEST_ASSERT_EQUAL_UINT16(1, pilot.ledger.ended);
    drive();
    TEST_ASSERT_TRUE(distance_to(&start) < 0.15f);
}

static void test_on_the_spot_nothing_is_left(void)
{
    struct jp_patrol_leg_forecast left;
    struct jp_plane_pose here;
    float length;

    stand();
    here = jp_patrol_pilot_pose(&pilot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_pilot_go(&pilot, &here));
    tick();
    if (jp_patrol_pilot_progress(&pilot, &length, &left) == JP_OK) {
        TEST_ASSERT_TRUE(length < 0.1f);
    }
    drive();
    TEST_ASSERT_TRUE(distance_to(&here) < 0.1f);
}
