/** The energy model of joulepath/skid_energy.h in double, by its header. */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_ENERGY_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_SKID_ENERGY_ORACLE_H

#include <joulepath/skid_energy.h>
#include <math.h>

#include "tests/support/decimal.h"

/** Energy of a piece, J, the sum of what its terms are without their signs, and what the treads would take if their
 * forces were the weight and they 1 m/s faster. */
struct oracle_energy {
    double energy;
    double terms;
    double by_weight;
};

static inline double oracle_sign(double x)
{
    return (double)((x > 0) - (x < 0));
}

static inline void oracle_add_side(const struct jp_skid_energy_model *model, double speed, double force, double slip,
                                   double level, struct oracle_energy *power)
{
    const double work = force * speed + slip;
    const double share = work < 0 ? q24(model->braking) : q24(model->driving);
    const double windings = force * speed <= 0 ? q16(model->copper_braking) : q16(model->copper_driving);

    power->energy += share * q16(model->weight) * work + windings * force * force * level;
    power->terms += share * q16(model->weight) * (fabs(force * speed) + slip) + windings * force * force;
    power->by_weight += share * q16(model->weight) * (fabs(speed) + 1) + windings * fabs(force);
}

static inline struct oracle_energy oracle_energy_of(const struct jp_skid_energy_model *model,
                                                    const struct jp_skid_piece *piece)
{
    const double seconds = q16(piece->duration);
    const double v = (q24(piece->start.speed) + q24(piece->end.speed)) / 2;
    const double w = (q24(piece->start.turn_rate) + q24(piece->end.turn_rate)) / 2;
    const double grade = q24(piece->grade);
    const double effort = grade + q24(model->inertia) * (q24(piece->end.speed) - q24(piece->start.speed)) / seconds;
    const double swinging =
        q24(model->turn_inertia) * (q24(piece->end.turn_rate) - q24(piece->start.turn_rate)) / seconds;
    const double bank = q24(piece->bank);
    const double across = q24(model->half_track) * w;
    const double friction = q24(model->friction);
    const double stiffness = friction * q24(model->yielding);
    const double rolling = fmax(fabs(v), fabs(across));
    const double eased =
        (q24(model->easing) * effort * effort + q24(model->bank_easing) * bank * bank) / (friction * friction);
    const double level = w == 0 ? 0 : q24(model->turning) * friction * w / (fabs(w) + stiffness * rolling);
    const double turning = level * fmax(1 - eased, 0) + q24(model->tilting) * effort * bank + swinging;
    const double grip = fmax(friction - fabs(effort), friction / 4);
    const double slip = effort * effort * q24(model->scrub) * (fabs(w) + stiffness * fabs(v)) / (2 * grip);
    struct oracle_energy power = {q16(model->electronics_power), q16(model->electronics_power), 0};

    for (int side = -1; side <= 1 && (v != 0 || w != 0); side += 2) {
        const double speed = v + side * across;
        const double force = oracle_sign(speed) * q24(model->rolling) / 2 + effort / 2 + side * turning;
        oracle_add_side(model, speed, force, slip, 1 / (1 + grade * grade), &power);
    }
    return (struct oracle_energy){power.energy * seconds, power.terms * seconds, power.by_weight * seconds};
}

#endif
