/*
 * Coulomb counting against sums of long double: no drift by rounding over ten million updates, the ends of the charge,
 * readings of any value, and a drive of the simulated robot whose plant knows the current of its battery.
 *
 * prop_battery [--count N] [--seed S] [--json FILE]
 */
#include <joulepath/battery.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define JOULE    4294967296.0
#define Q16_ONE  65536.0
#define FRACTION 18446744073709551616.0L /* 2⁻⁶⁴ A·s */

/* What is left of 2⁻⁶⁴ A·s an update, and of the oracle's own rounding. */
#define ORACLE_ERROR 1e-12L

#define DRIVE_BAR 0.001

static struct options options = {.count = 10000000, .seed = 1};

static double drift;       /* A·s, after options.count updates */
static double drive_error; /* of the charge that a drive takes, relative */

static const struct jp_battery_config lithium = {
    .capacity = 8595,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22.2),
    .voltage_full = JP_Q16(25.2),
    .voltage_min = JP_Q16(18),
    .voltage_max = JP_Q16(30),
    .voltage_jump = JP_Q16(30),
    .charge_efficiency = JP_Q16(0.98),
    .reserve = JP_Q31_MAX / 10,
};

void setUp(void)
{
    random_state = options.seed * 0x9E3779B97F4A7C15U;
}

void tearDown(void)
{
}

static int64_t between(int64_t low, int64_t high)
{
    return low + (int64_t)(random_bits() % (uint64_t)(high - low + 1));
}

/* The oracle */

/** A sum with what its additions lost (Neumaier). */
struct sum {
    long double value;
    long double lost;
};

static void add(struct sum *sum, long double term)
{
    const long double total = sum->value + term;

    sum->lost += fabsl(sum->value) >= fabsl(term) ? (sum->value - total) + term : (term - total) + sum->value;
    sum->value = total;
}

static long double drawn_charge(const struct jp_battery_config *config, jp_energy drawn, jp_q16 voltage)
{
    const long double share = drawn < 0 ? (long double)config->charge_efficiency / Q16_ONE : 1.0L;

    return (long double)drawn / JOULE * share / ((long double)voltage / Q16_ONE);
}

static long double counted(const struct jp_battery *battery)
{
    return (long double)battery->charge / JOULE + (long double)battery->fraction / FRACTION;
}

/* From less than a step of the charge to seconds at full power. */
static jp_energy random_energy(bool draws)
{
    static const jp_energy largest[] = {40, 100000, 1 << 26, (jp_energy)3 << 32, (jp_energy)400 << 32};
    const jp_energy size = between(0, largest[random_bits() % (sizeof largest / sizeof largest[0])]);

    return draws ? size : -size;
}

static void test_count_does_not_drift(void)
{
    const struct jp_battery_config *config = &lithium;
    struct jp_battery battery;
    jp_energy meter = INT64_MAX - ((jp_energy)1 << 40); /* it wraps soon */
    struct sum exact = {5000.0L, 0};
    bool draws = true;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, config, (jp_charge)5000 << 32, meter));
    for (unsigned long i = 0; i < options.count; i++) {
        const jp_q16 voltage = (jp_q16)between(config->voltage_min, config->voltage_max);

        draws = battery.charge > (jp_charge)7000 << 32 ||
                (battery.charge > (jp_charge)2000 << 32 && random_bits() % 5 != 0);

        const jp_energy drawn = random_energy(draws);

        meter = (jp_energy)((uint64_t)meter + (uint64_t)drawn);
        add(&exact, -drawn_charge(config, drawn, voltage));
        if (jp_battery_update(&battery, config, meter, voltage) != 0U) {
            TEST_FAIL_MESSAGE("a flag in the middle of the charge");
        }
    }
    drift = (double)fabsl(counted(&battery) - exact.value - exact.lost);
    TEST_ASSERT_TRUE(drift <= (double)options.count / FRACTION + ORACLE_ERROR);
}

/* The same energies, all in one direction: an error of one sign would add up. */
static void test_small_energies_add_up(void)
{
    const struct jp_battery_config *config = &lithium;
    const unsigned long updates = options.count / 10;
    struct jp_battery battery;
    struct sum exact = {5000.0L, 0};
    jp_energy meter = 0;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, config, (jp_charge)5000 << 32, meter));
    for (unsigned long i = 0; i < updates; i++) {
        const jp_q16 voltage = i % 2 == 0 ? JP_Q16(18) : JP_Q16(29.9);

        meter += 13;
        add(&exact, -drawn_charge(config, 13, voltage));
        (void)jp_battery_update(&battery, config, meter, voltage);
    }
    TEST_ASSERT_TRUE(fabsl(counted(&battery) - exact.value - exact.lost) <= updates / FRACTION + ORACLE_ERROR);
}

/* The ends */

static struct jp_battery_config random_config(void)
{
    struct jp_battery_config config = {
        .capacity = (uint32_t)between(60, 2000),
        .voltage_min = JP_Q16(18),
        .voltage_empty = JP_Q16(18),
        .voltage_nominal = JP_Q16(20),
        .voltage_full = JP_Q16(25.2),
        .voltage_max = JP_Q16(30),
        .voltage_jump = JP_Q16(30),
        .charge_efficiency = (jp_q16)between(JP_Q16(0.5), JP_Q16_ONE),
        .reserve = (jp_q31)between(0, (jp_q31)1 << 30),
    };
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_check(&config, &field));
    return config;
}

/* Equal but where rounding decides. */
static void expect_flag(bool expected, bool actual, double distance)
{
    if (fabs(distance) > 1e-9) {
        TEST_ASSERT_EQUAL_INT(expected, actual);
    }
}

static void live(void)
{
    const struct jp_battery_config config = random_config();
    const double reserve = config.capacity * (config.reserve / 2147483648.0);
    struct jp_battery battery;
    double charge = (double)between(0, config.capacity);
    jp_energy meter = (jp_energy)random_bits();

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, (jp_charge)charge * (jp_charge)JOULE, meter));
    for (int i = 0; i < 200; i++) {
        const jp_q16 voltage = (jp_q16)between(config.voltage_min, config.voltage_max);
        const jp_energy drawn = 20 * random_energy(random_bits() % 2 == 0);
        const double unlimited = charge - (double)drawn_charge(&config, drawn, voltage);

        meter = (jp_energy)((uint64_t)meter + (uint64_t)drawn);

        const unsigned flags = jp_battery_update(&battery, &config, meter, voltage);

        charge = fmin(fmax(unlimited, 0), config.capacity);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, charge, (double)counted(&battery));
        expect_flag(drawn < 0 && unlimited >= config.capacity, (flags & JP_BATTERY_FULL) != 0,
                    unlimited - config.capacity);
        expect_flag(charge <= reserve, (flags & JP_BATTERY_EMPTY) != 0, charge - reserve);
        TEST_ASSERT_EQUAL_UINT(0, flags & ~(unsigned)(JP_BATTERY_FULL | JP_BATTERY_EMPTY));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, charge / config.capacity, jp_battery_level(&battery) / 2147483648.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, fmax(charge - reserve, 0) * 20,
                                  (double)jp_battery_energy_left(&battery, &config) / JOULE);
        charge = (double)counted(&battery);
    }
}

static void test_ends_of_the_charge(void)
{
    for (unsigned long i = 0; i < options.count / 10000; i++) {
        live();
    }
}

/* Readings of any value */

static jp_q16 any_voltage(jp_q16 last)
{
    switch (random_bits() % 6) {
    case 0:
        return (jp_q16)(uint32_t)random_bits();
    case 1:
        return (jp_q16)between(JP_Q16(17), JP_Q16(31));
    case 2:
        return 0;
    default:
        return jp_clamp32((jp_q16)between(-JP_Q16(0.2), JP_Q16(0.2)) + jp_clamp32(last, 0, JP_Q16(40)), JP_Q16(17.9),
                          JP_Q16(30.1));
    }
}

static unsigned expected_reason(const struct jp_battery_config *config, jp_q16 last, jp_q16 voltage)
{
    const double change = (double)voltage - (double)last;

    return (voltage < config->voltage_min ? (unsigned)JP_BATTERY_VOLTAGE_LOW : 0U) |
           (voltage > config->voltage_max ? (unsigned)JP_BATTERY_VOLTAGE_HIGH : 0U) |
           (last != 0 && fabs(change) > config->voltage_jump ? (unsigned)JP_BATTERY_VOLTAGE_JUMP : 0U);
}

static void test_readings_of_any_value(void)
{
    const unsigned of_voltage = JP_BATTERY_VOLTAGE_LOW | JP_BATTERY_VOLTAGE_HIGH | JP_BATTERY_VOLTAGE_JUMP;
    struct jp_battery_config config = lithium;
    struct jp_battery battery;
    jp_q16 last = 0;
    unsigned reason = 0;
    unsigned wait = 0;
    unsigned long believed = 0;

    config.voltage_jump = JP_Q16(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, (jp_charge)4000 << 32, 0));
    for (unsigned long i = 0; i < options.count / 10; i++) {
        const jp_q16 voltage = any_voltage(last);
        const jp_energy energy =
            random_bits() % 8 == 0 ? (jp_energy)random_bits() : battery.energy + random_energy(true);
        const jp_charge before = battery.charge;
        const unsigned found = expected_reason(&config, last, voltage);
        const unsigned flags = jp_battery_update(&battery, &config, energy, voltage);

        wait = found != 0 ? JP_BATTERY_CONFIRM + 1 : wait - (wait > 0);
        reason = found != 0 ? found : reason;
        TEST_ASSERT_EQUAL_UINT(wait > 0 ? reason : 0, flags & of_voltage);
        TEST_ASSERT_TRUE(battery.charge >= 0 && battery.charge <= battery.capacity);
        if (flags & (of_voltage | JP_BATTERY_ENERGY_JUMP)) {
            TEST_ASSERT_EQUAL_INT64(before, battery.charge);
        } else {
            believed++;
        }
        if (battery.charge <= battery.reserve) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, (jp_charge)4000 << 32, energy));
            last = 0;
            wait = 0;
        } else {
            last = voltage;
        }
    }
    TEST_ASSERT_TRUE(believed > options.count / 1000);
}

/* In the loop */

#define DRIVE_TICKS  30000
#define UPDATE_TICKS 100

/** What left the plant's battery, A·s: its own current, tick by tick. */
static double plant_charge(const struct world *world, double electrical_before)
{
    const double energy = world->plant.ledger.electrical - electrical_before +
                          world->robot.electronics.power_w * world_tick_seconds(world);

    return energy / world->bus_voltage;
}

static void drive(struct rig *rig, struct jp_battery *battery, double *exact)
{
    static const struct jp_segment_command segments[] = {{{JP_Q24(0.9), JP_Q24(0.2)}, JP_Q24(0.6), JP_Q16(8)},
                                                         {{JP_Q24(0), JP_Q24(0)}, JP_Q24(0), JP_Q16(6)},
                                                         {{JP_Q24(0.7), JP_Q24(-0.3)}, JP_Q24(-1), JP_Q16(6)}};

    for (int tick = 0; tick < DRIVE_TICKS; tick++) {
        const double before = rig->world.plant.ledger.electrical;

        if (tick % 10000 == 0) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&rig->robot, &segments[tick / 10000]));
        }
        rig_tick(rig);
        *exact += plant_charge(&rig->world, before);
        if (tick % UPDATE_TICKS == UPDATE_TICKS - 1) {
            TEST_ASSERT_EQUAL_UINT8(0, jp_battery_update(battery, &lithium, jp_robot_meter(&rig->robot)->battery,
                                                         rig->world.faults.last_read.bus_voltage));
        }
    }
}

static void test_counts_what_leaves_the_battery_of_a_driven_robot(void)
{
    static struct rig rig;
    const struct robot_entry *entry = rig_find_robot("courier24");
    const jp_charge start = (jp_charge)6000 << 32;
    struct robot_file file;
    struct jp_battery battery;
    double exact = 0;

    TEST_ASSERT_NOT_NULL(entry);
    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &file));
    TEST_ASSERT_TRUE(rig_init(&rig, entry, &file, options.seed));
    rig_release(&rig, 0.02);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &lithium, start, jp_robot_meter(&rig.robot)->battery));
    drive(&rig, &battery, &exact);

    const double taken = (double)(start - battery.charge) / JOULE;

    drive_error = fabs(taken / exact - 1);
    printf("a drive takes %.4f A·s, counted %.4f\n", exact, taken);
    TEST_ASSERT_TRUE(exact > 5);
    TEST_ASSERT_TRUE(drive_error <= DRIVE_BAR);
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", drift, "A·s", at_most(1e-9), "coulomb counting, drift after %lu updates",
                options.count);
    figures_add(figures, "make figures", 100 * drive_error, "%", at_most(100 * DRIVE_BAR),
                "coulomb counting on a driven courier24, error");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
