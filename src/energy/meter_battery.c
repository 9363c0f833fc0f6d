#include <joulepath/meter.h>

#include "src/base/multiply_q32.h"

void jp_meter_update_battery(struct jp_meter *meter, const struct jp_voltages *voltages,
                             const struct jp_sensors *sensors)
{
    const int64_t power =
        jp_multiply(voltages->left, sensors->current_left) + jp_multiply(voltages->right, sensors->current_right);

    meter->battery += multiply_q32(power, meter->tick) + meter->electronics_tick;
}

/** What a bridge burns, W in Q32. */
static int64_t burnt_of(jp_q16 motor_resistance, jp_q16 share, jp_q16 voltage, jp_q16 current)
{
    const int64_t returned = -jp_multiply(voltage, current);

    if (returned <= 0) {
        return 0;
    }

    const jp_q16 copper = jp_q16_multiply(motor_resistance, jp_q16_multiply(current, current));
    const int64_t burnt = ((returned >> 16) + copper) * (uint32_t)share;

    return burnt < returned ? burnt : returned;
}

void jp_meter_burn(struct jp_meter *meter, jp_q16 motor_resistance, jp_q16 share, const struct jp_voltages *voltages,
                   const struct jp_sensors *sensors)
{
    const int64_t burnt = burnt_of(motor_resistance, share, voltages->left, sensors->current_left) +
                          burnt_of(motor_resistance, share, voltages->right, sensors->current_right);

    meter->battery += multiply_q32(2 * burnt, meter->tick);
}
