/**
 * The trajectory through waypoints by a rule, without search: close to the least energy, in integers.
 *
 * The robot cruises. At each waypoint its heading is the mean of the two lines that meet there, its turn rate that turn
 * times `turn_pace`; a blend takes `blend`, or a share of a leg that is too short for it. What is left to find, leg by
 * leg, is the line between the blends that leads to the waypoint, and its time.
 */
#ifndef JOULEPATH_TRAJECTORY_RULE_H
#define JOULEPATH_TRAJECTORY_RULE_H

#include <joulepath/trajectory.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How the robot moves when the trajectory begins. Zero: it stands upright. */
struct jp_travel_state {
    jp_q24 speed;             /**< m/s; ±8 */
    jp_q24 pitch;             /**< turn; ±1/8 */
    jp_q24 pitch_rate;        /**< turn/s; ±2 */
    jp_turns_per_s turn_rate; /**< turn/s; ±2 */
};

struct jp_trajectory_task {
    const struct jp_trajectory_config *config; /**< which passed its check */
    jp_q24 cruise;                             /**< m/s; 0.01…8 */
    struct jp_point start;
    jp_angle heading;
    struct jp_travel_state motion;
    const struct jp_point *targets; /**< neighbours are 1 mm to 512 m apart */
    uint16_t count;                 /**< at least 1 */
    bool to_stand;                  /**< at the last target; else it is passed at `cruise` */
};

/**
 * Plans the trajectory; `legs` holds one for each target and stays as long as the trajectory.
 * JP_ERR_ZERO_LENGTH, JP_ERR_ARGUMENT: as jp_segment_optimise(), or a null pointer, a count of 0, a cruise or a motion
 * out of its range. JP_ERR_INFEASIBLE: a leg is so short that no straight part is left between its blends. The
 * trajectory is not to be driven then. It passes each waypoint within 3 mm and what the robot covers in a set-point's
 * time; some millimetres more, 2.2 cm at most in 12 000 random routes, after a first leg hardly longer than the
 * start's transient. O(count); for the background.
 */
enum jp_status jp_trajectory_by_rule(const struct jp_trajectory_task *task, struct jp_trajectory_leg *legs,
                                     struct jp_trajectory *trajectory);

#ifdef __cplusplus
}
#endif

#endif
