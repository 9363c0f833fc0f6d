/* The same ways, lengths, prices, expansions and smooth curves on every core: a hash over the scenes, equal to a known
 * one. */
#include <joulepath/path_spline.h>
#include <joulepath/tables.h>

#include "tests/support/bits_hash.h"
#include "tests/support/scene.h"
#include "unity.h"

enum {
    BLOCK = 880 * 1024, /* of a scene */
    SCRATCH = 64 * 1024,
    POINTS_MAX = 4096,
    SLICE = 64,
    TUBE = 8,
};

static uint64_t map_block[(SCENE_TERRAIN_SIZE + 7) / 8];
static uint64_t block[BLOCK / 8];
static uint64_t scratch[SCRATCH / 8];
static struct jp_point smooth[POINTS_MAX];
static struct jp_terrain terrain;
static struct jp_grid_planner planner;

static void mix_points(const struct jp_point *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        mix((uint32_t)points[i].x);
        mix((uint32_t)points[i].y);
    }
}

static void mix_way(void)
{
    size_t count = 0;
    size_t smooth_count = 0;
    const struct jp_point *way = jp_grid_planner_path(&planner, &count);
    const struct jp_grid_counts *counts = jp_grid_planner_statistics(&planner);

    TEST_ASSERT_NOT_NULL(way);
    mix_points(way, count);
    mix(counts->expansions);
    mix(counts->edge_nodes);
    mix(counts->queue_most);
    mix((uint32_t)counts->octile_length);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_spline(&planner, way, count, SCENE_RESOLUTION, scratch, sizeof scratch, smooth,
                                                POINTS_MAX, &smooth_count));
    mix_points(smooth, smooth_count);
}

static void plan_scene(uint32_t seed, enum jp_grid_method method, jp_q16 clearance, const struct jp_grid_prices *prices)
{
    const struct jp_grid_planner_config config = {
        .method = method, .clearance = clearance, .tube = TUBE, .prices = prices};
    struct scene_task task;
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &scene_terrain_config, map_block, sizeof map_block, &field));
    scene_generate(seed, &terrain, &task);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_init(&planner, &config, &terrain, block, sizeof block, &field));
    const struct jp_grid_cell start = {(int16_t)task.start.x, (int16_t)task.start.y};
    const struct jp_grid_cell goal = {(int16_t)task.goal.x, (int16_t)task.goal.y};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_planner_start(&planner, &start, &goal));
    enum jp_grid_answer answer = JP_GRID_SEARCHING;
    while (answer == JP_GRID_SEARCHING) {
        answer = jp_grid_planner_work(&planner, SLICE);
    }
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, answer);
    mix_way();
    if (prices != NULL) {
        mix((uint32_t)jp_grid_planner_price(&planner));
    }
}

static void test_octile(void)
{
    plan_scene(1, JP_GRID_OCTILE, 0, NULL);
    plan_scene(2, JP_GRID_JUMP_POINTS, JP_Q16(0.5), NULL);
    TEST_ASSERT_EQUAL_HEX32(0x663919DB, hash);
}

static void test_any_angle(void)
{
    plan_scene(1, JP_GRID_ANY_ANGLE, 0, NULL);
    plan_scene(3, JP_GRID_ANY_ANGLE, JP_Q16(0.5), NULL);
    TEST_ASSERT_EQUAL_HEX32(0x0E4DE50A, hash);
}

/* Over hills, by a robot for which the ground beside things is dear. */
static void test_by_joules(void)
{
    struct jp_grid_prices prices;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_grid_prices_set(&jp_four_wheel_energy_patrol, JP_Q24(0.9), JP_Q16(10), &prices));
    prices.ring = SCENE_RESOLUTION;
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        prices.near[i] = JP_Q16(200) >> i;
    }
    plan_scene(1, JP_GRID_OCTILE, 0, &prices);
    plan_scene(2, JP_GRID_ANY_ANGLE, JP_Q16(0.5), &prices);
    plan_scene(3, JP_GRID_ANY_ANGLE, 0, &prices);
    TEST_ASSERT_EQUAL_HEX32(0xD19FBFF1, hash);
}
