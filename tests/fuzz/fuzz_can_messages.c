/**
 * Every message of joulepath.dbc, and the structs behind them: what is decoded of any bytes can be encoded, and is the
 * same when it is decoded again.
 */
#include "hal/can/jp_can.h"
#include "hal/can/messages.h"
#include "tests/fuzz/fuzz_input.h"

/** All of hal/can/jp_can.h; tests/tools/test_fuzz.py compares. */
#define MESSAGES(X)                                                                                                    \
    X(motor_command)                                                                                                   \
    X(wheel_target)                                                                                                    \
    X(wheel_sensors)                                                                                                   \
    X(balance_sensors)                                                                                                 \
    X(current_sensors)                                                                                                 \
    X(wheel_feedback)                                                                                                  \
    X(supply_sensors)                                                                                                  \
    X(scan_begin)                                                                                                      \
    X(scan_ranges)                                                                                                     \
    X(scan_end)                                                                                                        \
    X(battery_charge)                                                                                                  \
    X(operator_command)                                                                                                \
    X(route_offer)                                                                                                     \
    X(waypoint)                                                                                                        \
    X(goal)                                                                                                            \
    X(map_offer)                                                                                                       \
    X(map_data)                                                                                                        \
    X(cell_changes)                                                                                                    \
    X(map_goal)                                                                                                        \
    X(round_offer)                                                                                                     \
    X(round_data)                                                                                                      \
    X(ecu_status)                                                                                                      \
    X(ecu_errors)                                                                                                      \
    X(ecu_losses)                                                                                                      \
    X(route_status)                                                                                                    \
    X(pose)                                                                                                            \
    X(motion)                                                                                                          \
    X(reference)                                                                                                       \
    X(motors)                                                                                                          \
    X(energy_spent)                                                                                                    \
    X(energy_drawn)                                                                                                    \
    X(segment_motion)                                                                                                  \
    X(segment_shape)                                                                                                   \
    X(segment_forecast)                                                                                                \
    X(segment_result)                                                                                                  \
    X(energy_parameter)                                                                                                \
    X(reset_report)                                                                                                    \
    X(battery_status)                                                                                                  \
    X(crash_report)                                                                                                    \
    X(learned)                                                                                                         \
    X(learner_status)                                                                                                  \
    X(map_status)                                                                                                      \
    X(navigation_status)                                                                                               \
    X(navigation_progress)                                                                                             \
    X(course_leg)                                                                                                      \
    X(learned_factors)                                                                                                 \
    X(learned_deviations)                                                                                              \
    X(map_pose)                                                                                                        \
    X(patrol_status)                                                                                                   \
    X(home_status)                                                                                                     \
    X(home_battery)                                                                                                    \
    X(round_status)                                                                                                    \
    X(round_battery)                                                                                                   \
    X(sim_time)                                                                                                        \
    X(sim_done)

/** Unused bits of a message are 0 again when it was packed, and no signal changes. */
#define DEFINE_CHECK(name)                                                                                             \
    static void check_##name(const uint8_t *bytes, size_t size)                                                        \
    {                                                                                                                  \
        struct jp_can_##name##_t first, second;                                                                        \
        uint8_t packed[JP_CAN_LENGTH_MAX] = {0}, again[JP_CAN_LENGTH_MAX] = {0};                                       \
                                                                                                                       \
        memset(&first, 0, sizeof first);                                                                               \
        memset(&second, 0, sizeof second);                                                                             \
        if (jp_can_##name##_unpack(&first, bytes, size) != 0) {                                                        \
            return;                                                                                                    \
        }                                                                                                              \
        const int length = jp_can_##name##_pack(packed, &first, sizeof packed);                                        \
                                                                                                                       \
        fuzz_require(length >= 0 && (size_t)length <= size, #name ": cannot be encoded");                              \
        fuzz_require(jp_can_##name##_unpack(&second, packed, (size_t)length) == 0, #name ": cannot be decoded again"); \
        fuzz_require(memcmp(&first, &second, sizeof first) == 0, #name ": another message");                           \
        fuzz_require(jp_can_##name##_pack(again, &second, sizeof again) == length &&                                   \
                         memcmp(packed, again, sizeof packed) == 0,                                                    \
                     #name ": other bytes");                                                                           \
    }
MESSAGES(DEFINE_CHECK)

#define NAME_OF(name) check_##name,
static void (*const checks[])(const uint8_t *bytes, size_t size) = {MESSAGES(NAME_OF)};

/** Sensors go through the bus as they are but for what a signal cannot hold; so a second time nothing changes. */
static void check_sensors(struct fuzz_input *input)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_sensors sensors[2];
    uint8_t counter = fuzz_u8(input);

    fuzz_fill(input, &sensors[0], sizeof sensors[0]);
    for (unsigned i = 0; i < 2U; i++) {
        struct jp_e2e_receiver receiver = {.counter = (uint8_t)(counter & 15U), .synchronised = true};
        struct jp_sensors *to = &sensors[1];

        jp_message_from_sensors(frames, &counter, &sensors[i]);
        to->encoder_left = sensors[i].encoder_left;
        to->encoder_right = sensors[i].encoder_right;

        const struct jp_sensors before = *to;

        fuzz_require(jp_message_to_sensors(&receiver, frames, to) == JP_E2E_OK, "a sample of one's own");
        fuzz_require(i == 0U || memcmp(&before, to, sizeof before) == 0, "another sample");
    }
}

static void check_actuation(struct fuzz_input *input)
{
    struct jp_actuation actuation;
    struct jp_actuation decoded = {.enabled = 0};
    struct jp_can_frame frame;
    uint8_t counter = fuzz_u8(input);
    struct jp_e2e_receiver receiver = {.counter = (uint8_t)(counter & 15U), .synchronised = true};

    fuzz_fill(input, &actuation, sizeof actuation);
    actuation.enabled &= 1U;
    jp_message_from_actuation(&frame, &counter, &actuation);
    fuzz_require(jp_message_to_actuation(&receiver, &frame, &decoded) == JP_E2E_OK, "a command of one's own");
    fuzz_require(decoded.enabled == actuation.enabled, "whether the motors are on");
}

/** Frames that may be of a sample and of a command: those that are taken are of this protection. */
static void check_any(struct fuzz_input *input)
{
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_e2e_receiver receiver = {.counter = fuzz_u8(input) & 15U, .synchronised = fuzz_bool(input)};
    struct jp_sensors sensors = {.bus_voltage = 0};
    struct jp_actuation actuation;

    for (unsigned i = 0; i < (unsigned)JP_SAMPLE_PARTS; i++) {
        frames[i].length = JP_CAN_LENGTH_MAX;
        fuzz_fill(input, frames[i].data, sizeof frames[i].data);
    }
    (void)jp_message_to_sensors(&receiver, frames, &sensors);
    (void)jp_message_to_actuation(&receiver, &frames[0], &actuation);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    check_sensors(&input);
    check_actuation(&input);
    check_any(&input);
    while (fuzz_more(&input)) {
        uint8_t data[JP_CAN_LENGTH_MAX];
        const uint32_t message = fuzz_below(&input, sizeof checks / sizeof checks[0]);
        const uint32_t length = fuzz_below(&input, JP_CAN_LENGTH_MAX + 1U);

        fuzz_fill(&input, data, sizeof data);
        checks[message](data, length);
        checks[message](data, sizeof data);
    }
    return 0;
}
