/* What others read of a robot from any context: whole copies, and single words. */
#include <joulepath/skid_robot.h>

#include "src/base/compiler.h"
#include "src/base/sequence.h"

#define TWO_PI JP_Q24(6.283185307179586)

static void copy_telemetry(const struct jp_skid_robot_internal *robot, struct jp_skid_telemetry *telemetry)
{
    const struct jp_skid_odometry *odometry = &robot->odometry;

    telemetry->state = robot->state;
    telemetry->faults = robot->faults;
    telemetry->tick = robot->tick;
    telemetry->x = odometry->x;
    telemetry->y = odometry->y;
    telemetry->heading = odometry->heading;
    telemetry->motion = (struct jp_motion){odometry->speed, jp_q24_multiply(odometry->turn_rate, TWO_PI)};
    telemetry->reference = robot->reference;
    telemetry->command = robot->command.motion;
    telemetry->command_ticks_left = robot->command.ticks;
    telemetry->commands = robot->commands;
    telemetry->path_piece = jp_path_drive_piece(&robot->follow.drive);
    telemetry->voltages = robot->voltages;
    telemetry->rise = robot->wheels.rise;
    telemetry->steering_ratio = odometry->steering_ratio;
    telemetry->energy = robot->meter.battery;
    telemetry->saturated_ticks = robot->saturated_ticks;
    telemetry->dropped_frames = robot->monitor.dropped_frames;
}

bool jp_skid_robot_telemetry(const struct jp_skid_robot *robot, struct jp_skid_telemetry *telemetry)
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

/* One word is of one tick, whenever it is read. */
enum jp_skid_robot_state jp_skid_robot_state_now(const struct jp_skid_robot *robot)
{
    return JP_LOAD(&robot->internal.state);
}

bool jp_skid_robot_has_next(const struct jp_skid_robot *robot)
{
    return JP_LOAD_ACQUIRE(&robot->internal.next_full) != 0U;
}

jp_q24 jp_skid_robot_pitch(const struct jp_skid_robot *robot)
{
    const struct jp_skid_monitor *ground = &robot->internal.wheels;
    const jp_angle angle = jp_atan2(ground->rise, ground->upright);

    return (jp_q24)-jp_round_shift((int32_t)angle, 8);
}
