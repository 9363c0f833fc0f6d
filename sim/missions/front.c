#include "sim/missions/front.h"

#include <stdio.h>

#include "sim/balancer/energy_unit.h"
#include "sim/balancer/rig.h"
#include "sim/base/error.h"
#include "sim/base/progress.h"
#include "sim/missions/cruise_plan.h"
#include "sim/missions/mission.h"

#define Q16_ONE 65536.0
#define Q24_ONE 16777216.0

/** More than any route takes that can be planned at the speeds that pay, s. */
#define LONG_ENOUGH 32766.0

#define SHARE_OF_TIME   0.8
#define SHARE_OF_ENERGY 1.1

static const double shares[] = {0.95, 0.9, 0.85, 0.75, 0.7, 0.65, 0.6, 0.55};

/** What all points have. */
struct maker {
    struct front *front;
    struct scenario scenario;
    const struct robot_entry *entry;
    const struct jp_energy_model *model;
    struct cruise_plan plan;
    struct mission mission;
};

const char *front_request_name(enum front_request request)
{
    static const char *const names[] = {"least_energy", "share", "within_seconds", "within_joules"};

    return names[request];
}

static struct front_forecast forecast_of(const struct maker *maker)
{
    const struct cruise_plan *plan = &maker->plan;

    return (struct front_forecast){plan->forecast.cruise / Q24_ONE, plan->forecast.seconds / Q16_ONE,
                                   energy_unit_joules(maker->model, plan->forecast.energy)};
}

static void sweep(struct maker *maker)
{
    struct front *front = maker->front;
    const jp_q24 limit = maker->entry->config->limits.speed;
    const jp_q24 cheapest = jp_cruise_speed(maker->model);
    const jp_q24 low = (cheapest < limit ? cheapest : limit) / 2;

    for (int i = 0; i < FRONT_FORECASTS; i++) {
        const jp_q24 cruise = low + (limit - low) / (FRONT_FORECASTS - 1) * i;

        if (cruise_plan_at(&maker->plan, &maker->scenario, maker->entry->config, maker->model, cruise) == JP_OK &&
            maker->plan.forecast.seconds < INT32_MAX && maker->plan.forecast.energy < INT32_MAX) {
            front->forecasts[front->forecast_count++] = forecast_of(maker);
        }
    }
}

static double worst_miss(const struct mission *mission)
{
    double worst = 0;

    for (size_t i = 0; i < mission->leg_count; i++) {
        worst = mission->legs[i].passed > worst ? mission->legs[i].passed : worst;
    }
    return worst;
}

static bool drive(struct maker *maker, struct front_drive *point)
{
    const struct mission_view view = {.progress = front_request_name(point->request)};

    if (!mission_run(&maker->mission, MISSION_CRUISE, &maker->scenario, NULL, &view)) {
        mission_complain(&maker->mission, &maker->scenario);
        return false;
    }
    point->seconds = maker->mission.total.duration;
    point->joules = maker->mission.total.plant_energy;
    point->end_speed = maker->mission.total.end_speed;
    point->miss = worst_miss(&maker->mission);
    return true;
}

/** Plans within the budget and drives that. A share of the time that is too short is left out. */
static bool add(struct maker *maker, enum front_request request, double seconds, double joules)
{
    struct front *front = maker->front;
    struct front_drive *point = &front->drives[front->drive_count];

    maker->scenario.within_seconds = seconds;
    maker->scenario.within_joules = joules;

    const enum jp_status status =
        cruise_plan_within(&maker->plan, &maker->scenario, maker->entry->config, maker->model);

    if (status == JP_ERR_INFEASIBLE && request == FRONT_SHARE) {
        return true;
    }
    *point = (struct front_drive){.request = request,
                                  .limit = request == FRONT_LEAST_ENERGY ? 0 : seconds + joules,
                                  .forecast = forecast_of(maker)};
    front->drive_count++;
    return drive(maker, point);
}

static bool add_all(struct maker *maker, const struct scenario *asked)
{
    if (!add(maker, FRONT_LEAST_ENERGY, LONG_ENOUGH, 0)) {
        return false;
    }

    const struct front_forecast least = maker->front->drives[0].forecast;
    const double seconds = asked->within_seconds > 0 ? asked->within_seconds : SHARE_OF_TIME * least.seconds;
    const double joules = asked->within_joules > 0 ? asked->within_joules : SHARE_OF_ENERGY * least.joules;

    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        if (!add(maker, FRONT_SHARE, shares[i] * least.seconds, 0)) {
            return false;
        }
    }
    return add(maker, FRONT_WITHIN_SECONDS, seconds, 0) && add(maker, FRONT_WITHIN_JOULES, 0, joules);
}

bool front_make(struct front *front, const struct scenario *scenario)
{
    static struct maker maker;

    *front = (struct front){0};
    maker = (struct maker){.front = front, .scenario = *scenario, .entry = rig_find_robot(scenario->robot.name)};
    maker.model = maker.entry == NULL ? NULL : mission_model(scenario, maker.entry);
    if (maker.model == NULL) {
        return false;
    }
    sweep(&maker);
    return add_all(&maker, scenario);
}

/* What came of it. */

void front_print(const struct front *front)
{
    (void)printf("%-15s %9s %10s %11s %11s %10s %10s %9s\n", "request", "limit", "cruise m/s", "forecast s",
                 "forecast J", "driven s", "driven J", "passed m");
    for (size_t i = 0; i < front->drive_count; i++) {
        const struct front_drive *point = &front->drives[i];

        (void)printf("%-15s %9.2f %10.4f %11.3f %11.2f %10.3f %10.2f %9.3f\n", front_request_name(point->request),
                     point->limit, point->forecast.cruise, point->forecast.seconds, point->forecast.joules,
                     point->seconds, point->joules, point->miss);
    }
}

static json_t *json_forecast(const struct front_forecast *forecast)
{
    return json_pack("{s:f, s:f, s:f}", "cruise_m_s", forecast->cruise, "duration_s", forecast->seconds, "energy_j",
                     forecast->joules);
}

static json_t *json_drive(const struct front_drive *point)
{
    return json_pack("{s:s, s:f, s:o, s:f, s:f, s:f, s:f}", "request", front_request_name(point->request), "limit",
                     point->limit, "forecast", json_forecast(&point->forecast), "duration_s", point->seconds,
                     "plant_energy_j", point->joules, "end_speed_m_s", point->end_speed, "passed_m", point->miss);
}

json_t *front_json(const struct scenario *scenario, const struct front *front)
{
    json_t *waypoints = json_array();
    json_t *forecasts = json_array();
    json_t *drives = json_array();

    for (size_t i = 0; i < scenario->waypoint_count; i++) {
        (void)json_array_append_new(waypoints, json_pack("[f, f]", scenario->waypoints[i].x, scenario->waypoints[i].y));
    }
    for (size_t i = 0; i < front->forecast_count; i++) {
        (void)json_array_append_new(forecasts, json_forecast(&front->forecasts[i]));
    }
    for (size_t i = 0; i < front->drive_count; i++) {
        (void)json_array_append_new(drives, json_drive(&front->drives[i]));
    }
    return json_pack("{s:s, s:s, s:s, s:I, s:o, s:o, s:o}", "robot", scenario->robot.name, "scenario", scenario->name,
                     "energy", energy_kind_name(scenario->energy), "seed", (json_int_t)scenario->seed, "waypoints_m",
                     waypoints, "forecasts", forecasts, "drives", drives);
}
