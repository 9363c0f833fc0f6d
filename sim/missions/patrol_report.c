#include "sim/missions/patrol_report.h"

#include <math.h>
#include <stdlib.h>

#define DEGREES (180 / M_PI)

static const struct {
    const char *title;
    const char *log;
} methods[PATROL_METHODS] = {
    [PATROL_IMPROVED] = {"improved TEB", "log_improved.csv"},
    [PATROL_PLAIN] = {"plain TEB", "log_plain.csv"},
    [PATROL_PURSUIT] = {"pure pursuit", "log_pursuit.csv"},
};

const char *patrol_report_log(enum patrol_method method)
{
    return methods[method].log;
}

static double cell_m(const struct patrol_scene *scene)
{
    return (double)scene->ground.config.resolution / JP_Q16_ONE;
}

static bool has_reason(const struct patrol_result *result)
{
    return result->outcome == PATROL_GAVE_UP;
}

static size_t turning_points(const struct patrol_run *run)
{
    const json_t *way = json_object_get(json_array_get(run->record.plans, 0), "way_m");

    return json_array_size(way);
}

/* ---- Table ---- */

static void print_scene(const struct patrol_report *report)
{
    const struct jp_terrain_config *config = &report->scene->ground.config;
    const struct jp_plane_pose *start = &report->scene->start;
    const struct jp_plane_pose *goal = &report->scene->goal;

    (void)printf("%s, seed %llu: %.1f × %.1f m in cells of %.3f m; robot %s\n", report->scene->name,
                 (unsigned long long)report->seed, config->width * cell_m(report->scene),
                 config->height * cell_m(report->scene), cell_m(report->scene), report->robot->name);
    (void)printf("start %.2f, %.2f m, %.0f°; goal %.2f, %.2f m, %.0f°, from the map's south-west corner; within %.0f "
                 "s\n",
                 (double)start->x, (double)start->y, (double)start->heading * DEGREES, (double)goal->x, (double)goal->y,
                 (double)goal->heading * DEGREES, report->scene->limit_s);
}

static void print_faults(const struct patrol_faults *faults)
{
    if (faults->beam_dropout > 0) {
        (void)printf("fault: %.0f %% of the beams drop out\n", 100 * faults->beam_dropout);
    }
    if (faults->scan_dropout_until > faults->scan_dropout_from) {
        (void)printf("fault: no scans from %.1f s to %.1f s\n", faults->scan_dropout_from, faults->scan_dropout_until);
    }
    if (faults->jump_at >= 0) {
        (void)printf("fault: the laser's pose jumps by %.2f m at %.1f s\n", faults->jump_m, faults->jump_at);
    }
    if (faults->slip) {
        (void)printf("fault: slippery ground\n");
    }
}

static void print_run(const struct patrol_run *run)
{
    const struct patrol_result *result = &run->result;
    char outcome[64];

    (void)snprintf(outcome, sizeof outcome, "%s%s%s", patrol_outcome_names[result->outcome],
                   has_reason(result) ? ": " : "", has_reason(result) ? patrol_reason_names[result->reason] : "");
    (void)printf("%-13s %-28s %7.1f %9.2f %9.1f %11.2f %8u %12.3f %9.3f %9.1f %11.3f %6u %6u %8u\n",
                 methods[run->method].title, outcome, result->time, result->length, result->energy_j, result->reversed,
                 result->direction_changes, result->clearance_min, result->position_error,
                 result->heading_error * DEGREES, result->odometry_error, (unsigned)result->counts.turns,
                 (unsigned)result->counts.waits, result->replans);
}

/* What the robot noticed of faults and of a crowd. */
static void print_counts(const struct patrol_run *run)
{
    const struct jp_patrol_counts *counts = &run->result.counts;

    if (counts->scans_missing + counts->laser_missing + counts->laser_rejected + counts->shapes_dropped > 0) {
        (void)printf("%s: %u scans missing; poses of the laser: %u missing, %u rejected; %u obstacles did not fit\n",
                     methods[run->method].title, (unsigned)counts->scans_missing, (unsigned)counts->laser_missing,
                     (unsigned)counts->laser_rejected, (unsigned)counts->shapes_dropped);
    }
}

/* What it said that the way would take, and what its meter says. */
static void print_energy(const struct patrol_run *run)
{
    const struct patrol_leg *leg = &run->result.leg;

    if (leg->driven > 0) {
        (void)printf("%s: planned %.1f J, forecast %.1f ± %.1f J, metered %.1f J\n", methods[run->method].title,
                     leg->planned, leg->forecast, leg->deviation, leg->driven);
    }
}

static void print_path(const struct patrol_run *run)
{
    const struct jp_grid_counts *planner = &run->result.planner;

    (void)printf("path: %zu turning points, %.2f m smoothed; any-angle A*: %u expansions, %u edge nodes, %.1f KiB\n",
                 turning_points(run), run->result.path_length, (unsigned)planner->expansions,
                 (unsigned)planner->edge_nodes, planner->bytes / 1024.0);
    if (run->result.path_price > 0) {
        (void)printf("path: priced at %.1f J, with its time and clearance\n", run->result.path_price);
    }
}

void patrol_report_print(const struct patrol_report *report)
{
    print_scene(report);
    print_faults(&report->faults);
    (void)printf("\n%-13s %-28s %7s %9s %9s %11s %8s %12s %9s %9s %11s %6s %6s %8s\n", "method", "outcome", "time s",
                 "driven m", "energy J", "reversed m", "changes", "clearance m", "off m", "off °", "odometry m",
                 "turns", "waits", "replans");
    for (size_t i = 0; i < report->run_count; i++) {
        print_run(&report->runs[i]);
    }
    for (size_t i = 0; i < report->run_count; i++) {
        print_counts(&report->runs[i]);
    }
    for (size_t i = 0; i < report->run_count; i++) {
        print_energy(&report->runs[i]);
    }
    print_path(&report->runs[0]);
}

/* ---- Summary ---- */

static json_t *json_names(const char *const *names, size_t count)
{
    json_t *array = json_array();

    for (size_t i = 0; i < count; i++) {
        (void)json_array_append_new(array, json_string(names[i]));
    }
    return array;
}

/* '.' free, '#' solid on map and ground, '?' unknown, 'o' there but not on the map. */
static char symbol(const struct patrol_scene *scene, int x, int y)
{
    const enum jp_cell there = jp_terrain_cell(&scene->ground, x, y);

    if (there != jp_terrain_cell(&scene->map, x, y)) {
        return 'o';
    }
    return there == JP_CELL_FREE ? '.' : there == JP_CELL_OCCUPIED ? '#' : '?';
}

/* The northern row first, as in maps. */
static json_t *json_rows(const struct patrol_scene *scene)
{
    const int width = scene->ground.config.width;
    json_t *rows = json_array();
    char row[JP_TERRAIN_SIDE_MAX];

    for (int y = scene->ground.config.height - 1; y >= 0; y--) {
        for (int x = 0; x < width; x++) {
            row[x] = symbol(scene, x, y);
        }
        (void)json_array_append_new(rows, json_stringn(row, (size_t)width));
    }
    return rows;
}

json_t *patrol_report_map(const struct patrol_scene *scene, const char *map_path)
{
    const struct jp_terrain_config *config = &scene->ground.config;

    return json_pack("{s:s?, s:i, s:i, s:f, s:o}", "file", map_path, "width", config->width, "height", config->height,
                     "resolution_m", cell_m(scene), "rows", json_rows(scene));
}

static json_t *json_pose(const struct jp_plane_pose *pose)
{
    return json_pack("[f, f, f]", (double)pose->x, (double)pose->y, (double)pose->heading * DEGREES);
}

static json_t *json_faults(const struct patrol_faults *faults)
{
    return json_pack("{s:f, s:[f, f], s:[f, f], s:b}", "beam_dropout", faults->beam_dropout, "scan_dropout_s",
                     faults->scan_dropout_from, faults->scan_dropout_until, "jump_s_m", faults->jump_at, faults->jump_m,
                     "slip", faults->slip);
}

static json_t *json_planner(const struct patrol_run *run)
{
    const struct jp_grid_counts *planner = &run->result.planner;

    return json_pack("{s:I, s:I, s:I, s:I, s:f, s:f}", "turning_points", (json_int_t)turning_points(run), "expansions",
                     (json_int_t)planner->expansions, "edge_nodes", (json_int_t)planner->edge_nodes, "bytes",
                     (json_int_t)planner->bytes, "path_length_m", run->result.path_length, "path_price_j",
                     run->result.path_price);
}

static json_t *json_counts(const struct patrol_result *result)
{
    const struct jp_patrol_counts *counts = &result->counts;

    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "cycles", (json_int_t)counts->cycles, "turns",
                     (json_int_t)counts->turns, "waits", (json_int_t)counts->waits, "infeasible_bands",
                     (json_int_t)counts->infeasible, "laser_missing", (json_int_t)counts->laser_missing,
                     "laser_rejected", (json_int_t)counts->laser_rejected, "scans_missing",
                     (json_int_t)counts->scans_missing, "shapes_dropped", (json_int_t)counts->shapes_dropped, "replans",
                     (json_int_t)result->replans);
}

static json_t *json_energy(const struct patrol_leg *leg)
{
    return json_pack("{s:f, s:f, s:f, s:f}", "planned_j", leg->planned, "forecast_j", leg->forecast, "deviation_j",
                     leg->deviation, "metered_j", leg->driven);
}

static json_t *json_run(const struct patrol_run *run)
{
    const struct patrol_result *result = &run->result;

    return json_pack("{s:o, s:s, s:s, s:s, s:s, s:s, s:f, s:f, s:f, s:f, s:I, s:f, s:f, s:f, s:f, s:o, s:o, s:O, s:O}",
                     "energy", json_energy(&result->leg), "name", patrol_method_names[run->method], "title",
                     methods[run->method].title, "log", methods[run->method].log, "outcome",
                     patrol_outcome_names[result->outcome], "reason",
                     has_reason(result) ? patrol_reason_names[result->reason] : "", "time_s", result->time, "length_m",
                     result->length, "energy_j", result->energy_j, "reversed_m", result->reversed, "direction_changes",
                     (json_int_t)result->direction_changes, "clearance_min_m", result->clearance_min,
                     "position_error_m", result->position_error, "heading_error_deg", result->heading_error * DEGREES,
                     "odometry_error_m", result->odometry_error, "planner", json_planner(run), "counts",
                     json_counts(result), "plans", run->record.plans, "snapshots", run->record.snapshots);
}

json_t *patrol_report_json(const struct patrol_report *report)
{
    const struct patrol_scene *scene = report->scene;
    json_t *runs = json_array();

    for (size_t i = 0; i < report->run_count; i++) {
        (void)json_array_append_new(runs, json_run(&report->runs[i]));
    }
    return json_pack("{s:s, s:s, s:[f, f], s:I, s:o, s:o, s:o, s:f, s:o, s:o, s:o, s:o}", "robot", report->robot->name,
                     "scene", scene->name, "robot_size_m", report->robot->body.length_m, report->robot->body.width_m,
                     "seed", (json_int_t)report->seed, "map", patrol_report_map(scene, report->map_path), "start",
                     json_pose(&scene->start), "goal", json_pose(&scene->goal), "limit_s", scene->limit_s, "faults",
                     json_faults(&report->faults), "states", json_names(patrol_state_names, JP_PATROL_STOPPED + 1),
                     "reasons", json_names(patrol_reason_names, JP_PATROL_INFEASIBLE + 1), "methods", runs);
}
