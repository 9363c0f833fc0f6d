#include "hal/can/messages.h"

#include <string.h>

#include "hal/can/jp_can.h"
#include "hal/storage/crc32.h"

/** Fraction bits of the library's value that its signal leaves out. */
#define DUTY_SHIFT    7U  /* Q31 to Q24 */
#define ACCEL_SHIFT   11U /* Q24 to Q13 */
#define YAW_SHIFT     12U /* Q24 to Q12 */
#define CURRENT_SHIFT 8   /* Q16 to Q8 */
#define VOLTAGE_SHIFT 9   /* Q16 to Q7 */

#define COUNT_MASK ((1U << JP_SAMPLE_COUNT_BITS) - 1U)

/** Rounds `shift` fraction bits away and saturates to a signed signal of `bits`. */
static int32_t to_signal(int32_t value, unsigned shift, unsigned bits)
{
    const int64_t limit = (int64_t)1 << (bits - 1U);
    const int64_t rounded = shift == 0U ? value : jp_round_shift(value, shift);

    return (int32_t)(rounded >= limit ? limit - 1 : rounded < -limit ? -limit : rounded);
}

static int32_t from_signal(int32_t raw, unsigned shift)
{
    return raw * (int32_t)(1U << shift);
}

static void begin(struct jp_can_frame *frame, uint32_t id, uint8_t length)
{
    *frame = (struct jp_can_frame){.id = id, .length = length};
}

void jp_message_from_actuation(struct jp_can_frame *frame, uint8_t *counter, const struct jp_actuation *actuation)
{
    const struct jp_can_motor_command_t signals = {
        .enabled = actuation->enabled != 0U,
        .duty_left = to_signal(actuation->duty_left, DUTY_SHIFT, 25),
        .duty_right = to_signal(actuation->duty_right, DUTY_SHIFT, 25),
    };

    begin(frame, JP_CAN_MOTOR_COMMAND_FRAME_ID, JP_CAN_MOTOR_COMMAND_LENGTH);
    (void)jp_can_motor_command_pack(frame->data, &signals, sizeof frame->data);
    jp_e2e_protect(counter, JP_DATA_ID_MOTOR_COMMAND, frame->data, frame->length);
}

enum jp_e2e_result jp_message_to_actuation(struct jp_e2e_receiver *receiver, const struct jp_can_frame *frame,
                                           struct jp_actuation *actuation)
{
    struct jp_can_motor_command_t signals;
    enum jp_e2e_result result = jp_e2e_check(receiver, JP_DATA_ID_MOTOR_COMMAND, frame->data, frame->length);

    if (result != JP_E2E_OK || jp_can_motor_command_unpack(&signals, frame->data, frame->length) != 0) {
        return result == JP_E2E_OK ? JP_E2E_CRC : result;
    }
    *actuation = (struct jp_actuation){.enabled = signals.enabled};
    if (signals.enabled != 0U) {
        actuation->duty_left = from_signal(signals.duty_left, DUTY_SHIFT);
        actuation->duty_right = from_signal(signals.duty_right, DUTY_SHIFT);
    }
    return JP_E2E_OK;
}

static void put_wheels(struct jp_can_frame *frame, uint8_t counter, const struct jp_sensors *sensors)
{
    const struct jp_can_wheel_sensors_t signals = {
        .sample_counter = counter,
        .encoder_left = sensors->encoder_left & COUNT_MASK,
        .encoder_right = sensors->encoder_right & COUNT_MASK,
        /* The signal is unsigned. */
        .bus_voltage = (uint16_t)(sensors->bus_voltage <= 0 ? 0 : to_signal(sensors->bus_voltage, VOLTAGE_SHIFT, 17)),
    };

    begin(frame, JP_CAN_WHEEL_SENSORS_FRAME_ID, JP_CAN_WHEEL_SENSORS_LENGTH);
    (void)jp_can_wheel_sensors_pack(frame->data, &signals, sizeof frame->data);
}

static void put_balance(struct jp_can_frame *frame, uint8_t counter, const struct jp_sensors *sensors)
{
    const struct jp_can_balance_sensors_t signals = {
        .sample_counter = counter,
        .pitch_rate = to_signal(sensors->pitch_rate, 0, 28),
        .accel_x = (int16_t)to_signal(sensors->accel_x, ACCEL_SHIFT, 16),
        .accel_z = (int16_t)to_signal(sensors->accel_z, ACCEL_SHIFT, 16),
    };

    begin(frame, JP_CAN_BALANCE_SENSORS_FRAME_ID, JP_CAN_BALANCE_SENSORS_LENGTH);
    (void)jp_can_balance_sensors_pack(frame->data, &signals, sizeof frame->data);
}

static void put_currents(struct jp_can_frame *frame, const struct jp_sensors *sensors)
{
    const struct jp_can_current_sensors_t signals = {
        .current_left = (int16_t)to_signal(sensors->current_left, CURRENT_SHIFT, 16),
        .current_right = (int16_t)to_signal(sensors->current_right, CURRENT_SHIFT, 16),
        .yaw_rate = (int16_t)to_signal(sensors->yaw_rate, YAW_SHIFT, 16),
    };

    begin(frame, JP_CAN_CURRENT_SENSORS_FRAME_ID, JP_CAN_CURRENT_SENSORS_LENGTH);
    (void)jp_can_current_sensors_pack(frame->data, &signals, sizeof frame->data);
}

/** What the CRC goes on over after CurrentSensors. */
static void join(uint8_t rest[2U * JP_CAN_LENGTH_MAX], const struct jp_can_frame frames[JP_SAMPLE_PARTS])
{
    memcpy(rest, frames[JP_SAMPLE_WHEELS].data, JP_CAN_LENGTH_MAX);
    memcpy(rest + JP_CAN_LENGTH_MAX, frames[JP_SAMPLE_BALANCE].data, JP_CAN_LENGTH_MAX);
}

void jp_message_from_sensors(struct jp_can_frame frames[JP_SAMPLE_PARTS], uint8_t *counter,
                             const struct jp_sensors *sensors)
{
    const uint8_t next = (uint8_t)((*counter + 1U) & 0x0FU);
    struct jp_can_frame *last = &frames[JP_SAMPLE_CURRENTS];
    uint8_t rest[2U * JP_CAN_LENGTH_MAX];

    put_wheels(&frames[JP_SAMPLE_WHEELS], next, sensors);
    put_balance(&frames[JP_SAMPLE_BALANCE], next, sensors);
    put_currents(last, sensors);
    join(rest, frames);
    jp_e2e_protect_group(counter, JP_DATA_ID_SAMPLE, last->data, last->length, rest, sizeof rest);
}

/** The full count that ends in these bits and is nearest to `near`. */
static uint32_t full_count(uint32_t near, uint32_t bits)
{
    const unsigned shift = 32U - JP_SAMPLE_COUNT_BITS;
    const int32_t difference = (int32_t)((bits - near) << shift) >> shift;

    return near + (uint32_t)difference;
}

static void take(const struct jp_can_frame frames[JP_SAMPLE_PARTS], struct jp_sensors *sensors)
{
    struct jp_can_wheel_sensors_t wheels;
    struct jp_can_balance_sensors_t balance;
    struct jp_can_current_sensors_t currents;

    (void)jp_can_wheel_sensors_unpack(&wheels, frames[JP_SAMPLE_WHEELS].data, JP_CAN_LENGTH_MAX);
    (void)jp_can_balance_sensors_unpack(&balance, frames[JP_SAMPLE_BALANCE].data, JP_CAN_LENGTH_MAX);
    (void)jp_can_current_sensors_unpack(&currents, frames[JP_SAMPLE_CURRENTS].data, JP_CAN_LENGTH_MAX);
    *sensors = (struct jp_sensors){
        .encoder_left = full_count(sensors->encoder_left, wheels.encoder_left),
        .encoder_right = full_count(sensors->encoder_right, wheels.encoder_right),
        .pitch_rate = balance.pitch_rate,
        .yaw_rate = from_signal(currents.yaw_rate, YAW_SHIFT),
        .accel_x = from_signal(balance.accel_x, ACCEL_SHIFT),
        .accel_z = from_signal(balance.accel_z, ACCEL_SHIFT),
        .current_left = from_signal(currents.current_left, CURRENT_SHIFT),
        .current_right = from_signal(currents.current_right, CURRENT_SHIFT),
        .bus_voltage = from_signal(wheels.bus_voltage, VOLTAGE_SHIFT),
    };
}

enum jp_e2e_result jp_message_to_sensors(struct jp_e2e_receiver *receiver,
                                         const struct jp_can_frame frames[JP_SAMPLE_PARTS], struct jp_sensors *sensors)
{
    const struct jp_can_frame *last = &frames[JP_SAMPLE_CURRENTS];
    uint8_t rest[2U * JP_CAN_LENGTH_MAX];

    join(rest, frames);

    enum jp_e2e_result result =
        jp_e2e_check_group(receiver, JP_DATA_ID_SAMPLE, last->data, last->length, rest, sizeof rest);

    if (result == JP_E2E_OK) {
        take(frames, sensors);
    }
    return result;
}

uint32_t jp_route_crc(uint32_t crc, const struct jp_point *waypoint)
{
    const uint32_t words[2] = {(uint32_t)waypoint->x, (uint32_t)waypoint->y};
    uint8_t bytes[sizeof words];

    for (unsigned i = 0; i < sizeof bytes; i++) {
        bytes[i] = (uint8_t)(words[i / 4U] >> (8U * (i % 4U)));
    }
    return jp_crc32(crc, bytes, sizeof bytes);
}
