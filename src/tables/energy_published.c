/*
 * The paper's Table 2. The steady voltages follow from its Table 1 with Kt = 0.317 N·m/A and Kb = 0.468 V·s/rad:
 * cv = (β + fw)/(α R) = 8.3538 V·s/m, cw = cv W/2.
 */
#include <joulepath/energy.h>

const struct jp_energy_model jp_energy_model_published = {
    .a = {JP_Q16(172.2), JP_Q16(7.57), JP_Q16(13.2), JP_Q16(-0.66), JP_Q16(-0.94), JP_Q16(1.37), JP_Q16(16.26),
          JP_Q16(-4.39), JP_Q16(-1.11), JP_Q16(15.97), JP_Q16(4.27), JP_Q16(1.09), JP_Q16(5.82)},
    .b = {JP_Q16(20.83), JP_Q16(0.93)},
    .electronics_power = JP_Q16(6),
    .settling_time = JP_Q16(5.82),
    .voltage_per_speed = JP_Q16(8.353817),
    .voltage_per_turn_rate = JP_Q16(1.461918),
    .motor_resistance = JP_Q16(6.69),
};
