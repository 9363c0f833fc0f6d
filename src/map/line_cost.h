/** What a straight line over a map costs, by the prices of a lattice. Private to the core. */
#ifndef JOULEPATH_MAP_LINE_COST_H
#define JOULEPATH_MAP_LINE_COST_H

#include <joulepath/lattice.h>
#include <joulepath/point.h>

/** Physical cost of driving straight from one point to another, m from the south-west corner of the map, at most 256
 * cells apart: of its length, by the ground that it crosses, and of what it rises by in even steps of at most a cell.
 * JP_COST_MAX: a step is too steep. Work: two divisions and jp_terrain_height() a step. */
jp_cost jp_line_cost(const struct jp_lattice *lattice, const struct jp_terrain *terrain, const struct jp_point *from,
                     const struct jp_point *to);

#endif
