/**
 * A balancer's pilot over routes of any points, on a robot whose wheels go along with its reference: what it learned
 * can be stored, forecasts have no deviation below 0, legs are within the limits, and a robot that is told to stop
 * stands.
 */
#include <joulepath/pilot.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_input.h"

#define TARGETS 6U
#define TICKS   3000U

static struct jp_robot_config robot_config;
static struct jp_robot robot;
static struct jp_pilot pilot;
static struct jp_energy_model model;
static struct jp_sensors sensors;
/* What is driven must stay while the next one is drawn. */
static struct jp_point all_targets[2][TARGETS];
static struct jp_passage all_passages[2][TARGETS];
static unsigned driven;
static jp_phase wheel;
static jp_phase yaw;

/** Encoders and gyro as if the wheels were where the reference is; currents of any size. */
static void tick(jp_q16 current)
{
    const struct jp_reference *reference = jp_robot_reference(&robot);
    struct jp_actuation actuation;

    wheel = reference->wheel.angle;
    yaw = reference->yaw.angle;

    const int64_t sum = (int64_t)wheel / (int64_t)robot_config.estimator.wheel_per_count;
    const int64_t difference = (int64_t)yaw / (int64_t)robot_config.estimator.yaw_per_count;

    sensors.encoder_left = (uint32_t)((sum - difference) / 2);
    sensors.encoder_right = (uint32_t)((sum + difference) / 2);
    sensors.pitch_rate ^= 1;
    sensors.accel_x ^= 1;
    sensors.accel_z ^= 1;
    sensors.yaw_rate = reference->yaw.rate ^ (sensors.yaw_rate & 1) ^ 1;
    sensors.current_left = current;
    sensors.current_right = current;
    jp_robot_tick(&robot, JP_OK, &sensors, &actuation);
}

static struct jp_pilot_route draw_route(struct fuzz_input *input)
{
    struct jp_point *const targets = all_targets[1U - driven];
    struct jp_passage *const passages = all_passages[1U - driven];
    const jp_q16 most = fuzz_bool(input) ? JP_Q16(2) : fuzz_bool(input) ? JP_Q16(100) : INT32_MAX;

    for (unsigned i = 0; i < TARGETS; i++) {
        targets[i] = (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
        passages[i] = (struct jp_passage){(uint8_t)fuzz_below(input, 4), fuzz_u32(input),
                                          fuzz_range(input, JP_Q24(0.01), JP_Q24(2))};
    }
    return (struct jp_pilot_route){.targets = targets,
                                   .count = (uint16_t)fuzz_below(input, TARGETS + 1U),
                                   .end = fuzz_bool(input) ? JP_PILOT_STAND : JP_PILOT_PASS,
                                   .passages = fuzz_bool(input) ? passages : NULL,
                                   .slower = (uint8_t)fuzz_below(input, 4)};
}

static void check_pilot(void)
{
    struct jp_forecast forecast = {.deviation = 0};
    const char *field = NULL;
    const enum jp_status status = jp_pilot_answer(&pilot, &forecast);

    fuzz_require(pilot.phase <= JP_PILOT_DRIVING, "a phase that is none");
    fuzz_require(pilot.config.learning == NULL || jp_learned_state_check(&pilot.learner.state, &field) == JP_OK,
                 "a state that cannot be stored");
    fuzz_require(status != JP_OK || forecast.deviation >= 0, "a deviation of a forecast below 0");
    fuzz_require(pilot.leg.speed <= robot_config.limits.speed && pilot.leg.duration >= 0, "a leg beyond the limits");
}

static void command(struct fuzz_input *input)
{
    const struct jp_pilot_route route = draw_route(input);
    enum jp_status status = JP_ERR_STATE;

    switch (fuzz_below(input, 8)) {
    case 0:
        jp_pilot_stop(&pilot);
        break;
    case 1:
        status = jp_pilot_ask(&pilot, &route);
        break;
    case 2:
        jp_robot_disable(&robot);
        break;
    case 3:
        (void)jp_robot_enable(&robot);
        break;
    default:
        status = jp_pilot_follow(&pilot, &route);
        break;
    }
    driven = status == JP_OK ? 1U - driven : driven;
}

static bool start(struct fuzz_input *input)
{
    struct jp_pilot_config config = {.model = &model};
    const char *field = NULL;
    const bool small = fuzz_bool(input);

    robot_config = small ? jp_robot_gao2018 : jp_robot_courier24;
    model = small ? jp_energy_model_gao2018 : jp_energy_model_courier24;
    config.learning = fuzz_below(input, 4) == 3U ? NULL : small ? &jp_learning_gao2018 : &jp_learning_courier24;
    config.meter = (enum jp_pilot_meter)fuzz_below(input, JP_PILOT_BATTERY + 1U);
    robot_config.monitor.freeze_ticks = 0;
    robot_config.monitor.current_residual = INT32_MAX;
    FUZZ_CHANGE(input, model);
    FUZZ_CHANGE(input, robot_config.limits);
    FUZZ_CHANGE(input, robot_config.trajectory);
    sensors =
        (struct jp_sensors){.accel_z = JP_Q24_ONE,
                            .bus_voltage = (robot_config.monitor.voltage_min + robot_config.monitor.voltage_max) / 2};
    return jp_robot_init(&robot, &robot_config, &field) == JP_OK &&
           jp_pilot_init(&pilot, &config, &robot, &field) == JP_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    jp_q16 current = 0;

    if (!start(&input)) {
        return 0;
    }
    for (unsigned i = 0; i < 20U; i++) {
        tick(0);
    }
    (void)jp_robot_enable(&robot);
    for (unsigned i = 0; i < TICKS; i++) {
        if (i % 16U == 0U && fuzz_bool(&input)) {
            command(&input);
            current = fuzz_range(&input, -JP_Q16(3), JP_Q16(3));
        }
        tick(current);
        if (i % 4U == 0U) {
            (void)jp_pilot_work(&pilot);
            check_pilot();
        }
    }
    jp_pilot_stop(&pilot);
    tick(0);
    (void)jp_pilot_work(&pilot);
    fuzz_require(pilot.phase == JP_PILOT_RESTING, "a pilot that goes on after a stop");
    return 0;
}
