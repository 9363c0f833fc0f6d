/**
 * Energy of a trajectory, before it is driven:
 *
 *   E = 2/Rm ∫ (uc² + ud²) dt + (b1 − c1) ∫ v² dt + (b2 − c2) ∫ φ̇² dt + Ps T
 *
 * with uc, ud half the sum and half the difference of the voltages, which the trajectory tells, and c1 v² + c2 φ̇² what
 * they take in a steady motion: what the model knows of the steady motion of this robot replaces it. What the battery
 * gives is u·i instead of u²/Rm: with ec v and ed φ̇, which the motors' motion takes of the voltages,
 *
 *   E = 2/Rm ∫ (uc (uc − ec v) + ud (ud − ed φ̇)) dt + …
 *
 * J is the unit of the model (energy.h).
 */
#ifndef JOULEPATH_TRAJECTORY_ENERGY_H
#define JOULEPATH_TRAJECTORY_ENERGY_H

#include <joulepath/energy.h>
#include <joulepath/trajectory.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Speed at which a metre takes the least energy, √(Ps/b1), m/s; 0.01…8.
 */
jp_q24 jp_cruise_speed(const struct jp_energy_model *model);

/** Of the motors, as a trajectory tells its voltages: what the battery gives is the voltage times the current that it
 *  leaves. Zero: energy of the voltages alone, as of jp_meter.model. */
struct jp_back_emf {
    jp_q16 travel;  /**< ec, V·s/m; 0…4 096 */
    jp_q16 turning; /**< ed, V·s/turn; 0…4 096 */
};

/** What is left of the difference at a trajectory's start when its first leg begins: for jp_trajectory_leg_energy().
 *  Constant time. */
void jp_trajectory_modes(const struct jp_trajectory *trajectory, jp_q24 modes[JP_TRAVEL_MODES]);

/**
 * What a leg takes, its travel without what is left of the difference at the start; config and model passed their
 * checks. `modes`: what is left of the difference at the trajectory's start when the leg begins, at first as of
 * jp_trajectory_modes(), ±8 m/s; it becomes what is left when the leg ends. JP_ERR_OVERFLOW: a member is above 32 767,
 * which is what it then is; or a voltage is beyond some 4 096 V, or what is left decays so slowly that it rolls beyond
 * 128 m: then the energy is 32 767. JP_ERR_ARGUMENT: a null pointer. Bounded work; not for ISRs.
 */
enum jp_status jp_trajectory_leg_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                        const struct jp_back_emf *back_emf, const struct jp_trajectory_leg *leg,
                                        jp_q24 modes[JP_TRAVEL_MODES], struct jp_leg_energy *result);

/**
 * Energy in J, of the motors' voltages, of the whole trajectory, all of whose legs are in its places; config and model
 * passed their checks. JP_ERR_OVERFLOW: more than 32 767 J, which is what *energy then is. JP_ERR_ARGUMENT: a null
 * pointer. O(legs); not for ISRs.
 */
enum jp_status jp_trajectory_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                    const struct jp_trajectory *trajectory, jp_q16 *energy);

#ifdef __cplusplus
}
#endif

#endif
