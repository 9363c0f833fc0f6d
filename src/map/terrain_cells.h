/** What every step of a field or a primitive asks of the map, inline. */
#ifndef JOULEPATH_MAP_TERRAIN_CELLS_H
#define JOULEPATH_MAP_TERRAIN_CELLS_H

#include <joulepath/terrain.h>

/** As jp_terrain_contains(). */
static inline bool terrain_contains(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return (uint32_t)x < terrain->config.width && (uint32_t)y < terrain->config.height;
}

/** As jp_terrain_elevation(). */
static inline int32_t terrain_elevation(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    if (terrain->elevation == NULL || !terrain_contains(terrain, x, y)) {
        return 0;
    }
    return terrain->elevation[(size_t)y * terrain->config.width + (size_t)x];
}

/** As jp_terrain_cost(). */
static inline uint8_t terrain_cost(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    if (terrain->costs == NULL || !terrain_contains(terrain, x, y)) {
        return 0;
    }
    return terrain->costs[(size_t)y * terrain->config.width + (size_t)x];
}

/** As jp_terrain_class(). */
static inline uint8_t terrain_class(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    if (terrain->classes == NULL || !terrain_contains(terrain, x, y)) {
        return 0;
    }
    const size_t cell = (size_t)y * terrain->config.width + (size_t)x;
    return (uint8_t)(((uint32_t)terrain->classes[cell / 4U] >> (2U * (cell % 4U))) & 3U);
}

#endif
