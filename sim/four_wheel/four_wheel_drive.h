/** A simulated robot with four steered wheels that is told twists, on a plane, and the pieces that it drives. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_DRIVE_H
#define JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_DRIVE_H

#include <joulepath/four_wheel_trip.h>

#include "sim/base/random.h"
#include "sim/four_wheel/four_wheel_plant.h"

/** Ticks of a piece. */
#define FOUR_WHEEL_PIECE_TICKS 20

struct four_wheel_drive {
    struct four_wheel_plant plant;
    struct jp_four_wheel_config config;
    struct jp_wheels wheels; /**< asked of the plant */
    struct jp_four_wheel_trip trip;
    double rise_x; /**< of the plane, m/m */
    double rise_y;
};

/** A twist in m/s and rad/s. */
struct four_wheel_twist {
    double forward;
    double left;
    double turn_rate;
};

/** At rest on a plane that rises so much towards x and y. The robot stays in use. */
void four_wheel_drive_start(struct four_wheel_drive *drive, const struct four_wheel_file *robot, double rise_x,
                            double rise_y);

/** One tick; true: a piece is complete. */
bool four_wheel_drive_tick(struct four_wheel_drive *drive, const struct four_wheel_twist *twist,
                           struct jp_four_wheel_piece *piece);

/** What differs between robots and grounds of a kind, factors of the robot file's numbers. */
struct four_wheel_variation {
    double rolling;
    double mass; /**< with the inertia */
    double steering;
    double electronics;
};

/** Drawn evenly: rolling 0.7…1.5, mass 0.9…1.3, steering 0.6…1.4, electronics 0.8…1.2. */
struct four_wheel_variation four_wheel_random_variation(struct random *random);

/** The robot that differs so. */
struct four_wheel_file four_wheel_varied(const struct four_wheel_file *robot,
                                         const struct four_wheel_variation *variation);

/** A twist that the robot can drive: ahead, back, across, round a bend, on the spot, or all at once. */
struct four_wheel_twist four_wheel_random_twist(const struct four_wheel_file *robot, struct random *random);

#endif
