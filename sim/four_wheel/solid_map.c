#include "sim/four_wheel/solid_map.h"

#include <stdlib.h>

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* The cell's distance by its four neighbours towards `side`, −1 or 1: those that a pass has done already. */
static int through(const struct solid_map *map, int x, int y, int side)
{
    const int row = least(solid_map_distance(map, x - 1, y + side),
                          least(solid_map_distance(map, x, y + side), solid_map_distance(map, x + 1, y + side)));

    return least(row, solid_map_distance(map, x + side, y)) + 1;
}

static void update(struct solid_map *map, int x, int y, int side)
{
    uint8_t *distance = &map->distance[y * map->width + x];

    *distance = (uint8_t)least(*distance, through(map, x, y, side));
}

bool solid_map_init(struct solid_map *map, const struct jp_terrain *terrain)
{
    static const struct jp_span alone = {0, 0, 0};
    const int width = terrain->config.width;
    const int height = terrain->config.height;

    *map = (struct solid_map){width, height, (double)terrain->config.resolution / JP_Q16_ONE,
                              malloc((size_t)width * (size_t)height)};
    if (map->distance == NULL) {
        return false;
    }
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            map->distance[y * width + x] = jp_terrain_is_clear(terrain, &alone, 1, x, y) ? SOLID_MAP_DISTANCE_MAX : 0;
        }
    }
    /* Two passes make the chessboard distance exact. */
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            update(map, x, y, -1);
        }
    }
    for (int y = height - 1; y >= 0; y--) {
        for (int x = width - 1; x >= 0; x--) {
            update(map, x, y, 1);
        }
    }
    return true;
}

void solid_map_free(struct solid_map *map)
{
    free(map->distance);
    map->distance = NULL;
}
