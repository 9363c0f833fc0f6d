#include "sim/skid_steer/skid_steer_model.h"

#include <math.h>

/* Steeds' and Maclaurin's fit of the lateral resistance to the turn radius R: μt = μ / (0.925 + 0.15 R/B). */
#define LATERAL_AT_PIVOT   0.925
#define LATERAL_PER_RADIUS 0.15

struct skid_steer_sides skid_steer_wheel_speeds(const struct skid_steer_model *model,
                                                const struct skid_steer_motion *motion)
{
    const double across = motion->turn_rate * model->body.width_m / 2;

    return (struct skid_steer_sides){(motion->speed - across) / model->wheel.radius_m,
                                     (motion->speed + across) / model->wheel.radius_m};
}

static double sign(double x)
{
    return (double)((x > 0) - (x < 0));
}

/* N·m against the turn. */
static double turning_moment(const struct skid_steer_model *model, const struct skid_steer_motion *motion)
{
    if (motion->turn_rate == 0) {
        return 0;
    }
    const double weight = model->body.mass_kg * STANDARD_GRAVITY;
    const double radius = fabs(motion->speed / motion->turn_rate);
    const double lateral =
        model->ground.friction / (LATERAL_AT_PIVOT + LATERAL_PER_RADIUS * radius / model->body.width_m);

    return sign(motion->turn_rate) * lateral * weight * model->body.wheelbase_m / 4;
}

struct skid_steer_sides skid_steer_torques(const struct skid_steer_model *model, const struct skid_steer_motion *motion)
{
    const struct skid_steer_sides speeds = skid_steer_wheel_speeds(model, motion);
    const double weight = model->body.mass_kg * STANDARD_GRAVITY;
    const double rolling = model->ground.rolling * weight / 2;
    const double climbing = sign(motion->speed) * motion->grade * weight / 2;
    const double turning = turning_moment(model, motion) / model->body.width_m;

    return (struct skid_steer_sides){(sign(speeds.left) * rolling + climbing - turning) * model->wheel.radius_m,
                                     (sign(speeds.right) * rolling + climbing + turning) * model->wheel.radius_m};
}

/* A (eq. 5). */
static double current(const struct skid_steer_model *model, double torque)
{
    return torque / (model->motor.torque_constant * model->motor.gear_ratio * model->motor.efficiency);
}

static double voltage(const struct skid_steer_model *model, double torque, double speed)
{
    return model->motor.torque_constant * model->motor.gear_ratio * speed +
           current(model, torque) * model->motor.resistance_ohm;
}

struct skid_steer_sides skid_steer_voltages(const struct skid_steer_model *model,
                                            const struct skid_steer_motion *motion)
{
    const struct skid_steer_sides speeds = skid_steer_wheel_speeds(model, motion);
    const struct skid_steer_sides torques = skid_steer_torques(model, motion);

    return (struct skid_steer_sides){voltage(model, torques.left, speeds.left),
                                     voltage(model, torques.right, speeds.right)};
}

static double side_power(const struct skid_steer_model *model, enum jp_cost_kind kind, double torque, double speed)
{
    const double work = torque * speed;
    const double amperes = current(model, torque);
    const bool returns = kind == JP_COST_PHYSICAL && work < 0;
    const double mechanical =
        returns ? model->motor.recuperation * model->motor.efficiency * work : work / model->motor.efficiency;

    return mechanical + amperes * amperes * model->motor.resistance_ohm;
}

double skid_steer_power(const struct skid_steer_model *model, enum jp_cost_kind kind,
                        const struct skid_steer_motion *motion)
{
    const struct skid_steer_sides speeds = skid_steer_wheel_speeds(model, motion);
    const struct skid_steer_sides torques = skid_steer_torques(model, motion);
    const double motors =
        side_power(model, kind, torques.left, speeds.left) + side_power(model, kind, torques.right, speeds.right);

    return kind == JP_COST_PHYSICAL ? motors + model->electronics.power_w : motors;
}

double skid_steer_unlimited_energy(const struct skid_steer_model *model, enum jp_cost_kind kind,
                                   const struct skid_steer_motion *motion, double duration)
{
    const double driven = skid_steer_power(model, kind, motion) * duration;
    if (kind == JP_COST_PHYSICAL) {
        return driven;
    }
    const double distance = fabs(motion->speed) * duration;
    const double weight = model->body.mass_kg * STANDARD_GRAVITY;

    return model->lattice.distance_j_per_m * distance + driven +
           model->ground.friction * weight * motion->grade * distance;
}

double skid_steer_energy(const struct skid_steer_model *model, enum jp_cost_kind kind,
                         const struct skid_steer_motion *motion, double duration)
{
    const double least = kind == JP_COST_PHYSICAL ? model->electronics.power_w * duration : 0;

    return fmax(skid_steer_unlimited_energy(model, kind, motion, duration), least);
}
