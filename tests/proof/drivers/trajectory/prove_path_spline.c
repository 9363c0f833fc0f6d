// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:50,any_terrain:30,jp_terrain_init:30,is_side:10,jp_grid_planner_init:20
// eva: -eva-slevel-function jp_path_spline:50,take_path:50
/** Any map, any turning points on it and beside it, any spacing, scratch memory and room for points of any size. */
#include <joulepath/path_spline.h>

#include "tests/proof/any_terrain.h"

#define TURNS  3U
#define POINTS 8U

static uint64_t block[1024];
static uint64_t scratch[128];

int main(void)
{
    static struct jp_grid_planner planner;
    struct jp_terrain *map = any_terrain();
    struct jp_grid_planner_config config;
    struct jp_point path[TURNS];
    struct jp_point smooth[POINTS];
    size_t count;
    const char *field;

    ANY(config);
    config.prices = NULL;
    ANY(path);
    if (jp_grid_planner_init(&planner, &config, map, block, any_unsigned(sizeof block), &field) != JP_OK) {
        return 0;
    }
    (void)jp_path_spline(&planner, path, any_unsigned(TURNS), any_int(), scratch, any_unsigned(sizeof scratch), smooth,
                         any_unsigned(POINTS), &count);
    ARRIVED();
    return 0;
}
