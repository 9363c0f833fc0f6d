#include <joulepath/battery.h>

#include "src/energy/battery_filter.h"

/** A battery whose polarisation has settled: E − R i. */
struct settled {
    jp_q16 open;       /**< E, V */
    jp_q16 resistance; /**< R, Ω; above 0 */
};

/** Of one cell to the battery, Q24 to Q16. */
static jp_q16 of_all(jp_q24 of_one, const struct jp_battery_config *config)
{
    return jp_round_shift((int64_t)of_one * (int32_t)config->cells->series, 8);
}

static struct settled settled_of(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const struct jp_cell_point cell = jp_cell_at(config->cells, jp_battery_share(battery));
    const jp_q24 of_one = jp_battery_resistance(battery, config->cells, cell.resistance);

    return (struct settled){
        .open = of_all(cell.open_voltage, config),
        .resistance = jp_add(of_all(of_one, config), 1),
    };
}

void jp_battery_voltage_at(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current,
                           struct jp_battery_voltage *expected)
{
    struct jp_battery_expectation of_one;

    jp_battery_expect(battery, config, current, &of_one);
    expected->voltage = of_all(of_one.voltage, config);
    expected->deviation = of_all(jp_battery_deviation(jp_battery_variance(&battery->filter, of_one.gradient)), config);
}

enum jp_status jp_battery_voltage_under(const struct jp_battery *battery, const struct jp_battery_config *config,
                                        jp_q16 power, jp_q16 *voltage)
{
    const struct settled source = settled_of(battery, config);
    const jp_q16 half = source.open / 2;
    const int64_t rest = jp_multiply(half, half) - jp_multiply(source.resistance, power);

    *voltage = half;
    if (rest < 0) {
        return JP_ERR_INFEASIBLE;
    }
    *voltage = jp_add(half, (jp_q16)jp_square_root((uint64_t)rest));
    return JP_OK;
}

jp_q16 jp_battery_power_at(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 voltage)
{
    const struct settled source = settled_of(battery, config);
    const jp_q16 bus = jp_clamp32(voltage, source.open / 2, source.open);

    return jp_divide(jp_multiply(bus, source.open - bus), source.resistance);
}

jp_q16 jp_battery_lacks(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 power)
{
    jp_q16 voltage;

    (void)jp_battery_voltage_under(battery, config, power, &voltage);
    return voltage < config->voltage_designed ? config->voltage_designed - voltage : 0;
}
