/** Frames of every kind for the decoders, from a seed: sound but for their content, spoilt, foreign, garbage. */
#ifndef JOULEPATH_TESTS_SUPPORT_RANDOM_FRAMES_H
#define JOULEPATH_TESTS_SUPPORT_RANDOM_FRAMES_H

#include <stdio.h>
#include <string.h>

#include "tests/support/ecu_start.h"
#include "tests/support/random.h"
#include "unity.h"

static unsigned long executions;

/** For one_in(). */
#define NEVER 0U

static int32_t around(int32_t limit)
{
    return (int32_t)below(2U * (uint32_t)limit + 1U) - limit;
}

static void require(bool condition, const char *what)
{
    if (!condition) {
        printf("execution %lu\n", executions);
        TEST_FAIL_MESSAGE(what);
    }
}

/** The data frames of joulepath.dbc but for those of the lockstep. */
static const struct message {
    uint32_t id;
    uint8_t length;
    enum { TO_ECU, OPERATORS, FROM_ECU, OTHERS } kind;
    uint8_t data_id; /**< 0: not protected by itself */
} messages[] = {
    {0x010, 8, FROM_ECU, JP_DATA_ID_MOTOR_COMMAND},
    {0x011, 8, FROM_ECU, 0},
    {0x020, 8, TO_ECU, 0},
    {0x021, 8, TO_ECU, 0},
    {0x022, 8, TO_ECU, 0},
    {0x023, 8, OTHERS, 0}, /* these five to a robot with four steered wheels */
    {0x024, 8, OTHERS, 0},
    {0x030, 4, OTHERS, 0},
    {0x031, 8, OTHERS, 0},
    {0x032, 8, OTHERS, 0},
    {0x033, 8, OPERATORS, JP_DATA_ID_BATTERY_CHARGE},
    {0x100, 4, OPERATORS, JP_DATA_ID_OPERATOR_COMMAND},
    {0x101, 8, OPERATORS, JP_DATA_ID_ROUTE_OFFER},
    {0x102, 8, OPERATORS, JP_DATA_ID_WAYPOINT},
    {0x103, 8, OPERATORS, JP_DATA_ID_GOAL},
    {0x104, 8, OPERATORS, JP_DATA_ID_MAP_OFFER},
    {0x105, 8, OPERATORS, JP_DATA_ID_MAP_DATA},
    {0x106, 8, OPERATORS, JP_DATA_ID_CELL_CHANGES},
    {0x107, 8, OPERATORS, JP_DATA_ID_MAP_GOAL},
    {0x108, 8, OPERATORS, JP_DATA_ID_ROUND_OFFER},
    {0x109, 8, OPERATORS, JP_DATA_ID_ROUND_DATA},
    {0x180, 8, FROM_ECU, 0},
    {0x181, 8, FROM_ECU, 0},
    {0x182, 8, FROM_ECU, 0},
    {0x183, 8, FROM_ECU, 0},
    {0x184, 8, FROM_ECU, 0},
    {0x185, 8, FROM_ECU, 0},
    {0x186, 8, FROM_ECU, 0},
    {0x187, 8, FROM_ECU, 0},
    {0x188, 8, FROM_ECU, 0},
    {0x189, 8, FROM_ECU, 0},
    {0x18A, 8, FROM_ECU, 0},
    {0x18B, 8, FROM_ECU, 0},
    {0x18C, 8, FROM_ECU, 0},
    {0x18D, 8, FROM_ECU, 0},
    {0x18E, 8, FROM_ECU, 0},
    {0x18F, 8, FROM_ECU, 0},
    {0x190, 8, OTHERS, 0},
    {0x191, 8, FROM_ECU, 0},
    {0x192, 8, FROM_ECU, 0},
    {0x193, 8, FROM_ECU, 0},
    {0x194, 8, FROM_ECU, 0},
    {0x195, 8, FROM_ECU, 0},
    {0x196, 8, FROM_ECU, 0},
    {0x197, 8, FROM_ECU, 0},
    {0x198, 8, FROM_ECU, 0},
    {0x199, 8, FROM_ECU, 0},
    {0x19A, 8, FROM_ECU, 0},
    {0x19B, 8, FROM_ECU, 0},
    {0x19C, 8, FROM_ECU, 0},
    {0x19D, 8, FROM_ECU, 0},
    {0x19E, 8, FROM_ECU, 0},
    {0x19F, 8, FROM_ECU, 0},
};
#define MESSAGES (sizeof messages / sizeof messages[0])

static const struct message *message_of(uint32_t id)
{
    for (size_t i = 0; i < MESSAGES; i++) {
        if (messages[i].id == id) {
            return &messages[i];
        }
    }
    return NULL;
}

static void randomise_data(struct jp_can_frame *frame)
{
    const uint64_t bits = random_bits();

    memcpy(frame->data, &bits, sizeof frame->data);
}

static uint8_t random_length(void)
{
    return (uint8_t)(one_in(4) ? below(256) : below(JP_CAN_LENGTH_MAX + 1U));
}

static struct jp_can_frame foreign_frame(void)
{
    struct jp_can_frame frame = {.id = messages[below(MESSAGES)].id, .length = JP_CAN_LENGTH_MAX};

    switch (below(4)) {
    case 0:
        frame.id = below(0x800);
        break;
    case 1:
        frame.id = (uint32_t)random_bits();
        break;
    case 2:
        frame.id |= below(4) << 30;
        break;
    default:
        break;
    }
    if (one_in(2)) {
        frame.length = random_length();
    }
    randomise_data(&frame);
    return frame;
}

static void flip_bits(struct jp_can_frame *frame)
{
    for (uint32_t left = 1U + below(4); left > 0U; left--) {
        const uint32_t bit = below(8U * JP_CAN_LENGTH_MAX);

        frame->data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
    }
}

/** Another content under the right CRC, and mostly the right counter. */
static void forge(struct jp_can_frame *frame)
{
    const struct message *message = message_of(frame->id);
    uint8_t counter = (uint8_t)(frame->data[1] - 1U);

    if (message == NULL || message->data_id == 0U) {
        return;
    }
    if (one_in(2)) {
        frame->data[1U + below(7)] = (uint8_t)below(256);
    } else {
        randomise_data(frame);
    }
    counter = one_in(8) ? (uint8_t)below(16) : counter;
    jp_e2e_protect(&counter, message->data_id, frame->data, message->length);
}

static void spoil(struct jp_can_frame *frame)
{
    switch (below(5)) {
    case 0:
        forge(frame);
        break;
    case 1:
        frame->length = random_length();
        break;
    case 2:
        frame->id ^= one_in(2) ? 1U << below(11) : 1U << below(32);
        break;
    default:
        flip_bits(frame);
        break;
    }
}

#endif
