/*
 * State of charge of batteries that nobody knows: cells of courier24, drawn by the rule below, are driven, rest and are
 * charged for 50 cycles; the filter knows the data sheet alone and reads sensors that are off. Prints figures as JSON,
 * progress on stderr.
 *
 * Rule, of each battery: capacity N(1, 0.08) of the data sheet's, resistances exp N(0, 0.2) times, both before 0 to 500
 * cycles have aged them; air of 0 °C to 40 °C, its day ±3 °C about it; current sensor's gain N(1, 0.01) and zero N(0,
 * 20 mA); voltage of 12 bits with 10 mV of noise. Normal numbers are drawn again beyond 3 deviations. First charge 30 %
 * to 100 %, told to the filter by a voltage at rest.
 */
#include <joulepath/battery.h>
#include <joulepath/tables.h>
#include <math.h>

#include "sim/base/digital.h"
#include "sim/base/parallel.h"
#include "sim/base/progress.h"
#include "sim/base/random.h"
#include "sim/files/cell_file.h"
#include "tests/bench/figures.h"
#include "tests/bench/statistics.h"

enum {
    BATTERIES = 120,
    CYCLES = 50,
    SEED = 20261127,
    RATE = 2,    /* updates a second */
    EVERY = 600, /* seconds from one comparison to the next */
    DAY = 86400, /* s */
};

#define COMMAND "make figures"

#define ERROR_BAR   2.0 /* % of the charge, of the worst battery in its last cycle */
#define HONEST_LOW  0.5 /* mean of squared errors over their variances */
#define HONEST_HIGH 1.5

#define LOAD_A     1.2
#define RESERVE    0.1
#define STEP       (1.0 / RATE)
#define FULL_SCALE 36.0
#define NOISE_V    0.01
#define IDLE_A     0.17

struct driven {
    struct cell_pack pack;
    struct random random;
    struct jp_battery battery;
    struct jp_battery counted; /* without correction */
    double gain;
    double zero_a;
    double divider;
    double air_c;
    double seconds;
    double energy; /* as metered, J */
    unsigned long surprises;
};

struct result {
    double worst;   /* error in the last cycle, share of the charge */
    double counted; /* of coulomb counting at the end */
    double honesty; /* sum of squared errors over variances */
    unsigned long compared;
    double energy_error; /* of the forecast of what is left, relative to its deviation */
    double energy_share; /* the same of the energy */
    double capacity_error;
    double surprises; /* share of seconds */
};

static struct cell_constants cell;
static struct cell_wiring wiring;
static struct result results[BATTERIES];

static const struct jp_battery_config config = {
    .capacity = 10080,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22),
    .voltage_full = JP_Q16(25.2),
    .voltage_min = JP_Q16(12),
    .voltage_max = JP_Q16(30),
    .voltage_jump = JP_Q16(6),
    .charge_efficiency = JP_Q16_ONE,
    .reserve = JP_Q31_MAX / 10,
    .charge_deviation = JP_Q31_MAX / 20,
    .load = JP_Q16(LOAD_A),
    .update_rate = RATE,
    .cells = &jp_battery_cells_courier24,
    .unit_exponent = 3,
};

static struct jp_battery_config counting;

/* ---- What nobody knows ---- */

/* Within 3 deviations. */
static double normal(struct random *random, double deviation)
{
    double value;

    do {
        value = random_gaussian(random, deviation);
    } while (fabs(value) > 3 * deviation);
    return value;
}

static void draw_battery(struct driven *driven, uint64_t seed)
{
    struct random *const random = &driven->random;
    struct cell_constants own = cell;

    random_init(random, seed);
    own.capacity_ah *= 1 + normal(random, 0.08);
    const double resistance = exp(normal(random, 0.2));
    own.resistance.polarisation_ohm *= resistance;
    for (int i = 0; i < CELL_RESISTANCE_POINTS; i++) {
        own.resistance.ohmic_ohm[i] *= resistance;
    }
    for (int i = 0; i < CELL_POINTS; i++) {
        own.open_circuit_v[i] += normal(random, 0.004);
    }
    driven->air_c = random_uniform(random, 0, 40);
    driven->divider = 1 + normal(random, 0.001);
    driven->gain = 1 + normal(random, 0.01);
    driven->zero_a = normal(random, 0.02);

    const struct cell_condition condition = {random_uniform(random, 0.3, 1), driven->air_c,
                                             random_uniform(random, 0, 500)};

    cell_pack_init(&driven->pack, &own, &wiring, &condition);
}

/* ---- What the robot sees ---- */

static double voltage_at(const struct driven *driven, double amperes)
{
    const struct cell_source source = cell_pack_source(&driven->pack);

    return source.open_v - source.resistance_ohm * amperes;
}

static jp_q16 reading(struct driven *driven, double volts)
{
    const double noisy = driven->divider * volts + random_gaussian(&driven->random, NOISE_V);

    return digital_fixed(digital_convert(noisy, 0, FULL_SCALE, 12), JP_Q16_ONE);
}

static void start(struct driven *driven)
{
    jp_charge charge = 0;

    (void)jp_battery_estimate(&config, reading(driven, voltage_at(driven, 0)), &charge);
    (void)jp_battery_start(&driven->battery, &config, charge, 0);
    (void)jp_battery_start(&driven->counted, &counting, charge, 0);
}

static void step(struct driven *driven, double amperes)
{
    const double volts = voltage_at(driven, amperes);

    cell_pack_step(&driven->pack, amperes, STEP);
    driven->seconds += STEP;
    driven->pack.air_c = driven->air_c + 3 * sin(2 * M_PI * driven->seconds / DAY);
    driven->energy += volts * (driven->gain * amperes + driven->zero_a) * STEP;

    const jp_energy energy = (jp_energy)ldexp(driven->energy, 32);
    const jp_q16 seen = reading(driven, volts);

    driven->surprises +=
        (jp_battery_update(&driven->battery, &config, energy, seen) & JP_BATTERY_VOLTAGE_UNEXPECTED) != 0;
    (void)jp_battery_update(&driven->counted, &counting, energy, seen);
}

static double error_of(const struct driven *driven, const struct jp_battery *battery)
{
    return ldexp(jp_battery_level(battery), -31) - driven->pack.charge;
}

static void compare(const struct driven *driven, bool is_last, struct result *result)
{
    const double error = error_of(driven, &driven->battery);
    const double deviation = ldexp(jp_battery_level_deviation(&driven->battery, &config), -31);

    result->honesty += error * error / (deviation * deviation);
    result->compared++;
    if (is_last) {
        result->worst = fmax(result->worst, fabs(error));
    }
}

/* ---- Use ---- */

struct use {
    struct driven *driven;
    struct result *result;
    bool is_last;
};

static void live(const struct use *use, double amperes, double seconds)
{
    struct driven *const driven = use->driven;

    for (int i = 0; i < (int)(seconds * RATE); i++) {
        const double before = floor(driven->seconds / EVERY);

        step(driven, amperes);
        if (floor(driven->seconds / EVERY) > before) {
            compare(driven, use->is_last, use->result);
        }
    }
}

/* What a drive takes for a while: it stands, rolls, accelerates or brakes. */
static double drawn_current(struct random *random)
{
    const double kind = random_uniform(random, 0, 1);

    if (kind < 0.35) {
        return IDLE_A;
    }
    if (kind < 0.9) {
        return random_uniform(random, 0.5, 3);
    }
    return kind < 0.97 ? random_uniform(random, 3, 8) : random_uniform(random, -2, 0);
}

static void discharge(const struct use *use, double charge)
{
    struct driven *const driven = use->driven;

    while (driven->pack.charge > charge && voltage_at(driven, 2) > 15) {
        const double amperes = drawn_current(&driven->random);

        live(use, amperes, random_uniform(&driven->random, 2, 20));
    }
}

/* Constant current, then constant voltage down to a twentieth of it. */
static void charge_up(const struct use *use, double charge)
{
    struct driven *const driven = use->driven;
    double amperes = 1.4;

    while (driven->pack.charge < charge && amperes > 0.14) {
        const double most = wiring.series * 4.19;

        while (amperes > 0.14 && voltage_at(driven, -amperes) > most) {
            amperes *= 0.98;
        }
        live(use, -amperes, 5);
    }
}

static void cycle(const struct use *use)
{
    struct random *const random = &use->driven->random;

    discharge(use, random_uniform(random, 0.1, 0.5));
    live(use, IDLE_A, random_uniform(random, 60, 1800));
    charge_up(use, random_uniform(random, 0.7, 1));
    live(use, IDLE_A, random_uniform(random, 60, 1800));
}

/* What the robot's own meter would still count at the expected load, J. */
static double energy_left(const struct driven *driven)
{
    struct cell_pack pack = driven->pack;
    double energy = 0;

    while (pack.charge > RESERVE) {
        const struct cell_source source = cell_pack_source(&pack);

        energy += (source.open_v - source.resistance_ohm * LOAD_A) * (driven->gain * LOAD_A + driven->zero_a);
        cell_pack_step(&pack, LOAD_A, 1);
    }
    return energy;
}

static void compare_energy(const struct driven *driven, struct result *result)
{
    struct jp_forecast left = {0, 0};

    (void)jp_battery_forecast_left(&driven->battery, &config, &left);

    const double unit = ldexp(1, config.unit_exponent - 16);
    const double exact = energy_left(driven);

    result->energy_error = (left.energy * unit - exact) / (left.deviation * unit);
    result->energy_share = (left.energy * unit - exact) / exact;
}

static void live_a_life(void *context, size_t index)
{
    struct driven driven = {.seconds = 0};
    struct result *const result = &results[index];
    struct use use = {&driven, result, false};

    (void)context;
    draw_battery(&driven, SEED * 1000003U + index);
    start(&driven);
    for (int i = 0; i < CYCLES; i++) {
        use.is_last = i == CYCLES - 1;
        cycle(&use);
    }
    compare_energy(&driven, result);
    result->counted = fabs(error_of(&driven, &driven.counted));
    result->capacity_error =
        ldexp((double)driven.battery.capacity, -32) / driven.gain / cell_pack_capacity(&driven.pack) - 1;
    result->surprises = (double)driven.surprises / driven.seconds;
}

/* ---- Figures ---- */

static double mean_of(double (*of)(const struct result *result))
{
    double sum = 0;

    for (int i = 0; i < BATTERIES; i++) {
        sum += of(&results[i]);
    }
    return sum / BATTERIES;
}

static double worst_of(double (*of)(const struct result *result))
{
    double worst = 0;

    for (int i = 0; i < BATTERIES; i++) {
        worst = fmax(worst, of(&results[i]));
    }
    return worst;
}

static double error_in_last_cycle(const struct result *result)
{
    return result->worst;
}

static double squared_error(const struct result *result)
{
    return result->worst * result->worst;
}

static double counted_error(const struct result *result)
{
    return result->counted * result->counted;
}

static double honesty(const struct result *result)
{
    return result->honesty / (double)result->compared;
}

static double energy_honesty(const struct result *result)
{
    return result->energy_error * result->energy_error;
}

static double energy_square(const struct result *result)
{
    return result->energy_share * result->energy_share;
}

static double capacity_square(const struct result *result)
{
    return result->capacity_error * result->capacity_error;
}

static double surprises(const struct result *result)
{
    return result->surprises;
}

static void add_range(json_t *figures, double value, const char *name)
{
    figures_add(figures, COMMAND, value, "1", at_most(HONEST_HIGH), "%s, at most", name);
    figures_add(figures, COMMAND, value, "1", at_least(HONEST_LOW), "%s, at least", name);
}

int main(int argc, char **argv)
{
    json_t *figures = json_array();

    (void)figures_rows_path(argc, argv, "State of charge of unknown batteries over 50 cycles.");
    if (!pack_file_load_robot("courier24", &cell, &wiring)) {
        return ERROR_EXIT;
    }
    counting = config;
    counting.cells = NULL;
    in_parallel("batteries", live_a_life, NULL, BATTERIES);

    figures_add(figures, COMMAND, 100 * worst_of(error_in_last_cycle), "%", at_most(ERROR_BAR),
                "state of charge in cycle %d of %d unknown batteries, worst error", CYCLES, BATTERIES);
    figures_add(figures, COMMAND, 100 * sqrt(mean_of(squared_error)), "%", no_bar,
                "state of charge in cycle %d, root of the mean square of each battery's worst error", CYCLES);
    figures_add(figures, COMMAND, 100 * sqrt(mean_of(counted_error)), "%", no_bar,
                "state of charge after %d cycles counted without correction, root of the mean square", CYCLES);
    add_range(figures, mean_of(honesty), "state of charge, squared error over its variance");
    add_range(figures, mean_of(energy_honesty), "energy left after 50 cycles, squared error over its variance");
    figures_add(figures, COMMAND, 100 * sqrt(mean_of(energy_square)), "%", no_bar,
                "energy left after %d cycles, root of the mean square of the error", CYCLES);
    figures_add(figures, COMMAND, 100 * sqrt(mean_of(capacity_square)), "%", no_bar,
                "capacity found in %d cycles, root of the mean square of the error", CYCLES);
    figures_add(figures, COMMAND, 100 * mean_of(surprises), "%", no_bar, "seconds with an unexpected voltage");
    figures_print(figures);
    return 0;
}
