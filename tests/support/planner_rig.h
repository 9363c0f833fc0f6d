/** A planner on a map of 16 × 9 cells, for the tests of its parts. */
#ifndef JOULEPATH_TESTS_SUPPORT_PLANNER_RIG_H
#define JOULEPATH_TESTS_SUPPORT_PLANNER_RIG_H

#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <string.h>

#include "tests/support/level_map.h"
#include "unity.h"

enum {
    WIDTH = 16,
    HEIGHT = 9, /* the robot, 7 cells across, can be in three rows of them */
    HEIGHT_MAX = 16,
    BLOCK_BYTES = 8 * 1024,
    STEPS = 8,          /* from west to east */
    AXIS_COST = 224,    /* of a level step along an axis, physical */
    BUDGET_MAX = 20000, /* expansions after which a planner hangs */
    SPARE = 8
};

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static const struct jp_lattice_pose west = {4, 4, 0};
static const struct jp_goal east = {12, 4, 1};

static struct jp_terrain_config map;
static struct jp_planner_config config;
static struct jp_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];

static inline void rig_reset(void)
{
    map = (struct jp_terrain_config){
        .width = WIDTH, .height = HEIGHT, .resolution = lattice->resolution, .has_elevation = true};
    config = (struct jp_planner_config){
        .lattice = lattice, .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(2), JP_EPSILON_ONE}};
    memset(block, 0x5A, sizeof block);
    make_level_map(&map);
}

/** With more states than the block holds. */
static inline void make_large_map(void)
{
    map.height = HEIGHT_MAX;
    make_level_map(&map);
}

static inline enum jp_status init(size_t size, const char **field)
{
    return jp_planner_init(&planner, &config, &terrain, block, size, field);
}

static inline void start_planner(size_t size)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, init(size, &field));
    TEST_ASSERT_NULL(field);
}

static inline void go(const struct jp_lattice_pose *from, const struct jp_goal *to)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, from));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, to));
}

/** With all of the block, from west to east. */
static inline void begin(void)
{
    start_planner(sizeof block);
    go(&west, &east);
}

static inline enum jp_answer finish(void)
{
    for (int i = 0; !jp_planner_is_idle(&planner); i++) {
        TEST_ASSERT_TRUE(i < BUDGET_MAX);
        (void)jp_planner_work(&planner, 1);
    }
    return jp_planner_work(&planner, 1);
}

static inline void occupy(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cell(&planner, x, y, JP_CELL_OCCUPIED));
}

static inline void release(int32_t x, int32_t y)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cell(&planner, x, y, JP_CELL_FREE));
}

static inline void raise(int32_t x, int32_t y, jp_elevation elevation)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_elevation(&planner, x, y, elevation));
}

/** The plan's steps lead from its start to its end over free cells, at its cost. */
static inline void expect_drivable(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_lattice_pose pose = plan->start;
    jp_cost cost = 0;

    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *primitive = jp_planner_step(&planner, i, &pose);
        TEST_ASSERT_NOT_NULL(primitive);
        TEST_ASSERT_EQUAL_INT(from.heading, primitive->start);
        const jp_cost step = jp_lattice_cost(lattice, config.cost, &terrain, primitive, from.x, from.y);
        TEST_ASSERT_TRUE(step < JP_COST_MAX);
        cost += step;
    }
    TEST_ASSERT_EQUAL_UINT32(plan->cost, cost);
    TEST_ASSERT_EQUAL_INT(plan->end.x, pose.x);
    TEST_ASSERT_EQUAL_INT(plan->end.y, pose.y);
    TEST_ASSERT_EQUAL_INT(plan->end.heading, pose.heading);
}

static inline void expect_optimal(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);

    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, finish());
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_OPTIMAL, plan->answer);
    TEST_ASSERT_EQUAL_UINT32(JP_EPSILON_ONE, plan->bound);
    TEST_ASSERT_EQUAL_UINT32(0, plan->cost_left);
    expect_drivable();
}

/** The lattice with level driving twice as dear. */
static inline struct jp_lattice dearer_driving(void)
{
    struct jp_lattice dearer = *lattice;

    for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
        dearer.move_costs[JP_COST_PHYSICAL][move].climb.constant *= 2;
    }
    dearer.version = 3;
    return dearer;
}

/** What the planner has found after changes is what one finds that begins anew. */
static inline void expect_as_if_new(void)
{
    const enum jp_answer answer = finish();
    const jp_cost cost = jp_planner_plan(&planner)->cost;

    if (answer != JP_ANSWER_UNREACHABLE) {
        expect_optimal();
    }
    jp_planner_restart(&planner);
    TEST_ASSERT_EQUAL_INT(answer, finish());
    TEST_ASSERT_EQUAL_UINT32(cost, jp_planner_plan(&planner)->cost);
}

static inline void expect_start(enum jp_status status, int16_t x, int16_t y, uint8_t heading)
{
    const struct jp_lattice_pose pose = {x, y, heading};

    TEST_ASSERT_EQUAL_INT(status, jp_planner_set_start(&planner, &pose));
}

static inline void wall(bool built)
{
    for (int32_t y = 0; y < map.height; y++) {
        if (built) {
            occupy(7, y);
        } else {
            release(7, y);
        }
    }
}

#endif
