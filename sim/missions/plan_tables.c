#include "sim/missions/plan_tables.h"

#include <math.h>

#include "sim/base/strict_math.h"

#define KIB 1024.0

static const struct {
    const char *name;
    const char *title;
} aims[PLAN_AIMS] = {
    [PLAN_ENERGY] = {"energy", "energy-optimal"},
    [PLAN_DISTANCE] = {"distance", "distance-optimal"},
};

const char *const plan_route_files[PLAN_AIMS] = {
    [PLAN_ENERGY] = "energy_route.csv",
    [PLAN_DISTANCE] = "distance_route.csv",
};

static const char *const answers[] = {
    [JP_ANSWER_OUT_OF_BUDGET] = "none", [JP_ANSWER_OPTIMAL] = "optimal",         [JP_ANSWER_WITHIN_BOUND] = "within",
    [JP_ANSWER_PARTIAL] = "partial",    [JP_ANSWER_UNREACHABLE] = "unreachable", [JP_ANSWER_STALE] = "stale",
};

static const char *const costs[] = {
    [JP_COST_PHYSICAL] = "physical",
    [JP_COST_PAPER] = "paper",
    [JP_COST_DISTANCE] = "distance",
};

/** What a table says of a route. */
struct sums {
    double length;
    double energy;
    double time;
    double climb;
    double turning;
};

static struct sums sums_of(const struct plan_route *route)
{
    const struct plan_step *end = plan_route_end(route);

    return (struct sums){end->length, end->energy, end->time, route->climb, route->turning_energy};
}

static struct sums sums_of_aim(const struct plan_report *report, enum plan_aim aim)
{
    return sums_of(&report->searches[aim].route);
}

/* NAN when there is nothing to compare with. */
static double percent_above(double value, double base)
{
    return base > 0 ? 100 * (value / base - 1) : NAN;
}

static bool both_arrive(const struct plan_report *report)
{
    return plan_search_arrives(&report->searches[PLAN_ENERGY]) && plan_search_arrives(&report->searches[PLAN_DISTANCE]);
}

static struct plan_place place_of(const struct plan_report *report, const struct jp_lattice_pose *pose)
{
    const struct clearance_pose grid = plan_grid_pose(report->map, report->lattice, pose);

    return plan_map_place(report->map, &grid);
}

static struct plan_place goal_of(const struct plan_report *report)
{
    return place_of(report, &(struct jp_lattice_pose){report->task.goal.x, report->task.goal.y, 0});
}

/* From the end of a route to the goal, m. */
static double distance_left(const struct plan_report *report, const struct plan_search *search)
{
    const struct plan_place end = place_of(report, &plan_route_end(&search->route)->pose);
    const struct plan_place goal = goal_of(report);

    return strict_hypot(goal.x - end.x, goal.y - end.y);
}

/* ---- Table ---- */

static void print_percent(int width, double value)
{
    if (isnan(value)) {
        (void)printf(" %*s", width, "-");
    } else {
        (void)printf(" %+*.2f", width, value);
    }
}

static void print_search(const struct plan_report *report, enum plan_aim aim)
{
    const struct plan_search *search = &report->searches[aim];
    const struct sums sums = sums_of_aim(report, aim);

    (void)printf("%-18s %9.2f %10.1f %9.1f %8.2f %10.1f  %-12s", aims[aim].title, sums.length, sums.energy, sums.time,
                 sums.climb, sums.turning, answers[search->answer]);
    if (plan_search_arrives(search)) {
        (void)printf(" %6.3f", (double)search->plan.bound / JP_EPSILON_ONE);
    } else {
        (void)printf(" %6s", "-");
    }
    (void)printf(" %10u %8u %9.1f\n", search->statistics.expansions, search->statistics.states,
                 1000 * search->planning_s);
}

static void print_difference(const struct plan_report *report)
{
    const struct sums energy = sums_of_aim(report, PLAN_ENERGY);
    const struct sums distance = sums_of_aim(report, PLAN_DISTANCE);

    (void)printf("%-18s", "difference %");
    print_percent(9, percent_above(energy.length, distance.length));
    print_percent(10, percent_above(energy.energy, distance.energy));
    print_percent(9, percent_above(energy.time, distance.time));
    print_percent(8, percent_above(energy.climb, distance.climb));
    print_percent(10, percent_above(energy.turning, distance.turning));
    (void)printf("\n");
}

static void print_what_is_left(const struct plan_report *report)
{
    for (enum plan_aim aim = 0; aim < PLAN_AIMS; aim++) {
        const struct plan_search *search = &report->searches[aim];
        if (search->answer == JP_ANSWER_UNREACHABLE) {
            (void)printf("%s: unreachable: there is no route, which is proved\n", aims[aim].title);
        } else if (!plan_search_arrives(search)) {
            (void)printf("%s: the route ends %.1f m before the goal, as the crow flies: more --memory may find the "
                         "rest\n",
                         aims[aim].title, distance_left(report, search));
        }
    }
}

static void print_task(const struct plan_report *report)
{
    const struct jp_terrain_config *config = &report->map->terrain.config;
    const struct plan_place start = place_of(report, &report->task.start);
    const struct plan_place goal = goal_of(report);

    (void)printf("%s: %u × %u cells of %.3f m%s%s; robot %s, %s cost\n", report->map->name, config->width,
                 config->height, (double)config->resolution / JP_Q16_ONE, config->has_elevation ? "" : ", level ground",
                 config->has_costs ? ", whose costs count in the choice of routes" : "", report->lattice->name,
                 costs[report->searches[PLAN_ENERGY].cost]);
    (void)printf("start %.1f, %.1f m, %.0f°; goal %.1f, %.1f m (%s)\n", start.x, start.y, start.heading_deg, goal.x,
                 goal.y,
                 report->task.is_chosen ? "chosen: far apart in the largest free part; --start and --goal set others"
                                        : "as given");
}

static void print_parameters(const struct plan_report *report)
{
    if (report->parameters_path == NULL) {
        (void)printf("parameters: built in, version %u\n", report->lattice->version);
    } else {
        (void)printf("parameters: learned, version %u, %s\n", report->lattice->version, report->parameters_path);
    }
}

static void print_lattice(const struct plan_report *report)
{
    if (report->lattice_path != NULL) {
        (void)printf("lattice: %u primitives, %s\n", report->lattice->first_from[JP_HEADINGS], report->lattice_path);
    }
}

static void print_memory(const struct plan_report *report)
{
    const struct jp_planner_counts *statistics = &report->searches[PLAN_ENERGY].statistics;

    (void)printf(
        "memory: planner's block %.0f KiB (guide %.0f, energy field %.0f, search %.0f for %u states), map %.0f "
        "KiB\n",
        (double)report->memory / KIB, statistics->guide_bytes / KIB, statistics->field_bytes / KIB,
        statistics->search_bytes / KIB, statistics->states_max,
        (double)jp_terrain_size(&report->map->terrain.config) / KIB);
}

/* The lattice's energy, on the ground that the drive had. */
static double planned_energy(const struct plan_report *report)
{
    const struct plan_route *route = &report->searches[PLAN_ENERGY].route;

    return report->drive->is_level ? route->level_energy : plan_route_end(route)->energy;
}

/* The simulated ground is level, that of the map is not. */
static bool leaves_climbs_out(const struct plan_report *report)
{
    return report->drive->is_level && report->map->terrain.config.has_elevation;
}

static void print_sums(const char *label, double length, double energy, double time)
{
    (void)printf("%-34s %9.2f %10.1f %9.1f\n", label, length, energy, time);
}

static void print_drive(const struct plan_report *report)
{
    const struct plan_driven *drive = report->drive;
    const struct plan_step *end = plan_route_end(&report->searches[PLAN_ENERGY].route);

    (void)printf("\n%-34s %9s %10s %9s\n", "energy-optimal route, driven", "length m", "energy J", "time s");
    print_sums(drive->is_level ? "planned: lattice, level ground" : "planned: lattice", end->length,
               planned_energy(report), end->time);
    print_sums("predicted: energy model", drive->predicted.length, drive->predicted.energy, drive->predicted.time);
    print_sums("driven: simulator, closed loop", drive->driven.length, drive->driven.energy, drive->driven.time);
    (void)printf("%zu segments, margin %.2f m; the driven path %s; %.3f m from the goal at the end\n",
                 drive->place_count - 1, drive->margin_m,
                 drive->is_clear ? "touched no obstacle" : "TOUCHED AN OBSTACLE", drive->end_error);
    if (leaves_climbs_out(report)) {
        (void)printf("the simulator's ground is level: these energies leave the map's climbs out\n");
    }
}

void plan_print(const struct plan_report *report)
{
    print_task(report);
    print_lattice(report);
    print_parameters(report);
    (void)printf("\n%-18s %9s %10s %9s %8s %10s  %-12s %6s %10s %8s %9s\n", "route", "length m", "energy J", "time s",
                 "climb m", "turning J", "answer", "bound", "expansions", "states", "planned ms");
    for (enum plan_aim aim = 0; aim < PLAN_AIMS; aim++) {
        print_search(report, aim);
    }
    if (both_arrive(report)) {
        print_difference(report);
    }
    print_what_is_left(report);
    print_memory(report);
    if (report->drive != NULL) {
        print_drive(report);
    }
}

/* ---- Summary ---- */

static json_t *json_number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

/* Of the parameters that a route was found with; null without a route. */
static json_t *json_version(const struct plan_search *search)
{
    return search->plan.answer == JP_ANSWER_OUT_OF_BUDGET ? json_null() : json_integer(search->plan.parameter_version);
}

static json_t *json_search(const struct plan_report *report, enum plan_aim aim)
{
    const struct plan_search *search = &report->searches[aim];
    const struct sums sums = sums_of_aim(report, aim);
    const bool arrives = plan_search_arrives(search);

    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:o, s:f, s:I, s:I, s:I, s:f, s:f, s:o}",
                     "name", aims[aim].name, "title", aims[aim].title, "file", plan_route_files[aim], "cost",
                     costs[search->cost], "answer", answers[search->answer], "length_m", sums.length, "energy_j",
                     sums.energy, "time_s", sums.time, "climb_m", sums.climb, "turning_energy_j", sums.turning, "bound",
                     json_number_or_null(arrives ? (double)search->plan.bound / JP_EPSILON_ONE : NAN),
                     "distance_left_m", arrives ? 0 : distance_left(report, search), "steps",
                     (json_int_t)search->route.count - 1, "expansions", (json_int_t)search->statistics.expansions,
                     "states", (json_int_t)search->statistics.states, "planning_s", search->planning_s, "whole_s",
                     search->whole_s, "parameter_version", json_version(search));
}

static json_t *json_comparison(const struct plan_report *report)
{
    const struct sums energy = sums_of_aim(report, PLAN_ENERGY);
    const struct sums distance = sums_of_aim(report, PLAN_DISTANCE);

    if (!both_arrive(report)) {
        return json_null();
    }
    return json_pack("{s:o, s:o, s:o}", "energy_percent",
                     json_number_or_null(percent_above(energy.energy, distance.energy)), "length_percent",
                     json_number_or_null(percent_above(energy.length, distance.length)), "time_percent",
                     json_number_or_null(percent_above(energy.time, distance.time)));
}

static json_t *json_map(const struct plan_report *report)
{
    const struct map_file *map = report->map;
    const struct jp_terrain_config *config = &map->terrain.config;

    return json_pack("{s:s, s:s, s:s, s:i, s:i, s:f, s:b, s:b}", "file", report->map_path, "name", map->name, "note",
                     map->note, "width", config->width, "height", config->height, "resolution_m",
                     (double)config->resolution / JP_Q16_ONE, "has_elevation", config->has_elevation, "has_costs",
                     config->has_costs);
}

static json_t *json_parameters(const struct plan_report *report)
{
    return json_pack("{s:I, s:s?}", "version", (json_int_t)report->lattice->version, "file", report->parameters_path);
}

static json_t *json_memory(const struct plan_report *report)
{
    const struct jp_planner_counts *statistics = &report->searches[PLAN_ENERGY].statistics;

    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I}", "block_bytes", (json_int_t)report->memory, "guide_bytes",
                     (json_int_t)statistics->guide_bytes, "field_bytes", (json_int_t)statistics->field_bytes,
                     "search_bytes", (json_int_t)statistics->search_bytes, "states_max",
                     (json_int_t)statistics->states_max, "map_bytes",
                     (json_int_t)jp_terrain_size(&report->map->terrain.config));
}

static json_t *json_waypoints(const struct plan_report *report)
{
    json_t *waypoints = json_array();

    for (size_t i = 0; i < report->drive->place_count; i++) {
        const struct plan_place place = plan_map_place(report->map, &report->drive->places[i]);
        (void)json_array_append_new(waypoints, json_pack("[f, f]", place.x, place.y));
    }
    return waypoints;
}

static json_t *json_sums(const struct plan_sums *sums)
{
    return json_pack("{s:f, s:f, s:f}", "length_m", sums->length, "energy_j", sums->energy, "time_s", sums->time);
}

static json_t *json_drive(const struct plan_report *report)
{
    const struct plan_driven *drive = report->drive;

    if (drive == NULL) {
        return json_null();
    }
    const struct plan_step *end = plan_route_end(&report->searches[PLAN_ENERGY].route);
    const struct plan_sums planned = {planned_energy(report), end->length, end->time};
    return json_pack("{s:s?, s:s, s:o, s:f, s:b, s:f, s:b, s:o, s:o, s:o, s:f}", "scenario",
                     drive->is_level ? PLAN_SCENARIO_FILE : NULL, "log", PLAN_LOG_FILE, "waypoints_m",
                     json_waypoints(report), "margin_m", drive->margin_m, "clear", drive->is_clear, "end_error_m",
                     drive->end_error, "level_ground_assumed", leaves_climbs_out(report), "planned",
                     json_sums(&planned), "predicted", json_sums(&drive->predicted), "driven",
                     json_sums(&drive->driven), "battery_energy_j", drive->battery_energy);
}

json_t *plan_json(const struct plan_report *report)
{
    const struct plan_place start = place_of(report, &report->task.start);
    const struct plan_place goal = goal_of(report);

    return json_pack("{s:s, s:s?, s:o, s:o, s:o, s:b, s:[f, f, f], s:[f, f], s:[o, o], s:o, s:o}", "robot",
                     report->lattice->name, "lattice_file", report->lattice_path, "map", json_map(report), "parameters",
                     json_parameters(report), "memory", json_memory(report), "task_chosen", report->task.is_chosen,
                     "start", start.x, start.y, start.heading_deg, "goal_m", goal.x, goal.y, "routes",
                     json_search(report, PLAN_ENERGY), json_search(report, PLAN_DISTANCE), "comparison",
                     json_comparison(report), "drive", json_drive(report));
}
