// eva: -eva-slevel-function main:30,jp_ecu_battery_init:60,jp_battery_check:60,jp_battery_update:20
/** Any cells that pass, any energies and voltages, at any ticks, for ever. */
#include "hal/app/ecu_battery.h"
#include "tests/proof/any.h"

static struct jp_ecu_battery battery;
static struct jp_battery_config config;
static struct jp_battery_cells cells;

static void look(const struct jp_ecu_supply *supply)
{
    struct jp_forecast left;
    jp_energy told;
    jp_energy deviation;

    (void)jp_ecu_battery_left(&battery, &left);
    (void)jp_ecu_battery_given(&battery);
    jp_ecu_battery_tell(&battery, &told, &deviation);
    if (battery.updates > 0U) {
        (void)jp_ecu_battery_lacks(&battery, supply);
    }
}

int main(void)
{
    const uint32_t tick_rate = any_unsigned(9900U) + 100U;
    struct jp_ecu_supply supply;
    const char *field;

    ANY(config);
    ANY(cells);
    config.cells = &cells;
    if (jp_ecu_battery_init(&battery, &config, any_int(), &field) != JP_OK) {
        return 0;
    }
    ANY_TIMES
    {
        ANY(supply);
        (void)jp_ecu_battery_pass(&battery, &supply, any_unsigned(UINT32_MAX), tick_rate);
        look(&supply);
    }
    ARRIVED();
    return 0;
}
