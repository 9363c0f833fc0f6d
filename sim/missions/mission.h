/** One scenario driven by one strategy, in closed loop, with what it planned and what it spent. */
#ifndef JOULEPATH_SIM_MISSIONS_MISSION_H
#define JOULEPATH_SIM_MISSIONS_MISSION_H

#include <stdio.h>

#include <joulepath/learner.h>

#include "sim/balancer/rig.h"
#include "sim/missions/mission_view.h"

enum mission_strategy {
    /* One segment after the other. */
    MISSION_OPTIMAL,  /**< segment_route_work: each segment planned for least energy */
    MISSION_STRAIGHT, /**< straight chords, with the times of MISSION_OPTIMAL */
    MISSION_BEZIER,   /**< energy-optimised cubic Bézier curves */
    /* The whole route together. */
    MISSION_CRUISE,          /**< cruise and transients: jp_pilot_follow, learning on the way; within a budget
                                  jp_trajectory_budget_work */
    MISSION_STRAIGHT_CRUISE, /**< straight chords, with the times of MISSION_CRUISE */
    MISSION_BEZIER_ROUTE,    /**< energy-optimised cubic Bézier curves */
    /* By itself. */
    MISSION_OPTIMISED_CRUISE, /**< as MISSION_CRUISE, headings and speeds found by jp_trajectory_optimiser_work */
    /* A robot that its sides steer: jp_skid_pilot_follow, learning on the way. */
    MISSION_ROUNDED,       /**< an arc, within half of the robot's track, where that costs less */
    MISSION_TURN_AND_GO,   /**< it stands and turns at each corner */
    MISSION_ROUNDED_AGAIN, /**< as MISSION_ROUNDED, with what that has learned and other noise */
    MISSION_STRATEGIES
};

/** Those of a kind that are compared. */
#define MISSION_BALANCER_COMPARED 6
#define MISSION_SKID_COMPARED     3

/** One leg from waypoint to waypoint. */
struct mission_leg {
    struct bezier_point target;
    bool planned;            /**< one segment, planned before it was driven: the plan below holds */
    double planned_energy;   /**< J */
    double speed;            /**< v, m/s */
    double turn_rate;        /**< w, rad/s */
    double arc;              /**< γ, rad */
    double turn;             /**< σ, rad */
    double duration;         /**< T, s */
    double measured_energy;  /**< the robot's meter, the scenario's kind of energy, J */
    double plant_energy;     /**< the same from the plant's ledger in double, J */
    double battery_energy;   /**< the robot's meter, at the battery, J */
    struct bezier_point end; /**< where the robot was, m */
    double end_error;        /**< distance to the target, m */
    double passed;           /**< least distance to it at any time, m */
    double end_speed;        /**< m/s */
};

/** What a pilot says before it starts. */
struct mission_forecast {
    bool known;       /**< a pilot drives, and has a leg for each target */
    double energy;    /**< J */
    double deviation; /**< standard deviation, J */
};

#define MISSION_REASON_SIZE 160

/** The robot stands when it has been at rest for so long; it shall within so long after its last leg; s. */
#define MISSION_REST_SECONDS        0.5
#define MISSION_BRAKING_SECONDS_MAX 60.0

struct mission {
    enum mission_strategy strategy;
    char impossible[MISSION_REASON_SIZE]; /**< why the strategy cannot drive the route; empty: it did */
    struct mission_forecast forecast;
    size_t leg_count;
    struct mission_leg legs[BEZIER_WAYPOINTS_MAX];
    struct mission_leg braking; /**< from the end of the last leg to the stand, if the scenario ends there */
    struct mission_leg total;   /**< sums; end and end_error of the last of them */
    uint64_t ticks;
    uint64_t saturated_ticks;
    double wall_seconds;
    struct jp_learned_state learned; /**< at its end, by a robot that its sides steer */
};

/** The energy model that the scenario asks for, or NULL after one line on stderr. */
const struct jp_energy_model *mission_model(const struct scenario *scenario, const struct robot_entry *entry);

/**
 * Drives the scenario and fills *mission. `driven` holds the missions by strategy, of which straight chords take the
 * times of the one that they are compared with; NULL for the others. `view` may be NULL. False when the strategy cannot
 * drive the route, which mission->impossible says, and, with that empty, after one line on stderr.
 */
bool mission_run(struct mission *mission, enum mission_strategy strategy, const struct scenario *scenario,
                 const struct mission *driven, const struct mission_view *view);

/** For those who drive: the strategy cannot drive the route, for this reason; false, for the caller to return. */
__attribute__((format(printf, 2, 3))) bool mission_cannot(struct mission *mission, const char *format, ...);

/** Says in one line on stderr why the strategy cannot drive the route, if that is so. */
void mission_complain(const struct mission *mission, const struct scenario *scenario);

/** For missions that are driven otherwise: a leg's target; in each tick, how near the robot comes to the waypoints
 * before and after a leg; the plant's motor energy of the scenario's kind in J, whether the robot is at rest, the sums
 * of the legs and the braking, the clock in seconds. */
void mission_set_target(struct mission_leg *leg, struct bezier_point target);
void mission_note_passing(struct mission *mission, size_t leg, struct bezier_point position);
double mission_plant_energy(const struct scenario *scenario, const struct plant *plant);
bool mission_is_at_rest(const struct scenario *scenario, const struct plant *plant);
void mission_sum_up(struct mission *mission);
double mission_wall_clock(void);

#endif
