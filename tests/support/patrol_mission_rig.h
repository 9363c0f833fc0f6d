/** Missions of the patrol robot of patrol_rig.h on a small map: told where to go, worked and driven cycle by cycle. */
#ifndef JOULEPATH_TESTS_SUPPORT_PATROL_MISSION_RIG_H
#define JOULEPATH_TESTS_SUPPORT_PATROL_MISSION_RIG_H

#include <joulepath/patrol_mission.h>

#include "tests/support/patrol_rig.h"

enum { SIDE = 80, POINTS_MAX = 200, TURNS_MAX = 20, BLOCK_SIZE = 90000, CYCLES_MAX = 400 };

static struct jp_terrain map;
static uint64_t map_block[2 * SIDE * SIDE / 64 + 2 * SIDE];
static struct jp_patrol_mission_config mission_config;
static struct jp_patrol_mission mission;
static uint64_t block[BLOCK_SIZE / sizeof(uint64_t)];
static unsigned planned; /* calls of jp_patrol_mission_work() that had something to do */

static inline void make_map(jp_q16 resolution)
{
    const struct jp_terrain_config terrain = {
        .width = SIDE, .height = SIDE, .resolution = resolution, .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &terrain, map_block, sizeof map_block, &field));
}

static inline void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_init(&mission, &mission_config, block, sizeof block, &field));
    TEST_ASSERT_NULL(field);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_set_pose(&mission.patrol, &robot));
}

/** Of each test's setUp(). */
static inline void mission_rig_start(void)
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

static inline void occupy(float left, float bottom, float right, float top)
{
    for (int y = (int)(bottom * 10.0f + 0.5f); y < (int)(top * 10.0f + 0.5f); y++) {
        for (int x = (int)(left * 10.0f + 0.5f); x < (int)(right * 10.0f + 0.5f); x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, JP_CELL_OCCUPIED));
        }
    }
}

/* As much as there is time for between two cycles, and until there is a path. */
static inline void work(void)
{
    for (unsigned i = 0; i < 15U || mission.state == JP_MISSION_PLANNING; i++) {
        planned += jp_patrol_mission_work(&mission, 50) == JP_MISSION_PLANNING ? 1U : 0U;
    }
}

static inline void start(float x, float y, float heading)
{
    const struct jp_plane_pose goal = {x, y, heading};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_start(&mission, &goal));
    TEST_ASSERT_EQUAL_INT(JP_MISSION_PLANNING, mission.state);
    work();
}

static inline void cycle(void)
{
    rig_sense();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    work();
    rig_move();
}

static inline void cycles(unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        cycle();
    }
}

static inline void drive_until(enum jp_patrol_mission_state state)
{
    for (unsigned i = 0; i < CYCLES_MAX && mission.state != state; i++) {
        cycle();
    }
    TEST_ASSERT_EQUAL_INT(state, mission.state);
}

static inline void drive_until_leg(enum jp_patrol_leg leg)
{
    for (unsigned i = 0; i < CYCLES_MAX && mission.internal.leg != leg; i++) {
        cycle();
    }
    TEST_ASSERT_EQUAL_INT(leg, mission.internal.leg);
}

static inline void expect_at(float x, float y, float heading)
{
    TEST_ASSERT_NEAR(0.1f, x, robot.x);
    TEST_ASSERT_NEAR(0.1f, y, robot.y);
    TEST_ASSERT_NEAR(0.1f, 0.0f, jp_plane_wrap(robot.heading - heading));
}

/* What leaves no room to turn at (5.05, 4.05), known or not. */
static inline void put_beside_goal(bool is_known)
{
    rig_box(4.7f, 3.4f, 5.4f, 3.6f);
    if (is_known) {
        occupy(4.7f, 3.4f, 5.4f, 3.6f);
        init();
    }
}

/* Some cell of the map's copy about x between y = 3.5 m and 4.5 m. */
static inline bool is_marked(float x)
{
    const int32_t column = (int32_t)(x * 10.0f + 0.5f);

    for (int32_t i = 0; i < 3 * 10; i++) {
        if (jp_terrain_cell(&mission.internal.marked, column - 1 + i % 3, 35 + i / 3) == JP_CELL_OCCUPIED) {
            return true;
        }
    }
    return false;
}

static inline void plan_when_sure_to(float deviation)
{
    rig_sense();
    input.deviation = deviation;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_patrol_mission_cycle(&mission, &input, &twist));
    start(5.05f, 4.05f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_MISSION_UNDER_WAY, mission.state);
}

/* 25 J electronics and 15 J rolling a metre at 1 m/s. */
static struct jp_four_wheel_energy_model energy;

static inline void plan_by_joules(float obstacle, float clearance)
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

#endif
