/* The filter of known cells: configuration, what it believes, corrects and finds; what is stored; what is left. */
#include <joulepath/battery.h>
#include <joulepath/tables.h>

#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define JOULE    ((jp_energy)1 << 32)
#define COULOMB  ((jp_charge)1 << 32)
#define CAPACITY 10080
#define Q48      ((int64_t)1 << 48)
#define SERIES   6

static struct jp_battery_cells cells;
static struct jp_battery_config usual;
static struct jp_battery_config config;
static struct jp_battery battery;
static jp_energy meter;

void setUp(void)
{
    cells = jp_battery_cells_courier24;
    usual = (struct jp_battery_config){
        .capacity = CAPACITY,
        .voltage_empty = JP_Q16(18),
        .voltage_nominal = JP_Q16(22),
        .voltage_full = JP_Q16(25.2),
        .voltage_min = JP_Q16(12),
        .voltage_max = JP_Q16(30),
        .voltage_jump = JP_Q16(6),
        .charge_efficiency = JP_Q16_ONE,
        .reserve = (jp_q31)1 << 28, /* an eighth */
        .charge_deviation = (jp_q31)1 << 26,
        .load = JP_Q16_ONE,
        .update_rate = 2,
        .cells = &cells,
        .unit_exponent = 3,
    };
    config = usual;
    meter = 0;
}

void tearDown(void)
{
}

static void start(jp_charge charge)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, charge, meter));
}

/** V a cell at a point of the curve. */
static jp_q16 bus_at(size_t point)
{
    return (jp_q16)(((int64_t)cells.open_voltage[point] * SERIES) >> 8);
}

/** A second at this voltage, in which so much energy was drawn. */
static uint8_t second(jp_energy energy, jp_q16 voltage)
{
    meter += energy / 2;
    (void)jp_battery_update(&battery, &config, meter, voltage);
    meter += energy - energy / 2;
    return jp_battery_update(&battery, &config, meter, voltage);
}

static void seconds(unsigned count, jp_energy energy, jp_q16 voltage)
{
    for (unsigned i = 0; i < count; i++) {
        (void)second(energy, voltage);
    }
}

static jp_q31 share_of(jp_charge charge)
{
    return (jp_q31)((charge >> 1) / CAPACITY);
}

/* Configuration */

DEFINE_EXPECT_CONFIG_OF(jp_battery_check, usual)

#define CELLS_FIELD(member, value, expected)                                                                           \
    do {                                                                                                               \
        cells.member = (value);                                                                                        \
        expect_config(expected);                                                                                       \
        cells = jp_battery_cells_courier24;                                                                            \
    } while (0)

#define CELLS_RANGE(member, low, high)                                                                                 \
    do {                                                                                                               \
        CELLS_FIELD(member, low, NULL);                                                                                \
        CELLS_FIELD(member, (low)-1, "battery.cells." #member);                                                        \
        CELLS_FIELD(member, high, NULL);                                                                               \
        CELLS_FIELD(member, (high) + 1, "battery.cells." #member);                                                     \
    } while (0)

static void test_checks_every_field_at_its_limits(void)
{
    expect_config(NULL);
    RANGE("battery.", update_rate, 1, 1000);
    RANGE("battery.", load, 0, JP_Q16(1024));
    CELLS_RANGE(series, 1, 200);
    CELLS_FIELD(resistance[3], 1, NULL);
    CELLS_FIELD(resistance[3], 0, "battery.cells.resistance");
    CELLS_FIELD(resistance[3], JP_Q24_ONE + 1, "battery.cells.resistance");
    CELLS_RANGE(polarisation, 0, JP_Q24_ONE);
    CELLS_FIELD(polarisation_keep, -1, "battery.cells.polarisation_keep");
    CELLS_FIELD(polarisation_keep, INT32_MAX, NULL);
    CELLS_RANGE(resistance_deviation, JP_Q24(0.001), JP_Q24_ONE);
    CELLS_RANGE(slowness_deviation, JP_Q24(0.001), JP_Q24_ONE);
    CELLS_RANGE(capacity_deviation, JP_Q24(0.001), JP_Q24(0.5));
    CELLS_RANGE(curve_deviation, 0, JP_Q24(0.5));
    CELLS_RANGE(curve_length, JP_Q24(0.001), JP_Q24_ONE);
    CELLS_RANGE(offset_deviation, 0, JP_Q24_ONE);
    CELLS_RANGE(charge_walk, 0, JP_Q24_ONE);
    CELLS_RANGE(resistance_walk, 0, JP_Q24_ONE);
    CELLS_RANGE(slowness_walk, 0, JP_Q24_ONE);
    CELLS_RANGE(capacity_walk, 0, JP_Q24_ONE);
    CELLS_RANGE(offset_walk, 0, JP_Q24_ONE);
    CELLS_RANGE(voltage_noise, JP_Q24(0.005), JP_Q24_ONE);
    CELLS_RANGE(load_noise, 0, JP_Q24_ONE);
    CELLS_FIELD(identity, 0, "battery.cells.identity");
}

static void test_curves_rise_over_the_whole_charge(void)
{
    CELLS_FIELD(charge[0], 1, "battery.cells.charge");
    CELLS_FIELD(charge[JP_BATTERY_POINTS - 1U], JP_Q24_ONE - 1, "battery.cells.charge");
    CELLS_FIELD(charge[5], cells.charge[4], "battery.cells.charge");
    CELLS_FIELD(open_voltage[9], cells.open_voltage[8], "battery.cells.open_voltage");
    CELLS_FIELD(open_voltage[0], JP_Q24(0.4), "battery.cells.open_voltage");
}

/* Estimate */

static void test_estimates_along_the_curve(void)
{
    for (size_t i = 0; i < JP_BATTERY_POINTS; i++) {
        jp_charge charge = 0;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, bus_at(i) + 1, &charge));
        TEST_ASSERT_INT64_WITHIN(COULOMB, (jp_charge)cells.charge[i] * CAPACITY * 256, charge);
    }
}

static void test_estimate_ends_with_the_curve(void)
{
    jp_charge charge = 1;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, JP_Q16(12), &charge));
    TEST_ASSERT_EQUAL_INT64(0, charge);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, JP_Q16(30), &charge));
    TEST_ASSERT_EQUAL_INT64(CAPACITY * COULOMB, charge);
}

/* Correction */

static void test_a_start_is_as_uncertain_as_configured(void)
{
    start(CAPACITY * COULOMB / 2);
    TEST_ASSERT_INT32_WITHIN((jp_q31)1 << 18, (jp_q31)1 << 26, jp_battery_level_deviation(&battery, &config));
    config.cells = NULL;
    TEST_ASSERT_EQUAL_INT32(config.charge_deviation, jp_battery_level_deviation(&battery, &config));
}

static void test_counts_as_without_cells_until_the_second_is_over(void)
{
    start(8000 * COULOMB);
    meter += 40 * JOULE;
    (void)jp_battery_update(&battery, &config, meter, JP_Q16(20));
    TEST_ASSERT_EQUAL_INT64(7998 * COULOMB, battery.charge);
}

/* At rest the voltage tells the charge, whatever was told. */
static void test_voltage_at_rest_pulls_the_charge_to_the_curve(void)
{
    start(CAPACITY * COULOMB / 2);
    seconds(300, 0, bus_at(13)); /* 0.6 */
    TEST_ASSERT_INT32_WITHIN(JP_Q31_MAX / 50, JP_Q31_MAX / 10 * 6, jp_battery_level(&battery));
    TEST_ASSERT_LESS_THAN_INT32((jp_q31)1 << 25, jp_battery_level_deviation(&battery, &config));
    TEST_ASSERT_EQUAL_INT32(0, battery.current);
}

static void test_a_right_charge_stays_and_becomes_certain(void)
{
    start(CAPACITY * COULOMB / 2);
    seconds(300, 0, bus_at(12));
    TEST_ASSERT_INT32_WITHIN(JP_Q31_MAX / 2000, (jp_q31)1 << 30, jp_battery_level(&battery));
    TEST_ASSERT_GREATER_THAN_INT32(0, jp_battery_level_deviation(&battery, &config));
}

static void test_load_lowers_the_voltage_and_not_the_charge(void)
{
    const jp_q16 sag = (jp_q16)(((int64_t)cells.resistance[12] * 2 * SERIES) >> 8); /* of 2 A */

    start(CAPACITY * COULOMB / 2);
    (void)second(2 * 22 * JOULE, bus_at(12) - sag);
    TEST_ASSERT_INT32_WITHIN(JP_Q31_MAX / 500, share_of(battery.charge), (jp_q31)1 << 30);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), JP_Q16(2), battery.current);
}

/* Twice the drop that the table says: pulses tell resistance from charge. */
static void test_finds_the_resistance_of_pulses(void)
{
    const jp_q16 drop = (jp_q16)(((int64_t)cells.resistance[12] * 3 * SERIES) >> 8); /* of 3 A */

    start(CAPACITY * COULOMB / 2);
    seconds(60, 0, bus_at(12));
    for (int i = 0; i < 60; i++) {
        (void)second(3 * 22 * JOULE, bus_at(12) - 2 * drop);
        (void)second(-3 * 22 * JOULE, bus_at(12) + 2 * drop);
    }
    TEST_ASSERT_INT64_WITHIN(Q48 / 5, 2 * Q48, battery.filter.resistance);
    TEST_ASSERT_INT32_WITHIN(JP_Q31_MAX / 100, (jp_q31)1 << 30, jp_battery_level(&battery));
}

static void test_limits_hold_whatever_is_read(void)
{
    start(CAPACITY * COULOMB / 2);
    config.voltage_jump = INT32_MAX;
    for (int i = 0; i < 2000; i++) {
        (void)second((i % 3 - 1) * 400 * JOULE, i % 7 == 0 ? JP_Q16(12) : JP_Q16(30));
        TEST_ASSERT_TRUE(battery.charge >= 0 && battery.charge <= battery.capacity);
        TEST_ASSERT_TRUE(battery.capacity >= CAPACITY * COULOMB / 4 && battery.capacity <= CAPACITY * COULOMB * 2);
        TEST_ASSERT_TRUE(battery.filter.resistance >= Q48 / 4 && battery.filter.resistance <= Q48 * 16);
        for (size_t j = 0; j < JP_BATTERY_UNKNOWNS; j++) {
            TEST_ASSERT_TRUE(battery.filter.covariance[j][j] > 0);
        }
    }
}

/* Readings that cannot be */

static void test_an_unexpected_voltage_is_named_and_corrects_nothing(void)
{
    start(CAPACITY * COULOMB / 2);
    seconds(300, 0, bus_at(12));

    const jp_charge before = battery.charge;

    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_UNEXPECTED, second(0, bus_at(19)));
    TEST_ASSERT_INT64_WITHIN(COULOMB / 10, before, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, second(0, bus_at(12)));
}

static void test_a_battery_that_was_changed_is_found_after_a_while(void)
{
    start(CAPACITY * COULOMB / 2);
    config.charge_deviation = (jp_q31)1 << 29; /* a quarter */
    seconds(300, 0, bus_at(12));
    for (unsigned i = 0; i < JP_BATTERY_SURPRISES; i++) {
        TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_UNEXPECTED, second(0, bus_at(15)));
    }
    seconds(300, 0, bus_at(15)); /* 0.8 */
    TEST_ASSERT_INT32_WITHIN(JP_Q31_MAX / 50, JP_Q31_MAX / 10 * 8, jp_battery_level(&battery));
}

static void test_a_second_with_a_bad_reading_corrects_nothing(void)
{
    start(CAPACITY * COULOMB / 2);
    (void)jp_battery_update(&battery, &config, meter, bus_at(15));
    (void)jp_battery_update(&battery, &config, meter, 0);
    TEST_ASSERT_INT64_WITHIN(COULOMB / 10, CAPACITY * COULOMB / 2, battery.charge);
    (void)second(0, bus_at(15)); /* both are still in doubt */
    TEST_ASSERT_INT64_WITHIN(COULOMB / 10, CAPACITY * COULOMB / 2, battery.charge);
    TEST_ASSERT_EQUAL_UINT16(0, battery.second.updates);
}

/* What is stored */

static void expect_refused(const struct jp_battery_state *state, const char *name)
{
    const struct jp_battery before = battery;
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_battery_restore(&battery, &config, state, meter, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    TEST_ASSERT_EQUAL_MEMORY(&before, &battery, sizeof battery);
}

static struct jp_battery_state saved(void)
{
    struct jp_battery_state state;

    start(CAPACITY * COULOMB / 2);
    seconds(300, 22 * JOULE, bus_at(12));
    jp_battery_save(&battery, &config, &state);
    return state;
}

static void test_goes_on_from_what_was_stored(void)
{
    const struct jp_battery_state state = saved();
    const struct jp_battery before = battery;
    const char *field = "";

    battery = (struct jp_battery){.charge = 0};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&battery, &config, &state, 77, &field));
    TEST_ASSERT_NULL(field);
    TEST_ASSERT_EQUAL_INT64(before.charge, battery.charge);
    TEST_ASSERT_EQUAL_INT64(before.capacity, battery.capacity);
    TEST_ASSERT_EQUAL_INT64(before.reserve, battery.reserve);
    TEST_ASSERT_EQUAL_INT64(before.filter.resistance, battery.filter.resistance);
    TEST_ASSERT_EQUAL_INT64(77, battery.energy);
    TEST_ASSERT_EQUAL_INT64(0, battery.filter.polarisation);
    TEST_ASSERT_GREATER_THAN_INT64(before.filter.covariance[JP_BATTERY_CHARGE][JP_BATTERY_CHARGE],
                                   battery.filter.covariance[JP_BATTERY_CHARGE][JP_BATTERY_CHARGE]);
}

static void test_takes_no_state_that_cannot_be(void)
{
    const struct jp_battery_state sound = saved();
    const char *field = NULL;
    struct jp_battery_state state;

#define REFUSED(member, value, name)                                                                                   \
    do {                                                                                                               \
        state = sound;                                                                                                 \
        state.member = (value);                                                                                        \
        expect_refused(&state, name);                                                                                  \
    } while (0)
    REFUSED(identity, sound.identity + 1U, "identity");
    REFUSED(capacity, CAPACITY * COULOMB / 4 - 1, "capacity");
    REFUSED(capacity, CAPACITY * COULOMB * 2 + 1, "capacity");
    REFUSED(charge, -1, "charge");
    REFUSED(charge, sound.capacity + 1, "charge");
    REFUSED(filter.resistance, Q48 / 4 - 1, "resistance");
    REFUSED(filter.resistance, Q48 * 16 + 1, "resistance");
    REFUSED(filter.slowness, Q48 / 16 - 1, "slowness");
    REFUSED(filter.slowness, Q48 * 16 + 1, "slowness");
    REFUSED(filter.offset, -Q48 - 1, "offset");
    REFUSED(filter.offset, Q48 + 1, "offset");
    REFUSED(filter.covariance[2][2], 0, "covariance");
    REFUSED(filter.covariance[2][2], Q48 + 1, "covariance");
    REFUSED(filter.covariance[2][1], sound.filter.covariance[2][1] + 1, "covariance");
    state = sound;
    state.filter.covariance[3][1] = state.filter.covariance[1][3] = INT64_MIN;
    expect_refused(&state, "covariance");
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_restore(NULL, &config, &sound, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_restore(&battery, NULL, &sound, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_restore(&battery, &config, NULL, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_restore(&battery, &config, &sound, 0, NULL));
}

/* What just can be, is taken. */
static void test_takes_states_at_their_limits(void)
{
    const struct jp_battery_state sound = saved();
    const char *field = NULL;
    struct jp_battery_state state;

#define TAKEN(member, value)                                                                                           \
    do {                                                                                                               \
        state = sound;                                                                                                 \
        state.member = (value);                                                                                        \
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&battery, &config, &state, 0, &field));                        \
    } while (0)
    TAKEN(capacity, CAPACITY * COULOMB * 2);
    TAKEN(charge, 0);
    TAKEN(charge, sound.capacity);
    TAKEN(filter.resistance, Q48 / 4);
    TAKEN(filter.resistance, Q48 * 16);
    TAKEN(filter.slowness, Q48 / 16);
    TAKEN(filter.slowness, Q48 * 16);
    TAKEN(filter.offset, -Q48);
    TAKEN(filter.offset, Q48);
    TAKEN(filter.covariance[2][2], 1);
    TAKEN(filter.covariance[2][2], Q48);
    state = sound;
    state.charge = 0;
    state.capacity = CAPACITY * COULOMB / 4;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&battery, &config, &state, 0, &field));
}

/* What is left */

/** J, whole. */
static int32_t energy_left(void)
{
    return (int32_t)(jp_battery_energy_left(&battery, &config) >> 32);
}

static void test_energy_left_without_a_load_is_the_area_of_the_curve(void)
{
    int64_t area = 0; /* V in Q48 between 0.1 and 0.6 */

    for (size_t i = 7; i <= 13; i++) {
        area += (int64_t)(cells.charge[i] - cells.charge[i - 1U]) *
                (cells.open_voltage[i] / 2 + cells.open_voltage[i - 1U] / 2);
    }
    config.load = 0;
    config.reserve = (jp_q31)(((int64_t)cells.charge[6]) << 7);
    start((jp_charge)cells.charge[13] * CAPACITY * 256);
    TEST_ASSERT_INT32_WITHIN(30, (int32_t)((area >> 24) * CAPACITY / JP_Q24_ONE * SERIES), energy_left());
}

static void test_a_load_leaves_less(void)
{
    int32_t before;

    start(CAPACITY * COULOMB / 2);
    config.load = 0;
    before = energy_left();
    config.load = JP_Q16(2);
    /* (0.375 of the capacity) · 2 A · about 0.028 Ω · 6 */
    TEST_ASSERT_INT32_WITHIN(150, before - 1300, energy_left());
}

static void test_nothing_is_left_at_the_reserve(void)
{
    start(CAPACITY * COULOMB / 8);
    TEST_ASSERT_EQUAL_INT32(0, energy_left());
    start(0);
    TEST_ASSERT_EQUAL_INT32(0, energy_left());
    start(COULOMB);
    TEST_ASSERT_EQUAL_INT32(0, energy_left());
    config.load = JP_Q16(1000);
    start(CAPACITY * COULOMB);
    TEST_ASSERT_EQUAL_INT32(0, energy_left());
}

/* A sensor that shows 0.1 A too much counts a tenth more of 1 A. */
static void test_an_offset_of_the_sensor_is_counted_as_energy(void)
{
    int32_t before;

    start(CAPACITY * COULOMB / 2);
    before = energy_left();
    battery.filter.offset = Q48 / 28; /* 0.1 A of 2.8 Ah */
    TEST_ASSERT_INT32_WITHIN(before / 200, before / 9 * 10, energy_left());
    config.load = 0;
    before = energy_left();
    battery.filter.offset = 0;
    TEST_ASSERT_EQUAL_INT32(before, energy_left());
}

static void test_forecast_is_as_uncertain_as_the_charge(void)
{
    struct jp_forecast left;

    start(CAPACITY * COULOMB / 2);
    cells.capacity_deviation = JP_Q24(0.001);
    cells.resistance_deviation = cells.slowness_deviation = JP_Q24(0.001);
    cells.offset_deviation = 0;
    start(CAPACITY * COULOMB / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_forecast_left(&battery, &config, &left));
    TEST_ASSERT_EQUAL_INT32(jp_energy_to_q16(jp_battery_energy_left(&battery, &config), 3), left.energy);
    /* 1/32 of 10080 A·s at 22.2 V, in 8 J */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(12), JP_Q16(874), left.deviation);
    config.load = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_forecast_left(&battery, &config, &left));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(12), JP_Q16(874), left.deviation);
}

/* Headroom */

/* Energies that a meter may report and no cell bears. */

static void test_currents_that_no_cell_bears_overflow_nothing(void)
{
    struct jp_battery_state state;
    const char *field;

    cells.polarisation = JP_Q24_ONE;
    cells.polarisation_keep = (jp_q31)2126008811; /* 0.99 */
    cells.slowness_deviation = JP_Q24_ONE;
    start(CAPACITY * COULOMB);
    seconds(300, 2 * JP_BATTERY_ENERGY_STEP * JOULE, JP_Q16(12));
    TEST_ASSERT_TRUE(battery.filter.polarisation <= 16 * Q48);
    jp_battery_save(&battery, &config, &state);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&battery, &config, &state, meter, &field));
}

static void test_a_stored_covariance_that_contradicts_itself_overflows_nothing(void)
{
    struct jp_battery_state state;
    struct jp_battery_voltage expected;
    const char *field;

    start(CAPACITY / 2 * COULOMB);
    jp_battery_save(&battery, &config, &state);
    for (size_t i = 0; i < JP_BATTERY_UNKNOWNS; i++) {
        state.filter.covariance[i][i] = 1;
    }
    state.filter.covariance[JP_BATTERY_CHARGE][JP_BATTERY_CAPACITY] = Q48;
    state.filter.covariance[JP_BATTERY_CAPACITY][JP_BATTERY_CHARGE] = Q48;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&battery, &config, &state, meter, &field));
    jp_battery_voltage_at(&battery, &config, 0, &expected);
    TEST_ASSERT_EQUAL_UINT8(0, second(0, expected.voltage));
    TEST_ASSERT_TRUE(battery.charge >= 0 && battery.charge <= battery.capacity);
}

static void test_a_load_that_no_cell_bears_leaves_nothing(void)
{
    struct jp_forecast left;

    for (size_t i = 0; i < JP_BATTERY_POINTS; i++) {
        cells.resistance[i] = JP_Q24_ONE;
    }
    cells.series = 200;
    cells.polarisation = JP_Q24_ONE;
    cells.resistance_deviation = JP_Q24_ONE;
    cells.slowness_deviation = JP_Q24_ONE;
    config.capacity = 262144;
    config.load = JP_Q16(1024);
    start((jp_charge)262144 * COULOMB);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_battery_forecast_left(&battery, &config, &left));
    TEST_ASSERT_EQUAL_INT32(0, left.energy);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, left.deviation);
}

static void test_without_cells_no_second_is_summed_up(void)
{
    config.cells = NULL;
    config.voltage_min = JP_Q16_ONE;
    start(CAPACITY * COULOMB);
    for (unsigned i = 0; i < 140000; i++) {
        meter = (jp_energy)((uint64_t)meter + (uint64_t)(JP_BATTERY_ENERGY_STEP * JOULE)); /* wraps as a meter's */
        (void)jp_battery_update(&battery, &config, meter, JP_Q16_ONE);
    }
    TEST_ASSERT_TRUE(battery.charge == 0);
}

static void test_voltage_at_a_current(void)
{
    struct jp_battery_voltage expected;
    const jp_q16 drop = (jp_q16)(((int64_t)cells.resistance[12] * 4 * SERIES) >> 8);

    start(CAPACITY * COULOMB / 2);
    jp_battery_voltage_at(&battery, &config, 0, &expected);
    TEST_ASSERT_INT32_WITHIN(8, bus_at(12), expected.voltage);
    TEST_ASSERT_GREATER_THAN_INT32(0, expected.deviation);
    jp_battery_voltage_at(&battery, &config, JP_Q16(4), &expected);
    TEST_ASSERT_INT32_WITHIN(8, bus_at(12) - drop, expected.voltage);
    battery.filter.polarisation = Q48 / 100;
    jp_battery_voltage_at(&battery, &config, JP_Q16(4), &expected);
    TEST_ASSERT_INT32_WITHIN(16, bus_at(12) - drop - JP_Q16(0.06), expected.voltage);
}

/* V at P, and P at V: one is the other's inverse. */
static void test_what_the_bus_lacks(void)
{
    jp_q16 voltage;

    start(CAPACITY * COULOMB / 2);
    config.voltage_designed = JP_Q16(24);
    for (int watts = 0; watts <= 60; watts += 20) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_voltage_under(&battery, &config, JP_Q16(1) * watts, &voltage));
        TEST_ASSERT_EQUAL_INT32(JP_Q16(24) - voltage, jp_battery_lacks(&battery, &config, JP_Q16(1) * watts));
    }
    /* More than it can give: half of the open circuit's is left. */
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_battery_voltage_under(&battery, &config, JP_Q16(20000), &voltage));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(24) - voltage, jp_battery_lacks(&battery, &config, JP_Q16(20000)));
    config.voltage_designed = JP_Q16(12);
    TEST_ASSERT_EQUAL_INT32(0, jp_battery_lacks(&battery, &config, JP_Q16(20)));
    config.voltage_designed = 0;
    TEST_ASSERT_EQUAL_INT32(0, jp_battery_lacks(&battery, &config, JP_Q16(20)));
}

static void test_power_and_voltage_are_of_each_other(void)
{
    start(CAPACITY * COULOMB / 2);
    for (int32_t watts = 0; watts <= 400; watts += 50) {
        jp_q16 voltage = 0;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_voltage_under(&battery, &config, JP_Q16(1) * watts, &voltage));
        TEST_ASSERT_LESS_OR_EQUAL_INT32(bus_at(12) + 8, voltage);
        TEST_ASSERT_INT32_WITHIN(JP_Q16(0.2), JP_Q16(1) * watts, jp_battery_power_at(&battery, &config, voltage));
    }
}

static void test_more_than_there_is_is_refused(void)
{
    jp_q16 voltage = 0;

    start(CAPACITY * COULOMB / 2);

    const jp_q16 most = jp_battery_power_at(&battery, &config, 0);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_voltage_under(&battery, &config, most - JP_Q16(1), &voltage));
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_battery_voltage_under(&battery, &config, most + JP_Q16(1), &voltage));
    TEST_ASSERT_INT32_WITHIN(8, bus_at(12) / 2, voltage);
    TEST_ASSERT_EQUAL_INT32(0, jp_battery_power_at(&battery, &config, JP_Q16(30)));
    battery.filter.resistance = 4 * Q48;
    TEST_ASSERT_LESS_THAN_INT32(most, jp_battery_power_at(&battery, &config, 0));
}
