/* The energy meter: configuration, both definitions, recuperation, the ends of the range. */
#include <joulepath/meter.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/support/config_check.h"
#include "unity.h"

#define JOULE ((int64_t)1 << 32)

static struct jp_meter_config config;
static struct jp_meter meter;

void setUp(void)
{
    config = (struct jp_meter_config){.tick_rate = 1024, .motor_resistance = JP_Q16(4)};
}

void tearDown(void)
{
}

static void start(void)
{
    jp_meter_start(&meter, &config);
}

static void update(jp_q16 left, jp_q16 right, jp_q16 current_left, jp_q16 current_right)
{
    const struct jp_voltages voltages = {left, right, false};
    const struct jp_sensors sensors = {.current_left = current_left, .current_right = current_right};

    jp_meter_update(&meter, &voltages, &sensors);
}

DEFINE_EXPECT_CONFIG(meter)

static void test_checks_every_field_at_its_limits(void)
{
    config = jp_robot_courier24.meter;
    expect_config(NULL);
    RANGE("meter.", tick_rate, 100, 10000);
    AT_LEAST("meter.", motor_resistance, JP_Q16(0.01));
    config.tick_rate = 2500;
    FIELD(motor_resistance, INT32_MAX, NULL);
    config.tick_rate = 10000;
    FIELD(motor_resistance, JP_Q16(8192), NULL);
    config.tick_rate = 10000;
    FIELD(motor_resistance, JP_Q16(8192) + 1, "meter.motor_resistance");
    config.tick_rate = 100;
    FIELD(motor_resistance, JP_Q16(0.02) + 1, NULL); /* 2 Ω/s */
    config.tick_rate = 100;
    FIELD(motor_resistance, JP_Q16(0.02) - 1, "meter.motor_resistance");
    RANGE("meter.", electronics_power, 0, JP_Q16(256));
}

/** What leaves the battery in a second, J, for the left motor of 4 Ω by a bridge that burns this share. */
static jp_energy spent_with(jp_q16 share, jp_q16 voltage, jp_q16 current)
{
    const struct jp_voltages voltages = {voltage, 0, false};
    const struct jp_sensors sensors = {.current_left = current};

    start();
    for (uint32_t i = 0; i < config.tick_rate; i++) {
        jp_meter_update_battery(&meter, &voltages, &sensors);
        if (i % 2U == 1U) {
            jp_meter_burn(&meter, config.motor_resistance, share, &voltages, &sensors);
        }
    }
    return meter.battery;
}

#define EXPECT_POWER(watts, share, volts, amperes)                                                                     \
    TEST_ASSERT_INT64_WITHIN(JOULE / 5000, (int64_t)((watts) * (double)JOULE),                                         \
                             spent_with(JP_Q16(share), JP_Q16(volts), JP_Q16(amperes)))

static void test_a_bridge_burns_what_its_motor_generates(void)
{
    EXPECT_POWER(-6, 0, 6, -1);
    EXPECT_POWER(-3.5, 0.25, 6, -1); /* its back-EMF of 10 V generates 10 W */
    EXPECT_POWER(-1, 0.5, 6, -1);
    EXPECT_POWER(0, 0.75, 6, -1);
    EXPECT_POWER(0, 1, 6, -1);
    EXPECT_POWER(-3.5, 0.25, -6, 1);
}

static void test_a_bridge_burns_nothing_of_what_it_takes(void)
{
    EXPECT_POWER(6, 1, 6, 1);
    EXPECT_POWER(1, 1, 1, 1);   /* held against its motion: 4 V over the windings */
    EXPECT_POWER(1, 1, -1, -1); /* so backwards */
    EXPECT_POWER(0, 1, 0, 1);   /* shorted */
}

static void test_burning_on_both_sides_at_the_ends_of_the_range(void)
{
    const struct jp_voltages voltages = {JP_Q16(1024), JP_Q16(-1024), false};
    const struct jp_sensors sensors = {.current_left = JP_Q16(-1024), .current_right = JP_Q16(1024)};

    start();
    jp_meter_burn(&meter, JP_Q16(8192), JP_Q16_ONE, &voltages, &sensors);
    TEST_ASSERT_EQUAL_INT64((int64_t)4096 * JOULE, meter.battery); /* 2 · 2²⁰ W in two ticks of 1/1024 s */
}

static void test_both_definitions(void)
{
    config.electronics_power = JP_Q16(2);
    start();
    for (int i = 0; i < 1024; i++) {
        update(JP_Q16(6), JP_Q16(-2), JP_Q16(0.5), JP_Q16(-0.25));
    }
    TEST_ASSERT_EQUAL_INT64(12 * JOULE, meter.model);              /* (36 + 4)/4 + 2 */
    TEST_ASSERT_EQUAL_INT64(5 * JOULE + JOULE / 2, meter.battery); /* 3 + 0.5 + 2 */
}

static void test_braking_returns_energy(void)
{
    start();
    for (int i = 0; i < 1024; i++) {
        update(JP_Q16(6), JP_Q16(6), JP_Q16(-0.5), JP_Q16(-0.5));
    }
    TEST_ASSERT_EQUAL_INT64(-6 * JOULE, meter.battery);
    TEST_ASSERT_EQUAL_INT64(18 * JOULE, meter.model);
}

static void test_start_empties(void)
{
    start();
    update(JP_Q16(6), 0, JP_Q16(1), 0);
    start();
    TEST_ASSERT_EQUAL_INT64(0, meter.model);
    TEST_ASSERT_EQUAL_INT64(0, meter.battery);
}

static void test_electronics_alone(void)
{
    config = jp_robot_courier24.meter;
    start();
    for (int i = 0; i < 10000; i++) {
        update(0, 0, 0, 0);
    }
    TEST_ASSERT_INT64_WITHIN(5000, 40 * JOULE, meter.model); /* half a step a tick */
    TEST_ASSERT_EQUAL_INT64(meter.model, meter.battery);
}

static void test_small_voltages_count(void)
{
    /* 2⁻¹⁰ V on 1/16 Ω at 1 024 Hz: 2⁻²⁶ J a tick. */
    config.motor_resistance = JP_Q16_ONE / 16;
    start();
    update(64, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT64(64, meter.model);
}

static void test_greatest_voltages_and_currents(void)
{
    config = (struct jp_meter_config){.tick_rate = 100, .motor_resistance = JP_Q16(0.64), .electronics_power = 0};
    config.motor_resistance++;
    start();
    update(JP_Q16(1024), JP_Q16(-1024), JP_Q16(1024), JP_Q16(-1024));
    TEST_ASSERT_INT64_WITHIN(JOULE, (int64_t)32767 * JOULE, meter.model);
    TEST_ASSERT_INT64_WITHIN(JOULE / 100, (int64_t)2097152 * JOULE / 100, meter.battery);
    update(JP_Q16(1024), JP_Q16(-1024), JP_Q16(-1024), JP_Q16(1024));
    TEST_ASSERT_INT64_WITHIN(4, 0, meter.battery);

    config = (struct jp_meter_config){.tick_rate = 128, .motor_resistance = JP_Q16_ONE / 64}; /* 2 Ω/s */
    start();
    update(JP_Q16(1024), JP_Q16(-1024), 0, 0);
    TEST_ASSERT_EQUAL_INT64((int64_t)1048576 * JOULE, meter.model);
}

/* 1e-6 of the exact energy, whatever the resistance and the rate. */
static void test_every_resistance_is_accurate(void)
{
    static const uint32_t rates[] = {100, 1000, 10000};

    for (unsigned r = 0; r < sizeof rates / sizeof rates[0]; r++) {
        const jp_q16 most = rates[r] == 10000 ? JP_Q16(8192) : JP_Q16(28000);

        for (jp_q16 ohm = JP_Q16(0.02) + 1; ohm < most; ohm += ohm / 7) {
            const int64_t resistance_rate = (int64_t)ohm * rates[r];
            const int64_t whole = ((int64_t)2048 << 48) / resistance_rate * 1000; /* of 32² + 32² V² */

            config = (struct jp_meter_config){.tick_rate = rates[r], .motor_resistance = ohm};
            start();
            for (unsigned tick = 0; tick < 1000U; tick++) {
                update(JP_Q16(32), JP_Q16(-32), 0, 0);
            }
            TEST_ASSERT_INT64_WITHIN(whole / 1000000 + 1000, whole, meter.model);
        }
    }
}

/* 5 kΩ at 10 kHz: a volt is worth 17 steps a tick, which add up exactly but for half a step each. */
static void test_small_voltages_on_a_great_resistance(void)
{
    config = (struct jp_meter_config){.tick_rate = 10000, .motor_resistance = JP_Q16(5000)};
    start();
    for (unsigned tick = 0; tick < 10000U; tick++) {
        update(JP_Q16_ONE, 0, 0, 0);
    }
    TEST_ASSERT_INT64_WITHIN(5000, JOULE / 5000, meter.model);
}

static void test_energy_in_joules(void)
{
    TEST_ASSERT_EQUAL_INT32(0, jp_energy_to_q16(0, 0));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1.5), jp_energy_to_q16(JOULE + JOULE / 2, 0));
    TEST_ASSERT_EQUAL_INT32(1, jp_energy_to_q16(32768, 0));
    TEST_ASSERT_EQUAL_INT32(0, jp_energy_to_q16(32767, 0));
    TEST_ASSERT_EQUAL_INT32(-1, jp_energy_to_q16(-65536, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_energy_to_q16(32768 * JOULE, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_energy_to_q16(-40000 * JOULE, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_energy_to_q16(INT64_MAX, 0));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_energy_to_q16(INT64_MIN, 0));
}

static void test_energy_in_the_unit_of_a_model(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.75), jp_energy_to_q16(6 * JOULE, 3));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(24), jp_energy_to_q16(6 * JOULE, -2));
    TEST_ASSERT_EQUAL_INT32(-JP_Q16(32767), jp_energy_to_q16(-((int64_t)32767 << 15) * JOULE, 15));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, jp_energy_to_q16(JOULE, -15));
    TEST_ASSERT_EQUAL_INT32(1, jp_energy_to_q16(1, -15)); /* half a step, rounded */
    TEST_ASSERT_EQUAL_INT64(6 * JOULE, jp_energy_from_q16(JP_Q16(0.75), 3));
    TEST_ASSERT_EQUAL_INT64(-6 * JOULE, jp_energy_from_q16(-JP_Q16(24), -2));
    TEST_ASSERT_EQUAL_INT64(JOULE, jp_energy_from_q16(JP_Q16_ONE, 0));
}

/* Every number of a unit comes back from joules. */
/* As the other one where that does not overflow, but rounded down; differences hold everywhere. */
static void test_energy_that_wraps(void)
{
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1.5), jp_energy_to_wrapping_q16(JOULE + JOULE / 2, 0));
    TEST_ASSERT_EQUAL_INT32(-1, jp_energy_to_wrapping_q16(-1, 0));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.75), jp_energy_to_wrapping_q16(6 * JOULE, 3));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, jp_energy_to_wrapping_q16(32768 * JOULE, 0));
    for (jp_energy energy = -70000 * JOULE; energy < 70000 * JOULE; energy += 1234 * JOULE + 567) {
        const uint32_t before = (uint32_t)jp_energy_to_wrapping_q16(energy, 0);
        const uint32_t after = (uint32_t)jp_energy_to_wrapping_q16(energy + 9 * JOULE, 0);

        TEST_ASSERT_EQUAL_UINT32(JP_Q16(9), after - before);
    }
}

static void test_energy_there_and_back(void)
{
    static const jp_q16 numbers[] = {INT32_MIN, -1, 0, 1, 12345678, INT32_MAX};

    for (int32_t exponent = -15; exponent <= 15; exponent++) {
        for (unsigned i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
            TEST_ASSERT_EQUAL_INT32(numbers[i], jp_energy_to_q16(jp_energy_from_q16(numbers[i], exponent), exponent));
        }
    }
}
