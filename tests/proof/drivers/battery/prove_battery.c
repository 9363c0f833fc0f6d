// eva: -eva-slevel-function main:30,jp_battery_check:60,jp_battery_update:20,jp_battery_restore:20
/** Any battery that passes, with cells or without, any stored state, any energies and voltages, for ever. */
#include <joulepath/battery.h>

#include "tests/proof/any.h"

static struct jp_battery_cells cells;
static struct jp_battery_config config;
static struct jp_battery battery;

static void begin(void)
{
    struct jp_battery_state state;
    const char *field;

    ANY(state);
    while (jp_battery_start(&battery, &config, any_long(INT64_MIN, INT64_MAX), any_long(INT64_MIN, INT64_MAX)) !=
           JP_OK) {
        /* Another charge. */
    }
    if (config.cells != NULL && any_bool()) {
        (void)jp_battery_restore(&battery, &config, &state, any_long(INT64_MIN, INT64_MAX), &field);
    }
}

static void look(void)
{
    struct jp_forecast left;
    jp_charge charge;

    (void)jp_battery_estimate(&config, any_int(), &charge);
    (void)jp_battery_level(&battery);
    (void)jp_battery_level_deviation(&battery, &config);
    (void)jp_battery_energy_left(&battery, &config);
    (void)jp_battery_forecast_left(&battery, &config, &left);
}

static void look_at_cells(void)
{
    struct jp_battery_state state;
    struct jp_battery_voltage expected;
    jp_q16 voltage;

    jp_battery_save(&battery, &config, &state);
    jp_battery_voltage_at(&battery, &config, any_int(), &expected);
    (void)jp_battery_voltage_under(&battery, &config, any_int(), &voltage);
    (void)jp_battery_power_at(&battery, &config, any_int());
    (void)jp_battery_lacks(&battery, &config, any_int());
}

int main(void)
{
    const char *field;

    ANY(config);
    ANY(cells);
    config.cells = any_bool() ? &cells : NULL;
    if (jp_battery_check(&config, &field) != JP_OK) {
        return 0;
    }
    begin();
    ANY_TIMES
    {
        (void)jp_battery_update(&battery, &config, any_long(INT64_MIN, INT64_MAX), any_int());
        look();
        if (config.cells != NULL) {
            look_at_cells();
        }
    }
    ARRIVED();
    return 0;
}
