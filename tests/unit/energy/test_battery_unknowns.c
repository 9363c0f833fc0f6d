/* What a voltage and what is left of the energy say of each number that the filter of a battery knows: gradients
 * against differences, steps in their direction, limits. */
#include <joulepath/tables.h>

#include "src/base/integer.h"
#include "src/energy/battery_filter.h"
#include "src/energy/battery_left.h"
#include "unity.h"

#define CAPACITY 10080
#define COULOMB  ((jp_charge)1 << 32)
#define Q48      ((int64_t)1 << 48)

/* Of every unknown, for differences: 1/256. */
#define STEP (Q48 / 256)

static struct jp_battery_cells cells;
static struct jp_battery_config config;
static struct jp_battery battery;

void setUp(void)
{
    cells = jp_battery_cells_courier24;
    cells.polarisation = JP_Q24(0.02);
    config = (struct jp_battery_config){
        .capacity = CAPACITY,
        .voltage_empty = JP_Q16(18),
        .voltage_nominal = JP_Q16(22),
        .voltage_full = JP_Q16(25.2),
        .voltage_min = JP_Q16(12),
        .voltage_max = JP_Q16(30),
        .voltage_jump = JP_Q16(6),
        .charge_efficiency = JP_Q16_ONE,
        .reserve = (jp_q31)1 << 28,
        .charge_deviation = (jp_q31)1 << 26,
        .load = JP_Q16(3),
        .update_rate = 2,
        .cells = &cells,
        .unit_exponent = 3,
    };
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, CAPACITY * COULOMB * 63 / 100, 0));
}

void tearDown(void)
{
}

/* An unknown is by so much more. */
static void change(unsigned unknown, int64_t by)
{
    int64_t *const numbers[JP_BATTERY_UNKNOWNS] = {
        [JP_BATTERY_POLARISATION] = &battery.filter.polarisation,
        [JP_BATTERY_RESISTANCE] = &battery.filter.resistance,
        [JP_BATTERY_SLOWNESS] = &battery.filter.slowness,
        [JP_BATTERY_CURVE] = &battery.filter.curve,
        [JP_BATTERY_OFFSET] = &battery.filter.offset,
    };

    if (unknown == JP_BATTERY_CHARGE) {
        battery.charge += by / (1 << 16) * CAPACITY;
    } else if (unknown == JP_BATTERY_CAPACITY) {
        battery.capacity += by / (1 << 16) * CAPACITY;
        battery.reserve = (battery.capacity >> 31) * config.reserve;
    } else {
        *numbers[unknown] += by;
    }
}

/* ---- What a voltage says ---- */

static jp_q24 voltage_at(jp_q16 current)
{
    struct jp_battery_expectation expected;

    jp_battery_expect(&battery, &config, current, &expected);
    return expected.voltage;
}

static void test_a_voltage_changes_by_each_unknown_as_it_says(void)
{
    for (jp_q16 current = -JP_Q16(4); current <= JP_Q16(8); current += JP_Q16(6)) {
        struct jp_battery_expectation expected;

        jp_battery_expect(&battery, &config, current, &expected);
        for (unsigned i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
            change(i, STEP);
            const jp_q24 more = voltage_at(current);
            change(i, -2 * STEP);
            const jp_q24 less = voltage_at(current);
            change(i, STEP);
            const int32_t difference = (more - less) * 128;

            /* The resistance changes with the charge a little, too, which it leaves out. */
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.02) + jp_absolute32(difference) / 16, difference, expected.gradient[i]);
        }
    }
}

static void test_noise_grows_with_the_load(void)
{
    struct jp_battery_expectation idle;
    struct jp_battery_expectation loaded;

    cells.load_noise = JP_Q24(0.5);
    jp_battery_expect(&battery, &config, 0, &idle);
    jp_battery_expect(&battery, &config, JP_Q16(10), &loaded);
    TEST_ASSERT_EQUAL_INT64((int64_t)cells.voltage_noise * cells.voltage_noise, idle.noise);

    const int64_t sag = (int64_t)(idle.voltage - loaded.voltage) / 2;

    TEST_ASSERT_INT64_WITHIN(loaded.noise / 1000, idle.noise + sag * sag, loaded.noise);
}

/* A surprise of 20 mV is put down to the one number that is not known. */
static void test_each_unknown_is_corrected_towards_the_voltage(void)
{
    static const unsigned felt[] = {JP_BATTERY_CHARGE, JP_BATTERY_POLARISATION, JP_BATTERY_RESISTANCE, JP_BATTERY_CURVE,
                                    JP_BATTERY_CAPACITY};

    for (unsigned k = 0; k < sizeof felt / sizeof felt[0]; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            for (unsigned i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
                for (unsigned j = 0; j < JP_BATTERY_UNKNOWNS; j++) {
                    battery.filter.covariance[i][j] = i == j ? (i == felt[k] ? Q48 / 64 : 1) : 0;
                }
            }
            const struct jp_battery before = battery;

            (void)jp_battery_filter_second(&battery, &config, JP_Q16(5), 0, true);
            const jp_q24 foretold = voltage_at(JP_Q16(5));
            const jp_q24 told = foretold + sign * JP_Q24(0.02);

            battery = before;
            TEST_ASSERT_EQUAL_UINT8(0, jp_battery_filter_second(&battery, &config, JP_Q16(5), told, false));
            TEST_ASSERT_GREATER_THAN_INT32(JP_Q24(0.0005), sign * (voltage_at(JP_Q16(5)) - foretold));
            TEST_ASSERT_LESS_THAN_INT32(JP_Q24(0.021), sign * (voltage_at(JP_Q16(5)) - foretold));
        }
    }
}

static void test_a_cell_is_as_its_curves_say(void)
{
    for (unsigned i = 0; i < JP_BATTERY_POINTS; i++) {
        const struct jp_cell_point at = jp_cell_at(&cells, cells.charge[i]);

        TEST_ASSERT_INT32_WITHIN(2, cells.open_voltage[i], at.open_voltage);
        TEST_ASSERT_INT32_WITHIN(1, cells.resistance[i], at.resistance);
        TEST_ASSERT_INT32_WITHIN(1, cells.charge[i], jp_cell_charge(&cells, cells.open_voltage[i]));
        if (i > 0U) {
            const jp_q24 width = cells.charge[i] - cells.charge[i - 1U];
            const jp_q24 rise = cells.open_voltage[i] - cells.open_voltage[i - 1U];
            const struct jp_cell_point between = jp_cell_at(&cells, cells.charge[i - 1U] + width / 4);

            TEST_ASSERT_INT32_WITHIN(4, cells.open_voltage[i - 1U] + rise / 4, between.open_voltage);
            TEST_ASSERT_INT32_WITHIN(4, (cells.resistance[i - 1U] * 3 + cells.resistance[i]) / 4, between.resistance);
            TEST_ASSERT_INT32_WITHIN(64, jp_q24_divide(rise, width), between.slope);
            TEST_ASSERT_EQUAL_INT32(between.slope, at.slope); /* of what ends there */
        }
    }
}

static void test_beyond_its_ends_a_cell_goes_on_with_its_slope(void)
{
    const unsigned last = JP_BATTERY_POINTS - 1U;
    const struct jp_cell_point over = jp_cell_at(&cells, JP_Q24(1.25));
    const struct jp_cell_point under = jp_cell_at(&cells, -JP_Q24(0.25));

    TEST_ASSERT_INT32_WITHIN(8, cells.open_voltage[last] + over.slope / 4, over.open_voltage);
    TEST_ASSERT_INT32_WITHIN(8, cells.open_voltage[0] - under.slope / 4, under.open_voltage);
    TEST_ASSERT_EQUAL_INT32(cells.resistance[last], over.resistance);
    TEST_ASSERT_EQUAL_INT32(cells.resistance[0], under.resistance);
}

/* ---- What is left of the energy ---- */

/* J a cell by the A·s of the capacity and V, of a change of two unknowns by as much. */
static int64_t energy_by(unsigned i, unsigned j)
{
    change(i, STEP / 2);
    change(j, STEP / 2);
    const jp_energy more = jp_battery_cells_energy(&battery, &config);
    change(i, -STEP);
    change(j, -STEP);
    const jp_energy less = jp_battery_cells_energy(&battery, &config);
    change(i, STEP / 2);
    change(j, STEP / 2);
    return (more - less) * 256;
}

static int64_t magnitude_of(int64_t x)
{
    return x < 0 ? -x : x;
}

/* Both unknowns are off by 1/64, and by as much of each other. */
static jp_energy deviation_of(unsigned i, unsigned j)
{
    for (unsigned k = 0; k < JP_BATTERY_UNKNOWNS; k++) {
        for (unsigned l = 0; l < JP_BATTERY_UNKNOWNS; l++) {
            const bool is_both = (k == i || k == j) && (l == i || l == j);

            battery.filter.covariance[k][l] = is_both ? Q48 / 64 / 64 : 0;
        }
    }
    return jp_battery_cells_deviation(&battery, &config);
}

static void test_what_is_left_is_as_uncertain_as_each_pair_of_unknowns(void)
{
    const jp_energy whole = jp_battery_cells_energy(&battery, &config);

    for (unsigned i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        for (unsigned j = i; j < JP_BATTERY_UNKNOWNS; j++) {
            const int64_t by = energy_by(i, j) / (i == j ? 2 : 1);
            const int64_t one = magnitude_of(by) / 64;

            TEST_ASSERT_INT64_WITHIN(whole / 2000 + one / 20, one, deviation_of(i, j));
        }
    }
}

/* ---- How sure it is ---- */

static int64_t squared(jp_q24 deviation)
{
    return (int64_t)deviation * deviation;
}

static int64_t variance_of(unsigned unknown)
{
    return battery.filter.covariance[unknown][unknown];
}

/* Of the capacity's error the charge that was told as a share has its part. */
static void test_a_start_is_as_uncertain_as_its_cells_say(void)
{
    const jp_q24 of_share = jp_q24_multiply(cells.capacity_deviation, JP_Q24(0.63));

    TEST_ASSERT_EQUAL_INT64(squared(cells.polarisation), variance_of(JP_BATTERY_POLARISATION));
    TEST_ASSERT_EQUAL_INT64(squared(cells.resistance_deviation), variance_of(JP_BATTERY_RESISTANCE));
    TEST_ASSERT_EQUAL_INT64(squared(cells.slowness_deviation), variance_of(JP_BATTERY_SLOWNESS));
    TEST_ASSERT_EQUAL_INT64(squared(cells.curve_deviation), variance_of(JP_BATTERY_CURVE));
    TEST_ASSERT_EQUAL_INT64(squared(cells.capacity_deviation), variance_of(JP_BATTERY_CAPACITY));
    TEST_ASSERT_EQUAL_INT64(squared(cells.offset_deviation), variance_of(JP_BATTERY_OFFSET));
    TEST_ASSERT_INT64_WITHIN(Q48 >> 27, squared(config.charge_deviation >> 7) + squared(of_share),
                             variance_of(JP_BATTERY_CHARGE));
    TEST_ASSERT_INT64_WITHIN(Q48 >> 27, jp_scaled(squared(cells.capacity_deviation), JP_Q24(0.63)),
                             battery.filter.covariance[JP_BATTERY_CHARGE][JP_BATTERY_CAPACITY]);
}

/* An hour without voltages: each unknown walks as far as its cells say, and the offset takes the charge with it. */
static void test_unknowns_walk_with_the_time(void)
{
    static const unsigned walking[] = {JP_BATTERY_CHARGE, JP_BATTERY_RESISTANCE, JP_BATTERY_SLOWNESS,
                                       JP_BATTERY_CAPACITY, JP_BATTERY_OFFSET};
    jp_q24 *const walks[] = {&cells.charge_walk, &cells.resistance_walk, &cells.slowness_walk, &cells.capacity_walk,
                             &cells.offset_walk};

    for (unsigned k = 0; k < 5U; k++) {
        setUp();
        for (unsigned i = 0; i < 5U; i++) {
            *walks[i] = 0;
        }
        *walks[k] = JP_Q24(0.25);
        for (unsigned i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
            for (unsigned j = 0; j < JP_BATTERY_UNKNOWNS; j++) {
                battery.filter.covariance[i][j] = i == j ? 1 : 0;
            }
        }
        for (int i = 0; i < 36; i++) {
            (void)jp_battery_filter_second(&battery, &config, 0, 0, true);
        }
        for (unsigned i = 0; i < 5U; i++) {
            const int64_t walked = i == k ? Q48 / 16 / 100 : 0;

            TEST_ASSERT_INT64_WITHIN(Q48 >> 25, walked, variance_of(walking[i]));
        }
    }
}

/* What no model says of the voltage is of the polarisation, too. */
static void test_polarisation_is_never_sure(void)
{
    for (unsigned i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        for (unsigned j = 0; j < JP_BATTERY_UNKNOWNS; j++) {
            battery.filter.covariance[i][j] = i == j ? 1 : 0;
        }
    }
    (void)jp_battery_filter_second(&battery, &config, 0, 0, true);
    TEST_ASSERT_INT64_WITHIN(64, squared(cells.voltage_noise / 64), variance_of(JP_BATTERY_POLARISATION));
}

/* Polarisation and the curve's error pass with time and charge, to what the cells say; so does what is not known. */
static void test_polarisation_settles_at_what_the_current_makes(void)
{
    const jp_q24 settled = jp_multiply_shift(cells.polarisation, JP_Q16(2), 16);

    for (int i = 0; i < 3000; i++) {
        (void)jp_battery_filter_second(&battery, &config, JP_Q16(2), 0, true);
    }
    TEST_ASSERT_INT32_WITHIN(settled / 100, settled, (int32_t)(battery.filter.polarisation >> 24));
    TEST_ASSERT_INT64_WITHIN(squared(cells.curve_deviation) / 100, squared(cells.curve_deviation),
                             variance_of(JP_BATTERY_CURVE));
}

static void test_an_offset_moves_the_charge_with_the_time(void)
{
    const jp_charge before = battery.charge;

    battery.filter.offset = Q48 / 10; /* a tenth of the capacity an hour */
    for (int i = 0; i < 360; i++) {
        (void)jp_battery_filter_second(&battery, &config, 0, 0, true);
    }
    TEST_ASSERT_INT64_WITHIN(CAPACITY * COULOMB / 100000, CAPACITY * COULOMB / 100, battery.charge - before);
}

/* ---- Limits ---- */

static void test_every_number_keeps_its_range(void)
{
    const jp_charge nominal = CAPACITY * COULOMB;

    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        battery.capacity = sign < 0 ? nominal / 8 : nominal * 3;
        battery.charge = sign * nominal * 5;
        battery.filter.resistance = sign * 17 * Q48;
        battery.filter.slowness = sign * 17 * Q48;
        battery.filter.polarisation = sign * 64 * Q48;
        battery.filter.curve = sign * 64 * Q48;
        battery.filter.offset = sign * 2 * Q48;
        (void)jp_battery_filter_second(&battery, &config, 0, JP_Q24(3.7), true);
        TEST_ASSERT_EQUAL_INT64(sign < 0 ? nominal / 4 : nominal * 2, battery.capacity);
        TEST_ASSERT_EQUAL_INT64(sign < 0 ? 0 : battery.capacity, battery.charge);
        TEST_ASSERT_EQUAL_INT64(battery.capacity / 8, battery.reserve);
        TEST_ASSERT_EQUAL_INT64(sign < 0 ? Q48 / 4 : Q48 * 16, battery.filter.resistance);
        TEST_ASSERT_EQUAL_INT64(sign < 0 ? Q48 / 16 : Q48 * 16, battery.filter.slowness);
        TEST_ASSERT_EQUAL_INT64(sign * Q48, battery.filter.offset);
        TEST_ASSERT_LESS_OR_EQUAL_INT64(16 * Q48, magnitude_of(battery.filter.polarisation));
        TEST_ASSERT_LESS_OR_EQUAL_INT64(16 * Q48, magnitude_of(battery.filter.curve));
    }
}
