/**
 * What the operator's frames mean, told a second time and from their bits alone: by joulepath.dbc for the layout, CRCs
 * bit by bit. Only the rules for counters are those of jp_e2e_check(), which has tests of its own.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_COMMAND_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_COMMAND_ORACLE_H

#include "hal/can/jp_can.h"
#include "hal/can/operator_link.h"
#include "hal/can/route_link.h"

struct command_oracle {
    struct jp_e2e_receiver command_receiver;
    struct jp_e2e_receiver offer_receiver;
    struct jp_e2e_receiver goal_receiver;

    bool stood; /**< a valid Stand was heard, and since then neither Off nor a silence */
    enum jp_operator_mode mode;
    uint8_t route; /**< that Drive means */
    uint8_t heard; /**< mode and route of the last valid command */
    uint8_t heard_route;
    unsigned in_a_row;
    uint32_t silence; /**< ticks */

    struct jp_route_message offered;
    uint32_t offered_crc;
    uint8_t received;
    uint8_t counter; /**< of the last waypoint */
    bool broken;     /**< the route is not to be had whole any more */
};

static uint8_t oracle_crc8(const uint8_t *bytes, size_t length, uint8_t data_id)
{
    unsigned crc = 0xFF;

    for (size_t i = 1; i <= length; i++) {
        crc ^= i < length ? bytes[i] : data_id;
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 0x80U) != 0U ? ((crc << 1) ^ 0x2FU) & 0xFFU : crc << 1;
        }
    }
    return (uint8_t)(crc ^ 0xFFU);
}

static uint64_t oracle_bits(const struct jp_can_frame *frame, unsigned first, unsigned count)
{
    uint64_t all = 0;

    for (unsigned i = 0; i < JP_CAN_LENGTH_MAX; i++) {
        all |= (uint64_t)frame->data[i] << (8U * i);
    }
    return (all >> first) & ((UINT64_C(1) << count) - 1U);
}

static struct jp_point oracle_point(const struct jp_can_frame *frame)
{
    const uint32_t x = (uint32_t)oracle_bits(frame, 12, 26);
    const uint32_t y = (uint32_t)oracle_bits(frame, 38, 26);

    return (struct jp_point){.x = (int32_t)(x << 6) / 64, .y = (int32_t)(y << 6) / 64};
}

static uint32_t oracle_crc32(const struct jp_route_message *route)
{
    uint32_t crc = UINT32_MAX;

    for (unsigned bit = 0; bit < 64U * route->length; bit++) {
        const struct jp_point *point = &route->points[bit / 64U];
        const uint32_t word = (uint32_t)(bit % 64U < 32U ? point->x : point->y);

        crc = (crc >> 1) ^ (((crc ^ (word >> (bit % 32U))) & 1U) != 0U ? 0xEDB88320U : 0U);
    }
    return ~crc;
}

static bool oracle_is_whole(const struct command_oracle *oracle)
{
    return !oracle->broken && oracle->offered.length > 0U && oracle->received == oracle->offered.length &&
           (oracle->offered.id == JP_ROUTE_GOAL || oracle_crc32(&oracle->offered) == oracle->offered_crc);
}

static void oracle_take_command(struct command_oracle *oracle, const struct jp_can_frame *frame)
{
    const uint8_t before = oracle->command_receiver.counter;
    const uint8_t mode = (uint8_t)oracle_bits(frame, 12, 3);
    const uint8_t route = frame->data[2];

    const enum jp_e2e_result result =
        jp_e2e_check(&oracle->command_receiver, JP_DATA_ID_OPERATOR_COMMAND, frame->data, 4);

    if ((result == JP_E2E_REPEATED || result == JP_E2E_SEQUENCE) && mode == JP_MODE_STAND) {
        oracle->in_a_row = 0;
        oracle->mode = oracle->mode >= JP_MODE_DRIVE ? JP_MODE_STAND : oracle->mode;
    }
    if (result != JP_E2E_OK) {
        return;
    }
    if (mode > JP_MODE_NAVIGATE) {
        oracle->in_a_row = 0;
        return;
    }
    const bool goes_on =
        oracle->heard == mode && oracle->heard_route == route && (frame->data[1] & 15U) == ((before + 1U) & 15U);

    oracle->in_a_row = goes_on ? oracle->in_a_row + 1U : 1U;
    oracle->heard = mode;
    oracle->heard_route = route;
    oracle->silence = 0;
    if (mode == JP_MODE_STAND) {
        oracle->stood = true;
        oracle->mode = JP_MODE_STAND;
    } else if (mode == JP_MODE_OFF && oracle->in_a_row >= 3U) {
        oracle->stood = false;
        oracle->mode = JP_MODE_OFF;
    } else if (mode >= JP_MODE_DRIVE && oracle->in_a_row >= 3U && oracle->stood) {
        oracle->mode = (enum jp_operator_mode)mode;
        oracle->route = route;
    }
}

/** An offer that comes twice is one. */
static void oracle_take_offer(struct command_oracle *oracle, const struct jp_can_frame *frame)
{
    const struct jp_route_message *old = &oracle->offered;
    const uint32_t crc = (uint32_t)oracle_bits(frame, 32, 32);
    const bool same = old->id == frame->data[2] && old->length == frame->data[3] && oracle->offered_crc == crc;
    const enum jp_e2e_result result = jp_e2e_check(&oracle->offer_receiver, JP_DATA_ID_ROUTE_OFFER, frame->data, 8);

    if (result == JP_E2E_CRC || (result == JP_E2E_REPEATED && same)) {
        return;
    }
    oracle->offered = (struct jp_route_message){.id = frame->data[2], .length = frame->data[3]};
    oracle->offered_crc = crc;
    oracle->received = 0;
    oracle->broken = oracle->offered.id == 0U || oracle->offered.length == 0U || oracle->offered.length > 32U;
}

static void oracle_take_waypoint(struct command_oracle *oracle, const struct jp_can_frame *frame)
{
    const uint8_t counter = frame->data[1] & 15U;

    if (frame->data[0] != oracle_crc8(frame->data, 8, JP_DATA_ID_WAYPOINT) || oracle->broken ||
        oracle->received >= oracle->offered.length || (oracle->received > 0U && counter == oracle->counter)) {
        return;
    }
    oracle->broken = oracle->received > 0U && counter != ((oracle->counter + 1U) & 15U);
    oracle->offered.points[oracle->received] = oracle_point(frame);
    oracle->received++;
    oracle->counter = counter;
}

static void oracle_take_goal(struct command_oracle *oracle, const struct jp_can_frame *frame)
{
    if (jp_e2e_check(&oracle->goal_receiver, JP_DATA_ID_GOAL, frame->data, 8) == JP_E2E_OK) {
        oracle->offered = (struct jp_route_message){.id = JP_ROUTE_GOAL, .length = 1, .points = {oracle_point(frame)}};
        oracle->received = 1;
        oracle->broken = false;
    }
}

/** A frame of the right length that the application takes up. */
static void oracle_take(struct command_oracle *oracle, const struct jp_can_frame *frame)
{
    switch (frame->id) {
    case JP_CAN_OPERATOR_COMMAND_FRAME_ID:
        oracle_take_command(oracle, frame);
        break;
    case JP_CAN_ROUTE_OFFER_FRAME_ID:
        oracle_take_offer(oracle, frame);
        break;
    case JP_CAN_WAYPOINT_FRAME_ID:
        oracle_take_waypoint(oracle, frame);
        break;
    default:
        oracle_take_goal(oracle, frame);
        break;
    }
}

static void oracle_pass(struct command_oracle *oracle, uint32_t ticks, uint32_t timeout)
{
    oracle->silence += ticks;
    if (oracle->silence < timeout || !oracle->stood) {
        return;
    }
    oracle->stood = false;
    oracle->in_a_row = 0;
    if (oracle->mode >= JP_MODE_DRIVE) {
        oracle->mode = JP_MODE_STAND;
    }
}

#endif
