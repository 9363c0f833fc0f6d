/* Missions on small maps: goals straight on, approached, seen to be blocked on the way, planned anew, given up; work
 * in slices, a localiser; and what is refused. */
#include "tests/support/patrol_mission_rig.h"

void setUp(void)
{
    mission_rig_start();
}

void tearDown(void)
{
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
