#include "sim/missions/mission_report.h"

#include <math.h>
#include <stdio.h>

#define DEGREES (180 / M_PI)

static const struct {
    const char *name;
    const char *title;
    const char *log;
} strategies[] = {
    [MISSION_OPTIMAL] = {"optimal", "energy-optimal segments", "log_optimal.csv"},
    [MISSION_STRAIGHT] = {"straight", "straight chords, same times", "log_straight.csv"},
    [MISSION_BEZIER] = {"bezier", "energy-optimised cubic Bézier", "log_bezier.csv"},
    [MISSION_CRUISE] = {"cruise", "cruise and transients, by rule", "log_cruise.csv"},
    [MISSION_STRAIGHT_CRUISE] = {"straight_cruise", "straight chords, times of cruise and transients",
                                 "log_straight_cruise.csv"},
    [MISSION_BEZIER_ROUTE] = {"bezier_route", "Bézier, whole route at once", "log_bezier_route.csv"},
    [MISSION_OPTIMISED_CRUISE] = {"optimised_cruise", "cruise and transients, optimised", "log_optimised_cruise.csv"},
    [MISSION_ROUNDED] = {"rounded", "corners rounded where it saves", "log_rounded.csv"},
    [MISSION_TURN_AND_GO] = {"turn_and_go", "turns on the spot", "log_turn_and_go.csv"},
    [MISSION_ROUNDED_AGAIN] = {"rounded_again", "rounded again, with what was learned", "log_rounded_again.csv"},
};

const char *mission_name(enum mission_strategy strategy)
{
    return strategies[strategy].name;
}

const char *mission_log_name(enum mission_strategy strategy)
{
    return strategies[strategy].log;
}

static bool is_impossible(const struct mission *mission)
{
    return mission->impossible[0] != '\0';
}

/* The tables. */

static double error_percent(const struct mission_leg *leg)
{
    return 100 * (leg->planned_energy / leg->measured_energy - 1);
}

static void print_leg(const char *label, const struct mission_leg *leg, bool total)
{
    (void)printf("%-6s", label);
    if (leg->planned) {
        (void)printf(" %10.2f", leg->planned_energy);
    } else {
        (void)printf(" %10s", "-");
    }
    (void)printf(" %11.2f", leg->measured_energy);
    if (leg->planned) {
        (void)printf(" %8.3f", error_percent(leg));
    } else {
        (void)printf(" %8s", "-");
    }
    (void)printf(" %9.2f", leg->duration);
    if (leg->planned && !total) {
        (void)printf(" %8.4f %9.4f %8.2f", leg->speed, leg->turn_rate, leg->turn * DEGREES);
    } else {
        (void)printf(" %8s %9s %8s", "-", "-", "-");
    }
    (void)printf(" %9.3f %9.3f %12.2f\n", leg->end_error, leg->passed, leg->battery_energy);
}

void mission_print(const struct mission *mission)
{
    if (is_impossible(mission)) {
        (void)printf("\n%s\ncannot drive this route: %s\n", strategies[mission->strategy].title, mission->impossible);
        return;
    }
    (void)printf("\n%s\n%-6s %10s %11s %8s %9s %8s %9s %8s %9s %9s %12s\n", strategies[mission->strategy].title, "leg",
                 "planned J", "measured J", "error %", "time s", "v m/s", "w rad/s", "sigma °", "off m", "passed m",
                 "battery J");
    for (size_t i = 0; i < mission->leg_count; i++) {
        char label[24];

        (void)snprintf(label, sizeof label, "%zu", i + 1);
        print_leg(label, &mission->legs[i], false);
    }
    if (mission->braking.duration > 0) {
        print_leg("stand", &mission->braking, true);
    }
    print_leg("total", &mission->total, true);
    if (mission->forecast.known) {
        (void)printf("forecast before the start: %.2f J, standard deviation %.2f J\n", mission->forecast.energy,
                     mission->forecast.deviation);
    }
}

/** What the strategies are compared with: the first of them that drove. */
static const struct mission *basis_of(const struct mission *missions, size_t count)
{
    size_t i = 0;

    while (i + 1 < count && is_impossible(&missions[i])) {
        i++;
    }
    return &missions[i];
}

static double relative_percent(const struct mission *mission, const struct mission *basis)
{
    return 100 * mission->total.measured_energy / basis->total.measured_energy;
}

void mission_print_comparison(const struct mission *missions, size_t count)
{
    (void)printf("\n%-32s %11s %9s %9s\n", "strategy", "energy J", "time s", "per cent");
    for (size_t i = 0; i < count; i++) {
        if (is_impossible(&missions[i])) {
            (void)printf("%-32s %11s %9s %9s  cannot drive this route\n", mission_name(missions[i].strategy), "-", "-",
                         "-");
        } else {
            (void)printf("%-32s %11.2f %9.2f %9.2f\n", mission_name(missions[i].strategy),
                         missions[i].total.measured_energy, missions[i].total.duration,
                         relative_percent(&missions[i], basis_of(missions, count)));
        }
    }
}

/* The summary. */

static json_t *json_point(struct bezier_point point)
{
    return json_pack("[f, f]", point.x, point.y);
}

static json_t *json_planned(const struct mission_leg *leg, double value)
{
    return leg->planned ? json_real(value) : json_null();
}

static json_t *json_leg(const struct mission_leg *leg, size_t index)
{
    return json_pack("{s:I, s:o, s:o, s:f, s:f, s:f, s:o, s:f, s:o, s:o, s:o, s:o, s:o, s:f, s:f}", "index",
                     (json_int_t)index + 1, "target_m", json_point(leg->target), "planned_energy_j",
                     json_planned(leg, leg->planned_energy), "measured_energy_j", leg->measured_energy,
                     "plant_energy_j", leg->plant_energy, "battery_energy_j", leg->battery_energy, "error_percent",
                     json_planned(leg, error_percent(leg)), "duration_s", leg->duration, "speed_m_s",
                     json_planned(leg, leg->speed), "turn_rate_rad_s", json_planned(leg, leg->turn_rate), "turn_deg",
                     json_planned(leg, leg->turn * DEGREES), "arc_rad", json_planned(leg, leg->arc), "end_m",
                     json_point(leg->end), "end_error_m", leg->end_error, "passed_m", leg->passed);
}

static json_t *json_forecast(const struct mission_forecast *forecast)
{
    return forecast->known ? json_pack("{s:f, s:f}", "energy_j", forecast->energy, "deviation_j", forecast->deviation)
                           : json_null();
}

/* NULL: the mission ends with its last segment. */
static json_t *json_braking(const struct mission_leg *braking)
{
    return braking->duration > 0
               ? json_pack("{s:f, s:f, s:f, s:f, s:o, s:f}", "measured_energy_j", braking->measured_energy,
                           "plant_energy_j", braking->plant_energy, "battery_energy_j", braking->battery_energy,
                           "duration_s", braking->duration, "end_m", json_point(braking->end), "end_error_m",
                           braking->end_error)
               : NULL;
}

/* What there is of a strategy that cannot drive the route. */
static json_t *json_impossible(const struct mission *mission)
{
    return json_pack("{s:s, s:s, s:s, s:s}", "name", strategies[mission->strategy].name, "title",
                     strategies[mission->strategy].title, "log", strategies[mission->strategy].log, "impossible",
                     mission->impossible);
}

static json_t *json_mission(const struct mission *mission, const struct mission *basis)
{
    if (is_impossible(mission)) {
        return json_impossible(mission);
    }

    json_t *segments = json_array();
    const struct mission_leg *total = &mission->total;

    for (size_t i = 0; i < mission->leg_count; i++) {
        (void)json_array_append_new(segments, json_leg(&mission->legs[i], i));
    }
    return json_pack("{s:s, s:s, s:s, s:o, s:o, s:o*, s:{s:o, s:f, s:f, s:f, s:f, s:f, s:f}, s:I}", "name",
                     strategies[mission->strategy].name, "title", strategies[mission->strategy].title, "log",
                     strategies[mission->strategy].log, "forecast", json_forecast(&mission->forecast), "segments",
                     segments, "braking", json_braking(&mission->braking), "total", "planned_energy_j",
                     json_planned(total, total->planned_energy), "measured_energy_j", total->measured_energy,
                     "plant_energy_j", total->plant_energy, "battery_energy_j", total->battery_energy, "duration_s",
                     total->duration, "end_speed_m_s", total->end_speed, "relative_percent",
                     relative_percent(mission, basis), "saturated_ticks", (json_int_t)mission->saturated_ticks);
}

json_t *mission_json(const struct scenario *scenario, const struct mission *missions, size_t count)
{
    json_t *waypoints = json_array();
    json_t *driven = json_array();
    const struct mission *basis = basis_of(missions, count);
    const struct scenario_robot robot = scenario_robot(scenario);
    double simulated = (double)basis->ticks / robot.rate_hz;

    for (size_t i = 0; i < scenario->waypoint_count; i++) {
        (void)json_array_append_new(waypoints, json_point(scenario->waypoints[i]));
    }
    for (size_t i = 0; i < count; i++) {
        (void)json_array_append_new(driven, json_mission(&missions[i], basis));
    }
    return json_pack("{s:s, s:s, s:s, s:s, s:I, s:o, s:o, s:{s:I, s:f, s:f}}", "robot", robot.name, "scenario",
                     scenario->name, "energy_model", scenario->model == SCENARIO_PUBLISHED ? "published" : "identified",
                     "energy", energy_kind_name(scenario->energy), "seed", (json_int_t)scenario->seed, "waypoints_m",
                     waypoints, "strategies", driven, "simulation", "ticks", (json_int_t)basis->ticks, "wall_s",
                     basis->wall_seconds, "real_time_factor", simulated / basis->wall_seconds);
}
