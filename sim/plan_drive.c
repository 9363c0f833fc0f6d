#include "plan_drive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

#define Q16_ONE 65536.0

/** Of the waypoints in a scenario, m. */
#define DECIMALS 10000.0

#define SEED 1

/** That the driven path rarely leaves the predicted one by more. */
#define MARGIN_MIN_M 0.05

/* ---- Waypoints ---- */

static double least_margin(const struct plan_drive *drive)
{
    double least = WAYPOINTS_MARGIN_M;

    for (size_t i = 1; i < drive->waypoint_count; i++) {
        least = fmin(least, drive->waypoints[i].margin_m);
    }
    return least;
}

static bool take(struct plan_drive *drive, const struct waypoint *waypoints, size_t count)
{
    if (count == 0) {
        error_line("the route cannot be driven in arcs within the robot's limits; give other places or a finer map");
        return false;
    }
    if (count > BEZIER_WAYPOINTS_MAX) {
        error_line("the route takes %zu waypoints, a scenario holds %d; give a nearer --goal", count,
                   BEZIER_WAYPOINTS_MAX);
        return false;
    }
    memcpy(drive->waypoints, waypoints, count * sizeof *waypoints);
    drive->waypoint_count = count;
    drive->margin_m = least_margin(drive);
    return true;
}

/* Among the places of a route and, if these leave no choice, those beside it too. */
static size_t choose_within(const struct jp_terrain *terrain, const struct waypoints_robot *follower,
                            const struct clearance_pose *route, size_t count, struct clearance_pose *wide,
                            struct waypoint *waypoints)
{
    const double cell = (double)terrain->config.resolution / JP_Q16_ONE;
    const size_t chosen = waypoints_choose(terrain, follower, route, count, waypoints);

    return chosen > 0 ? chosen
                      : waypoints_choose(terrain, follower, wide, waypoints_widen(route, count, cell, wide), waypoints);
}

/* With a margin all along; without one only where it must be. */
static size_t choose(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                     const struct clearance_pose *route, size_t count, struct clearance_pose *wide,
                     struct waypoint *waypoints)
{
    const struct robot_entry *entry = rig_find_robot(robot->name);

    if (entry == NULL) {
        return 0;
    }
    struct waypoints_robot follower = {.length_m = robot->length_m,
                                       .width_m = robot->width_m,
                                       .model = entry->energy,
                                       .limits = &entry->config->limits,
                                       .margin_min_m = MARGIN_MIN_M,
                                       .step = &lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS]};
    const size_t chosen = choose_within(&map->terrain, &follower, route, count, wide, waypoints);
    follower.margin_min_m = 0;
    return chosen > 0 ? chosen : choose_within(&map->terrain, &follower, route, count, wide, waypoints);
}

static bool reduce(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                   const struct plan_route *route, struct plan_drive *drive)
{
    const size_t count = route->way_count;
    struct clearance_pose *places = calloc(count, sizeof *places);
    struct clearance_pose *wide = calloc(3 * count, sizeof *wide);
    struct waypoint *waypoints = calloc(3 * count, sizeof *waypoints);
    bool done = false;

    if (places == NULL || wide == NULL || waypoints == NULL) {
        error_line("%s: no memory for the route", map->name);
    } else if (count < 2) {
        error_line("--goal: is where the robot is already: nothing to drive; give a place farther off");
    } else {
        for (size_t i = 0; i < count; i++) {
            places[i] = plan_grid_pose(map, lattice, &route->way[i]);
        }
        done = take(drive, waypoints, choose(map, lattice, robot, places, count, wide, waypoints));
    }
    free(places);
    free(wide);
    free(waypoints);
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

    return (struct bezier_point){rounded(dx * cos(start->heading) + dy * sin(start->heading)),
                                 rounded(dy * cos(start->heading) - dx * sin(start->heading))};
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
        scenario->waypoints[i] = seen_from(&drive->waypoints[0].pose, &drive->waypoints[i].pose);
    }
}

bool plan_drive_prepare(const struct map_file *map, const struct jp_lattice *lattice, const struct lattice_robot *robot,
                        const struct plan_route *route, struct plan_drive *drive)
{
    *drive = (struct plan_drive){0};
    if (!reduce(map, lattice, robot, route, drive)) {
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

struct plan_sums plan_drive_predicted(const struct plan_drive *drive)
{
    struct plan_sums sums = {0};

    for (size_t i = 1; i < drive->waypoint_count; i++) {
        const struct jp_segment *segment = &drive->waypoints[i].segment;
        sums.energy += segment->energy / Q16_ONE;
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
    const struct clearance_pose pose = {start->x + position.x * cos(start->heading) - position.y * sin(start->heading),
                                        start->y + position.x * sin(start->heading) + position.y * cos(start->heading),
                                        start->heading + heading};

    follower->length += hypot(position.x - follower->before.x, position.y - follower->before.y);
    follower->before = position;
    follower->is_clear = follower->is_clear && clearance_at(follower->terrain, &follower->footprint, &pose);
}

bool plan_drive_run(const struct map_file *map, const struct lattice_robot *robot, struct plan_drive *drive, FILE *log)
{
    struct follower follower = {.terrain = &map->terrain,
                                .footprint = {robot->length_m, robot->width_m, 0},
                                .start = drive->waypoints[0].pose,
                                .is_clear = true};
    const struct mission_view view = {.log = log, .watch = watch, .context = &follower};

    if (!mission_run(&drive->mission, MISSION_OPTIMAL, &drive->scenario, NULL, &view)) {
        return false;
    }
    drive->length = follower.length;
    drive->is_clear = follower.is_clear;
    return true;
}
