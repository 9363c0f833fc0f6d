// eva: -eva-precision 0 -eva-auto-loop-unroll 64
// eva: -eva-slevel-function main:100,passes:200,jp_skid_robot_init:100,check:200,check_own:100
// eva: -eva-slevel-function jp_config_check:200,is_within:50,require_within:50,jp_skid_odometry_check:50
// eva: -eva-slevel-function jp_path_drive_init:50,follow:20,jp_skid_robot_follow:20
// eva: -eva-slevel-function jp_skid_control_check:50,jp_monitor_check:50,jp_skid_monitor_check:50,jp_meter_check:50
/** Any configuration that passes, any frames and statuses through a board, any paths, stopped and switched off at any
 * time, for ever. */
#include <joulepath/skid_robot.h>

#define ROBOT jp_skid_robot
#define ORDER jp_skid_command
#include "tests/proof/any_path.h"
#include "tests/proof/any_robot.h"

/** As jp_skid_robot_init() does, one by one: so the analyser keeps the ranges. */
static bool passes(const struct jp_skid_robot_config *config)
{
    static struct jp_path_drive drive;
    const char *field;

    return jp_path_drive_init(&drive, &config->path, &field) == JP_OK &&
           jp_skid_odometry_check(&config->odometry, &field) == JP_OK &&
           jp_skid_control_check(&config->control, &field) == JP_OK &&
           jp_monitor_check(&config->monitor, &field) == JP_OK &&
           jp_skid_monitor_check(&config->wheels, &field) == JP_OK && jp_meter_check(&config->meter, &field) == JP_OK;
}

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
    static struct jp_skid_robot_config config;
    static struct jp_skid_robot robot;
    enum jp_status written = JP_OK;
    const char *field;

    ANY(config);
    config.name = "any";
    if (!passes(&config) || jp_skid_robot_init(&robot, &config, &field) != JP_OK) {
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
