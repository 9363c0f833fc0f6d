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

/** One angle of the drive, in 2⁻⁵⁶ turn: where it is exactly, and how far off the controller is. */
struct wrap_angle {
    wrap_wide step; /**< a tick */
    jp_phase exact;
    int64_t error;  /**< reference − measured */
    int64_t offset; /**< measured − exact */
    int64_t settled_error;
    int64_t settled_offset;
    int64_t jump; /**< largest change of the error in a tick after settling */
};

static struct wrap_angle wrap_angle(const struct jp_reference *reference, jp_turns_per_s rate, uint64_t first)
{
    const wrap_wide step = (wrap_wide)rate * (wrap_wide)reference->phase_per_rate;

    return (struct wrap_angle){.step = step, .exact = (jp_phase)(step * (wrap_wide)first)};
}

static void wrap_observe(struct wrap_angle *angle, jp_phase reference, jp_phase measured)
{
    const int64_t error = (int64_t)(reference - measured);

    angle->jump = wrap_wider(angle->jump, error - angle->error);
    angle->error = error;
    angle->exact += (jp_phase)angle->step;
    angle->offset = (int64_t)(measured - angle->exact);
}

/** What was until now does not count. */
static void wrap_settle(struct wrap_angle *angle)
{
    angle->settled_error = angle->error;
    angle->settled_offset = angle->offset;
    angle->jump = 0;
}

/** The controller in the middle of a drive, with the encoders that it reads. */
struct wrap_controller {
    const struct jp_robot_config *config;
    struct jp_estimator estimator;
    struct jp_reference reference;
    struct jp_motion_state state;
    struct jp_sensors sensors;
    struct wrap_counter left;
    struct wrap_counter right;
    struct wrap_angle wheel;
    struct wrap_angle yaw;
};

static void wrap_start_encoders(struct wrap_controller *controller, const struct wrap_drive *drive)
{
    const struct wrap_geometry *geometry = drive->geometry;
    const wrap_wide mean = controller->wheel.step * geometry->half_track_denominator;
    const wrap_wide difference = controller->yaw.step * geometry->half_track_numerator;

    controller->left = wrap_counter(geometry, mean - difference, drive->first);
    controller->right = wrap_counter(geometry, mean + difference, drive->first);
    controller->sensors = (struct jp_sensors){
        .encoder_left = controller->left.value, .encoder_right = controller->right.value, .accel_z = JP_Q24_ONE};
}

static void wrap_start(struct wrap_controller *controller, const struct wrap_drive *drive)
{
    const struct jp_robot_config *config = drive->geometry->config;
    const struct jp_reference_step step = jp_reference_step_to(&config->reference, &drive->motion, 0);
    struct jp_estimator *estimator = &controller->estimator;
    struct jp_reference *reference = &controller->reference;

    *controller = (struct wrap_controller){.config = config};
    jp_reference_start(reference, &config->reference, 0, 0);
    jp_reference_apply(reference, &step);
    controller->wheel = wrap_angle(reference, reference->wheel.target_rate, drive->first);
    controller->yaw = wrap_angle(reference, reference->yaw.target_rate, drive->first);
    wrap_start_encoders(controller, drive);
    jp_estimator_start(estimator, &config->estimator, &controller->sensors);
    estimator->wheel_encoder = estimator->wheel.angle = controller->wheel.exact;
    estimator->yaw_encoder = estimator->yaw.angle = controller->yaw.exact;
    reference->wheel.target = reference->wheel.angle = controller->wheel.exact;
    reference->yaw.target = reference->yaw.angle = controller->yaw.exact;
}

static void wrap_tick(struct wrap_controller *controller)
{
    const struct jp_reference *reference = &controller->reference;
    const struct jp_motion_state *state = &controller->state;

    wrap_count(&controller->left);
    wrap_count(&controller->right);
    controller->sensors.encoder_left = controller->left.value;
    controller->sensors.encoder_right = controller->right.value;
    jp_estimator_update(&controller->estimator, &controller->config->estimator, &controller->sensors,
                        &controller->state);
    jp_reference_update(&controller->reference, &controller->config->reference);
    wrap_observe(&controller->wheel, reference->wheel.angle, state->wheel);
    wrap_observe(&controller->yaw, reference->yaw.angle, state->yaw);
}

/** The exact angle after all ticks by one product, which no sum of steps can falsify. */
static bool wrap_ends_at(const struct wrap_drive *drive, const struct wrap_angle *angle, jp_phase target)
{
    return target == (jp_phase)(angle->step * (wrap_wide)(drive->first + drive->ticks));
}

static void wrap_report(struct wrap_drive *drive, const struct wrap_controller *controller)
{
    const struct wrap_angle *wheel = &controller->wheel;
    const struct wrap_angle *yaw = &controller->yaw;

    drive->wheel_jump = wrap_turns(wheel->jump);
    drive->yaw_jump = wrap_turns(yaw->jump);
    drive->wheel_drift = wrap_turns(wheel->error - wheel->settled_error);
    drive->yaw_drift = wrap_turns(yaw->error - yaw->settled_error);
    drive->wheel_measured_drift = wrap_turns(wheel->offset - wheel->settled_offset);
    drive->yaw_measured_drift = wrap_turns(yaw->offset - yaw->settled_offset);
    drive->exact = wrap_ends_at(drive, wheel, controller->reference.wheel.target) &&
                   wrap_ends_at(drive, yaw, controller->reference.yaw.target);
}

static void wrap_run(struct wrap_drive *drive)
{
    struct wrap_controller controller;

    wrap_start(&controller, drive);

    const uint64_t settled = (uint64_t)WRAP_SETTLING_S * controller.config->estimator.tick_rate;

    for (uint64_t tick = 1; tick <= drive->ticks; tick++) {
        wrap_tick(&controller);
        if (tick <= settled) {
            wrap_settle(&controller.wheel);
            wrap_settle(&controller.yaw);
        }
    }
    wrap_report(drive, &controller);
}

#endif
