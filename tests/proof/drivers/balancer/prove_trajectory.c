// eva: -eva-slevel-function main:100,passes:200,jp_robot_init:100,check:200
/** Any configuration that passes, any frames and statuses through a board, any trajectories, stopped and switched off
 * at any time, for ever. */
#include <joulepath/robot.h>

#define ROBOT jp_robot
#define ORDER jp_segment_command
#include "tests/proof/any_robot.h"
#include "tests/proof/any_trajectory.h"

/** As jp_robot_init() does, one by one: so the analyser keeps the ranges. */
static bool passes(const struct jp_robot_config *config)
{
    const char *field;

    return jp_estimator_check(&config->estimator, &field) == JP_OK &&
           jp_reference_check(&config->reference, &field) == JP_OK && jp_lqr_check(&config->lqr, &field) == JP_OK &&
           jp_monitor_check(&config->monitor, &field) == JP_OK && jp_meter_check(&config->meter, &field) == JP_OK &&
           jp_segment_limits_check(&config->limits, NULL, &field) == JP_OK &&
           jp_trajectory_check(&config->trajectory, &field) == JP_OK;
}

static void drive(struct jp_robot *robot)
{
    static struct jp_trajectory trajectory;

    if (!jp_robot_has_next(robot) && jp_robot_state_now(robot) == JP_ROBOT_BALANCING) {
        any_trajectory(&trajectory);
        (void)jp_robot_drive_trajectory(robot, &trajectory);
    }
}

int main(void)
{
    static struct jp_robot_config config;
    static struct jp_robot robot;
    enum jp_status written = JP_OK;
    const char *field;

    ANY(config);
    config.name = "any";
    if (!passes(&config) || jp_robot_init(&robot, &config, &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        command(&robot);
        drive(&robot);
        if (any_bool()) {
            jp_robot_stop(&robot);
        }
        jp_hal_tick(&any_board, &robot, &written);
    }
    ARRIVED();
    return 0;
}
