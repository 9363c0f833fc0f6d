#include "hal/can/wheel_link.h"

#include <joulepath/count.h>

#include "hal/can/jp_can.h"
#include "hal/can/messages.h"

/** Fraction bits of the library's value that its signal leaves out. */
#define ANGLE_SHIFT   8U /* 2⁻³² to 2⁻²⁴ turn */
#define SPEED_SHIFT   4U /* Q24 to Q20 */
#define VOLTAGE_SHIFT 9U /* Q16 to Q7 */
#define CURRENT_SHIFT 6U /* Q16 to Q10 */

#define COUNT_BITS 24U
#define COUNT_MASK ((1U << COUNT_BITS) - 1U)

#define ALL_WHEELS ((1U << (unsigned)JP_WHEELS) - 1U)
#define ALL_PARTS  ((1U << JP_WHEEL_SAMPLE_FRAMES) - 1U)

static int32_t to_signal(int32_t value, unsigned shift, unsigned bits)
{
    const int32_t limit = (int32_t)1 << (bits - 1U);

    return jp_clamp32(jp_round_shift(value, shift), -limit, limit - 1);
}

static int32_t from_signal(int32_t raw, unsigned shift)
{
    return raw * (int32_t)(1U << shift);
}

/** A part with another counter than those before it begins a group. */
static void note_part(struct jp_wheel_group *group, unsigned part, uint8_t counter)
{
    if (counter != group->counter) {
        group->parts = 0;
        group->counter = counter;
    }
    group->parts |= (uint8_t)(1U << part);
}

/* Targets. */

void jp_wheel_targets_pack(struct jp_can_frame frames[JP_WHEELS], uint8_t *counter,
                           const struct jp_four_wheel_actuation *actuation)
{
    const uint8_t before = *counter;

    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        const struct jp_can_wheel_target_t signals = {.wheel = (uint8_t)i,
                                                      .enabled = actuation->enabled != 0U ? 1U : 0U,
                                                      .angle = to_signal(actuation->wheels.angle[i], ANGLE_SHIFT, 24),
                                                      .speed = to_signal(actuation->wheels.speed[i], SPEED_SHIFT, 25)};

        *counter = before;
        frames[i] = (struct jp_can_frame){.id = JP_CAN_WHEEL_TARGET_FRAME_ID, .length = JP_CAN_WHEEL_TARGET_LENGTH};
        (void)jp_can_wheel_target_pack(frames[i].data, &signals, sizeof frames[i].data);
        jp_e2e_protect(counter, JP_DATA_ID_WHEEL_TARGET, frames[i].data, frames[i].length);
    }
}

static void take_target(struct jp_wheel_targets *targets, const struct jp_can_wheel_target_t *signals)
{
    const uint8_t bit = (uint8_t)(1U << signals->wheel);

    targets->parts.wheels.angle[signals->wheel] = from_signal(signals->angle, ANGLE_SHIFT);
    targets->parts.wheels.speed[signals->wheel] = from_signal(signals->speed, SPEED_SHIFT);
    targets->enabled = (uint8_t)(signals->enabled != 0U ? targets->enabled | bit : targets->enabled & ~(unsigned)bit);
}

enum jp_e2e_result jp_wheel_targets_accept(struct jp_wheel_targets *targets, const struct jp_can_frame *frame,
                                           struct jp_four_wheel_actuation *actuation, bool *is_whole)
{
    struct jp_can_wheel_target_t signals;
    enum jp_e2e_result result;

    *is_whole = false;
    (void)jp_can_wheel_target_unpack(&signals, frame->data, frame->length);
    result =
        jp_e2e_check(&targets->group.receivers[signals.wheel], JP_DATA_ID_WHEEL_TARGET, frame->data, frame->length);
    if (result != JP_E2E_OK) {
        return result;
    }
    take_target(targets, &signals);
    note_part(&targets->group, signals.wheel, signals.counter);
    *is_whole = targets->group.parts == ALL_WHEELS;
    if (*is_whole) {
        targets->group.parts = 0;
        targets->parts.enabled = targets->enabled == ALL_WHEELS ? 1U : 0U;
        *actuation = targets->parts;
    }
    return JP_E2E_OK;
}

/* Samples. */

static void pack_wheel(struct jp_can_frame *frame, unsigned wheel, uint8_t counter,
                       const struct jp_four_wheel_sensors *sensors)
{
    const struct jp_can_wheel_feedback_t signals = {.wheel = (uint8_t)wheel,
                                                    .count = sensors->count[wheel] & COUNT_MASK,
                                                    .angle = to_signal(sensors->angle[wheel], ANGLE_SHIFT, 24)};

    *frame = (struct jp_can_frame){.id = JP_CAN_WHEEL_FEEDBACK_FRAME_ID, .length = JP_CAN_WHEEL_FEEDBACK_LENGTH};
    (void)jp_can_wheel_feedback_pack(frame->data, &signals, sizeof frame->data);
    jp_e2e_protect(&counter, JP_DATA_ID_WHEEL_FEEDBACK, frame->data, frame->length);
}

void jp_wheel_sample_pack(struct jp_can_frame frames[JP_WHEEL_SAMPLE_FRAMES], uint8_t *counter,
                          const struct jp_four_wheel_sensors *sensors)
{
    const struct jp_can_supply_sensors_t signals = {
        .bus_voltage = (uint16_t)jp_clamp32(jp_round_shift(sensors->bus_voltage, VOLTAGE_SHIFT), 0, UINT16_MAX),
        .bus_current = to_signal(sensors->bus_current, CURRENT_SHIFT, 24)};
    struct jp_can_frame *last = &frames[JP_WHEELS];

    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        pack_wheel(&frames[i], i, *counter, sensors);
    }
    *last = (struct jp_can_frame){.id = JP_CAN_SUPPLY_SENSORS_FRAME_ID, .length = JP_CAN_SUPPLY_SENSORS_LENGTH};
    (void)jp_can_supply_sensors_pack(last->data, &signals, sizeof last->data);
    jp_e2e_protect(counter, JP_DATA_ID_SUPPLY_SENSORS, last->data, last->length);
}

/** The full count that ends in these bits and is nearest to `near`. */
static uint32_t full_count(uint32_t near, uint32_t bits)
{
    const unsigned shift = 32U - COUNT_BITS;
    const int32_t difference = (int32_t)((bits - near) << shift) >> shift;

    return near + (uint32_t)difference;
}

static enum jp_e2e_result accept_wheel(struct jp_wheel_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_wheel_feedback_t signals;
    enum jp_e2e_result result;

    (void)jp_can_wheel_feedback_unpack(&signals, frame->data, frame->length);
    result = jp_e2e_check(&link->group.receivers[signals.wheel], JP_DATA_ID_WHEEL_FEEDBACK, frame->data, frame->length);
    if (result == JP_E2E_OK) {
        note_part(&link->group, signals.wheel, signals.counter);
        link->parts.count[signals.wheel] = full_count(link->parts.count[signals.wheel], signals.count);
        link->parts.angle[signals.wheel] = from_signal(signals.angle, ANGLE_SHIFT);
    }
    return result;
}

static enum jp_e2e_result accept_supply(struct jp_wheel_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_supply_sensors_t signals;
    const enum jp_e2e_result result =
        jp_e2e_check(&link->group.receivers[JP_WHEELS], JP_DATA_ID_SUPPLY_SENSORS, frame->data, frame->length);

    if (result != JP_E2E_OK) {
        return result;
    }
    (void)jp_can_supply_sensors_unpack(&signals, frame->data, frame->length);
    note_part(&link->group, JP_WHEELS, signals.counter);
    if (link->group.parts != ALL_PARTS) {
        return JP_E2E_SEQUENCE;
    }
    link->parts.bus_voltage = from_signal(signals.bus_voltage, VOLTAGE_SHIFT);
    link->parts.bus_current = from_signal(signals.bus_current, CURRENT_SHIFT);
    link->sample = link->parts;
    link->is_fresh = true;
    link->has_started = true;
    link->group.parts = 0;
    return JP_E2E_OK;
}

enum jp_e2e_result jp_wheel_link_accept(struct jp_wheel_link *link, const struct jp_can_frame *frame)
{
    return frame->id == JP_CAN_SUPPLY_SENSORS_FRAME_ID ? accept_supply(link, frame) : accept_wheel(link, frame);
}

enum jp_status jp_wheel_link_read(struct jp_wheel_link *link, struct jp_four_wheel_sensors *sensors)
{
    if (!link->is_fresh) {
        link->lost = link->has_started ? jp_one_more16(link->lost) : 0U;
        return JP_ERR_HARDWARE;
    }
    link->is_fresh = false;
    *sensors = link->sample;
    return JP_OK;
}
