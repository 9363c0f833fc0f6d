/** What a lattice must know of a robot, whatever drives it: its footprint, its limits and the energy of a motion. */
#ifndef JOULEPATH_SIM_LATTICE_LATTICE_ROBOT_H
#define JOULEPATH_SIM_LATTICE_LATTICE_ROBOT_H

#include <joulepath/lattice.h>

#include "sim/balancer/robot_file.h"
#include "sim/skid_steer/skid_steer_model.h"

/** A motion at constant speed and turn rate. Distances and grades are those of the map. */
struct lattice_motion {
    double speed;     /**< m/s */
    double turn_rate; /**< rad/s */
    double rise;      /**< m, over the whole motion */
    double duration;  /**< s */
};

struct lattice_robot {
    const char *name;
    double length_m; /**< of its outline, which lies round the place that is planned for */
    double width_m;
    double track_m;           /**< between the wheels of its sides */
    double cell_m;            /**< of its maps */
    double margin_m;          /**< that it keeps round itself where it finds its own way; 0: it does not */
    double radius_m;          /**< of the disc that it needs wherever it is; 0: it needs its rectangle */
    double turning_radius_m;  /**< of that disc where it finds its own way; 0: it does not */
    double speed_max;         /**< m/s */
    double turn_rate_max;     /**< rad/s */
    double pivot_duration;    /**< s, least duration of a turn in place */
    double grade_max;         /**< rise over run */
    double grade_bend;        /**< where the energy of straight driving changes its polynomial; −grade_max: nowhere */
    double electronics_power; /**< W */
    /** J, physical or paper, before any floor; quadratic in `rise` on either side of the bend when driving straight. */
    double (*energy)(const struct lattice_robot *robot, enum jp_cost_kind kind, const struct lattice_motion *motion);
    struct skid_steer_model skid_steer;
    struct {
        struct robot_file file;
        const struct jp_energy_model *model;
    } balancer;
};

/** Reads a robot file of either type. On failure prints one line on stderr and returns false. */
bool lattice_robot_load(const char *path, struct lattice_robot *robot);

/** Of the lattice by which it finds its own way it needs the disc. False: it does not find one. */
bool lattice_robot_turns_anywhere(struct lattice_robot *robot);

/** J, physical, at least what the electronics draw. */
double lattice_robot_energy(const struct lattice_robot *robot, const struct lattice_motion *motion);

/** The speed of a curve of this curvature (rad/m) that takes the least energy a metre within the limits. */
double lattice_robot_speed(const struct lattice_robot *robot, double curvature);

/** The rate of turning in place by an angle (rad) that takes the least energy within the limits. */
double lattice_robot_pivot_rate(const struct lattice_robot *robot, double angle);

#endif
