/** The plant of skid steer and differential drive under a speed controller of each side, and its energy in steady
 * motion.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_RIG_H
#define JOULEPATH_TESTS_SUPPORT_SKID_RIG_H

#include "sim/base/random.h"
#include "sim/skid_steer/skid_plant.h"
#include "tests/support/check.h"

#define SKID_RIG_TICK 0.002

static const struct planar_pose skid_origin = {0, 0, 0};
static const struct skid_ground skid_level = {NULL, NULL};

/** Proportional and integral control of the wheel speeds; back EMF ahead. */
struct skid_rig {
    struct skid_plant plant;
    double integral[SKID_SIDES]; /* rad */
};

/** Motion of the body, power at the bus and where it goes, mean of a time. */
struct skid_steady {
    double speed;     /* on the map, m/s */
    double turn_rate; /* of the heading, rad/s */
    double power;     /* out of the battery without what its resistance takes, W */
    double scrub;     /* lost by slip, W */
    double torque[SKID_SIDES];
};

static inline void skid_rig_start(struct skid_rig *rig, const struct skid_steer_model *model,
                                  const struct skid_ground *ground, double heading)
{
    const struct planar_pose pose = {0, 0, heading};

    *rig = (struct skid_rig){.integral = {0, 0}};
    skid_plant_init(&rig->plant, model, ground, &pose);
}

/** One tick towards wheel speeds, m/s of the tread. */
static inline void skid_rig_tick(struct skid_rig *rig, double left, double right)
{
    const struct skid_steer_model *model = &rig->plant.model;
    const double constant = model->motor.torque_constant * model->motor.gear_ratio;
    const double gain = rig->plant.side_inertia * model->motor.resistance_ohm / constant * 20;
    const double targets[SKID_SIDES] = {left / model->wheel.radius_m, right / model->wheel.radius_m};
    struct skid_input input = {.driven = true};

    for (int side = 0; side < SKID_SIDES; side++) {
        const double error = targets[side] - rig->plant.state.sides[side].rate;
        rig->integral[side] += SKID_RIG_TICK * error;
        const double volts = constant * targets[side] + gain * (error + 30 * rig->integral[side]);
        input.duty[side] = fmin(fmax(volts / rig->plant.attitude.bus_voltage, -1), 1);
    }
    skid_plant_step(&rig->plant, &input, SKID_RIG_TICK);
}

static inline void skid_rig_drive(struct skid_rig *rig, double left, double right, double seconds)
{
    for (int tick = 0; tick < (int)(seconds / SKID_RIG_TICK + 0.5); tick++) {
        skid_rig_tick(rig, left, right);
    }
}

/** Settles for 6 s, measures for 2 s. */
static inline struct skid_steady skid_rig_measure(struct skid_rig *rig, double left, double right)
{
    const double seconds = 2;
    skid_rig_drive(rig, left, right, 6);
    const struct skid_state before = rig->plant.state;
    skid_rig_drive(rig, left, right, seconds);
    const struct skid_state *after = &rig->plant.state;
    const double turn = after->heading - before.heading;
    const double chord = hypot(after->x - before.x, after->y - before.y);
    const double arc = fabs(turn) > 1e-9 ? chord * (turn / 2) / sin(turn / 2) : chord;
    const double ahead =
        cos(before.heading + turn / 2) * (after->x - before.x) + sin(before.heading + turn / 2) * (after->y - before.y);
    const struct skid_ledger *l = &after->ledger;
    const struct skid_ledger *b = &before.ledger;
    const double constant = rig->plant.model.motor.torque_constant * rig->plant.model.motor.gear_ratio;

    return (struct skid_steady){
        .speed = copysign(arc, ahead) / seconds,
        .turn_rate = turn / seconds,
        .power = (l->battery - b->battery - l->supply + b->supply) / seconds,
        .scrub = (l->slip_along - b->slip_along + l->slip_across - b->slip_across) / seconds,
        .torque = {constant * rig->plant.attitude.current[SKID_LEFT],
                   constant * rig->plant.attitude.current[SKID_RIGHT]},
    };
}

/** W that the formulas of the paper foretell for what was measured. */
static inline double skid_foretold(const struct skid_steer_model *model, const struct skid_steady *steady, double grade)
{
    const struct skid_steer_motion motion = {steady->speed, steady->turn_rate, grade};

    return skid_steer_power(model, JP_COST_PHYSICAL, &motion);
}

#endif
