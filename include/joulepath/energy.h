/**
 * Energy of one segment of constant speed and turn rate (paper eq. 12–19).
 *
 * A segment starts with a step of the reference, Δr = [Δv, Δw, σ], from a settled motion (v₋, w₋) whose
 * steady motor voltages are ul₋, ur₋:
 *
 *   E_state = [Δv², Δw², σ², ΔvΔw, Δvσ, Δwσ, ul₋Δv, ul₋Δw, ul₋σ, ur₋Δv, ur₋Δw, ur₋σ, P₋] · a
 *   E_fri   = [v², w²] · b · (T − Ts)
 *   E_other = Ps T
 *
 * with P₋ = (ul₋² + ur₋²)/Rm, ul₋ = cv v₋ − cw w₋ and ur₋ = cv v₋ + cw w₋.
 * The model holds for T >= Ts and a settled start.
 *
 * A robot of 100 kg spends a million times what one of 0.3 kg does. So each model has its own unit of energy, 2ⁿ J with
 * n its `unit_exponent`, and every energy of this library in Q16 is in the unit of the robot's model: here "J" stands
 * for that unit wherever a jp_q16 holds an energy, "W" for one such unit a second, and a motor's resistance is written
 * in Ω · 2ⁿ, so that V²/Rm has the model's unit. The meter counts joules (meter.h), and people and buses read joules:
 * jp_energy_to_q16() and jp_energy_from_q16() stand where the two meet. The arithmetic is the same in each unit.
 */
#ifndef JOULEPATH_ENERGY_H
#define JOULEPATH_ENERGY_H

#include <joulepath/fixed.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_ENERGY_TERMS 13

/** Greatest n of a unit of 2ⁿ J, and least with a minus. */
#define JP_ENERGY_UNIT_EXPONENT_MAX 15

/** Parameters of one robot under one controller; made by tools/design/identify.py. */
struct jp_energy_model {
    jp_q16 a[JP_ENERGY_TERMS];    /**< a1…a13: J per product of m/s, rad/s, rad and V; a13 in s; |a| <= 4 096 */
    jp_q16 b[2];                  /**< b1 J·s/m², b2 J·s/rad²; 0…4 096 */
    jp_q16 electronics_power;     /**< Ps, with what noise of sensors makes the motors take, W; above 0,
                                       at most 4 096 */
    jp_q16 settling_time;         /**< Ts, s; 0…60 */
    jp_q16 voltage_per_speed;     /**< cv, V·s/m; 0…256 */
    jp_q16 voltage_per_turn_rate; /**< cw, V·s/rad; 0…256 */
    jp_q16 motor_resistance;      /**< Rm, Ω · 2ⁿ; above 0 */
    int32_t unit_exponent;        /**< n: energies of this robot in Q16 are in 2ⁿ J; ±JP_ENERGY_UNIT_EXPONENT_MAX */
};

/** A motion at constant speed and turn rate. */
struct jp_motion {
    jp_q24 speed;               /**< v, m/s; |v| <= 8 */
    jp_radians_per_s turn_rate; /**< w, rad/s; |w| <= 8 */
};

/** One segment as the reference sees it: a step to (v, w), the heading turned by σ, held for T. */
struct jp_segment_command {
    struct jp_motion motion;
    jp_q24 turn;     /**< σ, rad; |σ| <= 2π */
    jp_q16 duration; /**< T, s; 0…16 384 */
};

#define JP_LEG_TRANSIENTS 3U

/**
 * What a leg of a trajectory takes (trajectory_energy.h). `transient`: what its blends take beside the steady motion,
 * J, part of the energy: of the voltage u that changes the speed, with the steady us, 4/Rm ∫ us u dt and 2/Rm ∫ u² dt;
 * of that which changes the turn rate the former.
 */
struct jp_leg_energy {
    jp_q16 energy;   /**< as built in, electronics included, J */
    jp_q16 duration; /**< s */
    jp_q16 travel;   /**< ∫ v² dt, m²/s: b1's share */
    jp_q16 turning;  /**< ∫ w² dt, rad²/s: b2's */
    jp_q16 transient[JP_LEG_TRANSIENTS];
};

/** An energy that is not known exactly: what a drive will take, what a battery still has. In 2^unit_exponent J. */
struct jp_forecast {
    jp_q16 energy;    /**< expected, J */
    jp_q16 deviation; /**< standard deviation, J */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null.
 *  Not for ISRs. */
enum jp_status jp_energy_model_check(const struct jp_energy_model *model, const char **field);

/**
 * Energy in J of a segment after the settled motion `before` (eq. 19).
 *
 * JP_ERR_ARGUMENT: T < Ts, a field outside its range, or a null pointer; *energy is not written.
 * JP_ERR_OVERFLOW: |E| > 32 767 J; *energy is saturated.
 * Error against exact arithmetic on the same inputs: at most 0.001 J for motions within 1 m/s and 1 rad/s.
 * P₋ saturates at 2²⁰ W. About 50 multiplications and one 64-bit division; may be called from an ISR.
 */
enum jp_status jp_energy_predict(const struct jp_energy_model *model, const struct jp_motion *before,
                                 const struct jp_segment_command *segment, jp_q16 *energy);

#ifdef __cplusplus
}
#endif

#endif
