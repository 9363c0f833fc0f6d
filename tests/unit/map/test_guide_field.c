/* The guide field on a small map: what it says of ways that are known by hand. */
#include <joulepath/guide_field.h>
#include <joulepath/tables.h>
#include <string.h>

#include "tests/support/level_map.h"
#include "tests/target/random.h"
#include "unity.h"

enum {
    SIDE = 16,
    AXIS_COST = 224, /* of a level step along an axis, physical */
    BLOCK_BYTES = 1024
};

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static const struct jp_terrain_config map = {
    .width = SIDE, .height = SIDE, .resolution = JP_Q16(0.2), .has_elevation = true};
static const struct jp_guide_root west = {4, 8, 1}; /* facing east */

static struct jp_turns turns;
static struct jp_guide_field guide;
static uint64_t block[BLOCK_BYTES / 8];

static void init(unsigned scale)
{
    TEST_ASSERT_TRUE(jp_guide_field_size(&map, scale) <= sizeof block);
    jp_guide_field_init(&guide, lattice, JP_COST_PHYSICAL, &terrain, &turns, scale, block);
}

void setUp(void)
{
    make_level_map(&map);
    jp_lattice_turns(lattice, JP_COST_PHYSICAL, &turns);
    memset(block, 0x5A, sizeof block);
    init(1);
}

void tearDown(void)
{
}

static void grow(enum jp_guide_direction direction, const struct jp_guide_root *root)
{
    unsigned looks = UINT32_MAX;

    jp_guide_field_start(&guide, direction, root, 12, 12);
    TEST_ASSERT_TRUE(jp_guide_field_grow(&guide, &looks));
}

static jp_cost estimate(int32_t x, int32_t y, unsigned heading)
{
    return jp_guide_field_estimate(&guide, x, y, heading);
}

static void slope_to_the_east(int rise)
{
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_terrain_set_elevation(&terrain, i % SIDE, i / SIDE, (jp_elevation)(rise * (i % SIDE))));
    }
}

static void test_size(void)
{
    size_t last = SIZE_MAX;

    for (unsigned scale = 1; scale <= JP_GUIDE_SCALE_MAX; scale++) {
        const size_t side = (SIDE + scale - 1) / scale;
        const size_t size = jp_guide_field_size(&map, scale);
        TEST_ASSERT_EQUAL_UINT32(0, size % 8);
        TEST_ASSERT_TRUE(size * 2 >= 5 * side * side);
        TEST_ASSERT_TRUE(size <= last);
        last = size;
    }
    TEST_ASSERT_TRUE(jp_guide_field_size(&map, 1) <= 5 * SIDE * SIDE / 2 + 4 * SIDE + 8);
}

static void test_stays_in_its_block(void)
{
    const uint8_t *bytes = (const uint8_t *)block;

    for (unsigned scale = 1; scale <= JP_GUIDE_SCALE_MAX; scale++) {
        memset(block, 0x5A, sizeof block);
        init(scale);
        grow(JP_GUIDE_FROM_ROOT, &west);
        for (size_t i = jp_guide_field_size(&map, scale); i < sizeof block; i++) {
            TEST_ASSERT_EQUAL_UINT8(0x5A, bytes[i]);
        }
    }
}

static void test_straight_ahead_costs_its_steps(void)
{
    grow(JP_GUIDE_FROM_ROOT, &west);
    for (int32_t x = 4; x <= 12; x++) {
        TEST_ASSERT_EQUAL_UINT32((x - 4) * AXIS_COST, estimate(x, 8, 0));
    }
}

static void test_straight_to_the_root(void)
{
    const struct jp_guide_root east = {12, 8, 1};

    grow(JP_GUIDE_TO_ROOT, &east);
    for (int32_t x = 4; x <= 12; x++) {
        TEST_ASSERT_EQUAL_UINT32((12 - x) * AXIS_COST, estimate(x, 8, 0));
    }
}

/* At the root, and at the end of a straight way. */
static void test_turning_is_charged(void)
{
    grow(JP_GUIDE_FROM_ROOT, &west);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        TEST_ASSERT_EQUAL_UINT32(turns.cost[0][heading], estimate(4, 8, heading));
        TEST_ASSERT_EQUAL_UINT32(5 * AXIS_COST + turns.cost[0][heading], estimate(9, 8, heading));
    }
    grow(JP_GUIDE_TO_ROOT, &west);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        TEST_ASSERT_EQUAL_UINT32(turns.cost[heading][0], estimate(4, 8, heading));
    }
    TEST_ASSERT_TRUE(estimate(4, 8, 8) > estimate(4, 8, 1));
}

/* Behind the robot: it turns by half a circle first. What is beyond the horizon is taken for as far as that. */
static void test_way_back(void)
{
    const struct jp_guide_root east = {10, 8, 1};
    const jp_cost way_back = turns.cost[0][8] + 5 * AXIS_COST;
    unsigned looks = UINT32_MAX;

    jp_guide_field_start(&guide, JP_GUIDE_FROM_ROOT, &east, 5, 8);
    TEST_ASSERT_TRUE(jp_guide_field_grow(&guide, &looks));
    TEST_ASSERT_EQUAL_UINT32(way_back, estimate(5, 8, 8));
    TEST_ASSERT_TRUE(estimate(5, 8, 0) > estimate(5, 8, 8));
    grow(JP_GUIDE_FROM_ROOT, &east);
    TEST_ASSERT_TRUE(estimate(5, 8, 8) < way_back);
    TEST_ASSERT_EQUAL_UINT32(estimate(5, 8, 8), estimate(4, 8, 3));
}

static void test_root_of_several_headings(void)
{
    const struct jp_guide_root several = {4, 8, 1U << 0 | 1U << 5};

    grow(JP_GUIDE_TO_ROOT, &several);
    TEST_ASSERT_EQUAL_UINT32(0, estimate(4, 8, 0));
    TEST_ASSERT_EQUAL_UINT32(0, estimate(4, 8, 5));
    TEST_ASSERT_EQUAL_UINT32(turns.cost[6][5], estimate(4, 8, 6));
    grow(JP_GUIDE_TO_ROOT, &(const struct jp_guide_root){4, 8, 0xFFFF});
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        TEST_ASSERT_EQUAL_UINT32(0, estimate(4, 8, heading));
    }
}

/* From the root uphill is dear; to the root it is the other way round. */
static void test_slopes_have_a_direction(void)
{
    const struct jp_slope_cost *axis = &lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS];

    slope_to_the_east(10);
    grow(JP_GUIDE_FROM_ROOT, &west);
    TEST_ASSERT_EQUAL_UINT32(5 * jp_move_cost(axis, 10), estimate(9, 8, 0));
    grow(JP_GUIDE_TO_ROOT, &(const struct jp_guide_root){4, 8, 1U << 8});
    TEST_ASSERT_EQUAL_UINT32(5 * jp_move_cost(axis, -10), estimate(9, 8, 8));
}

static void test_too_steep_is_no_way(void)
{
    slope_to_the_east(200);
    grow(JP_GUIDE_FROM_ROOT, &west);
    TEST_ASSERT_FALSE(jp_guide_field_reaches(&guide, 9, 8));
    TEST_ASSERT_TRUE(jp_guide_field_reaches(&guide, 4, 11));
}

static void test_wall_is_no_way(void)
{
    put_column(8, 0, SIDE - 1, JP_CELL_OCCUPIED);
    for (unsigned scale = 1; scale <= 4; scale++) {
        init(scale);
        grow(JP_GUIDE_FROM_ROOT, &west);
        TEST_ASSERT_TRUE(jp_guide_field_reaches(&guide, 4, 8));
        TEST_ASSERT_FALSE(jp_guide_field_reaches(&guide, 12, 12));
        TEST_ASSERT_EQUAL_UINT32(estimate(12, 12, 0), estimate(12, 4, 7));
        TEST_ASSERT_TRUE(estimate(12, 12, 0) > estimate(4, 10, 3));
    }
}

static void test_way_round_an_obstacle_costs_more(void)
{
    grow(JP_GUIDE_FROM_ROOT, &west);
    const jp_cost free_way = estimate(12, 8, 0);
    put_column(8, 0, 9, JP_CELL_OCCUPIED);
    const jp_cost old_estimate = estimate(12, 8, 0);
    TEST_ASSERT_EQUAL_UINT32(free_way, old_estimate); /* it is not repaired */
    grow(JP_GUIDE_FROM_ROOT, &west);
    TEST_ASSERT_TRUE(jp_guide_field_reaches(&guide, 12, 8));
    TEST_ASSERT_TRUE(estimate(12, 8, 0) > free_way);
}

/* Level and open, a coarse guide says about what a fine one does. */
static void test_scales_agree(void)
{
    for (unsigned scale = 1; scale <= 4; scale++) {
        init(scale);
        grow(JP_GUIDE_FROM_ROOT, &west);
        const int32_t steps = 12 / (int32_t)scale - 4 / (int32_t)scale;
        TEST_ASSERT_EQUAL_UINT32((uint32_t)steps * scale * AXIS_COST, estimate(12, 8, 0));
    }
}

static void test_slices_change_nothing(void)
{
    static jp_cost whole[SIDE][SIDE];

    put_column(8, 0, 9, JP_CELL_OCCUPIED);
    grow(JP_GUIDE_FROM_ROOT, &west);
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        whole[i / SIDE][i % SIDE] = estimate(i % SIDE, i / SIDE, 3);
    }
    for (unsigned slice = 1; slice < 200; slice *= 5) {
        unsigned looks = 0;
        jp_guide_field_start(&guide, JP_GUIDE_FROM_ROOT, &west, 12, 12);
        TEST_ASSERT_FALSE(jp_guide_field_grow(&guide, &looks));
        do {
            TEST_ASSERT_EQUAL_UINT32(0, looks);
            looks = slice;
        } while (!jp_guide_field_grow(&guide, &looks));
        for (int32_t i = 0; i < SIDE * SIDE; i++) {
            TEST_ASSERT_EQUAL_UINT32(whole[i / SIDE][i % SIDE], estimate(i % SIDE, i / SIDE, 3));
        }
    }
}

/* A map whose sides are no multiple of the scale; a root and a target at its far edges. */
static void test_odd_sides(void)
{
    const struct jp_terrain_config odd = {.width = 13, .height = 11, .resolution = JP_Q16(0.2), .has_elevation = true};
    unsigned looks = UINT32_MAX;

    make_level_map(&odd);
    for (unsigned scale = 1; scale <= JP_GUIDE_SCALE_MAX; scale++) {
        init(scale);
        jp_guide_field_start(&guide, JP_GUIDE_FROM_ROOT, &(const struct jp_guide_root){12, 10, 1}, 0, 0);
        TEST_ASSERT_TRUE(jp_guide_field_grow(&guide, &looks));
        TEST_ASSERT_TRUE(jp_guide_field_reaches(&guide, 12, 10));
        TEST_ASSERT_EQUAL_UINT32(0, estimate(12, 10, 0));
        looks = UINT32_MAX;
    }
}

/* ---- With a loan ---- */

static uint32_t random_state = 7;

static void block_some(uint32_t share)
{
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        const bool is_free = target_random(&random_state) % share != 0U;

        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_terrain_set_cell(&terrain, i % SIDE, i / SIDE, is_free ? JP_CELL_FREE : JP_CELL_OCCUPIED));
    }
}

static void grow_with(void *loan, enum jp_guide_direction direction, unsigned slice)
{
    unsigned units = slice;

    jp_guide_field_start(&guide, direction, &west, 12, 12);
    if (loan != NULL) {
        jp_guide_field_lend(&guide, loan);
    }
    while (!jp_guide_field_grow(&guide, &units)) {
        units = slice;
    }
}

static void test_a_loan_changes_nothing_but_the_time(void)
{
    static jp_cost without[SIDE * SIDE];
    static uint32_t loan[SIDE + 1];

    TEST_ASSERT_EQUAL_UINT32(SIDE * sizeof *loan, jp_guide_field_loan(&map));
    loan[SIDE] = 0x5A5A5A5AU;
    for (unsigned i = 0; i < 24; i++) {
        const enum jp_guide_direction direction = i % 2U == 0U ? JP_GUIDE_FROM_ROOT : JP_GUIDE_TO_ROOT;

        init(1U + i % JP_GUIDE_SCALE_MAX);
        block_some(8U + 4U * i);
        grow_with(NULL, direction, 100);
        for (int32_t cell = 0; cell < SIDE * SIDE; cell++) {
            without[cell] = estimate(cell % SIDE, cell / SIDE, i % JP_HEADINGS);
        }
        grow_with(loan, direction, 1U + i);
        for (int32_t cell = 0; cell < SIDE * SIDE; cell++) {
            TEST_ASSERT_EQUAL_UINT32(without[cell], estimate(cell % SIDE, cell / SIDE, i % JP_HEADINGS));
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0x5A5A5A5AU, loan[SIDE]);
}

/* The rows of the loan are looked at anew whenever the guide begins: the map may have changed. */
static void test_a_loan_shows_the_map_as_it_is(void)
{
    static uint32_t loan[SIDE];

    grow_with(loan, JP_GUIDE_FROM_ROOT, 100);
    const jp_cost before = estimate(12, 8, 0);
    for (int32_t y = 0; y < SIDE; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 8, y, JP_CELL_OCCUPIED));
    }
    grow_with(loan, JP_GUIDE_FROM_ROOT, 100);
    TEST_ASSERT_TRUE(estimate(12, 8, 0) > before);
    TEST_ASSERT_FALSE(jp_guide_field_reaches(&guide, 12, 8));
}

/* Straight steps cost what the lattice says of each kind of cost. */
static void test_each_kind_of_cost(void)
{
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        const jp_cost step = jp_move_cost(&lattice->move_costs[kind][JP_MOVE_AXIS], 0);
        jp_lattice_turns(lattice, (enum jp_cost_kind)kind, &turns);
        jp_guide_field_init(&guide, lattice, (enum jp_cost_kind)kind, &terrain, &turns, 1, block);
        grow(JP_GUIDE_FROM_ROOT, &west);
        TEST_ASSERT_UINT32_WITHIN(8 << guide.shift, 8 * step, estimate(12, 8, 0));
    }
}

static uint32_t units_in_slices(unsigned slice)
{
    uint32_t units = slice;
    unsigned left = slice;

    jp_guide_field_start(&guide, JP_GUIDE_FROM_ROOT, &west, 12, 12);
    while (!jp_guide_field_grow(&guide, &left)) {
        TEST_ASSERT_EQUAL_UINT32(0, left);
        units += slice;
        left = slice;
    }
    return units - left;
}

/* As much work in small slices as in one, but for a step of the wave. */
static void test_small_slices_take_as_many_units(void)
{
    const uint32_t units = units_in_slices(UINT32_MAX / 4);

    TEST_ASSERT_TRUE(units > 1000);
    TEST_ASSERT_UINT32_WITHIN(64, units, units_in_slices(1));
    TEST_ASSERT_UINT32_WITHIN(64, units, units_in_slices(29));
}

/* What it takes to turn there is not what it takes to turn back. */
static void test_turns_have_a_direction(void)
{
    turns.cost[0][4] = 1000;
    turns.cost[4][0] = 3000;
    grow(JP_GUIDE_FROM_ROOT, &west);
    TEST_ASSERT_EQUAL_UINT32(1000, estimate(west.x, west.y, 4));
    grow(JP_GUIDE_TO_ROOT, &west);
    TEST_ASSERT_EQUAL_UINT32(3000, estimate(west.x, west.y, 4));
}

/* Whatever was in its memory before. */
static void test_begins_in_any_memory(void)
{
    memset(&guide, 0xA5, sizeof guide);
    init(2);
    grow(JP_GUIDE_FROM_ROOT, &west);
    TEST_ASSERT_UINT32_WITHIN(2 * AXIS_COST, 8 * AXIS_COST, estimate(12, 8, 0));
}

/* An odd number of cells takes half a byte more, and no more. */
static void test_size_of_few_cells(void)
{
    static const struct jp_terrain_config few = {.width = 5, .height = 3, .resolution = JP_Q16(0.2)};

    TEST_ASSERT_EQUAL_UINT32(jp_wavefront_size(5, 3, JP_WAVE_2_BYTES) + 8U, jp_guide_field_size(&few, 1));
}

/* What an interrupted growth has left does not matter. */
static void test_a_start_anew_forgets_a_growth_that_was_cut(void)
{
    jp_cost expected[SIDE * SIDE];

    grow(JP_GUIDE_FROM_ROOT, &west);
    for (int32_t i = 0; i < SIDE * SIDE; i++) {
        expected[i] = estimate(i % SIDE, i / SIDE, 3);
    }
    for (unsigned cut = 1; cut < 4000; cut += 37) {
        const struct jp_guide_root other = {10, 5, 1U << 4};
        unsigned looks = cut;

        jp_guide_field_start(&guide, JP_GUIDE_FROM_ROOT, &other, 12, 12);
        (void)jp_guide_field_grow(&guide, &looks);
        grow(JP_GUIDE_FROM_ROOT, &west);
        for (int32_t i = 0; i < SIDE * SIDE; i++) {
            TEST_ASSERT_EQUAL_UINT32(expected[i], estimate(i % SIDE, i / SIDE, 3));
        }
    }
}

/* A robot of a cell comes near both edges; a wall parts them. What is beyond one is not what is before the other. */
static void test_no_way_leads_round_the_edges(void)
{
    static const struct jp_span own_cell = {0, 0, 0};
    struct jp_lattice small = *lattice;

    small.spans = &own_cell;
    small.core = (struct jp_cells){0, 1};
    put_column(8, 0, SIDE - 1, JP_CELL_OCCUPIED);
    put_column(9, 0, SIDE - 1, JP_CELL_OCCUPIED);
    for (unsigned scale = 1; scale <= 2; scale++) {
        for (unsigned direction = 0; direction < 2; direction++) {
            const struct jp_guide_root edge = {0, 8, JP_ANY_HEADING};

            init(scale);
            jp_guide_field_set_lattice(&guide, &small);
            grow(direction == 0 ? JP_GUIDE_FROM_ROOT : JP_GUIDE_TO_ROOT, &edge);
            for (int32_t i = 0; i < SIDE * SIDE; i++) {
                if (i % SIDE != 8 && i % SIDE != 9) {
                    TEST_ASSERT_EQUAL_INT(i % SIDE < 8, jp_guide_field_reaches(&guide, i % SIDE, i / SIDE));
                }
            }
        }
    }
}

/* ---- A robot of a cell ---- */

static struct jp_lattice small;

static void init_small(const struct jp_terrain_config *config, unsigned scale)
{
    static const struct jp_span own_cell = {0, 0, 0};

    small = *lattice;
    small.spans = &own_cell;
    small.core = (struct jp_cells){0, 1};
    make_level_map(config);
    jp_guide_field_init(&guide, &small, JP_COST_PHYSICAL, &terrain, &turns, scale, block);
}

static jp_elevation plateau(int32_t x, int32_t y)
{
    (void)x;
    (void)y;
    return 150;
}

/* High ground is as level as low ground, up to the far edges, where coarse cells are not whole. */
static void test_a_plateau_is_level_to_its_edges(void)
{
    static jp_cost low[13 * 11];
    static const struct jp_guide_root root = {6, 5, JP_ANY_HEADING};

    for (uint16_t width = 11; width <= 13; width++) {
        for (unsigned scale = 1; scale <= 6; scale++) {
            const struct jp_terrain_config odd = {
                .width = width, .height = 11, .resolution = JP_Q16(0.2), .has_elevation = true};

            for (unsigned is_high = 0; is_high < 2U; is_high++) {
                init_small(&odd, scale);
                if (is_high == 1U) {
                    raise_map(plateau);
                }
                grow(JP_GUIDE_FROM_ROOT, &root);
                for (int32_t i = 0; i < width * 11; i++) {
                    const jp_cost cost = estimate(i % width, i / width, 2);

                    TEST_ASSERT_EQUAL_UINT32(is_high == 1U ? low[i] : cost, cost);
                    low[i] = cost;
                }
            }
        }
    }
}

static uint32_t units_to_grow(uint32_t *loan)
{
    static const struct jp_guide_root root = {8, 8, JP_ANY_HEADING};
    unsigned units = 100000;

    jp_guide_field_start(&guide, JP_GUIDE_FROM_ROOT, &root, 0, 0);
    if (loan != NULL) {
        jp_guide_field_lend(&guide, loan);
    }
    TEST_ASSERT_TRUE(jp_guide_field_grow(&guide, &units));
    return 100000U - units;
}

/* Neighbours of the root's coarse cell that are on the map. */
static uint32_t neighbours_of_root(int32_t scale)
{
    uint32_t count = 0;

    for (unsigned i = 0; i < JP_MOVE_DIRECTIONS; i++) {
        const int32_t x = (8 / scale + jp_move_offsets[i].dx) * scale;
        const int32_t y = (8 / scale + jp_move_offsets[i].dy) * scale;

        count += x >= 0 && x < SIDE && y >= 0 && y < SIDE;
    }
    return count;
}

/* What is looked at is paid for: of a coarse cell that cannot be left, a neighbour in each direction, and for it a cell
 * of the map beside each cell; with a loan a row of it beside each row. */
static void test_all_that_is_looked_at_is_paid_for(void)
{
    enum { NEIGHBOUR = 4, CELL_LOOK = 4, WAVE_STEP = 64 };
    static uint32_t loan[SIDE];

    for (unsigned scale = 1; scale <= 4; scale *= 2) {
        init_small(&map, scale);
        for (int32_t x = 0; x < SIDE; x++) {
            put_column(x, 0, SIDE - 1, JP_CELL_OCCUPIED);
        }
        const uint32_t with_cells = units_to_grow(NULL);
        const uint32_t with_rows = units_to_grow(loan);
        const uint32_t neighbours = neighbours_of_root((int32_t)scale);
        const uint32_t looks = JP_MOVE_DIRECTIONS + neighbours * (NEIGHBOUR + scale * scale * CELL_LOOK);

        /* A step of the wave each for clearing, for the cell, and for what is looked at in vain at last. */
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(looks + 2U * WAVE_STEP, with_cells);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(looks + 6U * WAVE_STEP, with_cells);
        TEST_ASSERT_EQUAL_UINT32(with_cells + SIDE, with_rows + neighbours * scale * (scale * CELL_LOOK - 1U));
    }
}

/* And nothing more, once it has grown. */
static void test_a_grown_guide_takes_no_more(void)
{
    unsigned units = 500;

    grow(JP_GUIDE_FROM_ROOT, &west);
    TEST_ASSERT_TRUE(jp_guide_field_grow(&guide, &units));
    TEST_ASSERT_EQUAL_UINT32(500, units);
}

/* Of two cells a byte the last one has half a byte of its own, which a block that is aligned may have no room for. */
static void test_size_of_cells_that_fill_words(void)
{
    for (uint16_t width = 15; width <= 18; width++) {
        const struct jp_terrain_config row = {.width = width, .height = 1, .resolution = JP_Q16(0.2)};

        TEST_ASSERT_TRUE(jp_guide_field_size(&row, 1) - jp_wavefront_size(width, 1, JP_WAVE_2_BYTES) >=
                         (width + 1U) / 2U);
    }
}
