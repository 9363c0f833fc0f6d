/** The cells on which a lattice's robot may be at some heading, a bit each: what jp_lattice_is_open() says of them,
 * found for 32 cells at a time. Private to the core. */
#ifndef JOULEPATH_MAP_OPEN_PLANE_H
#define JOULEPATH_MAP_OPEN_PLANE_H

#include <joulepath/lattice.h>

/** Bytes for a map. */
size_t jp_open_plane_size(const struct jp_terrain_config *config);

/** Finds a row, 0…height − 1. Returns its work, in looks at 32 cells of the map: the cells of the lattice's core for
 * each word. */
unsigned jp_open_plane_make_row(uint32_t *plane, const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                                int32_t y);

/** Of the 32 cells from (x, y) on, the first in the lowest bit; cells off the map are not open. */
uint32_t jp_open_plane_look(const uint32_t *plane, const struct jp_terrain *terrain, int32_t x, int32_t y);

#endif
