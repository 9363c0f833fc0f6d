/* Energy by voltage and current of the bus. */
#include <joulepath/bus_meter.h>
#include <stddef.h>

#include "unity.h"

static struct jp_bus_meter meter;

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_bus_meter_start(&meter, 100));
}

void tearDown(void)
{
}

static void test_start_wants_a_rate(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_bus_meter_start(NULL, 100));
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_bus_meter_start(&meter, 9));
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_bus_meter_start(&meter, 10001));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_bus_meter_start(&meter, 10));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_bus_meter_start(&meter, 10000));
    TEST_ASSERT_TRUE(meter.energy == 0);
}

static void expect_joules(double joules)
{
    const double error = (double)meter.energy / 4294967296.0 - joules;

    TEST_ASSERT_TRUE(error < 2e-6 * 10 && error > -2e-6 * 10);
}

/* 24 V · 1.5 A for 10 s. */
static void test_power_is_summed_up(void)
{
    for (int i = 0; i < 1000; i++) {
        jp_bus_meter_update(&meter, JP_Q16(24), JP_Q16(1.5));
    }
    expect_joules(360);
}

static void test_braking_gives_back(void)
{
    for (int i = 0; i < 100; i++) {
        jp_bus_meter_update(&meter, JP_Q16(24), JP_Q16(2));
        jp_bus_meter_update(&meter, JP_Q16(24), -JP_Q16(0.5));
    }
    expect_joules(48 - 12);
}

static void test_power_is_limited(void)
{
    jp_bus_meter_update(&meter, JP_Q16(1000), JP_Q16(1000));
    expect_joules(327.68);
}
