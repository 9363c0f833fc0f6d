/** Data sheets of cells, sim/robots/cells/name.cfg, and packs of them, sim/robots/packs/robot.cfg. */
#ifndef JOULEPATH_SIM_FILES_CELL_FILE_H
#define JOULEPATH_SIM_FILES_CELL_FILE_H

#include <stdbool.h>

#include "sim/base/cell_pack.h"

/** Loads the file of a cell. False after one line on stderr. */
bool cell_file_load(const char *path, struct cell_constants *cell);

/** Loads the file of a pack and that of its cell. False after one line on stderr. */
bool pack_file_load(const char *path, struct cell_constants *cell, struct cell_wiring *wiring);

/** The same of a robot that has one. */
bool pack_file_load_robot(const char *robot, struct cell_constants *cell, struct cell_wiring *wiring);

#endif
