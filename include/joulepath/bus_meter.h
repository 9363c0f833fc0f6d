/** The energy that a robot takes from its battery, by the voltage and the current of its bus: ∫ u i dt. */
#ifndef JOULEPATH_BUS_METER_H
#define JOULEPATH_BUS_METER_H

#include <joulepath/meter.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Private but for the energy. */
struct jp_bus_meter {
    jp_energy energy; /**< J; current into the battery counts below 0 */
    uint32_t tick;    /**< 2⁻³² s */
};

/** Starts at 0. JP_ERR_CONFIG: `tick_rate`, 1/s, is not 10…10 000. JP_ERR_ARGUMENT: a null pointer. */
enum jp_status jp_bus_meter_start(struct jp_bus_meter *meter, uint32_t tick_rate);

/** One tick at a voltage, V, and a current, A, means of the tick: |u i| <= 32 767 W, beyond that the energy is that of
 *  32 767 W. Within 1e-6 of the exact sum, or 2e-6 W. Constant time; for the control ISR. */
void jp_bus_meter_update(struct jp_bus_meter *meter, jp_q16 voltage, jp_q16 current);

#ifdef __cplusplus
}
#endif

#endif
