/* The turn field on a small map, against relaxing all coarse cells and headings until nothing changes. */
#include <joulepath/tables.h>
#include <joulepath/turn_field.h>
#include <string.h>

#include "tests/support/level_map.h"
#include "tests/target/random.h"
#include "unity.h"

enum {
    WIDTH = 19, /* not a multiple of the scales */
    HEIGHT = 13,
    SCALES = 2,
    ROWS_MAX = 7, /* of coarse cells */
    COLUMNS_MAX = 10,
    BLOCK_BYTES = 2688,
    UNREACHED = UINT16_MAX,
    ROUNDS = 2,
    PRIMITIVES_MAX = 144
};

static const struct jp_lattice *lattice;
static enum jp_cost_kind kind;
static const struct {
    int32_t x;
    int32_t y;
    unsigned heading;
} root = {4, 4, 0}, far_off = {14, 8, 8};
static const unsigned scales[SCALES] = {2, 5};
static const struct jp_terrain_config map = {.width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.2)};

static struct jp_turn_field field;
static struct jp_turns turns;
static uint64_t block[BLOCK_BYTES / 8];
static uint16_t expected[ROWS_MAX][COLUMNS_MAX][JP_HEADINGS];
static uint32_t state;

static void init(unsigned scale)
{
    TEST_ASSERT_TRUE(jp_turn_field_size(&map, scale) <= sizeof block);
    jp_lattice_turns(lattice, kind, &turns);
    jp_turn_field_init(&field, lattice, kind, &terrain, scale, block);
}

void setUp(void)
{
    lattice = &jp_lattice_zhang2018;
    kind = JP_COST_PHYSICAL;
    make_level_map(&map);
    state = 20050903;
    init(scales[0]);
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
    unsigned looks = UINT32_MAX;

    TEST_ASSERT_TRUE(jp_turn_field_grow(&field, &looks));
    TEST_ASSERT_TRUE(looks > 0);
}

static void start(void)
{
    jp_turn_field_start(&field, &turns, root.x, root.y, root.heading, far_off.x, far_off.y, far_off.heading);
}

static void start_and_grow(void)
{
    start();
    grow();
}

static bool relax_from(int32_t x, int32_t y, const struct jp_primitive *primitive)
{
    const int32_t scale = field.scale;
    const int32_t here = expected[y / scale][x / scale][primitive->start];
    const int32_t value = here + (primitive->base[kind] >> field.shift);

    if (here == UNREACHED || !jp_lattice_is_clear(lattice, &terrain, primitive, x, y)) {
        return false;
    }
    uint16_t *there = &expected[(y + primitive->dy) / scale][(x + primitive->dx) / scale][primitive->end];
    const bool is_better = value < *there;
    *there = is_better ? (uint16_t)value : *there;
    return is_better;
}

static void relax_all(void)
{
    for (int32_t i = 0; i < ROWS_MAX * COLUMNS_MAX * JP_HEADINGS; i++) {
        (&expected[0][0][0])[i] = UNREACHED;
    }
    expected[root.y / field.scale][root.x / field.scale][root.heading] = 0;
    for (bool is_better = true; is_better;) {
        is_better = false;
        for (int32_t i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
            for (int32_t cell = 0; cell < WIDTH * HEIGHT; cell++) {
                is_better |= relax_from(cell % WIDTH, cell / WIDTH, &lattice->primitives[i]);
            }
        }
    }
}

static jp_cost bound(int32_t x, int32_t y, unsigned heading)
{
    return jp_turn_field_bound(&field, x, y, heading);
}

/* Each bound is the least cost, or the horizon if that is less. */
static void expect_exact(void)
{
    const int32_t horizon = (int32_t)field.wave.horizon;

    relax_all();
    for (int32_t i = 0; i < WIDTH * HEIGHT * JP_HEADINGS; i++) {
        const unsigned heading = (unsigned)(i % JP_HEADINGS);
        const int32_t x = i / JP_HEADINGS % WIDTH;
        const int32_t y = i / JP_HEADINGS / WIDTH;
        const int32_t value = expected[y / field.scale][x / field.scale][heading];
        const int32_t least = value < horizon ? value : horizon;
        const bool is_cut_off = value == UNREACHED && jp_wavefront_is_exhausted(&field.wave);
        TEST_ASSERT_EQUAL_UINT32(is_cut_off ? JP_COST_MAX : (jp_cost)least << field.shift, bound(x, y, heading));
    }
}

static void expect_below(void)
{
    relax_all();
    for (int32_t i = 0; i < WIDTH * HEIGHT * JP_HEADINGS; i++) {
        const int32_t x = i / JP_HEADINGS % WIDTH;
        const int32_t y = i / JP_HEADINGS / WIDTH;
        const int32_t value = expected[y / field.scale][x / field.scale][i % JP_HEADINGS];
        TEST_ASSERT_TRUE(value == UNREACHED || bound(x, y, (unsigned)(i % JP_HEADINGS)) <= (jp_cost)value
                                                                                               << field.shift);
    }
}

static void change(int32_t x, int32_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, cell));
    jp_turn_field_cell_changed(&field, x, y);
}

static void occupy_some(int count)
{
    for (int i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, below(WIDTH), below(HEIGHT), JP_CELL_OCCUPIED));
    }
}

static void test_size(void)
{
    const size_t rows = ROWS_MAX * JP_HEADINGS;
    TEST_ASSERT_EQUAL_UINT32(rows * COLUMNS_MAX * 2 + rows * 4, jp_turn_field_size(&map, 2));
    TEST_ASSERT_TRUE(jp_turn_field_size(&map, 3) < jp_turn_field_size(&map, 2));
}

/* A turn costs at least what it does anywhere, but for the rounding. */
static void test_open_ground(void)
{
    start_and_grow();
    TEST_ASSERT_EQUAL_UINT32(0, bound(root.x, root.y, root.heading));
    TEST_ASSERT_EQUAL_UINT32(0, bound(14, 4, 0));
    TEST_ASSERT_TRUE(bound(14, 7, 0) > 0);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const jp_cost turn = turns.cost[0][heading];
        TEST_ASSERT_TRUE(16 * bound(root.x, root.y, heading) >= 15 * turn);
    }
    expect_exact();
}

static void test_each_scale(void)
{
    for (unsigned i = 0; i < SCALES; i++) {
        for (int round = 0; round < ROUNDS; round++) {
            make_level_map(&map);
            occupy_some(5);
            init(scales[i]);
            start_and_grow();
            expect_exact();
        }
    }
}

/* A wall with a gap: through it the robot must turn, turn back, or both. */
static void test_turns_that_a_wall_forces(void)
{
    start_and_grow();
    const jp_cost before = bound(14, 4, 0);
    put_column(9, 0, 5, JP_CELL_OCCUPIED);
    start_and_grow();
    TEST_ASSERT_TRUE(bound(14, 4, 0) > before);
    expect_exact();
}

static void test_no_way_through_a_wall_until_it_opens(void)
{
    put_column(9, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    start_and_grow();
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, bound(far_off.x, far_off.y, far_off.heading));
    expect_exact();
    for (int32_t y = HEIGHT - 1; y >= 0; y--) {
        change(9, y, JP_CELL_FREE);
        grow();
    }
    expect_exact();
    TEST_ASSERT_TRUE(bound(far_off.x, far_off.y, far_off.heading) < JP_COST_MAX);
}

static void test_target_nearby_sets_the_horizon(void)
{
    jp_turn_field_start(&field, &turns, root.x, root.y, root.heading, 6, 4, 1);
    grow();
    TEST_ASSERT_TRUE(field.wave.horizon < jp_wavefront_value_max(&field.wave));
    TEST_ASSERT_EQUAL_UINT32(field.wave.horizon << field.shift, bound(far_off.x, far_off.y, far_off.heading));
    expect_exact();
}

static void test_slices_change_nothing(void)
{
    occupy_some(5);
    for (unsigned slice = 1; slice < 2000; slice *= 7) {
        unsigned looks = 0;
        start();
        TEST_ASSERT_FALSE(jp_turn_field_grow(&field, &looks));
        looks = slice;
        while (!jp_turn_field_grow(&field, &looks)) {
            TEST_ASSERT_EQUAL_UINT32(0, looks);
            looks = slice;
        }
        expect_exact();
    }
}

static bool is_in(const struct jp_cell_box *box, int32_t x, int32_t y)
{
    return x >= box->first_x && x <= box->last_x && y >= box->first_y && y <= box->last_y;
}

static void test_lowered_cells_are_told_once(void)
{
    static uint16_t before[ROWS_MAX * JP_HEADINGS][COLUMNS_MAX];

    put_column(9, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    start_and_grow();
    (void)jp_turn_field_take_lowered(&field);
    for (int32_t i = 0; i < ROWS_MAX * JP_HEADINGS * COLUMNS_MAX; i++) {
        before[i / COLUMNS_MAX][i % COLUMNS_MAX] =
            (uint16_t)jp_wavefront_value(&field.wave, i % COLUMNS_MAX, i / COLUMNS_MAX);
    }
    for (int32_t y = 0; y < HEIGHT; y++) {
        change(9, y, JP_CELL_FREE);
    }
    grow();
    const struct jp_cell_box box = jp_turn_field_take_lowered(&field);
    for (int32_t i = 0; i < ROWS_MAX * JP_HEADINGS * COLUMNS_MAX; i++) {
        const int32_t x = i % COLUMNS_MAX;
        const int32_t row = i / COLUMNS_MAX;
        TEST_ASSERT_TRUE(jp_wavefront_value(&field.wave, x, row) == before[row][x] ||
                         is_in(&box, x * field.scale, row / JP_HEADINGS * field.scale));
    }
    TEST_ASSERT_TRUE(box.last_x < WIDTH && box.last_y < HEIGHT && box.last_x > 9);
    const struct jp_cell_box empty = jp_turn_field_take_lowered(&field);
    TEST_ASSERT_TRUE(empty.last_x < empty.first_x);
}

/* What is blocked need not be told: the old values are bounds still. */
static void test_obstacles_leave_bounds(void)
{
    start_and_grow();
    for (int round = 0; round < ROUNDS; round++) {
        occupy_some(3);
        expect_below();
    }
}

/* Also while it grows, and beyond the borders of the map. */
static void test_cells_that_become_free(void)
{
    for (int round = 0; round < ROUNDS; round++) {
        make_level_map(&map);
        occupy_some(8);
        init(scales[round % SCALES]);
        start_and_grow();
        for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
            unsigned looks = (unsigned)below(40);
            if (jp_terrain_cell(&terrain, i % WIDTH, i / WIDTH) == JP_CELL_OCCUPIED) {
                change(i % WIDTH, i / WIDTH, JP_CELL_FREE);
                (void)jp_turn_field_grow(&field, &looks);
            }
        }
        grow();
        expect_exact();
    }
}

/* With costs that differ, so does the unit; sums beyond the range are limited to it. */
static void test_other_costs_of_the_same_lattice(void)
{
    static struct jp_primitive primitives[PRIMITIVES_MAX];
    struct jp_lattice dear = jp_lattice_zhang2018;

    TEST_ASSERT_TRUE(dear.first_from[JP_HEADINGS] <= PRIMITIVES_MAX);
    (void)memcpy(primitives, dear.primitives, dear.first_from[JP_HEADINGS] * sizeof *primitives);
    dear.primitives = primitives;
    for (unsigned i = 0; i < dear.first_from[JP_HEADINGS]; i++) {
        primitives[i].base[JP_COST_PHYSICAL] = primitives[i].start == primitives[i].end ? 0 : UINT16_MAX;
    }
    primitives[dear.first_from[1] - 1].base[JP_COST_PHYSICAL] = 1; /* the unit of all */
    lattice = &dear;
    jp_turn_field_set_lattice(&field, &dear);
    jp_lattice_turns(&dear, JP_COST_PHYSICAL, &turns);
    start_and_grow();
    TEST_ASSERT_EQUAL_UINT32(0, field.shift);
    TEST_ASSERT_TRUE(bound(far_off.x, far_off.y, far_off.heading) <= jp_wavefront_value_max(&field.wave));
    TEST_ASSERT_TRUE(bound(far_off.x, far_off.y, far_off.heading) > 0);
}

/* A value is a sixteenth of the cheapest turn, or up to a half less. */
static void test_unit_of_the_values(void)
{
    uint32_t least = UINT32_MAX;

    start();
    for (unsigned from = 0; from < JP_HEADINGS; from++) {
        for (unsigned to = 0; to < JP_HEADINGS; to++) {
            least = turns.cost[from][to] > 0 && turns.cost[from][to] < least ? turns.cost[from][to] : least;
        }
    }
    TEST_ASSERT_TRUE(least >> field.shift >= 16 && least >> field.shift < 32);
    TEST_ASSERT_EQUAL_UINT32((least >> field.shift) + 1, field.wave.step);
}

/* Values are known to the target and a quarter more: not of what lies beyond. */
static void test_horizon_lies_beyond_the_target(void)
{
    static const uint8_t targets[][3] = {{6, 4, 2}, {14, 8, 8}, {4, 6, 15}, {8, 4, 4}};

    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++) {
        const uint8_t *to = targets[i];
        jp_turn_field_start(&field, &turns, root.x, root.y, root.heading, to[0], to[1], to[2]);
        grow();
        const uint32_t value =
            jp_wavefront_value(&field.wave, to[0] / field.scale, to[1] / field.scale * JP_HEADINGS + to[2]);
        TEST_ASSERT_TRUE(value > 0);
        TEST_ASSERT_EQUAL_UINT32(value + value / 4 + field.wave.step, field.wave.horizon);
    }
}

static uint32_t looks_in_slices(unsigned slice)
{
    uint32_t looks = slice;
    unsigned left = slice;

    start();
    while (!jp_turn_field_grow(&field, &left)) {
        TEST_ASSERT_EQUAL_UINT32(0, left);
        looks += slice;
        left = slice;
    }
    return looks - left;
}

/* What is looked at is paid for, if need be later: as much in small slices as in one,
 * but for a step of the wave. */
static void test_small_slices_take_as_many_looks(void)
{
    occupy_some(5);
    const uint32_t looks = looks_in_slices(UINT32_MAX / 4);

    TEST_ASSERT_TRUE(looks > 1000);
    TEST_ASSERT_UINT32_WITHIN(16, looks, looks_in_slices(1));
    TEST_ASSERT_UINT32_WITHIN(16, looks, looks_in_slices(13));
    TEST_ASSERT_UINT32_WITHIN(16, looks, looks_in_slices(13)); /* nothing is owed from the time before */
}

/* Whatever was in its memory before. */
static void test_begins_in_any_memory(void)
{
    memset(&field, 0xA5, sizeof field);
    memset(block, 0xA5, sizeof block);
    init(scales[0]);
    start_and_grow();
    expect_exact();
}

/* A root that cannot be left is all that falls: its coarse cell, as far as it is on the map. */
static void expect_box_of_root(int32_t x, int32_t y, const struct jp_cell_box *its)
{
    jp_turn_field_start(&field, &turns, x, y, 3, x, y, 3);
    grow();
    const struct jp_cell_box box = jp_turn_field_take_lowered(&field);

    TEST_ASSERT_EQUAL_INT32(its->first_x, box.first_x);
    TEST_ASSERT_EQUAL_INT32(its->last_x, box.last_x);
    TEST_ASSERT_EQUAL_INT32(its->first_y, box.first_y);
    TEST_ASSERT_EQUAL_INT32(its->last_y, box.last_y);
}

static void test_lowered_cells_are_told_to_the_cell(void)
{
    for (int32_t x = 0; x < WIDTH; x++) {
        put_column(x, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    }
    init(5);
    expect_box_of_root(7, 6, &(struct jp_cell_box){5, 9, 5, 9});
    expect_box_of_root(0, 0, &(struct jp_cell_box){0, 4, 0, 4});
    expect_box_of_root(WIDTH - 1, HEIGHT - 1, &(struct jp_cell_box){15, WIDTH - 1, 10, HEIGHT - 1});
}

/* Cells of a coarse one from which a way along an axis leads to the coarse cell `far`, and from there on. */
static unsigned cells_towards(int32_t coarse, int32_t way, int32_t far)
{
    const int32_t scale = field.scale;
    unsigned count = 0;

    for (int32_t cell = coarse * scale; cell < (coarse + 1) * scale; cell++) {
        count += cell + way >= far * scale && cell + way < (far + 1) * scale;
    }
    return count;
}

/* Of a coarse cell without a way out: each of the four to which a primitive may lead costs a look; those that are not
 * as cheap already a sweep of each cell that leads there, and one more to find that there are no others. */
static uint32_t looks_of(const struct jp_primitive *primitive, int32_t x, int32_t y)
{
    enum { SWEEP = 16, AWAY = 10 };
    const int32_t scale = field.scale;
    const int32_t first_x = (x * scale + primitive->dx + AWAY * scale) / scale - AWAY;
    const int32_t first_y = (y * scale + primitive->dy + AWAY * scale) / scale - AWAY;
    uint32_t looks = 0;

    for (int32_t corner = 0; corner < 4; corner++) {
        const int32_t to_x = first_x + corner % 2;
        const int32_t to_y = first_y + corner / 2;
        const unsigned cells = cells_towards(x, primitive->dx, to_x) * cells_towards(y, primitive->dy, to_y);
        const bool is_root = to_x == x && to_y == y && primitive->end == 0U;
        const bool is_on_map = to_x >= 0 && to_y >= 0 && to_x * scale < WIDTH && to_y * scale < HEIGHT;

        looks += is_on_map && !is_root ? SWEEP * (cells + 1U) : 1U;
    }
    return looks;
}

static void test_all_that_is_looked_at_is_paid_for(void)
{
    enum { WAVE_STEP = 16, ROOT_X = 10, ROOT_Y = 6 };

    for (unsigned i = 0; i < SCALES; i++) {
        unsigned left = 100000;
        uint32_t looks = 0;

        for (int32_t x = 0; x < WIDTH; x++) {
            put_column(x, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
        }
        init(scales[i]);
        jp_turn_field_start(&field, &turns, ROOT_X, ROOT_Y, 0, ROOT_X, ROOT_Y, 0);
        TEST_ASSERT_TRUE(jp_turn_field_grow(&field, &left));
        for (unsigned k = lattice->first_from[0]; k < lattice->first_from[1]; k++) {
            looks += looks_of(&lattice->primitives[k], ROOT_X / field.scale, ROOT_Y / field.scale);
        }
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(looks + 2U * WAVE_STEP, 100000U - left);
        TEST_ASSERT_LESS_OR_EQUAL_UINT32(looks + 8U * WAVE_STEP, 100000U - left);
        left = 500; /* and nothing more, once it has grown */
        TEST_ASSERT_TRUE(jp_turn_field_grow(&field, &left));
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(500 - WAVE_STEP, left);
    }
}

/* Turning costs what the lattice says of each kind of cost. */
static void test_each_kind_of_cost(void)
{
    occupy_some(4);
    for (int i = 0; i < JP_COST_KINDS; i++) {
        kind = (enum jp_cost_kind)i;
        init(scales[0]);
        start_and_grow();
        expect_exact();
    }
}
