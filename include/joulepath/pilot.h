/**
 * Drives a robot through targets with the least energy: plans the whole route (route.h), learns from every segment
 * (learner.h), and forecasts the energy of a route with its uncertainty.
 *
 *   jp_pilot_work()  from the background loop, between the ticks of jp_robot_tick(): a slice of work a call
 *
 * The route is planned anew during each segment, from where the robot will be at its end, with what has been learned
 * by then; its first segment is handed to the robot. With more targets than legs the horizon recedes. A plan that is
 * late only makes the robot stand and continue from there. Until the pilot rests, nothing else may hand the robot
 * segments. A jp_robot_stop() in the middle of one ends the route with JP_ERR_STATE; jp_pilot_stop() always ends it.
 *
 * In libjoulepath_float. Without it, jp_robot_follow() drives a route.
 */
#ifndef JOULEPATH_PILOT_H
#define JOULEPATH_PILOT_H

#include <joulepath/drive_watch.h>
#include <joulepath/route.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Which of the robot's two meters (meter.h) the pilot learns from; model, horizon and learning are of the same. */
enum jp_pilot_meter { JP_PILOT_MOTORS, JP_PILOT_BATTERY };

struct jp_pilot_config {
    const struct jp_energy_model *model; /**< built in */
    const struct jp_horizon *horizon;
    const struct jp_learning *learning;
    enum jp_pilot_meter meter;
    struct jp_route_leg *legs; /**< the caller's memory */
    uint16_t leg_count;        /**< 1…JP_ROUTE_LEGS_MAX */
};

/** A segment that is planned or waits to be driven. */
struct jp_pilot_segment {
    struct jp_energy_start start;
    struct jp_segment_command command;
};

enum jp_pilot_phase {
    JP_PILOT_RESTING,  /**< no route */
    JP_PILOT_PLANNING, /**< works on a plan */
    JP_PILOT_DRIVING   /**< a segment was handed over; the next plan begins near the end of the one before it */
};

/** Private: what became of the last jp_pilot_ask(). */
enum jp_pilot_question { JP_PILOT_NOTHING_ASKED, JP_PILOT_ASKED, JP_PILOT_ANSWERED };

/** Private. */
struct jp_pilot_internal {
    struct jp_robot *robot;
    struct jp_energy_model model; /**< as learned when the last plan began */
    const struct jp_point *targets;
    uint16_t target_count;
    enum jp_pilot_question question;
    bool is_waiting; /**< a segment was handed over and has not begun */
    struct jp_drive_watch watch;
};

/** The members but `internal` may be read, and the two of the caller's be written. */
struct jp_pilot {
    struct jp_pilot_config config;
    struct jp_learner learner;      /**< what is known; its state is worth storing */
    enum jp_learned learned;        /**< what became of the last segment, once segments_learned_from > 0 */
    uint32_t segments_learned_from; /**< segments that the learner took, outliers too */
    uint32_t model_version;         /**< of the learner's state when the last plan began */
    struct jp_forecast forecast;    /**< of the last plan, all its legs */
    enum jp_pilot_phase phase;      /**< what the pilot does */
    enum jp_status status;          /**< as jp_pilot_work() returned it last */
    uint8_t battery_flags;          /**< the caller's: what jp_battery_update() found last, and what */
    uint8_t current_findings;       /**< jp_current_check_update() did; 0 where nobody asks them */
    struct jp_route route;          /**< the last plan */
    uint16_t targets_planned;       /**< of the route: their segments were handed over */
    struct jp_pilot_segment next;   /**< the first segment of the last plan */
    struct jp_pilot_internal internal;
};

/**
 * Prepares a pilot for a robot that is initialised; pointers are kept. JP_ERR_ARGUMENT: a null pointer. JP_ERR_CONFIG:
 * *field names the first field that is null or out of range, also within model, horizon, learning or limits. What was
 * stored is given to jp_learner_restore(&pilot->learner, …) afterwards.
 */
enum jp_status jp_pilot_init(struct jp_pilot *pilot, const struct jp_pilot_config *config, struct jp_robot *robot,
                             const char **field);

/**
 * Drives through `targets`, which must stay until the robot stands. Replaces an earlier route; a segment being driven
 * is driven to its end first. JP_ERR_ARGUMENT: null or empty. JP_ERR_STATE: neither balancing nor driving.
 */
enum jp_status jp_pilot_follow(struct jp_pilot *pilot, const struct jp_point *targets, uint16_t count);

/**
 * Plans through `targets` from where the robot stands, without driving. JP_ERR_STATE: it is not standing, or follows a
 * route. JP_ERR_MEMORY: more targets than legs. JP_ERR_ARGUMENT: null or empty.
 */
enum jp_status jp_pilot_ask(struct jp_pilot *pilot, const struct jp_point *targets, uint16_t count);

/** What jp_pilot_ask() asked: JP_WORKING until jp_pilot_work() has the plan; JP_ERR_NO_PLAN: nothing was asked since
 * the last route, or a stop came before the answer; JP_ERR_ARGUMENT: null; else as jp_pilot_work(). The plan's segments
 *  are in the legs. With jp_forecast_reserve() it answers "can I go there and come back?". */
enum jp_status jp_pilot_answer(const struct jp_pilot *pilot, struct jp_forecast *forecast);

/** Brakes to a balanced stand and forgets the route, at the next tick. From the context of jp_pilot_work(); constant
 *  time. */
void jp_pilot_stop(struct jp_pilot *pilot);

/**
 * A slice of background work: at most one jp_learner_update() and one jp_route_work(). To be called at least leg_count
 * + JP_ROUTE_ITERATIONS + 2 times in 0.2 s while driving, in place of jp_robot_work(). Returns the first failure of
 * planning (the robot then stops at the end of the segment), else JP_OK. JP_ERR_ARGUMENT: null.
 */
enum jp_status jp_pilot_work(struct jp_pilot *pilot);

#ifdef __cplusplus
}
#endif

#endif
