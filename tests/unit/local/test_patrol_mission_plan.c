/* Paths of missions: through gaps by how sure the place is, by joules, and none. */
#include <joulepath/patrol_forecast.h>

#include "tests/support/patrol_mission_rig.h"

void setUp(void)
{
    mission_rig_start();
}

void tearDown(void)
{
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
