/*
 * The model of cells against what physics and the data sheet say of it, and the plants that it feeds: charge, heat and
 * voltages add up; each plant's ledger with its cells' closes.
 *
 * prop_cells [--count N] [--seed S] [--json FILE]
 */
#include <math.h>
#include <stdio.h>

#include "sim/balancer/rig.h"
#include "sim/base/random.h"
#include "sim/files/cell_file.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/four_wheel/four_wheel_plant.h"
#include "sim/skid_steer/skid_world.h"
#include "tests/support/check.h"
#include "tests/support/options.h"
#include "unity.h"

#define CELL       "sim/robots/cells/inr18650_p28a.cfg"
#define HOUR       3600.0
#define LEDGER_BAR 0.001 /* of what the battery gave */

static struct options options = {.count = 40, .seed = 5};
static struct cell_constants cell;
static const struct cell_wiring single = {1, 1, 0, 0};
static const struct cell_condition full = {1, 23, 0};
static struct cell_pack pack;
static struct random noise;
static double worst_error;

void setUp(void)
{
    TEST_ASSERT_TRUE(cell_file_load(CELL, &cell));
    cell_pack_init(&pack, &cell, &single, &full);
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

static double between(double low, double high)
{
    return random_uniform(&noise, low, high);
}

static void draw(double amperes, double seconds)
{
    for (int i = 0; i < (int)(seconds * 10); i++) {
        cell_pack_step(&pack, amperes, 0.1);
    }
}

static double voltage(double amperes)
{
    const struct cell_source source = cell_pack_source(&pack);

    return source.open_v - source.resistance_ohm * amperes;
}

/* ---- The cell ---- */

static void test_curve_goes_through_the_measured_points(void)
{
    for (int i = 0; i < CELL_POINTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, cell.open_circuit_v[i], cell_open_circuit(&cell, cell.charge[i]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (cell.open_circuit_v[12] + cell.open_circuit_v[13]) / 2,
                              cell_open_circuit(&cell, (cell.charge[12] + cell.charge[13]) / 2));
    TEST_ASSERT_TRUE(cell_open_circuit(&cell, -0.01) < cell.open_circuit_v[0]);
    TEST_ASSERT_TRUE(cell_open_circuit(&cell, 1.01) > cell.open_circuit_v[CELL_POINTS - 1]);
}

/* Data sheet: 2.8 Ah at 0.56 A down to 2.5 V; here to the end of the measured curve, 2.7 V without load. */
static void test_a_cell_gives_what_its_data_sheet_says(void)
{
    double taken = 0;

    while (voltage(0.56) > 2.5) {
        cell_pack_step(&pack, 0.56, 1);
        taken += 0.56 / HOUR;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 2.8, taken);
}

/* Pulses of 10 A for 20 s: 17.2 mΩ at half charge, and the heat of a 16 A discharge stays below 75 °C at its end. */
static void test_pulses_find_the_resistance_of_the_source(void)
{
    pack.charge = 0.5;
    const double before = voltage(0);

    draw(10, 20);
    const double sunk = before - voltage(10) - (cell_open_circuit(&cell, 0.5) - cell_open_circuit(&cell, pack.charge));
    TEST_ASSERT_DOUBLE_WITHIN(0.0004, 0.0172, sunk / 10);
    draw(0, 300);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, cell_open_circuit(&cell, pack.charge), voltage(0));
}

static void test_polarisation_settles_in_its_time(void)
{
    pack.charge = 0.5;
    pack.cell.resistance.polarisation_activation_k = 0; /* it warms */
    pack.cell.ageing.resistance_per_cycle = 0;
    draw(1, 30);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, cell.resistance.polarisation_ohm * (1 - exp(-1)), pack.polarisation_v);
    draw(1, 300);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, cell.resistance.polarisation_ohm, pack.polarisation_v);
}

static double resistance_at(double temperature, double cycles)
{
    const struct cell_condition condition = {0.5, temperature, cycles};

    cell_pack_init(&pack, &cell, &single, &condition);
    return cell_pack_source(&pack).resistance_ohm;
}

static void test_cold_and_age_raise_the_resistance(void)
{
    const double usual = resistance_at(23, 0);

    TEST_ASSERT_DOUBLE_WITHIN(1e-12, cell_ohmic(&cell, 0.5), usual);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.30, resistance_at(5, 0) / resistance_at(20, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.5 * usual, resistance_at(23, 500));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.8 * 2.8 * HOUR, cell_pack_capacity(&pack));
}

static void test_throughput_ages(void)
{
    const double capacity = cell_pack_capacity(&pack);

    for (int i = 0; i < 10; i++) {
        draw(2, capacity / 2 * 0.9);
        draw(-2, capacity / 2 * 0.9);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 9, pack.cycles);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * capacity, capacity * (1 - 9 * cell.ageing.capacity_per_cycle),
                              cell_pack_capacity(&pack));
}

static void test_a_loaded_cell_warms_and_cools(void)
{
    draw(4, 900);
    TEST_ASSERT_TRUE(pack.temperature_c > 23.5 && pack.temperature_c < 40);
    draw(0, 8000);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 23, pack.temperature_c);
}

/* n in series, m in parallel: n times the voltage, m times the charge, one ledger. */
static void test_a_pack_is_its_cells(void)
{
    const struct cell_wiring wiring = {6, 2, 0.03, 0};
    struct cell_pack one = pack;

    cell_pack_init(&pack, &cell, &wiring, &full);
    for (int i = 0; i < 10000; i++) {
        const double amperes = between(-2, 5);
        cell_pack_step(&pack, 2 * amperes, 0.1);
        cell_pack_step(&one, amperes, 0.1);
    }
    const struct cell_source source = cell_pack_source(&pack);
    const struct cell_source of_one = cell_pack_source(&one);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, one.charge, pack.charge);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 6 * of_one.open_v, source.open_v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3 * of_one.resistance_ohm + 0.03, source.resistance_ohm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * pack.ledger.chemical, 12 * one.ledger.chemical, pack.ledger.chemical);
    TEST_ASSERT_TRUE(pack.ledger.ohmic > 0 && pack.ledger.polarisation > 0 && pack.ledger.wiring > 0);
}

/* ∫ U dq between two charges is what the ledger says, whatever the way; and the terminals see V = U − v − R i. */
static void test_energy_of_the_cell_is_the_area_below_its_curve(void)
{
    double seen = 0;
    double area = 0;

    for (int i = 0; i < 40000; i++) {
        const double amperes = between(-1, 2);
        const double before = voltage(amperes);
        cell_pack_step(&pack, amperes, 0.1);
        seen += (before + voltage(amperes)) / 2 * amperes * 0.1;
    }
    for (int i = 0; i < 100000; i++) {
        area += cell_open_circuit(&cell, 1 - (1 - pack.charge) * (i + 0.5) / 100000);
    }
    area *= (1 - pack.charge) / 100000 * cell_pack_capacity(&pack);
    TEST_ASSERT_TRUE(pack.charge > 0.05 && pack.charge < 0.9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * area, area, pack.ledger.chemical);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * seen, seen, pack.ledger.terminal);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * area, pack.ledger.chemical,
                              pack.ledger.terminal + pack.ledger.ohmic + pack.ledger.polarisation + pack.ledger.wiring);
}

/* ---- The plants ---- */

static struct cell_condition any_condition(void)
{
    return (struct cell_condition){between(0.1, 1), between(-5, 40), between(0, 500)};
}

static void feed_of(const char *robot, struct cell_constants *constants, struct cell_wiring *wiring)
{
    TEST_ASSERT_TRUE(pack_file_load_robot(robot, constants, wiring));
}

static void expect_closed(double cells, double robot)
{
    const double error = fabs(cells / robot - 1);

    worst_error = fmax(worst_error, error);
    TEST_ASSERT_TRUE(error < LEDGER_BAR);
}

/* What the cells gave less heat is what motors and electronics took. */
static void test_ledger_of_the_balancer_closes(void)
{
    static const struct jp_segment_command segment = {{JP_Q24(0.8), JP_Q24(0.3)}, JP_Q24(1), JP_Q16(5)};
    static struct rig rig;
    const struct robot_entry *entry = rig_find_robot("courier24");
    struct robot_file file;
    struct cell_constants constants;
    struct cell_wiring wiring;

    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &file));
    feed_of("courier24", &constants, &wiring);
    for (unsigned long i = 0; i < options.count / 10 + 1; i++) {
        const struct cell_condition condition = {between(0.4, 1), between(10, 40), between(0, 200)};

        TEST_ASSERT_TRUE(rig_init(&rig, entry, &file, options.seed + i));
        world_feed(&rig.world, &constants, &wiring, &condition);
        rig_release(&rig, 0.02);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&rig.robot, &segment));
        for (int tick = 0; tick < 8000; tick++) {
            rig_tick(&rig);
        }
        TEST_ASSERT_FALSE(rig.world.plant.fallen);
        const struct cell_ledger *ledger = &rig.world.pack.ledger;
        const double robot = rig.world.plant.ledger.electrical +
                             file.electronics.power_w * (double)rig.world.tick / file.control.rate_hz;
        expect_closed(ledger->chemical - ledger->ohmic - ledger->polarisation - ledger->wiring, robot);
        expect_closed(ledger->terminal, robot);
    }
}

static void test_ledger_of_skid_steer_closes(void)
{
    static const char *const names[] = {"zhang2018", "burger"};
    const struct skid_ground level = {NULL, NULL};
    const struct planar_pose origin = {0, 0, 0};
    static struct skid_plant plant;

    for (unsigned long i = 0; i < options.count / 4 + 1; i++) {
        const char *name = names[i % 2];
        const struct cell_condition condition = any_condition();
        struct skid_steer_model model;
        struct cell_constants constants;
        struct cell_wiring wiring;
        char path[64];

        (void)snprintf(path, sizeof path, "sim/robots/%s.cfg", name);
        TEST_ASSERT_TRUE(skid_robot_load(path, &model));
        feed_of(name, &constants, &wiring);
        skid_plant_init(&plant, &model, &level, &origin);
        skid_plant_feed(&plant, &constants, &wiring, &condition);
        for (int tick = 0; tick < 100; tick++) {
            const struct skid_input input = {.duty = {between(-0.3, 0.8), between(-0.3, 0.8)}, .driven = true};
            skid_plant_step(&plant, &input, 0.05);
        }
        const struct skid_ledger *ledger = &plant.state.ledger;
        const struct cell_ledger *cells = &plant.pack.ledger;
        TEST_ASSERT_TRUE(fabs(skid_plant_residual(&plant, 0)) < LEDGER_BAR * ledger->battery);
        expect_closed(cells->chemical - cells->polarisation, ledger->battery);
        expect_closed(cells->ohmic + cells->wiring, ledger->supply);
    }
}

static void test_ledger_of_four_wheels_closes(void)
{
    const struct planar_pose origin = {0, 0, 0};
    static struct four_wheel_plant plant;
    struct four_wheel_file robot;
    struct cell_constants constants;
    struct cell_wiring wiring;

    TEST_ASSERT_TRUE(four_wheel_file_load("sim/robots/patrol.cfg", &robot));
    feed_of("patrol", &constants, &wiring);
    for (unsigned long i = 0; i < options.count; i++) {
        const struct cell_condition condition = any_condition();
        const double speed = between(-1, 1.5);
        struct jp_wheels targets;

        four_wheel_plant_init(&plant, &robot, &origin);
        four_wheel_plant_feed(&plant, &constants, &wiring, &condition);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, cell_pack_source(&plant.pack).open_v, plant.bus_voltage);
        for (int wheel = 0; wheel < JP_WHEELS; wheel++) {
            targets.angle[wheel] = 0;
            targets.speed[wheel] = (jp_q24)lround(speed * JP_Q24_ONE);
        }
        for (int tick = 0; tick < 3 * FOUR_WHEEL_RATE_HZ; tick++) {
            four_wheel_plant_tick(&plant, &targets);
        }
        TEST_ASSERT_TRUE(plant.bus_voltage < cell_pack_source(&plant.pack).open_v);
        expect_closed(plant.pack.ledger.terminal, plant.ledger.battery);
    }
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", 100 * worst_error, "%", at_most(100 * LEDGER_BAR),
                "cells that feed the plants, largest gap of the ledger");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
