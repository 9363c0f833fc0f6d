// eva: -eva-precision 0 -eva-auto-loop-unroll 16
// eva: -eva-slevel-function main:200,any_terrain:30,jp_terrain_init:30,is_side:10,jp_waypoints_init:50
/** Any map and configuration, a block of any size, any route: what is refused, and that there is no answer before the
 *  first slice of work, which has no driver. */
#include <joulepath/waypoints.h>

#include "tests/proof/any_field.h"

static uint64_t block[512];
static struct jp_energy_model model;
static struct jp_segment_limits limits;
static struct jp_lattice_pose route[3];

int main(void)
{
    static struct jp_waypoints waypoints;
    struct jp_waypoints_config config;
    struct jp_waypoint list[2];
    const char *field;

    any_field_map();
    ANY(config);
    config.terrain = any_bool() ? field_map : NULL;
    config.lattice = any_bool() ? &field_lattice : NULL;
    config.model = any_bool() ? &model : NULL;
    config.limits = any_bool() ? &limits : NULL;
    ANY(route);
    if (jp_waypoints_init(&waypoints, &config, block, any_unsigned(sizeof block), &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        (void)jp_waypoints_start(&waypoints, route, any_unsigned(3));
        (void)jp_waypoints_count(&waypoints);
        (void)jp_waypoints_read(&waypoints, list, any_unsigned(2));
    }
    ARRIVED();
    return 0;
}
