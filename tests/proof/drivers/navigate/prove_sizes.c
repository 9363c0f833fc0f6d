// eva: -eva-slevel-function main:20
/** What blocks of memory maps and routes of any size need. */
#include <joulepath/navigator.h>
#include <joulepath/path_spline.h>
#include <joulepath/waypoints.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_grid_planner_config grid;
    struct jp_grid_prices prices;
    struct jp_terrain_config map;

    ANY(map);
    map.has_elevation = any_bool();
    map.unknown_is_free = any_bool();
    map.has_costs = any_bool();
    map.has_classes = any_bool();
    ANY(grid);
    ANY(prices);
    grid.prices = any_bool() ? &prices : NULL;
    (void)jp_planner_size(&map);
    (void)jp_navigator_way_size(&map);
    (void)jp_navigator_seen_size(&map);
    (void)jp_grid_planner_size(&grid, &map);
    (void)jp_path_spline_size(any_unsigned(UINT16_MAX));
    (void)jp_waypoints_size(any_unsigned(UINT32_MAX));
    ARRIVED();
    return 0;
}
