#include "sim/missions/plan_skid_drive.h"

#include <math.h>

#include "sim/base/error.h"
#include "sim/base/strict_math.h"
#include "sim/missions/navigation_sight.h"
#include "sim/skid_steer/skid_robots.h"

#define Q16     65536.0
#define RADIANS (2 * 3.14159265358979323846 / 4294967296.0)

#define SEED     1
#define LOG_RATE 20 /* rows a second */

/* ---- The path ---- */

static const struct jp_primitive *find_primitive(const struct jp_lattice *lattice, const struct jp_lattice_pose *from,
                                                 const struct jp_lattice_pose *to)
{
    for (unsigned i = lattice->first_from[from->heading]; i < lattice->first_from[from->heading + 1U]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];

        if (primitive->end == to->heading && primitive->dx == to->x - from->x && primitive->dy == to->y - from->y) {
            return primitive;
        }
    }
    return NULL;
}

static bool make_path(const struct map_file *map, const struct jp_lattice *lattice, const struct plan_route *route,
                      struct plan_skid_drive *drive)
{
    (void)jp_lattice_path_start(&drive->path, drive->pieces, PLAN_PIECES_MAX);
    for (size_t i = 1; i < route->count; i++) {
        const struct jp_lattice_pose *from = &route->steps[i - 1].pose;
        const struct jp_primitive *primitive = find_primitive(lattice, from, &route->steps[i].pose);

        if (primitive == NULL || jp_lattice_path_add(&drive->path, lattice, &map->terrain, from, primitive) != JP_OK) {
            error_line("the route cannot be driven: step %zu is no curve that the robot can follow, or there are more "
                       "than %d pieces; give a nearer --goal",
                       i, PLAN_PIECES_MAX);
            return false;
        }
    }
    return true;
}

static struct clearance_pose place_of(const struct jp_point *point, jp_angle heading)
{
    return (struct clearance_pose){point->x / Q16, point->y / Q16, heading * RADIANS};
}

static void note_places(struct plan_skid_drive *drive)
{
    const struct jp_lattice_path *path = &drive->path;

    for (uint16_t i = 0; i < path->count; i++) {
        drive->places[i] = place_of(&path->pieces[i].begin, path->pieces[i].heading);
    }
    drive->places[path->count] = place_of(&path->end.position, path->end.heading);
    drive->driven.places = drive->places;
    drive->driven.place_count = (size_t)path->count + 1;
}

static void predict(struct plan_skid_drive *drive)
{
    const struct jp_skid_energy_model *model = &drive->skid.pilot.learner.model;
    const struct jp_motion_price price = jp_skid_motion_price(model, 0);
    struct jp_skid_drive energy = {.energy = 0};
    struct jp_path_cost cost;
    jp_q16 duration = 0;

    (void)jp_path_plan_speeds(&drive->path, &drive->skid.pilot.config.limits, &price, &cost);
    jp_skid_path_energy(model, &drive->path, &energy, &duration);
    drive->driven.predicted =
        (struct plan_sums){.energy = ldexp((double)energy.energy, model->unit_exponent - 16), .time = duration / Q16};
    for (uint16_t i = 0; i < drive->path.count; i++) {
        const struct jp_path_piece *piece = &drive->path.pieces[i];
        drive->driven.predicted.length += piece->kind == JP_PIECE_CURVE ? piece->length / (Q16 * 256) : 0;
    }
}

/* ---- The drive ---- */

/* Out of the battery's cells, J. */
static double spent(const struct plan_skid_drive *drive)
{
    return drive->skid.world.plant.state.ledger.battery;
}

/* As odometry would see it: from the start, x ahead. */
static void log_row(const struct plan_skid_drive *drive, const struct clearance_pose *pose, double begin_energy,
                    FILE *log)
{
    const struct clearance_pose *start = &drive->places[0];
    const double dx = pose->x - start->x;
    const double dy = pose->y - start->y;
    const double c = strict_cos(start->heading);
    const double s = strict_sin(start->heading);

    (void)fprintf(log, "%.3f,%.5f,%.5f,%.5f,%.4f\n", drive->driven.driven.time, dx * c + dy * s, dy * c - dx * s,
                  pose->heading - start->heading, spent(drive) - begin_energy);
}

static void follow(const struct jp_terrain *terrain, struct plan_skid_drive *drive, FILE *log)
{
    const struct navigation_robot *robot = &drive->robot;
    const double begin_energy = spent(drive);
    const unsigned ticks_a_row = (unsigned)(robot->rate_hz / LOG_RATE);
    struct clearance_pose before = robot->pose(robot->self);
    struct plan_driven *driven = &drive->driven;

    driven->is_clear = true;
    for (unsigned tick = 1; jp_skid_robot_has_next(&drive->skid.controller) ||
                            jp_skid_robot_state_now(&drive->skid.controller) == JP_SKID_ROBOT_DRIVING;
         tick++) {
        robot->tick(robot->self);
        driven->driven.time = tick / robot->rate_hz;
        if (tick % ticks_a_row == 0) {
            const struct clearance_pose pose = robot->pose(robot->self);

            driven->driven.length += strict_hypot(pose.x - before.x, pose.y - before.y);
            driven->is_clear = driven->is_clear && clearance_at(terrain, &robot->body, &pose);
            before = pose;
            log_row(drive, &pose, begin_energy, log);
        }
    }
    driven->driven.energy = spent(drive) - begin_energy;
    driven->battery_energy = driven->driven.energy;
    driven->end_error =
        strict_hypot(before.x - drive->places[drive->path.count].x, before.y - drive->places[drive->path.count].y);
}

/* Path and odometry begin at the same place. */
static bool begin(struct plan_skid_drive *drive)
{
    const struct jp_path_pose origin = {drive->path.pieces[0].begin, drive->path.pieces[0].heading};

    jp_lattice_path_in_frame(&drive->path, &origin);
    if (jp_skid_robot_follow(&drive->skid.controller, &drive->path) != JP_OK) {
        error_line("%s: the robot does not stand at the start: it is too steep there; give another --start",
                   drive->robot.name);
        return false;
    }
    return true;
}

bool plan_skid_drive_prepare(const struct map_file *map, const struct jp_lattice *lattice,
                             const struct skid_robot_entry *entry, const struct skid_steer_model *model,
                             const struct plan_route *route, struct plan_skid_drive *drive)
{
    *drive = (struct plan_skid_drive){.driven = {.place_count = 0}};
    if (!make_path(map, lattice, route, drive)) {
        return false;
    }
    note_places(drive);
    if (!navigation_skid_init(&drive->skid, entry, model, &map->terrain, NULL, &drive->places[0], SEED,
                              &drive->robot)) {
        return false;
    }
    predict(drive);
    return begin(drive);
}

void plan_skid_drive_run(const struct map_file *map, struct plan_skid_drive *drive, FILE *log)
{
    (void)fprintf(log, "t_s,x_m,y_m,heading_rad,energy_j\n");
    follow(&map->terrain, drive, log);
}
