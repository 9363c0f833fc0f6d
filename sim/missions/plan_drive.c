#include "sim/missions/plan_drive.h"

#include <math.h>
#include <stdlib.h>

#include "sim/balancer/energy_unit.h"
#include "sim/base/error.h"
#include "sim/base/strict_math.h"

#define Q16_ONE 65536.0

/** Of the waypoints in a scenario, m. */
#define DECIMALS 10000.0

#define SEED 1

/** Steps of the margin that the driven path rarely leaves: 10 cm. */
#define MARGIN_MIN_STEPS 2

/** Places farther apart on a route are not joined by one segment. */
#define REACH 96

/** Pairs of places at a time. */
#define SLICE 1000

/* ---- Waypoints ---- */

static double margin_of(const struct jp_waypoint *waypoint)
{
    return JP_WAYPOINTS_MARGIN_M * waypoint->margin / JP_WAYPOINTS_MARGIN_STEPS;
}

static double least_margin(const struct plan_drive *drive)
{
    double least = JP_WAYPOINTS_MARGIN_M;

    for (size_t i = 1; i < drive->waypoint_count; i++) {
        least = fmin(least, margin_of(&drive->waypoints[i]));
    }
    return least;
}

/* A cell to the left or right of where the route leads, if not on it. */
static struct clearance_pose place_of(const struct map_file *map, const struct jp_lattice *lattice,
                                      const struct plan_route *route, const struct jp_waypoint *waypoint)
{
    struct clearance_pose place = plan_grid_pose(map, lattice, &route->way[waypoint->pose]);

    if (waypoint->side != 0) {
        const struct clearance_pose before = plan_grid_pose(map, lattice, &route->way[waypoint->pose - 1]);
        const struct clearance_pose after = plan_grid_pose(map, lattice, &route->way[waypoint->pose + 1]);
        const double ahead = strict_atan2(after.y - before.y, after.x - before.x);
        const double aside = waypoint->side * (double)map->terrain.config.resolution / JP_Q16_ONE;

        place.x -= aside * strict_sin(ahead);
        place.y += aside * strict_cos(ahead);
    }
    return place;
}

static bool read_waypoints(const struct map_file *map, const struct jp_lattice *lattice, const struct plan_route *route,
                           const struct jp_waypoints *choice, struct plan_drive *drive)
{
    const size_t count = jp_waypoints_count(choice);

    if (count == 0) {
        error_line("the route cannot be driven in arcs within the robot's limits; give other places or a finer map");
        return false;
    }
    if (jp_waypoints_read(choice, drive->waypoints, BEZIER_WAYPOINTS_MAX) != JP_OK) {
        error_line("the route takes %zu waypoints, a scenario holds %d; give a nearer --goal", count,
                   BEZIER_WAYPOINTS_MAX);
        return false;
    }
    drive->waypoint_count = count;
    drive->margin_m = least_margin(drive);
    for (size_t i = 0; i < count; i++) {
        drive->places[i] = place_of(map, lattice, route, &drive->waypoints[i]);
    }
    return true;
}

static bool begin(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                  struct jp_waypoints *choice, void *block, size_t size)
{
    const struct robot_entry *entry = rig_find_robot(robot->name);
    const char *field;

    if (entry == NULL) {
        error_line("%s: no tables of this robot are built in; run make gains ROBOT=%s", robot->name, robot->name);
        return false;
    }
    const struct jp_waypoints_config config = {.terrain = &map->terrain,
                                               .lattice = lattice,
                                               .model = entry->energy,
                                               .limits = &entry->config->limits,
                                               .length = (jp_q24)lround(robot->length_m * JP_Q24_ONE),
                                               .width = (jp_q24)lround(robot->width_m * JP_Q24_ONE),
                                               .reach = REACH,
                                               .margin_min = MARGIN_MIN_STEPS};
    if (jp_waypoints_init(choice, &config, block, size, &field) != JP_OK) {
        error_line("%s: %s is out of the range in which waypoints can be chosen", robot->name, field);
        return false;
    }
    return true;
}

static bool choose(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                   const struct plan_route *route, struct plan_drive *drive)
{
    const size_t size = jp_waypoints_size(route->way_count);
    void *block = malloc(size);
    struct jp_waypoints choice;
    bool done = false;

    drive->model = robot->balancer.model;
    if (size == 0 || block == NULL) {
        error_line("%s: no memory for the route", map->name);
    } else if (begin(map, lattice, robot, &choice, block, size)) {
        (void)jp_waypoints_start(&choice, route->way, route->way_count);
        while (jp_waypoints_work(&choice, SLICE) == JP_WAYPOINTS_CHOOSING) {
        }
        done = read_waypoints(map, lattice, route, &choice, drive);
    }
    free(block);
    return done;
}

/* ---- Scenario ---- */

static double rounded(double value)
{
    return round(value * DECIMALS) / DECIMALS + 0.0; /* no negative zero */
}

/* As odometry sees it: from the start, x ahead. */
static struct bezier_point seen_from(const struct clearance_pose *start, const struct clearance_pose *pose)
{
    const double dx = pose->x - start->x;
    const double dy = pose->y - start->y;

    return (struct bezier_point){rounded(dx * strict_cos(start->heading) + dy * strict_sin(start->heading)),
                                 rounded(dy * strict_cos(start->heading) - dx * strict_sin(start->heading))};
}

static void describe(const struct map_file *map, const struct lattice_robot *robot, struct plan_drive *drive)
{
    struct scenario *scenario = &drive->scenario;

    *scenario = (struct scenario){.robot = robot->balancer.file,
                                  .model = SCENARIO_IDENTIFIED,
                                  .seed = SEED,
                                  .waypoint_count = drive->waypoint_count};
    (void)snprintf(scenario->name, sizeof scenario->name, "%s", map->name);
    for (size_t i = 0; i < drive->waypoint_count; i++) {
        scenario->waypoints[i] = seen_from(&drive->places[0], &drive->places[i]);
    }
}

bool plan_drive_prepare(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                        const struct plan_route *route, struct plan_drive *drive)
{
    *drive = (struct plan_drive){0};
    if (route->way_count < 2) {
        error_line("--goal: is where the robot is already: nothing to drive; give a place farther off");
        return false;
    }
    if (!choose(map, lattice, robot, route, drive)) {
        return false;
    }
    describe(map, robot, drive);
    return true;
}

void plan_drive_write(const struct plan_drive *drive, const char *robot_path, FILE *stream)
{
    const struct scenario *scenario = &drive->scenario;

    (void)fprintf(stream,
                  "# Written by jp-plan: the route over a map, as the robot's odometry sees it.\n\n"
                  "name = \"%s\";\nrobot = \"%s\";\nenergy_model = \"identified\";\nseed = %d;\n\n"
                  "# m; the first is the start, where the robot stands at rest and looks along x\nwaypoints = (",
                  scenario->name, robot_path, SEED);
    for (size_t i = 0; i < scenario->waypoint_count; i++) {
        (void)fprintf(stream, "%s\n    [%.4f, %.4f]", i > 0 ? "," : "", scenario->waypoints[i].x,
                      scenario->waypoints[i].y);
    }
    (void)fprintf(stream, " );\n");
}

static struct plan_sums predicted_sums(const struct plan_drive *drive)
{
    struct plan_sums sums = {0};

    for (size_t i = 1; i < drive->waypoint_count; i++) {
        const struct jp_segment *segment = &drive->waypoints[i].segment;
        sums.energy += energy_unit_joules(drive->model, segment->energy);
        sums.length += segment->length / Q16_ONE;
        sums.time += segment->command.duration / Q16_ONE;
    }
    return sums;
}

/* ---- The drive ---- */

struct follower {
    const struct jp_terrain *terrain;
    struct clearance_robot footprint;
    struct clearance_pose start;
    struct bezier_point before;
    double length;
    bool is_clear;
};

static void watch(void *context, struct bezier_point position, double heading)
{
    struct follower *follower = context;
    const struct clearance_pose *start = &follower->start;
    const struct clearance_pose pose = {
        start->x + position.x * strict_cos(start->heading) - position.y * strict_sin(start->heading),
        start->y + position.x * strict_sin(start->heading) + position.y * strict_cos(start->heading),
        start->heading + heading};

    follower->length += strict_hypot(position.x - follower->before.x, position.y - follower->before.y);
    follower->before = position;
    follower->is_clear = follower->is_clear && clearance_at(follower->terrain, &follower->footprint, &pose);
}

bool plan_drive_run(const struct map_file *map, const struct lattice_robot *robot, struct plan_drive *drive, FILE *log)
{
    struct follower follower = {.terrain = &map->terrain,
                                .footprint = {robot->length_m, robot->width_m, 0},
                                .start = drive->places[0],
                                .is_clear = true};
    const struct mission_view view = {.log = log, .watch = watch, .context = &follower};

    if (!mission_run(&drive->mission, MISSION_OPTIMAL, &drive->scenario, NULL, &view)) {
        mission_complain(&drive->mission, &drive->scenario);
        return false;
    }
    drive->length = follower.length;
    drive->is_clear = follower.is_clear;
    return true;
}

struct plan_driven plan_drive_result(const struct plan_drive *drive)
{
    const struct mission_leg *total = &drive->mission.total;

    return (struct plan_driven){.places = drive->places,
                                .place_count = drive->waypoint_count,
                                .margin_m = drive->margin_m,
                                .predicted = predicted_sums(drive),
                                .driven = {total->measured_energy, drive->length, total->duration},
                                .battery_energy = total->battery_energy,
                                .end_error = total->end_error,
                                .is_clear = drive->is_clear,
                                .is_level = true};
}
