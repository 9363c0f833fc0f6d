/** What the ECU has told on the bus so far: its last telemetry, decoded, and the events since they were taken. */
#ifndef JOULEPATH_SIM_BUS_ECU_VIEW_H
#define JOULEPATH_SIM_BUS_ECU_VIEW_H

#include <math.h>
#include <stdbool.h>

#include "hal/can/can.h"
#include "hal/can/jp_can.h"
#include "hal/can/messages.h"

struct ecu_view {
    struct jp_can_ecu_status_t status;
    struct jp_can_ecu_errors_t errors;
    struct jp_can_ecu_losses_t losses;
    struct jp_can_route_status_t route;
    struct jp_can_pose_t pose;
    struct jp_can_motion_t motion;
    struct jp_can_reference_t reference;
    struct jp_can_motors_t motors;
    struct jp_can_energy_spent_t spent;
    struct jp_can_energy_drawn_t drawn;
    struct jp_can_segment_motion_t segment_motion;
    struct jp_can_segment_shape_t segment_shape;
    struct jp_can_segment_forecast_t segment_forecast;
    struct jp_can_segment_result_t segment_result;
    struct jp_can_learned_t learned;
    struct jp_can_learner_status_t learner;
    struct jp_can_map_status_t map;
    struct jp_can_navigation_status_t navigation;
    struct jp_can_navigation_progress_t left;
    struct jp_can_course_leg_t leg;
    struct jp_can_home_status_t home;
    struct jp_can_home_battery_t home_battery;
    struct jp_can_map_pose_t map_pose;
    struct jp_can_patrol_status_t patrol;
    struct jp_can_round_status_t round;
    struct jp_can_round_battery_t round_battery;
    bool heard;           /**< a status came */
    bool segment_begins;  /**< event: SegmentMotion came */
    bool segment_planned; /**< event: SegmentForecast came, the last of a plan */
    bool segment_ended;   /**< event: SegmentResult came */
    bool left_told;       /**< event: NavigationProgress came */
    bool leg_told;        /**< event: CourseLeg came */
};

/** J of an energy of a segment_result. */
static inline double segment_joules(int64_t energy)
{
    return ldexp((double)energy, JP_SEGMENT_RESULT_EXPONENT - 16);
}

/** Takes a frame; those of others, and of a wrong length, are ignored. */
void ecu_view_accept(struct ecu_view *view, const struct jp_can_frame *frame);

#endif
