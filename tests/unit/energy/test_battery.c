/* Coulomb counting: configuration, both directions, the ends of the charge, implausible readings, wraps. */
#include <joulepath/battery.h>

#include <stddef.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define JOULE    ((jp_energy)1 << 32)
#define COULOMB  ((jp_charge)1 << 32)
#define CAPACITY 8595 /* 53 Wh at 22.2 V */

static const struct jp_battery_config lithium = {
    .capacity = CAPACITY,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22),
    .voltage_full = JP_Q16(26),
    .voltage_min = JP_Q16(15),
    .voltage_max = JP_Q16(30),
    .voltage_jump = JP_Q16(3),
    .charge_efficiency = JP_Q16_ONE,
    .reserve = (jp_q31)1 << 28, /* an eighth */
};

static struct jp_battery_config config;
static struct jp_battery battery;
static jp_energy meter;

void setUp(void)
{
    config = lithium;
    meter = 0;
}

void tearDown(void)
{
}

static void start(jp_charge charge)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, charge, meter));
}

/** An update after this energy was drawn. */
static uint8_t draw(jp_energy energy, jp_q16 voltage)
{
    meter = (jp_energy)((uint64_t)meter + (uint64_t)energy);
    return jp_battery_update(&battery, &config, meter, voltage);
}

/* Configuration */

DEFINE_EXPECT_CONFIG_OF(jp_battery_check, lithium)

static void test_checks_every_field_at_its_limits(void)
{
    expect_config(NULL);
    RANGE("battery.", capacity, 60, 262144);
    AT_LEAST("battery.", charge_efficiency, JP_Q16(0.5));
    FIELD(charge_efficiency, JP_Q16_ONE + 1, "battery.charge_efficiency");
    RANGE("battery.", reserve, 0, (jp_q31)1 << 30);
    RANGE("battery.", charge_deviation, 0, (jp_q31)1 << 30);
    RANGE("battery.", unit_exponent, -15, 15);
    AT_LEAST("battery.", voltage_jump, 1);
}

static void test_voltages_are_in_order(void)
{
    AT_LEAST("battery.", voltage_min, JP_Q16_ONE);
    FIELD(voltage_min, JP_Q16(18), NULL);
    FIELD(voltage_min, JP_Q16(18) + 1, "battery.voltage_empty");
    AT_MOST("battery.", voltage_max, JP_Q16(1000));
    FIELD(voltage_max, JP_Q16(26), NULL);
    FIELD(voltage_max, JP_Q16(26) - 1, "battery.voltage_full");
    FIELD(voltage_full, JP_Q16(18), "battery.voltage_full");
    FIELD(voltage_nominal, JP_Q16(18), NULL);
    FIELD(voltage_nominal, JP_Q16(18) - 1, "battery.voltage_nominal");
    AT_MOST("battery.", voltage_nominal, JP_Q16(26));
}

/* Start */

static void test_goes_on_from_the_stored_charge(void)
{
    meter = 1000 * JOULE;
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(24)));
    TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(24 * JOULE, JP_Q16(24)));
    TEST_ASSERT_EQUAL_INT64(4999 * COULOMB, battery.charge);
}

static void test_takes_no_charge_that_the_battery_cannot_have(void)
{
    struct jp_battery before;

    start(5 * COULOMB);
    before = battery;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_start(&battery, &config, -1, 7));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_start(&battery, &config, CAPACITY * COULOMB + 1, 7));
    TEST_ASSERT_EQUAL_MEMORY(&before, &battery, sizeof battery);
    start(0);
    start(CAPACITY * COULOMB);
}

static void test_estimates_from_the_open_circuit_voltage(void)
{
    static const struct {
        jp_q16 voltage;
        jp_charge charge;
    } cases[] = {
        {JP_Q16(15), 0},
        {JP_Q16(18), 0},
        {JP_Q16(20), CAPACITY * COULOMB / 4},
        {JP_Q16(22), CAPACITY * COULOMB / 2},
        {JP_Q16(26) - 1, CAPACITY * COULOMB - CAPACITY * COULOMB / JP_Q16(8)},
        {JP_Q16(26), CAPACITY * COULOMB},
        {JP_Q16(30), CAPACITY * COULOMB},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        jp_charge charge = -1;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, cases[i].voltage, &charge));
        TEST_ASSERT_INT64_WITHIN(1, cases[i].charge, charge);
        start(charge);
    }
}

static void test_estimates_nothing_from_an_implausible_voltage(void)
{
    jp_charge charge = 77;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_estimate(&config, JP_Q16(15) - 1, &charge));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_estimate(&config, JP_Q16(30) + 1, &charge));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_estimate(&config, INT32_MIN, &charge));
    TEST_ASSERT_EQUAL_INT64(77, charge);
}

static void test_estimate_holds_at_the_ends_of_the_configuration(void)
{
    jp_charge charge = 0;

    config = (struct jp_battery_config){.capacity = 262144,
                                        .voltage_min = JP_Q16_ONE,
                                        .voltage_empty = JP_Q16_ONE,
                                        .voltage_full = JP_Q16(1000),
                                        .voltage_max = JP_Q16(1000)};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, JP_Q16(1000), &charge));
    TEST_ASSERT_EQUAL_INT64(262144 * COULOMB, charge);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, JP_Q16_ONE + 1, &charge));
    TEST_ASSERT_EQUAL_INT64(262144 * COULOMB / (999 * 65536), charge);
}

/* Counting */

static void test_charge_is_energy_over_voltage(void)
{
    start(8000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(40 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(7998 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(66 * JOULE, JP_Q16(22)));
    TEST_ASSERT_EQUAL_INT64(7995 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(JOULE / 2, JP_Q16(25)));
    TEST_ASSERT_INT64_WITHIN(1, 7995 * COULOMB - COULOMB / 50, battery.charge);
}

static void test_recuperation_charges_less_than_it_gives(void)
{
    config.charge_efficiency = JP_Q16(0.75);
    start(4000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(-80 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(4003 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(80 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(3999 * COULOMB, battery.charge);
}

static void test_remainders_are_carried_in_both_directions(void)
{
    start(4000 * COULOMB);
    /* 1/24 of a step each. */
    for (int i = 0; i < 24000; i++) {
        TEST_ASSERT_EQUAL_UINT8(0, draw(1, JP_Q16(24)));
    }
    TEST_ASSERT_INT64_WITHIN(1, 4000 * COULOMB - 1000, battery.charge);
    for (int i = 0; i < 24000; i++) {
        TEST_ASSERT_EQUAL_UINT8(0, draw(-1, JP_Q16(24)));
    }
    TEST_ASSERT_INT64_WITHIN(1, 4000 * COULOMB, battery.charge);

    /* Drawn with a remainder from a whole number: the next lower one, and the rest of it. */
    start(4000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(6, JP_Q16(24)));
    TEST_ASSERT_EQUAL_INT64(4000 * COULOMB - 1, battery.charge);
    TEST_ASSERT_EQUAL_HEX32(0xC0000000U, battery.fraction);
    TEST_ASSERT_EQUAL_UINT8(0, draw(-6, JP_Q16(24)));
    TEST_ASSERT_EQUAL_INT64(4000 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_HEX32(0, battery.fraction);
}

static void test_meter_may_wrap(void)
{
    meter = INT64_MAX - JOULE;
    start(1000 * COULOMB);
    (void)draw(0, JP_Q16(20));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_LESS_THAN_INT64(0, meter);
    TEST_ASSERT_EQUAL_INT64(999 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(-20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(1000 * COULOMB, battery.charge);
}

static void test_largest_step_at_the_ends_of_the_voltage(void)
{
    config = (struct jp_battery_config){.capacity = 262144,
                                        .voltage_min = JP_Q16_ONE,
                                        .voltage_max = JP_Q16(1000),
                                        .voltage_jump = INT32_MAX,
                                        .charge_efficiency = JP_Q16_ONE};
    start(100000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(JP_BATTERY_ENERGY_STEP * JOULE, JP_Q16_ONE));
    TEST_ASSERT_EQUAL_INT64((100000 - JP_BATTERY_ENERGY_STEP) * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(-JP_BATTERY_ENERGY_STEP * JOULE, JP_Q16_ONE));
    TEST_ASSERT_EQUAL_INT64(100000 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(10000 * JOULE, JP_Q16(1000)));
    TEST_ASSERT_EQUAL_INT64(99990 * COULOMB, battery.charge);
}

/* The ends of the charge */

static void test_empty_below_the_reserve(void)
{
    const jp_charge reserve = CAPACITY * COULOMB / 8;

    start(reserve + COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(reserve, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(reserve - COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(-41 * JOULE, JP_Q16(20)));
}

static void test_charge_ends_at_nothing(void)
{
    start(COULOMB);
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(0, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(1, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(0, battery.charge);
    TEST_ASSERT_EQUAL_HEX32(0, battery.fraction);
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY, draw(16000 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(0, battery.charge);
    TEST_ASSERT_EQUAL_INT32(0, jp_battery_level(&battery));
}

static void test_full_battery_takes_no_more_and_says_so(void)
{
    start((CAPACITY - 1) * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(-10 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_FULL, draw(-15 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(CAPACITY * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_HEX32(0, battery.fraction);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_FULL, draw(-1, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(0, draw(20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64((CAPACITY - 1) * COULOMB, battery.charge);
}

/* Readings that cannot be */

static void test_voltage_out_of_limits_is_named_and_counts_later(void)
{
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(16)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_LOW, draw(20 * JOULE, JP_Q16(15) - 1));
    TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
    for (unsigned i = 0; i < JP_BATTERY_CONFIRM; i++) {
        TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_LOW, draw(16 * JOULE, JP_Q16(16)));
        TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
    }
    TEST_ASSERT_EQUAL_UINT8(0, draw(12 * JOULE, JP_Q16(16)));
    TEST_ASSERT_EQUAL_INT64(4995 * COULOMB, battery.charge);
}

static void test_voltage_above_the_limit(void)
{
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(30)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_HIGH, draw(20 * JOULE, JP_Q16(30) + 1));
    TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
}

static void test_every_reason_of_a_bad_reading_is_named(void)
{
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(24)));
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(21)));
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(24)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_JUMP, draw(0, JP_Q16(21) - 1));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_JUMP, draw(0, JP_Q16(24)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_JUMP | JP_BATTERY_VOLTAGE_LOW, draw(0, JP_Q16(0)));
    /* After 0 V, which stands for no reading. */
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_HIGH, draw(0, INT32_MAX));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_JUMP | JP_BATTERY_VOLTAGE_LOW, draw(0, INT32_MIN));
}

static void test_a_new_level_is_believed_after_some_updates(void)
{
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(24)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_JUMP, draw(10 * JOULE, JP_Q16(20)));
    for (unsigned i = 0; i < JP_BATTERY_CONFIRM; i++) {
        TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_VOLTAGE_JUMP, draw(10 * JOULE, JP_Q16(20)));
    }
    TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(4998 * COULOMB, battery.charge);
}

static void test_doubt_begins_anew_with_each_bad_reading(void)
{
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(24)));
    for (int i = 0; i < 100; i++) {
        TEST_ASSERT_NOT_EQUAL(0, draw(JOULE, i % 3 == 0 ? JP_Q16(20) : JP_Q16(24)));
        TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
    }
}

static void test_an_empty_battery_says_so_with_a_bad_voltage_too(void)
{
    start(COULOMB);
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_EMPTY | JP_BATTERY_VOLTAGE_LOW, draw(0, 0));
}

static void test_energy_that_jumps_is_left_out(void)
{
    start(5000 * COULOMB);
    TEST_ASSERT_EQUAL_UINT8(0, draw(0, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_ENERGY_JUMP, draw(JP_BATTERY_ENERGY_STEP * JOULE + 1, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_ENERGY_JUMP, draw(-JP_BATTERY_ENERGY_STEP * JOULE - 1, JP_Q16(20)));
    TEST_ASSERT_EQUAL_UINT8(JP_BATTERY_ENERGY_JUMP, draw(INT64_MIN, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(5000 * COULOMB, battery.charge);
    TEST_ASSERT_EQUAL_UINT8(0, draw(20 * JOULE, JP_Q16(20)));
    TEST_ASSERT_EQUAL_INT64(4999 * COULOMB, battery.charge);
}

/* What is left */

static void test_level(void)
{
    start(CAPACITY * COULOMB);
    TEST_ASSERT_EQUAL_INT32(JP_Q31_MAX, jp_battery_level(&battery));
    start(CAPACITY * COULOMB / 2);
    TEST_ASSERT_EQUAL_INT32((jp_q31)1 << 30, jp_battery_level(&battery));
    start(CAPACITY * COULOMB / 4 * 3);
    TEST_ASSERT_INT32_WITHIN(1, (jp_q31)3 << 29, jp_battery_level(&battery));
    start(0);
    TEST_ASSERT_EQUAL_INT32(0, jp_battery_level(&battery));
}

static void test_energy_left_is_above_the_reserve(void)
{
    const jp_charge reserve = CAPACITY * COULOMB / 8;

    start(reserve + 100 * COULOMB);
    TEST_ASSERT_EQUAL_INT64(2200 * JOULE, jp_battery_energy_left(&battery, &config));
    start(reserve);
    TEST_ASSERT_EQUAL_INT64(0, jp_battery_energy_left(&battery, &config));
    start(reserve - 1);
    TEST_ASSERT_EQUAL_INT64(0, jp_battery_energy_left(&battery, &config));
    start(0);
    TEST_ASSERT_EQUAL_INT64(0, jp_battery_energy_left(&battery, &config));
    start(reserve + 1);
    TEST_ASSERT_EQUAL_INT64(22, jp_battery_energy_left(&battery, &config));
    start(reserve + 0x1FFFF);
    TEST_ASSERT_EQUAL_INT64(22 * 0x1FFFF, jp_battery_energy_left(&battery, &config));
    config.voltage_nominal = JP_Q16(0.5);
    TEST_ASSERT_EQUAL_INT64(0xFFFF, jp_battery_energy_left(&battery, &config));
}

static void test_energy_of_the_largest_battery(void)
{
    config.capacity = 262144;
    config.voltage_nominal = JP_Q16(1000);
    config.reserve = 0;
    start(262144 * COULOMB);
    TEST_ASSERT_EQUAL_INT64(262144000 * JOULE, jp_battery_energy_left(&battery, &config));
    config.capacity = 72000; /* 20 Ah */
    config.voltage_nominal = JP_Q16(22.2);
    start(72000 * COULOMB - 12345);
    TEST_ASSERT_INT64_WITHIN(JOULE, 1598400 * JOULE, jp_battery_energy_left(&battery, &config));
}

static void test_forecast_of_what_is_left(void)
{
    struct jp_forecast left;

    config.charge_deviation = (jp_q31)1 << 26; /* 1/32 */
    config.unit_exponent = 3;
    start(CAPACITY * COULOMB / 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_forecast_left(&battery, &config, &left));
    TEST_ASSERT_INT32_WITHIN(8, (jp_q16)(CAPACITY * 22LL * 65536 * 3 / 8 / 8), left.energy);
    TEST_ASSERT_INT32_WITHIN(8, (jp_q16)(CAPACITY * 22LL * 65536 / 32 / 8), left.deviation);
}

static void test_forecast_names_what_it_cannot_do(void)
{
    struct jp_forecast left;

    config.charge_deviation = (jp_q31)1 << 26; /* 1/32 of the capacity, of which 7/8 are left */
    start(CAPACITY * COULOMB);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_battery_forecast_left(&battery, &config, &left));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, left.energy);
    TEST_ASSERT_INT32_WITHIN(64, INT32_MAX / 28, left.deviation);
    config.charge_deviation = (jp_q31)1 << 30;
    start(0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_battery_forecast_left(&battery, &config, &left));
    TEST_ASSERT_EQUAL_INT32(0, left.energy);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, left.deviation);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_forecast_left(NULL, &config, &left));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_forecast_left(&battery, NULL, &left));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_forecast_left(&battery, &config, NULL));
}
