/** The extended Kalman filter of a battery: include/joulepath/battery.h states its equations. Private to the core. */
#ifndef JOULEPATH_ENERGY_BATTERY_FILTER_H
#define JOULEPATH_ENERGY_BATTERY_FILTER_H

#include <joulepath/battery.h>

/** a·b / 2²⁴, rounded down. */
static inline int64_t jp_scaled(int64_t a, jp_q24 b)
{
    const int64_t low = (int64_t)(uint32_t)a * b;

    return (a >> 32) * b * 256 + (low >> 24);
}

/** Of a cell at a charge. */
struct jp_cell_point {
    jp_q24 open_voltage; /**< V */
    jp_q24 slope;        /**< of it over the charge, V */
    jp_q24 resistance;   /**< Ω, before r */
};

/** Beyond the ends of the charge as at the end, with its slope. */
struct jp_cell_point jp_cell_at(const struct jp_battery_cells *cells, jp_q24 charge);

/** The charge at which a cell has this voltage without load, Q24; limited to 0…1. */
jp_q24 jp_cell_charge(const struct jp_battery_cells *cells, jp_q24 open_voltage);

/** c/k, Q24. */
jp_q24 jp_battery_share(const struct jp_battery *battery);

/** r R₀ + s R₁ of a cell whose R₀ this is, Ω. */
jp_q24 jp_battery_resistance(const struct jp_battery *battery, const struct jp_battery_cells *cells, jp_q24 resistance);

/** A variance of Q48 as deviation, Q24. */
jp_q24 jp_battery_deviation(int64_t variance);

/** Σ gᵢ Pᵢⱼ gⱼ of a gradient in Q24: Q48, at least 0. */
int64_t jp_battery_variance(const struct jp_battery_filter *filter, const jp_q24 gradient[JP_BATTERY_UNKNOWNS]);

/** A voltage as the filter expects it, and how. */
struct jp_battery_expectation {
    jp_q24 voltage; /**< V a cell */
    jp_q24 gradient[JP_BATTERY_UNKNOWNS];
    int64_t noise; /**< variance, V² in Q48 */
};

/** While this current flows, A. */
void jp_battery_expect(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current,
                       struct jp_battery_expectation *expected);

/** Nothing is known but the charge. */
void jp_battery_filter_start(struct jp_battery *battery, const struct jp_battery_config *config);

/** The charge is as uncertain as one that is given, beside what it was. */
void jp_battery_filter_doubt(struct jp_battery *battery, const struct jp_battery_config *config);

/** A second with this mean current, A, in which the charge was counted, and, unless it is spoilt, the mean voltage of a
 *  cell, V. Returns JP_BATTERY_VOLTAGE_UNEXPECTED or 0. */
uint8_t jp_battery_filter_second(struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current,
                                 jp_q24 cell_voltage, bool is_spoilt);

/** Failures as jp_battery_check(). */
enum jp_status jp_battery_cells_check(const struct jp_battery_cells *cells, const char **field);

/** Failures as jp_battery_restore(), but for the identity. */
enum jp_status jp_battery_state_check(const struct jp_battery_state *state, const struct jp_battery_config *config,
                                      const char **field);

#endif
