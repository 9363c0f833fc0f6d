/**
 * A robot that its sides steer with any configuration that it accepts, any sensors and any commands, for a thousand
 * ticks: the motors are off unless it was enabled or brakes after a reset in motion, and voltages are within the
 * supply.
 */
#include <joulepath/skid_robot.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_sensors.h"

#define TICKS 1000U

static struct jp_skid_robot robot;
static struct jp_skid_robot_config config;

/** `moved`: the encoders did, since init. */
static void check_tick(const struct jp_actuation *actuation, bool may_run, bool moved)
{
    struct jp_skid_telemetry telemetry;

    fuzz_require(actuation->enabled <= 1U, "whether the bridges are on");
    fuzz_require(actuation->enabled != 0U || (actuation->duty_left == 0 && actuation->duty_right == 0),
                 "duties of bridges that are off");
    fuzz_require(jp_skid_robot_telemetry(&robot, &telemetry), "telemetry");
    fuzz_require(telemetry.state <= JP_SKID_ROBOT_FAULT, "state of the robot");
    fuzz_require((telemetry.state != JP_SKID_ROBOT_STANDING && telemetry.state != JP_SKID_ROBOT_DRIVING) || may_run,
                 "a robot that nobody enabled");
    fuzz_require(may_run || moved || (actuation->duty_left == 0 && actuation->duty_right == 0),
                 "duties of a robot at rest that nobody enabled");
    fuzz_require(fuzz_within(telemetry.voltages.left, config.monitor.voltage_max) &&
                     fuzz_within(telemetry.voltages.right, config.monitor.voltage_max),
                 "voltages beyond any supply");
    if (telemetry.state == JP_SKID_ROBOT_STANDING || telemetry.state == JP_SKID_ROBOT_DRIVING) {
        const struct jp_sensors *good = jp_skid_robot_good_frame(&robot);

        fuzz_require(good != NULL && good->bus_voltage > 0, "a supply that cannot be");
        fuzz_require(fuzz_within(telemetry.voltages.left, good->bus_voltage) &&
                         fuzz_within(telemetry.voltages.right, good->bus_voltage),
                     "voltages beyond the supply");
    }
    fuzz_require(telemetry.steering_ratio > 0, "a steering ratio out of range");
}

static void draw_command(struct fuzz_input *input, struct jp_skid_command *command)
{
    *command = (struct jp_skid_command){.duration = fuzz_range(input, 0, JP_Q16(2))};
    command->motion.speed = fuzz_range(input, -config.limits.speed, config.limits.speed);
    command->motion.turn_rate = fuzz_range(input, -JP_Q24(8), JP_Q24(8));
    FUZZ_CHANGE(input, *command);
}

/** Returns whether the motors may run from now on. */
static bool command(struct fuzz_input *input, bool may_run)
{
    struct jp_skid_command order;

    switch (fuzz_below(input, 6)) {
    case 0:
        return jp_skid_robot_enable(&robot) == JP_OK || may_run;
    case 1:
        jp_skid_robot_disable(&robot);
        return may_run;
    case 2:
        jp_skid_robot_stop(&robot);
        return may_run;
    case 3:
        fuzz_require(jp_skid_robot_stopping_distance(&config, fuzz_range(input, -JP_Q24(8), JP_Q24(8))) >= 0,
                     "a way of braking");
        (void)jp_skid_robot_pitch(&robot);
        return may_run;
    default:
        draw_command(input, &order);
        (void)jp_skid_robot_drive(&robot, &order);
        return may_run;
    }
}

/** A start, after a reset with what was retained: of this robot, or any bytes. */
static bool start(struct fuzz_input *input, const struct jp_skid_snapshot *retained, bool *moved)
{
    const char *field = NULL;
    const enum jp_status status = jp_skid_robot_init(&robot, &config, &field);

    (void)fuzz_accepted(status, field);
    if (status == JP_OK && retained != NULL) {
        struct jp_skid_snapshot changed = *retained;

        FUZZ_CHANGE(input, changed);
        *moved = jp_skid_robot_resume(&robot, &changed) || *moved;
    }
    return status == JP_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct fuzz_sensors sensors;
    struct jp_skid_snapshot retained;
    bool may_run = false;
    bool moved = false;

    config = fuzz_bool(&input) ? jp_skid_robot_zhang2018 : jp_skid_robot_burger;
    FUZZ_CHANGE_FROM(&input, config, odometry);
    if (!start(&input, NULL, &moved)) {
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
            jp_skid_robot_snapshot(&robot, &retained);
            may_run = false;
            (void)start(&input, &retained, &moved);
        }
        moved = moved || sensors.frame.encoder_left != 0U || sensors.frame.encoder_right != 0U ||
                sensors.step_left != 0 || sensors.step_right != 0;
        fuzz_sensors_move(&sensors);
        jp_skid_robot_tick(&robot, sensors.read, &sensors.frame, &actuation);
        check_tick(&actuation, may_run, moved);
    }
    return 0;
}
