// eva: -eva-slevel-function main:100,any_balancer:200,passes:200,jp_robot_init:100,check:200
/** Any configuration that passes, any frames and statuses through a board, any trajectories, stopped and switched off
 * at any time, for ever. */
#include "tests/proof/any_balancer.h"

#define ROBOT jp_robot
#define ORDER jp_segment_command
#include "tests/proof/any_robot.h"
#include "tests/proof/any_trajectory.h"

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
    static struct jp_robot robot;
    enum jp_status written = JP_OK;

    if (!any_balancer(&robot)) {
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
