/**
 * Drives a robot through targets with the least energy: plans the route leg by leg (trajectory_rule.h), learns from
 * what each leg took (learner.h), and forecasts the energy of a route with its uncertainty.
 *
 *   jp_pilot_work()  from the background loop, between the ticks of jp_robot_tick(): a slice of work a call
 *
 *                 follow, ask                    planned                   stands
 *   resting ──────────────────────▶ planning ──────────────▶ driving ──────────────────▶ resting
 *      ▲                               │  ▲                     │
 *      └───────── asked, failed ───────┘  └────── follow ───────┘
 *
 * A route is planned whole before its first leg is driven, so that what cannot be driven is refused where the robot
 * stands, or at the end of the leg that it drives. Where legs are too short for the cruise of least energy the whole
 * route is driven slower. The legs are planned once more as they are driven, each shortly
 * before the one before it ends: a route may have any number. A leg that is late only makes the robot stand and
 * continue from there. Until the pilot rests, nothing else may hand the robot segments or trajectories. A
 * jp_robot_stop() in the middle of a leg ends the route with JP_ERR_STATE; jp_pilot_stop() always ends it.
 *
 * Its energies in Q16 are in the unit of config.model (energy.h).
 */
#ifndef JOULEPATH_PILOT_H
#define JOULEPATH_PILOT_H

#include <joulepath/evidence.h>
#include <joulepath/learner.h>
#include <joulepath/robot.h>
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Legs of which the robot drives one while the next is planned. */
#define JP_PILOT_PLACES 2U

/** Which of the robot's two meters (meter.h) the pilot learns from; model and learning are of the same. */
enum jp_pilot_meter { JP_PILOT_MOTORS, JP_PILOT_BATTERY };

struct jp_pilot_config {
    const struct jp_energy_model *model; /**< built in */
    const struct jp_learning *learning;  /**< null: nothing is learned, and a forecast has no deviation */
    enum jp_pilot_meter meter;
};

/** A cruise that legs have no room for is lowered by a quarter, so often at most: to a tenth. */
#define JP_PILOT_SLOWER_MAX 8U

/** How a route ends. */
enum jp_pilot_end {
    JP_PILOT_STAND, /**< at a stand at the last target */
    JP_PILOT_PASS   /**< in motion at the last target; then the robot rolls beyond it and comes back to a stand there,
                         which no leg counts */
};

/** Where to go. */
struct jp_pilot_route {
    const struct jp_point *targets;
    uint16_t count; /**< at least 1 */
    enum jp_pilot_end end;
    const struct jp_passage *passages; /**< of each target; null: as costs least */
    uint8_t slower; /**< times that the cruise is lowered by a quarter beforehand; 0…JP_PILOT_SLOWER_MAX */
};

enum jp_pilot_phase {
    JP_PILOT_RESTING,  /**< no route */
    JP_PILOT_PLANNING, /**< plans and forecasts the whole route */
    JP_PILOT_DRIVING
};

/** A leg as planned. */
struct jp_pilot_leg {
    jp_q24 speed;    /**< of its middle, m/s */
    jp_q24 turn;     /**< of the heading from its begin to its end, rad; ±π */
    jp_q16 duration; /**< s */
    jp_q16 energy;   /**< as learned, J */
};

/** Private: what became of the last jp_pilot_ask() or jp_pilot_follow(). */
enum jp_pilot_question { JP_PILOT_NOTHING_ASKED, JP_PILOT_ASKED, JP_PILOT_ANSWERED };

/** Private: the whole route, planned ahead for its forecast. */
struct jp_pilot_survey {
    struct jp_trajectory_plan plan;
    struct jp_trajectory trajectory;
    struct jp_trajectory_leg leg;
    jp_q24 modes[JP_TRAVEL_MODES];
    struct jp_forecast_sum sum;
};

/** Private: the trajectory that the robot drives. */
struct jp_pilot_drive {
    struct jp_trajectory_plan plan;
    struct jp_trajectory trajectory;
    struct jp_trajectory_leg legs[JP_PILOT_PLACES];
    struct jp_leg_energy energy[JP_PILOT_PLACES];
    jp_q24 modes[JP_TRAVEL_MODES];
    jp_angle heading;        /**< in which the next leg begins */
    bool is_waiting;         /**< it was handed over and has not begun */
    bool is_driven;          /**< it has begun and not ended */
    bool is_stopped;         /**< one of both, and the robot was told to stop */
    uint16_t segment_before; /**< telemetry.segment before its first leg */
    uint16_t begun;          /**< its legs */
    struct jp_segment_watch watch;
};

/** Private. */
struct jp_pilot_internal {
    struct jp_robot *robot;
    struct jp_energy_model model;           /**< as learned when the last plan began */
    struct jp_trajectory_config trajectory; /**< of the robot, with the voltage that the bus has for it */
    struct jp_back_emf back_emf;
    struct jp_pilot_route route;
    enum jp_pilot_question question;
    bool is_question;  /**< the route is only to be forecast */
    bool is_surveying; /**< the survey has begun */
    bool is_onward;    /**< it goes on from a leg that is driven or is to be */
    bool needs_stand;  /**< the route cannot go on from there */
    uint8_t slower;    /**< times that the cruise was lowered, for legs that are too short for it */
    enum jp_status forecast_status;
    struct jp_forecast forecast;
    struct jp_pilot_survey survey;
    struct jp_pilot_drive drive;
};

/** The members but `internal` may be read, and the two of the caller's be written. */
struct jp_pilot {
    struct jp_pilot_config config;
    struct jp_learner learner;  /**< what is known; its state is worth storing */
    enum jp_learned learned;    /**< what became of the last leg, once legs_learned_from > 0 */
    uint32_t legs_learned_from; /**< legs that the learner took, outliers too; saturating */
    uint32_t legs_left_out;     /**< legs that ended otherwise, saturating */
    enum jp_evidence evidence;  /**< of the last leg that ended */
    enum jp_pilot_phase phase;  /**< what the pilot does */
    enum jp_status status;      /**< as jp_pilot_work() returned it last */
    uint8_t battery_flags;      /**< the caller's: what jp_battery_update() found last, and what */
    uint8_t current_findings;   /**< jp_current_check_update() did; 0 where nobody asks them */
    uint16_t targets_surveyed;  /**< of the route, whose legs were planned for its forecast */
    uint16_t targets_planned;   /**< whose legs were handed over */
    struct jp_pilot_leg leg;    /**< of the last of them */
    struct jp_pilot_internal internal;
};

/**
 * Prepares a pilot for a robot that is initialised; pointers are kept. JP_ERR_ARGUMENT: a null pointer. JP_ERR_CONFIG:
 * *field names the first field that is null or out of range, also within model or learning. What was stored is given to
 * jp_learner_restore(&pilot->learner, …) afterwards.
 */
enum jp_status jp_pilot_init(struct jp_pilot *pilot, const struct jp_pilot_config *config, struct jp_robot *robot,
                             const char **field);

/**
 * Drives a route, which is copied; its targets and passages must stay until the robot stands or another route replaces
 * them. Replaces an earlier route; a leg that is driven or was handed over is driven to its end first, and the robot
 * stands there if it cannot go on in motion. JP_ERR_ARGUMENT: null, empty, or slower than can be. JP_ERR_STATE: neither
 * balancing nor driving.
 */
enum jp_status jp_pilot_follow(struct jp_pilot *pilot, const struct jp_pilot_route *route);

/**
 * Plans a route from where the robot stands, without driving. JP_ERR_STATE: it is not standing, or follows a
 * route. JP_ERR_ARGUMENT: null or empty.
 */
enum jp_status jp_pilot_ask(struct jp_pilot *pilot, const struct jp_pilot_route *route);

/** What the route that was asked for, or is followed, takes, from its begin: JP_WORKING until jp_pilot_work() has
 * planned it; JP_ERR_NO_PLAN: there was none, or a stop came before the answer; JP_ERR_ARGUMENT: null; JP_ERR_OVERFLOW:
 * a leg, the sum or its deviation is above 32 767 J; else as jp_pilot_work(). With jp_forecast_reserve() it answers
 * "can I go there and come back?". */
enum jp_status jp_pilot_answer(const struct jp_pilot *pilot, struct jp_forecast *forecast);

/** Brakes to a balanced stand and forgets the route, at the next tick. From the context of jp_pilot_work(); constant
 *  time. */
void jp_pilot_stop(struct jp_pilot *pilot);

/**
 * A slice of background work: at most one jp_learner_update_leg() and one jp_trajectory_plan_leg(). To be called at
 * least twice in 0.2 s while driving, where legs take longer. Returns the first failure of planning (the robot then
 * stands, or stops at the end of the leg), else JP_OK. JP_ERR_ARGUMENT: null.
 */
enum jp_status jp_pilot_work(struct jp_pilot *pilot);

/**
 * The bus has so many volts less than the robot was designed for, as from a battery that is low, cold or old: the
 * nominal voltage less jp_battery_voltage_under(). What is planned from now on takes so much less for its motion, what
 * balance keeps stays, and no leg is faster than by the share that is left. JP_ERR_ARGUMENT: null, or below 0.
 * JP_ERR_INFEASIBLE: less than an eighth of the motion's voltage is left; all stays as it was. Constant time.
 */
enum jp_status jp_pilot_lack_voltage(struct jp_pilot *pilot, jp_q16 lacking);

/** The cruise of this pilot's plans by a model, m/s: jp_pilot_cruise(), at most limits.speed by the share of the
 * voltage that is left. */
jp_q24 jp_pilot_cruise_now(const struct jp_pilot *pilot, const struct jp_energy_model *model);

/* For those who plan or measure without a pilot as it does. Constant time; robot and model passed their checks. */

/** The cruise of a pilot's plans, m/s: jp_cruise_speed() of what it knows, at most limits.speed. */
jp_q24 jp_pilot_cruise(const struct jp_robot_config *robot, const struct jp_energy_model *model);

/** Of the robot's motors, so that jp_trajectory_leg_energy() tells what this meter counts: zero of JP_PILOT_MOTORS. */
struct jp_back_emf jp_pilot_back_emf(const struct jp_robot_config *robot, enum jp_pilot_meter meter);

#ifdef __cplusplus
}
#endif

#endif
