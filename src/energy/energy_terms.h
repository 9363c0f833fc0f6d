/** What the energy model and the segment optimiser share: its terms in 64 bits. Private to the core. */
#ifndef JOULEPATH_ENERGY_ENERGY_TERMS_H
#define JOULEPATH_ENERGY_ENERGY_TERMS_H

#include <joulepath/energy.h>
#include <stdbool.h>

/** Fraction bits of every energy in 64 bits. No term of a model in range exceeds 2³² J. */
#define JP_TERM_BITS 28

/** a·b / 2^shift, 0 < shift < 32, rounded down; the result fits 64 bits. */
int64_t jp_term_scale(int64_t a, int32_t b, unsigned shift);

/** What a steady motion asks of the motors. */
struct jp_steady_voltages {
    int32_t left;  /**< ul₋, V in Q18 */
    int32_t right; /**< ur₋, V in Q18 */
    int64_t power; /**< P₋, W in Q16; saturates at 2²⁰ W */
};

void jp_steady_voltages(const struct jp_energy_model *model, const struct jp_motion *motion,
                        struct jp_steady_voltages *steady);

/** Energy per unit of Δv, Δw and σ that the previous voltages cause: ul₋ a7 + ur₋ a10 and so on. */
struct jp_voltage_terms {
    int64_t speed;     /**< J·s/m in Q28 */
    int64_t turn_rate; /**< J·s/rad in Q28 */
    int64_t turn;      /**< J/rad in Q28 */
    int64_t power;     /**< a13 P₋, J in Q28 */
};

void jp_voltage_terms(const struct jp_energy_model *model, const struct jp_motion *before,
                      struct jp_voltage_terms *terms);

/** Energy of a segment whose arguments are in range, also of one shorter than Ts: JP_OK, or JP_ERR_OVERFLOW with
 * *energy saturated. */
enum jp_status jp_energy_total(const struct jp_energy_model *model, const struct jp_motion *before,
                               const struct jp_voltage_terms *voltage, const struct jp_segment_command *segment,
                               jp_q16 *energy);

/** Both components within the range of struct jp_motion. */
bool jp_motion_in_range(const struct jp_motion *motion);

/** Motion, turn and duration, which is at least duration_min. */
bool jp_segment_in_range(const struct jp_segment_command *segment, jp_q16 duration_min);

#endif
