/*
 * The filter of known cells and its headroom against double precision: the same Kalman filter with dense matrices on
 * random drives of random cells; the voltage that a power leaves against the simulator's cells; and robots on low, old
 * and cold batteries whose pilots know what voltage is left.
 *
 * prop_battery_filter [--count N] [--seed S] [--json FILE]
 */
#include <joulepath/battery.h>
#include <joulepath/pilot.h>
#include <joulepath/tables.h>
#include <math.h>
#include <string.h>

#include "sim/balancer/rig.h"
#include "sim/base/random.h"
#include "sim/files/cell_file.h"
#include "sim/missions/navigation_skid.h"
#include "tests/support/options.h"
#include "unity.h"

#define N        JP_BATTERY_UNKNOWNS
#define Q24      16777216.0
#define Q48      281474976710656.0
#define JOULE    4294967296.0
#define Q16      65536.0
#define CAPACITY 10080

/* Of the charge, and of deviations: rounding to Q24 gains and gradients, summed over an hour. Near a bend of the curve
 * a difference of 1e-5 of the charge puts the two on different pieces for some seconds, whose slopes differ by half:
 * most of what their deviations differ by. */
#define CHARGE_BAR    2e-4
#define DEVIATION_BAR 0.05

static struct options options = {.count = 40, .seed = 11};
static struct cell_constants cell;
static struct cell_wiring wiring;
static struct random noise;
static double charge_error;
static double deviation_error;
static double saturated[2]; /* share of a skid drive's ticks, without and with headroom */

static const struct jp_battery_cells *const cells = &jp_battery_cells_courier24;

static const struct jp_battery_config config = {
    .capacity = CAPACITY,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22),
    .voltage_full = JP_Q16(25.2),
    .voltage_min = JP_Q16(12),
    .voltage_max = JP_Q16(30),
    .voltage_jump = JP_Q16(10),
    .charge_efficiency = JP_Q16_ONE,
    .reserve = JP_Q31_MAX / 10,
    .charge_deviation = JP_Q31_MAX / 20,
    .load = JP_Q16(1.2),
    .update_rate = 1,
    .cells = &jp_battery_cells_courier24,
    .unit_exponent = 3,
};

void setUp(void)
{
    TEST_ASSERT_TRUE(pack_file_load_robot("courier24", &cell, &wiring));
    random_init(&noise, options.seed);
}

void tearDown(void)
{
}

static double between(double low, double high)
{
    return random_uniform(&noise, low, high);
}

/* ---- The oracle ---- */

struct oracle {
    double x[N];
    double p[N][N];
};

static double of_q24(jp_q24 value)
{
    return value / Q24;
}

static double at(const jp_q24 *values, double charge, double *slope)
{
    unsigned i = 1;

    while (i < JP_BATTERY_POINTS - 1U && charge > of_q24(cells->charge[i])) {
        i++;
    }
    const double width = of_q24(cells->charge[i]) - of_q24(cells->charge[i - 1U]);

    *slope = (of_q24(values[i]) - of_q24(values[i - 1U])) / width;
    return of_q24(values[i - 1U]) + *slope * (charge - of_q24(cells->charge[i - 1U]));
}

static double square(double a)
{
    return a * a;
}

static void oracle_start(struct oracle *oracle, double share)
{
    const double deviation = config.charge_deviation / 2147483648.0;

    *oracle = (struct oracle){.x = {[JP_BATTERY_CHARGE] = share,
                                    [JP_BATTERY_RESISTANCE] = 1,
                                    [JP_BATTERY_SLOWNESS] = 1,
                                    [JP_BATTERY_CAPACITY] = 1}};
    oracle->p[JP_BATTERY_CAPACITY][JP_BATTERY_CAPACITY] = square(of_q24(cells->capacity_deviation));
    oracle->p[JP_BATTERY_CHARGE][JP_BATTERY_CAPACITY] = share * square(of_q24(cells->capacity_deviation));
    oracle->p[JP_BATTERY_CAPACITY][JP_BATTERY_CHARGE] = share * square(of_q24(cells->capacity_deviation));
    oracle->p[JP_BATTERY_CHARGE][JP_BATTERY_CHARGE] =
        square(share * of_q24(cells->capacity_deviation)) + square(deviation);
    oracle->p[JP_BATTERY_POLARISATION][JP_BATTERY_POLARISATION] = square(of_q24(cells->polarisation));
    oracle->p[JP_BATTERY_CURVE][JP_BATTERY_CURVE] = square(of_q24(cells->curve_deviation));
    oracle->p[JP_BATTERY_RESISTANCE][JP_BATTERY_RESISTANCE] = square(of_q24(cells->resistance_deviation));
    oracle->p[JP_BATTERY_SLOWNESS][JP_BATTERY_SLOWNESS] = square(of_q24(cells->slowness_deviation));
    oracle->p[JP_BATTERY_OFFSET][JP_BATTERY_OFFSET] = square(of_q24(cells->offset_deviation));
}

/* P = F P Fᵀ + Q of a second. */
static void oracle_predict(struct oracle *oracle, double current)
{
    const double keep = cells->polarisation_keep / 2147483648.0;
    const double polarised = of_q24(cells->polarisation) * (1 - keep) * current;
    const double stays = fmax(1 - fabs(current) / CAPACITY / of_q24(cells->curve_length), 0);
    double f[N][N] = {{0}};
    double fp[N][N] = {{0}};
    double x[N] = {0};
    double p[N][N] = {{0}};

    for (int i = 0; i < N; i++) {
        f[i][i] = 1;
    }
    f[JP_BATTERY_CHARGE][JP_BATTERY_OFFSET] = 1.0 / 3600;
    f[JP_BATTERY_POLARISATION][JP_BATTERY_POLARISATION] = keep;
    f[JP_BATTERY_POLARISATION][JP_BATTERY_SLOWNESS] = polarised;
    f[JP_BATTERY_CURVE][JP_BATTERY_CURVE] = stays;
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            x[i] += f[i][j] * oracle->x[j];
            for (int k = 0; k < N; k++) {
                fp[i][j] += f[i][k] * oracle->p[k][j];
            }
        }
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            for (int k = 0; k < N; k++) {
                p[i][j] += fp[i][k] * f[j][k];
            }
        }
    }
    x[JP_BATTERY_CHARGE] -= current / CAPACITY;
    memcpy(oracle->x, x, sizeof x);
    memcpy(oracle->p, p, sizeof p);
    oracle->p[JP_BATTERY_CURVE][JP_BATTERY_CURVE] += square(of_q24(cells->curve_deviation)) * (1 - square(stays));
    oracle->p[JP_BATTERY_CHARGE][JP_BATTERY_CHARGE] += square(of_q24(cells->charge_walk)) / 3600;
    oracle->p[JP_BATTERY_POLARISATION][JP_BATTERY_POLARISATION] += square(of_q24(cells->voltage_noise) / 64);
    oracle->p[JP_BATTERY_RESISTANCE][JP_BATTERY_RESISTANCE] += square(of_q24(cells->resistance_walk)) / 3600;
    oracle->p[JP_BATTERY_SLOWNESS][JP_BATTERY_SLOWNESS] += square(of_q24(cells->slowness_walk)) / 3600;
    oracle->p[JP_BATTERY_CAPACITY][JP_BATTERY_CAPACITY] += square(of_q24(cells->capacity_walk)) / 3600;
    oracle->p[JP_BATTERY_OFFSET][JP_BATTERY_OFFSET] += square(of_q24(cells->offset_walk)) / 3600;
}

static void oracle_correct(struct oracle *oracle, double current, double voltage)
{
    const double k = oracle->x[JP_BATTERY_CAPACITY];
    const double share = oracle->x[JP_BATTERY_CHARGE] / k;
    double slope;
    double none;
    const double open = at(cells->open_voltage, share, &slope);
    const double drop = at(cells->resistance, fmin(share, 1), &none) * current;
    const double sag = oracle->x[JP_BATTERY_RESISTANCE] * drop;
    const double h[N] = {[JP_BATTERY_CHARGE] = slope / k,
                         [JP_BATTERY_POLARISATION] = -1,
                         [JP_BATTERY_RESISTANCE] = -drop,
                         [JP_BATTERY_CURVE] = 1,
                         [JP_BATTERY_CAPACITY] = -slope * share / k};
    double ph[N] = {0};
    double s = square(of_q24(cells->voltage_noise)) + square(of_q24(cells->load_noise) * sag);

    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            ph[i] += oracle->p[i][j] * h[j];
        }
        s += h[i] * ph[i];
    }
    const double error = voltage - (open - sag + oracle->x[JP_BATTERY_CURVE] - oracle->x[JP_BATTERY_POLARISATION]);

    if (error * error > 25 * s) {
        return;
    }
    for (int i = 0; i < N; i++) {
        oracle->x[i] += ph[i] / s * error;
        for (int j = 0; j < N; j++) {
            oracle->p[i][j] -= ph[i] * ph[j] / s;
        }
    }
}

/* ---- The filter ---- */

struct run {
    struct jp_battery battery;
    struct oracle oracle;
    struct cell_pack pack;
    double energy;
};

static void second_of(struct run *run, double amperes)
{
    const struct cell_source source = cell_pack_source(&run->pack);
    const jp_q16 volts = (jp_q16)lround((source.open_v - source.resistance_ohm * amperes) * Q16);

    cell_pack_step(&run->pack, amperes, 1);
    run->energy += volts / Q16 * amperes;
    (void)jp_battery_update(&run->battery, &config, (jp_energy)(run->energy * JOULE), volts);
    oracle_predict(&run->oracle, amperes);
    oracle_correct(&run->oracle, amperes, volts / Q16 / wiring.series);
}

static double oracle_deviation(const struct oracle *oracle)
{
    const double k = oracle->x[JP_BATTERY_CAPACITY];
    const double share = oracle->x[JP_BATTERY_CHARGE] / k;

    return sqrt(oracle->p[JP_BATTERY_CHARGE][JP_BATTERY_CHARGE] -
                2 * share * oracle->p[JP_BATTERY_CHARGE][JP_BATTERY_CAPACITY] +
                share * share * oracle->p[JP_BATTERY_CAPACITY][JP_BATTERY_CAPACITY]) /
           k;
}

static void compare(const struct run *run)
{
    const double share = run->oracle.x[JP_BATTERY_CHARGE] / run->oracle.x[JP_BATTERY_CAPACITY];
    const double level = jp_battery_level(&run->battery) / 2147483648.0;
    const double deviation = jp_battery_level_deviation(&run->battery, &config) / 2147483648.0;

    charge_error = fmax(charge_error, fabs(level - share));
    deviation_error = fmax(deviation_error, fabs(deviation / oracle_deviation(&run->oracle) - 1));
}

static void expect_covariance(const struct jp_battery_filter *filter)
{
    for (int i = 0; i < N; i++) {
        TEST_ASSERT_TRUE(filter->covariance[i][i] > 0);
        for (int j = 0; j < i; j++) {
            const double limit = sqrt((double)filter->covariance[i][i] * (double)filter->covariance[j][j]);

            TEST_ASSERT_TRUE(filter->covariance[i][j] == filter->covariance[j][i]);
            TEST_ASSERT_TRUE(fabs((double)filter->covariance[i][j]) <= 1.001 * limit + 64);
        }
    }
}

static void test_filter_is_that_of_double_precision(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct cell_condition condition = {between(0.4, 0.9), between(0, 40), between(0, 400)};
        struct run run = {.energy = 0};
        const double told = condition.charge + between(-0.05, 0.05);
        double amperes = 0;

        cell_pack_init(&run.pack, &cell, &wiring, &condition);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&run.battery, &config, (jp_charge)(told * CAPACITY * JOULE), 0));
        oracle_start(&run.oracle, told);
        for (int second = 0; second < 3600 && run.pack.charge > 0.03; second++) {
            amperes = second % 7 == 0 ? between(-1, 4) : amperes;
            second_of(&run, amperes);
            if (second % 60 == 59) {
                compare(&run);
                expect_covariance(&run.battery.filter);
            }
        }
    }
    printf("charge within %.2g, deviation within %.2g\n", charge_error, deviation_error);
    TEST_ASSERT_TRUE(charge_error < CHARGE_BAR);
    TEST_ASSERT_TRUE(deviation_error < DEVIATION_BAR);
}

/* ---- Headroom ---- */

static void test_voltage_under_power_is_that_of_the_cells(void)
{
    for (unsigned long i = 0; i < 100 * options.count; i++) {
        const struct cell_condition condition = {between(0.02, 1), 23, 0};
        const double watts = between(0, 120);
        struct cell_pack pack;
        struct jp_battery battery;
        jp_q16 voltage;

        cell_pack_init(&pack, &cell, &wiring, &condition);
        TEST_ASSERT_EQUAL_INT(JP_OK,
                              jp_battery_start(&battery, &config, (jp_charge)(condition.charge * CAPACITY * JOULE), 0));
        const struct cell_source source = cell_pack_source(&pack);
        const double settled = source.resistance_ohm + wiring.series * cell.resistance.polarisation_ohm;
        const double exact = (source.open_v + sqrt(square(source.open_v) - 4 * settled * watts)) / 2;

        TEST_ASSERT_EQUAL_INT(JP_OK,
                              jp_battery_voltage_under(&battery, &config, (jp_q16)lround(watts * Q16), &voltage));
        /* The table has the resistance at the points of the curve. */
        TEST_ASSERT_DOUBLE_WITHIN(0.05, exact, voltage / Q16);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * watts + 0.05, watts, jp_battery_power_at(&battery, &config, voltage) / Q16);
    }
}

/* ---- Robots ---- */

/* 10 % of the charge, after 500 cycles, at -10 °C. */
static const struct cell_condition low_old_cold = {0.1, -10, 500};

/* The waypoints of courier24's mission. */
static const struct jp_point mission[] = {
    {JP_Q16(10), JP_Q16(10)}, {JP_Q16(20), JP_Q16(15)}, {JP_Q16(25), JP_Q16(25)}, {JP_Q16(15), JP_Q16(30)}};

struct drive {
    struct rig rig;
    struct jp_pilot pilot;
    struct jp_battery battery;
    struct jp_battery_config battery_config;
    double energy;           /* as metered, electronics included, J */
    double voltage;          /* sum of the second */
    double least;            /* bus, V */
    unsigned long saturated; /* ticks */
};

/* What the bus lacks while the robot takes what motion took at most so far. */
static jp_q16 lacking(const struct drive *drive, double watts)
{
    jp_q16 voltage;

    (void)jp_battery_voltage_under(&drive->battery, &config, (jp_q16)lround(watts * Q16), &voltage);
    return jp_sub((jp_q16)lround(drive->rig.world.robot.supply.voltage_v * Q16), voltage);
}

static void run_tick(struct drive *drive, unsigned long number)
{
    struct jp_telemetry telemetry;

    rig_tick(&drive->rig);
    drive->least = fmin(drive->least, drive->rig.world.bus_voltage);
    drive->voltage += drive->rig.world.bus_voltage;
    if (number % 1000 == 999) {
        (void)jp_battery_update(&drive->battery, &config, jp_robot_meter(&drive->rig.robot)->battery,
                                (jp_q16)lround(drive->voltage / 1000 * Q16));
        drive->voltage = 0;
    }
    jp_robot_telemetry(&drive->rig.robot, &telemetry);
    drive->saturated += telemetry.voltages.saturated;
}

static void test_balancer_drives_its_mission_on_a_low_old_and_cold_battery(void)
{
    const struct jp_pilot_config pilot = {&jp_energy_model_courier24_battery, &jp_learning_courier24_battery,
                                          JP_PILOT_BATTERY};
    const struct jp_pilot_route route = {mission, 4, JP_PILOT_STAND, NULL, 0};
    static struct drive drive;
    struct robot_file file;
    const char *field;

    TEST_ASSERT_TRUE(robot_file_load("sim/robots/courier24.cfg", &file));
    TEST_ASSERT_TRUE(rig_init(&drive.rig, rig_find_robot("courier24"), &file, options.seed));
    drive.least = INFINITY;
    world_feed(&drive.rig.world, &cell, &wiring, &low_old_cold);
    rig_release(&drive.rig, 0.02);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&drive.battery, &config, (jp_charge)(0.1 * CAPACITY * JOULE),
                                                  jp_robot_meter(&drive.rig.robot)->battery));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pilot_init(&drive.pilot, &pilot, &drive.rig.robot, &field));
    for (unsigned long tick = 0; tick < 120000; tick++) {
        run_tick(&drive, tick);
        if (tick == 5000) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_pilot_lack_voltage(&drive.pilot, lacking(&drive, 50)));
            TEST_ASSERT_TRUE(drive.pilot.internal.trajectory.voltage < file.supply.voltage_v * 0.75 * Q16);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_pilot_follow(&drive.pilot, &route));
            drive.saturated = 0;
        }
        (void)jp_pilot_work(&drive.pilot);
        if (tick > 6000 && drive.pilot.phase == JP_PILOT_RESTING) {
            break;
        }
    }
    printf("mission on a low, old and cold battery: bus %.2f V at least, %lu ticks saturated\n", drive.least,
           drive.saturated);
    TEST_ASSERT_FALSE(drive.rig.world.plant.fallen);
    TEST_ASSERT_EQUAL_INT(JP_PILOT_RESTING, drive.pilot.phase);
    TEST_ASSERT_EQUAL_INT(JP_OK, drive.pilot.status);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 15, drive.rig.world.plant.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 30, drive.rig.world.plant.y);
    TEST_ASSERT_TRUE(drive.least > file.control.voltage_min_v);
    TEST_ASSERT_EQUAL_UINT64(0, drive.saturated);
}

/* 5 %: at 10 % burger still has the voltage for its path up the slope. */
static const struct cell_condition lower = {0.05, -10, 500};

/* Share of the ticks of a drive of burger at which the bus had not the voltage that its controller asked for. */
static double saturated_share(bool with_headroom)
{
    const struct jp_terrain level = {.config = {.has_elevation = false}};
    const struct clearance_pose origin = {0, 0, 0};
    static const struct jp_point targets[] = {{JP_Q16(1.5), 0}, {JP_Q16(1.5), JP_Q16(1)}};
    const struct jp_skid_pilot_route route = {.targets = targets, .count = 2};
    static struct skid_slope climb;
    static struct navigation_skid skid;
    struct navigation_robot shown;
    struct skid_steer_model model;
    struct cell_constants burger;
    struct cell_wiring burger_wiring;
    struct jp_skid_telemetry telemetry;
    unsigned long ticks = 0;

    TEST_ASSERT_TRUE(skid_robot_load("sim/robots/burger.cfg", &model));
    climb = skid_slope_towards(model.limits.slope_deg, 0);
    TEST_ASSERT_TRUE(pack_file_load_robot("burger", &burger, &burger_wiring));
    TEST_ASSERT_TRUE(
        navigation_skid_init(&skid, skid_robot_find("burger"), &model, &level, NULL, &origin, options.seed, &shown));
    skid.world.plant.ground = skid_ground_slope(&climb);
    skid_plant_feed(&skid.world.plant, &burger, &burger_wiring, &lower);
    if (with_headroom) {
        const double lost = model.supply.voltage_v - skid.world.plant.attitude.bus_voltage;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_lack_voltage(&skid.pilot, (jp_q16)lround(lost * Q16)));
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_pilot_follow(&skid.pilot, &route));
    jp_skid_robot_telemetry(&skid.controller, &telemetry);
    const uint32_t before = telemetry.saturated_ticks;

    while (skid.pilot.phase != JP_SKID_PILOT_RESTING && ticks < 20000) {
        shown.tick(shown.self);
        (void)jp_skid_pilot_work(&skid.pilot);
        ticks++;
    }
    TEST_ASSERT_EQUAL_INT(JP_SKID_PILOT_RESTING, skid.pilot.phase);
    TEST_ASSERT_EQUAL_INT(JP_OK, skid.pilot.status);
    jp_skid_robot_telemetry(&skid.controller, &telemetry);
    return (double)(telemetry.saturated_ticks - before) / (double)ticks;
}

static void test_a_differential_drive_asks_for_what_there_is(void)
{
    saturated[0] = saturated_share(false);
    saturated[1] = saturated_share(true);
    printf(
        "burger up its slope on a lower, old and cold battery: %.2f %% of the ticks saturated, with headroom %.2f %%\n",
        100 * saturated[0], 100 * saturated[1]);
    TEST_ASSERT_TRUE(saturated[0] > 0);
    TEST_ASSERT_TRUE(saturated[1] == 0);
}

static void add_figures(json_t *figures)
{
    figures_add(figures, "make figures", 100 * charge_error, "%", at_most(100 * CHARGE_BAR),
                "filter of the battery's charge, largest error against double precision");
    figures_add(figures, "make figures", 100 * deviation_error, "%", at_most(100 * DEVIATION_BAR),
                "filter of the battery's charge, largest error of its deviation against double precision");
    figures_add(figures, "make figures", 100 * saturated[0], "%", no_bar,
                "burger up 10° at 5 %% of the charge, -10 °C and 500 cycles, ticks without the voltage asked for");
    figures_add(figures, "make figures", 100 * saturated[1], "%", no_bar,
                "burger up 10° at 5 %% of the charge, -10 °C and 500 cycles, the same with headroom");
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
