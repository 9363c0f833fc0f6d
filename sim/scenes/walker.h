/**
 * Somebody who walks to and fro along a line, stops and turns round now and then, and does not look where the robot is.
 *
 * Nobody goes through the robot: who would, stands until it has gone, or turns round after a while. Otherwise nobody
 * avoids it. Speeds change at WALKER_ACCELERATION, so that a stop or a start takes about a step.
 */
#ifndef JOULEPATH_SIM_SCENES_WALKER_H
#define JOULEPATH_SIM_SCENES_WALKER_H

#include <stdbool.h>
#include <stddef.h>

#include "sim/base/planar.h"

#define WALKER_ACTS_MAX 6

/** People stop from 1.2 m/s, and start, in 0.6 s: a step. */
#define WALKER_ACCELERATION 2.0

/** Who cannot go on for the robot turns round after so long, s. */
#define WALKER_PATIENCE 3.0

/** A stop at a time. */
struct walker_act {
    double time; /**< when the walker begins to slow down, s */
    double rest; /**< how long it stands, s */
    bool turns;  /**< goes back afterwards */
};

struct walker {
    struct planar_point from; /**< where it starts, towards `to`; at each end it turns round */
    struct planar_point to;
    double radius;
    double speed;                            /**< m/s; above 0 */
    double starts;                           /**< s */
    bool stays;                              /**< at `to`, for ever, instead of turning round there */
    double pause;                            /**< at an end before it goes back, s */
    struct walker_act acts[WALKER_ACTS_MAX]; /**< in the order of their times */
    size_t act_count;
};

/** How it is. */
struct walker_state {
    double time;
    double along;  /**< from `from`, m */
    double speed;  /**< along the line, m/s; below 0 on the way back */
    int direction; /**< in which it goes, or will go: 1 or −1 */
    double rests_until;
    double blocked; /**< for so long, s */
    double since;   /**< when it last began to walk, to stop or to turn round, s */
    size_t act;     /**< the next one */
    bool is_slowing;
};

void walker_begin(const struct walker *walker, struct walker_state *state);

/** Where it would be after some time, if nothing is in its way. */
struct walker_state walker_next(const struct walker *walker, const struct walker_state *state, double seconds);

/** It stands because something is in its way. */
struct walker_state walker_blocked(const struct walker_state *state, double seconds);

struct planar_point walker_place(const struct walker *walker, const struct walker_state *state);

struct planar_point walker_velocity(const struct walker *walker, const struct walker_state *state);

#endif
