/* Frames of the DBC against those that cantools packed, saturation of every signal, wrapping counts, the route's CRC.
 */
#include <string.h>

#include "hal/can/messages.h"

#include "hal/can/jp_can.h"

#include "unity.h"

static struct jp_can_frame frames[JP_SAMPLE_PARTS];
static struct jp_e2e_receiver receiver;
static struct jp_actuation actuation;
static struct jp_sensors sensors;
static uint8_t counter;

void setUp(void)
{
    receiver = (struct jp_e2e_receiver){.synchronised = false};
    actuation = (struct jp_actuation){0, 0, 0};
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE};
    counter = 0;
}

void tearDown(void)
{
}

static void expect_frame(const struct jp_can_frame *frame, uint32_t id, const uint8_t bytes[JP_CAN_LENGTH_MAX])
{
    TEST_ASSERT_EQUAL_HEX32(id, frame->id);
    TEST_ASSERT_EQUAL_UINT8(8, frame->length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(bytes, frame->data, JP_CAN_LENGTH_MAX);
}

/* MotorCommand */

static const uint8_t third_forward_half_back[8] = {0x4D, 0x51, 0x55, 0x55, 0x15, 0x00, 0x00, 0xC0}; /* counter 1 */
static const uint8_t off[8] = {0xCB, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};                     /* counter 2 */
static const uint8_t off_with_duties[8] = {0xA5, 0x43, 0x13, 0x00, 0x80, 0xD9, 0xFF, 0xFF};         /* counter 3 */
static const uint8_t both_ends[8] = {0xC9, 0xDF, 0xFF, 0xFF, 0x3F, 0x00, 0x00, 0x80};               /* counter 15 */

static void test_motor_command_is_packed_as_cantools_does(void)
{
    /* 5592405 · 2⁻²⁴ and what rounds to it. */
    actuation = (struct jp_actuation){5592405 * 128 + 63, -8388608 * 128 - 64, 1};
    jp_message_from_actuation(&frames[0], &counter, &actuation);
    expect_frame(&frames[0], 0x10, third_forward_half_back);
    TEST_ASSERT_EQUAL_UINT8(1, counter);

    actuation = (struct jp_actuation){0, 0, 0};
    jp_message_from_actuation(&frames[0], &counter, &actuation);
    expect_frame(&frames[0], 0x10, off);

    counter = 14;
    actuation = (struct jp_actuation){INT32_MAX, INT32_MIN, 255};
    jp_message_from_actuation(&frames[0], &counter, &actuation);
    expect_frame(&frames[0], 0x10, both_ends);
}

static enum jp_e2e_result receive(const uint8_t bytes[8])
{
    struct jp_can_frame frame = {.id = JP_CAN_MOTOR_COMMAND_FRAME_ID, .length = 8};

    memcpy(frame.data, bytes, sizeof frame.data);
    return jp_message_to_actuation(&receiver, &frame, &actuation);
}

static void expect_actuation(jp_q31 left, jp_q31 right, uint8_t enabled)
{
    TEST_ASSERT_EQUAL_INT32(left, actuation.duty_left);
    TEST_ASSERT_EQUAL_INT32(right, actuation.duty_right);
    TEST_ASSERT_EQUAL_UINT8(enabled, actuation.enabled);
}

static void test_motor_command_is_unpacked_as_cantools_does(void)
{
    receiver = (struct jp_e2e_receiver){.counter = 0, .synchronised = true};
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, receive(third_forward_half_back));
    expect_actuation(5592405 * 128, -8388608 * 128, 1);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, receive(off));
    expect_actuation(0, 0, 0);
    actuation.duty_left = 1;
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, receive(off_with_duties)); /* off is off */
    expect_actuation(0, 0, 0);
    receiver.counter = 14;
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, receive(both_ends));
    expect_actuation(INT32_MAX - 127, INT32_MIN, 1);
}

static void test_motor_command_is_written_only_when_ok(void)
{
    uint8_t corrupt[8];

    actuation = (struct jp_actuation){77, -77, 1};
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, receive(third_forward_half_back));
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, receive(third_forward_half_back));
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, receive(both_ends));
    memcpy(corrupt, off, sizeof corrupt);
    corrupt[7] ^= 1U;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, receive(corrupt));
    expect_actuation(77, -77, 1);
}

static void test_every_small_corruption_of_a_motor_command_is_found(void)
{
    struct jp_can_frame frame = {.id = JP_CAN_MOTOR_COMMAND_FRAME_ID, .length = 8};
    unsigned accepted = 0;

    actuation = (struct jp_actuation){77, -77, 1};
    for (unsigned a = 0; a < 64; a++) {
        for (unsigned b = a; b < 64; b++) {
            for (unsigned c = b; c < 64; c++) {
                /* One bit when all are equal, two when two of them are; a pair of equal ones undoes itself. */
                memcpy(frame.data, off, sizeof frame.data);
                frame.data[a / 8U] ^= (uint8_t)(1U << (a % 8U));
                frame.data[b / 8U] ^= (uint8_t)(b == a ? 0U : 1U << (b % 8U));
                frame.data[c / 8U] ^= (uint8_t)(c == b ? 0U : 1U << (c % 8U));
                receiver = (struct jp_e2e_receiver){.counter = 1, .synchronised = true};
                accepted += jp_message_to_actuation(&receiver, &frame, &actuation) != JP_E2E_CRC;
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT(0, accepted);
    expect_actuation(77, -77, 1);
}

static jp_q31 duty_through_a_frame(jp_q31 duty)
{
    actuation = (struct jp_actuation){duty, duty, 1};
    jp_message_from_actuation(&frames[0], &counter, &actuation);
    receiver = (struct jp_e2e_receiver){.counter = (counter - 1U) & 15U, .synchronised = true};
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_message_to_actuation(&receiver, &frames[0], &actuation));
    TEST_ASSERT_EQUAL_INT32(actuation.duty_left, actuation.duty_right);
    return actuation.duty_left;
}

static void test_duties_are_rounded_to_the_signal(void)
{
    TEST_ASSERT_EQUAL_INT32(0, duty_through_a_frame(63));
    TEST_ASSERT_EQUAL_INT32(128, duty_through_a_frame(64));
    TEST_ASSERT_EQUAL_INT32(128, duty_through_a_frame(191));
    TEST_ASSERT_EQUAL_INT32(-128, duty_through_a_frame(-65));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 127, duty_through_a_frame(INT32_MAX - 127));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 127, duty_through_a_frame(INT32_MAX)); /* would round beyond the signal */
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, duty_through_a_frame(INT32_MIN));
    for (int32_t duty = INT32_MIN + 64; duty < INT32_MAX - 1000003 * 128; duty += 1000003 * 128) {
        TEST_ASSERT_INT32_WITHIN(64, duty, duty_through_a_frame(duty));
    }
}

/* Samples */

static const uint8_t wheels[8] = {0x51, 0x34, 0x12, 0x2C, 0xB7, 0xFF, 0x05, 0x0C};
static const uint8_t balance[8] = {0x91, 0x97, 0xD2, 0xFE, 0xCD, 0xFC, 0xD6, 0x1F};
static const uint8_t currents[8] = {0xB7, 0x01, 0x2C, 0x01, 0xD3, 0xFE, 0x01, 0x04};

/* What the signals of these bytes mean, with counts that end in them. */
static const struct jp_sensors meant = {
    .encoder_left = 0x12345,
    .encoder_right = 0xFFFFEDCBU,
    .pitch_rate = -1234567,
    .yaw_rate = 1025 * 4096,
    .accel_x = -819 * 2048,
    .accel_z = 8150 * 2048,
    .current_left = 300 * 256,
    .current_right = -301 * 256,
    .bus_voltage = 3077 * 512,
};

static const uint8_t extreme_wheels[8] = {0x0F, 0x00, 0x00, 0xFC, 0xFF, 0xFF, 0xFF, 0xFF};
static const uint8_t extreme_balance[8] = {0x0F, 0x00, 0x00, 0x80, 0xFF, 0x7F, 0x00, 0x80};
static const uint8_t extreme_currents[8] = {0x12, 0x0F, 0x00, 0x80, 0xFF, 0x7F, 0x00, 0x80};

static void test_samples_are_packed_as_cantools_does(void)
{
    jp_message_from_sensors(frames, &counter, &meant);
    expect_frame(&frames[JP_SAMPLE_WHEELS], 0x20, wheels);
    expect_frame(&frames[JP_SAMPLE_BALANCE], 0x21, balance);
    expect_frame(&frames[JP_SAMPLE_CURRENTS], 0x22, currents);
    TEST_ASSERT_EQUAL_UINT8(1, counter);
}

static void test_every_signal_of_a_sample_saturates(void)
{
    sensors = (struct jp_sensors){
        .encoder_left = 0x12400000U, /* counts wrap instead */
        .encoder_right = UINT32_MAX,
        .pitch_rate = INT32_MIN,
        .yaw_rate = INT32_MIN,
        .accel_x = INT32_MAX,
        .accel_z = INT32_MIN,
        .current_left = INT32_MIN,
        .current_right = INT32_MAX,
        .bus_voltage = INT32_MAX,
    };
    counter = 14;
    jp_message_from_sensors(frames, &counter, &sensors);
    expect_frame(&frames[JP_SAMPLE_WHEELS], 0x20, extreme_wheels);
    expect_frame(&frames[JP_SAMPLE_BALANCE], 0x21, extreme_balance);
    expect_frame(&frames[JP_SAMPLE_CURRENTS], 0x22, extreme_currents);
}

/* Sends `sensors` in frames and returns what arrives beside encoder counts `near`. */
static struct jp_sensors through_frames(uint32_t near)
{
    struct jp_sensors arrived = {.encoder_left = near, .encoder_right = near};

    jp_message_from_sensors(frames, &counter, &sensors);
    receiver = (struct jp_e2e_receiver){.counter = (counter - 1U) & 15U, .synchronised = true};
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_message_to_sensors(&receiver, frames, &arrived));
    return arrived;
}

/* One step inside, on and outside each end of a signal's range. */
#define CHECK_ENDS(member, shift, low, high)                                                                           \
    do {                                                                                                               \
        const int32_t step = (int32_t)1 << (shift);                                                                    \
        const int32_t bottom = (low)*step;                                                                             \
        const int32_t top = (high)*step;                                                                               \
        sensors.member = bottom + step;                                                                                \
        TEST_ASSERT_EQUAL_INT32(bottom + step, through_frames(0).member);                                              \
        sensors.member = bottom;                                                                                       \
        TEST_ASSERT_EQUAL_INT32(bottom, through_frames(0).member);                                                     \
        sensors.member = bottom - step;                                                                                \
        TEST_ASSERT_EQUAL_INT32(bottom, through_frames(0).member);                                                     \
        sensors.member = top;                                                                                          \
        TEST_ASSERT_EQUAL_INT32(top, through_frames(0).member);                                                        \
        sensors.member = top + step / 2;                                                                               \
        TEST_ASSERT_EQUAL_INT32(top, through_frames(0).member);                                                        \
        sensors.member = top + step;                                                                                   \
        TEST_ASSERT_EQUAL_INT32(top, through_frames(0).member);                                                        \
        sensors.member = INT32_MAX;                                                                                    \
        TEST_ASSERT_EQUAL_INT32(top, through_frames(0).member);                                                        \
        sensors.member = INT32_MIN;                                                                                    \
        TEST_ASSERT_EQUAL_INT32(bottom, through_frames(0).member);                                                     \
    } while (0)

static void test_signals_saturate_at_their_ends_and_not_before(void)
{
    CHECK_ENDS(pitch_rate, 0, -(1 << 27), (1 << 27) - 1);
    CHECK_ENDS(yaw_rate, 12, -32768, 32767);
    CHECK_ENDS(accel_x, 11, -32768, 32767);
    CHECK_ENDS(accel_z, 11, -32768, 32767);
    CHECK_ENDS(current_left, 8, -32768, 32767);
    CHECK_ENDS(current_right, 8, -32768, 32767);
    CHECK_ENDS(bus_voltage, 9, 0, 65535);
}

static void test_samples_are_unpacked_as_cantools_does(void)
{
    memcpy(frames[JP_SAMPLE_WHEELS].data, wheels, sizeof wheels);
    memcpy(frames[JP_SAMPLE_BALANCE].data, balance, sizeof balance);
    memcpy(frames[JP_SAMPLE_CURRENTS].data, currents, sizeof currents);
    for (int i = 0; i < JP_SAMPLE_PARTS; i++) {
        frames[i].length = 8;
    }
    receiver = (struct jp_e2e_receiver){.counter = 0, .synchronised = true};
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_message_to_sensors(&receiver, frames, &sensors));
    TEST_ASSERT_EQUAL_MEMORY(&meant, &sensors, sizeof meant);
}

static void test_samples_are_written_only_when_ok(void)
{
    const struct jp_sensors before = sensors;

    jp_message_from_sensors(frames, &counter, &meant);
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, jp_message_to_sensors(&receiver, frames, &sensors));
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, jp_message_to_sensors(&receiver, frames, &sensors));
    jp_message_from_sensors(frames, &counter, &meant);
    for (unsigned part = 0; part < JP_SAMPLE_PARTS; part++) {
        for (unsigned bit = 0; bit < 64; bit++) {
            frames[part].data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
            TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_message_to_sensors(&receiver, frames, &sensors));
            frames[part].data[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        }
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &sensors, sizeof before);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, jp_message_to_sensors(&receiver, frames, &sensors));
    TEST_ASSERT_EQUAL_MEMORY(&meant, &sensors, sizeof meant);
}

static void test_a_frame_of_another_sample_does_not_pass(void)
{
    struct jp_can_frame others[JP_SAMPLE_PARTS];

    jp_message_from_sensors(frames, &counter, &meant);
    (void)jp_message_to_sensors(&receiver, frames, &sensors);
    jp_message_from_sensors(frames, &counter, &meant);
    sensors.encoder_left = 1;
    jp_message_from_sensors(others, &counter, &sensors);
    frames[JP_SAMPLE_WHEELS] = others[JP_SAMPLE_WHEELS];
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_message_to_sensors(&receiver, frames, &sensors));
}

/* Encoder counts */

static void expect_count(uint32_t count, uint32_t near)
{
    struct jp_sensors arrived;

    sensors.encoder_left = count;
    sensors.encoder_right = count;
    arrived = through_frames(near);
    TEST_ASSERT_EQUAL_HEX32(count, arrived.encoder_left);
    TEST_ASSERT_EQUAL_HEX32(count, arrived.encoder_right);
}

static void test_counts_go_on_over_the_wrap_of_22_bits(void)
{
    for (uint32_t wrap = 0; wrap < 5; wrap++) {
        const uint32_t edge = (wrap + 1U) << JP_SAMPLE_COUNT_BITS;

        expect_count(edge + 3U, edge - 2U);
        expect_count(edge - 2U, edge + 3U);
        expect_count(edge, edge - 1U);
    }
}

static void test_counts_go_on_over_the_wrap_of_32_bits(void)
{
    expect_count(2, UINT32_MAX - 1U);
    expect_count(UINT32_MAX, 0);
    expect_count(0x80000000U, 0x7FFFFFFFU);
    expect_count(0x7FFFFFFFU, 0x80000000U);
}

static void test_counts_may_be_half_the_range_away(void)
{
    const uint32_t half = 1U << (JP_SAMPLE_COUNT_BITS - 1U);

    expect_count(1000U + half - 1U, 1000U);
    expect_count(1000U - half, 1000U);
    /* One more forward is taken for the same backward. */
    sensors.encoder_left = 1000U + half;
    TEST_ASSERT_EQUAL_HEX32(1000U - half, through_frames(1000U).encoder_left);
}

/* Routes */

static void test_route_crc_is_that_of_zlib(void)
{
    /* zlib.crc32(struct.pack('<ii', x, y), crc), one after the other */
    static const struct jp_point points[3] = {{19661, -6554}, {-(1 << 25), (1 << 25) - 1}, {65536, 131072}};
    static const uint32_t crcs[3] = {0x0A2E84B0U, 0xCB21AA0CU, 0x7A09F878U};
    uint32_t crc = JP_ROUTE_CRC_START;

    for (int i = 0; i < 3; i++) {
        crc = jp_route_crc(crc, &points[i]);
        TEST_ASSERT_EQUAL_HEX32(crcs[i], crc);
    }
    TEST_ASSERT_EQUAL_HEX32(0x6522DF69U, jp_route_crc(JP_ROUTE_CRC_START, &(struct jp_point){0, 0}));
}
