/**
 * The energy that the robot spends, by both definitions:
 *
 *   model   = ∫ (ul² + ur²)/Rm + Ps dt   (paper eq. 10 and 18)
 *   battery = ∫ ul il + ur ir + Ps dt    (what leaves the battery; negative power is recuperation)
 */
#ifndef JOULEPATH_METER_H
#define JOULEPATH_METER_H

#include <joulepath/sensors.h>
#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Energy, J in Q32.32: ±2.1 GJ, step 2.3e-10 J. */
typedef int64_t jp_energy;

struct jp_meter_config {
    uint32_t tick_rate;       /**< calls a second; 100…10 000 */
    jp_q16 motor_resistance;  /**< Rm, Ω; at least 0.01, Rm · tick_rate 2…81 920 000 Ω/s */
    jp_q16 electronics_power; /**< Ps, W; 0…256 */
};

struct jp_meter {
    jp_energy model;
    jp_energy battery;
    jp_energy electronics_tick; /**< Ps for one tick */
    uint32_t tick_per_ohm;      /**< 1/(Rm · tick_rate), 2^−(32 + shift) s/Ω */
    uint32_t shift;             /**< above 0 for a great Rm · tick_rate, so that tick_per_ohm keeps its digits */
    uint32_t half;              /**< of 2^shift, rounded down */
    uint32_t tick;              /**< 1/tick_rate, 2⁻³² s */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_meter_check(const struct jp_meter_config *config, const char **field);

/** Starts both sums at 0. The configuration must have passed its check. */
void jp_meter_start(struct jp_meter *meter, const struct jp_meter_config *config);

/** One tick at these motor voltages and at the currents of `sensors`. |u| <= 1 024 V, |i| <= 1 024 A.
 *  Each sum is within 1e-6 of the exact one, or 3e-6 W. Constant time; for the control ISR. */
void jp_meter_update(struct jp_meter *meter, const struct jp_voltages *voltages, const struct jp_sensors *sensors);

/** The same for `battery` alone. */
void jp_meter_update_battery(struct jp_meter *meter, const struct jp_voltages *voltages,
                             const struct jp_sensors *sensors);

/**
 * Bridges that burn a share of what their motors generate, (Rm i − u) i: less goes back to the battery, but none leaves
 * it for a motor that brakes. Adds what was burnt in two ticks to `battery`, after an update with the same;
 * within 1e-4 of it, or 1e-4 W. `share`: 0…1. Constant time for motors that drive and for those that brake; for the
 * control ISR.
 */
void jp_meter_burn(struct jp_meter *meter, jp_q16 motor_resistance, jp_q16 share, const struct jp_voltages *voltages,
                   const struct jp_sensors *sensors);

/** Energy in the unit of a model, 2^unit_exponent J with ±JP_ENERGY_UNIT_EXPONENT_MAX (energy.h), as Q16.16, rounded
 * and saturated; 0: in J. Constant time; any context. */
jp_q16 jp_energy_to_q16(jp_energy energy, int32_t unit_exponent);

/** The same without the digits that do not fit, which counts on where that overflows: differences hold. Constant time;
 *  any context. */
jp_q16 jp_energy_to_wrapping_q16(jp_energy energy, int32_t unit_exponent);

/** The other way, exact. Constant time; any context. */
jp_energy jp_energy_from_q16(jp_q16 energy, int32_t unit_exponent);

#ifdef __cplusplus
}
#endif

#endif
