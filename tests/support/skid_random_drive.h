/** Random drives of skid-steered and differential-drive robots that nobody has seen: robot, ground and route by a rule.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_RANDOM_DRIVE_H
#define JOULEPATH_TESTS_SUPPORT_SKID_RANDOM_DRIVE_H

#include <joulepath/sensors.h>
#include <math.h>

#include "sim/skid_steer/skid_hal_sim.h"
#include "tests/support/skid_hills.h"

/** Way between two stands, m, and how long one lasts, s. */
#define SKID_STAND_EVERY 20
#define SKID_STAND       2

/** A robot on its way. */
struct skid_drive {
    struct random noise;
    struct skid_hills hills;
    struct skid_ground ground;
    struct skid_world world;
    double ratio; /* steering ratio that the driver assumes */
    double acceleration;
    double turn_acceleration;
    double integral[SKID_SIDES]; /* rad */
    struct {
        double speed;
        double turn_rate;
        double left; /* s */
    } piece;
    double speed; /* what is asked of the wheels now */
    double turn_rate;
    double way;        /* on the map, m */
    double next_stand; /* way at which it comes */
};

static inline double skid_either(struct random *noise, double size)
{
    return random_uniform(noise, -1, 1) < 0 ? -size : size;
}

/** Friction 0.4…1 of the file's, stiffness of the tyres 0.7…1.4, rolling resistance 0.7…1.5, mass −10…+30 %, gyro's
 * bias and scale within twice the file's, the accelerometer's within the file's. */
static inline struct skid_steer_model skid_random_robot(const struct skid_steer_model *file, struct random *noise)
{
    struct skid_steer_model model = *file;
    const double mass = random_uniform(noise, 0.9, 1.3);

    model.ground.friction *= random_uniform(noise, 0.4, 1);
    model.tyre.stiffness_per_m *= random_uniform(noise, 0.7, 1.4);
    model.ground.rolling *= random_uniform(noise, 0.7, 1.5);
    model.body.mass_kg *= mass;
    model.body.yaw_inertia_kg_m2 *= mass;
    model.gyro.bias_dps *= random_uniform(noise, -2, 2);
    model.gyro.scale_error *= random_uniform(noise, -2, 2);
    model.accelerometer.bias_g *= random_uniform(noise, -1, 1);
    model.accelerometer.scale_error *= random_uniform(noise, -1, 1);
    return model;
}

/** Straights of 0.5 to 4 m, of which one in eight goes back, arcs and turns on the spot of 30° to 180°, at lattice
 * speed; arcs at 0.25 to 1 of the lattice's turn rate. */
static inline void skid_next_piece(struct skid_drive *drive)
{
    const struct skid_steer_model *model = &drive->world.plant.model;
    const double kind = random_uniform(&drive->noise, 0, 3);
    const double turn = random_uniform(&drive->noise, M_PI / 6, M_PI);
    const double length = random_uniform(&drive->noise, 0.5, 4);
    const double share = random_uniform(&drive->noise, 0.25, 1);

    if (drive->way >= drive->next_stand) {
        drive->next_stand += SKID_STAND_EVERY;
        drive->piece.speed = 0;
        drive->piece.turn_rate = 0;
        drive->piece.left = SKID_STAND + 1; /* with the way to the stand */
        return;
    }
    drive->piece.speed = kind < 2 ? model->lattice.speed_m_s : 0;
    drive->piece.turn_rate = 0;
    drive->piece.left = length / model->lattice.speed_m_s;
    if (kind < 1) {
        drive->piece.speed *= share < 0.34375 ? -1 : 1;
        return;
    }
    const double rate = model->lattice.turn_rate_rad_s * (kind < 2 ? share : 1);
    drive->piece.turn_rate = skid_either(&drive->noise, rate);
    drive->piece.left = turn / rate;
}

/** At rest at the origin, on hills of at most `steepest` degrees, about to stand. */
static inline void skid_drive_start(struct skid_drive *drive, const struct skid_steer_model *model, double ratio,
                                    double steepest, uint64_t seed)
{
    const struct planar_pose origin = {0, 0, 0};

    *drive = (struct skid_drive){
        .ratio = ratio,
        .acceleration = model->lattice.speed_m_s / 0.7,
        .turn_acceleration = model->lattice.turn_rate_rad_s / 0.7,
    };
    random_init(&drive->noise, seed);
    drive->hills = skid_random_hills(&drive->noise, tan(steepest * M_PI / 180));
    drive->ground = skid_ground_hills(&drive->hills);
    skid_world_init(&drive->world, model, &drive->ground, &origin, seed);
    skid_next_piece(drive);
}

static inline double skid_towards(double from, double to, double step)
{
    return from + fmin(fmax(to - from, -step), step);
}

/* Proportional and integral control of the wheel speeds; back EMF ahead. */
static inline jp_q31 skid_duty(struct skid_drive *drive, int side, double target)
{
    const struct skid_plant *plant = &drive->world.plant;
    const double constant = plant->model.motor.torque_constant * plant->model.motor.gear_ratio;
    const double gain = plant->side_inertia * plant->model.motor.resistance_ohm / constant * 20;
    const double error = target - plant->state.sides[side].rate;

    drive->integral[side] += skid_world_tick_seconds(&drive->world) * error;
    const double volts = constant * target + gain * (error + 30 * drive->integral[side]);
    const double duty = fmin(fmax(volts / plant->attitude.bus_voltage, -1), 1);
    return (jp_q31)lround(duty * 2147483647.0);
}

/** One tick of the drive; *sensors are those at its end. */
static inline void skid_drive_tick(struct skid_drive *drive, struct jp_sensors *sensors)
{
    const struct skid_steer_model *model = &drive->world.plant.model;
    const double tick = skid_world_tick_seconds(&drive->world);
    const struct planar_pose before = skid_plant_pose(&drive->world.plant);
    const struct jp_hal hal = skid_hal_sim(&drive->world);

    if (drive->piece.left <= 0) {
        skid_next_piece(drive);
    }
    drive->piece.left -= tick;
    drive->speed = skid_towards(drive->speed, drive->piece.speed, drive->acceleration * tick);
    drive->turn_rate = skid_towards(drive->turn_rate, drive->piece.turn_rate, drive->turn_acceleration * tick);
    const double across = drive->turn_rate * model->body.width_m / 2 / drive->ratio;
    drive->world.actuation.duty_left = skid_duty(drive, SKID_LEFT, (drive->speed - across) / model->wheel.radius_m);
    drive->world.actuation.duty_right = skid_duty(drive, SKID_RIGHT, (drive->speed + across) / model->wheel.radius_m);
    drive->world.actuation.enabled = 1;
    skid_world_step(&drive->world);
    (void)hal.read(hal.context, sensors);
    const struct planar_pose after = skid_plant_pose(&drive->world.plant);
    drive->way += hypot(after.x - before.x, after.y - before.y);
}

#endif
