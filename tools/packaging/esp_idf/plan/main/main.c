/** Plans a route round a wall in 64 KiB and prints its energy, and how long that took. */
#include <inttypes.h>
#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <stdio.h>

#include "esp_timer.h"

enum { WIDTH = 60, HEIGHT = 40, WALL_X = 26, WALL_END = 28, BLOCK_BYTES = 64 * 1024, SLICE = 100 };

static uint64_t map_memory[WIDTH * HEIGHT];
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];
static struct jp_terrain map;
static struct jp_planner planner;

/** Free but for a wall with a gap at its end. */
static enum jp_status make_map(void)
{
    const struct jp_terrain_config config = {
        .width = WIDTH, .height = HEIGHT, .resolution = jp_lattice_zhang2018.resolution};
    const char *field = "";
    const enum jp_status status = jp_terrain_init(&map, &config, map_memory, sizeof map_memory, &field);

    for (int32_t y = 0; status == JP_OK && y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            (void)jp_terrain_set_cell(&map, x, y, x == WALL_X && y < WALL_END ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        }
    }
    return status;
}

static enum jp_status begin(void)
{
    static const struct jp_planner_config config = {
        .lattice = &jp_lattice_zhang2018, .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(2), JP_EPSILON_ONE}};
    static const struct jp_lattice_pose start = {.x = 8, .y = 20, .heading = 0};
    static const struct jp_goal goal = {.x = 50, .y = 20, .headings = JP_ANY_HEADING};
    const char *field = "";
    enum jp_status status = make_map();

    status = status == JP_OK ? jp_planner_init(&planner, &config, &map, block, sizeof block, &field) : status;
    status = status == JP_OK ? jp_planner_set_start(&planner, &start) : status;
    return status == JP_OK ? jp_planner_set_goal(&planner, &goal) : status;
}

void app_main(void)
{
    const int64_t begun = esp_timer_get_time();
    const enum jp_status status = begin();

    if (status != JP_OK) {
        printf("refused: status %d\n", (int)status);
        return;
    }
    while (!jp_planner_is_idle(&planner)) {
        (void)jp_planner_work(&planner, SLICE);
    }
    const struct jp_plan *plan = jp_planner_plan(&planner);
    printf("%u steps, %" PRIu32 ".%" PRIu32 " J, proved within %u/256 of the optimum, after %" PRId64 " us\n",
           (unsigned)plan->step_count, plan->cost / JP_COST_PER_JOULE, plan->cost % JP_COST_PER_JOULE * 10 / JP_COST_PER_JOULE,
           (unsigned)plan->bound, esp_timer_get_time() - begun);
}
