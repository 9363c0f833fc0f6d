/** Where the unit steps of a lattice cannot be driven. Private to the core. */
#ifndef JOULEPATH_MAP_BARRED_STEPS_H
#define JOULEPATH_MAP_BARRED_STEPS_H

#include <joulepath/pose_field.h>

/** Sets bits at each cell of a row from where a step outward sweeps a cell that is blocked or off the map; at all if
 * the lattice has no such step. Work: for each span of the step the words of the row; and the bits. */
void jp_barred_steps(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                     const struct jp_pose_step *step, int32_t y, uint16_t bits, uint16_t *row);

#endif
