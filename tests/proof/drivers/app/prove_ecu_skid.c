// eva: -eva-precision 0 -eva-auto-loop-unroll 64
// eva: -eva-slevel-function main:1000,any_skid:200,passes:200,jp_skid_robot_init:500,check:200,check_own:100
// eva: -eva-slevel-function jp_config_check:200,is_within:50,require_within:50,jp_skid_odometry_check:50
// eva: -eva-slevel-function jp_path_drive_init:50,jp_skid_control_check:50,jp_monitor_check:50,jp_skid_monitor_check:50
// eva: -eva-slevel-function jp_meter_check:50,jp_ecu_skid_init:500,prepare:500,jp_skid_pilot_init:500,restore:20
// eva: -eva-slevel-function jp_skid_energy_check:50,jp_skid_learning_check:50,jp_path_limits_check:50
/** Any tables that pass, any state and any scale of the gyro that are stored: how a skid-steered robot and its pilot
 * are prepared for the application. */
#include "hal/app/ecu_skid.h"
#include "tests/proof/any_skid.h"

static struct jp_ecu_skid skid;
static struct jp_skid_energy_model energy;
static struct jp_skid_learning learning;
static struct jp_path_limits limits;
static struct jp_learned_state state;
static struct jp_gyro_scale scale;

int main(void)
{
    const struct jp_ecu_skid_config config = {.robot = &any_skid_config,
                                              .energy = &energy,
                                              .learning = &learning,
                                              .limits = &limits,
                                              .corner = any_int(),
                                              .goal_corner = any_int(),
                                              .stored =
                                                  (enum jp_stored)any_between(JP_STORED_TAKEN, JP_STORED_OTHER_TABLES),
                                              .state = any_bool() ? &state : NULL,
                                              .scale = any_bool() ? &scale : NULL};
    struct jp_ecu_robot robot;
    const char *field;

    ANY(any_skid_config);
    any_skid_config.name = "any";
    ANY(energy);
    ANY(learning);
    ANY(limits);
    ANY(state);
    scale = (struct jp_gyro_scale){any_between(-JP_GYRO_SCALE_MAX, JP_GYRO_SCALE_MAX),
                                   any_between(0, JP_GYRO_SCALE_DEVIATION_MAX)};
    if (!passes(&any_skid_config) || jp_skid_energy_check(&energy, &field) != JP_OK ||
        jp_skid_learning_check(&learning, &field) != JP_OK || jp_path_limits_check(&limits, &field) != JP_OK ||
        jp_ecu_skid_init(&skid, &config, &robot, &field) != JP_OK) {
        return 0;
    }
    (void)jp_ecu_skid_gyro_scale(&skid);
    (void)robot.kind->state(robot.self);
    (void)robot.kind->parameter(robot.self, (uint8_t)any_unsigned(robot.kind->parameters - 1U));
    ARRIVED();
    return 0;
}
