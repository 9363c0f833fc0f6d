/** Instructions of one jp_grid_planner_work() of 32 expansions, any angle: the worst slice over the scenes of the
 *  bench. */
#include <joulepath/grid_planner.h>

#include "tests/support/scene.h"
#include "tests/target/cycles.h"
#include "tests/target/target.h"

enum { BLOCK = 880 * 1024, SLICE = 32, TUBE = 8 };

static uint64_t map_block[(SCENE_TERRAIN_SIZE + 7) / 8];
static uint64_t block[BLOCK / 8];
static struct jp_terrain terrain;
static struct jp_grid_planner planner;
static enum jp_grid_answer answer;

static void work(void *argument)
{
    answer = jp_grid_planner_work(argument, SLICE);
}

static uint32_t worst_slice;
static uint32_t slices;

static void plan_scene(uint32_t seed)
{
    static const struct jp_grid_planner_config config = {
        .method = JP_GRID_ANY_ANGLE, .clearance = JP_Q16(0.5), .tube = TUBE};
    struct scene_task task;
    const char *field = "";

    (void)jp_terrain_init(&terrain, &scene_terrain_config, map_block, sizeof map_block, &field);
    scene_generate(seed, &terrain, &task);
    const struct jp_grid_cell start = {(int16_t)task.start.x, (int16_t)task.start.y};
    const struct jp_grid_cell goal = {(int16_t)task.goal.x, (int16_t)task.goal.y};
    (void)jp_grid_planner_init(&planner, &config, &terrain, block, sizeof block, &field);
    (void)jp_grid_planner_start(&planner, &start, &goal);
    do {
        const uint32_t instructions = target_count_once(work, &planner);

        worst_slice = instructions > worst_slice ? instructions : worst_slice;
        slices++;
    } while (answer == JP_GRID_SEARCHING);
}

int main(void)
{
    for (uint32_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        plan_scene(SCENE_BENCH_FIRST + i);
    }
    target_print("[\n{\"name\": \"" TARGET_CORE ": slice of 32 expansions of the grid planner, worst of ");
    target_print_number(slices);
    target_print("\", \"value\": ");
    target_print_number(worst_slice);
    target_print(", \"unit\": \"instructions\", \"bound\": null, \"command\": \"make figures\"}\n]\n");
    return 0;
}
