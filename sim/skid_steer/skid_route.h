/**
 * Routes of a skid-steered or differential-drive robot: legs of constant speed and turn rate with even ramps between
 * them, cut into the short pieces that the energy model of joulepath/skid_energy.h counts, on the ground as planned.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_ROUTE_H
#define JOULEPATH_SIM_SKID_STEER_SKID_ROUTE_H

#include <joulepath/skid_energy.h>
#include <stddef.h>

#include "sim/base/planar.h"
#include "sim/base/random.h"
#include "sim/skid_steer/skid_ground.h"
#include "sim/skid_steer/skid_steer_model.h"

/** A piece is about so long, s; a whole number of control ticks. */
#define SKID_PIECE_SECONDS 0.2

/** Pieces of a leg. */
#define SKID_LEG_PIECES_MAX 128

/** What a robot is asked for. */
struct skid_leg {
    double speed;     /**< on the map, m/s */
    double turn_rate; /**< rad/s */
    double seconds;   /**< with the ramp from the leg before */
};

/** The members of struct jp_skid_piece in double. */
struct skid_piece {
    struct skid_steer_motion start; /**< with the grade along the heading, of the whole piece */
    struct skid_steer_motion end;
    double bank; /**< rise over run to the left */
    double seconds;
    bool is_ramp;
};

/** Where a route has come to. */
struct skid_route {
    const struct skid_steer_model *model;
    const struct skid_ground *ground;
    struct planar_pose pose;
    double speed;
    double turn_rate;
};

/** At rest at a pose. Model and ground stay in use. */
void skid_route_start(struct skid_route *route, const struct skid_steer_model *model, const struct skid_ground *ground,
                      const struct planar_pose *pose);

/** Goes on by a leg; its pieces, at most SKID_LEG_PIECES_MAX, and their number. */
size_t skid_route_add(struct skid_route *route, const struct skid_leg *leg, struct skid_piece *pieces);

/** The pose after a motion for some time. */
struct planar_pose skid_route_pose(const struct planar_pose *pose, double speed, double turn_rate, double seconds);

/** Half of the track by which the treads turn, m: of wheels that slide by Coulomb's friction, evenly loaded. */
double skid_half_track(const struct skid_steer_model *model);

/** What the treads may do on a route, m/s: keeps something for slopes, payload and control. */
double skid_tread_speed_max(const struct skid_steer_model *model);

/** A leg at random: straight or a bend of 3 to 8 s, mostly forwards, or up to half a turn on the spot. */
struct skid_leg skid_random_leg(const struct skid_steer_model *model, struct random *random);

/** What differs between robots and grounds of a kind. */
struct skid_variation {
    double rolling;     /**< factors of the robot file's numbers */
    double friction;    /**< of the ground */
    double mass;        /**< with the inertia */
    double electronics; /**< power */
    double resistance;  /**< of the motors */
};

/** Drawn evenly: rolling 0.7…1.5, friction 0.6…1.2, mass 0.9…1.3, electronics 0.8…1.2, resistance 0.9…1.1. */
struct skid_variation skid_random_variation(struct random *random);

/** The robot that differs so. */
struct skid_steer_model skid_varied(const struct skid_steer_model *model, const struct skid_variation *variation);

/** The piece in the formats of the core; what exceeds them is saturated. */
struct jp_skid_piece skid_core_piece(const struct skid_piece *piece);

#endif
