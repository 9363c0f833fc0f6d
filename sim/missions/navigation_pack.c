#include "sim/missions/navigation_pack.h"

#include <math.h>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/files/cell_file.h"

#define Q16   65536.0
#define Q31   2147483648.0
#define JOULE 4294967296.0

/** That it looks at its cells before it is told where to go, s. */
#define STAND_SECONDS 10.0

/** Of the true energy that is left, share of the charge: a step, and what is nothing. */
#define CHARGE_STEP  0.001
#define CHARGE_LEAST 1e-9

static jp_q16 q16(double value)
{
    return (jp_q16)lround(value * Q16);
}

/** As the robot's firmware has it. */
static struct jp_battery_config config_of(const struct navigation_pack *pack)
{
    struct jp_battery_config config = *pack->robot->supply.battery;

    config.load = q16(pack->robot->supply.standing_w / (config.voltage_nominal / Q16));
    config.unit_exponent = pack->robot->unit_exponent;
    return config;
}

/** Of the bus while the robot stands, V; 0: the cells cannot give that much. */
static double standing_voltage(const struct navigation_pack *pack, const struct cell_condition *condition)
{
    struct cell_pack cells;

    cell_pack_init(&cells, &pack->cell, &pack->wiring, condition);
    const struct cell_source source = cell_pack_source(&cells);
    const double square = source.open_v * source.open_v - 4 * source.resistance_ohm * pack->robot->supply.standing_w;

    return square < 0 ? 0 : (source.open_v + sqrt(square)) / 2;
}

/** False after one line on stderr: the bus has not the voltage that the robot needs. */
static bool suffices(const struct navigation_pack *pack, double volts)
{
    const struct navigation_robot *robot = pack->robot;

    if (volts < robot->supply.voltage_min_v) {
        error_line("--charge %g: the bus of %s has %.2f V then while it stands, and needs %.2f V; charge the cells",
                   100 * pack->charge, robot->name, volts, robot->supply.voltage_min_v);
        return false;
    }
    return true;
}

static bool start_battery(struct navigation_pack *pack, uint64_t seed)
{
    struct random random;
    const char *field = "";

    pack->config = config_of(pack);
    if (jp_battery_check(&pack->config, &field) != JP_OK) {
        error_line("%s: the battery is refused: %s; correct sim/robots/packs/%s.cfg", pack->robot->name, field,
                   pack->robot->name);
        return false;
    }
    random_init(&random, seed);
    const double known = fmin(fmax(pack->charge + random_gaussian(&random, pack->config.charge_deviation / Q31), 0), 1);

    pack->energy = pack->robot->supply.metered(pack->robot->self);
    pack->before = pack->energy;
    return jp_battery_start(&pack->battery, &pack->config, (jp_charge)(known * pack->config.capacity * JOULE),
                            pack->energy) == JP_OK;
}

/** What is forecast is expected to take the current that the robot took so far. */
static void expect_load(struct navigation_pack *pack)
{
    const double joules = (double)(pack->robot->supply.metered(pack->robot->self) - pack->energy) / JOULE;

    pack->config.load = q16(fmax(joules / pack->seconds, 0) * Q16 / pack->config.voltage_nominal);
}

/** As an ECU does: jp_ecu_battery_lacks(). */
static void plan_for_what_is_there(struct navigation_pack *pack)
{
    const struct navigation_supply *supply = &pack->robot->supply;
    const jp_energy now = supply->metered(pack->robot->self);

    pack->most_w = fmax(pack->most_w, (double)(now - pack->before) / JOULE * pack->config.update_rate);
    pack->before = now;
    supply->lack(pack->robot->self,
                 jp_battery_lacks(&pack->battery, &pack->config, q16(fmax(pack->most_w, supply->cruise_w))));
}

void navigation_pack_tick(struct navigation_pack *pack)
{
    const struct navigation_supply *supply = &pack->robot->supply;

    pack->voltage += supply->bus_voltage(pack->robot->self);
    pack->ticks++;
    if (pack->ticks == pack->ticks_an_update) {
        const jp_q16 voltage = (jp_q16)(pack->voltage / pack->ticks);

        (void)jp_battery_update(&pack->battery, &pack->config, supply->metered(pack->robot->self), voltage);
        pack->seconds += 1.0 / pack->config.update_rate;
        pack->least_v = fmin(pack->least_v, voltage / Q16);
        pack->voltage = 0;
        pack->ticks = 0;
        expect_load(pack);
        plan_for_what_is_there(pack);
    }
}

static void stand(struct navigation_pack *pack)
{
    for (int i = 0; i < (int)(STAND_SECONDS * pack->robot->rate_hz); i++) {
        pack->robot->tick(pack->robot->self);
        navigation_pack_tick(pack);
    }
}

bool navigation_pack_start(struct navigation_pack *pack, const struct navigation_robot *robot, uint64_t seed)
{
    *pack = (struct navigation_pack){.charge = pack->charge, .robot = robot, .least_v = INFINITY};
    if (robot->supply.battery == NULL) {
        error_line("%s: --charge: its firmware knows no cells; write sim/robots/packs/%s.cfg and run make battery "
                   "ROBOT=%s",
                   robot->name, robot->name, robot->name);
        return false;
    }
    if (!pack_file_load_robot(robot->name, &pack->cell, &pack->wiring)) {
        return false;
    }
    const struct cell_condition condition = {.charge = pack->charge,
                                             .temperature_c = pack->cell.resistance.reference_c};

    if (!suffices(pack, standing_voltage(pack, &condition)) || !start_battery(pack, seed)) {
        return false;
    }
    pack->ticks_an_update = (unsigned)lround(robot->rate_hz / pack->config.update_rate);
    robot->supply.feed(robot->self, &pack->cell, &pack->wiring, &condition);
    stand(pack);
    return suffices(pack, pack->least_v);
}

/** Returns the exponent of its unit: the least from the vehicle's on that holds it. */
static int32_t forecast_left(const struct navigation_pack *pack, struct jp_forecast *left)
{
    struct jp_battery_config config = pack->config;

    while (jp_battery_forecast_left(&pack->battery, &config, left) == JP_ERR_OVERFLOW &&
           config.unit_exponent < JP_ENERGY_UNIT_EXPONENT_MAX) {
        config.unit_exponent++;
    }
    return config.unit_exponent;
}

struct jp_forecast navigation_pack_left(const struct navigation_pack *pack)
{
    struct jp_forecast left = {0, 0};

    (void)jp_battery_forecast_left(&pack->battery, &pack->config, &left);
    return left;
}

jp_q16 navigation_pack_given(const struct navigation_pack *pack)
{
    const jp_energy given = pack->robot->supply.metered(pack->robot->self) - pack->energy;

    return (jp_q16)(uint32_t)((uint64_t)given >> (16 + pack->robot->unit_exponent));
}

bool navigation_pack_is_empty(const struct navigation_pack *pack)
{
    return pack->least_v < pack->robot->supply.voltage_min_v;
}

/** By emptying a copy of the cells at the load down to the reserve. */
static double true_joules(const struct navigation_pack *pack)
{
    struct cell_pack cells = *pack->robot->supply.pack;
    const double before = cells.ledger.terminal;
    const double amperes = pack->config.load / Q16;
    const double reserve = pack->config.reserve / Q31;

    while (cells.charge > reserve + CHARGE_LEAST) {
        const double share = fmin(cells.charge - reserve, CHARGE_STEP);

        cell_pack_step(&cells, amperes, share * cell_pack_capacity(&cells) / amperes);
    }
    return cells.ledger.terminal - before;
}

struct navigation_charge navigation_pack_charge(const struct navigation_pack *pack)
{
    struct jp_forecast left = {0, 0};
    const int32_t exponent = forecast_left(pack, &left);

    return (struct navigation_charge){.charge = pack->robot->supply.pack->charge,
                                      .known = jp_battery_level(&pack->battery) / Q31,
                                      .deviation = jp_battery_level_deviation(&pack->battery, &pack->config) / Q31,
                                      .joules = true_joules(pack),
                                      .known_joules = ldexp(left.energy, exponent - 16),
                                      .joules_deviation = ldexp(left.deviation, exponent - 16)};
}
