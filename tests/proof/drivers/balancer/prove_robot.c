// eva: -eva-slevel-function main:100,any_balancer:200,passes:200,jp_robot_init:100,check:200
/** Any configuration that passes, any frames and statuses, any segments, at any time, for ever; a reset at any time.
 *  Trajectories have a driver of their own. */
#include "tests/proof/any_balancer.h"

#define ROBOT jp_robot
#define ORDER jp_segment_command
#include "tests/proof/any_robot.h"

static void look(const struct jp_robot *robot)
{
    struct jp_telemetry telemetry;
    struct jp_motor_sample sample;
    struct jp_point position;
    jp_angle heading;

    if (jp_robot_telemetry(robot, &telemetry)) {
        jp_robot_predict_end(robot, &telemetry, &position, &heading);
    }
    (void)jp_robot_motors(robot, &sample);
    (void)jp_robot_state_now(robot);
    (void)jp_robot_has_next(robot);
    (void)jp_robot_position(robot);
}

static void tick(struct jp_robot *robot)
{
    struct jp_sensors sensors;
    struct jp_actuation actuation;

    ANY(sensors);
    jp_robot_tick(robot, any_reading(), &sensors, &actuation);
}

static void reset(struct jp_robot *robot, const struct jp_robot_config *config)
{
    struct jp_snapshot snapshot;
    const char *field;

    jp_robot_snapshot(robot, &snapshot);
    while (jp_robot_init(robot, config, &field) != JP_OK) {
        /* It passed before. */
    }
    jp_robot_know_gyro_bias(robot, any_long(-JP_Q24(0.05) * (INT64_C(1) << 32), JP_Q24(0.05) * (INT64_C(1) << 32)));
    jp_robot_resume(robot, &snapshot);
}

int main(void)
{
    static struct jp_robot robot;

    if (!any_balancer(&robot)) {
        return 0;
    }
    ANY_TIMES
    {
        command(&robot);
        if (any_bool()) {
            jp_robot_stop(&robot);
        }
        tick(&robot);
        look(&robot);
        if (any_bool()) {
            reset(&robot, &any_balancer_config);
        }
    }
    ARRIVED();
    return 0;
}
