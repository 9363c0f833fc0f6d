/* Lattices at other prices: by hand for both robots, bit for bit without a change, what must stay, what is refused. */
#include <joulepath/tables.h>
#include <joulepath/tariff.h>
#include <stddef.h>
#include <string.h>

#include "tests/support/energy_unit.h"
#include "unity.h"

enum {
    PRIMITIVES_MAX = 144,
    AHEAD = 0,          /* primitives of gao2018 by their index: a cell straight on */
    SHARP_CURVE = 3,    /* three cells on and one to the left, by 45° */
    IN_PLACE = 4,       /* to the next heading */
    QUARTER_TURN = 16,  /* from heading 1 to heading 15 */
    STEP_PER_MASS = 25, /* a unit of elevation on a slope costs zhang2018 at most that much */
    VERSION = 7
};

static const struct jp_lattice *const lattices[] = {&jp_lattice_zhang2018, &jp_lattice_gao2018};
enum { LATTICES = sizeof lattices / sizeof lattices[0] };

static const struct jp_lattice *const balancer = &jp_lattice_gao2018;
static struct jp_primitive primitives[PRIMITIVES_MAX];
static struct jp_tariff tariff;
static struct jp_tariff_factors factors;
static struct jp_energy_model learned;
static struct jp_tariff_models models;

/* A lattice to damage. */
static struct jp_lattice copy;
static struct jp_primitive copied[PRIMITIVES_MAX];

void setUp(void)
{
    memset(&tariff, 0x5A, sizeof tariff);
    tariff.primitives = primitives;
    tariff.primitives_max = PRIMITIVES_MAX;
    factors = (struct jp_tariff_factors){VERSION, JP_Q16_ONE, JP_Q16_ONE, JP_Q16_ONE};
    learned = jp_energy_model_gao2018;
    models = (struct jp_tariff_models){VERSION, &jp_energy_model_gao2018, &learned, JP_Q16_ONE};
    copy = *balancer;
    memcpy(copied, balancer->primitives, sizeof copied);
    copy.primitives = copied;
}

void tearDown(void)
{
}

static void expect_sound(const struct jp_lattice *source)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&tariff.lattice, &field));
    TEST_ASSERT_EQUAL_UINT32(VERSION, tariff.lattice.version);
    TEST_ASSERT_EQUAL_PTR(primitives, tariff.lattice.primitives);
    for (unsigned i = 0; i < source->first_from[JP_HEADINGS]; i++) {
        struct jp_primitive primitive = primitives[i];
        primitive.base[JP_COST_PHYSICAL] = source->primitives[i].base[JP_COST_PHYSICAL];
        TEST_ASSERT_EQUAL_MEMORY(&source->primitives[i], &primitive, sizeof primitive);
    }
    for (unsigned kind = JP_COST_PAPER; kind < (unsigned)JP_COST_KINDS; kind++) {
        TEST_ASSERT_EQUAL_MEMORY(source->move_costs[kind], tariff.lattice.move_costs[kind],
                                 sizeof source->move_costs[kind]);
    }
}

static void charge_by_factors(const struct jp_lattice *source)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&tariff, source, &factors, &field));
    TEST_ASSERT_NULL(field);
    expect_sound(source);
}

static void charge_by_models(const struct jp_lattice *source)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_models(&tariff, source, &models, &field));
    TEST_ASSERT_NULL(field);
    expect_sound(source);
}

static const struct jp_slope_cost *move_cost(const struct jp_lattice *lattice, enum jp_move_kind kind)
{
    return &lattice->move_costs[JP_COST_PHYSICAL][kind];
}

static const struct jp_slope_cost *axis(void)
{
    return move_cost(&tariff.lattice, JP_MOVE_AXIS);
}

static unsigned base(unsigned primitive)
{
    return primitives[primitive].base[JP_COST_PHYSICAL];
}

/* Cost of a primitive on level ground. */
static uint32_t level_cost(const struct jp_lattice *lattice, unsigned index)
{
    const struct jp_primitive *primitive = &lattice->primitives[index];
    uint32_t cost = primitive->base[JP_COST_PHYSICAL];

    for (unsigned i = 0; i < primitive->move_count; i++) {
        cost += jp_move_cost(move_cost(lattice, jp_move_kind_of(lattice->moves[primitive->first_move + i])), 0);
    }
    return cost;
}

/* How much more a primitive costs than by the tables. */
static int32_t rise_of(unsigned index)
{
    return (int32_t)level_cost(&tariff.lattice, index) - (int32_t)level_cost(balancer, index);
}

/* ---- Factors ---- */

static void expect_unchanged(const struct jp_lattice *source)
{
    TEST_ASSERT_EQUAL_MEMORY(source->move_costs, tariff.lattice.move_costs, sizeof source->move_costs);
    TEST_ASSERT_EQUAL_MEMORY(source->primitives, primitives, source->first_from[JP_HEADINGS] * sizeof *primitives);
}

static void test_factors_of_one_change_no_bit(void)
{
    for (size_t i = 0; i < LATTICES; i++) {
        charge_by_factors(lattices[i]);
        expect_unchanged(lattices[i]);
    }
}

static void test_all_but_the_costs_is_the_lattices(void)
{
    factors.turning = JP_Q16(2);
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_PTR(balancer->spans, tariff.lattice.spans);
    TEST_ASSERT_EQUAL_PTR(balancer->moves, tariff.lattice.moves);
    TEST_ASSERT_EQUAL_PTR(balancer->by_end, tariff.lattice.by_end);
    TEST_ASSERT_EQUAL_STRING("gao2018", tariff.lattice.name);
    TEST_ASSERT_EQUAL_UINT32(0, balancer->version);
}

static void test_straight_scales_level_driving(void)
{
    factors.straight = JP_Q16(1.5);
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_INT32(6946437, axis()->climb.constant); /* 4630958 · 1.5, rounded down */
    TEST_ASSERT_EQUAL_INT32(6946437, axis()->descend.constant);
    TEST_ASSERT_EQUAL_UINT32(105, jp_move_cost(axis(), 0));
    TEST_ASSERT_EQUAL_UINT32(237, jp_move_cost(move_cost(&tariff.lattice, JP_MOVE_KNIGHT), 0));
    TEST_ASSERT_EQUAL_UINT32(149, jp_move_cost(move_cost(&tariff.lattice, JP_MOVE_DIAGONAL), 0));
    TEST_ASSERT_EQUAL_INT32(261989, axis()->climb.linear);
    TEST_ASSERT_EQUAL_INT32(7313, axis()->climb.quadratic);
}

static void test_bases_of_straight_driving_follow_it(void)
{
    factors.straight = JP_Q16(3);
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_UINT(3, base(AHEAD));
    TEST_ASSERT_EQUAL_UINT(146, base(SHARP_CURVE));
    TEST_ASSERT_EQUAL_UINT(564, base(IN_PLACE));
}

static void test_turning_scales_the_other_bases_and_rounds_up(void)
{
    factors.turning = JP_Q16(1.25);
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_UINT(1, base(AHEAD));
    TEST_ASSERT_EQUAL_UINT(183, base(SHARP_CURVE)); /* 182.5 */
    TEST_ASSERT_EQUAL_UINT(705, base(IN_PLACE));
    TEST_ASSERT_EQUAL_MEMORY(balancer->move_costs, tariff.lattice.move_costs, sizeof balancer->move_costs);
}

static void test_mass_scales_what_a_rise_adds(void)
{
    factors.mass = JP_Q16(1.5);
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_INT32(4630958, axis()->climb.constant);
    TEST_ASSERT_EQUAL_INT32(392983, axis()->climb.linear);   /* 261989 · 1.5 */
    TEST_ASSERT_EQUAL_INT32(16454, axis()->climb.quadratic); /* 7313 · 2.25, rounded down */
    TEST_ASSERT_EQUAL_UINT(564, base(IN_PLACE));
}

/* Where gravity overcomes rolling resistance the cost keeps its bend, and has no step. */
static void expect_no_step(jp_q16 straight, jp_q16 mass, int16_t bend)
{
    factors.straight = straight;
    factors.mass = mass;
    charge_by_factors(&jp_lattice_zhang2018);
    TEST_ASSERT_EQUAL_INT16(bend, axis()->bend);
    for (int32_t rise = bend - 2; rise <= bend + 2; rise++) {
        const int32_t below = (int32_t)jp_move_cost(axis(), rise - 1);
        const int32_t here = (int32_t)jp_move_cost(axis(), rise);
        TEST_ASSERT_INT32_WITHIN(STEP_PER_MASS * mass / JP_Q16_ONE, below, here);
    }
}

static void test_bend_moves_with_rolling_resistance(void)
{
    expect_no_step(JP_Q16_ONE, JP_Q16_ONE, -8);
    expect_no_step(JP_Q16(2), JP_Q16_ONE, -16);
    expect_no_step(JP_Q16(4), JP_Q16(2), -16);
    expect_no_step(JP_Q16(0.5), JP_Q16_ONE, -4);
    expect_no_step(JP_Q16(2), JP_Q16(4), -4);
}

static void test_bend_stays_within_its_format(void)
{
    copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS].bend = INT16_MIN;
    copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_KNIGHT].bend = INT16_MAX;
    factors.straight = JP_Q16(2);
    charge_by_factors(&copy);
    TEST_ASSERT_EQUAL_INT16(INT16_MIN, axis()->bend);
    TEST_ASSERT_EQUAL_INT16(INT16_MAX, move_cost(&tariff.lattice, JP_MOVE_KNIGHT)->bend);
}

static void test_electronics_remain_the_least_cost(void)
{
    factors.straight = JP_TARIFF_FACTOR_MIN;
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_UINT32(35, jp_move_cost(axis(), 0)); /* 16 · 6 W · 0.373 s */
    TEST_ASSERT_EQUAL_UINT32(80, jp_move_cost(move_cost(&tariff.lattice, JP_MOVE_KNIGHT), 0));
}

static void test_extremes_of_every_factor(void)
{
    static const jp_q16 extremes[] = {JP_TARIFF_FACTOR_MIN, JP_TARIFF_FACTOR_MAX};

    for (size_t i = 0; i < LATTICES; i++) {
        for (unsigned mix = 0; mix < 8U; mix++) {
            factors.straight = extremes[mix & 1U];
            factors.turning = extremes[(mix >> 1) & 1U];
            factors.mass = extremes[mix >> 2];
            charge_by_factors(lattices[i]);
        }
    }
}

/* Turning on the spot may get cheap, but never free. */
static void test_nothing_is_free(void)
{
    copied[IN_PLACE].base[JP_COST_PHYSICAL] = 1;
    factors.turning = JP_TARIFF_FACTOR_MIN;
    charge_by_factors(&copy);
    TEST_ASSERT_EQUAL_UINT(1, base(IN_PLACE));
}

static void test_curve_to_the_same_heading_is_no_straight_way(void)
{
    factors.turning = JP_Q16(2);
    charge_by_factors(balancer);
    TEST_ASSERT_EQUAL_INT8(0, (int)primitives[2].end); /* from 0 to 0, a cell to the left */
    TEST_ASSERT_EQUAL_UINT(120, base(2));
}

/* ---- Models ---- */

static void test_equal_models_change_no_bit(void)
{
    charge_by_models(balancer);
    expect_unchanged(balancer);
}

static void test_twice_the_resistance_to_driving(void)
{
    learned.b[0] *= 2;
    charge_by_models(balancer);
    /* At √(Ps/b1) half of the power drives: 1.5 of 70.66 units, and the knight's 2.236 times that. */
    TEST_ASSERT_EQUAL_UINT32(106, jp_move_cost(axis(), 0));
    TEST_ASSERT_EQUAL_UINT32(237, jp_move_cost(move_cost(&tariff.lattice, JP_MOVE_KNIGHT), 0));
    TEST_ASSERT_EQUAL_INT32(36, rise_of(AHEAD));       /* 16 · 20.863 · 0.2²/0.373 = 35.8 */
    TEST_ASSERT_EQUAL_INT32(41, rise_of(SHARP_CURVE)); /* 16 · 20.863 · 0.649²/3.448 = 40.8 */
    TEST_ASSERT_EQUAL_INT32(0, rise_of(IN_PLACE));
    TEST_ASSERT_TRUE(base(SHARP_CURVE) < 146U); /* slow, so it costs less more than its moves say */
}

static void test_twice_the_resistance_to_turning(void)
{
    learned.b[1] *= 2;
    charge_by_models(balancer);
    TEST_ASSERT_EQUAL_INT32(0, rise_of(AHEAD));
    TEST_ASSERT_EQUAL_INT32(2, rise_of(SHARP_CURVE));  /* 16 · 0.64054 · 0.7854²/3.448 = 1.83 */
    TEST_ASSERT_EQUAL_INT32(4, rise_of(QUARTER_TURN)); /* 16 · 0.64054 · 0.9273²/2.649 = 3.33 */
    TEST_ASSERT_EQUAL_INT32(0, rise_of(IN_PLACE));
    TEST_ASSERT_EQUAL_MEMORY(balancer->move_costs, tariff.lattice.move_costs, sizeof balancer->move_costs);
}

static void test_twice_the_cost_of_a_step_of_the_heading(void)
{
    learned.a[2] *= 2;
    charge_by_models(balancer);
    TEST_ASSERT_EQUAL_INT32(0, rise_of(SHARP_CURVE));
    TEST_ASSERT_EQUAL_INT32(46, rise_of(IN_PLACE)); /* 16 · 13.162 · 0.4636² = 45.3 */
}

static void test_less_costs_less(void)
{
    learned.b[0] = 0;
    learned.b[1] = 0;
    learned.a[2] = 0;
    charge_by_models(balancer);
    TEST_ASSERT_EQUAL_UINT32(35, jp_move_cost(axis(), 0)); /* what the electronics draw */
    TEST_ASSERT_EQUAL_INT32(-35, rise_of(AHEAD));
    TEST_ASSERT_EQUAL_UINT(519, base(IN_PLACE)); /* 564 − 45.3 */
}

static void test_in_place_the_electronics_draw_goes_on(void)
{
    learned.a[2] = -JP_Q16(4096);
    charge_by_models(balancer);
    TEST_ASSERT_EQUAL_UINT(518, base(IN_PLACE)); /* 16 · 6 W · 5.4 s */
}

static void test_a_curve_costs_at_least_its_moves(void)
{
    learned.b[0] *= 5;
    charge_by_models(balancer);
    TEST_ASSERT_EQUAL_UINT(0, base(SHARP_CURVE));
}

static void test_payload_beside_the_models(void)
{
    models.mass = JP_Q16(2);
    charge_by_models(balancer);
    TEST_ASSERT_EQUAL_INT32(2 * 261989, axis()->climb.linear);
    TEST_ASSERT_EQUAL_INT32(4 * 7313, axis()->climb.quadratic);
    TEST_ASSERT_EQUAL_INT32(0, rise_of(AHEAD));
}

/* An imported table may know no times: then its moves do not follow, and turning in place still does. */
static void test_lattice_without_times(void)
{
    for (unsigned i = 0; i < PRIMITIVES_MAX; i++) {
        copied[i].duration = 0;
        copied[i].length = 0;
    }
    copied[IN_PLACE].base[JP_COST_PHYSICAL] = 1;
    learned.b[0] *= 2;
    learned.a[2] = 0;
    charge_by_models(&copy);
    TEST_ASSERT_EQUAL_MEMORY(copy.move_costs, tariff.lattice.move_costs, sizeof copy.move_costs);
    TEST_ASSERT_EQUAL_UINT(1, base(IN_PLACE));
}

/* Faster than any motion: as fast as jp_motion allows. */
static void test_speed_is_limited(void)
{
    copied[AHEAD].length = UINT16_MAX;
    copied[AHEAD].duration = 1;
    copied[AHEAD].base[JP_COST_PHYSICAL] = 0;
    learned.b[0] += JP_Q16(0.25);
    charge_by_models(&copy);
    TEST_ASSERT_INT32_WITHIN(100, 4686217, axis()->climb.constant); /* 16 W more than 6 W + 1335.25 W */
}

/* ---- What is refused ---- */

static void expect_factor_refused(const char *name)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_tariff_by_factors(&tariff, balancer, &factors, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

static void test_factors_out_of_range(void)
{
    static const jp_q16 wrong[] = {JP_TARIFF_FACTOR_MIN - 1, JP_TARIFF_FACTOR_MAX + 1, 0, -JP_Q16_ONE, INT32_MIN};

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        setUp();
        factors.straight = wrong[i];
        expect_factor_refused("straight");
        factors.straight = JP_Q16_ONE;
        factors.turning = wrong[i];
        expect_factor_refused("turning");
        factors.turning = JP_Q16_ONE;
        factors.mass = wrong[i];
        expect_factor_refused("mass");
    }
}

static void test_factors_want_pointers(void)
{
    const char *field = "none";
    struct jp_tariff homeless = {.primitives = NULL, .primitives_max = PRIMITIVES_MAX};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_factors(NULL, balancer, &factors, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_factors(&homeless, balancer, &factors, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_factors(&tariff, NULL, &factors, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_factors(&tariff, balancer, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_factors(&tariff, balancer, &factors, NULL));
}

static void test_models_want_pointers(void)
{
    const char *field = "none";
    struct jp_tariff homeless = {.primitives = NULL, .primitives_max = PRIMITIVES_MAX};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(NULL, balancer, &models, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(&homeless, balancer, &models, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(&tariff, NULL, &models, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(&tariff, balancer, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(&tariff, balancer, &models, NULL));
    models.learned = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(&tariff, balancer, &models, &field));
    models.built_in = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_models(&tariff, balancer, &models, &field));
}

static void expect_models_refused(const char *name)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_tariff_by_models(&tariff, balancer, &models, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
}

static void test_models_out_of_range(void)
{
    struct jp_energy_model wrong = jp_energy_model_gao2018;

    learned.b[1] = -1;
    expect_models_refused("model.b");
    wrong.electronics_power = 0;
    models.built_in = &wrong;
    expect_models_refused("model.electronics_power");
    models.built_in = &jp_energy_model_gao2018;
    models.learned = &jp_energy_model_gao2018;
    models.mass = 0;
    expect_models_refused("mass");
}

/* Prices are joules, whatever unit the models have. */
static void test_models_in_another_unit(void)
{
    static struct jp_primitive in_joules[PRIMITIVES_MAX];

    learned.a[2] += JP_Q16(3);
    learned.b[0] += JP_Q16(5);
    learned.b[1] += JP_Q16(0.25);
    charge_by_models(balancer);
    memcpy(in_joules, primitives, sizeof in_joules);
    for (int32_t exponent = -4; exponent <= 4; exponent += 8) {
        const struct jp_energy_model built_in_unit = energy_model_in_unit(&jp_energy_model_gao2018, exponent);
        const struct jp_energy_model learned_in_unit = energy_model_in_unit(&learned, exponent);

        models.built_in = &built_in_unit;
        models.learned = &learned_in_unit;
        charge_by_models(balancer);
        for (unsigned i = 0; i < balancer->first_from[JP_HEADINGS]; i++) {
            TEST_ASSERT_INT_WITHIN(1, in_joules[i].base[JP_COST_PHYSICAL], base(i));
        }
    }
}

static void test_models_of_different_units(void)
{
    learned.unit_exponent = 1;
    expect_models_refused("model.unit_exponent");
}

static void test_models_that_differ_too_much(void)
{
    struct jp_energy_model idle = jp_energy_model_gao2018;

    learned.b[0] = JP_Q16(4096);
    expect_models_refused("straight");
    idle.electronics_power = 1; /* then the ratio fits no 32 bits */
    idle.b[0] = 0;
    models.built_in = &idle;
    expect_models_refused("straight");
}

static void test_memory_for_all_primitives(void)
{
    const char *field = "none";

    tariff.primitives_max = PRIMITIVES_MAX - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_tariff_by_factors(&tariff, balancer, &factors, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_tariff_by_models(&tariff, balancer, &models, &field));
}

static void expect_overflow(void)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT(JP_ERR_OVERFLOW, jp_tariff_by_factors(&tariff, &copy, &factors, &field));
    TEST_ASSERT_NULL(field);
}

static void test_costs_that_do_not_fit(void)
{
    static const struct jp_polynomial dear[] = {
        {INT32_MAX / 2, 0, 0},              /* the constant */
        {0, INT32_MAX / 2, 0},              /* the linear part */
        {0, 0, INT32_MAX / 2},              /* the quadratic part */
        {INT32_MAX / 8, INT32_MAX / 256, 0} /* each, but not their sum */
    };

    factors.straight = JP_Q16(4);
    factors.mass = JP_Q16(4);
    for (size_t i = 0; i < sizeof dear / sizeof dear[0]; i++) {
        struct jp_slope_cost *cost = &copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_DIAGONAL];
        *cost = (struct jp_slope_cost){.climb = dear[i], .rise_max = 64, .floor = 1};
        expect_overflow();
        *cost = (struct jp_slope_cost){.descend = dear[i], .rise_max = 64, .floor = 1, .bend = 64};
        expect_overflow();
    }
}

static void test_bases_that_do_not_fit(void)
{
    copied[IN_PLACE].base[JP_COST_PHYSICAL] = 40000;
    factors.turning = JP_Q16(1.5);
    charge_by_factors(&copy);
    TEST_ASSERT_EQUAL_UINT(60000, base(IN_PLACE));
    factors.turning = JP_Q16(2);
    expect_overflow();
}

/* ---- Grounds ---- */

static struct jp_tariff_factors of[JP_GROUND_CLASSES];
static struct jp_tariff_grounds grounds;

static void set_grounds(void)
{
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        of[k] = factors;
    }
    grounds = (struct jp_tariff_grounds){of, JP_GROUND_CLASSES, 0};
}

static void test_the_cheapest_ground_sets_the_prices_of_the_lattice(void)
{
    struct jp_tariff cheapest = {.primitives = copied, .primitives_max = PRIMITIVES_MAX};
    const char *field = "";

    set_grounds();
    of[1].straight = JP_Q16(0.5);
    of[2].turning = JP_Q16(0.25);
    of[3].straight = JP_Q16(4);
    of[3].turning = JP_Q16(1.5);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, balancer, &grounds, &field));
    expect_sound(balancer);
    factors.straight = JP_Q16(0.5);
    factors.turning = JP_Q16(0.25);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&cheapest, balancer, &factors, &field));
    TEST_ASSERT_EQUAL_MEMORY(copied, primitives, balancer->first_from[JP_HEADINGS] * sizeof copied[0]);
    TEST_ASSERT_EQUAL_MEMORY(&cheapest.lattice.move_costs, &tariff.lattice.move_costs,
                             sizeof tariff.lattice.move_costs);
    TEST_ASSERT_EQUAL_UINT16(JP_GROUND_ONE, tariff.lattice.ground[0].straight); /* twice as much */
    TEST_ASSERT_EQUAL_UINT16(3U * JP_GROUND_ONE, tariff.lattice.ground[0].turning);
    TEST_ASSERT_EQUAL_UINT16(0, tariff.lattice.ground[1].straight);
    TEST_ASSERT_EQUAL_UINT16(0, tariff.lattice.ground[2].turning);
    TEST_ASSERT_EQUAL_UINT16(7U * JP_GROUND_ONE, tariff.lattice.ground[3].straight);
    TEST_ASSERT_EQUAL_UINT16(5U * JP_GROUND_ONE, tariff.lattice.ground[3].turning);
}

static void test_grounds_that_the_map_does_not_have_are_as_class_0(void)
{
    const char *field = "";

    set_grounds();
    of[1].straight = JP_Q16(0.25);
    grounds.classes = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, balancer, &grounds, &field));
    TEST_ASSERT_EQUAL_MEMORY(&balancer->ground, &tariff.lattice.ground, sizeof tariff.lattice.ground);
    TEST_ASSERT_EQUAL_MEMORY(&balancer->sides, &tariff.lattice.sides, sizeof tariff.lattice.sides);
    TEST_ASSERT_EQUAL_MEMORY(balancer->primitives, primitives,
                             balancer->first_from[JP_HEADINGS] * sizeof primitives[0]);
}

/* Across the heading, and no further than what each primitive sweeps. */
static void test_where_the_wheels_are(void)
{
    const char *field = "";

    set_grounds();
    grounds.half_track = JP_Q16(0.35);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, &jp_lattice_zhang2018_navigation, &grounds, &field));
    TEST_ASSERT_EQUAL_INT32(JP_Q16(0.35), tariff.lattice.half_track);
    TEST_ASSERT_EQUAL_INT(0, tariff.lattice.sides[0].dx);
    TEST_ASSERT_EQUAL_INT(2, tariff.lattice.sides[0].dy);
    TEST_ASSERT_EQUAL_INT(-1, tariff.lattice.sides[2].dx);
    TEST_ASSERT_EQUAL_INT(1, tariff.lattice.sides[2].dy);
    TEST_ASSERT_EQUAL_INT(-2, tariff.lattice.sides[4].dx);
    TEST_ASSERT_EQUAL_INT(0, tariff.lattice.sides[4].dy);
    grounds.half_track = JP_Q16(4);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, &jp_lattice_zhang2018_navigation, &grounds, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&tariff.lattice, &field));
    TEST_ASSERT_GREATER_THAN_INT(1, tariff.lattice.sides[0].dy);
    TEST_ASSERT_LESS_THAN_INT(20, tariff.lattice.sides[0].dy);
}

/* Both are, or none: what one side alone has cells for is no place of wheels. */
static void test_wheels_stay_within_a_core_that_is_longer_on_one_side(void)
{
    static const struct jp_span lopsided = {0, -3, 1};
    static const struct jp_span even = {0, -3, 3};
    const char *field = "";

    set_grounds();
    grounds.half_track = 3 * copy.resolution;
    copy.core = (struct jp_cells){0, 1};
    copy.spans = &even;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, &copy, &grounds, &field));
    TEST_ASSERT_EQUAL_INT(-3, tariff.lattice.sides[4].dx);
    TEST_ASSERT_EQUAL_INT(3, tariff.lattice.sides[12].dx);
    copy.spans = &lopsided;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, &copy, &grounds, &field));
    TEST_ASSERT_EQUAL_INT(-1, tariff.lattice.sides[4].dx);
    TEST_ASSERT_EQUAL_INT(1, tariff.lattice.sides[12].dx);
    TEST_ASSERT_EQUAL_INT(0, tariff.lattice.sides[0].dy); /* it has no cells there */
}

/* A core that reaches to one side only, or nowhere, has the wheels in its middle. */
static void test_wheels_of_a_core_without_sides(void)
{
    static const struct jp_span one_cell = {0, 0, 0};
    static const struct jp_span upward[] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const char *field = "";

    for (int i = 0; i < 2; i++) {
        set_grounds();
        grounds.half_track = 2 * copy.resolution - copy.resolution / 8;
        copy.spans = i == 0 ? &one_cell : upward;
        copy.core = (struct jp_cells){0, i == 0 ? 1 : 3};
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_grounds(&tariff, &copy, &grounds, &field));
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            TEST_ASSERT_EQUAL_INT(0, tariff.lattice.sides[heading].dx);
            TEST_ASSERT_EQUAL_INT(0, tariff.lattice.sides[heading].dy);
        }
    }
}

/* Also by the least that a factor may be above one. */
static void test_turning_rounds_up_by_the_least_factor(void)
{
    const char *field = "";
    const struct jp_tariff_factors least = {.straight = JP_Q16_ONE, .mass = JP_Q16_ONE, .turning = JP_Q16_ONE + 1};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&tariff, balancer, &least, &field));
    for (unsigned i = 0; i < balancer->first_from[JP_HEADINGS]; i++) {
        const uint16_t base = balancer->primitives[i].base[JP_COST_PHYSICAL];
        if (balancer->primitives[i].start != balancer->primitives[i].end) {
            TEST_ASSERT_EQUAL_UINT32(base + (base > 0 ? 1 : 0), primitives[i].base[JP_COST_PHYSICAL]);
        }
    }
}

static void test_prices_of_grounds_that_are_refused(void)
{
    const char *field = "";

    set_grounds();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_grounds(NULL, balancer, &grounds, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_grounds(&tariff, NULL, &grounds, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_grounds(&tariff, balancer, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_grounds(&tariff, balancer, &grounds, NULL));
    grounds.factors = NULL;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_tariff_by_grounds(&tariff, balancer, &grounds, &field));
    set_grounds();
    of[1].turning = JP_TARIFF_FACTOR_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_tariff_by_grounds(&tariff, balancer, &grounds, &field));
    TEST_ASSERT_EQUAL_STRING("turning", field);
    set_grounds();
    tariff.primitives_max = 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_tariff_by_grounds(&tariff, balancer, &grounds, &field));
}

static void test_limits_of_grounds(void)
{
    static const struct {
        uint8_t classes;
        jp_q16 half_track;
        const char *field; /* NULL: it is taken */
    } limits[] = {{0, 0, "classes"},
                  {1, 0, NULL},
                  {JP_GROUND_CLASSES, JP_Q16(4), NULL},
                  {JP_GROUND_CLASSES + 1U, 0, "classes"},
                  {1, -1, "half_track"},
                  {1, JP_Q16(4) + 1, "half_track"}};

    set_grounds();
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        const char *field = NULL;

        grounds.classes = limits[i].classes;
        grounds.half_track = limits[i].half_track;
        TEST_ASSERT_EQUAL_INT(limits[i].field == NULL ? JP_OK : JP_ERR_CONFIG,
                              jp_tariff_by_grounds(&tariff, balancer, &grounds, &field));
        if (limits[i].field != NULL) {
            TEST_ASSERT_EQUAL_STRING(limits[i].field, field);
        }
    }
}

/* A curve of two moves, of which the first alone looks straight. */
static void test_two_moves_that_differ_are_no_straight_way(void)
{
    static uint8_t moves[] = {0, 0};
    const char *field = "none";

    for (unsigned i = 0; i < copy.first_from[JP_HEADINGS]; i++) {
        copied[i].move_count = 0;
    }
    copy.moves = moves;
    copied[IN_PLACE].move_count = 2;
    copied[IN_PLACE].first_move = 0;
    copied[IN_PLACE].end = copied[IN_PLACE].start;
    copied[IN_PLACE].base[JP_COST_PHYSICAL] = 100;
    factors.straight = JP_Q16(1.5);
    factors.turning = JP_Q16(2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&tariff, &copy, &factors, &field));
    TEST_ASSERT_EQUAL_UINT(150, base(IN_PLACE));
    moves[1] = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_factors(&tariff, &copy, &factors, &field));
    TEST_ASSERT_EQUAL_UINT(200, base(IN_PLACE));
}
