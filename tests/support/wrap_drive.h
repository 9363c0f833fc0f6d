/**
 * A drive at constant speed and turn rate whose angles are known exactly: the wheels do what the reference's target
 * does, the encoders count it, and estimator and reference follow through every wrap. Their differences are the errors
 * of the controller.
 *
 * Every tick of the drive is computed. The angles of the oracle are integers of 128 bits.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_WRAP_DRIVE_H
#define JOULEPATH_TESTS_SUPPORT_WRAP_DRIVE_H

#include <joulepath/robot.h>

/** The shaped reference and the tracking loops have settled after this many seconds. */
#define WRAP_SETTLING_S 60

/** W/(2R) as a fraction, and counts of an encoder in a turn. */
struct wrap_geometry {
    const struct jp_robot_config *config;
    int64_t half_track_numerator;
    int64_t half_track_denominator;
    int64_t counts_per_turn;
};

struct wrap_drive {
    const struct wrap_geometry *geometry;
    struct jp_motion motion;
    uint64_t first; /**< ticks driven before, so that a drive can be cut into parts */
    uint64_t ticks;
    /* Results, in turns, after settling. */
    double wheel_jump; /**< largest change of the controller's error between ticks */
    double yaw_jump;
    double wheel_drift; /**< reference − measured: last against first */
    double yaw_drift;
    double wheel_measured_drift; /**< measured − exact: last against first */
    double yaw_measured_drift;
    bool exact; /**< the target's last angle is the exact one */
};

/** A counter that is exact for ever: `value` rises by step/denominator a tick. */
struct wrap_counter {
    uint32_t value;
    uint32_t whole;
    uint64_t part;
    uint64_t rest;
    uint64_t denominator;
};

typedef __int128 wrap_wide;

static wrap_wide wrap_floor(wrap_wide a, wrap_wide b)
{
    wrap_wide quotient = a / b;

    return a % b < 0 ? quotient - 1 : quotient;
}

/** After `first` ticks of `step` in 2⁻⁵⁶ turn / denominator. */
static struct wrap_counter wrap_counter(const struct wrap_geometry *geometry, wrap_wide step, uint64_t first)
{
    const wrap_wide denominator = (wrap_wide)geometry->half_track_denominator << 56;
    const wrap_wide counts = step * geometry->counts_per_turn;
    const wrap_wide whole = wrap_floor(counts, denominator);
    const wrap_wide start = wrap_floor(counts * (wrap_wide)first, denominator);

    return (struct wrap_counter){.value = (uint32_t)start,
                                 .whole = (uint32_t)whole,
                                 .part = (uint64_t)(counts - whole * denominator),
                                 .rest = (uint64_t)(counts * (wrap_wide)first - start * denominator),
                                 .denominator = (uint64_t)denominator};
}

static void wrap_count(struct wrap_counter *counter)
{
    counter->value += counter->whole;
    counter->rest += counter->part;
    if (counter->rest >= counter->denominator) {
        counter->rest -= counter->denominator;
        counter->value++;
    }
}

static int64_t wrap_wider(int64_t worst, int64_t change)
{
    const int64_t size = change < 0 ? -change : change;

    return size > worst ? size : worst;
}

static double wrap_turns(int64_t phase)
{
    return (double)phase * 0x1p-56;
}

static void wrap_run(struct wrap_drive *drive)
{
    const struct wrap_geometry *geometry = drive->geometry;
    const struct jp_robot_config *config = geometry->config;
    const uint64_t settled = (uint64_t)WRAP_SETTLING_S * config->estimator.tick_rate;
    struct jp_estimator estimator;
    struct jp_reference reference;
    struct jp_motion_state state = {0};
    const struct jp_reference_step step = jp_reference_step_to(&config->reference, &drive->motion, 0);

    jp_reference_start(&reference, &config->reference, 0, 0);
    jp_reference_apply(&reference, &step);

    const wrap_wide wheel_step = (wrap_wide)reference.wheel.target_rate * (wrap_wide)reference.phase_per_rate;
    const wrap_wide yaw_step = (wrap_wide)reference.yaw.target_rate * (wrap_wide)reference.phase_per_rate;
    const wrap_wide mean = wheel_step * geometry->half_track_denominator;
    const wrap_wide difference = yaw_step * geometry->half_track_numerator;
    struct wrap_counter left = wrap_counter(geometry, mean - difference, drive->first);
    struct wrap_counter right = wrap_counter(geometry, mean + difference, drive->first);
    const wrap_wide wheel_first = wheel_step * (wrap_wide)drive->first;
    const wrap_wide yaw_first = yaw_step * (wrap_wide)drive->first;
    struct jp_sensors sensors = {.encoder_left = left.value, .encoder_right = right.value, .accel_z = JP_Q24_ONE};

    jp_estimator_start(&estimator, &config->estimator, &sensors);
    estimator.wheel_encoder = estimator.wheel.angle = (jp_phase)wheel_first;
    estimator.yaw_encoder = estimator.yaw.angle = (jp_phase)yaw_first;
    reference.wheel.target = reference.wheel.angle = (jp_phase)wheel_first;
    reference.yaw.target = reference.yaw.angle = (jp_phase)yaw_first;

    int64_t wheel_first_error = 0, yaw_first_error = 0, wheel_first_offset = 0, yaw_first_offset = 0;
    int64_t wheel_error = 0, yaw_error = 0, wheel_jump = 0, yaw_jump = 0;
    jp_phase wheel_exact = (jp_phase)wheel_first;
    jp_phase yaw_exact = (jp_phase)yaw_first;

    for (uint64_t tick = 1; tick <= drive->ticks; tick++) {
        wrap_count(&left);
        wrap_count(&right);
        sensors.encoder_left = left.value;
        sensors.encoder_right = right.value;
        wheel_exact += (jp_phase)wheel_step;
        yaw_exact += (jp_phase)yaw_step;
        jp_estimator_update(&estimator, &config->estimator, &sensors, &state);
        jp_reference_update(&reference, &config->reference);

        const int64_t wheel = (int64_t)(reference.wheel.angle - state.wheel);
        const int64_t yaw = (int64_t)(reference.yaw.angle - state.yaw);

        if (tick == settled) {
            wheel_first_error = wheel;
            yaw_first_error = yaw;
            wheel_first_offset = (int64_t)(state.wheel - wheel_exact);
            yaw_first_offset = (int64_t)(state.yaw - yaw_exact);
        } else if (tick > settled) {
            wheel_jump = wrap_wider(wheel_jump, wheel - wheel_error);
            yaw_jump = wrap_wider(yaw_jump, yaw - yaw_error);
        }
        wheel_error = wheel;
        yaw_error = yaw;
    }

    const wrap_wide last = (wrap_wide)(drive->first + drive->ticks);

    drive->wheel_jump = wrap_turns(wheel_jump);
    drive->yaw_jump = wrap_turns(yaw_jump);
    drive->wheel_drift = wrap_turns(wheel_error - wheel_first_error);
    drive->yaw_drift = wrap_turns(yaw_error - yaw_first_error);
    drive->wheel_measured_drift = wrap_turns((int64_t)(state.wheel - wheel_exact) - wheel_first_offset);
    drive->yaw_measured_drift = wrap_turns((int64_t)(state.yaw - yaw_exact) - yaw_first_offset);
    drive->exact =
        reference.wheel.target == (jp_phase)(wheel_step * last) && reference.yaw.target == (jp_phase)(yaw_step * last);
}

#endif
