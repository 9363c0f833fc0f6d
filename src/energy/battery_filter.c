#include "src/energy/battery_filter.h"

#include <stddef.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"

#define ONE_Q48 ((int64_t)1 << 48)

/** Seconds an hour: o is in capacities an hour, and what wanders does so in an hour. */
#define HOUR 3600

/** An error of so many deviations is not believed, squared. */
#define UNEXPECTED 25

/** What one pair of R and C leaves out, by the second: a share of the voltage's noise. It keeps the covariance far from
 *  what rounding does to it. */
#define POLARISATION_SHARE 64

/** What the numbers are limited to. */
#define RESISTANCE_LEAST (ONE_Q48 / 4)
#define SLOWNESS_LEAST   (ONE_Q48 / 16)
#define RESISTANCE_MOST  (ONE_Q48 * 16)
#define OFFSET_MOST      ONE_Q48
#define VARIANCE_MOST    ONE_Q48

/** What voltages of a cell and their gradients are limited to, V. */
#define SLOPE_MAX    JP_Q24(16)
#define VOLTAGE_MOST (ONE_Q48 * 16)

typedef int64_t jp_covariance[JP_BATTERY_UNKNOWNS][JP_BATTERY_UNKNOWNS];

/* ---- Cells ---- */

#define FIELD(member, low, high) JP_CONFIG_FIELD("battery.cells.", struct jp_battery_cells, member, low, high)

static bool rises(const jp_q24 *values)
{
    for (size_t i = 1; i < JP_BATTERY_POINTS; i++) {
        if (values[i] <= values[i - 1U]) {
            return false;
        }
    }
    return true;
}

enum jp_status jp_battery_cells_check(const struct jp_battery_cells *cells, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(series, 1, 200),
        FIELD(charge, 0, JP_Q24_ONE),
        FIELD(open_voltage, JP_Q24(0.5), JP_Q24(10)),
        FIELD(resistance, 1, JP_Q24_ONE),
        FIELD(polarisation, 0, JP_Q24_ONE),
        FIELD(polarisation_keep, 0, INT32_MAX),
        FIELD(resistance_deviation, JP_Q24(0.001), JP_Q24_ONE),
        FIELD(slowness_deviation, JP_Q24(0.001), JP_Q24_ONE),
        FIELD(curve_deviation, 0, JP_Q24(0.5)),
        FIELD(curve_length, JP_Q24(0.001), JP_Q24_ONE),
        FIELD(capacity_deviation, JP_Q24(0.001), JP_Q24(0.5)),
        FIELD(offset_deviation, 0, JP_Q24_ONE),
        FIELD(charge_walk, 0, JP_Q24_ONE),
        FIELD(resistance_walk, 0, JP_Q24_ONE),
        FIELD(slowness_walk, 0, JP_Q24_ONE),
        FIELD(capacity_walk, 0, JP_Q24_ONE),
        FIELD(offset_walk, 0, JP_Q24_ONE),
        FIELD(voltage_noise, JP_Q24(0.005), JP_Q24_ONE),
        FIELD(load_noise, 0, JP_Q24_ONE),
    };
    const enum jp_status status = jp_config_check(cells, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (!rises(cells->charge) || cells->charge[0] != 0 || cells->charge[JP_BATTERY_POINTS - 1U] != JP_Q24_ONE) {
        return jp_config_refuse("battery.cells.charge", field);
    }
    if (!rises(cells->open_voltage)) {
        return jp_config_refuse("battery.cells.open_voltage", field);
    }
    if (cells->identity == 0U) {
        return jp_config_refuse("battery.cells.identity", field);
    }
    return JP_OK;
}

/** The interval of a rising curve in which a value lies, or the last one before it: its end. */
static size_t interval(const jp_q24 *values, jp_q24 value)
{
    size_t i = 1;

    while (i < JP_BATTERY_POINTS - 1U && value > values[i]) {
        i++;
    }
    return i;
}

struct jp_cell_point jp_cell_at(const struct jp_battery_cells *cells, jp_q24 charge)
{
    const size_t i = interval(cells->charge, charge);
    const jp_q24 width = cells->charge[i] - cells->charge[i - 1U];
    const jp_q24 slope = jp_q24_divide(cells->open_voltage[i] - cells->open_voltage[i - 1U], width);
    const jp_q24 beyond = jp_sub(charge, cells->charge[i - 1U]);
    const jp_q24 part = jp_clamp32(jp_q24_divide(beyond, width), 0, JP_Q24_ONE);
    const jp_q24 resistance_change = cells->resistance[i] - cells->resistance[i - 1U];

    return (struct jp_cell_point){
        .open_voltage = jp_add(cells->open_voltage[i - 1U], jp_q24_multiply(slope, beyond)),
        .slope = slope,
        .resistance = cells->resistance[i - 1U] + jp_q24_multiply(resistance_change, part),
    };
}

jp_q24 jp_cell_charge(const struct jp_battery_cells *cells, jp_q24 open_voltage)
{
    const size_t i = interval(cells->open_voltage, open_voltage);
    const jp_q24 rise = cells->open_voltage[i] - cells->open_voltage[i - 1U];
    const jp_q24 width = cells->charge[i] - cells->charge[i - 1U];
    const jp_q24 part = jp_q24_divide(jp_sub(open_voltage, cells->open_voltage[i - 1U]), rise);

    return jp_clamp32(jp_add(cells->charge[i - 1U], jp_q24_multiply(part, width)), 0, JP_Q24_ONE);
}

jp_q24 jp_battery_share(const struct jp_battery *battery)
{
    return jp_divide(battery->charge, (int32_t)(battery->capacity >> 24));
}

/* ---- Covariance ---- */

jp_q24 jp_battery_deviation(int64_t variance)
{
    return (jp_q24)jp_square_root((uint64_t)variance);
}

/** P g, Q48. */
static void times(const jp_covariance p, const jp_q24 gradient[JP_BATTERY_UNKNOWNS],
                  int64_t product[JP_BATTERY_UNKNOWNS])
{
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        product[i] = 0;
        for (size_t j = 0; j < JP_BATTERY_UNKNOWNS; j++) {
            product[i] += jp_scaled(p[i][j], gradient[j]);
        }
    }
}

/** gᵀ x, at least 0. */
static int64_t along(const int64_t product[JP_BATTERY_UNKNOWNS], const jp_q24 gradient[JP_BATTERY_UNKNOWNS])
{
    int64_t sum = 0;

    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        sum += jp_scaled(product[i], gradient[i]);
    }
    return sum < 0 ? 0 : sum;
}

int64_t jp_battery_variance(const struct jp_battery_filter *filter, const jp_q24 gradient[JP_BATTERY_UNKNOWNS])
{
    int64_t product[JP_BATTERY_UNKNOWNS];

    times(filter->covariance, gradient, product);
    return along(product, gradient);
}

/** x[target] becomes keep·x[target] + gain·x[other]: F P Fᵀ. */
static void mix(jp_covariance p, size_t target, jp_q24 keep, size_t other, jp_q24 gain)
{
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        p[target][i] = jp_scaled(p[target][i], keep) + jp_scaled(p[other][i], gain);
    }
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        p[i][target] = jp_scaled(p[i][target], keep) + jp_scaled(p[i][other], gain);
    }
}

/** Adds the variance of a deviation of Q24, of which a second has 1/parts. */
static void widen(jp_covariance p, size_t unknown, jp_q24 deviation, int32_t parts)
{
    const int64_t wider = p[unknown][unknown] + (int64_t)deviation * deviation / parts;

    p[unknown][unknown] = wider > VARIANCE_MOST ? VARIANCE_MOST : wider;
}

static int64_t limited(int64_t value, int64_t low, int64_t high)
{
    if (value < low) {
        return low;
    }
    return value > high ? high : value;
}

/** Rounding must not make a variance vanish, nor a current that no cell bears make a covariance overflow. */
static void keep_whole(jp_covariance p)
{
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        for (size_t j = 0; j < JP_BATTERY_UNKNOWNS; j++) {
            p[i][j] = limited(p[i][j], i == j ? 1 : -VARIANCE_MOST, VARIANCE_MOST);
        }
    }
}

/* ---- The filter ---- */

/** An unknown is as uncertain as at first, whatever the others are. */
static void forget(jp_covariance p, size_t unknown, jp_q24 deviation)
{
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        p[unknown][i] = 0;
        p[i][unknown] = 0;
    }
    widen(p, unknown, deviation, 1);
}

/** Polarisation and the curve's error pass: the one with time, the other with a charge that nobody knows. */
static void forget_what_passes(struct jp_battery_filter *filter, const struct jp_battery_cells *cells)
{
    filter->polarisation = 0;
    filter->curve = 0;
    forget(filter->covariance, JP_BATTERY_POLARISATION, cells->polarisation);
    forget(filter->covariance, JP_BATTERY_CURVE, cells->curve_deviation);
    keep_whole(filter->covariance);
}

void jp_battery_filter_doubt(struct jp_battery *battery, const struct jp_battery_config *config)
{
    widen(battery->filter.covariance, JP_BATTERY_CHARGE, config->charge_deviation >> 7, 1);
    forget_what_passes(&battery->filter, config->cells);
    battery->second.surprises = 0;
}

void jp_battery_filter_start(struct jp_battery *battery, const struct jp_battery_config *config)
{
    const struct jp_battery_cells *const cells = config->cells;
    const jp_q24 share = jp_battery_share(battery);

    battery->filter = (struct jp_battery_filter){.resistance = ONE_Q48, .slowness = ONE_Q48};
    widen(battery->filter.covariance, JP_BATTERY_RESISTANCE, cells->resistance_deviation, 1);
    widen(battery->filter.covariance, JP_BATTERY_SLOWNESS, cells->slowness_deviation, 1);
    widen(battery->filter.covariance, JP_BATTERY_CAPACITY, cells->capacity_deviation, 1);
    widen(battery->filter.covariance, JP_BATTERY_OFFSET, cells->offset_deviation, 1);
    /* c = z k with the share that is told: what k is off by, c is by as much of it. */
    mix(battery->filter.covariance, JP_BATTERY_CHARGE, 0, JP_BATTERY_CAPACITY, share);
    jp_battery_filter_doubt(battery, config);
}

/** A part of the nominal capacity, Q48, as charge. */
static jp_charge charge_of(int64_t part, const struct jp_battery_config *config)
{
    return jp_round_shift64(limited(part, -ONE_Q48 * 2, ONE_Q48 * 2), 16) * (int32_t)config->capacity;
}

static void keep_within(struct jp_battery *battery, const struct jp_battery_config *config)
{
    const jp_charge nominal = (jp_charge)config->capacity << 32;
    struct jp_battery_filter *const filter = &battery->filter;

    battery->capacity = limited(battery->capacity, nominal / 4, nominal * 2);
    battery->charge = limited(battery->charge, 0, battery->capacity);
    battery->reserve = (battery->capacity >> 31) * config->reserve;
    filter->resistance = limited(filter->resistance, RESISTANCE_LEAST, RESISTANCE_MOST);
    filter->slowness = limited(filter->slowness, SLOWNESS_LEAST, RESISTANCE_MOST);
    filter->polarisation = limited(filter->polarisation, -VOLTAGE_MOST, VOLTAGE_MOST);
    filter->curve = limited(filter->curve, -VOLTAGE_MOST, VOLTAGE_MOST);
    filter->offset = limited(filter->offset, -OFFSET_MOST, OFFSET_MOST);
}

/** The error of the curve at a charge that is farther on by what a second draws. */
static void move_along_curve(struct jp_battery_filter *filter, const struct jp_battery_config *config, jp_q16 current)
{
    const struct jp_battery_cells *const cells = config->cells;
    const jp_q24 way = jp_divide((int64_t)jp_magnitude32(current) * 256, (int32_t)config->capacity);
    const jp_q24 share = jp_clamp32(jp_q24_divide(way, cells->curve_length), 0, JP_Q24_ONE);
    const jp_q24 keep = JP_Q24_ONE - share;
    const int64_t variance = (int64_t)cells->curve_deviation * cells->curve_deviation;

    filter->curve = jp_scaled(filter->curve, keep);
    mix(filter->covariance, JP_BATTERY_CURVE, keep, JP_BATTERY_CURVE, 0);
    filter->covariance[JP_BATTERY_CURVE][JP_BATTERY_CURVE] += variance - jp_scaled(jp_scaled(variance, keep), keep);
}

/** What passes in a second. */
static void predict(struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current)
{
    const struct jp_battery_cells *const cells = config->cells;
    struct jp_battery_filter *const filter = &battery->filter;
    const jp_q24 keep = cells->polarisation_keep >> 7;
    const jp_q24 drop = jp_multiply_shift(jp_q24_multiply(cells->polarisation, JP_Q24_ONE - keep), current, 16);
    const jp_q24 polarised = jp_clamp32(drop, -SLOPE_MAX, SLOPE_MAX);
    const jp_q24 second = JP_Q24_ONE / HOUR;

    filter->polarisation = jp_scaled(filter->polarisation, keep) + jp_scaled(filter->slowness, polarised);
    battery->charge += charge_of(jp_scaled(filter->offset, second), config);
    mix(filter->covariance, JP_BATTERY_CHARGE, JP_Q24_ONE, JP_BATTERY_OFFSET, second);
    mix(filter->covariance, JP_BATTERY_POLARISATION, keep, JP_BATTERY_SLOWNESS, polarised);
    move_along_curve(filter, config, current);
    widen(filter->covariance, JP_BATTERY_CHARGE, cells->charge_walk, HOUR);
    widen(filter->covariance, JP_BATTERY_POLARISATION, cells->voltage_noise / POLARISATION_SHARE, 1);
    widen(filter->covariance, JP_BATTERY_RESISTANCE, cells->resistance_walk, HOUR);
    widen(filter->covariance, JP_BATTERY_SLOWNESS, cells->slowness_walk, HOUR);
    widen(filter->covariance, JP_BATTERY_CAPACITY, cells->capacity_walk, HOUR);
    widen(filter->covariance, JP_BATTERY_OFFSET, cells->offset_walk, HOUR);
    keep_whole(filter->covariance);
}

void jp_battery_expect(const struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current,
                       struct jp_battery_expectation *expected)
{
    const struct jp_battery_cells *const cells = config->cells;
    const jp_q24 share = jp_battery_share(battery);
    const struct jp_cell_point cell = jp_cell_at(cells, share);
    const jp_q24 relative = jp_divide(battery->capacity, (int32_t)(config->capacity << 8));
    const jp_q24 by_charge = jp_clamp32(jp_q24_divide(cell.slope, relative), 0, SLOPE_MAX);
    const jp_q24 drop = jp_clamp32(jp_multiply_shift(cell.resistance, current, 16), -SLOPE_MAX, SLOPE_MAX);
    const jp_q24 sag = jp_saturate32(jp_scaled(battery->filter.resistance >> 24, drop));
    const jp_q24 load_noise = jp_q24_multiply(cells->load_noise, sag);

    *expected = (struct jp_battery_expectation){
        .voltage = jp_sub(jp_sub(cell.open_voltage, sag),
                          jp_saturate32((battery->filter.polarisation - battery->filter.curve) >> 24)),
        .gradient = {[JP_BATTERY_CHARGE] = by_charge,
                     [JP_BATTERY_POLARISATION] = -JP_Q24_ONE,
                     [JP_BATTERY_RESISTANCE] = -drop,
                     [JP_BATTERY_CURVE] = JP_Q24_ONE,
                     [JP_BATTERY_CAPACITY] = -jp_clamp32(jp_q24_multiply(by_charge, share), 0, SLOPE_MAX)},
        .noise = (int64_t)cells->voltage_noise * cells->voltage_noise + (int64_t)load_noise * load_noise,
    };
}

/** x/S, Q24, of a product P h with S = hᵀ P h and noise, so that x² <= 16 S in Q48. */
static jp_q24 gain_of(int64_t x, int64_t s)
{
    unsigned shift = 0;

    while (s >> shift > INT32_MAX) {
        shift++;
    }
    return jp_divide(jp_times_power(x, 24 - (int32_t)shift), (int32_t)(s >> shift));
}

static void correct(struct jp_battery *battery, const struct jp_battery_config *config,
                    const int64_t product[JP_BATTERY_UNKNOWNS], int64_t variance, jp_q24 error)
{
    struct jp_battery_filter *const filter = &battery->filter;
    const int64_t most = (int64_t)jp_square_root((uint64_t)variance) * JP_Q24_ONE; /* of an unknown's deviation of 1 */
    int64_t step[JP_BATTERY_UNKNOWNS];

    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        const jp_q24 gain = gain_of(limited(product[i], -most, most), variance);

        step[i] = (int64_t)gain * error;
        for (size_t j = i; j < JP_BATTERY_UNKNOWNS; j++) {
            filter->covariance[i][j] -= jp_scaled(product[j], gain);
            filter->covariance[j][i] = filter->covariance[i][j];
        }
    }
    keep_whole(filter->covariance);
    battery->charge += charge_of(step[JP_BATTERY_CHARGE], config);
    battery->capacity += charge_of(step[JP_BATTERY_CAPACITY], config);
    filter->polarisation += step[JP_BATTERY_POLARISATION];
    filter->resistance += step[JP_BATTERY_RESISTANCE];
    filter->curve += step[JP_BATTERY_CURVE];
    filter->slowness += step[JP_BATTERY_SLOWNESS];
    filter->offset += step[JP_BATTERY_OFFSET];
}

/** error² > 25 variances, of Q24 and Q48. */
static bool is_unexpected(jp_q24 error, int64_t variance)
{
    return (int64_t)error * error / UNEXPECTED > variance;
}

static uint8_t surprise(struct jp_battery *battery, const struct jp_battery_config *config)
{
    battery->second.surprises++;
    if (battery->second.surprises >= JP_BATTERY_SURPRISES) {
        jp_battery_filter_doubt(battery, config);
    }
    return (uint8_t)JP_BATTERY_VOLTAGE_UNEXPECTED;
}

uint8_t jp_battery_filter_second(struct jp_battery *battery, const struct jp_battery_config *config, jp_q16 current,
                                 jp_q24 cell_voltage, bool is_spoilt)
{
    int64_t product[JP_BATTERY_UNKNOWNS];

    predict(battery, config, current);
    keep_within(battery, config);
    if (is_spoilt) {
        return 0;
    }

    struct jp_battery_expectation expected;

    jp_battery_expect(battery, config, current, &expected);

    const jp_q24 error = jp_sub(cell_voltage, expected.voltage);

    times(battery->filter.covariance, expected.gradient, product);

    const int64_t variance = along(product, expected.gradient) + expected.noise;

    if (is_unexpected(error, variance)) {
        return surprise(battery, config);
    }
    battery->second.surprises = 0;
    correct(battery, config, product, variance, error);
    keep_within(battery, config);
    return 0;
}

/* ---- What is stored ---- */

static bool is_covariance(const jp_covariance p)
{
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        if (p[i][i] < 1 || p[i][i] > VARIANCE_MOST) {
            return false;
        }
        for (size_t j = 0; j < i; j++) {
            if (p[i][j] != p[j][i] || jp_absolute64(p[i][j] / 2) > VARIANCE_MOST / 2) {
                return false;
            }
        }
    }
    return true;
}

enum jp_status jp_battery_state_check(const struct jp_battery_state *state, const struct jp_battery_config *config,
                                      const char **field)
{
    const jp_charge nominal = (jp_charge)config->capacity << 32;
    const struct jp_battery_filter *const filter = &state->filter;

    if (state->capacity < nominal / 4 || state->capacity > nominal * 2) {
        return jp_config_refuse("capacity", field);
    }
    if (state->charge < 0 || state->charge > state->capacity) {
        return jp_config_refuse("charge", field);
    }
    if (filter->resistance < RESISTANCE_LEAST || filter->resistance > RESISTANCE_MOST) {
        return jp_config_refuse("resistance", field);
    }
    if (filter->slowness < SLOWNESS_LEAST || filter->slowness > RESISTANCE_MOST) {
        return jp_config_refuse("slowness", field);
    }
    if (filter->offset < -OFFSET_MOST || filter->offset > OFFSET_MOST) {
        return jp_config_refuse("offset", field);
    }
    if (!is_covariance(filter->covariance)) {
        return jp_config_refuse("covariance", field);
    }
    return JP_OK;
}

jp_q24 jp_battery_resistance(const struct jp_battery *battery, const struct jp_battery_cells *cells, jp_q24 resistance)
{
    const struct jp_battery_filter *const filter = &battery->filter;

    return jp_saturate32(jp_scaled(filter->resistance >> 24, resistance) +
                         jp_scaled(filter->slowness >> 24, cells->polarisation));
}
