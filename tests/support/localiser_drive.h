/** Drives over a map whose true pose is known: a route between random places, wheels that err, scans of what stands on
 *  the map and of what it does not show. */
#ifndef JOULEPATH_TESTS_SUPPORT_LOCALISER_DRIVE_H
#define JOULEPATH_TESTS_SUPPORT_LOCALISER_DRIVE_H

#include <joulepath/grid_planner.h>
#include <joulepath/localiser.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "sim/base/random.h"
#include "sim/four_wheel/laser.h"

enum { DRIVE_TURNS_MAX = 512, DRIVE_SHAPES_MAX = 128, DRIVE_WALKERS = 4, DRIVE_SUBSTEPS = 10 };

#define DRIVE_PERIOD    0.1 /* of a scan, s */
#define DRIVE_SPEED     0.8 /* m/s */
#define DRIVE_TURN_RATE 1.0 /* rad/s */
#define DRIVE_CLEARANCE JP_Q16(0.4)

/** Those of sim/robots/patrol.cfg. */
#define DRIVE_BEAMS 360
#define DRIVE_RANGE 8.0
#define DRIVE_NOISE 0.01

/** What makes it hard. */
struct drive_trouble {
    double slip;        /* the wheels' error: a share of the way and of the turn, drawn up to this for each drive */
    bool has_walkers;   /* who go along with the robot, at 0.8 to 2 m */
    double box_spacing; /* a box that the map does not show every so many m along the way; 0: none */
    double dropout;     /* share of the beams */
    double outage;      /* s without any scan in each half minute */
};

struct drive {
    const struct jp_terrain *map;
    struct solid_map solid;
    struct random random;
    struct drive_trouble trouble;
    struct laser_config laser;
    struct planar_pose pose; /* true */
    struct planar_pose wheels;
    double wheel_scale;
    double turn_scale;
    double sideways;
    double length;            /* driven, m */
    double time;              /* s */
    struct planar_point from; /* where the route begins */
    struct planar_point turns[DRIVE_TURNS_MAX];
    size_t turn_count;
    size_t turn_next;
    struct planar_shape shapes[DRIVE_SHAPES_MAX];
    size_t box_count;
    size_t shape_count;
    struct laser_scan scan;
    bool has_scan;
    void *planner_block;
    size_t planner_size;
    struct jp_grid_planner planner;
};

/* ---- Routes ---- */

static inline struct jp_grid_cell drive_cell(const struct drive *drive, double x, double y)
{
    return (struct jp_grid_cell){(int16_t)floor(x / drive->solid.cell), (int16_t)floor(y / drive->solid.cell)};
}

static inline bool drive_has_room(const struct drive *drive, int x, int y)
{
    return solid_map_distance(&drive->solid, x, y) * drive->solid.cell > 0.6;
}

/** A random place with room around it. */
static inline struct planar_point drive_place(struct drive *drive)
{
    int x;
    int y;

    do {
        x = (int)random_uniform(&drive->random, 0, drive->solid.width);
        y = (int)random_uniform(&drive->random, 0, drive->solid.height);
    } while (!drive_has_room(drive, x, y));
    return (struct planar_point){(x + 0.5) * drive->solid.cell, (y + 0.5) * drive->solid.cell};
}

static inline void drive_keep_path(struct drive *drive)
{
    size_t count;
    const struct jp_point *path = jp_grid_planner_path(&drive->planner, &count);

    drive->turn_count = count < DRIVE_TURNS_MAX ? count : DRIVE_TURNS_MAX;
    drive->turn_next = 1;
    for (size_t i = 0; i < drive->turn_count; i++) {
        drive->turns[i] = (struct planar_point){(double)path[i].x / JP_Q16_ONE, (double)path[i].y / JP_Q16_ONE};
    }
}

/** From a place that a route ended at or begins from; false where no way leads there. */
static inline bool drive_route_to(struct drive *drive, struct planar_point goal)
{
    const struct jp_grid_planner_config config = {.method = JP_GRID_ANY_ANGLE, .clearance = DRIVE_CLEARANCE, .tube = 4};
    const struct jp_grid_cell start = drive_cell(drive, drive->from.x, drive->from.y);
    const struct jp_grid_cell end = drive_cell(drive, goal.x, goal.y);
    const char *field;
    enum jp_grid_answer answer = JP_GRID_SEARCHING;

    if (jp_grid_planner_init(&drive->planner, &config, drive->map, drive->planner_block, drive->planner_size, &field) !=
            JP_OK ||
        jp_grid_planner_start(&drive->planner, &start, &end) != JP_OK) {
        return false;
    }
    while (answer == JP_GRID_SEARCHING) {
        answer = jp_grid_planner_work(&drive->planner, 100000);
    }
    if (answer != JP_GRID_FOUND) {
        return false;
    }
    drive_keep_path(drive);
    return true;
}

static inline double drive_left(const struct drive *drive)
{
    double left = 0;
    struct planar_point last = {drive->pose.x, drive->pose.y};

    for (size_t i = drive->turn_next; i < drive->turn_count; i++) {
        left += hypot(drive->turns[i].x - last.x, drive->turns[i].y - last.y);
        last = drive->turns[i];
    }
    return left;
}

/* Boxes at random beside the way that is left, off it by more than the robot needs. */
static inline void drive_put_boxes(struct drive *drive)
{
    drive->box_count = 0;
    if (drive->trouble.box_spacing <= 0) {
        return;
    }
    for (size_t i = 1; i < drive->turn_count; i++) {
        const struct planar_point a = drive->turns[i - 1];
        const struct planar_point b = drive->turns[i];
        const double way = hypot(b.x - a.x, b.y - a.y);
        const int boxes = (int)(way / drive->trouble.box_spacing);

        for (int k = 0; k < boxes && drive->box_count < DRIVE_SHAPES_MAX - DRIVE_WALKERS; k++) {
            const double along = random_uniform(&drive->random, 0, way);
            const double side = random_uniform(&drive->random, 0, 1) < 0.5 ? -1 : 1;
            const double off = side * random_uniform(&drive->random, 0.7, 1.6);

            drive->shapes[drive->box_count++] = (struct planar_shape){
                .kind = PLANAR_BOX,
                .pose = {a.x + (along * (b.x - a.x) - off * (b.y - a.y)) / way,
                         a.y + (along * (b.y - a.y) + off * (b.x - a.x)) / way, random_uniform(&drive->random, 0, 3)},
                .half_length = random_uniform(&drive->random, 0.1, 0.4),
                .half_width = random_uniform(&drive->random, 0.1, 0.3)};
        }
    }
}

/** To a random place that is reachable. */
static inline void drive_route(struct drive *drive)
{
    while (!drive_route_to(drive, drive_place(drive)) || drive_left(drive) < 1) {
    }
    drive_put_boxes(drive);
}

/* ---- Beginning ---- */

/* Anywhere in the largest part of the map: most places can be reached from there. */
static inline void drive_put(struct drive *drive)
{
    int reached = 0;

    while (reached < 3) {
        drive->from = drive_place(drive);
        drive->pose = (struct planar_pose){drive->from.x, drive->from.y, random_uniform(&drive->random, -M_PI, M_PI)};
        reached = 0;
        for (int i = 0; i < 5; i++) {
            reached += drive_route_to(drive, drive_place(drive)) && drive_left(drive) >= 1;
        }
    }
}

static inline double drive_error(struct drive *drive)
{
    return drive->trouble.slip * random_uniform(&drive->random, -1, 1);
}

/** At a random place, on the way to another. `map` outlives it. */
static inline void drive_begin(struct drive *drive, const struct jp_terrain *map, uint64_t seed,
                               const struct drive_trouble *trouble)
{
    const struct jp_grid_planner_config config = {.method = JP_GRID_ANY_ANGLE, .clearance = DRIVE_CLEARANCE, .tube = 4};

    *drive = (struct drive){.map = map, .trouble = *trouble};
    random_init(&drive->random, seed);
    drive->planner_size = jp_grid_planner_size(&config, &map->config);
    drive->planner_block = malloc(drive->planner_size);
    if (drive->planner_block == NULL || !solid_map_init(&drive->solid, map)) {
        abort();
    }
    drive->laser = laser_config_of(DRIVE_BEAMS, 2 * M_PI, DRIVE_RANGE, DRIVE_NOISE);
    drive->laser.dropout = trouble->dropout;
    drive->wheel_scale = 1 + drive_error(drive);
    drive->turn_scale = 1 + drive_error(drive);
    drive->sideways = drive_error(drive) / 2;

    drive_put(drive);
    drive->wheels = drive->pose;
    drive_route(drive);
}

static inline void drive_end(struct drive *drive)
{
    solid_map_free(&drive->solid);
    free(drive->planner_block);
}

/** Carries it to another place and lets it go on from there. */
static inline void drive_kidnap(struct drive *drive)
{
    const struct planar_point from = {drive->pose.x, drive->pose.y};

    do {
        drive_put(drive);
    } while (hypot(from.x - drive->pose.x, from.y - drive->pose.y) < 3);
    drive_route(drive);
}

/* ---- A cycle ---- */

static inline struct planar_pose drive_motion(const struct drive *drive, struct planar_point goal)
{
    const double seconds = DRIVE_PERIOD / DRIVE_SUBSTEPS;
    const double error = planar_wrap(atan2(goal.y - drive->pose.y, goal.x - drive->pose.x) - drive->pose.heading);
    const double rate = fmax(fmin(4 * error, DRIVE_TURN_RATE), -DRIVE_TURN_RATE);
    const double left = hypot(goal.x - drive->pose.x, goal.y - drive->pose.y);
    const double speed = fabs(error) > 0.4 ? 0 : fmin(DRIVE_SPEED, 0.1 + 2 * left);

    return (struct planar_pose){speed * seconds, 0, rate * seconds};
}

static inline void drive_move(struct drive *drive)
{
    const struct planar_point goal = drive->turns[drive->turn_next];
    const struct planar_pose motion = drive_motion(drive, goal);
    const struct planar_pose felt = {motion.x * drive->wheel_scale, motion.x * drive->sideways,
                                     motion.heading * drive->turn_scale};

    drive->pose = planar_bend(&drive->pose, &motion);
    drive->wheels = planar_bend(&drive->wheels, &felt);
    drive->length += motion.x;
    if (hypot(goal.x - drive->pose.x, goal.y - drive->pose.y) < 0.05) {
        drive->turn_next++;
    }
    if (drive->turn_next >= drive->turn_count) {
        drive->from = drive->turns[drive->turn_count - 1];
        drive_route(drive);
    }
}

/* People who go along, and drift around the robot. */
static inline void drive_walk(struct drive *drive)
{
    drive->shape_count = drive->box_count;
    for (int i = 0; drive->trouble.has_walkers && i < DRIVE_WALKERS; i++) {
        const double bearing = drive->pose.heading + 1.7 * i + 0.8 * sin(0.3 * drive->time + i);
        const double away = 1.4 + 0.6 * sin(0.5 * drive->time + 2 * i);

        drive->shapes[drive->shape_count++] =
            (struct planar_shape){.kind = PLANAR_DISC,
                                  .pose = {drive->pose.x + away * cos(bearing), drive->pose.y + away * sin(bearing), 0},
                                  .radius = 0.25};
    }
}

/** The next scan, DRIVE_PERIOD later. */
static inline void drive_step(struct drive *drive, bool stands)
{
    for (int i = 0; i < DRIVE_SUBSTEPS && !stands; i++) {
        drive_move(drive);
    }
    drive->time += DRIVE_PERIOD;
    drive_walk(drive);
    laser_take(&drive->laser, &drive->solid, drive->shapes, drive->shape_count, &drive->pose, &drive->random,
               &drive->scan);
    drive->has_scan = fmod(drive->time, 30) >= drive->trouble.outage;
}

/* ---- What the robot is told ---- */

static inline struct jp_plane_pose drive_plane(const struct planar_pose *pose)
{
    return (struct jp_plane_pose){(float)pose->x, (float)pose->y, (float)pose->heading};
}

static inline struct jp_localiser_input drive_input(const struct drive *drive)
{
    struct jp_localiser_input input = {.wheels = drive_plane(&drive->wheels)};

    if (drive->has_scan) {
        input.scan = (struct jp_scan){drive->scan.ranges, (uint16_t)drive->scan.beams, (float)drive->scan.first,
                                      (float)drive->scan.step};
    }
    return input;
}

/** How a robot like the patrol robot is localised. */
static inline struct jp_localiser_config drive_localiser(const struct jp_terrain *map)
{
    return (struct jp_localiser_config){.map = map,
                                        .range_max = 8.0f,
                                        .noise = 0.01f,
                                        .wheels = {0.1f, 0.1f, 0.02f},
                                        .start_distance = 0.1f,
                                        .start_turn = 0.05f,
                                        .lost_distance = 1.0f,
                                        .lost_turn = 0.5f};
}

static inline double drive_distance(const struct drive *drive, const struct jp_plane_pose *pose)
{
    return hypot((double)pose->x - drive->pose.x, (double)pose->y - drive->pose.y);
}

static inline double drive_turn(const struct drive *drive, const struct jp_plane_pose *pose)
{
    return fabs(planar_wrap((double)pose->heading - drive->pose.heading));
}

#endif
