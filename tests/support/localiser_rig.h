/** A robot in a room of cells that its scanner sees, for the tests of the localiser. */
#ifndef JOULEPATH_TESTS_SUPPORT_LOCALISER_RIG_H
#define JOULEPATH_TESTS_SUPPORT_LOCALISER_RIG_H

#include <joulepath/localiser.h>
#include <string.h>

#include "src/base/plane.h"
#include "tests/support/near.h"

enum { RIG_WIDTH = 70, RIG_HEIGHT = 60, RIG_BEAMS = 120, RIG_CELLS = RIG_WIDTH * RIG_HEIGHT };

#define RIG_RANGE 5.0f
#define RIG_STEP  0.02f /* along a beam, m */

static struct jp_terrain map;
static uint64_t map_block[RIG_HEIGHT * 4];
static struct jp_localiser localiser;
static struct jp_localiser_config config;
static uint64_t block[(RIG_CELLS + RIG_HEIGHT + 8 * JP_LOCALISER_POINTS_MAX) / 8 + 2];
static struct jp_localiser_input input;
static float ranges[RIG_BEAMS];
static struct jp_plane_pose robot; /* true */
static float person;               /* beams below this bearing from the robot's back end at 0.6 m, rad; 0: none do */

static inline void rig_fill(int x0, int y0, int x1, int y1, enum jp_cell cell)
{
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, cell));
        }
    }
}

static inline void rig_map(void)
{
    const struct jp_terrain_config terrain = {.width = RIG_WIDTH, .height = RIG_HEIGHT, .resolution = JP_Q16(0.1)};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &terrain, map_block, sizeof map_block, &field));
    rig_fill(0, 0, RIG_WIDTH, RIG_HEIGHT, JP_CELL_FREE);
}

/** A wall around 6.6 m × 5.6 m, a cupboard, a column, a wall with a door. */
static inline void rig_room(void)
{
    rig_map();
    rig_fill(0, 0, RIG_WIDTH, 2, JP_CELL_OCCUPIED);
    rig_fill(0, RIG_HEIGHT - 2, RIG_WIDTH, RIG_HEIGHT, JP_CELL_OCCUPIED);
    rig_fill(0, 0, 2, RIG_HEIGHT, JP_CELL_OCCUPIED);
    rig_fill(RIG_WIDTH - 2, 0, RIG_WIDTH, RIG_HEIGHT, JP_CELL_OCCUPIED);
    rig_fill(50, 2, 60, 9, JP_CELL_OCCUPIED);
    rig_fill(12, 40, 16, 44, JP_CELL_OCCUPIED);
    rig_fill(44, 30, 46, 58, JP_CELL_OCCUPIED);
}

static inline struct jp_localiser_config rig_config(void)
{
    return (struct jp_localiser_config){.map = &map,
                                        .range_max = RIG_RANGE,
                                        .noise = 0.02f,
                                        .wheels = {0.1f, 0.1f, 0.02f},
                                        .start_distance = 0.1f,
                                        .start_turn = 0.05f,
                                        .lost_distance = 0.5f,
                                        .lost_turn = 0.4f};
}

static inline void rig_init(void)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_init(&localiser, &config, block, sizeof block, &field));
}

static inline void rig_reset(void)
{
    rig_room();
    config = rig_config();
    input = (struct jp_localiser_input){.wheels = {5.0f, 5.0f, 1.0f}};
    robot = (struct jp_plane_pose){3.0f, 2.0f, 0.3f};
    person = 0.0f;
    rig_init();
}

static inline float rig_ray(float bearing)
{
    const struct jp_plane_point along = jp_plane_direction(bearing);
    float way = 0.0f;

    while (way < RIG_RANGE) {
        const float x = 10.0f * (robot.x + way * along.x);
        const float y = 10.0f * (robot.y + way * along.y);

        if (x < 0.0f || y < 0.0f || jp_terrain_cell(&map, (int32_t)x, (int32_t)y) == JP_CELL_OCCUPIED) {
            return way - 0.5f * RIG_STEP;
        }
        way += RIG_STEP;
    }
    return 0.0f;
}

static inline void rig_scan(void)
{
    input.scan = (struct jp_scan){ranges, RIG_BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / RIG_BEAMS};
    for (int i = 0; i < RIG_BEAMS; i++) {
        const float bearing = input.scan.first_angle + (float)i * input.scan.angle_step;

        ranges[i] = bearing < person - JP_PLANE_PI ? 0.6f : rig_ray(jp_plane_wrap(robot.heading + bearing));
    }
}

static inline void rig_update(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_update(&localiser, &input));
}

/** Takes a scan and has it worked on. */
static inline void rig_look(void)
{
    rig_scan();
    rig_update();
}

static inline void rig_search(void)
{
    while (jp_localiser_work(&localiser, 500)) {
    }
}

/** Drives on; the wheels tell of `share` of the way and the turn. */
static inline void rig_drive(float way, float turn, float share)
{
    const struct jp_plane_pose motion = {way, 0.0f, turn};
    const struct jp_plane_pose told = {share * way, 0.0f, share * turn};

    robot = jp_plane_compose(&robot, &motion);
    input.wheels = jp_plane_compose(&input.wheels, &told);
}

static inline void rig_expect(enum jp_localiser_state state, enum jp_localiser_reason reason)
{
    TEST_ASSERT_EQUAL_INT(state, localiser.state);
    TEST_ASSERT_EQUAL_INT(reason, localiser.reason);
}

static inline void rig_expect_pose(float distance, float turn)
{
    TEST_ASSERT_NEAR(distance, robot.x, localiser.pose.x);
    TEST_ASSERT_NEAR(distance, robot.y, localiser.pose.y);
    TEST_ASSERT_NEAR(turn, 0.0f, jp_plane_wrap(robot.heading - localiser.pose.heading));
}

/** Starts where the robot is, and tracks. */
static inline void rig_start(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_localiser_start(&localiser, &robot));
    rig_look();
    rig_search();
    rig_look();
    rig_expect(JP_LOCALISER_TRACKING, JP_LOCALISER_NONE);
}

#endif
