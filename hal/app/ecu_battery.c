#include "hal/app/ecu_battery.h"

#include <joulepath/count.h>
#include <stddef.h>

#define LOAD_MAX JP_Q16(1024)

enum jp_status jp_ecu_battery_init(struct jp_ecu_battery *battery, const struct jp_battery_config *config,
                                   int32_t unit_exponent, const char **field)
{
    if (battery == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *battery = (struct jp_ecu_battery){.config = *config};
    battery->config.unit_exponent = unit_exponent;
    if (config->cells == NULL) {
        *field = "cells";
        return JP_ERR_CONFIG;
    }
    return jp_battery_check(&battery->config, field);
}

/** Motors off: all that flows is what the electronics take. */
static void begin(struct jp_ecu_battery *battery, const struct jp_ecu_supply *supply, uint32_t tick)
{
    jp_charge charge;

    if (jp_battery_estimate(&battery->config, supply->voltage, &charge) == JP_OK &&
        jp_battery_start(&battery->battery, &battery->config, charge, supply->drawn) == JP_OK) {
        battery->has_started = true;
        battery->origin = supply->drawn;
        battery->before = supply->drawn;
        battery->tick = tick;
    }
}

/** What is forecast is expected to take the current that was taken so far. */
static void expect_load(struct jp_ecu_battery *battery)
{
    const jp_energy drawn = battery->drawn - battery->origin;
    const jp_energy a_second = drawn / (int64_t)battery->updates * (int64_t)battery->config.update_rate;

    battery->config.load = jp_clamp32(jp_divide(a_second, battery->config.voltage_nominal), 0, LOAD_MAX);
}

static void note_power(struct jp_ecu_battery *battery)
{
    const jp_q16 power = jp_energy_to_q16((battery->drawn - battery->before) * (int64_t)battery->config.update_rate, 0);

    battery->before = battery->drawn;
    battery->power = power > battery->power ? power : battery->power;
}

static void update(struct jp_ecu_battery *battery)
{
    const jp_q16 voltage = (jp_q16)(battery->voltage / (int64_t)battery->samples);

    (void)jp_battery_update(&battery->battery, &battery->config, battery->drawn, voltage);
    battery->voltage = 0;
    battery->samples = 0;
    battery->updates = jp_one_more32(battery->updates);
    expect_load(battery);
    note_power(battery);
}

bool jp_ecu_battery_pass(struct jp_ecu_battery *battery, const struct jp_ecu_supply *supply, uint32_t tick,
                         uint32_t tick_rate)
{
    const uint32_t period = tick_rate / battery->config.update_rate;

    battery->drawn = supply->drawn;
    if (!battery->has_started) {
        begin(battery, supply, tick);
        return false;
    }
    battery->voltage += supply->voltage;
    battery->samples++;
    if (tick - battery->tick < period) {
        return false;
    }
    /* A slice that took longer does not slow the battery's clock. */
    battery->tick = tick - battery->tick < 2U * period ? battery->tick + period : tick;
    update(battery);
    return true;
}

jp_q16 jp_ecu_battery_lacks(const struct jp_ecu_battery *battery, const struct jp_ecu_supply *supply)
{
    const jp_q16 power = supply->cruise > battery->power ? supply->cruise : battery->power;

    return jp_battery_lacks(&battery->battery, &battery->config, power);
}

bool jp_ecu_battery_left(void *battery, struct jp_forecast *left)
{
    const struct jp_ecu_battery *const self = battery;

    if (self->has_started) {
        (void)jp_battery_forecast_left(&self->battery, &self->config, left);
    }
    return self->has_started;
}

jp_q16 jp_ecu_battery_given(void *battery)
{
    const struct jp_ecu_battery *const self = battery;

    return jp_energy_to_wrapping_q16(self->drawn - self->origin, self->config.unit_exponent);
}

void jp_ecu_battery_tell(const struct jp_ecu_battery *battery, jp_energy *left, jp_energy *deviation)
{
    struct jp_battery_config config = battery->config;
    struct jp_forecast forecast = {0, 0};

    if (battery->has_started) {
        while (jp_battery_forecast_left(&battery->battery, &config, &forecast) == JP_ERR_OVERFLOW &&
               config.unit_exponent < JP_ENERGY_UNIT_EXPONENT_MAX) {
            config.unit_exponent++;
        }
    }
    *left = jp_energy_from_q16(forecast.energy, config.unit_exponent);
    *deviation = jp_energy_from_q16(forecast.deviation, config.unit_exponent);
}
