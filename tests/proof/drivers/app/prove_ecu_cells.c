// eva: -eva-slevel-function main:30,jp_ecu_battery_init:60,jp_battery_check:60,jp_battery_update:20
// eva: -eva-slevel-function jp_ecu_battery_pass:20,update:20,follow_battery:20,jp_ecu_work:20 -eva-widening-delay 8
/** The cells of a robot of any kind, any that pass: slices of work at any ticks, whatever the robot measures of its
 * supply, for ever. */
#include "hal/app/ecu.h"
#include "tests/proof/any_kind.h"
#include "tests/proof/any_port.h"

static struct jp_ecu ecu;
static struct jp_ecu_battery battery;
static struct jp_battery_config config;
static struct jp_battery_cells cells;

int main(void)
{
    const struct jp_ecu_robot robot = {.kind = &any_kind, .tick_rate = any_unsigned(9900U) + 100U, .monitor = NULL};
    const char *field;

    ANY(config);
    ANY(cells);
    config.cells = &cells;
    if (jp_ecu_battery_init(&battery, &config, any_int(), &field) != JP_OK) {
        return 0;
    }
    while (jp_ecu_init(&ecu, &robot, &any_port, NULL) != JP_OK) {
        /* Nothing is null. */
    }
    jp_ecu_use_battery(&ecu, &battery);
    ANY_TIMES
    {
        ecu.tick = any_unsigned(UINT32_MAX);
        jp_ecu_work(&ecu);
    }
    ARRIVED();
    return 0;
}
