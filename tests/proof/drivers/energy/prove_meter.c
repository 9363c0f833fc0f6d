// eva: -eva-slevel 100
/** Any configuration that passes, any voltages and currents within the header's ranges, for ever. */
#include <joulepath/bus_meter.h>
#include <joulepath/meter.h>

#include "tests/proof/any.h"

#define VOLTS_MAX   JP_Q16(1024)
#define AMPERES_MAX JP_Q16(1024)

static void measure(struct jp_meter *meter, const struct jp_meter_config *config)
{
    const struct jp_voltages voltages = {any_between(-VOLTS_MAX, VOLTS_MAX), any_between(-VOLTS_MAX, VOLTS_MAX), false};
    struct jp_sensors sensors;

    ANY(sensors);
    sensors.current_left = any_between(-AMPERES_MAX, AMPERES_MAX);
    sensors.current_right = any_between(-AMPERES_MAX, AMPERES_MAX);
    if (any_bool()) {
        jp_meter_update(meter, &voltages, &sensors);
    } else {
        jp_meter_update_battery(meter, &voltages, &sensors);
    }
    jp_meter_burn(meter, config->motor_resistance, any_between(0, JP_Q16_ONE), &voltages, &sensors);
}

int main(void)
{
    struct jp_meter_config config;
    struct jp_meter meter;
    struct jp_bus_meter bus_meter;
    const char *field;

    ANY(config);
    if (jp_meter_check(&config, &field) != JP_OK || jp_bus_meter_start(&bus_meter, any_unsigned(UINT32_MAX)) != JP_OK) {
        return 0;
    }
    jp_meter_start(&meter, &config);
    ANY_TIMES
    {
        measure(&meter, &config);
        jp_bus_meter_update(&bus_meter, any_int(), any_int());
        (void)jp_energy_to_q16(any_long(INT64_MIN, INT64_MAX), any_between(-8, 8));
        (void)jp_energy_from_q16(any_int(), any_between(-8, 8));
    }
    ARRIVED();
    return 0;
}
