#include "sim/skid_steer/skid_ground.h"

#include <math.h>
#include <stddef.h>

#include "sim/base/strict_math.h"

#define Q16 65536.0

struct skid_slope skid_slope_towards(double degrees, double heading)
{
    const double rise = strict_tan(degrees * M_PI / 180);

    return (struct skid_slope){.slope_x = rise * strict_cos(heading), .slope_y = rise * strict_sin(heading)};
}

static struct skid_ground_point on_slope(const void *context, double x, double y)
{
    const struct skid_slope *slope = context;

    return (struct skid_ground_point){slope->slope_x * x + slope->slope_y * y, slope->slope_x, slope->slope_y};
}

struct skid_ground skid_ground_slope(const struct skid_slope *slope)
{
    return (struct skid_ground){on_slope, slope};
}

/* Between which two middles of cells a coordinate lies. */
struct between {
    int32_t low;
    double share; /* of the way from the one to the next */
    double rate;  /* of the share, 1/m; 0 beyond the outermost middle */
};

static struct between middles(double position, double side, int32_t count)
{
    const double cells = position / side - 0.5;

    if (!(cells > 0)) {
        return (struct between){0, 0, 0};
    }
    if (cells >= count - 1) {
        return (struct between){count - 1, 0, 0};
    }
    return (struct between){(int32_t)cells, cells - floor(cells), 1 / side};
}

static double elevation(const struct jp_terrain *map, int32_t x, int32_t y)
{
    const int32_t last_x = map->config.width - 1;
    const int32_t last_y = map->config.height - 1;

    return (double)jp_terrain_elevation(map, x < last_x ? x : last_x, y < last_y ? y : last_y) / JP_ELEVATION_ONE;
}

static struct skid_ground_point on_map(const void *context, double x, double y)
{
    const struct jp_terrain *map = context;
    const double side = map->config.resolution / Q16;
    const struct between across = middles(x, side, map->config.width);
    const struct between up = middles(y, side, map->config.height);
    const double south_west = elevation(map, across.low, up.low);
    const double south_east = elevation(map, across.low + 1, up.low);
    const double north_west = elevation(map, across.low, up.low + 1);
    const double north_east = elevation(map, across.low + 1, up.low + 1);
    const double south = south_west + across.share * (south_east - south_west);
    const double north = north_west + across.share * (north_east - north_west);
    const double slope_south = across.rate * (south_east - south_west);
    const double slope_north = across.rate * (north_east - north_west);

    return (struct skid_ground_point){south + up.share * (north - south),
                                      slope_south + up.share * (slope_north - slope_south), up.rate * (north - south)};
}

struct skid_ground skid_ground_map(const struct jp_terrain *map)
{
    return (struct skid_ground){on_map, map};
}

static struct skid_grip on_class(const void *context, double x, double y)
{
    const struct skid_classes *classes = context;
    const double side = classes->map->config.resolution / Q16;

    return classes->grip[jp_terrain_class(classes->map, (int32_t)floor(x / side), (int32_t)floor(y / side))];
}

struct skid_surface skid_surface_map(const struct skid_classes *classes)
{
    struct skid_surface surface = {on_class, classes, classes->grip[0]};

    for (unsigned k = 1; k < JP_GROUND_CLASSES; k++) {
        surface.most.rolling = fmax(surface.most.rolling, classes->grip[k].rolling);
        surface.most.friction = fmin(surface.most.friction, classes->grip[k].friction);
    }
    return surface;
}
