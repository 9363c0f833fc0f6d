/** What a path whose speeds are planned (path_speed.h) takes of a skid-steered or differential-drive robot, by its
 *  energy model. */
#ifndef JOULEPATH_SKID_PATH_ENERGY_H
#define JOULEPATH_SKID_PATH_ENERGY_H

#include <joulepath/path_speed.h>
#include <joulepath/skid_energy.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Adds a piece, at whose begin the robot has a speed, 0…8 m/s, to a drive, and what it lasts to *duration, s,
 * saturated. `next`: the piece after it, to whose curvature it changes at its end, or null. The model must have passed
 * its check. Work: five pieces of skid_energy.h and one more for each 256 s, with a division of 64 bits and a square
 * root each. Not for ISRs. */
void jp_skid_piece_energy(const struct jp_skid_energy_model *model, const struct jp_path_piece *piece,
                          const struct jp_path_piece *next, jp_q24 begin, struct jp_skid_drive *drive,
                          jp_q16 *duration);

/** The same of a path, from a stand. */
void jp_skid_path_energy(const struct jp_skid_energy_model *model, const struct jp_lattice_path *path,
                         struct jp_skid_drive *drive, jp_q16 *duration);

/** Prices of path_speed.h by a model, which must have passed its check and stay; `time`: what a second less is worth,
 * W, 0…16 384. */
struct jp_motion_price jp_skid_motion_price(const struct jp_skid_energy_model *model, jp_q16 time);

#ifdef __cplusplus
}
#endif

#endif
