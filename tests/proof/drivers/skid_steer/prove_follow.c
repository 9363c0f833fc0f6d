// eva: -eva-precision 0 -eva-auto-loop-unroll 64
// eva: -eva-slevel-function main:100,any_skid:200,passes:200,jp_skid_robot_init:100,check:200,check_own:100
// eva: -eva-slevel-function jp_config_check:200,is_within:50,require_within:50,jp_skid_odometry_check:50
// eva: -eva-slevel-function jp_path_drive_init:50,follow:20,jp_skid_robot_follow:20
// eva: -eva-slevel-function jp_skid_control_check:50,jp_monitor_check:50,jp_skid_monitor_check:50,jp_meter_check:50
/** Any configuration that passes, any frames and statuses through a board, any paths, stopped and switched off at any
 * time, for ever. */
#include "tests/proof/any_skid.h"

#define ROBOT jp_skid_robot
#define ORDER jp_skid_command
#include "tests/proof/any_path.h"
#include "tests/proof/any_robot.h"

static void follow(struct jp_skid_robot *robot)
{
    static struct jp_lattice_path path;

    if (jp_skid_robot_state_now(robot) == JP_SKID_ROBOT_STANDING) {
        any_path(&path);
        (void)jp_skid_robot_follow(robot, &path);
    }
}

int main(void)
{
    static struct jp_skid_robot robot;
    enum jp_status written = JP_OK;

    if (!any_skid(&robot)) {
        return 0;
    }
    ANY_TIMES
    {
        command(&robot);
        follow(&robot);
        if (any_bool()) {
            jp_skid_robot_stop(&robot);
        }
        jp_hal_skid_tick(&any_board, &robot, &written);
    }
    ARRIVED();
    return 0;
}
