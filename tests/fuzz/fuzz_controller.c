/**
 * The parts of the balancer's tick one by one, with any configuration that their checks accept and any motion: voltages
 * and angles stay in their ranges, and the meter never counts back what the resistance took.
 */
#include <joulepath/current_check.h>
#include <joulepath/lqr.h>
#include <joulepath/meter.h>
#include <joulepath/odometry.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_sensors.h"

#define TICKS 250U

static struct jp_robot_config config;
static struct jp_estimator estimator;
static struct jp_reference reference;
static struct jp_lqr lqr;
static struct jp_monitor monitor;
static struct jp_meter meter;
static struct jp_odometry odometry;
static struct jp_current_check current_check;
static struct jp_current_check_config current_config;

/** Any bytes, or a robot's with some of them changed. */
static void draw(struct fuzz_input *input, void *part, size_t size)
{
    if (fuzz_below(input, 16) == 15U) {
        fuzz_fill(input, part, size);
    } else {
        fuzz_change(input, part, size);
    }
}

#define DRAW(input, part) draw(input, &(part), sizeof(part))

static void follow(struct fuzz_input *input, const struct jp_motion_state *state)
{
    struct jp_motion motion = {.speed = fuzz_range(input, -JP_Q24(8), JP_Q24(8)),
                               .turn_rate = fuzz_range(input, -JP_Q24(8), JP_Q24(8))};
    const struct jp_reference_step step =
        jp_reference_step_to(&config.reference, &motion, fuzz_range(input, -JP_Q24(6.28), JP_Q24(6.28)));

    switch (fuzz_below(input, 4)) {
    case 0:
        jp_reference_start(&reference, &config.reference, state->wheel, state->yaw);
        break;
    case 1:
        jp_reference_coast(&reference, &config.reference, state->wheel_rate, state->yaw_rate);
        break;
    default:
        jp_reference_apply(&reference, &step);
        break;
    }
}

/** A state that no estimator gives: what the tick's parts accept of any. */
static void change_state(struct fuzz_input *input, struct jp_motion_state *state)
{
    if (fuzz_below(input, 4) == 3U) {
        fuzz_fill(input, state, sizeof *state);
    }
}

static void check_voltages(const struct jp_voltages *voltages, jp_q16 limit)
{
    fuzz_require(voltages->left <= limit && voltages->left >= -limit && voltages->right <= limit &&
                     voltages->right >= -limit,
                 "voltages beyond the limit");
}

static void meter_tick(const struct jp_voltages *voltages, const struct jp_sensors *sensors)
{
    const jp_energy before = meter.model;
    const struct jp_sensors bounded = {.current_left = jp_clamp32(sensors->current_left, -JP_Q16(1024), JP_Q16(1024)),
                                       .current_right =
                                           jp_clamp32(sensors->current_right, -JP_Q16(1024), JP_Q16(1024))};

    jp_meter_update(&meter, voltages, &bounded);
    fuzz_require(meter.model >= before, "the model's energy fell");
}

static bool start(struct fuzz_input *input)
{
    const char *field = NULL;

    DRAW(input, config.estimator);
    DRAW(input, config.reference);
    DRAW(input, config.lqr);
    DRAW(input, config.monitor);
    DRAW(input, config.meter);
    DRAW(input, current_config);
    return fuzz_accepted(jp_estimator_check(&config.estimator, &field), field) &&
           fuzz_accepted(jp_reference_check(&config.reference, &field), field) &&
           fuzz_accepted(jp_lqr_check(&config.lqr, &field), field) &&
           fuzz_accepted(jp_monitor_check(&config.monitor, &field), field) &&
           fuzz_accepted(jp_meter_check(&config.meter, &field), field) &&
           fuzz_accepted(jp_current_check_check(&current_config, &field), field);
}

static void check_currents(const struct jp_motor_sample *sample)
{
    const uint8_t found = jp_current_check_update(&current_check, sample);

    fuzz_require(found < (JP_CURRENT_CHANGING << 1), "a finding that there is not");
    fuzz_require(current_check.left.estimate.offset_deviation >= 0 && current_check.left.estimate.gain_deviation >= 0 &&
                     current_check.right.estimate.offset_deviation >= 0 &&
                     current_check.right.estimate.gain_deviation >= 0,
                 "a negative deviation");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct fuzz_sensors sensors;
    struct jp_motion_state state = {.wheel = 0};
    struct jp_voltages voltages = {0, 0, false};

    config = fuzz_bool(&input) ? jp_robot_courier24 : jp_robot_gao2018;
    current_config = (struct jp_current_check_config){JP_Q16(0.1), JP_Q16(0.1), JP_Q16(0.2), JP_Q16(0.1), 1024};
    if (!start(&input)) {
        return 0;
    }
    fuzz_sensors_begin(&sensors);
    jp_estimator_start(&estimator, &config.estimator, &sensors.frame);
    jp_reference_start(&reference, &config.reference, 0, 0);
    jp_lqr_start(&lqr, &config.lqr);
    jp_monitor_start(&monitor, &config.monitor);
    jp_meter_start(&meter, &config.meter);
    jp_current_check_start(&current_check, &current_config, &config.monitor);
    jp_odometry_start(&odometry, config.metres_per_turn, &state);
    for (unsigned tick = 0; tick < TICKS; tick++) {
        const jp_q16 limit = fuzz_more(&input) ? fuzz_range(&input, 0, JP_Q16(1000)) : JP_Q16(24);

        if (fuzz_bool(&input)) {
            fuzz_sensors_change(&sensors, &input);
            change_state(&input, &state);
            follow(&input, &state);
        }
        fuzz_sensors_move(&sensors);
        (void)jp_monitor_sensors(&monitor, &config.monitor, sensors.read, &sensors.frame);
        if (fuzz_below(&input, 64) == 63U) {
            jp_estimator_resume(&estimator, &config.estimator, &sensors.frame, &state);
        }
        jp_estimator_update(&estimator, &config.estimator, &sensors.frame, &state);
        fuzz_require(state.pitch <= JP_Q24(0.5) && state.pitch >= -JP_Q24(0.5), "a pitch beyond half a turn");
        change_state(&input, &state);
        jp_reference_update(&reference, &config.reference);
        jp_lqr_update(&lqr, &config.lqr, &reference, &state, limit, &voltages);
        check_voltages(&voltages, limit);
        (void)jp_monitor_motors(&monitor, &config.monitor, &voltages, state.wheel_rate, state.yaw_rate);
        meter_tick(&voltages, &sensors.frame);
        jp_odometry_update(&odometry, &state);
        check_currents(&(struct jp_motor_sample){voltages, state.wheel_rate, state.yaw_rate, sensors.frame.current_left,
                                                 sensors.frame.current_right});
    }
    return 0;
}
