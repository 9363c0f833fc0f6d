#include <joulepath/battery.h>

#include <stdbool.h>

#include "src/base/config_check.h"
#include "src/energy/battery_left.h"

#define ENERGY_STEP ((int64_t)JP_BATTERY_ENERGY_STEP << 32)

#define UPDATE_RATE_MOST 1000U

struct quotient {
    int64_t whole;
    uint32_t fraction; /**< 2⁻³² of one, rounded down */
};

#define FIELD(member, low, high) JP_CONFIG_FIELD("battery.", struct jp_battery_config, member, low, high)

static enum jp_status check_filter(const struct jp_battery_config *config, const char **field)
{
    if (config->update_rate < 1U || config->update_rate > UPDATE_RATE_MOST) {
        return jp_config_refuse("battery.update_rate", field);
    }
    return jp_battery_cells_check(config->cells, field);
}

enum jp_status jp_battery_check(const struct jp_battery_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(capacity, 60, 262144),
        FIELD(charge_efficiency, JP_Q16(0.5), JP_Q16_ONE),
        FIELD(reserve, 0, (jp_q31)1 << 30),
        FIELD(charge_deviation, 0, (jp_q31)1 << 30),
        FIELD(load, 0, JP_Q16(1024)),
        FIELD(voltage_designed, 0, JP_Q16(1000)),
        FIELD(unit_exponent, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX),
        FIELD(voltage_min, JP_Q16_ONE, INT32_MAX),
        FIELD(voltage_max, INT32_MIN, JP_Q16(1000)),
        FIELD(voltage_jump, 1, INT32_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (config->voltage_empty < config->voltage_min) {
        return jp_config_refuse("battery.voltage_empty", field);
    }
    if (config->voltage_full <= config->voltage_empty || config->voltage_full > config->voltage_max) {
        return jp_config_refuse("battery.voltage_full", field);
    }
    if (config->voltage_nominal < config->voltage_empty || config->voltage_nominal > config->voltage_full) {
        return jp_config_refuse("battery.voltage_nominal", field);
    }
    return config->cells == NULL ? JP_OK : check_filter(config, field);
}

/** The dividend is below 2⁶³, the divisor above 0. */
static struct quotient divide(uint64_t dividend, uint32_t divisor)
{
    const uint64_t whole = dividend / divisor;
    const uint64_t fraction = ((dividend % divisor) << 32) / divisor;

    return (struct quotient){(int64_t)whole, (uint32_t)fraction};
}

enum jp_status jp_battery_start(struct jp_battery *battery, const struct jp_battery_config *config, jp_charge charge,
                                jp_energy energy)
{
    const jp_charge capacity = (jp_charge)config->capacity << 32;

    if (charge < 0 || charge > capacity) {
        return JP_ERR_ARGUMENT;
    }
    *battery = (struct jp_battery){
        .charge = charge,
        .energy = energy,
        .capacity = capacity,
        .reserve = (jp_charge)config->capacity * config->reserve * 2,
    };
    if (config->cells != NULL) {
        jp_battery_filter_start(battery, config);
    }
    return JP_OK;
}

void jp_battery_save(const struct jp_battery *battery, const struct jp_battery_config *config,
                     struct jp_battery_state *state)
{
    *state = (struct jp_battery_state){battery->charge, battery->capacity, battery->filter, config->cells->identity};
}

enum jp_status jp_battery_restore(struct jp_battery *battery, const struct jp_battery_config *config,
                                  const struct jp_battery_state *state, jp_energy energy, const char **field)
{
    if (battery == NULL || config == NULL || state == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (state->identity != config->cells->identity) {
        return jp_config_refuse("identity", field);
    }

    const enum jp_status status = jp_battery_state_check(state, config, field);

    if (status != JP_OK) {
        return status;
    }
    *battery = (struct jp_battery){
        .charge = state->charge,
        .energy = energy,
        .capacity = state->capacity,
        .reserve = (state->capacity >> 31) * config->reserve,
        .filter = state->filter,
    };
    jp_battery_filter_doubt(battery, config);
    *field = NULL;
    return JP_OK;
}

static jp_charge estimate_of_cells(const struct jp_battery_config *config, jp_q16 voltage)
{
    const jp_q24 of_one = jp_divide((int64_t)voltage * 256, (int32_t)config->cells->series);

    return (jp_charge)config->capacity * jp_cell_charge(config->cells, of_one) * 256;
}

enum jp_status jp_battery_estimate(const struct jp_battery_config *config, jp_q16 open_circuit_voltage,
                                   jp_charge *charge)
{
    if (open_circuit_voltage < config->voltage_min || open_circuit_voltage > config->voltage_max) {
        return JP_ERR_ARGUMENT;
    }

    if (config->cells != NULL) {
        *charge = estimate_of_cells(config, open_circuit_voltage);
        return JP_OK;
    }

    const uint32_t span = (uint32_t)(config->voltage_full - config->voltage_empty);
    const jp_q16 within = jp_clamp32(open_circuit_voltage, config->voltage_empty, config->voltage_full);
    const struct quotient part = divide((uint64_t)config->capacity * (uint32_t)(within - config->voltage_empty), span);

    *charge = part.whole * ((jp_charge)1 << 32) + (jp_charge)part.fraction;
    return JP_OK;
}

/** Flags of an implausible voltage, held until it has been confirmed; 0: plausible. */
static uint8_t doubt_of(struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 voltage)
{
    const jp_q16 change = jp_sub(voltage, battery->voltage);
    uint32_t reason = 0;

    if (voltage < config->voltage_min) {
        reason |= (uint32_t)JP_BATTERY_VOLTAGE_LOW;
    }
    if (voltage > config->voltage_max) {
        reason |= (uint32_t)JP_BATTERY_VOLTAGE_HIGH;
    }
    if (battery->voltage != 0 && (change > config->voltage_jump || change < -config->voltage_jump)) {
        reason |= (uint32_t)JP_BATTERY_VOLTAGE_JUMP;
    }
    battery->voltage = voltage;
    if (reason != 0U) {
        battery->doubt = JP_BATTERY_CONFIRM;
        battery->reason = (uint8_t)reason;
        return battery->reason;
    }
    if (battery->doubt == 0U) {
        return 0;
    }
    battery->doubt--;
    return battery->reason;
}

static void draw(struct jp_battery *battery, const struct quotient *charge)
{
    const jp_charge borrow = battery->fraction < charge->fraction ? 1 : 0;

    battery->charge -= charge->whole + borrow;
    battery->second.drawn += charge->whole;
    battery->fraction -= charge->fraction;
    if (battery->charge < 0) {
        battery->charge = 0;
        battery->fraction = 0;
    }
}

/** Adds charge. Returns JP_BATTERY_FULL or 0. */
static uint32_t recuperate(struct jp_battery *battery, const struct quotient *charge)
{
    const uint64_t fraction = (uint64_t)battery->fraction + charge->fraction;
    const uint64_t carry = fraction >> 32;

    battery->charge += charge->whole + (jp_charge)carry;
    battery->second.drawn -= charge->whole;
    battery->fraction = (uint32_t)fraction;
    if (battery->charge < battery->capacity) {
        return 0;
    }
    battery->charge = battery->capacity;
    battery->fraction = 0;
    return (uint32_t)JP_BATTERY_FULL;
}

/** Counts the energy since the last update. Returns jp_battery_flag bits. */
static uint32_t count(struct jp_battery *battery, const struct jp_battery_config *config, jp_energy energy)
{
    const int64_t drawn = (int64_t)((uint64_t)energy - (uint64_t)battery->energy);
    const uint32_t voltage = (uint32_t)battery->voltage;

    battery->energy = energy;
    if (drawn > ENERGY_STEP || drawn < -ENERGY_STEP) {
        return (uint32_t)JP_BATTERY_ENERGY_JUMP;
    }
    if (drawn < 0) {
        const int64_t regained = -drawn;
        const struct quotient charge = divide((uint64_t)regained * (uint32_t)config->charge_efficiency, voltage);

        return recuperate(battery, &charge);
    }

    const struct quotient charge = divide((uint64_t)drawn << 16, voltage);

    draw(battery, &charge);
    return 0;
}

/** An update more of the present second; at its end the filter corrects the charge. Returns jp_battery_flag bits. */
static uint32_t measure(struct jp_battery *battery, const struct jp_battery_config *config, bool is_believed)
{
    struct jp_battery_second *const second = &battery->second;

    second->voltage += battery->voltage;
    second->updates++;
    second->is_spoilt = second->is_spoilt || !is_believed;
    if (second->updates < config->update_rate) {
        return 0;
    }

    const uint8_t surprises = second->surprises;
    const bool is_spoilt = second->is_spoilt;
    const int64_t readings = (int64_t)config->update_rate * (int64_t)config->cells->series;
    const jp_q24 of_one = jp_divide(second->voltage * 256, (int32_t)readings);

    battery->current = jp_saturate32(second->drawn >> 16);
    *second = (struct jp_battery_second){.surprises = surprises};
    return jp_battery_filter_second(battery, config, battery->current, of_one, is_spoilt);
}

uint8_t jp_battery_update(struct jp_battery *battery, const struct jp_battery_config *config, jp_energy energy,
                          jp_q16 bus_voltage)
{
    uint32_t flags = doubt_of(battery, config, bus_voltage);

    if (flags == 0U) {
        flags = count(battery, config, energy);
    }
    if (config->cells != NULL) {
        flags |= measure(battery, config, (flags & ~(uint32_t)JP_BATTERY_FULL) == 0U);
    } else {
        battery->second.drawn = 0;
    }
    if (battery->charge <= battery->reserve) {
        flags |= (uint32_t)JP_BATTERY_EMPTY;
    }
    return (uint8_t)flags;
}

jp_q31 jp_battery_level(const struct jp_battery *battery)
{
    return jp_saturate32((battery->charge >> 1) / (battery->capacity >> 32));
}

jp_q31 jp_battery_level_deviation(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    if (config->cells == NULL) {
        return config->charge_deviation;
    }

    const jp_q24 gradient[JP_BATTERY_UNKNOWNS] = {
        [JP_BATTERY_CHARGE] = JP_Q24_ONE,
        [JP_BATTERY_CAPACITY] = -jp_battery_share(battery),
    };
    const jp_q24 of_nominal = jp_battery_deviation(jp_battery_variance(&battery->filter, gradient));
    const int64_t share = (int64_t)of_nominal * (int32_t)config->capacity * 128;

    return jp_divide(share, (int32_t)(battery->capacity >> 32));
}

/** Of a charge above 0 at the nominal voltage. */
static jp_energy energy_of(jp_charge charge, const struct jp_battery_config *config)
{
    const int64_t low = (int64_t)(uint16_t)charge * config->voltage_nominal;

    return (charge >> 16) * config->voltage_nominal + (low >> 16);
}

jp_energy jp_battery_energy_left(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const jp_charge usable = battery->charge - battery->reserve;

    if (config->cells != NULL) {
        return jp_battery_cells_energy(battery, config);
    }
    return usable < 0 ? 0 : energy_of(usable, config);
}

static jp_energy deviation_left(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    if (config->cells != NULL) {
        return jp_battery_cells_deviation(battery, config);
    }
    return energy_of((jp_charge)config->capacity * config->charge_deviation * 2, config);
}

/** Returns whether it fits. */
static bool narrow(jp_energy energy, const struct jp_battery_config *config, jp_q16 *narrowed)
{
    *narrowed = jp_energy_to_q16(energy, config->unit_exponent);
    return *narrowed < INT32_MAX;
}

/** Of as much more than fits: the same share of what fits. */
static jp_q16 share_of_most(jp_energy energy, jp_energy deviation)
{
    jp_energy whole = energy;
    jp_energy part = deviation;

    while (((uint64_t)whole | (uint64_t)part) > (uint64_t)INT32_MAX) {
        whole /= 2;
        part /= 2;
    }
    return jp_saturate32(part * INT32_MAX / whole);
}

enum jp_status jp_battery_forecast_left(const struct jp_battery *battery, const struct jp_battery_config *config,
                                        struct jp_forecast *left)
{
    if (battery == NULL || config == NULL || left == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const jp_energy energy = jp_battery_energy_left(battery, config);
    const jp_energy deviation = deviation_left(battery, config);
    const bool energy_fits = narrow(energy, config, &left->energy);
    const bool deviation_fits = narrow(deviation, config, &left->deviation);

    if (!energy_fits) {
        left->deviation = share_of_most(energy, deviation);
    }
    return energy_fits && deviation_fits ? JP_OK : JP_ERR_OVERFLOW;
}
