/** Any configurations that pass, any samples, for ever. */
#include <joulepath/current_check.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_current_check_config config;
    struct jp_monitor_config motors;
    struct jp_current_check check;
    struct jp_motor_sample sample;
    const char *field;

    ANY(config);
    ANY(motors);
    if (jp_current_check_check(&config, &field) != JP_OK || jp_monitor_check(&motors, &field) != JP_OK) {
        return 0;
    }
    jp_current_check_start(&check, &config, &motors);
    ANY_TIMES
    {
        ANY(sample);
        sample.voltages.saturated = any_bool();
        (void)jp_current_check_update(&check, &sample);
    }
    ARRIVED();
    return 0;
}
