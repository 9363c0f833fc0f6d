/** What the sensors of a robot on two motors may say: a frame that is plausible until the input says otherwise. */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_SENSORS_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_SENSORS_H

#include <joulepath/sensors.h>
#include <joulepath/status.h>

#include "tests/fuzz/fuzz_input.h"

struct fuzz_sensors {
    struct jp_sensors frame;
    int32_t step_left; /**< counts in a tick */
    int32_t step_right;
    enum jp_status read;
};

static inline void fuzz_sensors_begin(struct fuzz_sensors *sensors)
{
    *sensors = (struct fuzz_sensors){.frame = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)}};
}

/** Something else from now on. */
static inline void fuzz_sensors_change(struct fuzz_sensors *sensors, struct fuzz_input *input)
{
    static const enum jp_status readings[] = {JP_OK, JP_ERR_HARDWARE, JP_HELD};
    const struct jp_sensors *frame = &sensors->frame;

    switch (fuzz_below(input, 8)) {
    case 0:
        fuzz_change_field(input, (uint8_t *)&sensors->frame + 4U * fuzz_below(input, sizeof *frame / 4U), 4);
        break;
    case 1:
        fuzz_fill(input, &sensors->frame, sizeof *frame);
        break;
    case 2:
        sensors->read = readings[fuzz_below(input, sizeof readings / sizeof readings[0])];
        break;
    case 3:
        sensors->frame.pitch_rate = fuzz_range(input, -JP_Q24(2), JP_Q24(2));
        sensors->frame.yaw_rate = fuzz_range(input, -JP_Q24(2), JP_Q24(2));
        break;
    case 4:
        sensors->frame.current_left = fuzz_range(input, -JP_Q16(20), JP_Q16(20));
        sensors->frame.current_right = fuzz_range(input, -JP_Q16(20), JP_Q16(20));
        break;
    case 5:
        sensors->step_left = (int8_t)fuzz_u8(input);
        sensors->step_right = (int8_t)fuzz_u8(input);
        break;
    case 6:
        sensors->step_left = fuzz_hostile(input);
        sensors->step_right = fuzz_hostile(input);
        break;
    default:
        fuzz_sensors_begin(sensors);
        break;
    }
}

/** The next frame; its noise keeps it from being frozen. */
static inline void fuzz_sensors_move(struct fuzz_sensors *sensors)
{
    struct jp_sensors *frame = &sensors->frame;

    frame->encoder_left += (uint32_t)sensors->step_left;
    frame->encoder_right += (uint32_t)sensors->step_right;
    frame->pitch_rate ^= 1;
    frame->yaw_rate ^= 1;
    frame->accel_x ^= 1;
    frame->accel_z ^= 1;
}

#endif
