/** Frames of an operator, with a counter of one's own: whoever skips, repeats or swaps one sees how it is judged. */
#ifndef JOULEPATH_TESTS_SUPPORT_COMMANDS_H
#define JOULEPATH_TESTS_SUPPORT_COMMANDS_H

#include "hal/can/jp_can.h"
#include "hal/can/messages.h"

/** Writes this counter and the CRC. */
static inline void protect_as(struct jp_can_frame *frame, uint8_t data_id, uint8_t counter)
{
    uint8_t before = (uint8_t)(counter - 1U);

    jp_e2e_protect(&before, data_id, frame->data, frame->length);
}

static inline struct jp_can_frame operator_command(uint8_t counter, uint8_t mode, uint8_t route)
{
    const struct jp_can_operator_command_t signals = {.mode = mode, .route_id = route};
    struct jp_can_frame frame = {.id = JP_CAN_OPERATOR_COMMAND_FRAME_ID, .length = JP_CAN_OPERATOR_COMMAND_LENGTH};

    (void)jp_can_operator_command_pack(frame.data, &signals, sizeof frame.data);
    protect_as(&frame, JP_DATA_ID_OPERATOR_COMMAND, counter);
    return frame;
}

static inline struct jp_can_frame route_offer(uint8_t counter, uint8_t route, uint8_t length, uint32_t crc)
{
    const struct jp_can_route_offer_t signals = {.route_id = route, .length = length, .route_crc = crc};
    struct jp_can_frame frame = {.id = JP_CAN_ROUTE_OFFER_FRAME_ID, .length = JP_CAN_ROUTE_OFFER_LENGTH};

    (void)jp_can_route_offer_pack(frame.data, &signals, sizeof frame.data);
    protect_as(&frame, JP_DATA_ID_ROUTE_OFFER, counter);
    return frame;
}

static inline struct jp_can_frame waypoint(uint8_t counter, struct jp_point point)
{
    const struct jp_can_waypoint_t signals = {.x = point.x, .y = point.y};
    struct jp_can_frame frame = {.id = JP_CAN_WAYPOINT_FRAME_ID, .length = JP_CAN_WAYPOINT_LENGTH};

    (void)jp_can_waypoint_pack(frame.data, &signals, sizeof frame.data);
    protect_as(&frame, JP_DATA_ID_WAYPOINT, counter);
    return frame;
}

static inline struct jp_can_frame goal(uint8_t counter, struct jp_point point)
{
    const struct jp_can_goal_t signals = {.x = point.x, .y = point.y};
    struct jp_can_frame frame = {.id = JP_CAN_GOAL_FRAME_ID, .length = JP_CAN_GOAL_LENGTH};

    (void)jp_can_goal_pack(frame.data, &signals, sizeof frame.data);
    protect_as(&frame, JP_DATA_ID_GOAL, counter);
    return frame;
}

static inline uint32_t route_crc(const struct jp_point *points, uint8_t length)
{
    uint32_t crc = JP_ROUTE_CRC_START;

    for (uint8_t i = 0; i < length; i++) {
        crc = jp_route_crc(crc, &points[i]);
    }
    return crc;
}

#endif
