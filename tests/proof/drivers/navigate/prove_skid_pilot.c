// eva: -eva-precision 0 -eva-auto-loop-unroll 64
// eva: -eva-slevel-function main:1000,any_skid:1000,passes:1000,jp_skid_robot_init:500,check:200,check_own:200
// eva: -eva-slevel-function jp_config_check:200,is_within:50,require_within:50,jp_skid_pilot_init:500,look:50
// eva: -eva-slevel-function jp_skid_odometry_check:50,jp_path_drive_init:50,jp_skid_control_check:50
// eva: -eva-slevel-function jp_monitor_check:50,jp_skid_monitor_check:50,jp_meter_check:50
// eva: -eva-slevel-function jp_skid_energy_check:50,jp_skid_learning_check:50,jp_path_limits_check:50
/** A pilot of any robot and tables that pass, and what the robot and the slices of work may have left of it: any
 * requests and questions, any voltage that lacks. The slices have no driver. */
#include <joulepath/skid_vehicle.h>

#include "tests/proof/any_skid.h"

static struct jp_skid_robot robot;
static struct jp_skid_pilot pilot;
static struct jp_skid_vehicle skid;
static struct jp_skid_energy_model model;
static struct jp_skid_learning learning;
static struct jp_path_piece pieces[6];
static struct jp_point targets[2];

/** What ticks and slices of work leave. */
static void pass(void)
{
    robot.internal.state = (enum jp_skid_robot_state)any_between(JP_SKID_ROBOT_IDLE, JP_SKID_ROBOT_FAULT);
    robot.internal.next_full = (uint8_t)any_unsigned(1);
    ANY(robot.internal.odometry);
    ANY(robot.internal.meter.battery);
    robot.internal.sequence = any_unsigned(UINT32_MAX);
    pilot.phase = (enum jp_skid_pilot_phase)any_between(JP_SKID_PILOT_RESTING, JP_SKID_PILOT_DRIVING);
    pilot.status = (enum jp_status)any_int();
    pilot.internal.question =
        (enum jp_skid_pilot_question)any_between(JP_SKID_PILOT_NOTHING_ASKED, JP_SKID_PILOT_ANSWERED);
    pilot.internal.forecast_status = (enum jp_status)any_int();
    ANY(pilot.internal.forecast);
    pilot.legs_begun = (uint16_t)any_unsigned(UINT16_MAX);
    pilot.legs_ended = (uint16_t)any_unsigned(UINT16_MAX);
}

static void request(void)
{
    struct jp_skid_pilot_route route;

    ANY(route);
    route.targets = any_bool() ? targets : NULL;
    route.ground = NULL;
    (void)jp_skid_pilot_follow(&pilot, &route);
    (void)jp_skid_pilot_turn(&pilot, any_unsigned(UINT32_MAX), NULL);
    (void)jp_skid_pilot_ask(&pilot, &route);
    if (any_bool()) {
        jp_skid_pilot_stop(&pilot);
    }
}

static void look(void)
{
    struct jp_forecast forecast;

    (void)jp_skid_pilot_answer(&pilot, &forecast);
    (void)jp_skid_pilot_lack_voltage(&pilot, any_int());
    jp_skid_pilot_pass_corners(&pilot, any_between(0, JP_Q24(8)));
}

/** As the navigator asks. */
static void navigate(void)
{
    struct jp_vehicle vehicle;
    struct jp_vehicle_view view;

    while (jp_skid_vehicle_init(&skid, &pilot, &vehicle) != JP_OK) {
        /* Nothing is null. */
    }
    vehicle.look(vehicle.context, &view);
    vehicle.stop(vehicle.context);
}

int main(void)
{
    struct jp_skid_pilot_config config = {
        .model = &model, .learning = &learning, .time = any_int(), .corner = any_int(), .pieces = pieces};
    const char *field;

    ANY(model);
    ANY(learning);
    ANY(targets);
    ANY(config.limits);
    config.places = (uint16_t)any_unsigned(6);
    if (!any_skid(&robot) || jp_skid_pilot_init(&pilot, &config, &robot, &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        pass();
        request();
        look();
        navigate();
    }
    ARRIVED();
    return 0;
}
