#include "sim/base/cell_pack.h"

#include <math.h>

#include "sim/base/strict_math.h"

#define KELVIN  273.15
#define SECONDS 3600.0

/* Linear between the points, and beyond the first and the last as between the last two. */
static double at(const double *places, const double *values, int count, double place)
{
    int i = 1;

    while (i < count - 1 && place > places[i]) {
        i++;
    }
    const double share = (place - places[i - 1]) / (places[i] - places[i - 1]);
    return values[i - 1] + share * (values[i] - values[i - 1]);
}

double cell_open_circuit(const struct cell_constants *cell, double charge)
{
    return at(cell->charge, cell->open_circuit_v, CELL_POINTS, charge);
}

double cell_ohmic(const struct cell_constants *cell, double charge)
{
    const double within = fmin(fmax(charge, 0), 1);

    return at(cell->resistance.charge, cell->resistance.ohmic_ohm, CELL_RESISTANCE_POINTS, within);
}

void cell_pack_init(struct cell_pack *pack, const struct cell_constants *cell, const struct cell_wiring *wiring,
                    const struct cell_condition *condition)
{
    *pack = (struct cell_pack){
        .cell = *cell,
        .wiring = *wiring,
        .charge = condition->charge,
        .temperature_c = condition->temperature_c,
        .air_c = condition->temperature_c,
        .cycles = condition->cycles,
    };
}

/* By which a resistance is greater than that of a new cell at its reference temperature. */
static double growth(const struct cell_pack *pack, double activation)
{
    const double colder = 1 / (pack->temperature_c + KELVIN) - 1 / (pack->cell.resistance.reference_c + KELVIN);

    return strict_exp(activation * colder) * (1 + pack->cycles * pack->cell.ageing.resistance_per_cycle);
}

static double ohmic(const struct cell_pack *pack)
{
    return cell_ohmic(&pack->cell, pack->charge) * growth(pack, pack->cell.resistance.ohmic_activation_k);
}

static double cell_capacity(const struct cell_pack *pack)
{
    return pack->cell.capacity_ah * SECONDS * (1 - pack->cycles * pack->cell.ageing.capacity_per_cycle);
}

double cell_pack_capacity(const struct cell_pack *pack)
{
    return cell_capacity(pack) * pack->wiring.parallel;
}

struct cell_source cell_pack_source(const struct cell_pack *pack)
{
    const double rest = cell_open_circuit(&pack->cell, pack->charge) - pack->polarisation_v;

    return (struct cell_source){
        .open_v = pack->wiring.series * rest,
        .resistance_ohm = pack->wiring.series * ohmic(pack) / pack->wiring.parallel + pack->wiring.wiring_ohm,
    };
}

/* What polarisation takes of a cell in a step, J; *pack gets its voltage at the end. */
static double polarise(struct cell_pack *pack, double current, double seconds)
{
    const double settled = current * pack->cell.resistance.polarisation_ohm *
                           growth(pack, pack->cell.resistance.polarisation_activation_k);
    const double time = pack->cell.resistance.polarisation_s;
    const double before = pack->polarisation_v - settled;
    const double after = before * strict_exp(-seconds / time);

    pack->polarisation_v = settled + after;
    return current * (settled * seconds + time * (before - after));
}

void cell_pack_step(struct cell_pack *pack, double amperes, double seconds)
{
    const double cells = (double)pack->wiring.series * pack->wiring.parallel;
    const double current = amperes / pack->wiring.parallel;
    const double capacity = cell_capacity(pack);
    const double drawn = current * seconds / capacity;
    const double heat = ohmic(pack) * current * current * seconds;
    const double polarised = polarise(pack, current, seconds);
    const double chemical = cell_open_circuit(&pack->cell, pack->charge - drawn / 2) * current * seconds;
    const double lost = pack->wiring.wiring_ohm * amperes * amperes * seconds;
    struct cell_ledger *ledger = &pack->ledger;

    ledger->chemical += cells * chemical;
    ledger->ohmic += cells * heat;
    ledger->polarisation += cells * polarised;
    ledger->wiring += lost;
    ledger->terminal += cells * (chemical - heat - polarised) - lost;
    pack->charge -= drawn;
    pack->cycles += fabs(drawn) / 2;
    pack->temperature_c +=
        (heat + polarised - pack->cell.heat.to_air_w_per_k * (pack->temperature_c - pack->air_c) * seconds) /
        (pack->cell.heat.capacity_j_per_kg_k * pack->cell.mass_kg);
}
