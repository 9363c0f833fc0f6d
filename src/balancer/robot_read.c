/* What others read of a robot from any context: whole copies, and single words. */
#include <joulepath/robot.h>

#include "src/base/compiler.h"
#include "src/base/sequence.h"

static bool motors_run(enum jp_robot_state state)
{
    return state == JP_ROBOT_BALANCING || state == JP_ROBOT_DRIVING;
}

/* Copies. */

static void copy_telemetry(const struct jp_robot_internal *robot, struct jp_telemetry *telemetry)
{
    const struct jp_tick_telemetry *tick = &robot->telemetry;
    const struct jp_reference *reference = &robot->reference;

    telemetry->state = tick->state;
    telemetry->faults = tick->faults;
    telemetry->tick = tick->tick;
    telemetry->motion = tick->motion;
    telemetry->reference_wheel = reference->wheel.angle;
    telemetry->reference_yaw = reference->yaw.angle;
    telemetry->reference_wheel_rate = reference->wheel.rate;
    telemetry->reference_yaw_rate = reference->yaw.rate;
    telemetry->target_wheel = reference->wheel.target;
    telemetry->target_yaw = reference->yaw.target;
    telemetry->position = jp_odometry_position(&robot->odometry);
    telemetry->voltages = tick->voltages;
    telemetry->energy_model = robot->meter.model;
    telemetry->energy_battery = robot->meter.battery;
    telemetry->saturated_ticks = tick->saturated_ticks;
    telemetry->segment = tick->segment;
    telemetry->segment_ticks_left = tick->segment_ticks_left;
    telemetry->command = tick->command;
    telemetry->segment_energy_model = tick->segment_energy_model;
    telemetry->segment_energy_battery = tick->segment_energy_battery;
    telemetry->segments_ended = tick->segments_ended;
    telemetry->gyro_bias = robot->estimator.gyro_bias;
    telemetry->dropped_frames = robot->monitor.dropped_frames;
}

bool jp_robot_telemetry(const struct jp_robot *robot, struct jp_telemetry *telemetry)
{
    uint32_t begun;

    do {
        if (!jp_sequence_begin_copy(&robot->internal.sequence, &begun)) {
            return false;
        }
        copy_telemetry(&robot->internal, telemetry);
    } while (!jp_sequence_is_whole(&robot->internal.sequence, begun));
    return true;
}

bool jp_robot_motors(const struct jp_robot *robot, struct jp_motor_sample *sample)
{
    const struct jp_sensors *sensors = &robot->internal.monitor.good;
    uint32_t begun;
    bool usable;

    do {
        if (!jp_sequence_begin_copy(&robot->internal.sequence, &begun)) {
            return false;
        }
        usable = motors_run(robot->internal.telemetry.state) && robot->internal.monitor.implausible_ticks == 0U;
        *sample = (struct jp_motor_sample){
            .voltages = robot->internal.reviewed,
            .wheel_rate = robot->internal.estimator.wheel.rate,
            .yaw_rate = robot->internal.estimator.yaw.rate,
            .current_left = sensors->current_left,
            .current_right = sensors->current_right,
        };
    } while (!jp_sequence_is_whole(&robot->internal.sequence, begun));
    return usable;
}

/* Single words. */

/* One word is of one tick, whenever it is read. */
enum jp_robot_state jp_robot_state_now(const struct jp_robot *robot)
{
    return JP_LOAD(&robot->internal.telemetry.state);
}

bool jp_robot_has_next(const struct jp_robot *robot)
{
    return JP_LOAD_ACQUIRE(&robot->internal.next_full) != 0U;
}
