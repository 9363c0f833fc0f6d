#include "tools/python/native/map_arrays.h"

#include <stdlib.h>

#include "sim/base/error.h"

static void fill(struct jp_terrain *terrain, const struct map_arrays *arrays)
{
    size_t i = 0;

    for (int32_t y = 0; y < terrain->config.height; y++) {
        for (int32_t x = 0; x < terrain->config.width; x++, i++) {
            (void)jp_terrain_set_cell(terrain, x, y, (enum jp_cell)arrays->cells[i]);
            if (arrays->elevation != NULL) {
                (void)jp_terrain_set_elevation(terrain, x, y, arrays->elevation[i]);
            }
            if (arrays->costs != NULL) {
                (void)jp_terrain_set_cost(terrain, x, y, arrays->costs[i]);
            }
        }
    }
}

bool map_arrays_make(struct map_file *map, const struct jp_terrain_config *config, const struct map_arrays *arrays)
{
    const size_t size = jp_terrain_size(config);
    const char *field = "";

    *map = (struct map_file){.block = malloc(size > 0 ? size : 1)};
    const enum jp_status status = jp_terrain_init(&map->terrain, config, map->block, size, &field);
    if (status != JP_OK) {
        error_line("map: %s is out of range", status == JP_ERR_CONFIG ? field : "its size");
        map_file_free(map);
        return false;
    }
    fill(&map->terrain, arrays);
    return true;
}

void map_arrays_cells(const struct map_file *map, uint8_t *cells)
{
    const struct jp_terrain *terrain = &map->terrain;
    size_t i = 0;

    for (int32_t y = 0; y < terrain->config.height; y++) {
        for (int32_t x = 0; x < terrain->config.width; x++) {
            cells[i++] = (uint8_t)jp_terrain_cell(terrain, x, y);
        }
    }
}
