/**
 * Energy of a segment of any length from 0.5 s, whatever motion it starts from.
 *
 * The paper's model (energy.h) takes a segment to start settled and to last until it is settled again. The closed loop
 * is linear, so what an earlier step left behind is a sum of modes, and the motor voltage of an axis is
 *
 *   u(t) = c v + Σ mᵢ(t),   m(T) = Φ(T) (m(0) + j Δ)
 *
 * with Φ diagonal (a real mode decays, a pair of modes oscillates and decays) and j what a step of the reference adds.
 * Real modes whose decays are nearly equal would have huge amplitudes that cancel. They are kept as sums: a mode that
 * is passed on is in its successor, too, as pᵢ of each of its own unit, and Φ has an entry beside its diagonal,
 *
 *   mᵢ₊₁(T) = sᵢ₊₁ mᵢ₊₁ + cᵢ,   cᵢ = pᵢ (cᵢ₋₁ + (sᵢ − sᵢ₊₁) mᵢ),   s = 2^−(decay T)
 *
 * where cᵢ₋₁ is 0 if nothing is passed on to mode i. Each m is a voltage. Energy that is the integral of a quadratic
 * form, such as ∫ u² dt, has a storage function S(m, v) = mᵀ P m + v hᵀ m: what m costs until it has decayed. So
 *
 *   E(T) = E_settled(T) + S(m(0), v) + Σ Δ gᵀ m(0) − S(m(T), v)
 *
 * where E_settled is the paper's formula, also for T < Ts. With m(0) = 0 and T → ∞ it is the paper's model exactly.
 * It holds up to the longest T that a segment may have, 16 384 s: the modes vanish.
 *
 * Modes that have decayed after `duration_min` are left out of m: g holds their cost. The axes are travel (common
 * voltage; step Δv) and yaw (difference; steps Δw and σ). In a pair only its first mode is part of the voltage; the
 * second is a quarter turn behind.
 *
 * A change of direction is two pieces: what the reference rests at v = 0 (reference.h), and what is left of T.
 *
 * Nothing needs m itself: what is written as volts here is, of each mode, in a unit of the table's own, the same for
 * both of a pair. It is 1 V where that fits the formats. J is the unit of the model (energy.h).
 */
#ifndef JOULEPATH_HORIZON_H
#define JOULEPATH_HORIZON_H

#include <stdbool.h>

#include <joulepath/energy.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_AXIS_MODES 9

/** How one mode moves. The two of a pair follow each other: mᵢ' = −λ mᵢ − ω mᵢ₊₁, mᵢ₊₁' = ω mᵢ − λ mᵢ₊₁. */
struct jp_mode {
    jp_q24 decay;     /**< λ/ln 2, halvings a second; above 0 */
    jp_q24 frequency; /**< ω/2π, turn/s, at most 64; above 0 and equal in both modes of a pair; 0: a real mode */
};

/** One axis; what lies beyond `count` is not looked at. Steps are of v in m/s for travel, of w in rad/s and σ in rad
 * for yaw. */
struct jp_axis_modes {
    uint32_t count; /**< modes used, at most JP_AXIS_MODES */
    struct jp_mode mode[JP_AXIS_MODES];
    jp_q16 passed[JP_AXIS_MODES];  /**< p; 0: not passed on; else up to 4 096, and this mode and the next are real */
    jp_q16 step[2][JP_AXIS_MODES]; /**< j, V per unit step: of v or w, and of σ; ±512 */
    int32_t storage[JP_AXIS_MODES * (JP_AXIS_MODES + 1) / 2]; /**< P, J/V² in Q4.28: the upper triangle of
                                                                   count × count by rows, without gaps, what is off the
                                                                   diagonal doubled */
    jp_q16 cross[2][JP_AXIS_MODES];                           /**< g, J/V per unit step; ±4 096 */
    jp_q16 steady[JP_AXIS_MODES];                             /**< h, J/V per m/s or rad/s; ±4 096 */
};

/** One robot under one controller, for one definition of energy; made by tools/design/horizon.py. */
struct jp_horizon {
    jp_q16 duration_min;  /**< shortest segment that the model holds for, s; above 0, at most 60 */
    jp_q16 reversal_rest; /**< at speed 0 between forward and back, as of the reference, s; 0…1 000 */
    struct jp_axis_modes travel;
    struct jp_axis_modes yaw;
};

/** What earlier steps have left, V or the mode's own unit; ±4 096. Zero: settled. */
struct jp_transient {
    jp_q16 travel[JP_AXIS_MODES];
    jp_q16 yaw[JP_AXIS_MODES];
};

/** How a robot moves when a segment begins: the motion commanded before, and what is left of the steps that led there.
 *  Zero: at rest. */
struct jp_energy_start {
    struct jp_motion motion;
    struct jp_transient transient;
    jp_q16 reversal_rest; /**< s until the direction may change; 0…1 000 */
    bool is_forward;      /**< the last speed that was not 0 */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_horizon_check(const struct jp_horizon *horizon, const char **field);

/**
 * Energy in J of a segment that begins at `start`, and in *end how the next one will begin. `end` may be `start`.
 *
 * With a horizon the model holds from horizon->duration_min; without (null) it is jp_energy_predict(): T >= Ts, and
 * *end is settled, and directions change without a rest. `model` and `horizon` must have passed their checks.
 *
 * JP_ERR_ARGUMENT: T too short, a field outside its range, the transient too, or a null pointer; nothing is written.
 * JP_ERR_OVERFLOW: |E| > 32 767 J, or a transient beyond ±4 096 V: what does not fit is saturated.
 * Error against exact arithmetic on the same inputs, for motions within 1 m/s and 1 rad/s and chains of any length: at
 * most 0.002 J with the tables of the robots here; for others 0.01 J + 10⁻⁴ of it, with what rounding a table costs.
 * At most 450 multiplications, 16 sines and one 64-bit division, twice as many where the direction changes; may be
 * called from an ISR.
 */
enum jp_status jp_energy_forecast(const struct jp_energy_model *model, const struct jp_horizon *horizon,
                                  const struct jp_energy_start *start, const struct jp_segment_command *segment,
                                  jp_q16 *energy, struct jp_energy_start *end);

/** Number of parameters of the energy model, each with a regressor: a1…a13, b1, b2. */
#define JP_ENERGY_PARAMETERS (JP_ENERGY_TERMS + 2)

/**
 * The same energy as Σ parameter · regressor + *rest, with regressors in Q16 (units of energy.h inverted) and the rest
 * in J: Ps T and what the transients add, which no parameter changes. The sum is within 2⁻¹⁷ Σ |parameter| + 0.001 J of
 * jp_energy_forecast(). Needs of the model only Ps, cv, cw, Rm and Ts.
 *
 * JP_ERR_ARGUMENT: as jp_energy_forecast(). JP_ERR_OVERFLOW: a regressor or the rest exceeds its format, or a transient
 * ±4 096 V: what does not fit is saturated. May be called from an ISR.
 */
enum jp_status jp_energy_regressors(const struct jp_energy_model *model, const struct jp_horizon *horizon,
                                    const struct jp_energy_start *start, const struct jp_segment_command *segment,
                                    jp_q16 regressor[JP_ENERGY_PARAMETERS], jp_q16 *rest);

#ifdef __cplusplus
}
#endif

#endif
