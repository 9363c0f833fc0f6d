/** Instructions of one jp_planner_work() of 32 expansions: the worst slice of each kind of work over the scenes of the
 *  bench, in 256 KiB. */
#include <joulepath/planner.h>
#include <joulepath/tables.h>

#include "tests/support/scene.h"
#include "tests/target/cycles.h"
#include "tests/target/target.h"

enum { BLOCK = 256 * 1024, SLICE = 32 };

static uint64_t map_block[(SCENE_TERRAIN_SIZE + 7) / 8];
static uint64_t block[BLOCK / 8];
static struct jp_terrain terrain;
static struct jp_planner planner;

static void work(void *argument)
{
    (void)jp_planner_work(argument, SLICE);
}

static uint32_t worst_slice;
static uint32_t slices;

static void plan_scene(uint32_t seed)
{
    static const struct jp_planner_config config = {
        &jp_lattice_zhang2018,
        JP_COST_PHYSICAL,
        {JP_EPSILON(1.35), JP_EPSILON(1.2), JP_EPSILON(1.1), JP_EPSILON_ONE},
    };
    struct scene_task task;
    const char *field = "";

    (void)jp_terrain_init(&terrain, &scene_terrain_config, map_block, sizeof map_block, &field);
    scene_generate(seed, &terrain, &task);
    const struct jp_lattice_pose start = {(int16_t)task.start.x, (int16_t)task.start.y, task.start.heading};
    const struct jp_goal goal = {(int16_t)task.goal.x, (int16_t)task.goal.y, (uint16_t)(1U << task.goal.heading)};
    (void)jp_planner_init(&planner, &config, &terrain, block, sizeof block, &field);
    (void)jp_planner_set_start(&planner, &start);
    (void)jp_planner_set_goal(&planner, &goal);
    while (!jp_planner_is_idle(&planner)) {
        const uint32_t instructions = target_count_once(work, &planner);

        worst_slice = instructions > worst_slice ? instructions : worst_slice;
        slices++;
    }
}

int main(void)
{
    for (uint32_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        plan_scene(SCENE_BENCH_FIRST + i);
    }
    target_print("[\n{\"name\": \"" TARGET_CORE ": slice of 32 expansions of the planner in 256 KiB, worst of ");
    target_print_number(slices);
    target_print("\", \"value\": ");
    target_print_number(worst_slice);
    target_print(", \"unit\": \"instructions\", \"bound\": null, \"command\": \"make figures\"}\n]\n");
    return 0;
}
