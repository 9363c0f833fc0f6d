/** A route of any length planned segment by segment and jointly over a receding horizon (joulepath/route.h). */
#ifndef JOULEPATH_SIM_MISSIONS_ROUTE_PLAN_H
#define JOULEPATH_SIM_MISSIONS_ROUTE_PLAN_H

#include <joulepath/route.h>

#include "sim/files/route_file.h"

struct route_planner {
    const struct jp_energy_model *model;
    const struct jp_horizon *horizon; /**< NULL: every segment starts settled */
    const struct jp_segment_limits *limits;
    uint16_t legs; /**< planned at once */
};

/** Two plans of the same route: a segment for each target, with its energy in the chain. */
struct route_plan {
    struct jp_segment greedy[ROUTE_FILE_TARGETS_MAX];
    struct jp_segment joint[ROUTE_FILE_TARGETS_MAX];
};

/** Plans a route from rest. False after one line on stderr that begins with `source`. */
bool route_plan_make(const struct route_planner *planner, const char *source, const struct route_file *route,
                     struct route_plan *plan);

#endif
