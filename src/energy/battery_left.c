#include "src/energy/battery_left.h"

#define HOUR 3600

/** What the sensor may count more or less than the cells give. */
#define COUNTED_MIN JP_Q24(0.5)
#define COUNTED_MAX JP_Q24(2)

/** What a gradient is limited to. */
#define SLOPE_MAX JP_Q24(16)

/** What the cells still have: F(z) = ∫ U dz from the reserve to the charge, and what the load loses. */
struct remainder {
    jp_q24 area;      /**< F, V a cell */
    jp_q24 loss;      /**< (r R₀ + s R₁) i, V a cell */
    jp_q24 ohmic;     /**< R₀ i, V a cell */
    jp_q24 polarised; /**< R₁ i */
    jp_q24 voltage;   /**< U at the charge, V */
    jp_q24 share;     /**< z */
    jp_q24 reserve;
};

/** ∫ U dz and ∫ R₀ dz between two charges, each 0…1: the trapezia between the points of the curves. */
struct area {
    jp_q24 voltage;    /**< V */
    jp_q24 resistance; /**< Ω */
};

static struct area area_between(const struct jp_battery_cells *cells, jp_q24 low, jp_q24 high)
{
    struct area area = {0, 0};
    struct jp_cell_point begin = jp_cell_at(cells, low);
    jp_q24 from = low;

    for (uint32_t i = 1; i < JP_BATTERY_POINTS && from < high; i++) {
        const jp_q24 to = cells->charge[i] < high ? cells->charge[i] : high;

        if (to > from) {
            const struct jp_cell_point end = jp_cell_at(cells, to);

            area.voltage += jp_multiply_shift(to - from, begin.open_voltage + end.open_voltage, 25);
            area.resistance += jp_multiply_shift(to - from, begin.resistance + end.resistance, 25);
            from = to;
            begin = end;
        }
    }
    return area;
}

/** What the load takes of a cell's voltage, limited: more than a cell has is as bad. */
static jp_q24 drop_of(jp_q24 resistance, const struct jp_battery_config *config)
{
    return jp_clamp32(jp_multiply_shift(resistance, config->load, 16), 0, SLOPE_MAX);
}

static struct remainder remainder_of(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const struct jp_battery_cells *const cells = config->cells;
    const jp_q24 share = jp_battery_share(battery);
    const jp_q24 reserve = config->reserve >> 7;
    const struct jp_cell_point cell = jp_cell_at(cells, share);
    const struct area area = area_between(cells, reserve, share);
    const jp_q24 ohmic = share > reserve ? jp_q24_divide(area.resistance, share - reserve) : cell.resistance;
    const jp_q24 resistance = jp_battery_resistance(battery, cells, ohmic);

    return (struct remainder){
        .area = area.voltage,
        .loss = drop_of(resistance, config),
        .ohmic = drop_of(ohmic, config),
        .polarised = drop_of(cells->polarisation, config),
        .voltage = cell.open_voltage,
        .share = share,
        .reserve = reserve,
    };
}

/** What the sensor is off by, A. */
static jp_q16 offset_of(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    return jp_divide((battery->filter.offset >> 24) * (int32_t)config->capacity, HOUR << 8);
}

/** By which the sensor counts more than the cells give, at the load. */
static jp_q24 counted_more(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const jp_q16 load = config->load;

    if (load == 0) {
        return JP_Q24_ONE;
    }
    return jp_clamp32(jp_q24_divide(load, jp_sub(load, offset_of(battery, config))), COUNTED_MIN, COUNTED_MAX);
}

/** What is left, J in Q32, of one cell, as the cells give it. */
static jp_energy energy_of_one(const struct jp_battery *battery, const struct remainder *left)
{
    const jp_charge usable = battery->charge - battery->reserve;
    const int64_t energy = jp_scaled(battery->capacity, left->area) - jp_scaled(usable, left->loss);

    return usable <= 0 || energy <= 0 ? 0 : energy;
}

/** What that changes by the offset, V·h a cell: the time that it takes. */
static jp_q24 by_offset(const struct jp_battery_config *config, jp_energy of_one)
{
    if (config->load == 0) {
        return 0;
    }
    return jp_clamp32(jp_divide(of_one / HOUR * 256, config->load), 0, SLOPE_MAX);
}

jp_energy jp_battery_cells_energy(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const struct remainder left = remainder_of(battery, config);
    const jp_energy of_one = energy_of_one(battery, &left);

    return jp_scaled(of_one, counted_more(battery, config)) * (int32_t)config->cells->series;
}

/** Of that energy: by charge k (F(c/k) − F(ρ)) − l (c − ρ k), in what the unknowns are uncertain. */
jp_energy jp_battery_cells_deviation(const struct jp_battery *battery, const struct jp_battery_config *config)
{
    const struct remainder left = remainder_of(battery, config);
    const jp_q24 usable = left.share - left.reserve;
    const jp_q24 gradient[JP_BATTERY_UNKNOWNS] = {
        [JP_BATTERY_CHARGE] = jp_sub(left.voltage, left.loss),
        [JP_BATTERY_RESISTANCE] = -jp_q24_multiply(usable, left.ohmic),
        [JP_BATTERY_SLOWNESS] = -jp_q24_multiply(usable, left.polarised),
        [JP_BATTERY_CAPACITY] =
            left.area - jp_q24_multiply(left.share, left.voltage) + jp_q24_multiply(left.loss, left.reserve),
        [JP_BATTERY_OFFSET] = by_offset(config, energy_of_one(battery, &left)),
    };
    const jp_q24 deviation = jp_battery_deviation(jp_battery_variance(&battery->filter, gradient));
    const jp_q24 of_one = jp_clamp32(deviation, 0, SLOPE_MAX);

    return (int64_t)of_one * (int64_t)config->capacity * (int64_t)config->cells->series * 256;
}
