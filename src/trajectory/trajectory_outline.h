/** A leg of a plan before its middle is found. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_TRAJECTORY_OUTLINE_H
#define JOULEPATH_TRAJECTORY_TRAJECTORY_OUTLINE_H

#include <joulepath/trajectory_rule.h>

/** What holds at a leg's ends. */
struct jp_leg_outline {
    uint32_t begin; /**< set-points of its first blend */
    uint32_t end;   /**< of its last */
    struct jp_waypoint_motion next;
    struct jp_chord following; /**< of the leg after it, if there is one */
    struct jp_chord later;     /**< and after that */
    bool ends_straight;        /**< in the heading of its middle */
};

/** As jp_trajectory_plan_start(), without a trajectory. */
enum jp_status jp_plan_begin(struct jp_trajectory_plan *plan, const struct jp_trajectory_task *task);

/** That of the leg that is planned next. Failures as jp_trajectory_plan_leg(), but for those of the middle. */
enum jp_status jp_leg_outline(const struct jp_trajectory_plan *plan, struct jp_leg_outline *outline);

/** The leg is planned: the next one is due. */
void jp_leg_pass(struct jp_trajectory_plan *plan, const struct jp_leg_outline *outline);

#endif
