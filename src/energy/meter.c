#include <joulepath/meter.h>

#include "src/base/config_check.h"
#include "src/base/multiply_q32.h"

/** Rm · tick_rate, Ω/s in Q16: below it a tick's conductance does not fit 32 bits, above it its inverse not 64. */
#define RESISTANCE_RATE_MIN ((int64_t)JP_Q16(2))
#define RESISTANCE_RATE_MAX ((int64_t)JP_Q16(8192) * 10000)

/** Least conductance of a tick in its own unit, so that rounding it is an error below 1e-6. */
#define CONDUCTANCE_MIN ((int64_t)1 << 19)

#define FIELD(member, low, high) JP_CONFIG_FIELD("meter.", struct jp_meter_config, member, low, high)

enum jp_status jp_meter_check(const struct jp_meter_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(motor_resistance, JP_Q16(0.01), INT32_MAX),
        FIELD(electronics_power, 0, JP_Q16(256)),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }

    const int64_t resistance_rate = (int64_t)config->motor_resistance * (int64_t)config->tick_rate;

    if (resistance_rate < RESISTANCE_RATE_MIN || resistance_rate > RESISTANCE_RATE_MAX) {
        return jp_config_refuse("meter.motor_resistance", field);
    }
    return JP_OK;
}

/** a/b, rounded, of numbers above 0. */
static int64_t divided(int64_t a, int64_t b)
{
    return (a + b / 2) / b;
}

void jp_meter_start(struct jp_meter *meter, const struct jp_meter_config *config)
{
    int64_t rate = config->tick_rate;
    int64_t resistance_rate = rate * config->motor_resistance; /* below 2⁴³ */
    unsigned shift = 0;

    while (divided((int64_t)1 << (48U + shift), resistance_rate) < CONDUCTANCE_MIN) {
        shift++;
    }

    *meter = (struct jp_meter){
        .electronics_tick = divided((int64_t)config->electronics_power * 65536, rate),
        .shift = shift,
        .half = (1U << shift) >> 1,
        .tick_per_ohm = (uint32_t)divided((int64_t)1 << (48U + shift), resistance_rate),
        .tick = (uint32_t)divided((int64_t)1 << 32, rate),
    };
}

void jp_meter_update(struct jp_meter *meter, const struct jp_voltages *voltages, const struct jp_sensors *sensors)
{
    jp_q16 left = voltages->left;
    jp_q16 right = voltages->right;
    int64_t squares = jp_multiply(left, left) + jp_multiply(right, right);
    int64_t power = jp_multiply(left, sensors->current_left) + jp_multiply(right, sensors->current_right);

    meter->model +=
        ((multiply_q32(squares, meter->tick_per_ohm) + meter->half) >> meter->shift) + meter->electronics_tick;
    meter->battery += multiply_q32(power, meter->tick) + meter->electronics_tick;
}

jp_q16 jp_energy_to_q16(jp_energy energy, int32_t unit_exponent)
{
    const int32_t bits = 16 + unit_exponent;

    return jp_round_shift(energy, (unsigned)bits);
}

jp_q16 jp_energy_to_wrapping_q16(jp_energy energy, int32_t unit_exponent)
{
    const int32_t bits = 16 + unit_exponent;

    return (jp_q16)(uint32_t)((uint64_t)energy >> (unsigned)bits);
}

jp_energy jp_energy_from_q16(jp_q16 energy, int32_t unit_exponent)
{
    const int32_t bits = 16 + unit_exponent;

    return energy * ((int64_t)1 << (unsigned)bits);
}
