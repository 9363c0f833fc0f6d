/* Missions that go around where people walk to and fro. */
#include "tests/support/patrol_mission_rig.h"

void setUp(void)
{
    mission_rig_start();
}

void tearDown(void)
{
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
