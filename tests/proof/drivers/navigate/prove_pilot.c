// eva: -eva-precision 0 -eva-auto-loop-unroll 64
// eva: -eva-slevel-function main:1000,any_balancer:1000,passes:1000,jp_robot_init:1000,check:200,jp_pilot_init:1000
// eva: -eva-slevel-function jp_config_check:200,is_within:50,require_within:50,jp_estimator_check:50,jp_lqr_check:50
// eva: -eva-slevel-function jp_reference_check:50,jp_monitor_check:50,jp_meter_check:50,jp_trajectory_check:50
// eva: -eva-slevel-function jp_segment_limits_check:50,jp_energy_model_check:50,jp_learning_check:50
// eva: -eva-slevel-function jp_robot_telemetry:50,look:50,stands:50,turn:50
/** A pilot of any robot, model and learning that pass, and what the robot and the slices of work may have left of it:
 * any requests and questions, any voltage that lacks. The slices have no driver. */
#include <joulepath/balancer_vehicle.h>

#include "tests/proof/any_balancer.h"

static struct jp_robot robot;
static struct jp_pilot pilot;
static struct jp_energy_model model;
static struct jp_learning learning;
static struct jp_point targets[2];

/** What ticks and slices of work leave. */
static void pass(void)
{
    ANY(robot.internal.telemetry);
    robot.internal.next_full = (uint8_t)any_unsigned(1);
    robot.internal.sequence = any_unsigned(UINT32_MAX);
    pilot.phase = (enum jp_pilot_phase)any_between(JP_PILOT_RESTING, JP_PILOT_DRIVING);
    pilot.status = (enum jp_status)any_int();
    pilot.internal.question = (enum jp_pilot_question)any_between(JP_PILOT_NOTHING_ASKED, JP_PILOT_ANSWERED);
    pilot.internal.forecast_status = (enum jp_status)any_int();
    ANY(pilot.internal.forecast);
    pilot.internal.drive.is_waiting = any_bool();
    pilot.internal.drive.is_driven = any_bool();
}

static void request(void)
{
    struct jp_pilot_route route;

    ANY(route);
    route.targets = any_bool() ? targets : NULL;
    route.passages = NULL;
    (void)jp_pilot_follow(&pilot, &route);
    (void)jp_pilot_ask(&pilot, &route);
    if (any_bool()) {
        jp_pilot_stop(&pilot);
    }
}

static void look(void)
{
    struct jp_forecast forecast;

    (void)jp_pilot_answer(&pilot, &forecast);
    (void)jp_pilot_lack_voltage(&pilot, any_int());
    (void)jp_pilot_cruise_now(&pilot, &model);
    (void)jp_pilot_cruise(&any_balancer_config, &model);
}

/** As the navigator asks. */
static void navigate(void)
{
    struct jp_balancer_vehicle balancer;
    struct jp_vehicle vehicle;
    struct jp_vehicle_view view;
    struct jp_forecast energy;
    jp_q16 duration;

    while (jp_balancer_vehicle_init(&balancer, &pilot, &vehicle) != JP_OK) {
        /* Nothing is null. */
    }
    vehicle.look(vehicle.context, &view);
    (void)vehicle.turn(vehicle.context, any_unsigned(UINT32_MAX), NULL);
    vehicle.stop(vehicle.context);
    vehicle.forecast(vehicle.context, &duration, &energy);
}

int main(void)
{
    const struct jp_pilot_config config = {.model = &model,
                                           .learning = any_bool() ? &learning : NULL,
                                           .meter =
                                               (enum jp_pilot_meter)any_between(JP_PILOT_MOTORS, JP_PILOT_BATTERY)};
    const char *field;

    ANY(model);
    ANY(learning);
    ANY(targets);
    if (!any_balancer(&robot) || jp_pilot_init(&pilot, &config, &robot, &field) != JP_OK) {
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
