/** Maps from arrays, row by row from the south, as NumPy holds them. */
#ifndef JOULEPATH_PYTHON_MAP_ARRAYS_H
#define JOULEPATH_PYTHON_MAP_ARRAYS_H

#include "sim/files/map_file.h"

struct map_arrays {
    const uint8_t *cells;          /**< enum jp_cell */
    const jp_elevation *elevation; /**< NULL: level */
    const uint8_t *costs;          /**< NULL: none */
};

/** Makes a map. False after one line (errors.h); then there is nothing to free. */
bool map_arrays_make(struct map_file *map, const struct jp_terrain_config *config, const struct map_arrays *arrays);

/** Writes the state of each cell. */
void map_arrays_cells(const struct map_file *map, uint8_t *cells);

#endif
