/** A strategy's reference as a list of segment commands, for what is planned before the start. */
#ifndef JOULEPATH_SIM_MISSIONS_SCRIPT_H
#define JOULEPATH_SIM_MISSIONS_SCRIPT_H

#include <joulepath/energy.h>

#include "sim/balancer/experiment.h"
#include "sim/missions/bezier.h"

struct script_step {
    struct jp_segment_command command;
    size_t leg; /**< the leg that this step belongs to */
};

struct script {
    struct script_step *steps; /**< freed by script_free */
    size_t count;
};

/** Straight chords from waypoint to waypoint, from heading 0; durations[i] for leg i. A robot whose turns lag drives on
 *  for turn_lag seconds before it turns: its chords begin there. False without memory. */
bool script_straight(struct script *script, const struct bezier_point *waypoints, size_t count, const double *durations,
                     double turn_lag);

/** A Bézier path as short steps of constant speed and turn rate. False without memory. */
bool script_bezier(struct script *script, const struct bezier_path *path);

/** Steps that are faster than the limit by at most a hundredth keep their length and take longer: chords of arcs that
 * are driven at the limit, and curves whose optimiser weighs it. Others stay, for the robot to refuse. */
void script_keep_limit(struct script *script, jp_q24 speed_max);

void script_free(struct script *script);

#endif
