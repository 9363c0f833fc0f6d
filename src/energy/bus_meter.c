#include <joulepath/bus_meter.h>
#include <stddef.h>

#include "src/base/integer.h"

#define TICK_RATE_MIN 10U
#define TICK_RATE_MAX 10000U

enum jp_status jp_bus_meter_start(struct jp_bus_meter *meter, uint32_t tick_rate)
{
    if (meter == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (tick_rate < TICK_RATE_MIN || tick_rate > TICK_RATE_MAX) {
        return JP_ERR_CONFIG;
    }
    *meter = (struct jp_bus_meter){
        .tick = (uint32_t)((((uint64_t)1 << 32) + (uint64_t)tick_rate / 2U) / (uint64_t)tick_rate)};
    return JP_OK;
}

void jp_bus_meter_update(struct jp_bus_meter *meter, jp_q16 voltage, jp_q16 current)
{
    const jp_q16 power = jp_q16_multiply(voltage, current);

    meter->energy += jp_round_shift64((int64_t)power * (int64_t)meter->tick, 16);
}
