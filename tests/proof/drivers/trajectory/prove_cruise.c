// eva: -eva-slevel-function main:20
/** Any robot and model that pass: the cruise of their plans, what motors' motion takes of the voltage, and what is left
 * at the start of any trajectory. */
#include <joulepath/pilot.h>

#include "tests/proof/any_trajectory.h"

int main(void)
{
    static struct jp_robot_config robot;
    static struct jp_energy_model model;
    struct jp_trajectory trajectory;
    jp_q24 modes[JP_TRAVEL_MODES];
    const char *field;

    ANY(robot);
    ANY(model);
    if (jp_energy_model_check(&model, &field) != JP_OK ||
        jp_segment_limits_check(&robot.limits, &model, &field) != JP_OK ||
        jp_monitor_check(&robot.monitor, &field) != JP_OK || jp_trajectory_check(&robot.trajectory, &field) != JP_OK) {
        return 0;
    }
    (void)jp_cruise_speed(&model);
    (void)jp_pilot_cruise(&robot, &model);
    (void)jp_pilot_back_emf(&robot, any_bool() ? JP_PILOT_MOTORS : JP_PILOT_BATTERY);
    any_trajectory(&trajectory);
    jp_trajectory_modes(&trajectory, modes);
    ARRIVED();
    return 0;
}
