/* Duties against the division in 64 bits: every width of the bus voltage, both ends, ties. */
#include "src/base/duty.h"
#include "unity.h"

#define BUS_MAX JP_Q16(1000)

void setUp(void)
{
}

void tearDown(void)
{
}

/** |voltage| <= bus. */
static jp_q31 expected(int32_t voltage, int32_t bus)
{
    const uint64_t size = jp_magnitude32(voltage);
    const uint64_t quotient = ((size << 32) / (uint64_t)bus + 1U) / 2U;
    const int64_t duty = voltage < 0 ? -(int64_t)quotient : (int64_t)quotient;

    return jp_saturate32(duty);
}

static void check(int32_t voltage, int32_t bus)
{
    const struct jp_bus divisor = jp_bus_of(bus);

    TEST_ASSERT_EQUAL_INT32(expected(voltage, bus), jp_duty(voltage, &divisor));
    TEST_ASSERT_EQUAL_INT32(expected(-voltage, bus), jp_duty(-voltage, &divisor));
}

static void check_bus(int32_t bus)
{
    check(0, bus);
    check(1, bus);
    check(bus / 3, bus);
    check(bus / 2, bus);
    check((int32_t)(((int64_t)bus * 5) / 8), bus);
    check(bus - 1, bus);
    check(bus, bus);
}

static void test_buses_of_every_width(void)
{
    for (unsigned bits = 1; bits < 26U; bits++) {
        const int32_t power = (int32_t)1 << bits;

        check_bus(power - 1);
        check_bus(power);
        check_bus(power + 1);
        check_bus(power + power / 3);
    }
    check_bus(1);
    check_bus(BUS_MAX - 1);
    check_bus(BUS_MAX);
}

static void test_random_voltages(void)
{
    uint32_t state = 1;

    for (int i = 0; i < 2000; i++) {
        state = state * 1664525U + 1013904223U;
        const int32_t bus = 1 + (int32_t)((state >> 6) % (uint32_t)BUS_MAX);

        state = state * 1664525U + 1013904223U;
        check((int32_t)((state >> 6) % ((uint32_t)bus + 1U)), bus);
    }
}

/** Left of a digit are less than three divisors, so that eight times of it fit a word. */
static void test_remainders_stay_small(void)
{
    for (int32_t bus = (int32_t)1 << 25; bus <= BUS_MAX; bus += 1021) {
        const struct jp_bus divisor = jp_bus_of(bus);
        uint32_t remainder = divisor.divisor;

        (void)jp_bus_digit(&divisor, &remainder);
        TEST_ASSERT_TRUE(remainder < 2U * divisor.divisor);
        remainder = 2U * divisor.divisor;
        (void)jp_bus_digit(&divisor, &remainder);
        TEST_ASSERT_TRUE(remainder < 3U * divisor.divisor);
    }
}
