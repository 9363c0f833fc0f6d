#include <joulepath/meter.h>

#include "src/base/config_check.h"
#include "src/base/multiply_q32.h"

#define FIELD(member, low, high) JP_CONFIG_FIELD("meter.", struct jp_meter_config, member, low, high)

enum jp_status jp_meter_check(const struct jp_meter_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(motor_resistance, JP_Q16(0.01), JP_Q16(256)),
        FIELD(electronics_power, 0, JP_Q16(256)),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    /* Below 64 Ω/s the squares of 1 024 V would not fit. */
    if (status == JP_OK && (int64_t)config->motor_resistance * (int64_t)config->tick_rate < JP_Q16(64)) {
        return jp_config_refuse("meter.motor_resistance", field);
    }
    return status;
}

void jp_meter_start(struct jp_meter *meter, const struct jp_meter_config *config)
{
    int64_t rate = config->tick_rate;
    int64_t resistance_rate = rate * config->motor_resistance;

    *meter = (struct jp_meter){
        .electronics_tick = ((int64_t)config->electronics_power * 65536 + rate / 2) / rate,
        .tick_per_ohm = (((int64_t)1 << 48) + resistance_rate / 2) / resistance_rate,
        .tick = (((int64_t)1 << 32) + rate / 2) / rate,
    };
}

void jp_meter_update(struct jp_meter *meter, const struct jp_voltages *voltages, const struct jp_sensors *sensors)
{
    jp_q16 left = voltages->left;
    jp_q16 right = voltages->right;
    int64_t squares = jp_multiply(left, left) + jp_multiply(right, right);
    int64_t power = jp_multiply(left, sensors->current_left) + jp_multiply(right, sensors->current_right);

    meter->model += multiply_q32(squares, (uint32_t)meter->tick_per_ohm) + meter->electronics_tick;
    meter->battery += multiply_q32(power, (uint32_t)meter->tick) + meter->electronics_tick;
}

jp_q16 jp_energy_to_q16(jp_energy energy, int32_t unit_exponent)
{
    return jp_round_shift(energy, (unsigned)(16 + unit_exponent));
}

jp_energy jp_energy_from_q16(jp_q16 energy, int32_t unit_exponent)
{
    return (jp_energy)energy * ((int64_t)1 << (unsigned)(16 + unit_exponent));
}
