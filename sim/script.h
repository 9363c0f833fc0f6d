/** A strategy's reference as a list of segment commands, for strategies that are planned before the start. */
#ifndef JOULEPATH_SIM_SCRIPT_H
#define JOULEPATH_SIM_SCRIPT_H

#include "bezier.h"
#include "experiment.h"

struct script_step {
    struct jp_segment_command command;
    size_t leg; /**< the leg that this step belongs to */
};

struct script {
    struct script_step *steps; /**< freed by script_free */
    size_t count;
};

/** Straight chords from waypoint to waypoint, from heading 0; durations[i] for leg i. False without memory. */
bool script_straight(struct script *script, const struct bezier_point *waypoints, size_t count,
                     const double *durations);

/** A Bézier path as short steps of constant speed and turn rate. False without memory. */
bool script_bezier(struct script *script, const struct bezier_path *path);

void script_free(struct script *script);

#endif
