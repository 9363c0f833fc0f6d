/*
 * Lattices at random prices: their tables against long double arithmetic, what their primitives cost against the energy
 * model, the planner on them against Dijkstra over the whole lattice while prices and map change, and the lower bounds
 * that it lives on.
 *
 * prop_tariff [--count N] [--seed S]
 * --count is the number of price changes.
 */
#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <joulepath/tariff.h>
#include <stdio.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/planner_oracle.h"
#include "tests/support/random.h"
#include "tests/support/toy_lattice.h"
#include "unity.h"

enum {
    SIDE_MIN = 12,
    SIDE_MAX = 26,
    AMPLE_BYTES = 1 << 19, /* all states of the largest map, and the fields */
    PRIMITIVES_MAX = 160,
    CHANGES_PER_MAP = 6,
    ROUGHNESS_MAX = 50, /* units of elevation */
    WORK_MAX = 1 << 22, /* expansions after which a planner hangs */
    TRIES = 400
};

/* The range of factors that a drive may bring. */
#define FACTOR_MIN 0.3
#define FACTOR_MAX 4.0

static struct toy_lattice toy;
static const struct jp_lattice *lattice; /* at its own prices */
static struct jp_primitive primitives[2][PRIMITIVES_MAX];
static struct jp_tariff tariffs[2];
static unsigned current; /* the tariff that is planned on */
static uint32_t version;

static struct jp_lattice expected;
static struct jp_primitive expected_primitives[PRIMITIVES_MAX];
static struct oracle oracle;
static struct oracle_map map;

static struct options options = {.count = 200, .seed = 1};
static struct jp_terrain terrain;
static struct jp_terrain_config config;
static uint64_t terrain_block[1024];
static struct jp_planner planner;
static _Alignas(8) uint8_t block[AMPLE_BYTES];
static struct jp_lattice_pose start;
static struct jp_goal goal;

void setUp(void)
{
    for (unsigned i = 0; i < 2; i++) {
        tariffs[i].primitives = primitives[i];
        tariffs[i].primitives_max = PRIMITIVES_MAX;
    }
}

void tearDown(void)
{
}

/* ---- Prices ---- */

/* Evenly over the decades. */
static jp_q16 random_factor(void)
{
    const double share = below(1 << 20) / (double)(1 << 20);

    return (jp_q16)lrint(FACTOR_MIN * pow(FACTOR_MAX / FACTOR_MIN, share) * JP_Q16_ONE);
}

static struct jp_tariff_factors random_factors(void)
{
    return (struct jp_tariff_factors){++version, random_factor(), random_factor(), random_factor()};
}

/* Times and lengths as a robot might have them. */
static void time_toy(void)
{
    for (unsigned i = 0; i < toy.primitive_count; i++) {
        toy.primitives[i].length = (uint16_t)(toy.primitives[i].move_count * (150U + below(200)));
        toy.primitives[i].duration = (uint16_t)(200U + below(4000));
    }
}

static void random_lattice(void)
{
    const char *field = NULL;

    switch (below(3)) {
    case 0:
        lattice = &jp_lattice_zhang2018;
        break;
    case 1:
        lattice = &jp_lattice_gao2018;
        break;
    default:
        toy_lattice_make(&toy, jp_lattice_zhang2018.resolution);
        time_toy();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_check(&toy.lattice, &field));
        lattice = &toy.lattice;
        break;
    }
}

static int32_t scaled(int32_t value, long double factor)
{
    return (int32_t)fmaxl(fminl(floorl(value * factor), INT32_MAX), INT32_MIN);
}

static void expect_scaled_polynomial(struct jp_polynomial *polynomial, long double straight, long double mass,
                                     long double mass_square)
{
    polynomial->constant = scaled(polynomial->constant, straight);
    polynomial->linear = scaled(polynomial->linear, mass);
    polynomial->quadratic = scaled(polynomial->quadratic, mass_square);
}

/* All in one direction, to the heading that it had. */
static bool leads_straight_on(const struct jp_primitive *primitive)
{
    bool is_one_way = primitive->move_count > 0;

    for (int i = 0; i < primitive->move_count; i++) {
        is_one_way &= lattice->moves[primitive->first_move + i] == lattice->moves[primitive->first_move];
    }
    return is_one_way && primitive->start == primitive->end;
}

/* The lattice at other prices, in arithmetic of our own. */
static void expect_prices(const struct jp_tariff_factors *factors)
{
    const long double straight = factors->straight / 65536.0L;
    const long double turning = factors->turning / 65536.0L;
    const long double mass = factors->mass / 65536.0L;
    const long double mass_square = floorl(mass * mass * 65536.0L + 0.5L) / 65536.0L;

    expected = *lattice;
    expected.primitives = expected_primitives;
    for (int move = 0; move < JP_MOVE_KINDS; move++) {
        struct jp_slope_cost *cost = &expected.move_costs[JP_COST_PHYSICAL][move];
        expect_scaled_polynomial(&cost->climb, straight, mass, mass_square);
        expect_scaled_polynomial(&cost->descend, straight, mass, mass_square);
        cost->bend = (int16_t)truncl((long double)cost->bend * factors->straight / factors->mass);
    }
    for (int i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        const long double factor = leads_straight_on(primitive) ? straight : turning;
        expected_primitives[i] = *primitive;
        expected_primitives[i].base[JP_COST_PHYSICAL] =
            (uint16_t)fminl(ceill(primitive->base[JP_COST_PHYSICAL] * factor), UINT16_MAX);
    }
}

/* Charges the tariff that is not planned on. False when the prices fit no table. */
static bool charge(const struct jp_tariff_factors *factors)
{
    const char *field = "";
    const unsigned spare = 1U - current;
    const enum jp_status status = jp_tariff_by_factors(&tariffs[spare], lattice, factors, &field);

    TEST_ASSERT_TRUE(status == JP_OK || status == JP_ERR_OVERFLOW);
    if (status == JP_OK) {
        current = spare;
    }
    return status == JP_OK;
}

static const struct jp_lattice *charged(void)
{
    return &tariffs[current].lattice;
}

static void expect_sound(void)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_lattice_check(charged(), &field), field);
    TEST_ASSERT_EQUAL_UINT32(version, charged()->version);
}

/* ---- Maps ---- */

static void put_cell(bool tell, int x, int y, bool is_blocked)
{
    const enum jp_cell cell = is_blocked ? JP_CELL_OCCUPIED : JP_CELL_FREE;

    TEST_ASSERT_EQUAL_INT(JP_OK,
                          tell ? jp_planner_set_cell(&planner, x, y, cell) : jp_terrain_set_cell(&terrain, x, y, cell));
    map.is_blocked[oracle_cell(x, y)] = is_blocked;
}

static void random_map(void)
{
    const char *field = NULL;
    const uint32_t blocked_percent = lattice == &toy.lattice ? below(25) : below(6);
    const uint32_t roughness = below(ROUGHNESS_MAX);

    config = (struct jp_terrain_config){.width = (uint16_t)(SIDE_MIN + below(SIDE_MAX - SIDE_MIN + 1)),
                                        .height = (uint16_t)(SIDE_MIN + below(SIDE_MAX - SIDE_MIN + 1)),
                                        .resolution = lattice->resolution,
                                        .has_elevation = true};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, terrain_block, sizeof terrain_block, &field));
    oracle_map_clear(&map, config.width, config.height);
    for (int y = 0; y < config.height; y++) {
        for (int x = 0; x < config.width; x++) {
            const int elevation = (int)below(roughness + 1);
            put_cell(false, x, y, below(100) < blocked_percent);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)elevation));
            map.elevation[oracle_cell(x, y)] = elevation;
        }
    }
}

static struct jp_lattice_pose random_pose(void)
{
    return (struct jp_lattice_pose){(int16_t)below(config.width), (int16_t)below(config.height),
                                    (uint8_t)below(JP_HEADINGS)};
}

/* Start and goal where the robot fits. */
static bool random_task(void)
{
    for (int i = 0; i < TRIES; i++) {
        const struct jp_lattice_pose from = random_pose();
        const struct jp_lattice_pose to = random_pose();
        start = from;
        goal = (struct jp_goal){to.x, to.y, (uint16_t)(one_in(3) ? JP_ANY_HEADING : 1U << to.heading)};
        if (jp_planner_set_start(&planner, &start) == JP_OK && jp_planner_set_goal(&planner, &goal) == JP_OK) {
            return true;
        }
    }
    return false;
}

/* A lattice at random prices, a map and a task, all ready to be planned. */
static void random_trial(void)
{
    struct jp_tariff_factors factors;
    const char *field = NULL;

    do {
        random_lattice();
        factors = random_factors();
        while (!charge(&factors)) {
            factors = random_factors();
        }
        random_map();
        const struct jp_planner_config planner_config = {
            .lattice = charged(), .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(2), JP_EPSILON_ONE}};
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&planner, &planner_config, &terrain, block, sizeof block, &field));
    } while (!random_task());
    expect_prices(&factors);
}

/* ---- Tests ---- */

static void expect_tables(void)
{
    for (int move = 0; move < JP_MOVE_KINDS; move++) {
        TEST_ASSERT_EQUAL_MEMORY(&expected.move_costs[JP_COST_PHYSICAL][move],
                                 &charged()->move_costs[JP_COST_PHYSICAL][move], sizeof(struct jp_slope_cost));
    }
    TEST_ASSERT_EQUAL_MEMORY(expected_primitives, charged()->primitives,
                             lattice->first_from[JP_HEADINGS] * sizeof *expected_primitives);
}

static void test_tables_are_those_of_other_arithmetic(void)
{
    unsigned long refused = 0;

    begin_random(options.seed, 1);
    for (unsigned long i = 0; i < 4 * options.count; i++) {
        const char *field = "none";
        random_lattice();
        const struct jp_tariff_factors factors = random_factors();
        expect_prices(&factors);
        if (charge(&factors)) {
            expect_sound();
            expect_tables();
        } else { /* only what no table can hold */
            TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_lattice_check(&expected, &field));
            TEST_ASSERT_EQUAL_STRING("move_costs", field);
            refused++;
        }
    }
    printf("%lu tables, %lu of them too dear\n", 4 * options.count, refused);
    TEST_ASSERT_TRUE(refused * 4 < options.count);
}

static bool is_finished(enum jp_answer answer)
{
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_UNREACHABLE;
}

/* Plans to the end and compares with the exhaustive search at the prices of other arithmetic. */
static bool expect_optimum(void)
{
    oracle_init(&oracle, &expected, JP_COST_PHYSICAL);
    const double optimum = oracle_shortest(&oracle, &map, &start, &goal);
    enum jp_answer answer = jp_planner_work(&planner, 0);

    for (unsigned long work = 0; !jp_planner_is_idle(&planner); work += 100) {
        TEST_ASSERT_TRUE(work < WORK_MAX);
        answer = jp_planner_work(&planner, 100);
    }
    TEST_ASSERT_TRUE(is_finished(answer));
    TEST_ASSERT_EQUAL_INT(isinf(optimum), answer == JP_ANSWER_UNREACHABLE);
    if (answer == JP_ANSWER_OPTIMAL) {
        TEST_ASSERT_EQUAL_DOUBLE(optimum, jp_planner_plan(&planner)->cost);
        TEST_ASSERT_EQUAL_UINT32(charged()->version, jp_planner_plan(&planner)->parameter_version);
    }
    return answer == JP_ANSWER_OPTIMAL;
}

/* New prices now and then while it searches, new obstacles before and after. */
static void test_planner_follows_changing_prices(void)
{
    unsigned long changes = 0;
    unsigned long routes = 0;

    begin_random(options.seed, 2);
    while (changes < options.count) {
        random_trial();
        (void)expect_optimum();
        for (int i = 0; i < CHANGES_PER_MAP; i++) {
            const struct jp_tariff_factors factors = random_factors();
            put_cell(true, (int)below(config.width), (int)below(config.height), one_in(2));
            (void)jp_planner_work(&planner, below(200));
            if (!charge(&factors)) {
                continue;
            }
            expect_prices(&factors);
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, charged()));
            memset(primitives[1U - current], 0xA5, sizeof primitives[0]); /* the old prices are free */
            (void)jp_planner_work(&planner, below(200));
            put_cell(true, (int)below(config.width), (int)below(config.height), one_in(2));
            routes += expect_optimum();
            changes++;
        }
    }
    printf("%lu changes of prices, %lu with a route, all optimal\n", changes, routes);
    TEST_ASSERT_TRUE(routes * 3 > changes);
}

/* The field that proves the optimum: below the truth from a root, and no primitive overtakes it. */
static void expect_field_below(const struct jp_energy_field *field, const struct jp_turns *turns,
                               const struct jp_lattice_pose *root)
{
    struct jp_straight straight;

    jp_lattice_straight(charged(), JP_COST_PHYSICAL, &straight);
    for (int state = 0; state < map.width * map.height * JP_HEADINGS; state++) {
        const int heading = state % JP_HEADINGS;
        const int x = state / JP_HEADINGS % map.width;
        const int y = state / JP_HEADINGS / map.width;
        const double here = (double)jp_energy_field_bound(field, x, y) + turns->cost[root->heading][heading];
        TEST_ASSERT_TRUE(here <= oracle.distance[state]);
        if (isinf(oracle.distance[state])) {
            continue;
        }
        const jp_cost bound =
            jp_straight_bound(&straight, x - root->x, y - root->y,
                              map.elevation[oracle_cell(x, y)] - map.elevation[oracle_cell(root->x, root->y)]);
        TEST_ASSERT_TRUE((double)bound + turns->cost[root->heading][heading] <= oracle.distance[state]);
        for (int i = lattice->first_from[heading]; i < lattice->first_from[heading + 1]; i++) {
            const struct jp_primitive *p = &lattice->primitives[i];
            const double cost = oracle_edge(&oracle, &map, i, x, y);
            if (!isinf(cost)) {
                TEST_ASSERT_TRUE((double)jp_energy_field_bound(field, x + p->dx, y + p->dy) +
                                     turns->cost[root->heading][p->end] <=
                                 here + cost);
            }
        }
    }
}

static void test_bounds_remain_below_the_truth(void)
{
    static uint64_t field_block[(SIDE_MAX + 2) * SIDE_MAX];
    struct jp_energy_field field;
    struct jp_turns turns;

    begin_random(options.seed, 3);
    for (unsigned long i = 0; i < options.count / 4; i++) {
        unsigned cells = UINT16_MAX;
        random_trial();
        oracle_init(&oracle, &expected, JP_COST_PHYSICAL);
        (void)oracle_shortest(&oracle, &map, &start, NULL);
        TEST_ASSERT_TRUE(jp_energy_field_size(&config, JP_WAVE_3_BYTES) <= sizeof field_block);
        jp_lattice_turns(charged(), JP_COST_PHYSICAL, &turns);
        jp_energy_field_init(&field, charged(), JP_COST_PHYSICAL, &terrain, JP_WAVE_3_BYTES, JP_COST_MAX, field_block);
        jp_energy_field_start(&field, start.x, start.y, goal.x, goal.y);
        TEST_ASSERT_TRUE(jp_energy_field_grow(&field, &cells));
        expect_field_below(&field, &turns, &start);
    }
}

/* ---- Models ---- */

static jp_q16 random_share_of(jp_q16 value)
{
    return (jp_q16)((int64_t)value * random_factor() / JP_Q16_ONE);
}

static double level_cost(const struct jp_lattice *at, const struct jp_primitive *primitive)
{
    double cost = primitive->base[JP_COST_PHYSICAL];

    for (int i = 0; i < primitive->move_count; i++) {
        const enum jp_move_kind kind = jp_move_kind_of(lattice->moves[primitive->first_move + i]);
        cost += jp_move_cost(&at->move_costs[JP_COST_PHYSICAL][kind], 0);
    }
    return cost;
}

/* Cost units that the learned model adds to a primitive on level ground. */
static double learned_difference(const struct jp_energy_model *built_in, const struct jp_energy_model *learned,
                                 const struct jp_primitive *primitive)
{
    const double turn =
        (int32_t)(lattice->heading[primitive->end] - lattice->heading[primitive->start]) * M_PI / 0x1p31;
    const double length = primitive->length / 1000.0;
    const double duration = primitive->duration / 1000.0;
    const double joules = primitive->move_count == 0
                              ? (learned->a[2] - built_in->a[2]) / 65536.0 * turn * turn
                              : (learned->b[0] - built_in->b[0]) / 65536.0 * length * length / duration +
                                    (learned->b[1] - built_in->b[1]) / 65536.0 * turn * turn / duration;
    return joules * JP_COST_PER_JOULE;
}

static void expect_learned_cost(const struct jp_tariff_models *models, unsigned index, unsigned long *clamped)
{
    const struct jp_primitive *before = &lattice->primitives[index];
    const struct jp_primitive *after = &charged()->primitives[index];
    const double draw = models->built_in->electronics_power / 65536.0 * before->duration / 1000 * JP_COST_PER_JOULE;
    const double least = before->move_count > 0 ? 0 : fmax(1, floor(draw + 1e-6));
    const double cost = level_cost(lattice, before) + learned_difference(models->built_in, models->learned, before);

    TEST_ASSERT_TRUE(after->base[JP_COST_PHYSICAL] >= least);
    if (after->base[JP_COST_PHYSICAL] > least) { /* rounded up, from products that are rounded down */
        TEST_ASSERT_TRUE(level_cost(charged(), after) >= cost - 0.01);
        TEST_ASSERT_TRUE(level_cost(charged(), after) <= cost + 1.01);
    } else {
        TEST_ASSERT_TRUE(level_cost(charged(), after) >= cost - 0.01);
        ++*clamped;
    }
}

static void random_learned(struct jp_energy_model *learned)
{
    *learned = jp_energy_model_gao2018;
    learned->a[2] = random_share_of(learned->a[2]);
    learned->b[0] = random_share_of(learned->b[0]);
    learned->b[1] = random_share_of(learned->b[1]);
}

static void charge_learned(const struct jp_energy_model *learned, const struct jp_energy_model *built_in)
{
    const struct jp_tariff_models models = {++version, built_in, learned, JP_Q16_ONE};
    const char *field = "none";

    current = 1U - current;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_tariff_by_models(&tariffs[current], lattice, &models, &field));
}

static void test_primitives_cost_what_the_model_says(void)
{
    unsigned long clamped = 0;
    unsigned long primitive_count = 0;

    begin_random(options.seed, 4);
    for (unsigned long i = 0; i < 2 * options.count; i++) {
        struct jp_energy_model learned;
        const struct jp_tariff_models models = {0, &jp_energy_model_gao2018, &learned, JP_Q16_ONE};
        do {
            random_lattice();
        } while (lattice == &jp_lattice_zhang2018); /* of no such model */
        random_learned(&learned);
        charge_learned(&learned, &jp_energy_model_gao2018);
        expect_sound();
        for (unsigned k = 0; k < lattice->first_from[JP_HEADINGS]; k++) {
            expect_learned_cost(&models, k, &clamped);
            primitive_count++;
        }
    }
    printf("%lu primitives, %lu at their least\n", primitive_count, clamped);
}

/* There and back: the built-in model learned again gives the tables again. */
static void test_what_is_unlearned_costs_what_it_did(void)
{
    struct jp_energy_model learned;

    begin_random(options.seed, 5);
    lattice = &jp_lattice_gao2018;
    for (unsigned long i = 0; i < options.count; i++) {
        random_learned(&learned);
        charge_learned(&learned, &jp_energy_model_gao2018);
        charge_learned(&jp_energy_model_gao2018, &jp_energy_model_gao2018);
        TEST_ASSERT_EQUAL_MEMORY(lattice->move_costs, charged()->move_costs, sizeof lattice->move_costs);
        TEST_ASSERT_EQUAL_MEMORY(lattice->primitives, charged()->primitives,
                                 lattice->first_from[JP_HEADINGS] * sizeof *lattice->primitives);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
