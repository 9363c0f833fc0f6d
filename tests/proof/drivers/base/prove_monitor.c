/** Any limits that pass, any frames and statuses, for ever. */
#include <joulepath/monitor.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_monitor_config config;
    struct jp_monitor monitor;
    struct jp_sensors sensors;
    struct jp_voltages voltages;
    const char *field;

    ANY(config);
    if (jp_monitor_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_monitor_start(&monitor, &config);
    ANY_TIMES
    {
        ANY(sensors);
        ANY(voltages);
        voltages.saturated = any_bool();
        (void)jp_monitor_sensors(&monitor, &config,
                                 any_bool()   ? JP_OK
                                 : any_bool() ? JP_HELD
                                              : JP_ERR_HARDWARE,
                                 &sensors);
        if (monitor.started) {
            (void)jp_monitor_motors(&monitor, &config, &voltages, any_int(), any_int());
        }
    }
    ARRIVED();
    return 0;
}
