/** Instructions of one jp_grid_planner_work() of 32 expansions, any angle: the worst slice over the scenes of the
 *  bench, by length and by the prices of the patrol robot among things and hills; and the longest search by prices. */
#include <joulepath/grid_planner.h>
#include <joulepath/tables.h>

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

/* Of searches. */
struct effort {
    uint32_t worst_slice;
    uint32_t slices;
    uint32_t longest; /* all slices of one search, thousands of instructions */
};

static void plan_scene(uint32_t seed, const struct jp_grid_prices *prices, struct effort *effort)
{
    const struct jp_grid_planner_config config = {
        .method = JP_GRID_ANY_ANGLE, .clearance = JP_Q16(0.5), .tube = TUBE, .prices = prices};
    struct scene_task task;
    const char *field = "";
    uint32_t thousands = 0;

    (void)jp_terrain_init(&terrain, &scene_terrain_config, map_block, sizeof map_block, &field);
    scene_generate(seed, &terrain, &task);
    const struct jp_grid_cell start = {(int16_t)task.start.x, (int16_t)task.start.y};
    const struct jp_grid_cell goal = {(int16_t)task.goal.x, (int16_t)task.goal.y};
    (void)jp_grid_planner_init(&planner, &config, &terrain, block, sizeof block, &field);
    (void)jp_grid_planner_start(&planner, &start, &goal);
    do {
        const uint32_t instructions = target_count_once(work, &planner);

        effort->worst_slice = instructions > effort->worst_slice ? instructions : effort->worst_slice;
        effort->slices++;
        thousands += instructions / 1000U;
    } while (answer == JP_GRID_SEARCHING);
    effort->longest = thousands > effort->longest ? thousands : effort->longest;
}

static void print_figure(const char *name, uint32_t of, const char *unit, uint32_t value)
{
    target_print("{\"name\": \"" TARGET_CORE ": ");
    target_print(name);
    target_print(", worst of ");
    target_print_number(of);
    target_print("\", \"value\": ");
    target_print_number(value);
    target_print(", \"unit\": \"");
    target_print(unit);
    target_print("\", \"bound\": null, \"command\": \"make figures\"}");
}

int main(void)
{
    struct jp_grid_prices prices;
    struct effort by_length = {0};
    struct effort by_prices = {0};

    (void)jp_grid_prices_set(&jp_four_wheel_energy_patrol, JP_Q24(1), JP_Q16(10), &prices);
    prices.ring = SCENE_RESOLUTION;
    prices.near[0] = JP_Q16(160);
    for (uint32_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        plan_scene(SCENE_BENCH_FIRST + i, NULL, &by_length);
        plan_scene(SCENE_BENCH_FIRST + i, &prices, &by_prices);
    }
    target_print("[\n");
    print_figure("slice of 32 expansions of the grid planner", by_length.slices, "instructions", by_length.worst_slice);
    target_print(",\n");
    print_figure("grid planner by prices, slice of 32 expansions", by_prices.slices, "instructions",
                 by_prices.worst_slice);
    target_print(",\n");
    print_figure("grid planner by length, search over 300 × 300 cells", SCENE_BENCH_COUNT, "thousand instructions",
                 by_length.longest);
    target_print(",\n");
    print_figure("grid planner by prices, search over 300 × 300 cells with hills", SCENE_BENCH_COUNT,
                 "thousand instructions", by_prices.longest);
    target_print("\n]\n");
    return 0;
}
