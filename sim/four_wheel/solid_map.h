/**
 * Which cells of a map are solid, and how far each is from the next solid one: what rays and collisions ask for.
 *
 * Solid is where the robot may not be: occupied cells, unknown ones unless the map lets the robot drive over them, and
 * everything off the map.
 */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_SOLID_MAP_H
#define JOULEPATH_SIM_FOUR_WHEEL_SOLID_MAP_H

#include <joulepath/terrain.h>
#include <stdbool.h>
#include <stdint.h>

/** Distances are capped here, cells. */
#define SOLID_MAP_DISTANCE_MAX 255

struct solid_map {
    int width;         /**< cells */
    int height;        /**< cells */
    double cell;       /**< side of a cell, m */
    uint8_t *distance; /**< row by row: the larger of |Δx| and |Δy| to the next solid cell; 0: solid */
};

/** Reads a map as it is now. False without memory; then there is nothing to free. Work: all cells, twice. */
bool solid_map_init(struct solid_map *map, const struct jp_terrain *terrain);

void solid_map_free(struct solid_map *map);

/** Cells to the next solid one in the larger of x and y; 0 in a solid cell and off the map. */
static inline int solid_map_distance(const struct solid_map *map, int x, int y)
{
    const bool inside = x >= 0 && y >= 0 && x < map->width && y < map->height;

    return inside ? map->distance[y * map->width + x] : 0;
}

#endif
