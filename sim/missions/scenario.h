/** What a simulation runs: a libconfig file in sim/scenarios/. */
#ifndef JOULEPATH_SIM_MISSIONS_SCENARIO_H
#define JOULEPATH_SIM_MISSIONS_SCENARIO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <joulepath/segment.h>
#include <joulepath/trajectory_rule.h>

#include "sim/balancer/energy_kind.h"
#include "sim/balancer/robot_file.h"
#include "sim/missions/bezier.h"
#include "sim/skid_steer/skid_steer_model.h"

#define SCENARIO_NAME_SIZE 64

enum scenario_model { SCENARIO_IDENTIFIED, SCENARIO_PUBLISHED };

/** What drives it. */
enum scenario_kind {
    SCENARIO_BALANCER,
    SCENARIO_SKID /**< a robot that its sides steer: skid steer or differential drive */
};

struct scenario {
    char name[SCENARIO_NAME_SIZE];
    enum scenario_kind kind;
    struct robot_file robot;      /**< a balancer, */
    struct skid_steer_model skid; /**< or this */
    enum scenario_model model;
    enum energy_kind energy; /**< what is predicted, optimised and compared; the published model is of the motors' */
    bool to_stand;           /**< the mission ends, and counts, when the robot stands, not when its last segment does */
    uint64_t seed;
    double within_seconds; /**< budgets of the strategy of cruise and transients, one of which may be there; s */
    double within_joules;  /**< J; 0: none */
    size_t waypoint_count; /**< 2…BEZIER_WAYPOINTS_MAX, the first is the start */
    struct bezier_point waypoints[BEZIER_WAYPOINTS_MAX]; /**< m */
    struct jp_passage passages[BEZIER_WAYPOINTS_MAX];    /**< how cruise and transients pass them */
};

/** What is asked of its robot, of whatever kind. */
struct scenario_robot {
    const char *name;
    double rate_hz;             /**< of its ticks */
    double electronics_power_w; /**< beside what the motors take */
};

struct scenario_robot scenario_robot(const struct scenario *scenario);

/**
 * Reads and checks a scenario and its robot. On failure prints one line on stderr (file, key or line, what, what to
 * do), returns false, and *scenario is not to be used.
 */
bool scenario_load(const char *path, struct scenario *scenario);

/** The same of a scenario whose robot must be a balancer. */
bool scenario_load_balancer(const char *path, struct scenario *scenario);

#endif
