/* The tables of both lattices: their check, costs by hand, swept cells, the core, symmetry. */
#include <joulepath/lattice.h>
#include <joulepath/tables.h>
#include <stddef.h>
#include <string.h>

#include "unity.h"

enum { SIDE = 29, CENTRE = SIDE / 2, PRIMITIVES_MAX = 160, MOVES_MAX = 512 };

static const struct jp_lattice *const lattices[] = {&jp_lattice_zhang2018, &jp_lattice_gao2018};
enum { LATTICES = sizeof lattices / sizeof lattices[0] };

static struct jp_terrain terrain;
static uint64_t block[SIDE * SIDE / 3];

/* A lattice to damage. */
static struct jp_lattice copy;
static struct jp_primitive primitives[PRIMITIVES_MAX];
static uint16_t by_end[PRIMITIVES_MAX];
static uint8_t moves[MOVES_MAX];

static unsigned count_of(const struct jp_lattice *lattice)
{
    return lattice->first_from[JP_HEADINGS];
}

static size_t move_total(const struct jp_lattice *lattice)
{
    size_t total = 0;

    for (unsigned i = 0; i < count_of(lattice); i++) {
        const size_t end = (size_t)lattice->primitives[i].first_move + lattice->primitives[i].move_count;
        total = end > total ? end : total;
    }
    return total;
}

/* All free and level. */
static void reset_terrain(void)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.2), .has_elevation = true, .unknown_is_free = true};
    const char *field = NULL;

    TEST_ASSERT_TRUE(jp_terrain_size(&config) <= sizeof block);
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
}

static void reset_copy(void)
{
    const struct jp_lattice *source = &jp_lattice_zhang2018;
    const unsigned count = count_of(source);

    TEST_ASSERT_TRUE(count <= PRIMITIVES_MAX && move_total(source) <= MOVES_MAX);
    copy = *source;
    memcpy(primitives, source->primitives, count * sizeof *primitives);
    memcpy(by_end, source->by_end, count * sizeof *by_end);
    memcpy(moves, source->moves, move_total(source));
    copy.primitives = primitives;
    copy.by_end = by_end;
    copy.moves = moves;
}

void setUp(void)
{
    reset_terrain();
    reset_copy();
}

void tearDown(void)
{
}

static void test_tables_pass_their_check(void)
{
    for (size_t i = 0; i < LATTICES; i++) {
        const char *field = "none";
        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_lattice_check(lattices[i], &field));
        TEST_ASSERT_NULL(field);
    }
}

static void test_check_wants_pointers(void)
{
    const char *field = NULL;
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_lattice_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT32(JP_ERR_ARGUMENT, jp_lattice_check(&copy, NULL));
}

/* The check of the damaged copy names the field; the copy is whole again afterwards. */
static void expect_bad(const char *name)
{
    const char *field = "none";
    TEST_ASSERT_EQUAL_INT32(JP_ERR_CONFIG, jp_lattice_check(&copy, &field));
    TEST_ASSERT_EQUAL_STRING(name, field);
    reset_copy();
}

static void test_check_of_resolution_and_headings(void)
{
    copy.resolution = 0;
    expect_bad("resolution");
    copy.heading[0] = 1;
    expect_bad("heading");
    copy.heading[7] = copy.heading[6];
    expect_bad("heading");
}

static void test_check_of_primitives(void)
{
    copy.primitives = NULL;
    expect_bad("primitives");
    primitives[3].start = JP_HEADINGS;
    expect_bad("primitives");
    primitives[3].start = 1;
    expect_bad("primitives");
    primitives[3].end = JP_HEADINGS;
    expect_bad("primitives");
    primitives[1].dx++;
    expect_bad("primitives");
    primitives[1].dy--;
    expect_bad("primitives");
    moves[primitives[1].first_move] = JP_MOVE_DIRECTIONS;
    expect_bad("primitives");
    copy.first_from[0] = 1;
    expect_bad("primitives");
    copy.first_from[5]++;
    expect_bad("primitives");
    copy.first_from[1] = JP_PRIMITIVES_PER_HEADING_MAX + 1;
    expect_bad("primitives");
}

static void test_check_of_a_turn_that_costs_nothing(void)
{
    for (unsigned kind = 0; kind < JP_COST_KINDS; kind++) {
        unsigned i = 0;
        while (primitives[i].move_count != 0) {
            i++;
        }
        primitives[i].base[kind] = 0;
        expect_bad("primitives");
    }
}

static void test_check_of_the_order_by_end(void)
{
    copy.by_end = NULL;
    expect_bad("by_end");
    by_end[0] = (uint16_t)count_of(&copy);
    expect_bad("by_end");
    by_end[0] = by_end[count_of(&copy) - 1];
    expect_bad("by_end");
    copy.first_to[0] = 1;
    expect_bad("by_end");
    copy.first_to[JP_HEADINGS]--;
    expect_bad("by_end");
}

/* A step along an axis that sweeps only where it begins, or only where it ends. */
static void test_check_of_ends_that_are_not_swept(void)
{
    static const struct jp_span spans[] = {{0, 0, 0}, {0, 1, 1}, {0, 0, 1}};

    for (uint16_t i = 0; i < 2U; i++) {
        copy.spans = spans;
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            copy.reach[heading] = (struct jp_cells){2, 1};
        }
        for (unsigned primitive = 0; primitive < count_of(&copy); primitive++) {
            primitives[primitive].first_span = i;
            primitives[primitive].span_count = 1;
        }
        expect_bad("spans");
    }
}

static void test_check_of_spans(void)
{
    copy.spans = NULL;
    expect_bad("spans");
    copy.core.span_count = 0;
    expect_bad("spans");
    copy.reach[3].span_count--; /* the last row of what is swept is outside */
    expect_bad("spans");
}

/* The first reach is looked at first, so that no other span is needed. */
static void test_check_of_the_reach(void)
{
    static const struct jp_span wrong[] = {{0, 1, 0}, {0, -127, -128}};

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        copy.spans = &wrong[i];
        copy.reach[0] = (struct jp_cells){0, 1};
        expect_bad("spans");
    }
}

/* On the row of what a primitive sweeps, but not all of it. */
static void test_check_of_a_reach_that_is_too_narrow(void)
{
    static const struct jp_span spans[] = {{0, -3, 3}, {0, -2, 3}, {0, -3, 2}, {1, -3, 3}};

    for (uint16_t narrow = 1; narrow < sizeof spans / sizeof *spans; narrow++) {
        copy.spans = spans;
        copy.reach[0] = (struct jp_cells){narrow, 1};
        primitives[0].first_span = 0;
        primitives[0].span_count = 1;
        expect_bad("spans");
    }
}

/* What no primitive sweeps. */
static void test_check_of_the_cells_of_the_wheels(void)
{
    copy.sides[0].dx = INT8_MAX;
    expect_bad("sides");
    copy.sides[JP_MOVE_DIRECTIONS - 1U].dy = -INT8_MAX;
    expect_bad("sides");
}

/* Of a core that is its first row alone, on one side of the robot. */
static void test_check_of_the_cells_of_wheels_that_are_not_opposite(void)
{
    const struct jp_span *row = &copy.spans[copy.core.first_span];

    copy.core.span_count = 1;
    for (unsigned i = 0; i < (unsigned)JP_MOVE_DIRECTIONS; i++) {
        copy.sides[i] = (struct jp_cell_offset){0, row->y};
    }
    TEST_ASSERT_TRUE(jp_lattice_core_holds(&copy, 0, row->y));
    TEST_ASSERT_FALSE(jp_lattice_core_holds(&copy, 0, -row->y));
    expect_bad("sides");
}

static void test_check_of_prices_of_grounds(void)
{
    copy.ground[0].straight = JP_GROUND_SHARE_MAX + 1U;
    expect_bad("ground");
    copy.ground[JP_GROUND_CLASSES - 1U].turning = JP_GROUND_SHARE_MAX + 1U;
    expect_bad("ground");
}

static void test_check_of_move_costs(void)
{
    struct jp_slope_cost *cost = &copy.move_costs[JP_COST_PAPER][JP_MOVE_DIAGONAL];
    cost->rise_max = 0;
    expect_bad("move_costs");
    cost->rise_max = 4097;
    expect_bad("move_costs");
    cost->floor = 0;
    expect_bad("move_costs");
    cost->climb.linear = INT32_MAX;
    expect_bad("move_costs");
    cost->climb.quadratic = INT32_MAX / 50;
    expect_bad("move_costs");
    cost->descend.linear = INT32_MIN;
    expect_bad("move_costs");
}

/* A climb of one or two units overflows a part of the sum, though not always the sum. */
static void test_check_of_each_part_of_a_move_cost(void)
{
    static const struct jp_polynomial wrong[] = {
        {0, INT32_MIN, (int32_t)1 << 30},               /* the quadratic part, upwards */
        {0, INT32_MAX, -((int32_t)1 << 30) - 1},        /* and downwards */
        {INT32_MAX, 1, 0},                              /* the sum, upwards */
        {INT32_MIN, -1, 0},                             /* and downwards */
        {-1, INT32_MAX, 1},                             /* the factor of the rise, upwards */
        {INT32_MAX, INT32_MIN, -1},                     /* and downwards */
        {-((int32_t)1 << 30), (int32_t)1 << 30, 0},     /* its product with the rise, upwards */
        {(int32_t)1 << 30, -((int32_t)1 << 30) - 1, 0}, /* and downwards */
    };
    struct jp_slope_cost *cost = &copy.move_costs[JP_COST_PAPER][JP_MOVE_DIAGONAL];

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        cost->descend = (struct jp_polynomial){0, 0, 0};
        cost->climb = wrong[i];
        cost->bend = 0;
        cost->rise_max = 2;
        expect_bad("move_costs");
    }
}

static jp_cost straight_bound(const struct jp_lattice *of, int32_t dx, int32_t dy, int32_t rise)
{
    struct jp_straight straight;

    jp_lattice_straight(of, JP_COST_PHYSICAL, &straight);
    return jp_straight_bound(&straight, dx, dy, rise);
}

static void test_straight_bound_is_no_more_than_the_largest_cost(void)
{
    const struct jp_lattice *lattice = &jp_lattice_zhang2018;

    TEST_ASSERT_EQUAL_UINT32(0, straight_bound(lattice, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX - 1, straight_bound(lattice, 100000, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX - 1, straight_bound(lattice, 0, -100000, 0));
}

/* Where steep steps cost less than their rise is worth, a way up bounds nothing. */
static void test_straight_bound_where_steep_steps_are_cheap(void)
{
    copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS].climb.quadratic = -700000;
    TEST_ASSERT_EQUAL_UINT32(1, jp_move_cost(&copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], 54) > 0);
    TEST_ASSERT_EQUAL_UINT32(0, straight_bound(&copy, 10, 0, 0));
}

static jp_cost axis_cost(enum jp_cost_kind kind, int32_t rise)
{
    return jp_move_cost(&jp_lattice_zhang2018.move_costs[kind][JP_MOVE_AXIS], rise);
}

/* 902.21 N (0.0425930 · 0.2 m + rise) at 0.5 m/s: work / 0.78, twice (work · 0.34/4.5739)² · 0.74 for 0.4 s, 10 W. */
static void test_physical_cost_of_a_straight_step(void)
{
    /* 7.6856 J / 0.78 + 0.1932 J + 4 J */
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(14.0465 * JP_COST_PER_JOULE), axis_cost(JP_COST_PHYSICAL, 0));
    /* 16.4962 J / 0.78 + 0.8902 J + 4 J */
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(26.0392 * JP_COST_PER_JOULE), axis_cost(JP_COST_PHYSICAL, 10));
    /* 3.2803 J / 0.78 + 0.0352 J + 4 J */
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(8.2407 * JP_COST_PER_JOULE), axis_cost(JP_COST_PHYSICAL, -5));
}

static void test_descent_costs_the_electronics(void)
{
    TEST_ASSERT_EQUAL_UINT32(4 * JP_COST_PER_JOULE, axis_cost(JP_COST_PHYSICAL, -9));
    TEST_ASSERT_EQUAL_UINT32(4 * JP_COST_PER_JOULE, axis_cost(JP_COST_PHYSICAL, -54));
}

/* Eq. 14: 70.23 J/m, the motors' work without the electronics, and 0.69 · 902.21 N of rise. */
static void test_paper_cost_of_a_straight_step(void)
{
    /* 14.046 J + 9.8533 J + 0.1932 J */
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(24.0925 * JP_COST_PER_JOULE), axis_cost(JP_COST_PAPER, 0));
    /* 14.046 J + 21.1490 J + 0.8902 J + 6.0793 J */
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(42.1645 * JP_COST_PER_JOULE), axis_cost(JP_COST_PAPER, 10));
    TEST_ASSERT_EQUAL_UINT32(1, axis_cost(JP_COST_PAPER, -54));
}

/* 15 degrees over 0.2 m are 54.9 units of elevation. */
static void test_steeper_than_15_degrees_is_impassable(void)
{
    for (unsigned kind = 0; kind < JP_COST_KINDS; kind++) {
        TEST_ASSERT_TRUE(axis_cost((enum jp_cost_kind)kind, 54) < JP_COST_MAX);
        TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, axis_cost((enum jp_cost_kind)kind, 55));
        TEST_ASSERT_TRUE(axis_cost((enum jp_cost_kind)kind, -54) < JP_COST_MAX);
        TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, axis_cost((enum jp_cost_kind)kind, -55));
    }
}

static void test_climbing_costs_more(void)
{
    for (size_t l = 0; l < LATTICES; l++) {
        for (unsigned move = 0; move < JP_MOVE_KINDS; move++) {
            const struct jp_slope_cost *cost = &lattices[l]->move_costs[JP_COST_PHYSICAL][move];
            for (int32_t rise = 1; rise <= cost->rise_max; rise++) {
                TEST_ASSERT_TRUE(jp_move_cost(cost, rise) > jp_move_cost(cost, rise - 1));
            }
        }
    }
}

static jp_cost level_cost(const struct jp_lattice *lattice, enum jp_cost_kind kind,
                          const struct jp_primitive *primitive)
{
    jp_cost sum = primitive->base[kind];

    for (unsigned i = 0; i < primitive->move_count; i++) {
        const uint8_t direction = lattice->moves[primitive->first_move + i];
        sum += jp_move_cost(&lattice->move_costs[kind][jp_move_kind_of(direction)], 0);
    }
    return sum;
}

static void test_straight_primitives_cost_their_step(void)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_primitive *straight =
            &jp_lattice_zhang2018.primitives[jp_lattice_zhang2018.first_from[heading]];
        TEST_ASSERT_EQUAL_UINT32(1, straight->move_count);
        TEST_ASSERT_EQUAL_UINT32(heading, jp_lattice_zhang2018.moves[straight->first_move]);
        TEST_ASSERT_EQUAL_UINT32(heading, straight->end);
        TEST_ASSERT_EQUAL_UINT32(0, straight->base[JP_COST_PHYSICAL]);
        TEST_ASSERT_EQUAL_UINT32(0, straight->base[JP_COST_PAPER]);
    }
}

/* Within the unit that each step and the base are rounded by. */
static void test_distance_is_the_length(void)
{
    for (size_t l = 0; l < LATTICES; l++) {
        for (unsigned i = 0; i < count_of(lattices[l]); i++) {
            const struct jp_primitive *primitive = &lattices[l]->primitives[i];
            if (primitive->move_count > 0) {
                TEST_ASSERT_INT32_WITHIN(2 + primitive->move_count, primitive->length,
                                         (int32_t)level_cost(lattices[l], JP_COST_DISTANCE, primitive));
            }
        }
    }
}

/* Each move by the dearer of its cells, the base by the dearest of all, rounded down. */
static void test_costs_of_cells_multiply(void)
{
    static uint64_t own[40];
    const struct jp_terrain_config config = {
        .width = 8, .height = 8, .resolution = JP_Q16(0.2), .has_costs = true, .cost_shift = 4};
    const struct jp_lattice *lattice = &jp_lattice_gao2018;
    const struct jp_slope_cost *axis = &lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS];
    const uint32_t step = jp_move_cost(axis, 0);
    const uint8_t two_steps[] = {0, 0};
    struct jp_terrain costly;
    struct jp_lattice line = *lattice;
    const struct jp_primitive way = {.dx = 2, .base = {7, 0, 0}, .move_count = 2};
    const char *field = NULL;

    line.moves = two_steps;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_init(&costly, &config, own, sizeof own, &field));
    TEST_ASSERT_EQUAL_UINT32(2 * step + 7, jp_lattice_energy(&line, JP_COST_PHYSICAL, &costly, &way, 1, 1));
    (void)jp_terrain_set_cost(&costly, 3, 1, 5); /* the second step's end: times 21/16 */
    TEST_ASSERT_EQUAL_UINT32(step + step * 21 / 16 + 7 * 21 / 16,
                             jp_lattice_energy(&line, JP_COST_PHYSICAL, &costly, &way, 1, 1));
    (void)jp_terrain_set_cost(&costly, 1, 1, 255); /* the first one's start: times 271/16 */
    TEST_ASSERT_EQUAL_UINT32(step * 271 / 16 + step * 21 / 16 + 7 * 271 / 16,
                             jp_lattice_energy(&line, JP_COST_PHYSICAL, &costly, &way, 1, 1));
    (void)jp_terrain_set_cost(&costly, 4, 1, 255); /* not on it */
    TEST_ASSERT_EQUAL_UINT32(step * 271 / 16 + step * 21 / 16 + 7 * 271 / 16,
                             jp_lattice_energy(&line, JP_COST_PHYSICAL, &costly, &way, 1, 1));
}

/* ---- Grounds ---- */

enum { GRASS = 1, MUD = 3, GROUND_SIDE = 8 };

/* The copy is gao2018's, with wheels a cell aside. Grass takes twice as much, and thrice as much of turning; mud the
 * most there is. */
static void make_grounds(void)
{
    static const uint8_t two_steps[] = {0, 0};
    const struct jp_terrain_config config = {
        .width = GROUND_SIDE, .height = GROUND_SIDE, .resolution = JP_Q16(0.2), .has_classes = true};
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
    copy = jp_lattice_gao2018;
    copy.moves = two_steps;
    copy.sides[0] = (struct jp_cell_offset){0, 1};
    copy.ground[GRASS] = (struct jp_ground_price){JP_GROUND_ONE, 2U * JP_GROUND_ONE};
    copy.ground[MUD] = (struct jp_ground_price){JP_GROUND_SHARE_MAX, JP_GROUND_SHARE_MAX};
}

static void put_ground(int32_t x, int32_t y, uint8_t ground)
{
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_set_class(&terrain, x, y, ground));
}

/* From (1, 1) to (3, 1); `base` is what turning costs on top. */
static jp_cost cost_on_grounds(enum jp_cost_kind kind, uint16_t base)
{
    const struct jp_primitive way = {.dx = 2, .base = {base, base, base}, .move_count = 2};

    return jp_lattice_energy(&copy, kind, &terrain, &way, 1, 1);
}

/* Each move by the mean of both sides at both its ends, the base by the largest mean of all, rounded down. */
static void test_ground_under_the_wheels_charges_moves_and_turning(void)
{
    const uint32_t step = jp_move_cost(&jp_lattice_gao2018.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], 0);

    make_grounds();
    TEST_ASSERT_EQUAL_UINT32(2 * step + 10, cost_on_grounds(JP_COST_PHYSICAL, 10));
    put_ground(2, 1, MUD); /* between the wheels */
    TEST_ASSERT_EQUAL_UINT32(2 * step + 10, cost_on_grounds(JP_COST_PHYSICAL, 10));
    put_ground(3, 2, GRASS); /* left at the end */
    TEST_ASSERT_EQUAL_UINT32(step + (step + step / 4) + 20, cost_on_grounds(JP_COST_PHYSICAL, 10));
    put_ground(3, 0, GRASS); /* right, too */
    TEST_ASSERT_EQUAL_UINT32(step + (step + step / 2) + 30, cost_on_grounds(JP_COST_PHYSICAL, 10));
    put_ground(1, 0, GRASS); /* right at the begin */
    TEST_ASSERT_EQUAL_UINT32((step + step / 4) + (step + step / 2) + 30, cost_on_grounds(JP_COST_PHYSICAL, 10));
    put_ground(2, 2, GRASS); /* left in the middle, for both moves */
    TEST_ASSERT_EQUAL_UINT32((step + step / 2) + (step + 3 * step / 4) + 30, cost_on_grounds(JP_COST_PHYSICAL, 10));
}

static void test_ground_charges_no_other_kind_of_cost(void)
{
    make_grounds();
    for (unsigned kind = JP_COST_PAPER; kind < (unsigned)JP_COST_KINDS; kind++) {
        const jp_cost before = cost_on_grounds((enum jp_cost_kind)kind, 10);

        put_ground(1, 2, GRASS);
        put_ground(3, 0, MUD);
        TEST_ASSERT_EQUAL_UINT32(before, cost_on_grounds((enum jp_cost_kind)kind, 10));
        put_ground(1, 2, 0);
        put_ground(3, 0, 0);
    }
}

static void test_what_ground_takes_more_keeps_its_format(void)
{
    const uint32_t step = jp_move_cost(&jp_lattice_gao2018.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], 0);

    make_grounds();
    put_ground(1, 2, MUD);
    put_ground(1, 0, MUD);
    TEST_ASSERT_EQUAL_UINT32((step + 8 * step) + step + 17 * 3000, cost_on_grounds(JP_COST_PHYSICAL, 3000));
    TEST_ASSERT_EQUAL_UINT32((step + 8 * step) + step + UINT16_MAX, cost_on_grounds(JP_COST_PHYSICAL, 4000));
}

static void test_steep_steps_stay_impassable_on_cells_with_costs(void)
{
    static uint64_t own[40];
    const struct jp_terrain_config config = {
        .width = 8, .height = 8, .resolution = JP_Q16(0.2), .has_elevation = true, .has_costs = true, .cost_shift = 8};
    const struct jp_primitive *way = &jp_lattice_gao2018.primitives[0];
    struct jp_terrain costly;
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_init(&costly, &config, own, sizeof own, &field));
    (void)jp_terrain_set_elevation(&costly, 3, 1, 2000);
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_lattice_energy(&jp_lattice_gao2018, JP_COST_PHYSICAL, &costly, way, 2, 1));
    (void)jp_terrain_set_cost(&costly, 3, 1, 255);
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_lattice_energy(&jp_lattice_gao2018, JP_COST_PHYSICAL, &costly, way, 2, 1));
}

/* A turn in place is as long as the way of the robot's sides: half its width times the angle, rounded up. */
static void test_distance_of_turning_in_place(void)
{
    static const int64_t widths_mm[LATTICES] = {700, 350};

    for (size_t l = 0; l < LATTICES; l++) {
        const jp_angle *heading = lattices[l]->heading;
        unsigned turns = 0;
        for (unsigned i = 0; i < count_of(lattices[l]); i++) {
            const struct jp_primitive *primitive = &lattices[l]->primitives[i];
            if (primitive->move_count == 0) {
                const int32_t turn = (int32_t)(heading[primitive->end] - heading[primitive->start]);
                const int64_t way = (widths_mm[l] * (turn < 0 ? -(int64_t)turn : turn) * 355 / 113) >> 32;
                TEST_ASSERT_EQUAL_INT32((int32_t)way + 1, primitive->base[JP_COST_DISTANCE]);
                turns++;
            }
        }
        TEST_ASSERT_EQUAL_UINT(2 * JP_HEADINGS, turns);
    }
}

/* On a plane that rises east by 5 and north by 3 units a cell. */
static void test_energy_on_a_slope_adds_up(void)
{
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            TEST_ASSERT_EQUAL_INT32(JP_OK,
                                    jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(5 * x + 3 * y - 100)));
        }
    }
    const struct jp_lattice *lattice = &jp_lattice_zhang2018;
    for (unsigned i = 0; i < count_of(lattice); i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        jp_cost sum = primitive->base[JP_COST_PHYSICAL];
        for (unsigned m = 0; m < primitive->move_count; m++) {
            const uint8_t direction = lattice->moves[primitive->first_move + m];
            const int32_t rise = 5 * jp_move_offsets[direction].dx + 3 * jp_move_offsets[direction].dy;
            sum += jp_move_cost(&lattice->move_costs[JP_COST_PHYSICAL][jp_move_kind_of(direction)], rise);
        }
        TEST_ASSERT_EQUAL_UINT32(sum,
                                 jp_lattice_energy(lattice, JP_COST_PHYSICAL, &terrain, primitive, CENTRE, CENTRE));
        TEST_ASSERT_EQUAL_UINT32(sum, jp_lattice_cost(lattice, JP_COST_PHYSICAL, &terrain, primitive, CENTRE, CENTRE));
    }
}

static bool covers(const struct jp_lattice *lattice, unsigned first_span, unsigned span_count, int x, int y)
{
    for (unsigned i = 0; i < span_count; i++) {
        const struct jp_span span = lattice->spans[first_span + i];
        if (span.y == y && span.first <= x && x <= span.last) {
            return true;
        }
    }
    return false;
}

static bool sweeps(const struct jp_lattice *lattice, const struct jp_primitive *primitive, int x, int y)
{
    return covers(lattice, primitive->first_span, primitive->span_count, x, y);
}

static bool holds(const struct jp_lattice *lattice, struct jp_cells cells, int x, int y)
{
    return covers(lattice, cells.first_span, cells.span_count, x, y);
}

/* Every primitive that sweeps the one blocked cell is impassable, and no other. */
static void expect_blocked_by(const struct jp_lattice *lattice, int x, int y)
{
    for (unsigned i = 0; i < count_of(lattice); i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        const jp_cost cost = jp_lattice_cost(lattice, JP_COST_PHYSICAL, &terrain, primitive, CENTRE, CENTRE);
        TEST_ASSERT_EQUAL(sweeps(lattice, primitive, x, y), cost == JP_COST_MAX);
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        TEST_ASSERT_EQUAL(!holds(lattice, lattice->footprint[heading], x, y),
                          jp_lattice_can_stand(lattice, &terrain, CENTRE, CENTRE, heading));
    }
    TEST_ASSERT_EQUAL(!holds(lattice, lattice->core, x, y), jp_lattice_is_open(lattice, &terrain, CENTRE, CENTRE));
}

static void test_a_blocked_cell_blocks_what_sweeps_it(void)
{
    for (size_t l = 0; l < LATTICES; l++) {
        for (int y = 0; y < SIDE; y++) {
            for (int x = 0; x < SIDE; x++) {
                TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
                expect_blocked_by(lattices[l], x - CENTRE, y - CENTRE);
                TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_FREE));
            }
        }
    }
}

static void test_the_edge_of_the_map_blocks(void)
{
    const struct jp_lattice *lattice = &jp_lattice_zhang2018;
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX,
                             jp_lattice_cost(lattice, JP_COST_PHYSICAL, &terrain, &lattice->primitives[0], 0, CENTRE));
    TEST_ASSERT_FALSE(jp_lattice_can_stand(lattice, &terrain, SIDE - 1, CENTRE, 0));
    TEST_ASSERT_FALSE(jp_lattice_is_open(lattice, &terrain, 0, 0));
}

static void expect_subset(const struct jp_lattice *lattice, struct jp_cells cells, const struct jp_primitive *of,
                          int dx, int dy)
{
    for (unsigned i = 0; i < cells.span_count; i++) {
        const struct jp_span span = lattice->spans[cells.first_span + i];
        for (int x = span.first; x <= span.last; x++) {
            TEST_ASSERT_TRUE(sweeps(lattice, of, x + dx, span.y + dy));
        }
    }
}

static void test_core_and_footprints_are_swept(void)
{
    for (size_t l = 0; l < LATTICES; l++) {
        const struct jp_lattice *lattice = lattices[l];
        TEST_ASSERT_TRUE(holds(lattice, lattice->core, 0, 0));
        for (unsigned i = 0; i < count_of(lattice); i++) {
            const struct jp_primitive *primitive = &lattice->primitives[i];
            int x = 0;
            int y = 0;
            expect_subset(lattice, lattice->core, primitive, x, y);
            for (unsigned m = 0; m < primitive->move_count; m++) {
                const uint8_t direction = lattice->moves[primitive->first_move + m];
                x += jp_move_offsets[direction].dx;
                y += jp_move_offsets[direction].dy;
                expect_subset(lattice, lattice->core, primitive, x, y);
            }
            expect_subset(lattice, lattice->footprint[primitive->start], primitive, 0, 0);
            expect_subset(lattice, lattice->footprint[primitive->end], primitive, primitive->dx, primitive->dy);
        }
    }
}

static void test_reach_is_what_the_primitives_sweep(void)
{
    for (size_t l = 0; l < LATTICES; l++) {
        const struct jp_lattice *lattice = lattices[l];
        for (int cell = 0; cell < SIDE * SIDE; cell++) {
            const int x = cell % SIDE - CENTRE;
            const int y = cell / SIDE - CENTRE;
            for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
                bool swept = false;
                for (unsigned i = lattice->first_from[heading]; i < lattice->first_from[heading + 1]; i++) {
                    swept = swept || sweeps(lattice, &lattice->primitives[i], x, y);
                }
                TEST_ASSERT_EQUAL(swept, holds(lattice, lattice->reach[heading], x, y));
            }
        }
    }
}

/* A symmetry of the map. */
struct symmetry {
    int xx, xy, yx, yy; /* of cells */
    int factor, addend; /* of headings and directions */
};

static unsigned image_of(const struct symmetry *symmetry, unsigned heading)
{
    return (unsigned)(symmetry->factor * (int)heading + symmetry->addend + 2 * JP_HEADINGS) % JP_HEADINGS;
}

static const struct jp_primitive *find(const struct jp_lattice *lattice, unsigned start, unsigned end, int dx, int dy)
{
    for (unsigned i = lattice->first_from[start]; i < lattice->first_from[start + 1]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];
        if (primitive->end == end && primitive->dx == dx && primitive->dy == dy) {
            return primitive;
        }
    }
    return NULL;
}

static void expect_images(const struct jp_lattice *lattice, const struct symmetry *s,
                          const struct jp_primitive *primitive, const struct jp_primitive *image)
{
    TEST_ASSERT_EQUAL_UINT32(primitive->length, image->length);
    TEST_ASSERT_EQUAL_UINT32(primitive->duration, image->duration);
    TEST_ASSERT_EQUAL_UINT32(primitive->move_count, image->move_count);
    for (unsigned kind = 0; kind < JP_COST_KINDS; kind++) {
        TEST_ASSERT_EQUAL_UINT32(primitive->base[kind], image->base[kind]);
    }
    for (unsigned m = 0; m < primitive->move_count; m++) {
        TEST_ASSERT_EQUAL_UINT32(image_of(s, lattice->moves[primitive->first_move + m]),
                                 lattice->moves[image->first_move + m]);
    }
    for (unsigned i = 0; i < primitive->span_count; i++) {
        const struct jp_span span = lattice->spans[primitive->first_span + i];
        for (int x = span.first; x <= span.last; x++) {
            TEST_ASSERT_TRUE(sweeps(lattice, image, s->xx * x + s->xy * span.y, s->yx * x + s->yy * span.y));
        }
    }
}

static void expect_symmetric(const struct symmetry *s)
{
    for (size_t l = 0; l < LATTICES; l++) {
        for (unsigned i = 0; i < count_of(lattices[l]); i++) {
            const struct jp_primitive *primitive = &lattices[l]->primitives[i];
            const struct jp_primitive *image =
                find(lattices[l], image_of(s, primitive->start), image_of(s, primitive->end),
                     s->xx * primitive->dx + s->xy * primitive->dy, s->yx * primitive->dx + s->yy * primitive->dy);
            TEST_ASSERT_NOT_NULL(image);
            expect_images(lattices[l], s, primitive, image);
        }
    }
}

static void test_quarter_turns_change_nothing(void)
{
    expect_symmetric(&(struct symmetry){0, -1, 1, 0, 1, 4});
}

static void test_reflections_change_nothing(void)
{
    expect_symmetric(&(struct symmetry){1, 0, 0, -1, -1, 0});
    expect_symmetric(&(struct symmetry){0, 1, 1, 0, -1, 4});
}

static void test_headings_are_those_of_the_unit_steps(void)
{
    for (size_t l = 0; l < LATTICES; l++) {
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const jp_angle exact = jp_atan2(jp_move_offsets[heading].dy, jp_move_offsets[heading].dx);
            TEST_ASSERT_INT32_WITHIN(JP_ATAN2_ERROR + 1, 0, (int32_t)(lattices[l]->heading[heading] - exact));
        }
    }
}

/* Where the parts of a factor take each other away it fits, though each alone is near the end of the format. */
static void test_parts_of_a_move_cost_that_cancel(void)
{
    struct jp_slope_cost cost = copy.move_costs[JP_COST_PAPER][JP_MOVE_DIAGONAL];

    cost.rise_max = 1;
    cost.bend = 0;
    cost.descend = (struct jp_polynomial){65536, 0, 0};
    cost.climb = (struct jp_polynomial){65536, -2000000000, 2000000000};
    TEST_ASSERT_TRUE(jp_slope_cost_is_valid(&cost));
    cost.climb.linear = 2000000000;
    TEST_ASSERT_FALSE(jp_slope_cost_is_valid(&cost));
}

/* Along an axis that is the cheapest way the bound of level ground is what driving costs. */
static void test_straight_bound_along_an_axis_is_tight(void)
{
    struct jp_lattice even = jp_lattice_zhang2018;
    struct jp_slope_cost *costs = even.move_costs[JP_COST_PHYSICAL];

    for (int move = 0; move < JP_MOVE_KINDS; move++) {
        costs[move].climb = (struct jp_polynomial){(move == JP_MOVE_AXIS ? 1000 : 3000) * 65536, 0, 0};
        costs[move].descend = costs[move].climb;
    }
    TEST_ASSERT_UINT32_WITHIN(1, 1000 * 1000, straight_bound(&even, 1000, 0, 0));
    TEST_ASSERT_UINT32_WITHIN(1, 1000 * 1000, straight_bound(&even, 0, -1000, 0));
    costs[JP_MOVE_DIAGONAL].climb.constant = 1400 * 65536; /* cheaper by length than along an axis */
    costs[JP_MOVE_DIAGONAL].descend.constant = 1400 * 65536;
    const jp_cost diagonal = straight_bound(&even, 1000, 1000, 0);
    TEST_ASSERT_TRUE(diagonal <= 1400 * 1000 && diagonal >= 1400 * 1000 - 30);
}

/* Wheels on either side count alike, whichever way the robot looks. */
static void test_wheels_of_both_sides_count_alike(void)
{
    make_grounds();
    for (uint8_t heading = 0; heading < JP_HEADINGS; heading++) {
        const struct jp_primitive turn = {.start = heading, .end = heading, .base = {400, 400, 400}};
        jp_cost costs[2];
        copy.sides[heading] = (struct jp_cell_offset){(int8_t)(1 + heading % 2), (int8_t)(heading % 3 - 1)};
        for (int side = 0; side < 2; side++) {
            const int sign = side == 0 ? 1 : -1;
            const int32_t x = 4 + sign * copy.sides[heading].dx;
            const int32_t y = 4 + sign * copy.sides[heading].dy;
            put_ground(x, y, GRASS);
            costs[side] = jp_lattice_energy(&copy, JP_COST_PHYSICAL, &terrain, &turn, 4, 4);
            put_ground(x, y, 0);
        }
        TEST_ASSERT_EQUAL_UINT32(2 * 400, costs[0]); /* a mean of once and thrice */
        TEST_ASSERT_EQUAL_UINT32(costs[0], costs[1]);
        TEST_ASSERT_EQUAL_UINT32(400, jp_lattice_energy(&copy, JP_COST_PHYSICAL, &terrain, &turn, 4, 4));
    }
}

/* Each kind of move of each kind of cost is looked at, and its limits are within. */
static void test_check_of_every_move_cost(void)
{
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        for (int move = 0; move < JP_MOVE_KINDS; move++) {
            copy.move_costs[kind][move].floor = 0;
            expect_bad("move_costs");
        }
    }
    struct jp_slope_cost cost = {.climb = {65536, 0, 0}, .descend = {65536, 0, 0}, .rise_max = 4096, .floor = 1};
    TEST_ASSERT_TRUE(jp_slope_cost_is_valid(&cost));
    cost.rise_max = 1;
    TEST_ASSERT_TRUE(jp_slope_cost_is_valid(&cost));
}

/* Along the other axis as along the first: the cells of the moves are those that the robot drives over. */
static void test_costs_of_cells_along_both_axes(void)
{
    static const uint8_t steps[][2] = {{0, 0}, {4, 4}};

    make_grounds();
    copy.sides[0] = (struct jp_cell_offset){0, 0};
    copy.sides[4] = copy.sides[0];
    for (int axis = 0; axis < 2; axis++) {
        const struct jp_primitive way = {.start = (uint8_t)(4 * axis), .base = {8, 8, 8}, .move_count = 2};
        copy.moves = steps[axis];
        const uint32_t step = jp_move_cost(&copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], 0);
        for (int32_t i = 0; i < 4; i++) {
            const int32_t x = axis == 0 ? 2 + i : 2;
            const int32_t y = axis == 0 ? 2 : 2 + i;
            put_ground(x, y, GRASS);
            const uint32_t more = i == 0 || i == 2 ? step / 2 : (i == 1 ? step / 2 + step / 2 : 0);
            const jp_cost cost = jp_lattice_energy(&copy, JP_COST_PHYSICAL, &terrain, &way, 2, 2);
            TEST_ASSERT_UINT32_WITHIN(2, 2 * step + more + (i < 3 ? 3 * 8 : 8), cost);
            put_ground(x, y, 0);
        }
    }
}

/* Every primitive is looked at, the first and the last: each sweeps its end, which is not among its first cells. */
static void test_check_of_the_ends_of_every_primitive(void)
{
    unsigned cut = 0;

    for (unsigned i = 0; i < count_of(&copy); i += 11) {
        if (copy.primitives[i].dy > 0 && copy.primitives[i].span_count > 1) {
            primitives[i].span_count = 1;
            expect_bad("spans");
            cut++;
        }
    }
    TEST_ASSERT_TRUE(cut > 3);
}

/* Costs of 0 charge nothing, however the ground rises. */
static void test_cells_without_a_cost_leave_energies(void)
{
    enum { SMALL = 20 };
    static jp_cost plain[PRIMITIVES_MAX];
    const struct jp_lattice *lattice = &jp_lattice_zhang2018;

    for (unsigned pass = 0; pass < 2; pass++) {
        const struct jp_terrain_config config = {.width = SMALL,
                                                 .height = SMALL,
                                                 .resolution = JP_Q16(0.2),
                                                 .has_elevation = true,
                                                 .has_costs = pass == 1,
                                                 .unknown_is_free = true};
        const char *field = NULL;

        TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
        for (int32_t i = 0; i < SMALL * SMALL; i++) {
            TEST_ASSERT_EQUAL_INT32(
                JP_OK, jp_terrain_set_elevation(&terrain, i % SMALL, i / SMALL, (jp_elevation)(300 + i * 37 % 11)));
        }
        for (unsigned i = 0; i < count_of(lattice); i++) {
            const jp_cost cost =
                jp_lattice_energy(lattice, JP_COST_PHYSICAL, &terrain, &lattice->primitives[i], SMALL / 2, SMALL / 2);

            TEST_ASSERT_TRUE(cost < JP_COST_MAX);
            TEST_ASSERT_TRUE(pass == 0 || cost == plain[i]);
            plain[i] = cost;
        }
    }
}

/* It takes their lengths in cells rounded up, so that none is bounded by more than it costs, nor by much less. */
static void test_straight_bound_of_each_unit_step(void)
{
    for (unsigned kind = 0; kind < (unsigned)JP_MOVE_KINDS; kind++) {
        const int64_t square = kind == (unsigned)JP_MOVE_AXIS ? 1 : kind == (unsigned)JP_MOVE_KNIGHT ? 5 : 2;
        struct jp_straight straight;

        for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
            const struct jp_polynomial level = {(move == kind ? 1000 : 30000) * JP_Q16_ONE, 0, 0};

            copy.move_costs[JP_COST_PHYSICAL][move] =
                (struct jp_slope_cost){.climb = level, .descend = level, .rise_max = 10, .floor = 1};
        }
        jp_lattice_straight(&copy, JP_COST_PHYSICAL, &straight);
        /* per_cell · length in Q16 is what the step costs, with a length that is at most 1 too long. */
        const int64_t length = (INT64_C(1000) << 32) / straight.per_cell;

        TEST_ASSERT_TRUE((length + 1) * (length + 1) >= square << 32);
        TEST_ASSERT_TRUE((length - 1) * (length - 1) < square << 32);
    }
}

/* The reach of each heading holds what its primitives sweep. */
static void test_check_of_the_reach_of_every_heading(void)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        copy.reach[heading].span_count = 0;
        expect_bad("spans");
        reset_copy();
    }
}

/* Grounds that the map does not tell apart charge nothing, whatever their prices are, not even the dearest step. */
static void test_grounds_that_are_not_on_the_map_charge_nothing(void)
{
    const struct jp_terrain_config config = {
        .width = GROUND_SIDE, .height = GROUND_SIDE, .resolution = JP_Q16(0.2), .has_costs = true};
    const char *field = NULL;

    make_grounds();
    copy.ground[0] = copy.ground[MUD];
    copy.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS].floor = UINT16_MAX;
    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_UINT32(2U * UINT16_MAX + 60000U, cost_on_grounds(JP_COST_PHYSICAL, 60000));
}

/* Nor of a cost of another kind. */
static void test_grounds_charge_no_other_kind_of_the_dearest_step(void)
{
    make_grounds();
    copy.ground[0] = copy.ground[MUD];
    for (unsigned kind = JP_COST_PAPER; kind < (unsigned)JP_COST_KINDS; kind++) {
        copy.move_costs[kind][JP_MOVE_AXIS].floor = UINT16_MAX;
        TEST_ASSERT_EQUAL_UINT32(2U * UINT16_MAX + 60000U, cost_on_grounds((enum jp_cost_kind)kind, 60000));
    }
}

/* ---- Spans ---- */

enum { FARTHEST = 16, ROWS = 2 * FARTHEST + 1 };

static struct jp_span own_spans[2 * PRIMITIVES_MAX + ROWS + 1];

/* A robot of a cell: each primitive sweeps its first cell and its last, and a heading's reach is all that is near. */
static void make_small_copy(void)
{
    const unsigned count = count_of(&copy);
    const struct jp_cells reach = {(uint16_t)(2U * count), ROWS};

    for (unsigned i = 0; i < count; i++) {
        primitives[i].first_span = (uint16_t)(2U * i);
        primitives[i].span_count = 2;
        own_spans[2U * i] = (struct jp_span){0, 0, 0};
        own_spans[2U * i + 1U] = (struct jp_span){primitives[i].dy, primitives[i].dx, primitives[i].dx};
    }
    for (int row = 0; row < ROWS; row++) {
        own_spans[2U * count + (unsigned)row] = (struct jp_span){(int8_t)(row - FARTHEST), -FARTHEST, FARTHEST};
    }
    own_spans[2U * count + ROWS] = (struct jp_span){0, 0, 0};
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        copy.reach[heading] = reach;
        copy.sides[heading] = (struct jp_cell_offset){0, 0};
    }
    copy.core = (struct jp_cells){(uint16_t)(2U * count + ROWS), 1};
    copy.spans = own_spans;
}

static void expect_sound(void)
{
    const char *field = "none";

    TEST_ASSERT_EQUAL_INT32(JP_OK, jp_lattice_check(&copy, &field));
}

static void expect_bad_span(unsigned index, struct jp_span span)
{
    make_small_copy();
    own_spans[index] = span;
    expect_bad("spans");
}

/* Whichever of them it is of whichever primitive: it lies within the reach, and both ends are swept. */
static void test_check_of_every_span(void)
{
    make_small_copy();
    expect_sound();
    for (unsigned i = 0; i < 2U * count_of(&copy); i++) {
        const struct jp_span kept = own_spans[i];
        const bool is_in_place = primitives[i / 2U].move_count == 0U;

        expect_bad_span(i, (struct jp_span){kept.y, -FARTHEST - 1, kept.last});
        expect_bad_span(i, (struct jp_span){kept.y, kept.first, FARTHEST + 1});
        if (!is_in_place) { /* else the other one holds both ends */
            expect_bad_span(i, (struct jp_span){kept.y, (int8_t)(kept.first + 1), FARTHEST});
            expect_bad_span(i, (struct jp_span){kept.y, -FARTHEST, (int8_t)(kept.last - 1)});
            expect_bad_span(i, (struct jp_span){(int8_t)(kept.y + 1), kept.first, kept.last});
        }
        make_small_copy();
    }
    for (unsigned row = 0; row < ROWS; row++) {
        expect_bad_span(2U * count_of(&copy) + row, (struct jp_span){0, FARTHEST, FARTHEST - 1}); /* none */
    }
    make_small_copy();
    copy.core.span_count = 0;
    expect_bad("spans");
}

/* The largest shares there are pass. */
static void test_check_of_the_largest_prices_of_grounds(void)
{
    for (unsigned i = 0; i < JP_GROUND_CLASSES; i++) {
        copy.ground[i] = (struct jp_ground_price){JP_GROUND_SHARE_MAX, JP_GROUND_SHARE_MAX};
        expect_sound();
        copy.ground[i].straight++;
        expect_bad("ground");
        copy.ground[i].turning = JP_GROUND_SHARE_MAX + 1U;
        expect_bad("ground");
    }
}

/* The finest resolution there is passes. */
static void test_check_of_the_finest_resolution(void)
{
    copy.resolution = 1;
    expect_sound();
    copy.resolution = INT32_MAX;
    expect_sound();
    copy.resolution = 0;
    expect_bad("resolution");
    copy.resolution = -1;
    expect_bad("resolution");
}
