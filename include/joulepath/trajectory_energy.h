/**
 * Energy of a trajectory, before it is driven:
 *
 *   E = 2/Rm ∫ (uc² + ud²) dt + Ps T
 *
 * with uc, ud half the sum and half the difference of the voltages, which the trajectory tells.
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

/**
 * Energy in J of the whole trajectory; config and model passed their checks. JP_ERR_OVERFLOW: more than 32 767 J, which
 * is what *energy then is. JP_ERR_ARGUMENT: a null pointer. O(legs); not for ISRs.
 */
enum jp_status jp_trajectory_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                    const struct jp_trajectory *trajectory, jp_q16 *energy);

#ifdef __cplusplus
}
#endif

#endif
