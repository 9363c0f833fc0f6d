/* The energy field on a small map, against relaxing all cells until nothing changes. */
#include <joulepath/energy_field.h>
#include <joulepath/tables.h>
#include <string.h>

#include "tests/support/level_map.h"
#include "tests/target/random.h"
#include "unity.h"

enum {
    WIDTH = 16,
    HEIGHT = 12,
    AXIS_COST = 224, /* of a level step along an axis, physical */
    BLOCK_BYTES = 640,
    UNREACHED = 1 << 30,
    ROUNDS = 12
};

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static const struct jp_terrain_config map = {
    .width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.2), .has_elevation = true};

static struct jp_energy_field field;
static uint64_t block[BLOCK_BYTES / 8];
static int32_t expected[HEIGHT][WIDTH];
static uint32_t state;

void setUp(void)
{
    make_level_map(&map);
    state = 20050902;
    TEST_ASSERT_TRUE(jp_energy_field_size(&map, JP_WAVE_3_BYTES) <= sizeof block);
    jp_energy_field_init(&field, lattice, JP_COST_PHYSICAL, &terrain, JP_WAVE_3_BYTES, JP_COST_MAX, block);
}

void tearDown(void)
{
}

static int32_t below(int32_t n)
{
    return (int32_t)(target_random(&state) % (uint32_t)n);
}

static void grow(void)
{
    unsigned cells = UINT16_MAX;

    TEST_ASSERT_TRUE(jp_energy_field_grow(&field, &cells));
    TEST_ASSERT_TRUE(cells > 0);
}

/* From (3, 3) to the far corner, so that the horizon is beyond all cells. */
static void start_and_grow(void)
{
    jp_energy_field_start(&field, 3, 3, 12, 8);
    grow();
}

static bool is_open(int32_t x, int32_t y)
{
    for (int i = 0; i < lattice->core.span_count; i++) {
        const struct jp_span span = lattice->spans[lattice->core.first_span + i];
        for (int32_t dx = span.first; dx <= span.last; dx++) {
            if (jp_terrain_cell(&terrain, x + dx, y + span.y) != JP_CELL_FREE) {
                return false;
            }
        }
    }
    return true;
}

static bool expect_better(int32_t x, int32_t y)
{
    bool is_better = false;

    for (unsigned i = 0; i < JP_MOVE_DIRECTIONS && is_open(x, y); i++) {
        const int32_t px = x - jp_move_offsets[i].dx;
        const int32_t py = y - jp_move_offsets[i].dy;
        if (!jp_terrain_contains(&terrain, px, py) || expected[py][px] == UNREACHED) {
            continue;
        }
        const int32_t rise = jp_terrain_elevation(&terrain, x, y) - jp_terrain_elevation(&terrain, px, py);
        const jp_cost step = jp_move_cost(&lattice->move_costs[field.kind][jp_move_kind_of(i)], rise);
        if (step != JP_COST_MAX && expected[py][px] + (int32_t)step < expected[y][x]) {
            expected[y][x] = expected[py][px] + (int32_t)step;
            is_better = true;
        }
    }
    return is_better;
}

static void relax_all(int32_t root_x, int32_t root_y)
{
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        expected[i / WIDTH][i % WIDTH] = UNREACHED;
    }
    expected[root_y][root_x] = 0;
    for (bool is_better = true; is_better;) {
        is_better = false;
        for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
            is_better |= expect_better(i % WIDTH, i / WIDTH);
        }
    }
}

/* Each bound is the least cost, or the horizon if that is less. */
static void expect_exact(int32_t root_x, int32_t root_y)
{
    const int32_t horizon = (int32_t)field.wave.horizon;

    relax_all(root_x, root_y);
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            const int32_t least = expected[y][x] < horizon ? expected[y][x] : horizon;
            const jp_cost bound = jp_energy_field_bound(&field, x, y);
            if (expected[y][x] == UNREACHED && jp_wavefront_is_exhausted(&field.wave)) {
                TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, bound);
            } else {
                TEST_ASSERT_EQUAL_UINT32(least, bound);
            }
        }
    }
}

static void expect_below(int32_t root_x, int32_t root_y)
{
    relax_all(root_x, root_y);
    for (int32_t y = 0; y < HEIGHT; y++) {
        for (int32_t x = 0; x < WIDTH; x++) {
            TEST_ASSERT_TRUE(expected[y][x] == UNREACHED ||
                             jp_energy_field_bound(&field, x, y) <= (jp_cost)expected[y][x]);
        }
    }
}

static void change(int32_t x, int32_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, cell));
    jp_energy_field_cell_changed(&field, x, y);
}

static void test_size(void)
{
    TEST_ASSERT_EQUAL_UINT32(3 * WIDTH * HEIGHT + 4 * HEIGHT, jp_energy_field_size(&map, JP_WAVE_3_BYTES));
}

static void test_level_ground(void)
{
    start_and_grow();
    TEST_ASSERT_EQUAL_UINT32(0, jp_energy_field_bound(&field, 3, 3));
    TEST_ASSERT_EQUAL_UINT32(5 * AXIS_COST, jp_energy_field_bound(&field, 8, 3));
    TEST_ASSERT_EQUAL_UINT32(4 * AXIS_COST, jp_energy_field_bound(&field, 3, 7));
    expect_exact(3, 3);
}

static void test_each_kind_of_cost(void)
{
    for (int kind = 0; kind < JP_COST_KINDS; kind++) {
        jp_energy_field_init(&field, lattice, (enum jp_cost_kind)kind, &terrain, JP_WAVE_3_BYTES, JP_COST_MAX, block);
        start_and_grow();
        expect_exact(3, 3);
    }
}

/* The field is of the way from the root, not to it. */
static void test_uphill_costs_more_than_downhill(void)
{
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_terrain_set_elevation(&terrain, i % WIDTH, i / WIDTH, (jp_elevation)(10 * (i % WIDTH))));
    }
    jp_energy_field_start(&field, 8, 5, 12, 8);
    grow();
    expect_exact(8, 5);
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 11, 5) > 3 * AXIS_COST);
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 5, 5) < 3 * AXIS_COST);
}

static void test_no_way_through_a_wall_until_it_opens(void)
{
    put_column(8, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    start_and_grow();
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_energy_field_bound(&field, 12, 8));
    expect_exact(3, 3);
    for (int32_t y = HEIGHT - 1; y >= 0; y--) {
        change(8, y, JP_CELL_FREE);
        grow();
        expect_exact(3, 3);
    }
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 12, 8) < JP_COST_MAX);
}

static void test_no_way_up_a_cliff(void)
{
    for (int32_t y = 0; y < HEIGHT; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 7, y, JP_ELEVATION_ONE));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 8, y, JP_ELEVATION_ONE));
    }
    start_and_grow();
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 6, 5) < JP_COST_MAX);
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_energy_field_bound(&field, 7, 5));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_energy_field_bound(&field, 12, 8));
    expect_exact(3, 3);
}

static void test_horizon_bounds_what_is_far(void)
{
    jp_energy_field_start(&field, 3, 3, 4, 3);
    grow();
    expect_exact(3, 3);
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 12, 8) >= AXIS_COST * 5 / 4);
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 12, 8) < 9 * AXIS_COST);
}

static void test_slices_change_nothing(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 7, 4, JP_CELL_OCCUPIED));
    for (unsigned slice = 1; slice < 100; slice *= 3) {
        unsigned cells = 0;
        jp_energy_field_start(&field, 3, 3, 12, 8);
        TEST_ASSERT_FALSE(jp_energy_field_grow(&field, &cells));
        cells = slice;
        while (!jp_energy_field_grow(&field, &cells)) {
            TEST_ASSERT_EQUAL_UINT32(0, cells);
            cells = slice;
        }
        expect_exact(3, 3);
    }
}

static bool is_in(const struct jp_cell_box *box, int32_t x, int32_t y)
{
    return x >= box->first_x && x <= box->last_x && y >= box->first_y && y <= box->last_y;
}

static void test_lowered_cells_are_told_once(void)
{
    jp_cost before[HEIGHT][WIDTH];

    put_column(8, 1, HEIGHT - 1, JP_CELL_OCCUPIED);
    start_and_grow();
    (void)jp_energy_field_take_lowered(&field);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        before[i / WIDTH][i % WIDTH] = jp_energy_field_bound(&field, i % WIDTH, i / WIDTH);
    }
    for (int32_t y = 1; y < HEIGHT; y++) {
        change(8, y, JP_CELL_FREE);
    }
    grow();
    const struct jp_cell_box box = jp_energy_field_take_lowered(&field);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const jp_cost after = jp_energy_field_bound(&field, i % WIDTH, i / WIDTH);
        TEST_ASSERT_TRUE(after == before[i / WIDTH][i % WIDTH] || is_in(&box, i % WIDTH, i / WIDTH));
    }
    TEST_ASSERT_TRUE(box.first_x > 3 && box.last_x >= 12);
    const struct jp_cell_box empty = jp_energy_field_take_lowered(&field);
    TEST_ASSERT_TRUE(empty.last_x < empty.first_x);
}

/* What makes the map dearer need not be told: the old values are bounds still. */
static void test_dearer_maps_leave_bounds(void)
{
    start_and_grow();
    for (int round = 0; round < ROUNDS; round++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, below(WIDTH), below(HEIGHT), JP_CELL_OCCUPIED));
        expect_below(3, 3);
    }
}

/* The core of the lattice is wider than a cell: blocked cells round a way close it. */
static void test_cells_that_become_free(void)
{
    for (int round = 0; round < ROUNDS; round++) {
        make_level_map(&map);
        for (int i = 0; i < 8; i++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, below(WIDTH), below(HEIGHT), JP_CELL_OCCUPIED));
        }
        start_and_grow();
        for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
            unsigned cells = (unsigned)below(3);
            if (jp_terrain_cell(&terrain, i % WIDTH, i / WIDTH) == JP_CELL_OCCUPIED) {
                change(i % WIDTH, i / WIDTH, JP_CELL_FREE);
                (void)jp_energy_field_grow(&field, &cells);
            }
        }
        grow();
        expect_exact(3, 3);
    }
}

static void test_elevations_that_change(void)
{
    start_and_grow();
    for (int round = 0; round < ROUNDS; round++) {
        const int32_t x = below(WIDTH);
        const int32_t y = below(HEIGHT);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)-below(30)));
        jp_energy_field_cell_changed(&field, x, y);
        grow();
        expect_below(3, 3);
    }
}

/* A robot at the edge, where no robot could be, still has ways to go. */
static void test_root_that_is_not_open(void)
{
    jp_energy_field_start(&field, 0, 5, 12, 8);
    grow();
    TEST_ASSERT_EQUAL_UINT32(0, jp_energy_field_bound(&field, 0, 5));
    expect_exact(0, 5);
}

/* The bounds of a way that costs more than 16 bits hold are exact, too. */
static void test_dear_ways_are_not_rounded(void)
{
    enum { TIMES = 50 };
    struct jp_lattice dear = *lattice;

    dear.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS].climb.constant *= TIMES;
    dear.move_costs[JP_COST_PHYSICAL][JP_MOVE_KNIGHT].climb.constant *= TIMES;
    dear.move_costs[JP_COST_PHYSICAL][JP_MOVE_DIAGONAL].climb.constant *= TIMES;
    const jp_cost step = jp_move_cost(&dear.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], 0);
    jp_energy_field_set_lattice(&field, &dear);
    start_and_grow();
    TEST_ASSERT_TRUE(9 * step > UINT16_MAX);
    for (int32_t x = 3; x <= 12; x++) {
        TEST_ASSERT_EQUAL_UINT32((jp_cost)(x - 3) * step, jp_energy_field_bound(&field, x, 3));
    }
}

/* Two bytes hold a large range in a coarser unit: each step is rounded down. */
static void test_two_bytes_round_down(void)
{
    jp_energy_field_init(&field, lattice, JP_COST_PHYSICAL, &terrain, JP_WAVE_2_BYTES, 4U * UINT16_MAX, block);
    start_and_grow();
    TEST_ASSERT_TRUE(field.shift > 0);
    expect_below(3, 3);
    TEST_ASSERT_TRUE(jp_energy_field_bound(&field, 8, 3) > 4 * AXIS_COST);
}

/* ---- A robot of a cell ---- */

/* So that a step needs nothing but the cell where it ends. */
static struct jp_lattice small;
static const struct jp_span own_cell = {0, 0, 0};

static void init_small(void)
{
    small = *lattice;
    small.spans = &own_cell;
    small.core = (struct jp_cells){0, 1};
    jp_energy_field_init(&field, &small, JP_COST_PHYSICAL, &terrain, JP_WAVE_3_BYTES, JP_COST_MAX, block);
}

static void block_all_but(int32_t x, int32_t y)
{
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const enum jp_cell cell = i == y * WIDTH + x ? JP_CELL_FREE : JP_CELL_OCCUPIED;

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH, cell));
    }
}

static void test_a_cell_that_becomes_free_is_reached_by_each_of_the_steps(void)
{
    init_small();
    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const int32_t x = 8 + jp_move_offsets[direction].dx;
        const int32_t y = 6 + jp_move_offsets[direction].dy;

        block_all_but(8, 6);
        jp_energy_field_start(&field, 8, 6, 8, 6);
        grow();
        change(x, y, JP_CELL_FREE);
        grow();
        TEST_ASSERT_EQUAL_UINT32(jp_move_cost(&small.move_costs[JP_COST_PHYSICAL][jp_move_kind_of(direction)], 0),
                                 jp_wavefront_value(&field.wave, x, y));
    }
}

/* The core of the lattice lets go of cells some way off, on either side. */
static void test_a_cell_that_becomes_free_opens_those_beside_it(void)
{
    for (int32_t x = 2; x < WIDTH - 2; x++) {
        put_column(x, HEIGHT / 2, HEIGHT / 2, JP_CELL_OCCUPIED);
        jp_energy_field_start(&field, 8, 3, 8, HEIGHT - 4);
        grow();
        change(x, HEIGHT / 2, JP_CELL_FREE);
        grow();
        expect_exact(8, 3);
    }
}

static void test_a_root_that_rises_makes_what_is_round_it_cheaper(void)
{
    init_small();
    start_and_grow();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, 3, 3, 10));
    jp_energy_field_cell_changed(&field, 3, 3);
    grow();
    TEST_ASSERT_EQUAL_UINT32(jp_move_cost(&small.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], -10),
                             jp_energy_field_bound(&field, 4, 3));
}

static void test_no_cell_is_told_where_nothing_fell(void)
{
    start_and_grow();
    (void)jp_energy_field_take_lowered(&field);
    jp_energy_field_cell_changed(&field, 6, 5);
    grow();
    const struct jp_cell_box box = jp_energy_field_take_lowered(&field);

    TEST_ASSERT_TRUE(box.last_x < box.first_x);
}
