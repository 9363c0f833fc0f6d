/** Any limits that pass, any frames and motions, for ever. */
#include <joulepath/skid_monitor.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_skid_monitor_config config;
    struct jp_skid_monitor monitor;
    struct jp_skid_control control;
    struct jp_skid_motion motion;
    struct jp_sensors sensors;
    const char *field;

    ANY(config);
    if (jp_skid_monitor_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_skid_monitor_start(&monitor, any_int());
    ANY_TIMES
    {
        ANY(sensors);
        ANY(control);
        ANY(motion);
        motion.control = &control;
        motion.straight = any_bool();
        (void)jp_skid_monitor_ground(&monitor, &config, &sensors, any_int());
        (void)jp_skid_monitor_is_steep(&monitor, &config);
        (void)jp_skid_monitor_wheels(&monitor, &config, &motion);
    }
    ARRIVED();
    return 0;
}
