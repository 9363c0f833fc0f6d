/**
 * The trajectory through waypoints by a rule, without search: close to the least energy, in integers.
 *
 * The robot cruises. At each waypoint its heading is the mean of the two lines that meet there, its turn rate that turn
 * times `turn_pace`; a blend takes `blend`, or a share of a leg that is too short for it. What is left to find, leg by
 * leg, is the line between the blends that leads to the waypoint, and its time. Where heading or speed at a waypoint
 * are given, the legs on both sides turn and change speed in their blends, and are slower if the motors' voltage asks
 * for it.
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

/** What is given of the motion at a target: bits of struct jp_passage. */
enum jp_given { JP_GIVEN_HEADING = 1, JP_GIVEN_SPEED = 2 };

/** How a target is to be passed. Zero: as costs least. */
struct jp_passage {
    uint8_t given; /**< enum jp_given */
    jp_angle heading;
    jp_q24 speed; /**< m/s; 0.01…8. Of no account at a stand */
};

struct jp_trajectory_task {
    const struct jp_trajectory_config *config; /**< which passed its check */
    jp_q24 cruise;                             /**< m/s; 0.01…8 */
    struct jp_point start;
    jp_angle heading;
    struct jp_travel_state motion;
    const struct jp_point *targets;    /**< neighbours are 1 mm to 512 m apart */
    const struct jp_passage *passages; /**< of each target; null: nothing is given */
    uint16_t count;                    /**< at least 1 */
    bool to_stand;                     /**< at the last target; else it is passed at `cruise`, or as is given */
};

/** Private: m in Q12.20. */
struct jp_way {
    int32_t x;
    int32_t y;
};

/** Private: from one target to the next. */
struct jp_chord {
    uint32_t distance; /**< 2⁻²² m */
    jp_angle direction;
    jp_q24 speed;   /**< of the leg's middle, m/s */
    uint32_t blend; /**< set_points of each of its blends */
};

/** Private: what holds at the waypoint that the last leg leads to. */
struct jp_trajectory_plan_internal {
    struct jp_trajectory_task task;
    struct jp_chord chord;    /**< of the leg that is planned next */
    struct jp_chord next;     /**< of the one after it, whose speed may still fall; if there is one */
    struct jp_point waypoint; /**< that the last leg leads to; at first the start */
    struct jp_way ahead;      /**< where the trajectory is, from the waypoint */
    struct jp_waypoint_motion motion;
    jp_q24 modes[JP_TRAVEL_MODES];
    uint32_t blend; /**< of the last leg, at its end, set-points */
};

/** A plan in the making, leg by leg. */
struct jp_trajectory_plan {
    uint16_t planned; /**< legs */
    struct jp_trajectory_plan_internal internal;
};

/**
 * Begins a plan, and the trajectory: without a leg yet, in the caller's memory for `places` legs. The task is copied,
 * targets and passages must stay until all legs are planned, or the plan goes on to others. JP_ERR_ZERO_LENGTH,
 * JP_ERR_ARGUMENT: as jp_segment_optimise(), or a null pointer, a count or `places` of 0, a cruise, a motion or a
 * passage out of its range. JP_ERR_INFEASIBLE: the robot has not the voltage for the first turns. For the background.
 */
enum jp_status jp_trajectory_plan_start(struct jp_trajectory_plan *plan, const struct jp_trajectory_task *task,
                                        struct jp_trajectory_leg *legs, uint16_t places,
                                        struct jp_trajectory *trajectory);

/**
 * Plans the next leg. Where it goes in the trajectory, and that `count` grows, is the caller's business: it is the
 * place of a leg that is driven. JP_ERR_ZERO_LENGTH, JP_ERR_ARGUMENT, JP_ERR_INFEASIBLE: as jp_trajectory_by_rule(), of
 * this leg or the next three targets; nothing is written, and the plan cannot go on. JP_ERR_STATE: all legs are
 * planned. Bounded work: tests/bench/FIGURES.md. For the background.
 */
enum jp_status jp_trajectory_plan_leg(struct jp_trajectory_plan *plan, struct jp_trajectory_leg *leg);

/**
 * Goes on to other targets from where the last leg leads, or will: of the task, which is copied, config, start, heading
 * and motion do not count. `planned` is 0 then. Failures as jp_trajectory_plan_start(), and JP_ERR_STATE: the last leg
 * ends at a stand; nothing is written then. Constant time; for the background.
 */
enum jp_status jp_trajectory_plan_redirect(struct jp_trajectory_plan *plan, const struct jp_trajectory_task *task);

/**
 * Plans the whole trajectory; `legs` holds one for each target and stays as long as the trajectory.
 * JP_ERR_ZERO_LENGTH, JP_ERR_ARGUMENT: as jp_segment_optimise(), or a null pointer, a count of 0, a cruise, a motion
 * or a passage out of its range. JP_ERR_INFEASIBLE: a leg is so short that no straight part is left between its blends,
 * or that its speed cannot become the one that is given. The trajectory is not to be driven then. It passes each
 * waypoint within 3 mm and what the robot covers in a set-point's time; some millimetres more, 7 mm at most in 16 000
 * random routes, after a first leg hardly longer than the start's transient. O(count); for the background.
 */
enum jp_status jp_trajectory_by_rule(const struct jp_trajectory_task *task, struct jp_trajectory_leg *legs,
                                     struct jp_trajectory *trajectory);

#ifdef __cplusplus
}
#endif

#endif
