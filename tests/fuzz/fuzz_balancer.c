/**
 * The balancer's robot with any configuration that it accepts, any sensors and any commands, for a thousand ticks: the
 * motors are off unless it was enabled, voltages are within the supply, and the telemetry is whole.
 */
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_sensors.h"

#define TICKS 1000U

static struct jp_robot robot;
static struct jp_robot_config config;

static bool runs(void)
{
    const enum jp_robot_state state = jp_robot_state_now(&robot);

    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

static void check_tick(const struct jp_actuation *actuation, bool may_run)
{
    const struct jp_tick_telemetry *last = jp_robot_last_tick(&robot);
    const struct jp_sensors *good = jp_robot_good_frame(&robot);
    struct jp_telemetry telemetry;

    fuzz_require(actuation->enabled <= 1U && (actuation->enabled != 0U) == runs(), "motors by the state");
    fuzz_require(!runs() || may_run, "motors that nobody enabled");
    fuzz_require(actuation->enabled != 0U || (actuation->duty_left == 0 && actuation->duty_right == 0),
                 "duties of bridges that are off");
    if (actuation->enabled != 0U) {
        fuzz_require(good != NULL && good->bus_voltage >= config.monitor.voltage_min &&
                         good->bus_voltage <= config.monitor.voltage_max,
                     "a supply that cannot be");
        fuzz_require(fuzz_within(last->voltages.left, good->bus_voltage) &&
                         fuzz_within(last->voltages.right, good->bus_voltage),
                     "voltages beyond the supply");
    }
    fuzz_require(last->state <= JP_ROBOT_FAULT, "state of the robot");
    fuzz_require((last->state == JP_ROBOT_FAULT) == (last->faults != 0U) || last->state == JP_ROBOT_FALLEN,
                 "a fault by the faults");
    fuzz_require(jp_robot_telemetry(&robot, &telemetry) && telemetry.state == last->state, "telemetry");
}

static void draw_segment(struct fuzz_input *input, struct jp_segment_command *segment)
{
    *segment = (struct jp_segment_command){.duration = JP_Q16(0.01)};
    segment->motion.speed = fuzz_range(input, -config.limits.speed, config.limits.speed);
    segment->motion.turn_rate = fuzz_range(input, -JP_Q24(8), JP_Q24(8));
    segment->turn = fuzz_range(input, -JP_Q24(6), JP_Q24(6));
    segment->duration = fuzz_range(input, 0, JP_Q16(1));
    FUZZ_CHANGE(input, *segment);
}

/** Returns whether the motors may run from now on. */
static bool command(struct fuzz_input *input, bool may_run)
{
    struct jp_segment_command segment;
    struct jp_motor_sample sample;
    struct jp_telemetry telemetry;
    struct jp_point end;
    jp_angle heading;

    switch (fuzz_below(input, 6)) {
    case 0:
        return jp_robot_enable(&robot) == JP_OK || may_run;
    case 1:
        jp_robot_disable(&robot);
        return may_run;
    case 2:
        jp_robot_stop(&robot);
        return may_run;
    case 3:
        if (jp_robot_telemetry(&robot, &telemetry)) {
            jp_robot_predict_end(&robot, &telemetry, &end, &heading);
        }
        (void)jp_robot_motors(&robot, &sample);
        return may_run;
    default:
        draw_segment(input, &segment);
        (void)jp_robot_drive(&robot, &segment);
        return may_run;
    }
}

/** A start after a reset: what was retained is that of a robot of this configuration. */
static bool start(struct fuzz_input *input, const struct jp_snapshot *retained)
{
    const char *field = NULL;
    const enum jp_status status = jp_robot_init(&robot, &config, &field);

    (void)fuzz_accepted(status, field);
    if (status == JP_OK && fuzz_bool(input)) {
        jp_robot_know_gyro_bias(&robot, (int64_t)fuzz_range(input, -JP_Q24(0.05), JP_Q24(0.05)) * (INT64_C(1) << 32));
    }
    if (status == JP_OK && retained != NULL) {
        jp_robot_resume(&robot, retained);
    }
    return status == JP_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct fuzz_sensors sensors;
    struct jp_snapshot retained;
    bool may_run = false;

    config = fuzz_bool(&input) ? jp_robot_courier24 : jp_robot_gao2018;
    FUZZ_CHANGE_FROM(&input, config, estimator);
    if (!start(&input, NULL)) {
        return 0;
    }
    fuzz_sensors_begin(&sensors);
    sensors.frame.bus_voltage = (config.monitor.voltage_min + config.monitor.voltage_max) / 2;
    for (unsigned tick = 0; tick < TICKS; tick++) {
        struct jp_actuation actuation;

        if (tick % 4U == 0U && fuzz_bool(&input)) {
            fuzz_sensors_change(&sensors, &input);
            may_run = command(&input, may_run);
        }
        if (tick % 64U == 63U && fuzz_below(&input, 8) == 1U) {
            jp_robot_snapshot(&robot, &retained);
            may_run = retained.balancing;
            (void)start(&input, &retained);
        }
        fuzz_sensors_move(&sensors);
        jp_robot_tick(&robot, sensors.read, &sensors.frame, &actuation);
        check_tick(&actuation, may_run);
    }
    return 0;
}
