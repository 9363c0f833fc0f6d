/* What a controller knows of its cells: what is refused, with which charge it begins, how often it updates whatever the
 * rate of its work, and what it tells. */
#include "hal/app/ecu_battery.h"

#include <joulepath/tables.h>
#include <string.h>

#include "unity.h"

#define JOULE ((jp_energy)1 << 32)

static struct jp_battery_config config;
static struct jp_ecu_battery battery;
static struct jp_ecu_supply supply;
static uint32_t now;

static void make(int32_t unit_exponent)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_ecu_battery_init(&battery, &config, unit_exponent, &field));
    TEST_ASSERT_FALSE(battery.has_started);
}

void setUp(void)
{
    config = jp_battery_config_courier24;
    supply = (struct jp_ecu_supply){.drawn = 77 * JOULE, .voltage = JP_Q16(22)};
    now = UINT32_MAX - 250U; /* it wraps on the way */
    make(0);
}

void tearDown(void)
{
}

/** At 1 kHz, while this power flows. */
static void pass(unsigned ticks, int32_t watts)
{
    for (unsigned i = 0; i < ticks; i++) {
        supply.drawn += watts * JOULE / 1000;
        jp_ecu_battery_pass(&battery, &supply, ++now, 1000);
    }
}

static void test_what_is_refused(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_battery_init(NULL, &config, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_battery_init(&battery, NULL, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_ecu_battery_init(&battery, &config, 0, NULL));
    config.cells = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_battery_init(&battery, &config, 0, &field));
    TEST_ASSERT_EQUAL_STRING("cells", field);
    config = jp_battery_config_courier24;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG,
                          jp_ecu_battery_init(&battery, &config, JP_ENERGY_UNIT_EXPONENT_MAX + 1, &field));
    TEST_ASSERT_EQUAL_STRING("battery.unit_exponent", field);
    config.capacity = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_ecu_battery_init(&battery, &config, 0, &field));
    TEST_ASSERT_EQUAL_STRING("battery.capacity", field);
}

static void test_every_pack_that_ships_is_taken(void)
{
    static const struct jp_battery_config *const packs[] = {&jp_battery_config_burger, &jp_battery_config_courier24,
                                                            &jp_battery_config_patrol, &jp_battery_config_zhang2018};

    for (unsigned i = 0; i < sizeof packs / sizeof packs[0]; i++) {
        config = *packs[i];
        make(2);
    }
}

static void test_it_knows_nothing_before_a_voltage(void)
{
    struct jp_forecast left = {1, 2};
    jp_energy energy = 1;
    jp_energy deviation = 1;

    TEST_ASSERT_FALSE(jp_ecu_battery_left(&battery, &left));
    jp_ecu_battery_tell(&battery, &energy, &deviation);
    TEST_ASSERT_TRUE(energy == 0 && deviation == 0);
    supply.voltage = 0;
    pass(500, 4);
    TEST_ASSERT_FALSE(battery.has_started);
    supply.voltage = JP_Q16(22);
    pass(1, 4);
    TEST_ASSERT_TRUE(battery.has_started);
}

static void test_it_begins_with_the_charge_of_the_voltage(void)
{
    jp_charge charge;

    pass(1, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_estimate(&config, JP_Q16(22), &charge));
    TEST_ASSERT_TRUE(battery.battery.charge == charge);
    TEST_ASSERT_EQUAL_INT32(0, jp_ecu_battery_given(&battery));
}

static void test_it_updates_at_its_rate(void)
{
    pass(1, 0);
    pass(99, 5);
    TEST_ASSERT_EQUAL_UINT32(0, battery.updates);
    pass(1, 5);
    TEST_ASSERT_EQUAL_UINT32(1, battery.updates);
    pass(950, 5);
    TEST_ASSERT_EQUAL_UINT32(10, battery.updates);
    /* The mean current is what it expects of what is forecast. */
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.003), jp_q16_divide(JP_Q16(5), config.voltage_nominal), battery.config.load);
}

static void test_a_slice_that_takes_long_does_not_slow_it(void)
{
    pass(1, 0);
    now += 1000;
    pass(1, 0);
    TEST_ASSERT_EQUAL_UINT32(1, battery.updates);
    pass(99, 0);
    TEST_ASSERT_EQUAL_UINT32(1, battery.updates);
    pass(1, 0);
    TEST_ASSERT_EQUAL_UINT32(2, battery.updates);
    /* A little late, and the next one comes when it would have. */
    now += 149;
    pass(1, 0);
    TEST_ASSERT_EQUAL_UINT32(3, battery.updates);
    pass(50, 0);
    TEST_ASSERT_EQUAL_UINT32(4, battery.updates);
}

static void test_what_the_bus_will_lack(void)
{
    jp_q16 standing;
    jp_q16 driving;

    supply.cruise = JP_Q16(6);
    pass(1, 0);
    pass(100, 4);
    TEST_ASSERT_EQUAL_INT32(jp_battery_lacks(&battery.battery, &battery.config, JP_Q16(6)),
                            jp_ecu_battery_lacks(&battery, &supply));
    standing = jp_ecu_battery_lacks(&battery, &supply);
    /* Of 24 V by 22 V of open circuit, and what the cells lose. */
    TEST_ASSERT_GREATER_THAN_INT32(JP_Q16(1.5), standing);
    TEST_ASSERT_LESS_THAN_INT32(JP_Q16(3), standing);
    /* The greatest power counts from then on. */
    pass(100, 60);
    driving = jp_ecu_battery_lacks(&battery, &supply);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(60), battery.power);
    TEST_ASSERT_GREATER_THAN_INT32(standing + JP_Q16(0.3), driving);
    pass(1000, 4);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.1), JP_Q16(60), battery.power);
    /* Nothing is lacking where it is not told for what the robot was designed. */
    battery.config.voltage_designed = 0;
    TEST_ASSERT_EQUAL_INT32(0, jp_ecu_battery_lacks(&battery, &supply));
}

static void test_what_it_has_given(void)
{
    make(-4);
    pass(1, 0);
    pass(1000, 3);
    TEST_ASSERT_INT32_WITHIN(16, 3 * 65536 * 16, jp_ecu_battery_given(&battery));
    make(3);
    pass(1, 0);
    pass(1000, 3);
    TEST_ASSERT_INT32_WITHIN(16, 3 * 65536 / 8, jp_ecu_battery_given(&battery));
}

static void test_what_is_told_is_what_is_left(void)
{
    struct jp_forecast left;
    jp_energy energy;
    jp_energy deviation;

    make(4); /* units of 16 J hold it */
    pass(1, 0);
    pass(300, 4);
    TEST_ASSERT_TRUE(jp_ecu_battery_left(&battery, &left));
    jp_ecu_battery_tell(&battery, &energy, &deviation);
    TEST_ASSERT_TRUE(energy == jp_energy_from_q16(left.energy, 4));
    TEST_ASSERT_TRUE(deviation == jp_energy_from_q16(left.deviation, 4));
}

/* What does not fit the robot's unit is told all the same. */
static void test_more_than_the_unit_holds_is_told(void)
{
    struct jp_forecast left;
    jp_energy energy;
    jp_energy deviation;

    make(-4);
    pass(1, 0);
    TEST_ASSERT_TRUE(jp_ecu_battery_left(&battery, &left));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, left.energy);
    jp_ecu_battery_tell(&battery, &energy, &deviation);
    TEST_ASSERT_TRUE(energy > 32768 * JOULE);
    TEST_ASSERT_TRUE(energy < (jp_energy)config.capacity * 24 * JOULE);
    /* The same share. */
    TEST_ASSERT_INT32_WITHIN(1000000, left.deviation, jp_saturate32(deviation / (energy / INT32_MAX)));
}

static void test_numbers_that_wrap(void)
{
    pass(1, 0);
    battery.updates = UINT32_MAX;
    pass(100, 4);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, battery.updates);
    TEST_ASSERT_TRUE(battery.config.load >= 0);
}
