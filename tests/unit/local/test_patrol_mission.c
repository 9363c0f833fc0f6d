/* Missions of the patrol robot on small maps: goals straight on, approached, seen to be blocked on the way, planned
 * anew, given up; and what is refused. */
#include <joulepath/patrol_forecast.h>
#include <joulepath/patrol_mission.h>

#include "tests/support/patrol_rig.h"

enum { SIDE = 80, POINTS_MAX = 200, TURNS_MAX = 20, BLOCK_SIZE = 90000, CYCLES_MAX = 400 };

static struct jp_terrain map;
static uint64_t map_block[2 * SIDE * SIDE / 64 + 2 * SIDE];
static struct jp_patrol_mission_config mission_config;
static struct jp_patrol_mission mission;
static uint64_t block[BLOCK_SIZE / sizeof(uint64_t)];
static unsigned planned; /* calls of jp_patrol_mission_work() that had something to do */

static void make_map(jp_q16 resolution)
{
    const struct jp_terrain_config terrain = {
        .width = SIDE, .height = SIDE, .resolution = resolution, .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &terrain, map_block, sizeof map_block, &field));
}

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_init(&mission, &mission_config, block, sizeof block, &field));
    TEST_ASSERT_NULL(field);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&mission.patrol, &robot));
}

void setUp(void)
{
    rig_reset();
    make_map(JP_Q16(0.1));
    mission_config = (struct jp_patrol_mission_config){.patrol = rig_config(),
                                                       .map = &map,
                                                       .turns_before_goal = true,
                                                       .points_max = POINTS_MAX,
                                                       .turns_max = TURNS_MAX};
    robot = (struct jp_plane_pose){1.5f, 4.05f, 0.0f};
    init();
    planned = 0;
}

void tearDown(void)
{
}

/* ---- The world ---- */

static void occupy(float left, float bottom, float right, float top)
{
    for (int y = (int)(bottom * 10.0f + 0.5f); y < (int)(top * 10.0f + 0.5f); y++) {
        for (int x = (int)(left * 10.0f + 0.5f); x < (int)(right * 10.0f + 0.5f); x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, JP_CELL_OCCUPIED));
        }
    }
}

/* As much as there is time for between two cycles, and until there is a path. */
static void work(void)
{
    for (unsigned i = 0; i < 15U || mission.state == JP_MISSION_PLANNING; i++) {
        planned += jp_patrol_mission_work(&mission, 50) == JP_MISSION_PLANNING ? 1U : 0U;
    }
}

static void start(float x, float y, float heading)
{
    const struct jp_plane_pose goal = {x, y, heading};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_start(&mission, &goal));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    work();
}

static void cycle(void)
{
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    work();
    rig_move();
}

static void cycles(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        cycle();
    }
}

static void drive_until(enum jp_patrol_mission_state state)
{
    for (unsigned i = 0; i < CYCLES_MAX && mission.state != state; i++) {
        cycle();
    }
    TEST_ASSERT_EQUAL_INT(state, mission.state);
}

static void drive_until_leg(enum jp_patrol_leg leg)
{
    for (unsigned i = 0; i < CYCLES_MAX && mission.internal.leg != leg; i++) {
        cycle();
    }
    TEST_ASSERT_EQUAL_INT(leg, mission.internal.leg);
}

static void expect_at(float x, float y, float heading)
{
    TEST_ASSERT_NEAR(0.1f, x, robot.x);
    TEST_ASSERT_NEAR(0.1f, y, robot.y);
    TEST_ASSERT_NEAR(0.1f, 0.0f, jp_plane_wrap(robot.heading - heading));
}

/* What leaves no room to turn at (5.05, 4.05), known or not. */
static void put_beside_goal(bool is_known)
{
    rig_box(4.7f, 3.4f, 5.4f, 3.6f);
    if (is_known) {
        occupy(4.7f, 3.4f, 5.4f, 3.6f);
        init();
    }
}

/* Some cell of the map's copy about x between y = 3.5 m and 4.5 m. */
static bool is_marked(float x)
{
    const int32_t column = (int32_t)(x * 10.0f + 0.5f);

    for (int32_t i = 0; i < 3 * 10; i++) {
        if (jp_terrain_cell(&mission.internal.marked, column - 1 + i % 3, 35 + i / 3) == JP_CELL_OCCUPIED) {
            return true;
        }
    }
    return false;
}

/* ---- Drives ---- */

static void test_a_goal_straight_on(void)
{
    size_t turns;

    start(4.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_TRUE(planned > 0);
    TEST_ASSERT_TRUE(mission.path_count > 20);
    TEST_ASSERT_TRUE(mission.counts.expansions > 0);
    TEST_ASSERT_NOT_NULL(jp_patrol_mission_grid_path(&mission, &turns));
    TEST_ASSERT_EQUAL_UINT(2, turns);
    drive_until(JP_MISSION_ARRIVED);
    expect_at(4.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_UINT(0, mission.replans);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_ARRIVED, jp_patrol_mission_work(&mission, 50));
}

static void test_a_goal_round_a_corner_with_another_heading(void)
{
    occupy(2.5f, 0.0f, 3.0f, 5.0f);
    rig_box(2.5f, 0.0f, 3.0f, 5.0f);
    init();
    start(4.05f, 3.05f, 1.5f);
    drive_until(JP_MISSION_ARRIVED);
    expect_at(4.05f, 3.05f, 1.5f);
}

static void test_a_goal_on_the_spot(void)
{
    size_t turns = 1;

    start(1.5f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_UINT16(2, mission.path_count);
    TEST_ASSERT_NULL(jp_patrol_mission_grid_path(&mission, &turns));
    TEST_ASSERT_EQUAL_UINT(0, turns);
    drive_until(JP_MISSION_ARRIVED);
}

/* Nearer than a path on the map: straight, with a point every 0.1 m. */
static void test_goals_that_are_near(void)
{
    start(1.64f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_UINT16(3, mission.path_count);
    robot = (struct jp_plane_pose){0.0f, -0.05f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&mission.patrol, &robot));
    start(0.1f, -0.05f, 0.0f);
    TEST_ASSERT_EQUAL_UINT16(2, mission.path_count);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(-0.05), mission.path[1].y);
    /* In the same cell of a coarse map. */
    make_map(JP_Q16(0.5));
    robot = (struct jp_plane_pose){10.1f, 10.1f, 0.0f};
    init();
    start(10.4f, 10.4f, 0.0f);
    TEST_ASSERT_EQUAL_UINT16(6, mission.path_count);
}

static void test_a_goal_with_no_room_to_turn_is_approached(void)
{
    put_beside_goal(true);
    robot = (struct jp_plane_pose){5.05f, 6.05f, -1.5f};
    init();
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_LEG_APPROACH, mission.internal.leg);
    drive_until_leg(JP_LEG_LAST);
    TEST_ASSERT_TRUE(robot.x < 4.6f);
    drive_until(JP_MISSION_ARRIVED);
    expect_at(5.05f, 4.05f, 0.0f);
}

static void test_without_approaches_it_goes_straight_to_the_goal(void)
{
    mission_config.turns_before_goal = false;
    put_beside_goal(true);
    robot = (struct jp_plane_pose){5.05f, 6.05f, -1.5f};
    init();
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_LEG_GOAL, mission.internal.leg);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
}

static void begin_to_pause(void)
{
    put_beside_goal(false);
    robot = (struct jp_plane_pose){5.05f, 7.05f, -1.5f};
    init();
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_LEG_GOAL, mission.internal.leg);
    drive_until_leg(JP_LEG_PAUSE);
}

static void test_what_the_scanner_sees_at_the_goal_changes_the_path(void)
{
    begin_to_pause();
    drive_until_leg(JP_LEG_APPROACH);
    TEST_ASSERT_EQUAL_UINT(0, mission.replans);
    drive_until(JP_MISSION_ARRIVED);
    expect_at(5.05f, 4.05f, 0.0f);
}

static void test_a_goal_that_is_glided_into(void)
{
    mission_config.patrol.strategy = (uint8_t)JP_PATROL_BY_COST;
    init();
    start(5.05f, 4.05f, 1.0f);
    drive_until(JP_MISSION_ARRIVED);
    TEST_ASSERT_EQUAL_INT(JP_LEG_GOAL, mission.internal.leg);
    TEST_ASSERT_EQUAL_UINT32(0, mission.patrol.counts.turns);
    expect_at(5.05f, 4.05f, 1.0f);
}

/* By cost it would rather glide in; when it sees that this is not free, it does not stop to plan anew. */
static void test_a_glide_into_the_goal_that_is_seen_not_to_be_free(void)
{
    mission_config.patrol.strategy = (uint8_t)JP_PATROL_BY_COST;
    put_beside_goal(true);
    robot = (struct jp_plane_pose){5.05f, 7.05f, -1.5f};
    init();
    start(5.05f, 4.05f, -0.35f);
    TEST_ASSERT_EQUAL_INT(JP_LEG_GOAL, mission.internal.leg);
    drive_until_leg(JP_LEG_APPROACH);
    drive_until(JP_MISSION_ARRIVED);
    expect_at(5.05f, 4.05f, -0.35f);
}

static void test_a_hold_by_others_ends_a_pause_too(void)
{
    begin_to_pause();
    jp_patrol_hold(&mission.patrol);
    cycle();
    TEST_ASSERT_EQUAL_INT(JP_LEG_APPROACH, mission.internal.leg);
}

static void test_a_hold_by_others_ends_the_mission(void)
{
    start(5.05f, 4.05f, 0.0f);
    cycles(3);
    jp_patrol_hold(&mission.patrol);
    cycle();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_GIVEN_UP, mission.state);
}

/* ---- Planning anew ---- */

static void test_a_wall_across_the_way_is_gone_round(void)
{
    rig_box(4.0f, 1.5f, 4.2f, 5.5f);
    start(6.05f, 3.05f, 0.0f);
    drive_until(JP_MISSION_ARRIVED);
    TEST_ASSERT_TRUE(mission.replans >= 1);
    expect_at(6.05f, 3.05f, 0.0f);
}

static void test_a_robot_walled_in_gives_up(void)
{
    start(6.05f, 4.05f, 0.0f);
    rig_box(0.7f, 3.3f, 2.3f, 4.8f);
    drive_until(JP_MISSION_GIVEN_UP);
    TEST_ASSERT_EQUAL_UINT(6, mission.replans);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_STOPPED, mission.patrol.state);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_BLOCKED, mission.patrol.reason);
}

static void test_wheels_that_do_not_turn_get_another_path_then_none(void)
{
    mission_config.patrol.waits_max = 5;
    init();
    start(6.05f, 4.05f, 0.0f);
    is_stuck = true;
    drive_until(JP_MISSION_GIVEN_UP);
    TEST_ASSERT_EQUAL_UINT(6, mission.replans);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_STALLED, mission.patrol.reason);
}

static void test_a_robot_off_its_path_gets_one_from_where_it_is(void)
{
    start(6.05f, 2.05f, 0.0f);
    robot = (struct jp_plane_pose){2.05f, 7.05f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&mission.patrol, &robot));
    cycles(2);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_OFF_PATH, mission.patrol.reason);
    cycles(10);
    TEST_ASSERT_EQUAL_UINT(1, mission.replans);
    TEST_ASSERT_TRUE(mission.path[0].y > JP_Q16(6.9));
}

/* It has come nearer to a shelf than any path keeps. */
static void test_a_path_may_begin_beside_a_robot_that_stands_too_near(void)
{
    occupy(0.5f, 4.3f, 3.0f, 4.6f);
    init();
    start(6.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_TRUE(mission.path[0].y < JP_Q16(4.0) && mission.path[0].y > JP_Q16(3.6));
    drive_until(JP_MISSION_ARRIVED);
    occupy(0.5f, 3.5f, 3.0f, 3.8f);
    robot = (struct jp_plane_pose){1.5f, 4.05f, 0.0f};
    init();
    start(6.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_GIVEN_UP, mission.state);
}

/* It stands on a shelf, as far as it knows; the first free cell beside it is in a pocket as wide as itself. */
static void test_from_a_pocket_the_path_begins_elsewhere(void)
{
    occupy(0.5f, 4.0f, 3.0f, 4.1f);
    occupy(0.5f, 2.5f, 1.2f, 4.0f);
    occupy(1.9f, 2.5f, 3.0f, 4.0f);
    occupy(1.2f, 2.5f, 1.9f, 3.0f);
    robot = (struct jp_plane_pose){1.55f, 4.05f, 0.0f};
    mission_config.patrol.teb.footprint.front = 0.45f; /* four cells */
    init();
    start(6.05f, 6.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_TRUE(mission.internal.is_beside);
    TEST_ASSERT_EQUAL_UINT8(1, mission.internal.beside);
    TEST_ASSERT_TRUE(mission.path[0].y > JP_Q16(4.4));
    drive_until(JP_MISSION_ARRIVED);
    expect_at(6.05f, 6.05f, 0.0f);
}

/* No path leads from any cell of a pocket: it does not look for one from all of them. */
static void test_from_a_wide_pocket_it_gives_up(void)
{
    occupy(0.0f, 4.0f, 3.5f, 8.0f);
    occupy(3.0f, 0.0f, 3.5f, 4.0f);
    robot = (struct jp_plane_pose){1.55f, 4.05f, 0.0f};
    mission_config.patrol.teb.footprint.front = 0.45f; /* four cells */
    init();
    start(6.05f, 6.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_GIVEN_UP, mission.state);
    TEST_ASSERT_EQUAL_UINT8(7, mission.internal.beside); /* that were given up before the last */
}

/* Who gets on may be blocked as often as there are things in its way. */
static void test_tries_begin_anew_where_it_has_got_on(void)
{
    start(6.05f, 4.05f, 0.0f);
    mission.internal.tries = 5;
    mission.internal.tried = (struct jp_plane_pose){6.05f, 7.05f, 0.0f};
    rig_box(0.7f, 3.3f, 2.3f, 4.8f);
    drive_until(JP_MISSION_GIVEN_UP);
    TEST_ASSERT_EQUAL_UINT(6, mission.replans);
    TEST_ASSERT_EQUAL_UINT8(6, mission.internal.tries);
}

/* Marks that close every way, and are of nothing. */
static void test_marks_that_leave_no_path_are_forgotten(void)
{
    start(6.05f, 4.05f, 0.0f);
    rig_box(0.7f, 3.3f, 2.3f, 4.8f);
    for (int32_t y = 0; y < SIDE; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&mission.internal.marked, 40, y, JP_CELL_OCCUPIED));
    }
    while (mission.internal.forgets == 0U && mission.replans < 5U) {
        cycle();
    }
    TEST_ASSERT_EQUAL_UINT8(1, mission.internal.forgets);
    TEST_ASSERT_TRUE(mission.internal.is_closed || mission.state == JP_MISSION_UNDER_WAY);
    TEST_ASSERT_FALSE(jp_terrain_cell(&mission.internal.marked, 40, 2) == JP_CELL_OCCUPIED);
    drive_until(JP_MISSION_GIVEN_UP);
    TEST_ASSERT_EQUAL_UINT8(3, mission.internal.forgets);
}

/* Another path does not help it. */
static void test_a_robot_in_a_collision_waits(void)
{
    start(6.05f, 4.05f, 0.0f);
    cycles(2);
    rig_wall(1.4f, 4.0f, 1.6f, 4.1f);
    rig_wall(1.4f, 4.1f, 1.6f, 4.0f);
    is_stuck = true;
    cycles(20);
    TEST_ASSERT_EQUAL_UINT(0, mission.replans);
}

/* On the last leg it waits longer: who stands there may go. */
static void test_the_last_leg_is_waited_for(void)
{
    put_beside_goal(true);
    robot = (struct jp_plane_pose){5.05f, 6.05f, -1.5f};
    init();
    start(5.05f, 4.05f, 0.0f);
    drive_until_leg(JP_LEG_LAST);
    rig_wall(4.9f, 3.3f, 4.9f, 4.7f);

    unsigned waited = 0;

    while (mission.replans == 0U && waited < 60U) {
        cycle();
        waited++;
    }
    TEST_ASSERT_TRUE(waited > 30U && waited < 50U);
}

static void test_a_missing_scan_marks_nothing(void)
{
    start(6.05f, 4.05f, 0.0f);
    rig_box(4.0f, 3.5f, 4.2f, 4.5f);
    is_blind = true;
    cycles(6);
    TEST_ASSERT_FALSE(is_marked(4.0f));
    is_blind = false;
    cycles(6);
    TEST_ASSERT_TRUE(is_marked(4.0f));
}

/* ---- How sure the place is ---- */

/* A wall with a gap of a metre on the straight way, and room round its northern end, if wanted. */
static void put_wall_with_gap(bool has_end)
{
    occupy(3.0f, 0.0f, 3.2f, 3.5f);
    occupy(3.0f, 4.5f, 3.2f, has_end ? 6.0f : 8.0f);
    init();
}

static float highest_of_path(void)
{
    float highest = 0.0f;

    for (unsigned i = 0; i < mission.path_count; i++) {
        const float y = (float)mission.path[i].y / (float)JP_Q16_ONE;

        highest = y > highest ? y : highest;
    }
    return highest;
}

static void plan_when_sure_to(float deviation)
{
    rig_sense();
    input.deviation = deviation;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
}

static void test_a_robot_that_knows_its_place_takes_the_gap(void)
{
    put_wall_with_gap(true);
    plan_when_sure_to(0.003f);
    TEST_ASSERT_TRUE(highest_of_path() < 4.5f);
}

static void test_a_robot_that_is_not_sure_goes_round(void)
{
    put_wall_with_gap(true);
    plan_when_sure_to(0.15f);
    TEST_ASSERT_TRUE(highest_of_path() > 6.0f);
}

static void test_where_there_is_no_other_way_it_takes_the_gap(void)
{
    put_wall_with_gap(false);
    plan_when_sure_to(0.15f);
    TEST_ASSERT_TRUE(highest_of_path() < 4.5f);
}

/* ---- By joules ---- */

/* 25 J electronics and 15 J rolling a metre at 1 m/s. */
static struct jp_four_wheel_energy_model energy;

static void plan_by_joules(float obstacle, float clearance)
{
    energy = (struct jp_four_wheel_energy_model){.wheelbase = JP_Q24(0.5),
                                                 .track = JP_Q24(0.44),
                                                 .weight = JP_Q16(500),
                                                 .rolling = JP_Q24(0.02),
                                                 .driving = JP_Q24(1.5),
                                                 .electronics_power = JP_Q16(25)};
    mission_config.energy = &energy;
    mission_config.patrol.teb.weights.obstacle = obstacle;
    mission_config.patrol.teb.weights.second = 1.0f;
    mission_config.patrol.teb.clearance = clearance;
    init();
    plan_when_sure_to(0.003f);
}

/* 0.9 m wide, so that the robot keeps about 0.15 m in it; and room round the wall's northern end. */
static void put_wall_with_narrow_gap(void)
{
    occupy(3.0f, 0.0f, 3.2f, 3.6f);
    occupy(3.0f, 4.5f, 3.2f, 6.0f);
}

static void test_by_joules_a_gap_is_worth_its_clearance(void)
{
    put_wall_with_narrow_gap();
    plan_by_joules(100.0f, 0.2f);
    TEST_ASSERT_TRUE(highest_of_path() < 4.5f);
    plan_by_joules(100000.0f, 0.2f);
    TEST_ASSERT_TRUE(highest_of_path() > 6.0f);
}

/* 3.6 m between middles of cells, at 40 J each, and 10 W for as many seconds. */
static void test_by_joules_a_path_has_its_price(void)
{
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_NEAR(1e-6f, 0.0f, mission.price);
    mission_config.patrol.price.worth = 10.0f;
    mission_config.patrol.teb.speed_max = 1.0f;
    plan_by_joules(100.0f, 0.2f);
    TEST_ASSERT_NEAR(1.0f, 3.6f * 50.0f, mission.price);
    energy.electronics_power *= 2; /* as it was learned meanwhile */
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_NEAR(1.0f, 3.6f * 75.0f, mission.price);
    start(1.64f, 4.05f, 0.0f);
    TEST_ASSERT_NEAR(1e-6f, 0.0f, mission.price);
}

/* Of the way that was found, as the leg is foretold, J. */
static float foretold(float *seconds)
{
    const struct jp_patrol_plan leg = {.start = mission.patrol.pose,
                                       .path = mission.path,
                                       .path_count = mission.path_count,
                                       .goal = {.pose = mission.internal.goal, .is_heading_free = true},
                                       .tick_rate = 100};
    struct jp_four_wheel_drive drive = {0};

    *seconds = 0.0f;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_plan_energy(&mission.config.patrol, &energy, &leg, &drive, seconds));
    return (float)(int32_t)drive.energy / (float)JP_Q16_ONE;
}

/* Of two ways that begin and end alike the difference is the same by the price and as it is foretold, with its time. */
static void test_by_joules_price_and_forecast_agree(void)
{
    float short_seconds;
    float long_seconds;

    plan_by_joules(100.0f, 0.2f);
    start(4.05f, 4.05f, 0.0f);
    const float short_price = mission.price;
    const float short_energy = foretold(&short_seconds);

    start(7.05f, 4.05f, 0.0f);
    const float price = mission.price - short_price;
    const float driven = foretold(&long_seconds) - short_energy;
    const float time = mission_config.patrol.price.worth * (long_seconds - short_seconds);

    TEST_ASSERT_NEAR(1.0f, price, driven + time);
    TEST_ASSERT_TRUE(driven > 100.0f);
}

/* Nearer than 10 cm it goes only where there is no other way, however long that is. */
static void test_by_joules_no_detour_is_too_long_for_ten_centimetres(void)
{
    occupy(3.0f, 0.0f, 3.2f, 3.7f);
    occupy(3.0f, 4.5f, 3.2f, 7.0f);
    plan_by_joules(0.0f, 0.2f);
    TEST_ASSERT_TRUE(highest_of_path() > 7.0f);
    occupy(3.0f, 7.0f, 3.2f, 8.0f);
    plan_by_joules(0.0f, 0.2f);
    TEST_ASSERT_TRUE(highest_of_path() < 4.5f);
}

static void test_by_joules_a_robot_that_is_not_sure_goes_round(void)
{
    put_wall_with_gap(true);
    plan_by_joules(0.0f, 0.2f);
    plan_when_sure_to(0.15f);
    TEST_ASSERT_TRUE(highest_of_path() > 6.0f);
    put_wall_with_gap(false);
    plan_when_sure_to(0.15f);
    TEST_ASSERT_TRUE(highest_of_path() < 4.5f);
}

/* ---- No path ---- */

static void expect_no_path(float x, float y)
{
    start(x, y, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_GIVEN_UP, mission.state);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_HELD, mission.patrol.state);
    TEST_ASSERT_EQUAL_INT(JP_PATROL_NONE, mission.patrol.reason);
    TEST_ASSERT_EQUAL_UINT16(0, mission.path_count);
}

static void test_goals_without_a_path(void)
{
    occupy(5.0f, 3.0f, 5.1f, 5.1f);
    occupy(7.0f, 3.0f, 7.1f, 5.1f);
    occupy(5.0f, 3.0f, 7.1f, 3.1f);
    occupy(5.0f, 5.0f, 7.1f, 5.1f);
    init();
    expect_no_path(6.05f, 4.05f);
    expect_no_path(20.0f, 4.05f);
}

static void test_by_joules_goals_without_a_path(void)
{
    plan_by_joules(0.0f, 0.2f);
    test_goals_without_a_path();
}

/* It is learned to be what has no price. */
static void test_without_a_price_there_is_no_path(void)
{
    mission_config.patrol.teb.speed_max = 0.004f;
    plan_by_joules(0.0f, 0.2f);
    energy.electronics_power = JP_Q16(1024);
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_GIVEN_UP, mission.state);
}

static void test_paths_that_do_not_fit(void)
{
    mission_config.points_max = 10;
    init();
    expect_no_path(6.05f, 4.05f);
    mission_config.points_max = 2;
    init();
    expect_no_path(1.64f, 4.05f);
    mission_config.points_max = POINTS_MAX;
    mission_config.turns_max = 2;
    occupy(2.5f, 0.0f, 3.0f, 5.0f);
    init();
    expect_no_path(4.05f, 3.05f);
}

static void test_a_planner_without_memory_finds_no_path(void)
{
    init();
    mission.internal.grid_size = 0;
    expect_no_path(6.05f, 4.05f);
}

/* The path ends in the middle of a cell. */
static void test_paths_that_the_patrol_does_not_take(void)
{
    mission_config.patrol.position_tolerance = 0.01f;
    init();
    expect_no_path(6.02f, 4.02f);
}

/* The way to the approach fits, the last leg does not. */
static void test_a_last_leg_that_does_not_fit(void)
{
    mission_config.points_max = 5;
    put_beside_goal(true);
    robot = (struct jp_plane_pose){4.25f, 4.05f, 0.0f};
    init();
    start(5.05f, 4.05f, 0.0f);
    drive_until(JP_MISSION_GIVEN_UP);
    TEST_ASSERT_EQUAL_INT(JP_LEG_LAST, mission.internal.leg);
}

/* ---- Slices ---- */

static void test_a_cycle_while_it_plans(void)
{
    const struct jp_plane_pose goal = {6.05f, 4.05f, 0.0f};

    rig_box(3.0f, 3.5f, 3.2f, 4.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_start(&mission, &goal));
    for (int i = 0; i < 7; i++) {
        rig_sense();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
        rig_expect_stand();
        TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, jp_patrol_mission_work(&mission, 1));
        TEST_ASSERT_FALSE(is_marked(3.0f));
    }
    work();
    /* What was left out is made up for. */
    cycle();
    TEST_ASSERT_TRUE(is_marked(3.0f));
}

/* The cycle that is to watch the goal sees a box. */
static void see_box(unsigned slices, unsigned expansions)
{
    const struct jp_plane_pose goal = {6.05f, 4.05f, 0.0f};

    init();
    rig_box(3.0f, 3.5f, 3.2f, 4.5f);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_start(&mission, &goal));
    while (jp_patrol_mission_work(&mission, 1000) == JP_MISSION_PLANNING) {
    }
    while (mission.internal.marks == JP_MARKS_NONE) {
        rig_sense();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    }
    for (unsigned i = 0; i < slices; i++) {
        (void)jp_patrol_mission_work(&mission, expansions);
    }
}

static void test_a_scan_is_marked_in_slices(void)
{
    see_box(RIG_BEAMS / 3U - 1U, 8);
    TEST_ASSERT_EQUAL_INT(JP_MARKS_WATCH, mission.internal.marks);
    TEST_ASSERT_FALSE(is_marked(3.0f));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, jp_patrol_mission_work(&mission, 8));
    TEST_ASSERT_EQUAL_INT(JP_MARKS_NONE, mission.internal.marks);
    TEST_ASSERT_TRUE(is_marked(3.0f));
}

/* What of a scan is left when the next one comes is seen by that. */
static void test_the_next_scan_is_marked_where_the_last_one_is_not(void)
{
    see_box(RIG_BEAMS / 6U, 8);
    is_blind = true;
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    is_blind = false;
    TEST_ASSERT_NOT_NULL(mission.internal.scan.ranges);
    rig_box(2.8f, 3.5f, 2.9f, 4.5f);
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_MARKS_WATCH, mission.internal.marks);
    (void)jp_patrol_mission_work(&mission, 2U * RIG_BEAMS);
    TEST_ASSERT_EQUAL_INT(JP_MARKS_NONE, mission.internal.marks);
    TEST_ASSERT_TRUE(is_marked(2.8f));
    TEST_ASSERT_FALSE(is_marked(3.1f));
}

static void test_who_stops_or_has_another_goal_marks_nothing(void)
{
    const struct jp_plane_pose goal = {6.05f, 4.05f, 0.0f};

    see_box(1, 8);
    jp_patrol_mission_stop(&mission);
    TEST_ASSERT_EQUAL_INT(JP_MARKS_NONE, mission.internal.marks);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_IDLE, jp_patrol_mission_work(&mission, 1000));
    wall_count = 0;
    see_box(1, 8);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_start(&mission, &goal));
    TEST_ASSERT_EQUAL_INT(JP_MARKS_NONE, mission.internal.marks);
    TEST_ASSERT_FALSE(is_marked(3.0f));
}

/* Bit by bit. */
static void test_a_path_is_the_same_however_it_is_sliced(void)
{
    static const unsigned slices[] = {1, 7, 100000};
    static struct jp_point first[RIG_POINTS_MAX];
    uint16_t count = 0;

    for (unsigned i = 0; i < 3U; i++) {
        const struct jp_plane_pose goal = {6.05f, 4.05f, 2.0f};

        occupy(3.0f, 0.0f, 3.2f, 3.9f);
        occupy(4.5f, 3.0f, 4.7f, 8.0f);
        init();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_start(&mission, &goal));
        while (jp_patrol_mission_work(&mission, slices[i]) == JP_MISSION_PLANNING) {
        }
        TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
        if (i == 0U) {
            count = mission.path_count;
            TEST_ASSERT_TRUE(count > 10U && count <= RIG_POINTS_MAX);
            memcpy(first, mission.path, count * sizeof first[0]);
        }
        TEST_ASSERT_EQUAL_UINT16(count, mission.path_count);
        TEST_ASSERT_EQUAL_MEMORY(first, mission.path, count * sizeof first[0]);
    }
}

static void test_an_idle_mission_stands(void)
{
    cycles(6);
    rig_expect_stand();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_IDLE, mission.state);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_IDLE, jp_patrol_mission_work(&mission, 1));
}

/* ---- What is refused ---- */

static void expect_field(const char *expected)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG,
                          jp_patrol_mission_init(&mission, &mission_config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    setUp();
}

static void test_configurations_out_of_range(void)
{
    mission_config.patrol.horizon = 0.0f;
    expect_field("horizon");
    mission_config.map = NULL;
    expect_field("map");
    mission_config.points_max = 1;
    expect_field("points_max");
    mission_config.turns_max = 1;
    expect_field("turns_max");
    energy = (struct jp_four_wheel_energy_model){0};
    mission_config.energy = &energy;
    expect_field("energy");
    plan_by_joules(0.0f, 0.2f);
    mission_config.patrol.teb.speed_max = 16.0f;
    expect_field("energy");
    make_map(JP_Q16(0.01));
    expect_field("teb.footprint");
    make_map(JP_Q16(52));
    TEST_ASSERT_EQUAL_UINT(0, jp_patrol_mission_size(&mission_config));
    expect_field("map");
}

static void test_fewest_and_most_points_and_turns(void)
{
    const char *field = "";

    mission_config.points_max = 2;
    mission_config.turns_max = 2;
    init();
    mission_config.points_max = UINT16_MAX; /* in range, but not in the block */
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY,
                          jp_patrol_mission_init(&mission, &mission_config, block, sizeof block, &field));
    mission_config.points_max = 2;
    mission_config.turns_max = UINT16_MAX;
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY,
                          jp_patrol_mission_init(&mission, &mission_config, block, sizeof block, &field));
}

static void test_blocks_that_do_not_do(void)
{
    const size_t size = jp_patrol_mission_size(&mission_config);
    const char *field;

    TEST_ASSERT_TRUE(size <= sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_init(&mission, &mission_config, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_patrol_mission_init(&mission, &mission_config, block, size - 1U, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT,
                          jp_patrol_mission_init(&mission, &mission_config, (char *)block + 4, size, &field));
}

static void test_arguments_that_are_refused(void)
{
    const struct jp_plane_pose far = {40000.0f, 0.0f, 0.0f};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_init(NULL, &mission_config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_init(&mission, NULL, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT,
                          jp_patrol_mission_init(&mission, &mission_config, NULL, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT,
                          jp_patrol_mission_init(&mission, &mission_config, block, sizeof block, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_start(NULL, &robot));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_start(&mission, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_start(&mission, &far));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_cycle(NULL, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_patrol_mission_cycle(&mission, NULL, &twist));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_IDLE, mission.state);
}

/* ---- A localiser ---- */

/* The robot was carried: it plans from there. */
static void test_from_a_new_place_it_plans_anew(void)
{
    start(4.05f, 4.05f, 0.0f);
    cycles(3);
    robot = (struct jp_plane_pose){2.5f, 6.05f, 0.0f};
    rig_sense();
    input.is_lost = true;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_PATROL_WAITING, mission.patrol.state);
    rig_sense();
    input.is_lost = false;
    input.is_new_place = true;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    input.is_new_place = false;
    work();
    drive_until(JP_MISSION_ARRIVED);
    expect_at(4.05f, 4.05f, 0.0f);
    rig_sense();
    input.is_new_place = true;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_ARRIVED, mission.state);
}

/* They were made from where it was not. */
static void test_from_a_new_place_marks_are_forgotten(void)
{
    start(6.05f, 4.05f, 0.0f);
    rig_wall(2.9f, 2.0f, 2.9f, 6.0f);
    cycles(6);
    TEST_ASSERT_TRUE(is_marked(2.9f));
    wall_count = 0;
    rig_sense();
    input.is_new_place = true;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    /* In slices, from the north, before a path is looked for. */
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, jp_patrol_mission_work(&mission, 1));
    TEST_ASSERT_TRUE(is_marked(2.9f));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, jp_patrol_mission_work(&mission, 1000));
    TEST_ASSERT_FALSE(is_marked(2.9f));
    TEST_ASSERT_FALSE(mission.internal.is_searching);
    TEST_ASSERT_EQUAL_UINT16(0, mission.internal.rows_stale);
}

/* What it sees while it does not know where it is marks nothing. */
static void test_a_robot_that_is_lost_marks_nothing(void)
{
    start(4.05f, 4.05f, 0.0f);
    rig_wall(2.5f, 2.0f, 2.5f, 6.0f);
    for (int i = 0; i < 20; i++) {
        rig_sense();
        input.is_lost = true;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    }
    TEST_ASSERT_FALSE(is_marked(2.5f));
}

/* ---- Around people who walk to and fro ---- */

/* Across the direct way from a goal ahead, with room only far to the south of it. */
static void tread_across(float from)
{
    for (unsigned i = 0; i < 30U; i++) {
        mission.patrol.internal.trodden[i] = (struct jp_patrol_trodden){{4.2f, from + 0.2f * (float)i}, 0.25f, 0.0f};
    }
}

/* In each cycle somebody is there for whom it stands, who is on the way that it has. */
static void stand_for_somebody(float waited)
{
    mission.patrol.internal.yielded = waited;
    mission.patrol.movers.count = 1;
    mission.patrol.movers.movers[0] = (struct jp_mover){.centre = {mission.patrol.pose.x + 1.2f, 4.05f},
                                                        .velocity = {-0.5f, 0.0f},
                                                        .walk = {-1.0f, 0.0f},
                                                        .radius = 0.25f,
                                                        .largest = 0.25f,
                                                        .speed_variance = 1.0e-4f,
                                                        .pace = 0.5f,
                                                        .sightings = 20};
    rig_sense();
    input.speed = (struct jp_plane_speed){0.0f, 0.0f};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
}

static float southernmost(void)
{
    float least = 100.0f;

    for (uint16_t i = 0; i < mission.path_count; i++) {
        least = jp_plane_smaller(least, (float)mission.path[i].y / (float)JP_Q16_ONE);
    }
    return least;
}

static void begin_among_people(void)
{
    make_map(JP_Q16(0.1));
    occupy(0.0f, 0.0f, 8.0f, 0.2f);
    init();
    start(7.0f, 4.05f, 0.0f);
    tread_across(2.4f);
}

static void test_robot_goes_around_where_people_walk(void)
{
    begin_among_people();
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    work();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_TRUE(southernmost() < 2.4f - 0.25f - config.people.clearance - config.teb.footprint.half_width);
    TEST_ASSERT_EQUAL_UINT(0, mission.replans);
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, jp_terrain_cell(&mission.internal.marked, 42, 60));
}

static void test_who_has_hardly_waited_does_not(void)
{
    begin_among_people();
    stand_for_somebody(2.5f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    stand_for_somebody(3.1f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
}

static void test_on_its_way_to_an_approach_it_goes_around_people_too(void)
{
    begin_among_people();
    mission.internal.leg = JP_LEG_APPROACH;
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
}

/* Driving, on the straight way into the goal, on the way to a halt, and near its target. */
static void test_when_it_does_not_go_around_people(void)
{
    begin_among_people();
    mission.patrol.internal.yielded = 20.0f;
    cycle();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    mission.internal.leg = JP_LEG_LAST;
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    mission.internal.leg = JP_LEG_PAUSE;
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    mission.internal.leg = JP_LEG_GOAL;
    mission.internal.target = mission.patrol.pose;
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
}

/* It takes longer than what has been waited, and is asked for again only after half as long again. */
static void test_a_way_around_that_takes_longer_than_the_wait_is_not_taken(void)
{
    begin_among_people();
    tread_across(1.6f);
    stand_for_somebody(3.2f);
    work();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_TRUE(southernmost() > 3.5f);
    stand_for_somebody(4.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    work();
    TEST_ASSERT_TRUE(southernmost() < 1.4f);
}

/* Where there is no room for the clearance from people, without it. */
static void test_around_people_with_less_clearance(void)
{
    begin_among_people();
    tread_across(1.4f);
    stand_for_somebody(60.0f);
    work();
    TEST_ASSERT_TRUE(southernmost() < 1.0f);
}

static void test_no_way_around_people(void)
{
    begin_among_people();
    tread_across(0.4f);
    for (unsigned i = 30; i < 60U; i++) {
        mission.patrol.internal.trodden[i] = (struct jp_patrol_trodden){{4.2f, 0.4f + 0.2f * (float)i}, 0.25f, 0.0f};
    }
    stand_for_somebody(60.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    work();
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
    TEST_ASSERT_TRUE(southernmost() > 3.5f);
    TEST_ASSERT_FALSE(mission.internal.is_detour);
}

/* A new goal while a way around is looked for: what was marked for it is gone. */
static void test_a_new_goal_ends_the_search_around_people(void)
{
    begin_among_people();
    stand_for_somebody(20.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, jp_patrol_mission_work(&mission, 4U * RIG_BEAMS));
    TEST_ASSERT_EQUAL_INT(JP_CELL_OCCUPIED, jp_terrain_cell(&mission.internal.marked, 42, 60));
    start(7.0f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, jp_terrain_cell(&mission.internal.marked, 42, 60));
    TEST_ASSERT_TRUE(southernmost() > 3.5f);
}
