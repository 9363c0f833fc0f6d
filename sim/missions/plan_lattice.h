/** The lattices that are built in, and whether a map has their cells. */
#ifndef JOULEPATH_SIM_MISSIONS_PLAN_LATTICE_H
#define JOULEPATH_SIM_MISSIONS_PLAN_LATTICE_H

#include <joulepath/lattice.h>

#include "sim/files/map_file.h"

/** Of a robot's name; NULL: none is built in. */
const struct jp_lattice *plan_lattice_find(const char *name);

/** The one by which a robot of this name finds its own way: that which is made for it alone, or its lattice. NULL: none
 *  is built in. */
const struct jp_lattice *plan_lattice_for_navigation(const char *name);

/** False after one line on stderr: a map, read from `path`, has other cells than a lattice. */
bool plan_lattice_fits(const char *path, const struct map_file *map, const struct jp_lattice *lattice);

#endif
