/** Skid steer and differential drive on a path: the plant under a controller of its sides' speeds and its turn rate,
 * with its true pose. */
#ifndef JOULEPATH_TESTS_SUPPORT_PATH_RIG_H
#define JOULEPATH_TESTS_SUPPORT_PATH_RIG_H

#include <joulepath/path_drive.h>
#include <joulepath/path_speed.h>
#include <joulepath/skid_steer.h>

#include "tests/support/skid_odometry_config.h"
#include "tests/support/skid_rig.h"

#define PATH_RIG_TICK_RATE 500

/** 1/s: how fast the turn rate's error becomes a difference of the sides. */
#define PATH_RIG_YAW_GAIN 6.0

#define PATH_RIG_Q16   65536.0
#define PATH_RIG_Q24   16777216.0
#define PATH_RIG_ANGLE 4294967296.0

static inline jp_q16 path_rig_q16(double value)
{
    return (jp_q16)lrint(value * PATH_RIG_Q16);
}

static inline jp_q24 path_rig_q24(double value)
{
    return (jp_q24)lrint(value * PATH_RIG_Q24);
}

static inline double path_rig_radians(jp_angle angle)
{
    return angle * (2 * M_PI / PATH_RIG_ANGLE);
}

/** With wheels and rotors, kg. */
static inline double path_rig_moving_mass(const struct skid_steer_model *model)
{
    const double rotor = model->motor.rotor_inertia_kg_m2 * model->motor.gear_ratio * model->motor.gear_ratio;
    const double side = model->wheel.axles * model->wheel.inertia_kg_m2 + rotor;

    return model->body.mass_kg + 2 * side / (model->wheel.radius_m * model->wheel.radius_m);
}

/** Of the formulas of `constants`, and of the moving mass; time has no price. */
static inline struct jp_motion_price path_rig_price(const struct skid_steer_model *model,
                                                    const struct jp_skid_steer_config *constants)
{
    const double half_mass = path_rig_moving_mass(model) / 2;

    return (struct jp_motion_price){
        .power = jp_skid_steer_power_of,
        .model = constants,
        .gain = path_rig_q16(half_mass / model->motor.efficiency),
        .recovery = path_rig_q16(half_mass * model->motor.efficiency * model->motor.recuperation),
    };
}

/** Errors of the robot in the frame of the set-point, m and rad. */
struct path_rig_error {
    double ahead;
    double left;
    double turned;
};

struct path_rig {
    struct skid_rig robot;
    struct jp_path_drive drive;
    struct jp_path_set_point at;
    struct jp_motion command;
    struct skid_pivot pivot;
    double yaw; /* added to the turn rate that the sides are given, rad/s */
    struct path_rig_error worst;
    double worst_distance; /* of robot and set-point, m */
    double way;            /* that was driven on the map, m */
    double seconds;
};

static inline struct jp_path_pose path_rig_pose(const struct path_rig *rig)
{
    const struct planar_pose pose = skid_plant_pose(&rig->robot.plant);
    const double turns = pose.heading / (2 * M_PI);

    return (struct jp_path_pose){{path_rig_q16(pose.x), path_rig_q16(pose.y)},
                                 (jp_angle)(int64_t)llrint((turns - floor(turns)) * PATH_RIG_ANGLE)};
}

/** At rest at the begin of a path whose speeds are planned; `steering` at the rig's own tick rate. False: it does not
 *  pass its check. */
static inline bool path_rig_start(struct path_rig *rig, const struct skid_steer_model *model,
                                  const struct jp_path_drive_config *steering, const struct skid_ground *ground,
                                  const struct jp_lattice_path *path)
{
    const struct jp_path_piece *first = &path->pieces[0];
    const struct planar_pose pose = {first->begin.x / PATH_RIG_Q16, first->begin.y / PATH_RIG_Q16,
                                     path_rig_radians(first->heading)};
    struct jp_path_drive_config config = *steering;
    const char *field = "";

    config.tick_rate = PATH_RIG_TICK_RATE;
    *rig = (struct path_rig){.pivot = skid_pivot_of(model)};
    skid_plant_init(&rig->robot.plant, model, ground, &pose);
    if (jp_path_drive_init(&rig->drive, &config, &field) != JP_OK) {
        return false;
    }
    jp_path_drive_begin(&rig->drive, path);
    return true;
}

static inline void path_rig_measure(struct path_rig *rig)
{
    const struct planar_pose pose = skid_plant_pose(&rig->robot.plant);
    const struct planar_pose at = {rig->at.pose.position.x / PATH_RIG_Q16, rig->at.pose.position.y / PATH_RIG_Q16,
                                   path_rig_radians(rig->at.pose.heading)};
    const struct planar_pose error = planar_between(&at, &pose);

    rig->worst.ahead = fmax(rig->worst.ahead, fabs(error.x));
    rig->worst.left = fmax(rig->worst.left, fabs(error.y));
    rig->worst.turned = fmax(rig->worst.turned, fabs(error.heading));
    rig->worst_distance = fmax(rig->worst_distance, hypot(error.x, error.y));
}

/** The sides' speeds by the command; the turn rate's error is integrated, since tyres that scrub turn less. */
static inline void path_rig_drive_sides(struct path_rig *rig)
{
    const struct skid_steer_model *model = &rig->robot.plant.model;
    const double speed = rig->command.speed / PATH_RIG_Q24;
    const double turn_rate = rig->command.turn_rate / PATH_RIG_Q24;
    const struct planar_pose before = skid_plant_pose(&rig->robot.plant);

    rig->yaw += SKID_RIG_TICK * PATH_RIG_YAW_GAIN * (turn_rate - rig->robot.plant.state.turn_rate);
    const double difference = (turn_rate + rig->yaw) * model->body.width_m / 2;
    skid_rig_tick(&rig->robot, speed - difference, speed + difference);
    const struct planar_pose after = skid_plant_pose(&rig->robot.plant);
    rig->way += hypot(after.x - before.x, after.y - before.y);
    rig->seconds += SKID_RIG_TICK;
}

/** By the tyres' model and how the plant lies on its slope. */
static inline struct jp_path_slide path_rig_slide(const struct path_rig *rig)
{
    const struct skid_attitude *attitude = &rig->robot.plant.attitude;
    const double across = attitude->rise_across * attitude->normal[2];
    const double ahead = attitude->rise_ahead * attitude->normal[2];

    return (struct jp_path_slide){path_rig_q24(ahead),
                                  path_rig_q24(across),
                                  path_rig_q24(rig->pivot.creep_across),
                                  path_rig_q24(rig->pivot.shift_across),
                                  path_rig_q24(rig->pivot.slide_most),
                                  path_rig_q24(rig->pivot.creep),
                                  path_rig_q24(1 / rig->pivot.slide_most)};
}

/** A set-point's time; false: the path is driven. */
static inline bool path_rig_step(struct path_rig *rig)
{
    if (!jp_path_drive_advance(&rig->drive, &rig->at)) {
        return false;
    }
    const struct jp_path_pose pose = path_rig_pose(rig);

    const struct jp_path_slide slide = path_rig_slide(rig);
    jp_path_drive_look_ahead(&rig->drive, &slide);
    jp_path_drive_track(&rig->drive, &rig->at, &pose, &rig->command);
    for (unsigned tick = 0; tick < JP_TICKS_PER_PATH_POINT; tick++) {
        path_rig_drive_sides(rig);
    }
    path_rig_measure(rig);
    return true;
}

/** To the end of the path, and half a second of rest there. */
static inline void path_rig_drive(struct path_rig *rig)
{
    while (path_rig_step(rig)) {
    }
    for (int tick = 0; tick < PATH_RIG_TICK_RATE / 2; tick++) {
        rig->command = (struct jp_motion){0, 0};
        path_rig_drive_sides(rig);
    }
}

#endif
