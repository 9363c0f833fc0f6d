/**
 * State of charge by coulomb counting, and, where the cells are known, by an extended Kalman filter over it.
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
 * With jp_battery_config.cells the bus voltage under load corrects the count once a second. The filter knows, with
 * their covariance, and finds
 *
 *   c  charge, of the nominal capacity         c' = c − (i − o) dt/Q
 *   v  polarisation, V a cell                  v' = a v + (1 − a) s R₁ i
 *   r  resistance by that of the table         r' = r
 *   s  the same of polarisation, R₁            s' = s
 *   e  error of the curve U, V a cell          e' = (1 − |i| dt/(Q L)) e
 *   k  capacity by the nominal one             k' = k
 *   o  what the current sensor is off by       o' = o
 *
 * from the mean voltage of a cell u = U(c/k) + e − v − r R₀(c/k) i, with the curve's errors at charges that are L
 * apart independent. Charges are as the robot's own sensors count them: a
 * current that they read too small makes the capacity as much smaller.
 *
 * All calls come from one context, such as the background loop with what jp_robot_telemetry() copied. None is for the
 * control ISR. Pointers are not checked unless a function says so, and the configuration must have passed its check.
 */
#ifndef JOULEPATH_BATTERY_H
#define JOULEPATH_BATTERY_H

#include <joulepath/energy.h>
#include <joulepath/meter.h>
#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Charge, A·s in Q32.32: step 2.3e-10 A·s. */
typedef int64_t jp_charge;

/** A larger change of the energy between two updates, J, shows that the meter was started anew; it is not counted. */
#define JP_BATTERY_ENERGY_STEP 16384

/** Plausible updates after an implausible voltage until the voltage is believed again. */
#define JP_BATTERY_CONFIRM 3U

/** Points of the curves. */
#define JP_BATTERY_POINTS 21U

/** What a battery's cells are like, and how far single ones are from it; made by tools/design/battery.py. */
struct jp_battery_cells {
    uint32_t series;                        /**< cells; 1…200 */
    jp_q24 charge[JP_BATTERY_POINTS];       /**< of the points below: from 0 to 1, rising */
    jp_q24 open_voltage[JP_BATTERY_POINTS]; /**< U, V a cell; 0.5…10, rising */
    jp_q24 resistance[JP_BATTERY_POINTS];   /**< R₀ by series, with wires and switches, Ω; above 0, at most 1 */
    jp_q24 polarisation;                    /**< R₁ by series, Ω; 0…1 */
    jp_q31 polarisation_keep;               /**< a: what a second leaves of it; 0…1 */
    jp_q24 resistance_deviation;            /**< of r at the first start; 0.001…1 */
    jp_q24 slowness_deviation;              /**< of s; 0.001…1 */
    jp_q24 curve_deviation;                 /**< of e, V; 0…0.5 */
    jp_q24 curve_length;                    /**< L, share of the capacity; 0.001…1 */
    jp_q24 capacity_deviation;              /**< of k; 0.001…0.5 */
    jp_q24 offset_deviation;                /**< of o, capacities an hour; 0…1 */
    jp_q24 charge_walk;                     /**< by which c, */
    jp_q24 resistance_walk;                 /**< r, */
    jp_q24 slowness_walk;                   /**< s, */
    jp_q24 capacity_walk;                   /**< k */
    jp_q24 offset_walk;                     /**< and o wander in an hour, standard deviation; 0…1 */
    jp_q24 voltage_noise;                   /**< of a second's mean against the model, V a cell; 0.005…1 */
    jp_q24 load_noise;                      /**< the same, share of r R₀ i; 0…1 */
    uint32_t identity;                      /**< of the numbers above, not 0: a state of others is invalid */
};

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
    jp_q16 load;              /**< expected mean current of what is forecast, A; 0…1 024 */
    jp_q16 voltage_designed;  /**< bus voltage for which the robot was designed, V; up to 1 000; 0: it is not told */
    uint32_t update_rate;     /**< jp_battery_update() a second; 1…1 000 */
    const struct jp_battery_cells
        *cells;            /**< null: the charge is counted and never corrected; it asks for neither of both */
    int32_t unit_exponent; /**< n: forecasts are in 2ⁿ J, as the robot's energy model; ±JP_ENERGY_UNIT_EXPONENT_MAX */
};

/** Bits of what an update found; 0: nothing wrong. */
enum jp_battery_flag {
    JP_BATTERY_EMPTY = 1 << 0,        /**< the charge is not above the reserve */
    JP_BATTERY_FULL = 1 << 1,         /**< this update's charging reached the capacity; what exceeds it is left out */
    JP_BATTERY_VOLTAGE_LOW = 1 << 2,  /**< below voltage_min; of this and the next two see jp_battery_update() */
    JP_BATTERY_VOLTAGE_HIGH = 1 << 3, /**< above voltage_max */
    JP_BATTERY_VOLTAGE_JUMP = 1 << 4, /**< farther from the last reading than voltage_jump */
    JP_BATTERY_ENERGY_JUMP = 1 << 5,  /**< beyond JP_BATTERY_ENERGY_STEP since the last update: it is left out */
    /** The cells' voltage is more than five deviations from what charge and load let expect, in a second that this
     * update ended: the charge is not corrected. After JP_BATTERY_SURPRISES of them in a row the charge is as uncertain
     * as one that is given. */
    JP_BATTERY_VOLTAGE_UNEXPECTED = 1 << 6
};

/** Unexpected seconds in a row after which the filter doubts its charge. */
#define JP_BATTERY_SURPRISES 30U

/** Numbers that the filter knows, in this order in its covariance. */
enum jp_battery_unknown {
    JP_BATTERY_CHARGE,       /**< c */
    JP_BATTERY_POLARISATION, /**< v, V */
    JP_BATTERY_RESISTANCE,   /**< r */
    JP_BATTERY_SLOWNESS,     /**< s */
    JP_BATTERY_CURVE,        /**< e, V */
    JP_BATTERY_CAPACITY,     /**< k */
    JP_BATTERY_OFFSET,       /**< o, 1/h */
    JP_BATTERY_UNKNOWNS
};

/** Private: what the filter knows beside charge and capacity. */
struct jp_battery_filter {
    int64_t polarisation;                                         /**< v, V in Q48 */
    int64_t resistance;                                           /**< r, Q48 */
    int64_t slowness;                                             /**< s, Q48 */
    int64_t curve;                                                /**< e, V in Q48 */
    int64_t offset;                                               /**< o, 1/h in Q48 */
    int64_t covariance[JP_BATTERY_UNKNOWNS][JP_BATTERY_UNKNOWNS]; /**< Q48, symmetrical */
};

/** What is known of a battery. Persistent: hal/storage/battery_store.h keeps it. */
struct jp_battery_state {
    jp_charge charge;   /**< 0…capacity */
    jp_charge capacity; /**< ¼…2 of the nominal one */
    struct jp_battery_filter filter;
    uint32_t identity; /**< of the jp_battery_cells that it belongs to; 0: of none */
};

/** Private: the second that is being measured. */
struct jp_battery_second {
    int64_t voltage; /**< sum of its readings, V in Q16 */
    jp_charge drawn;
    uint16_t updates; /**< so far */
    bool is_spoilt;   /**< by a voltage or an energy that is not believed */
    uint8_t surprises;
};

/** Private but for the members with a comment. */
struct jp_battery {
    jp_charge charge;  /**< counted and, with cells, corrected; 0…capacity; what to store for the next start */
    uint32_t fraction; /**< of the charge, below one step of it, 2⁻⁶⁴ A·s */
    jp_energy energy;
    jp_charge capacity; /**< of the full battery: as configured or, with cells, as found */
    jp_charge reserve;
    jp_q16 voltage;
    jp_q16 current; /**< mean of the last second, with cells, A; below 0 while it is charged */
    uint8_t doubt;
    uint8_t reason;
    struct jp_battery_filter filter;
    struct jp_battery_second second;
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_battery_check(const struct jp_battery_config *config, const char **field);

/**
 * Continues from a stored charge, at the meter's present energy; with cells, all else is as uncertain as they say.
 * Constant time.
 *
 * JP_ERR_ARGUMENT: the charge is not within 0…capacity, as when it is that of another battery; *battery stays as it
 * was.
 */
enum jp_status jp_battery_start(struct jp_battery *battery, const struct jp_battery_config *config, jp_charge charge,
                                jp_energy energy);

/** What is to be stored, with cells, so that jp_battery_restore() goes on from there. Constant time. */
void jp_battery_save(const struct jp_battery *battery, const struct jp_battery_config *config,
                     struct jp_battery_state *state);

/**
 * Continues from what jp_battery_save() gave, at the meter's present energy; config->cells is not null. The charge
 * becomes less certain by charge_deviation: for what happened meanwhile. Constant time.
 *
 * JP_ERR_CONFIG: *field names what is out of range, or is "identity": the state is that of other cells; *battery stays
 * as it was. JP_ERR_ARGUMENT: a pointer is null.
 */
enum jp_status jp_battery_restore(struct jp_battery *battery, const struct jp_battery_config *config,
                                  const struct jp_battery_state *state, jp_energy energy, const char **field);

/**
 * Estimates the charge from a bus voltage without load, for when none is stored: with cells by their curve, else linear
 * from voltage_empty (0) to voltage_full (capacity); limited to these. Linear it is rough: the curve of a lithium
 * battery is flat in the middle, where the estimate errs by a fifth of the capacity and more. Two 64-bit divisions.
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
 * as many updates. Two 64-bit divisions; with cells, in the last update of each second, the filter's step beside it:
 * tests/bench/FIGURES.md.
 */
uint8_t jp_battery_update(struct jp_battery *battery, const struct jp_battery_config *config, jp_energy energy,
                          jp_q16 bus_voltage);

/** State of charge: charge/capacity, Q31, rounded down; JP_Q31_MAX when full. One 64-bit division. */
jp_q31 jp_battery_level(const struct jp_battery *battery);

/** Standard deviation of the state of charge, Q31: with cells as the filter knows it, else charge_deviation. A square
 *  root and a 64-bit division. */
jp_q31 jp_battery_level_deviation(const struct jp_battery *battery, const struct jp_battery_config *config);

/** Usable energy left, at least 0: (charge − reserve) · voltage_nominal, rounded down; with cells, ∫ U dq from the
 * reserve to the charge less what (r R₀ + s R₁) takes of it at `load`. */
jp_energy jp_battery_energy_left(const struct jp_battery *battery, const struct jp_battery_config *config);

/** The same with its standard deviation, in 2^unit_exponent J, as jp_forecast_reserve() takes it. JP_ERR_OVERFLOW: one
 *  of them is above 32 767 of these, and saturated; where it is the energy, the deviation is the same share of it.
 * JP_ERR_ARGUMENT: a pointer is null. A square root and five 64-bit divisions. */
enum jp_status jp_battery_forecast_left(const struct jp_battery *battery, const struct jp_battery_config *config,
                                        struct jp_forecast *left);

/** A voltage as expected and how sure that is. */
struct jp_battery_voltage {
    jp_q16 voltage;   /**< V */
    jp_q16 deviation; /**< standard deviation, V */
};

/* Headroom: what battery and cells, which must be known, let the bus have. Not for ISRs. */

/** Bus voltage while this current flows, A, as the battery is now: series · (U − v − r R₀ i). What cold and age do is
 * in r, as the filter found it. Two square roots, six 64-bit divisions. */
void jp_battery_voltage_at(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current,
                           struct jp_battery_voltage *expected);

/** Bus voltage that a power, W, leaves until polarisation has settled: V = E/2 + √(E²/4 − R P) with E = series · U and
 *  R = series · (r R₀ + s R₁). JP_ERR_INFEASIBLE: the battery cannot give that much; *voltage is E/2, at which it gives
 *  most. A square root, five 64-bit divisions. */
enum jp_status jp_battery_voltage_under(const struct jp_battery *battery, const struct jp_battery_config *config,
                                        jp_q16 power, jp_q16 *voltage);

/** Greatest power, W, that leaves the bus this voltage, at least 0, saturated: V (E − V)/R, or E²/(4 R) when the
 * voltage is below E/2. Five 64-bit divisions. */
jp_q16 jp_battery_power_at(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 voltage);

/** What the bus has less than the robot was designed for while a power flows, W, at least 0, as pilots take it:
 *  voltage_designed less jp_battery_voltage_under(), or less E/2 where the battery cannot give that much; 0 where it is
 *  not told. Work: that of jp_battery_voltage_under(). */
jp_q16 jp_battery_lacks(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 power);

#ifdef __cplusplus
}
#endif

#endif
