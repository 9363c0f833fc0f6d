/**
 * Trajectory of cruise and transients through waypoints.
 *
 * Where no waypoint is near, the least energy is spent on a straight line at constant speed. Each leg has such a
 * middle, and a blend on either side in which heading and speed change:
 *
 *   φ(t)  a cubic of the heading and the turn rate at its ends
 *   ν(t)  a quintic of the speed at its ends, without acceleration there
 *
 * ν is the flat output of wheels and body: speed, pitch and voltages of the motion follow from it and its derivatives,
 *
 *   v = ν − lag ν̈     ψ = lean₀ ν + lean₁ ν̇     (ur + ul)/2 = Σ voltsᵢ ν⁽ⁱ⁾     (ur − ul)/2 = turning₀ φ̇ + turning₁ φ̈
 *
 * so that the body leans into each change before it comes. Where the robot starts otherwise than the first leg wants,
 * at rest or in any motion, the difference in (v, ψ, ψ̇) decays in the three modes of the regulator of least ∫ u² dt,
 * which mirrors the plant's poles.
 */
#ifndef JOULEPATH_TRAJECTORY_H
#define JOULEPATH_TRAJECTORY_H

#include <stdbool.h>

#include <joulepath/point.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A set-point serves for two ticks of the robot: between them it is steered back to the path. */
#define JP_TICKS_PER_SET_POINT 2U

/** Modes in which a difference from the flat motion decays. */
#define JP_TRAVEL_MODES 3U

/** Each by the speed that it is. */
struct jp_travel_modes {
    jp_q16 decay[JP_TRAVEL_MODES];      /**< λ/ln 2, halvings a second; above 0 */
    jp_q16 share[3U * JP_TRAVEL_MODES]; /**< in a difference of v in m/s, ψ in turn and ψ̇ in turn/s; by modes; ±1 024 */
    jp_q31 keep[JP_TRAVEL_MODES];       /**< what a set-point leaves of each; above 0 */
    jp_q24 lean[JP_TRAVEL_MODES];       /**< what each adds to ψ, turn·s/m; ±16 */
    jp_q24 lean_rate[JP_TRAVEL_MODES]; /**< to ψ̇, turn/m; ±64 */
    jp_q16 volts[JP_TRAVEL_MODES];     /**< to the mean voltage, V·s/m; ±4 096 */
};

/** How wheels and body move together about standing upright; made by tools/design/gain_design.py. */
struct jp_trajectory_config {
    uint32_t tick_rate;       /**< of the robot, 1/s; 100…10 000 */
    jp_q24 turns_per_metre;   /**< 1/(2πR), turn/m; 0.1…16 */
    jp_q24 lag;               /**< s²; 0…1 */
    jp_q24 lean[2];           /**< turn·s/m, turn·s²/m; ±16 */
    jp_q16 volts[4];          /**< V·s/m, V·s²/m, V·s³/m, V·s⁴/m; ±4 096 */
    jp_q16 turning[2];        /**< V·s/turn, V·s²/turn; ±4 096 */
    jp_q16 voltage;           /**< for the motion, without what balance needs, V; above 0, at most 512 */
    jp_q24 pitch;             /**< most that a change of speed may lean, turn; above 0, at most 1/8 */
    jp_q16 blend;             /**< longest change of heading before and after a waypoint, s; 0.05…60 */
    jp_q24 turn_pace;         /**< turn rate at a waypoint by the turn there, 1/s; 0.01…64 */
    jp_turns_per_s turn_rate; /**< most, of what gyro and wheels can, turn/s; 0.01…64 */
    int32_t steering;         /**< share of the way back to the path that two ticks turn, Q32; 0…2³⁰ */
    jp_q24 aim;               /**< how steeply, turn by wheel turn off the path; 0…16 */
    struct jp_travel_modes modes;
};

/** Motion at a waypoint. */
struct jp_waypoint_motion {
    jp_angle heading;
    jp_turns_per_s turn_rate; /**< turn/s */
    jp_q24 speed;             /**< ν, m/s */
};

/** A change of heading and speed, ready for the tick: polynomials in the share s of its duration that has passed, made
 * of q = s³(10 − 15 s + 6 s²), p = s(1 − s), p², p(1 − 2s) and 1 − 6p. */
struct jp_blend {
    uint32_t set_points;        /**< 1…2²⁴ */
    uint32_t step;              /**< of s from one to the next, Q32 */
    jp_q24 wheel_rate[3];       /**< at its begin, by q, by p(1 − 2s); turn/s */
    jp_q24 pitch[3];            /**< at its begin, by q, by p²; turn */
    jp_q24 pitch_rate[2];       /**< by p², by p(1 − 2s); turn/s */
    jp_q16 common[5];           /**< at its begin, by q, by p², by p(1 − 2s), by 1 − 6p; V */
    jp_turns_per_s yaw_rate[3]; /**< at its begin, by s, by p; turn/s */
    jp_q16 difference[3];       /**< at its begin, by s, by p; V */
};

/** A straight part at constant speed, ready for the tick. */
struct jp_cruise {
    uint32_t set_points; /**< 1…2³⁰ */
    jp_q24 wheel_rate;   /**< turn/s */
    jp_q24 pitch;        /**< turn */
    jp_q16 common;       /**< V */
};

/** From a waypoint to the next. */
struct jp_trajectory_leg {
    jp_angle chord;   /**< direction of the next waypoint, by which the first blend turns to the middle */
    jp_angle heading; /**< of the middle */
    jp_q24 speed;     /**< of the middle, m/s */
    struct jp_blend begin;
    struct jp_cruise middle;
    struct jp_blend end;
    struct jp_waypoint_motion next;
};

/** Leg i is legs[i % places]: with fewer places than legs it is planned while it is driven. */
struct jp_trajectory {
    const struct jp_trajectory_leg *legs; /**< the caller's memory */
    uint16_t places;                      /**< in it; at least 1 */
    uint16_t count;                       /**< legs that are planned; may grow while the first of them are driven */
    struct jp_waypoint_motion start;
    int32_t transient[JP_TRAVEL_MODES]; /**< the modes at the start, m/s in Q28 */
};

/** What the controller has to follow. */
struct jp_set_point {
    jp_turns_per_s wheel_rate; /**< turn/s */
    jp_turns_per_s yaw_rate;   /**< turn/s */
    jp_q24 pitch;              /**< turn */
    jp_q24 pitch_rate;         /**< turn/s */
    jp_q16 common;             /**< (ur + ul)/2, V */
    jp_q16 difference;         /**< (ur − ul)/2, V */
};

/** Private: of a leg. */
enum jp_trajectory_piece { JP_BLEND_AT_BEGIN, JP_MIDDLE, JP_BLEND_AT_END };

/** Private. */
struct jp_trajectory_drive_internal {
    const struct jp_trajectory *trajectory;
    uint32_t set_points_left; /**< of the piece; 0: the piece has not begun */
    uint32_t share;           /**< s, Q32 */
    enum jp_trajectory_piece piece;
    uint16_t leg;
    uint16_t place;                /**< of the leg */
    int32_t mode[JP_TRAVEL_MODES]; /**< m/s in Q28 */
};

/** A trajectory being driven. */
struct jp_trajectory_drive {
    struct jp_trajectory_drive_internal internal;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_trajectory_check(const struct jp_trajectory_config *config, const char **field);

/** What it takes, all of whose legs are in its places, s, rounded up; config passed its check. JP_ERR_OVERFLOW: more
 * than 32 767 s, which is what *seconds then is. JP_ERR_ARGUMENT: a pointer is null. O(legs); not for ISRs. */
enum jp_status jp_trajectory_duration(const struct jp_trajectory_config *config, const struct jp_trajectory *trajectory,
                                      jp_q16 *seconds);

/** What a leg takes of the ground beside the straight line from its begin to its end, m. */
struct jp_leg_extent {
    jp_q16 aside;  /**< most that it leaves the line, on either side */
    jp_q16 beyond; /**< most that it goes beyond the end, before it comes back: wheels get ahead of a body to slow it
                      down */
};

/** `heading` is the one at the leg's begin, and nothing is left of a difference at the trajectory's start: where there
 *  is, a first leg leaves its line by less. Some 40 sines and cosines; not for ISRs. */
struct jp_leg_extent jp_trajectory_leg_extent(const struct jp_trajectory_config *config,
                                              const struct jp_trajectory_leg *leg, jp_angle heading);

/** Begins; the trajectory must stay until it is driven, each leg until the next one is. Constant time; for the control
 *  ISR. */
void jp_trajectory_begin(struct jp_trajectory_drive *drive, const struct jp_trajectory *trajectory);

/** The next set-point; false after the last leg that is planned, with *set_point not written. Constant time; for the
 *  control ISR. */
bool jp_trajectory_advance(struct jp_trajectory_drive *drive, const struct jp_trajectory_config *config,
                           struct jp_set_point *set_point);

/** Legs that are driven; the count of legs when all are. */
static inline uint16_t jp_trajectory_leg_now(const struct jp_trajectory_drive *drive)
{
    return drive->internal.leg;
}

/** The leg that comes next, at the begin of which the drive is; NULL: none is planned. Constant time; for the control
 *  ISR. */
const struct jp_trajectory_leg *jp_trajectory_next_leg(const struct jp_trajectory_drive *drive);

#ifdef __cplusplus
}
#endif

#endif
