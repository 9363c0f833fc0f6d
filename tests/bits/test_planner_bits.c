/* The same route, cost and expansions on every core: a hash over whole plans and replans, equal to a known one. */
#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <joulepath/tariff.h>
#include <string.h>

#include "tests/support/bits_hash.h"
#include "tests/support/scene.h"
#include "unity.h"

enum {
    SMALL_BLOCK = 256 * 1024,
    LARGE_BLOCK = 3000 * 1024, /* holds the energy field */
    SLICE = 32,
    CHANGES = 8,
    AHEAD = 10, /* primitives from the robot to a change */
    SQUARE = 3, /* cells that change together */
    PRIMITIVES_MAX = 144,
};

static uint64_t map_block[(SCENE_TERRAIN_SIZE + 7) / 8];
static uint64_t block[LARGE_BLOCK / 8];
static struct jp_terrain terrain;
static struct jp_planner planner;
static struct scene_task task;
static struct jp_primitive primitives[PRIMITIVES_MAX];
static struct jp_tariff tariff = {.primitives = primitives, .primitives_max = PRIMITIVES_MAX};

static void mix_plan(void)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_lattice_pose pose = plan->start;

    mix((uint32_t)plan->answer);
    mix(plan->cost);
    mix(plan->bound);
    mix(jp_planner_statistics(&planner)->expansions);
    mix(jp_planner_statistics(&planner)->states);
    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_primitive *step = jp_planner_step(&planner, i, &pose);
        mix((uint32_t)(step - planner.internal.config.lattice->primitives));
    }
}

static void work(void)
{
    while (!jp_planner_is_idle(&planner)) {
        (void)jp_planner_work(&planner, SLICE);
    }
    mix_plan();
}

static void plan_scene(uint32_t seed, const struct jp_planner_config *config, size_t size)
{
    const char *field = "";
    const struct jp_terrain_config *map = &scene_terrain_config;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, map, map_block, sizeof map_block, &field));
    scene_generate(seed, &terrain, &task);
    const struct jp_lattice_pose start = {(int16_t)task.start.x, (int16_t)task.start.y, task.start.heading};
    const struct jp_goal goal = {(int16_t)task.goal.x, (int16_t)task.goal.y, (uint16_t)(1U << task.goal.heading)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&planner, config, &terrain, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &start));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &goal));
    work();
}

static struct jp_lattice_pose pose_after(unsigned steps)
{
    struct jp_lattice_pose pose = jp_planner_plan(&planner)->start;

    for (unsigned i = 0; i < steps; i++) {
        (void)jp_planner_step(&planner, i, &pose);
    }
    return pose;
}

/* The robot drives a step, and a square on its route changes. */
static void drive_and_change(enum jp_cell cell)
{
    const struct jp_lattice_pose place = pose_after(AHEAD);
    const struct jp_lattice_pose robot = pose_after(1);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &robot));
    for (int32_t i = 0; i < SQUARE * SQUARE; i++) {
        (void)jp_planner_set_cell(&planner, place.x + i % SQUARE, place.y + i / SQUARE, cell);
        (void)jp_planner_set_elevation(&planner, place.x - i % SQUARE, place.y,
                                       (jp_elevation)(jp_terrain_elevation(&terrain, place.x, place.y) + i));
    }
    work();
}

static void test_256_kib(void)
{
    const struct jp_planner_config config = {
        &jp_lattice_zhang2018,
        JP_COST_PHYSICAL,
        {JP_EPSILON(1.35), JP_EPSILON(1.2), JP_EPSILON(1.1), JP_EPSILON_ONE},
    };

    plan_scene(1, &config, SMALL_BLOCK);
    plan_scene(18, &config, SMALL_BLOCK);
    TEST_ASSERT_EQUAL_HEX32(0x847A91D2, hash);
}

static void test_optimum_and_replans(void)
{
    const struct jp_planner_config config = {&jp_lattice_zhang2018, JP_COST_PHYSICAL, {JP_EPSILON_ONE}};

    plan_scene(1, &config, LARGE_BLOCK);
    for (unsigned i = 0; i < CHANGES; i++) {
        drive_and_change(i % 2 == 0 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    TEST_ASSERT_EQUAL_HEX32(0xDC959C49, hash);
}

static void test_paper_and_distance(void)
{
    const struct jp_planner_config paper = {&jp_lattice_zhang2018, JP_COST_PAPER, {JP_EPSILON(1.2)}};
    const struct jp_planner_config distance = {&jp_lattice_zhang2018, JP_COST_DISTANCE, {JP_EPSILON(1.2)}};

    plan_scene(3, &paper, SMALL_BLOCK);
    plan_scene(4, &distance, SMALL_BLOCK);
    TEST_ASSERT_EQUAL_HEX32(0xBC2A4438, hash);
}

static void test_learned_costs(void)
{
    const struct jp_tariff_factors factors = {3, JP_Q16(1.3), JP_Q16(2.1), JP_Q16(0.7)};
    const struct jp_planner_config config = {&tariff.lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.5)}};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&tariff, &jp_lattice_zhang2018, &factors, &field));
    plan_scene(4, &config, SMALL_BLOCK);
    mix(jp_planner_plan(&planner)->parameter_version);
    TEST_ASSERT_EQUAL_HEX32(0x3E5F7B4A, hash);
}

static void test_costs_by_models(void)
{
    struct jp_energy_model learned = jp_energy_model_gao2018;
    const struct jp_tariff_models models = {1, &jp_energy_model_gao2018, &learned, JP_Q16(1.1)};
    const char *field = "";

    learned.a[2] += JP_Q16(3.3);
    learned.b[0] += JP_Q16(7.7);
    learned.b[1] -= JP_Q16(0.1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_models(&tariff, &jp_lattice_gao2018, &models, &field));
    for (unsigned i = 0; i < PRIMITIVES_MAX; i++) {
        mix(primitives[i].base[JP_COST_PHYSICAL]);
    }
    for (unsigned i = 0; i < (unsigned)JP_MOVE_KINDS; i++) {
        mix((uint32_t)tariff.lattice.move_costs[JP_COST_PHYSICAL][i].climb.constant);
        mix((uint32_t)tariff.lattice.move_costs[JP_COST_PHYSICAL][i].climb.quadratic);
    }
    TEST_ASSERT_EQUAL_HEX32(0x8BAF6E46, hash);
}
