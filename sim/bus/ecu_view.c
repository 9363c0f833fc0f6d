#include "sim/bus/ecu_view.h"

/** Unpacks the frame if it is this message; `then` follows when it was. */
#define TAKE(message, MESSAGE, member, then)                                                                           \
    case JP_CAN_##MESSAGE##_FRAME_ID:                                                                                  \
        if (frame->length == JP_CAN_##MESSAGE##_LENGTH) {                                                              \
            (void)jp_can_##message##_unpack(&view->member, frame->data, frame->length);                                \
            then;                                                                                                      \
        }                                                                                                              \
        break

void ecu_view_accept(struct ecu_view *view, const struct jp_can_frame *frame)
{
    switch (frame->id) {
        TAKE(ecu_status, ECU_STATUS, status, view->heard = true);
        TAKE(ecu_errors, ECU_ERRORS, errors, (void)0);
        TAKE(ecu_losses, ECU_LOSSES, losses, (void)0);
        TAKE(route_status, ROUTE_STATUS, route, (void)0);
        TAKE(pose, POSE, pose, (void)0);
        TAKE(motion, MOTION, motion, (void)0);
        TAKE(reference, REFERENCE, reference, (void)0);
        TAKE(motors, MOTORS, motors, (void)0);
        TAKE(energy_spent, ENERGY_SPENT, spent, (void)0);
        TAKE(energy_drawn, ENERGY_DRAWN, drawn, (void)0);
        TAKE(segment_motion, SEGMENT_MOTION, segment_motion, view->segment_begins = true);
        TAKE(segment_shape, SEGMENT_SHAPE, segment_shape, (void)0);
        TAKE(segment_forecast, SEGMENT_FORECAST, segment_forecast, view->segment_planned = true);
        TAKE(segment_result, SEGMENT_RESULT, segment_result, view->segment_ended = true);
        TAKE(learned, LEARNED, learned, (void)0);
        TAKE(learner_status, LEARNER_STATUS, learner, (void)0);
        TAKE(map_status, MAP_STATUS, map, (void)0);
        TAKE(navigation_status, NAVIGATION_STATUS, navigation, (void)0);
        TAKE(navigation_progress, NAVIGATION_PROGRESS, left, view->left_told = true);
        TAKE(course_leg, COURSE_LEG, leg, view->leg_told = true);
        TAKE(home_status, HOME_STATUS, home, (void)0);
        TAKE(home_battery, HOME_BATTERY, home_battery, (void)0);
        TAKE(map_pose, MAP_POSE, map_pose, (void)0);
        TAKE(patrol_status, PATROL_STATUS, patrol, (void)0);
        TAKE(round_status, ROUND_STATUS, round, (void)0);
        TAKE(round_battery, ROUND_BATTERY, round_battery, (void)0);
    default:
        break;
    }
}
