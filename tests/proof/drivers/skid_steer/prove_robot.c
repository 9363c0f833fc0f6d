// eva: -eva-precision 0 -eva-auto-loop-unroll 64
// eva: -eva-slevel-function main:100,any_skid:200,passes:200,jp_skid_robot_init:100,check:200,check_own:100
// eva: -eva-slevel-function jp_config_check:200,is_within:50,require_within:50,jp_skid_odometry_check:50
// eva: -eva-slevel-function jp_path_drive_init:50,jp_skid_control_check:50,jp_monitor_check:50
// eva: -eva-slevel-function jp_skid_monitor_check:50,jp_meter_check:50
/** Any configuration that passes, any frames and statuses, any commands, at any time, for ever; a reset at any time,
 * with any bytes retained, and any scale of the gyro that can be stored. */
#include "tests/proof/any_skid.h"

#define ROBOT jp_skid_robot
#define ORDER jp_skid_command
#include "tests/proof/any_robot.h"

static void look(const struct jp_skid_robot *robot)
{
    struct jp_skid_telemetry telemetry;

    (void)jp_skid_robot_telemetry(robot, &telemetry);
    (void)jp_skid_robot_state_now(robot);
    (void)jp_skid_robot_has_next(robot);
    (void)jp_skid_robot_pitch(robot);
    (void)jp_skid_robot_stopping_distance(jp_skid_robot_configuration(robot), any_between(-JP_Q24(8), JP_Q24(8)));
}

static void tick(struct jp_skid_robot *robot)
{
    struct jp_sensors sensors;
    struct jp_actuation actuation;

    ANY(sensors);
    jp_skid_robot_tick(robot, any_reading(), &sensors, &actuation);
}

static void reset(struct jp_skid_robot *robot, const struct jp_skid_robot_config *config)
{
    const struct jp_gyro_scale scale = {any_between(-JP_GYRO_SCALE_MAX, JP_GYRO_SCALE_MAX),
                                        any_between(0, JP_GYRO_SCALE_DEVIATION_MAX)};
    struct jp_skid_snapshot snapshot;
    const char *field;

    jp_skid_robot_snapshot(robot, &snapshot);
    if (any_bool()) {
        ANY(snapshot);
    }
    while (jp_skid_robot_init(robot, config, &field) != JP_OK) {
        /* It passed before. */
    }
    if (any_bool()) {
        jp_skid_robot_know_gyro_scale(robot, &scale);
    }
    (void)jp_skid_robot_resume(robot, &snapshot);
}

int main(void)
{
    static struct jp_skid_robot robot;

    if (!any_skid(&robot)) {
        return 0;
    }
    ANY_TIMES
    {
        command(&robot);
        if (any_bool()) {
            jp_skid_robot_stop(&robot);
        }
        tick(&robot);
        look(&robot);
        if (any_bool()) {
            reset(&robot, &any_skid_config);
        }
    }
    ARRIVED();
    return 0;
}
