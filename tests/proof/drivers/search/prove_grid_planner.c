// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:20,any_terrain:30,jp_terrain_init:30,is_side:10,jp_grid_planner_init:20,begin:20
/** Any map and configuration that pass, with prices or without, a block of any size: any starts and goals, any cells
 * that change, any lines on the map and beside it. The slices of work have no driver. */
#include <joulepath/grid_planner.h>

#include "tests/proof/any_terrain.h"

static uint64_t block[1024];
static struct jp_grid_planner planner;
static struct jp_grid_prices prices;

static void start(void)
{
    struct jp_grid_cell from;
    struct jp_grid_cell to;

    ANY(from);
    ANY(to);
    (void)jp_grid_planner_start(&planner, &from, &to);
}

static void look(void)
{
    struct jp_point from;
    struct jp_point to;
    size_t count;

    ANY(from);
    ANY(to);
    (void)jp_grid_planner_path(&planner, &count);
    (void)jp_grid_planner_statistics(&planner);
    (void)jp_grid_planner_resolution(&planner);
    (void)jp_grid_planner_line_is_free(&planner, &from, &to);
}

int main(void)
{
    struct jp_terrain *map = any_terrain();
    struct jp_grid_planner_config config;
    const char *field;

    ANY(config);
    ANY(prices);
    config.prices = any_bool() ? &prices : NULL;
    if (jp_grid_planner_init(&planner, &config, map, block, any_unsigned(sizeof block), &field) != JP_OK) {
        return 0;
    }
    start();
    ANY_TIMES
    {
        if (any_bool()) {
            start();
        }
        if (any_bool()) {
            any_cell(map);
        }
        look();
    }
    ARRIVED();
    return 0;
}
