// eva: -eva-slevel-function main:20
/** The shapes of a robot's lattice with any prices, on any map of any size, from any cells. */
#include <joulepath/tables.h>
#include <joulepath/tariff.h>

#include "tests/proof/any_lattice.h"

#define PRIMITIVES 320U
#define FAR        (1 << 30)

static struct jp_primitive charged[PRIMITIVES];
static struct jp_lattice lattice;

static void look(const struct jp_terrain *terrain)
{
    const struct jp_primitive *primitive =
        &lattice.primitives[any_unsigned(lattice.first_from[JP_HEADINGS] - UINT32_C(1))];
    const enum jp_cost_kind kind = (enum jp_cost_kind)any_between(JP_COST_PHYSICAL, JP_COST_DISTANCE);
    const int32_t x = any_between(-FAR, FAR);
    const int32_t y = any_between(-FAR, FAR);

    (void)jp_lattice_is_clear(&lattice, terrain, primitive, x, y);
    (void)jp_lattice_energy(&lattice, kind, terrain, primitive, x, y);
    (void)jp_lattice_cost(&lattice, kind, terrain, primitive, x, y);
    (void)jp_lattice_can_stand(&lattice, terrain, x, y, any_unsigned(JP_HEADINGS - 1U));
    (void)jp_lattice_is_open(&lattice, terrain, x, y);
    (void)jp_lattice_core_holds(&lattice, any_int(), any_int());
}

static void bound(void)
{
    const enum jp_cost_kind kind = (enum jp_cost_kind)any_between(JP_COST_PHYSICAL, JP_COST_DISTANCE);
    struct jp_straight straight;
    struct jp_turns turns;

    jp_lattice_turns(&lattice, kind, &turns);
    jp_lattice_straight(&lattice, kind, &straight);
    (void)jp_straight_bound(&straight, any_between(INT16_MIN, INT16_MAX), any_between(INT16_MIN, INT16_MAX),
                            any_between(INT16_MIN, INT16_MAX));
}

static void charge(void)
{
    struct jp_tariff tariff = {.primitives = charged, .primitives_max = PRIMITIVES};
    struct jp_tariff_factors factors[JP_GROUND_CLASSES];
    const struct jp_tariff_grounds grounds = {
        .factors = factors, .classes = (uint8_t)any_unsigned(UINT8_MAX), .half_track = any_int()};
    const char *field;

    ANY(factors);
    (void)jp_tariff_by_factors(&tariff, &lattice, &factors[0], &field);
    (void)jp_tariff_by_grounds(&tariff, &lattice, &grounds, &field);
}

static void charge_by_models(void)
{
    struct jp_tariff tariff = {.primitives = charged, .primitives_max = PRIMITIVES};
    struct jp_energy_model built_in;
    struct jp_energy_model learned;
    struct jp_tariff_models models;
    const char *field;

    ANY(built_in);
    ANY(learned);
    ANY(models);
    models.built_in = &built_in;
    models.learned = &learned;
    (void)jp_tariff_by_models(&tariff, &lattice, &models, &field);
}

int main(void)
{
    const struct jp_terrain *terrain = any_terrain();
    const char *field;

    (void)jp_lattice_check(&jp_lattice_burger, &field);
    any_lattice(&lattice);
    ANY_TIMES
    {
        look(terrain);
    }
    bound();
    charge();
    charge_by_models();
    ARRIVED();
    return 0;
}
