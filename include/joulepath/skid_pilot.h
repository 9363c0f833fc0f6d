/**
 * Drives a skid-steered or differential-drive robot through targets with the least energy: plans the route as a path of
 * straight lines, turns on the spot and, where that costs less, arcs round its corners (path_corner.h), at the speeds
 * of least energy and time by its price (path_speed.h); learns from what each leg took (skid_learner.h), on a map that
 * tells grounds apart also of these (skid_grounds.h), and forecasts the energy of a route with its uncertainty.
 *
 *   jp_skid_pilot_work()  from the background loop, between the ticks of jp_skid_robot_tick(): a slice of work a call
 *
 *                 follow, ask, turn             planned                   stands
 *   resting ──────────────────────▶ planning ──────────────▶ driving ──────────────────▶ resting
 *      ▲                               │  ▲                     │
 *      └───────── asked, failed ───────┘  └──── follow, turn ───┘
 *
 * A leg leads to a target: a turn on the spot, where its line has another heading, and the line. Where its corners are
 * rounded it begins and ends in the middle of their arcs. Their radius is twice the model's half track or more: the
 * inner side keeps rolling forward, for tyres that stand or go back among others that drive hop. A route is planned
 * whole, from where the robot stands, before it is driven; one that replaces another makes the robot brake to a stand
 * first. Until the pilot rests, nothing else may hand the robot commands or paths: a jp_skid_robot_stop() in the middle
 * of a route, a fault or a disable ends it with JP_ERR_STATE; jp_skid_pilot_stop() always ends it.
 *
 * A leg's energy is counted from the call of jp_skid_pilot_work() that sees it begin to the one that sees it end, so
 * that what passes between a leg's end and that call is counted to the next leg. Of legs that end between two calls
 * nothing is learned. On a map that tells grounds apart what is learned from is not legs but their parts on one ground.
 *
 * What the lines rise by on the ground of a route is part of what they take, as far as the pieces of its path tell it.
 * Energies in Q16 are in the unit of config.model (energy.h). Nothing here is for ISRs.
 */
#ifndef JOULEPATH_SKID_PILOT_H
#define JOULEPATH_SKID_PILOT_H

#include <joulepath/evidence.h>
#include <joulepath/line_path.h>
#include <joulepath/path_corner.h>
#include <joulepath/skid_grounds.h>
#include <joulepath/skid_path_energy.h>
#include <joulepath/skid_robot.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Pieces of path that routes of so many targets take on level ground at most: lines, and turns on the spot or arcs in
 *  two halves. On other ground lines are as many pieces as there is memory for. */
#define JP_SKID_PILOT_PIECES(targets) (3U * (targets))

/** Steps by which a route can be driven slower, each by a quarter of the speed. */
#define JP_SKID_PILOT_SLOWER_MAX 8U

struct jp_skid_pilot_config {
    const struct jp_skid_energy_model *model; /**< built in */
    const struct jp_skid_learning *learning;
    struct jp_path_limits limits;    /**< of what it drives by itself */
    jp_q16 time;                     /**< what a second less is worth, W; 0…16 384 */
    jp_q24 corner;                   /**< how far inside a corner it may pass, m; 0…8; 0: it turns on the spot */
    struct jp_path_piece *pieces;    /**< memory of the route */
    uint16_t places;                 /**< in it: JP_SKID_PILOT_PIECES() of the most targets; at least that of 1 */
    struct jp_skid_grounds *grounds; /**< what is known of grounds that maps tell apart, started by
                                        jp_skid_pilot_init(); null: all ground is alike */
    const struct jp_factor_learning *ground_learning; /**< such as &jp_ground_learning; not read without grounds */
};

/** Where to go, to a stand at the last target. */
struct jp_skid_pilot_route {
    const struct jp_point *targets; /**< m, as odometry counts */
    uint16_t count;                 /**< at least 1 */
    uint8_t slower;                 /**< by so many steps; 0…JP_SKID_PILOT_SLOWER_MAX */
    const struct jp_ground *ground; /**< null: level */
};

enum jp_skid_pilot_phase {
    JP_SKID_PILOT_RESTING,  /**< no route */
    JP_SKID_PILOT_PLANNING, /**< waits for the robot to stand, plans and forecasts the whole route */
    JP_SKID_PILOT_DRIVING
};

/** A leg as planned. */
struct jp_skid_pilot_leg {
    jp_q24 speed;    /**< of its line, m/s; 0: it only turns */
    jp_q24 turn;     /**< of the heading from its begin to its end, rad; ±π */
    jp_q16 duration; /**< s */
    jp_q16 energy;   /**< as learned when it began, J */
};

/** What a leg took. */
struct jp_skid_pilot_result {
    uint16_t leg;     /**< its number in the route, from 1 */
    jp_energy energy; /**< out of the battery, J, Q32.32 */
    uint32_t ticks;   /**< that it lasted */
};

/** Private: what became of the last route that was asked for or is followed. */
enum jp_skid_pilot_question { JP_SKID_PILOT_NOTHING_ASKED, JP_SKID_PILOT_ASKED, JP_SKID_PILOT_ANSWERED };

/** Private: a leg of a path: its pieces, and how fast it begins. */
struct jp_skid_leg {
    uint16_t begin;
    uint16_t end; /**< piece after its last one */
    jp_q24 speed; /**< m/s */
};

/** Private: a route as a path, planned slice by slice. */
struct jp_skid_run {
    struct jp_lattice_path path;
    struct jp_path_limits limits;
    uint16_t rounded; /**< pieces that were looked at as corners */
    uint16_t paced;   /**< pieces whose speeds are planned */
    uint16_t halved;  /**< pieces that were looked at as arcs */
};

/** Private: the leg that is driven; the part of it that is learned from, and how the telemetry was when it began. */
struct jp_skid_pilot_watch {
    struct jp_skid_leg leg;
    jp_energy leg_energy; /**< when it began */
    uint32_t leg_tick;
    struct jp_skid_leg part;           /**< of the leg, on one ground; without grounds, all of it */
    struct jp_skid_ground_drive drive; /**< of the part, as learned when it began */
    bool is_mixed;                     /**< it was over when it was seen to begin */
    jp_energy energy;
    uint32_t tick;
    uint32_t dropped_frames;
    uint32_t saturated_ticks;
    uint8_t battery_flags;
};

/** Private. */
struct jp_skid_pilot_internal {
    struct jp_skid_robot *robot;
    struct jp_path_limits designed; /**< limits before the bus lacked voltage */
    struct jp_skid_pilot_route route;
    jp_angle heading; /**< to turn to, of a route without targets */
    enum jp_skid_pilot_question question;
    bool is_question; /**< the route is only to be forecast */
    bool is_laid;     /**< its path is laid */
    struct jp_skid_run run;
    struct jp_skid_leg surveyed; /**< the last leg that was */
    struct jp_skid_ground_sum sum;
    enum jp_status forecast_status;
    struct jp_forecast forecast;
    uint16_t commands_before; /**< telemetry.commands before the robot takes the path up */
    struct jp_skid_pilot_watch watch;
};

/** The members but `internal` may be read, and the one of the caller's be written. */
struct jp_skid_pilot {
    struct jp_skid_pilot_config config;
    struct jp_skid_learner learner;     /**< what is known; its state is worth storing */
    enum jp_learned learned;            /**< what became of the last leg, once legs_learned_from > 0 */
    uint32_t legs_learned_from;         /**< legs, or their parts, that a learner took, outliers too; saturating */
    uint32_t legs_left_out;             /**< legs that ended otherwise, or were cut short; saturating */
    enum jp_evidence evidence;          /**< of the last leg; JP_EVIDENCE_INCOMPLETE: it was cut short, or its energy
                                             cannot be told from that of another one */
    enum jp_skid_pilot_phase phase;     /**< what the pilot does */
    enum jp_status status;              /**< as jp_skid_pilot_work() returned it last */
    uint8_t battery_flags;              /**< the caller's: what jp_battery_update() found last */
    uint16_t legs_surveyed;             /**< of the route, which were planned for its forecast */
    jp_q16 duration;                    /**< of the legs surveyed, s */
    uint16_t legs_begun;                /**< of the route: driven, or handed over */
    struct jp_skid_pilot_leg leg;       /**< the last of them, once legs_begun > 0 */
    uint16_t legs_ended;                /**< of the route */
    struct jp_skid_pilot_result result; /**< of the last of them, once legs_ended > 0 */
    struct jp_skid_pilot_internal internal;
};

/**
 * Prepares a pilot for a robot that is initialised; pointers are kept. JP_ERR_ARGUMENT: a null pointer. JP_ERR_CONFIG:
 * *field names the first field that is null or out of range, also within model or learning. What was stored is given to
 * jp_skid_learner_restore(&pilot->learner, …) afterwards.
 */
enum jp_status jp_skid_pilot_init(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_config *config,
                                  struct jp_skid_robot *robot, const char **field);

/**
 * Drives a route, which is copied; its targets and its ground must stay while the pilot plans. Replaces an earlier
 * route: the robot brakes to a stand and goes on from there. JP_ERR_ARGUMENT: null, empty, or slower than can be.
 * JP_ERR_MEMORY: it has more targets than the memory is for. JP_ERR_STATE: neither standing nor driving. Else the
 * earlier route goes on.
 */
enum jp_status jp_skid_pilot_follow(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_route *route);

/** Turns on the spot to a heading, as a route of one leg, or of none where the robot has that heading, on ground that
 *  may be null. JP_ERR_STATE as jp_skid_pilot_follow(). JP_ERR_ARGUMENT: `pilot` is null. */
enum jp_status jp_skid_pilot_turn(struct jp_skid_pilot *pilot, jp_angle heading, const struct jp_ground *ground);

/**
 * Plans a route from where the robot stands, without driving. JP_ERR_STATE: it is not standing, or follows a
 * route. JP_ERR_ARGUMENT, JP_ERR_MEMORY: as jp_skid_pilot_follow().
 */
enum jp_status jp_skid_pilot_ask(struct jp_skid_pilot *pilot, const struct jp_skid_pilot_route *route);

/** What the route that was asked for, or is followed, takes, from its begin: JP_WORKING until jp_skid_pilot_work() has
 * planned it; JP_ERR_NO_PLAN: there was none, or a stop came before the answer; JP_ERR_ARGUMENT: null; JP_ERR_OVERFLOW:
 * a leg, the sum or its deviation is above 32 767 units; else as jp_skid_pilot_work(). With jp_forecast_reserve() it
 * answers "can I go there and come back?". */
enum jp_status jp_skid_pilot_answer(const struct jp_skid_pilot *pilot, struct jp_forecast *forecast);

/**
 * The bus has so many volts less than the robot was designed for, as from a battery that is low, cold or old: the
 * nominal voltage less jp_battery_voltage_under(). What is planned from now on is slower by what they turn the wheels
 * of a side, config.limits.speed and side_speed. JP_ERR_ARGUMENT: null, or below 0. JP_ERR_INFEASIBLE: less than an
 * eighth of the speed is left; all stays as it was. Two 64-bit divisions.
 */
enum jp_status jp_skid_pilot_lack_voltage(struct jp_skid_pilot *pilot, jp_q16 lacking);

/** Brakes to a stand and forgets the route, at the next tick. From the context of jp_skid_pilot_work(); constant time.
 */
void jp_skid_pilot_stop(struct jp_skid_pilot *pilot);

/**
 * A slice of background work: at most one jp_skid_learner_update() with the energy of two legs, and the straight lines
 * of a route, one jp_path_round_corner(), the speeds from one stand to the next, the halves of an arc or the energy of
 * a leg. To be called often while driving: what passes from the end of a leg to the next call is not counted to it.
 * Returns the first failure (the robot then stands, or brakes), else JP_OK. JP_ERR_ARGUMENT: null. JP_ERR_STATE: the
 * robot was stopped, disabled or found a fault. JP_ERR_ZERO_LENGTH: two targets, or the robot and the first one, are
 * less than 1 mm apart. JP_ERR_INFEASIBLE: a line is longer than a piece may be (lattice_path.h).
 */
enum jp_status jp_skid_pilot_work(struct jp_skid_pilot *pilot);

/** How far inside a corner the routes that are planned from now on may pass, m; 0…8. Constant time. */
static inline void jp_skid_pilot_pass_corners(struct jp_skid_pilot *pilot, jp_q24 corner)
{
    pilot->config.corner = corner;
}

/** The path of the route, whole while it is driven. Constant time. */
static inline const struct jp_lattice_path *jp_skid_pilot_path(const struct jp_skid_pilot *pilot)
{
    return &pilot->internal.run.path;
}

#ifdef __cplusplus
}
#endif

#endif
