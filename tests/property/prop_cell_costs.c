/*
 * The planner on maps whose cells have costs and classes of ground, against Dijkstra in double precision: random
 * lattices, random edits of costs, classes, cells, elevations and prices of grounds while it searches.
 *
 * prop_cell_costs [--count N] [--seed S]
 * --count is the number of edits.
 */
#include <joulepath/tables.h>
#include <joulepath/tariff.h>

#include "tests/support/options.h"
#include "tests/support/planner_oracle.h"
#include "tests/support/random.h"
#include "tests/support/toy_lattice.h"

enum {
    SIDE = 28,
    EDITS_PER_MAP = 20,
    BLOCKED_PERCENT = 8,
    ROUGHNESS = 30,
    DEAR_MAX = 40, /* of a factor, so that no route exceeds JP_COST_MAX */
    BLOCK = 1 << 19,
    TRIES = 1000,
    PRIMITIVES_MAX = 256
};

static struct toy_lattice toy;
static const struct jp_lattice *built_in;
static const struct jp_lattice *lattice; /* of its prices, or of a tariff */
static struct jp_primitive primitives[2][PRIMITIVES_MAX];
static struct jp_tariff tariffs[2];
static unsigned next_tariff;
static enum jp_cost_kind kind;
static struct jp_terrain terrain;
static uint64_t terrain_block[1024];
static struct oracle_map map;
static struct oracle oracle;
static struct jp_planner planner;
static _Alignas(8) uint8_t block[BLOCK];
static struct jp_lattice_pose start;
static struct jp_goal goal;
static struct options options = {.count = 400, .seed = 1};

static void pick_lattice(void)
{
    switch (below(3)) {
    case 0:
        built_in = &jp_lattice_gao2018;
        break;
    default:
        toy_lattice_make(&toy, JP_Q16(0.2));
        built_in = &toy.lattice;
        break;
    }
    lattice = built_in;
    kind = one_in(2) ? JP_COST_PHYSICAL : (enum jp_cost_kind)below(JP_COST_KINDS);
}

static jp_q16 random_factor(void)
{
    return JP_TARIFF_FACTOR_MIN + (jp_q16)below(JP_TARIFF_FACTOR_MAX - JP_TARIFF_FACTOR_MIN + 1);
}

/* Of each class. Factors that the lattice has no costs for are drawn again. */
static void price_grounds(void)
{
    struct jp_tariff *tariff = &tariffs[next_tariff];
    struct jp_tariff_factors factors[JP_GROUND_CLASSES];
    const char *field = "";
    enum jp_status status;

    tariff->primitives = primitives[next_tariff];
    tariff->primitives_max = PRIMITIVES_MAX;
    do {
        for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
            factors[k] = (struct jp_tariff_factors){1, random_factor(), random_factor(), JP_Q16_ONE};
        }
        const struct jp_tariff_grounds grounds = {factors, (uint8_t)(1 + below(JP_GROUND_CLASSES)),
                                                  (jp_q16)below((uint32_t)(4 * built_in->resolution))};

        status = jp_tariff_by_grounds(tariff, built_in, &grounds, &field);
    } while (status == JP_ERR_OVERFLOW);
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, status, field);
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_lattice_check(&tariff->lattice, &field), field);
    lattice = &tariff->lattice;
    next_tariff = 1 - next_tariff;
}

static int random_cost(void)
{
    const uint32_t most = (uint32_t)(DEAR_MAX - 1) << map.cost_shift;

    return one_in(2) ? 0 : (int)below(most < UINT8_MAX ? most + 1 : UINT8_MAX + 1);
}

static void make_map(void)
{
    const struct jp_terrain_config config = {.width = SIDE,
                                             .height = SIDE,
                                             .resolution = lattice->resolution,
                                             .has_elevation = one_in(2),
                                             .has_costs = one_in(2),
                                             .has_classes = one_in(2),
                                             .cost_shift = (uint8_t)below(JP_CELL_COST_SHIFT_MAX + 1)};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT_MESSAGE(
        JP_OK, jp_terrain_init(&terrain, &config, terrain_block, sizeof terrain_block, &field), field);
    oracle_map_clear(&map, SIDE, SIDE);
    oracle_init(&oracle, lattice, kind);
    map.cost_shift = config.cost_shift;
    map.has_classes = config.has_classes;
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        const int32_t x = i % SIDE;
        const int32_t y = i / SIDE;
        const int cell = oracle_cell(x, y);
        map.is_blocked[cell] = below(100) < BLOCKED_PERCENT;
        map.cell_cost[cell] = config.has_costs ? random_cost() : 0;
        map.ground[cell] = config.has_classes ? (int)below(JP_GROUND_CLASSES) : 0;
        map.elevation[cell] = config.has_elevation ? (int)below(ROUGHNESS) : 0;
        (void)jp_terrain_set_cell(&terrain, x, y, map.is_blocked[cell] ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        (void)jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)map.elevation[cell]);
        (void)jp_terrain_set_cost(&terrain, x, y, (uint8_t)map.cell_cost[cell]);
        (void)jp_terrain_set_class(&terrain, x, y, (uint8_t)map.ground[cell]);
    }
}

static struct jp_lattice_pose random_pose(void)
{
    return (struct jp_lattice_pose){(int16_t)below(SIDE), (int16_t)below(SIDE), (uint8_t)below(JP_HEADINGS)};
}

static bool put_task(void)
{
    for (int i = 0; i < TRIES; i++) {
        const struct jp_lattice_pose end = random_pose();
        start = random_pose();
        goal = (struct jp_goal){end.x, end.y, JP_ANY_HEADING};
        if (jp_planner_set_start(&planner, &start) == JP_OK && jp_planner_set_goal(&planner, &goal) == JP_OK) {
            return true;
        }
    }
    return false;
}

static void begin(void)
{
    const char *field = "";

    do {
        pick_lattice();
        make_map();
        if (terrain.config.has_classes) {
            price_grounds();
            oracle_init(&oracle, lattice, kind);
        }
        const struct jp_planner_config config = {lattice, kind, {JP_EPSILON(2), JP_EPSILON_ONE}};
        TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_planner_init(&planner, &config, &terrain, block, sizeof block, &field),
                                      field);
    } while (!put_task());
}

static void edit(void)
{
    const int32_t x = (int32_t)below(SIDE);
    const int32_t y = (int32_t)below(SIDE);
    const int cell = oracle_cell(x, y);

    if (one_in(6)) {
        map.is_blocked[cell] = one_in(2);
        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_planner_set_cell(&planner, x, y, map.is_blocked[cell] ? JP_CELL_OCCUPIED : JP_CELL_FREE));
    } else if (terrain.config.has_elevation && one_in(6)) {
        map.elevation[cell] = (int)below(ROUGHNESS);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_elevation(&planner, x, y, (jp_elevation)map.elevation[cell]));
    } else if (terrain.config.has_classes && one_in(20)) {
        price_grounds();
        oracle_init(&oracle, lattice, kind);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_lattice(&planner, lattice));
    } else if (terrain.config.has_classes && one_in(2)) {
        map.ground[cell] = (int)below(JP_GROUND_CLASSES);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_class(&planner, x, y, (uint8_t)map.ground[cell]));
    } else if (terrain.config.has_costs) {
        map.cell_cost[cell] = random_cost();
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cost(&planner, x, y, (uint8_t)map.cell_cost[cell]));
    }
    if (one_in(4)) {
        (void)jp_planner_work(&planner, below(60));
    }
}

/* The cost of the plan's steps by the oracle. */
static double driven_cost(void)
{
    struct jp_lattice_pose pose = jp_planner_plan(&planner)->start;
    double cost = 0;

    for (unsigned i = 0; i < jp_planner_plan(&planner)->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *step = jp_planner_step(&planner, i, &pose);
        cost += oracle_edge(&oracle, &map, (int)(step - lattice->primitives), from.x, from.y);
    }
    return cost;
}

static bool expect_optimum(void)
{
    enum jp_answer answer = jp_planner_work(&planner, 1 + below(500));

    while (!jp_planner_is_idle(&planner)) {
        answer = jp_planner_work(&planner, 1 + below(500));
    }
    const double optimum = oracle_shortest(&oracle, &map, &start, &goal);
    TEST_ASSERT_EQUAL_INT(isinf(optimum) ? JP_ANSWER_UNREACHABLE : JP_ANSWER_OPTIMAL, answer);
    if (answer == JP_ANSWER_OPTIMAL) {
        TEST_ASSERT_EQUAL_UINT32((uint32_t)optimum, jp_planner_plan(&planner)->cost);
        TEST_ASSERT_EQUAL_UINT32((uint32_t)optimum, (uint32_t)driven_cost());
    }
    return answer == JP_ANSWER_OPTIMAL;
}

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_edits_keep_the_optimum(void)
{
    unsigned long optimal = 0;

    begin_random(options.seed, 1);
    for (unsigned long i = 0; i < options.count; i++) {
        if (i % EDITS_PER_MAP == 0) {
            begin();
        }
        optimal += expect_optimum();
        for (uint32_t cells = 1 + below(6); cells > 0; cells--) {
            edit();
        }
    }
    printf("edits %lu, optimal %lu\n", options.count, optimal);
    TEST_ASSERT_GREATER_THAN_UINT(options.count / 2, optimal);
}

static void test_costs_that_cannot_be_set(void)
{
    const struct jp_terrain_config plain = {.width = SIDE, .height = SIDE, .resolution = JP_Q16(0.2)};
    const char *field = "";

    begin_random(options.seed, 2);
    do {
        begin();
    } while (!terrain.config.has_costs || !terrain.config.has_classes);
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_cost(&planner, SIDE, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_planner_set_class(&planner, 0, -1, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_planner_set_class(&planner, 0, 0, JP_GROUND_CLASSES));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &plain, terrain_block, sizeof terrain_block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_planner_set_cost(&planner, 0, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_STATE, jp_planner_set_class(&planner, 0, 0, 1));
}

static void add_figures(json_t *figures)
{
    (void)figures;
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
