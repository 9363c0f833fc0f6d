/**
 * Prices of a lattice that was made by the formulas of skid_steer.h, by what a robot has learned of its energy: factors
 * for jp_tariff_by_factors().
 *
 * Each factor is the power by the learned model over that by the formulas, at the usual motion (v, w) of the lattice:
 *
 *   straight  P(v, 0)                               of level driving
 *   mass      P(v, 0) up a grade of 1/8 less P(v, 0)  of what a rise adds
 *   turning   P(0, w) + P(v, w) − P(v, 0)           of turns on the spot and of what bends add
 *
 * Pure and bounded, at most 80 64-bit divisions. Not for ISRs.
 */
#ifndef JOULEPATH_SKID_TARIFF_H
#define JOULEPATH_SKID_TARIFF_H

#include <joulepath/skid_energy.h>
#include <joulepath/skid_steer.h>
#include <joulepath/tariff.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Factors of `learned`, such as jp_skid_learner.model, on a lattice that `priced` made, both of which passed their
 * checks; limited to the range of factors. Its version is that of the learned state, for the tariff.
 * JP_ERR_ARGUMENT: a pointer is null, or the usual speed or turn rate is not above 0, or out of its range.
 * JP_ERR_OVERFLOW: a power does not fit. Then *factors is not written.
 */
enum jp_status jp_skid_tariff_factors(const struct jp_skid_steer_config *priced,
                                      const struct jp_skid_energy_model *learned, const struct jp_motion *usual,
                                      uint32_t version, struct jp_tariff_factors *factors);

#ifdef __cplusplus
}
#endif

#endif
