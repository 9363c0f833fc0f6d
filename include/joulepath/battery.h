/**
 * State of charge by coulomb counting.
 *
 * The charge that leaves the battery is ∫ P/V dt, of the energy that jp_meter.battery sums (which has the electronics
 * in it) and of the bus voltage:
 *
 *   charge −= ΔE/V          drawn
 *   charge += η |ΔE|/V      recuperated, with the coulombic efficiency η of charging
 *
 * computed once per update from the energy since the last one. The voltage should not change much between updates: 10 a
 * second or more are enough. Remainders are carried: after n updates the count is within n · 2⁻⁶⁴ A·s of the exact sum.
 *
 * All calls come from one context, such as the background loop with what jp_robot_telemetry() copied. None is for the
 * control ISR. Pointers are not checked unless a function says so, and the configuration must have passed its check.
 */
#ifndef JOULEPATH_BATTERY_H
#define JOULEPATH_BATTERY_H

#include <joulepath/forecast.h>
#include <joulepath/meter.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Charge, A·s in Q32.32: step 2.3e-10 A·s. */
typedef int64_t jp_charge;

/** A larger change of the energy between two updates, J, shows that the meter was started anew; it is not counted. */
#define JP_BATTERY_ENERGY_STEP 16384

/** Plausible updates after an implausible voltage until the voltage is believed again. */
#define JP_BATTERY_CONFIRM 3U

struct jp_battery_config {
    uint32_t capacity;        /**< charge of the full battery, A·s; 60…262 144 (72.8 Ah) */
    jp_q16 voltage_empty;     /**< open circuit at charge 0, V; from voltage_min */
    jp_q16 voltage_nominal;   /**< mean over a discharge, V; voltage_empty…voltage_full */
    jp_q16 voltage_full;      /**< open circuit at full charge, V; above voltage_empty, up to voltage_max */
    jp_q16 voltage_min;       /**< a bus voltage below is implausible, V; from 1 */
    jp_q16 voltage_max;       /**< a bus voltage above is implausible, V; up to 1 000 */
    jp_q16 voltage_jump;      /**< a larger change from one update to the next is implausible, V; above 0 */
    jp_q16 charge_efficiency; /**< η; 0.5…1 */
    jp_q31 reserve;           /**< share of the capacity that is not to be used; 0…0.5 */
    jp_q31 charge_deviation;  /**< standard deviation of a charge that is given, share of the capacity; 0…0.5 */
    int32_t unit_exponent; /**< n: forecasts are in 2ⁿ J, as the robot's energy model; ±JP_ENERGY_UNIT_EXPONENT_MAX */
};

/** Bits of what an update found; 0: nothing wrong. */
enum jp_battery_flag {
    JP_BATTERY_EMPTY = 1 << 0,        /**< the charge is not above the reserve */
    JP_BATTERY_FULL = 1 << 1,         /**< this update's charging reached the capacity; what exceeds it is left out */
    JP_BATTERY_VOLTAGE_LOW = 1 << 2,  /**< below voltage_min; of this and the next two see jp_battery_update() */
    JP_BATTERY_VOLTAGE_HIGH = 1 << 3, /**< above voltage_max */
    JP_BATTERY_VOLTAGE_JUMP = 1 << 4, /**< farther from the last reading than voltage_jump */
    JP_BATTERY_ENERGY_JUMP = 1 << 5   /**< beyond JP_BATTERY_ENERGY_STEP since the last update: it is left out */
};

struct jp_battery {
    jp_charge charge;  /**< counted, 0…capacity; what to store for the next start */
    uint32_t fraction; /**< below one step of the charge, 2⁻⁶⁴ A·s */
    jp_energy energy;  /**< of the meter, counted so far */
    jp_charge capacity;
    jp_charge reserve;
    jp_q16 voltage; /**< last reading; 0: none */
    uint8_t doubt;  /**< updates until a voltage is believed again */
    uint8_t reason; /**< of the doubt, jp_battery_flag */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_battery_check(const struct jp_battery_config *config, const char **field);

/**
 * Continues from a stored charge, at the meter's present energy. Constant time.
 *
 * JP_ERR_ARGUMENT: the charge is not within 0…capacity, as when it is that of another battery; *battery stays as it
 * was.
 */
enum jp_status jp_battery_start(struct jp_battery *battery, const struct jp_battery_config *config, jp_charge charge,
                                jp_energy energy);

/**
 * Estimates the charge from a bus voltage without load, for when none is stored: linear from voltage_empty (0) to
 * voltage_full (capacity), limited to these. It is rough: the curve of a lithium battery is flat in the middle, where
 * the estimate errs by a fifth of the capacity and more. Two 64-bit divisions.
 *
 * JP_ERR_ARGUMENT: the voltage is outside voltage_min…voltage_max; *charge is not written.
 */
enum jp_status jp_battery_estimate(const struct jp_battery_config *config, jp_q16 open_circuit_voltage,
                                   jp_charge *charge);

/**
 * Counts the energy since the last update, `energy` being jp_meter.battery, at this bus voltage. Returns
 * jp_battery_flag bits.
 *
 * While a voltage is implausible, and for JP_BATTERY_CONFIRM updates after it, the charge stays as it is; the energy of
 * that time is counted at the first voltage that is believed again. A new level of the voltage is thus believed after
 * as many updates. Two 64-bit divisions.
 */
uint8_t jp_battery_update(struct jp_battery *battery, const struct jp_battery_config *config, jp_energy energy,
                          jp_q16 bus_voltage);

/** State of charge: charge/capacity, Q31, rounded down; JP_Q31_MAX when full. One 64-bit division. */
jp_q31 jp_battery_level(const struct jp_battery *battery);

/** Usable energy left: (charge − reserve) · voltage_nominal, rounded down; at least 0. Constant time. */
jp_energy jp_battery_energy_left(const struct jp_battery *battery, const struct jp_battery_config *config);

/** The same with its standard deviation, in 2^unit_exponent J, as jp_forecast_reserve() takes it. JP_ERR_OVERFLOW: one
 *  of them is above 32 767 of these, and saturated. JP_ERR_ARGUMENT: a pointer is null. Constant time. */
enum jp_status jp_battery_forecast_left(const struct jp_battery *battery, const struct jp_battery_config *config,
                                        struct jp_forecast *left);

#ifdef __cplusplus
}
#endif

#endif
