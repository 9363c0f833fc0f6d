/**
 * A simulated robot of skid steer or differential drive under a controller that knows its pose: wheel speeds by
 * proportional and integral control with the back EMF ahead, and around it the way back to where the route is.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_DRIVE_H
#define JOULEPATH_SIM_SKID_STEER_SKID_DRIVE_H

#include "sim/skid_steer/skid_route.h"
#include "sim/skid_steer/skid_world.h"

struct skid_drive {
    struct skid_world world;
    struct planar_pose reference;
    double integral[SKID_SIDES]; /**< of the wheels' errors, rad */
    double trim;                 /**< tread speed that turns besides what the geometry says, m/s */
    struct planar_pose last;     /**< pose one tick ago */
};

/** At rest at a pose. The model is copied; the ground stays in use. */
void skid_drive_start(struct skid_drive *drive, const struct skid_steer_model *model, const struct skid_ground *ground,
                      const struct planar_pose *pose, uint64_t seed);

/** Goes on from where the robot is, as navigators do from leg to leg: the pose, for the route. */
struct planar_pose skid_drive_go_on(struct skid_drive *drive);

/** Drives a piece of a route. */
void skid_drive_piece(struct skid_drive *drive, const struct skid_piece *piece);

/** What the battery has given at its terminals since the start, electronics included, J. */
double skid_drive_energy(const struct skid_drive *drive);

/** From where the route is, m. */
double skid_drive_distance(const struct skid_drive *drive);

#endif
