// eva: -eva-precision 3 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:200,small_terrain:30,jp_terrain_init:30,jp_grid_planner_init:200
// eva: -eva-slevel-function jp_grid_take_prices:50,take_all:50
/** What a path costs that was found: a small map with any cells, any configuration and prices that pass, rings that are
 * any, and any points of a path on the map. */
#include <joulepath/grid_planner.h>

#include "tests/proof/any_small_map.h"

#define POINTS 3U

static uint64_t block[1024];
static struct jp_grid_planner planner;
static struct jp_grid_prices prices;
static struct jp_point points[POINTS];

/** As the slices of work leave it. */
static void any_path_found(void)
{
    ANY(block);
    for (unsigned i = 0; i < POINTS; i++) {
        small_point(&points[i]);
    }
    planner.internal.path.points = points;
    planner.internal.path.count = any_unsigned(POINTS - 1U) + 1U;
    planner.internal.answer = JP_GRID_FOUND;
}

int main(void)
{
    struct jp_terrain *map = small_terrain();
    struct jp_grid_planner_config config;
    const char *field;

    ANY(config);
    ANY(prices);
    config.prices = &prices;
    if (jp_grid_planner_init(&planner, &config, map, block, any_unsigned(sizeof block), &field) != JP_OK) {
        return 0;
    }
    any_path_found();
    (void)jp_grid_planner_price(&planner);
    ARRIVED();
    return 0;
}
