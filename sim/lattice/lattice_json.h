/** A lattice as JSON: what tools/design/lattice.py turns into tables, and the primitives that it imports. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_JSON_H
#define JOULEPATH_SIM_LATTICE_LATTICE_JSON_H

#include <jansson.h>

#include "sim/lattice/lattice_primitive.h"

/** Everything of a finished lattice. The caller owns the value. */
json_t *lattice_to_json(const struct lattice *lattice);

/** Reads resolution, headings and the paths of primitives made elsewhere, finds their moves and drives them. False
 *  after one line on stderr: file, primitive, what, what to do. */
bool lattice_from_json(const char *path, struct lattice *lattice);

#endif
