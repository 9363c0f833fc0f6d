/* A disc moved along a line between obstacles: every case against the distance of the line from cells and edges, found
 * by halving the line again and again. */
#include "src/map/capsule.h"

#include "tests/target/random.h"
#include "unity.h"

/* Lengths are units but for those of the oracle; at a resolution of 2⁻⁶ m a unit is 2⁻¹⁶ m. */
enum {
    SIDE = 40,
    LONG = 150, /* cells of a row, for which two looks are too few */
    LOW = 9,
    BLOCKS_MAX = 12,
    RADIUS_MAX = 64,                       /* cells */
    UNITS = 1024,                          /* of a cell: what the capsule counts in */
    STEPS = 4096,                          /* of a line, and of 2⁻¹⁶ m */
    WORDS = (LONG + 31) / 32 * LOW + SIDE, /* 64 bits each, for two planes */
};

struct cell {
    int32_t x;
    int32_t y;
};

static struct jp_terrain terrain;
static uint64_t block[WORDS];
static struct cell blocks[BLOCKS_MAX];
static int block_count;
static uint32_t state;

/* ---- Maps ---- */

/* All of it free, but for what is set later. */
static void start(uint16_t width, uint16_t height, jp_q16 resolution, bool unknown_is_free)
{
    const struct jp_terrain_config config = {
        .width = width, .height = height, .resolution = resolution, .unknown_is_free = unknown_is_free};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, block, sizeof block, &field));
    for (int32_t y = 0; y < height; y++) {
        for (int32_t x = 0; x < width; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_FREE));
        }
    }
    block_count = 0;
}

void setUp(void)
{
    state = UINT32_C(20180900);
    start(SIDE, SIDE, UNITS, false);
}

void tearDown(void)
{
}

static void set(int32_t x, int32_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, cell));
}

/* ---- The distance, in 2⁻²⁸ m ---- */

static int64_t lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static int64_t greater(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int64_t outside(int64_t place, int64_t low, int64_t high)
{
    return place < low ? low - place : place > high ? place - high : 0;
}

/* Square of it, of a place of the line from a cell. */
static int64_t square_at(const struct jp_capsule *capsule, int64_t step, const struct cell *cell)
{
    const int64_t side = (int64_t)terrain.config.resolution * STEPS;
    const int64_t x = capsule->from.x * (STEPS - step) + capsule->to.x * step;
    const int64_t y = capsule->from.y * (STEPS - step) + capsule->to.y * step;
    const int64_t dx = outside(x, cell->x * side, (cell->x + 1) * side);
    const int64_t dy = outside(y, cell->y * side, (cell->y + 1) * side);

    return dx * dx + dy * dy;
}

/* Along the line it falls, and then it rises. */
static int64_t distance_from_cell(const struct jp_capsule *capsule, const struct cell *cell)
{
    int64_t low = 0;
    int64_t high = STEPS;

    while (low < high) {
        const int64_t middle = (low + high) / 2;

        if (square_at(capsule, middle, cell) > square_at(capsule, middle + 1, cell)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return jp_square_root((uint64_t)square_at(capsule, low, cell));
}

/* Negative beyond it. */
static int64_t distance_from_edge(const struct jp_point *point)
{
    const int64_t east = (int64_t)terrain.config.width * terrain.config.resolution - point->x;
    const int64_t north = (int64_t)terrain.config.height * terrain.config.resolution - point->y;

    return STEPS * lesser(lesser(point->x, point->y), lesser(east, north));
}

static int64_t distance(const struct jp_capsule *capsule)
{
    int64_t least = lesser(distance_from_edge(&capsule->from), distance_from_edge(&capsule->to));

    for (int i = 0; i < block_count; i++) {
        least = lesser(least, distance_from_cell(capsule, &blocks[i]));
    }
    return least;
}

/* ---- Random ---- */

static int32_t between(int32_t low, int32_t high)
{
    return low + (int32_t)(target_random(&state) % (uint32_t)(high - low + 1));
}

static bool one_in(int32_t times)
{
    return between(1, times) == 1;
}

/* Here and below each draw is a statement: those of one may come in any order. */
static void random_cell(void)
{
    const int32_t x = between(0, terrain.config.width - 1);
    const int32_t y = between(0, terrain.config.height - 1);
    const enum jp_cell kind = one_in(3) ? JP_CELL_UNKNOWN : JP_CELL_OCCUPIED;

    if (jp_terrain_cell(&terrain, x, y) == JP_CELL_FREE) {
        set(x, y, kind);
        if (kind == JP_CELL_OCCUPIED || !terrain.config.unknown_is_free) {
            blocks[block_count++] = (struct cell){x, y};
        }
    }
}

static void random_map(void)
{
    static const jp_q16 resolutions[] = {UNITS, 4 * UNITS, JP_Q16(0.1), JP_Q16(0.05)};
    const int32_t width = between(1, SIDE);
    const int32_t height = between(1, SIDE);
    const jp_q16 resolution = resolutions[between(0, 3)];
    const bool unknown_is_free = one_in(2);

    if (one_in(4)) {
        start(LONG, LOW, UNITS, unknown_is_free);
    } else {
        start((uint16_t)width, (uint16_t)height, resolution, unknown_is_free);
    }
    for (int32_t i = between(0, BLOCKS_MAX); i > 0; i--) {
        random_cell();
    }
}

/* Now and then at a corner or the middle of a cell or of its side, or off the map. */
static int32_t random_place(int32_t cells)
{
    const jp_q16 resolution = terrain.config.resolution;

    if (one_in(4)) {
        return between(0, 2 * cells) * resolution / 2;
    }
    return one_in(50) ? between(-2 * resolution, (cells + 2) * resolution) : between(0, cells * resolution);
}

static struct jp_capsule random_capsule(void)
{
    const jp_q16 resolution = terrain.config.resolution;
    struct jp_capsule capsule;

    capsule.from.x = random_place(terrain.config.width);
    capsule.from.y = random_place(terrain.config.height);
    capsule.to.x = random_place(terrain.config.width);
    capsule.to.y = random_place(terrain.config.height);
    if (one_in(2)) {
        capsule.to.x = capsule.from.x + between(-2 * resolution, 2 * resolution);
        capsule.to.y = capsule.from.y + between(-2 * resolution, 2 * resolution);
    }
    capsule.to.x = one_in(8) ? capsule.from.x : capsule.to.x;
    capsule.to.y = one_in(8) ? capsule.from.y : capsule.to.y;
    capsule.radius = between((resolution + 3) / 4, 4 * resolution);
    return capsule;
}

/* Within so many units of touching it may say either. Where units do not end at 2⁻¹⁶ m both ends may be off by one in x
 * and in y. */
static int64_t slack(void)
{
    return terrain.config.resolution % UNITS == 0 ? 2 : 3;
}

enum answer { BLOCKED, CLEAR, EITHER, ANSWERS };

static enum answer expected(const struct jp_capsule *capsule, int64_t distance)
{
    const int64_t over = (distance - (int64_t)capsule->radius * STEPS) * UNITS;
    const int64_t allowed = slack() * terrain.config.resolution * STEPS;

    if (over >= allowed) {
        return CLEAR;
    }
    return over <= -allowed ? BLOCKED : EITHER;
}

static enum answer look(struct jp_capsule capsule, int64_t radius, int64_t distance)
{
    const int64_t resolution = terrain.config.resolution;

    capsule.radius = (jp_q16)greater((resolution + 3) / 4, lesser(radius, RADIUS_MAX * resolution));

    const enum answer answer = expected(&capsule, distance);
    const bool is_clear = jp_capsule_is_clear(&terrain, &capsule);

    TEST_ASSERT_TRUE(answer == EITHER || is_clear == (answer == CLEAR));
    return answer;
}

/* Of a random radius, and of those that are just small and just large enough. */
static void test_random_capsules_agree_with_the_distance(void)
{
    int counts[ANSWERS] = {0};

    for (int map = 0; map < 400; map++) {
        random_map();
        for (int i = 0; i < 8; i++) {
            const struct jp_capsule capsule = random_capsule();
            const int64_t nearest = distance(&capsule);
            const int64_t allowed = slack() * terrain.config.resolution / UNITS + 1;

            counts[look(capsule, capsule.radius, nearest)]++;
            counts[look(capsule, nearest / STEPS - allowed, nearest)]++;
            counts[look(capsule, nearest / STEPS + allowed + 1, nearest)]++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(2000, counts[CLEAR]);
    TEST_ASSERT_GREATER_THAN_INT(4000, counts[BLOCKED]);
    TEST_ASSERT_LESS_THAN_INT(50, counts[EITHER]);
}

/* ---- One by one, in units ---- */

enum { CELL = UNITS, SMALLEST = CELL / 4 };

static bool is_clear(int32_t from_x, int32_t from_y, int32_t to_x, int32_t to_y, int32_t radius)
{
    const struct jp_capsule capsule = {{from_x, from_y}, {to_x, to_y}, radius};

    return jp_capsule_is_clear(&terrain, &capsule);
}

/* Touches at this radius, either way round. */
static void expect_touch(struct jp_point from, struct jp_point to, int32_t radius)
{
    TEST_ASSERT_TRUE(is_clear(from.x, from.y, to.x, to.y, radius));
    TEST_ASSERT_TRUE(is_clear(to.x, to.y, from.x, from.y, radius));
    TEST_ASSERT_FALSE(is_clear(from.x, from.y, to.x, to.y, radius + 2));
    TEST_ASSERT_FALSE(is_clear(to.x, to.y, from.x, from.y, radius + 2));
}

static struct jp_point in_halves(int32_t x, int32_t y)
{
    return (struct jp_point){x * (CELL / 2), y * (CELL / 2)};
}

static void expect_disc(struct jp_point centre, int32_t radius)
{
    expect_touch(centre, centre, radius);
}

static void test_a_line_without_length_is_a_disc(void)
{
    set(20, 20, JP_CELL_OCCUPIED);
    expect_disc(in_halves(34, 41), 3 * CELL);
    expect_disc(in_halves(48, 41), 3 * CELL);
    expect_disc(in_halves(41, 34), 3 * CELL);
    expect_disc(in_halves(41, 48), 3 * CELL);
    expect_disc(in_halves(32, 34), 5 * CELL); /* 3, 4, 5 */
    expect_disc(in_halves(48, 36), 3 * CELL + 620);
    TEST_ASSERT_FALSE(is_clear(41 * CELL / 2, 41 * CELL / 2, 41 * CELL / 2, 41 * CELL / 2, SMALLEST));
}

static void test_level_and_upright_lines(void)
{
    set(20, 20, JP_CELL_OCCUPIED);
    expect_touch(in_halves(20, 34), in_halves(60, 34), 3 * CELL);
    expect_touch(in_halves(20, 48), in_halves(60, 48), 3 * CELL);
    expect_touch(in_halves(34, 20), in_halves(34, 60), 3 * CELL);
    expect_touch(in_halves(48, 20), in_halves(48, 60), 3 * CELL);
    /* Their ends are nearest. */
    expect_touch(in_halves(20, 41), in_halves(34, 41), 3 * CELL);
    expect_touch(in_halves(41, 48), in_halves(41, 60), 3 * CELL);
    expect_touch(in_halves(14, 34), in_halves(32, 34), 5 * CELL);
    expect_touch(in_halves(48, 14), in_halves(48, 32), 5 * CELL);
    /* Along its side, and through its middle. */
    TEST_ASSERT_FALSE(is_clear(10 * CELL, 20 * CELL, 30 * CELL, 20 * CELL, SMALLEST));
    TEST_ASSERT_FALSE(is_clear(21 * CELL, 10 * CELL, 21 * CELL, 30 * CELL, SMALLEST));
    TEST_ASSERT_FALSE(is_clear(10 * CELL, 41 * CELL / 2, 30 * CELL, 41 * CELL / 2, SMALLEST));
}

static void test_each_cell_beside_a_line_of_three_looks(void)
{
    const struct jp_point west = in_halves(6, 9);
    const struct jp_point east = in_halves(2 * LONG - 6, 9);

    start(LONG, LOW, UNITS, false);
    TEST_ASSERT_TRUE(is_clear(west.x, west.y, east.x, east.y, 3 * CELL));
    for (int32_t x = 3; x < LONG - 3; x++) {
        set(x, 6, JP_CELL_OCCUPIED);
        expect_touch(west, east, 3 * CELL / 2);
        set(x, 6, JP_CELL_FREE);
        set(x, 4, JP_CELL_OCCUPIED);
        TEST_ASSERT_FALSE(is_clear(west.x, west.y, east.x, east.y, SMALLEST));
        set(x, 4, JP_CELL_FREE);
    }
}

/* Nearly level, with each cell of its middle row in turn. */
static void test_each_cell_beside_a_slanting_line_of_three_looks(void)
{
    struct jp_capsule capsule = {in_halves(6, 5), in_halves(2 * LONG - 6, 13), 0};

    start(LONG, LOW, UNITS, false);
    block_count = 1;
    for (int32_t x = 0; x < LONG; x++) {
        blocks[0] = (struct cell){x, 4};
        set(x, 4, JP_CELL_OCCUPIED);
        for (int32_t radius = SMALLEST; radius < 3 * CELL; radius += CELL / 4) {
            (void)look(capsule, radius, distance(&capsule));
        }
        set(x, 4, JP_CELL_FREE);
    }
}

static void test_beyond_the_map_all_is_blocked(void)
{
    const int32_t side = 2 * SIDE;

    expect_touch(in_halves(6, 20), in_halves(20, 20), 3 * CELL);
    expect_touch(in_halves(side - 6, 20), in_halves(side - 6, 60), 3 * CELL);
    expect_touch(in_halves(20, 6), in_halves(60, 6), 3 * CELL);
    expect_touch(in_halves(20, side - 6), in_halves(20, 40), 3 * CELL);
    expect_disc(in_halves(40, 40), SIDE / 2 * CELL);
    /* Across its sides, and wholly off it. */
    for (int32_t beyond = 1; beyond < 300; beyond += 23) {
        const int32_t far = SIDE * CELL + beyond * (CELL / 2);
        const int32_t inside = 20 * CELL;

        TEST_ASSERT_FALSE(is_clear(inside, inside, SIDE * CELL - far, inside, SMALLEST));
        TEST_ASSERT_FALSE(is_clear(inside, inside, far, inside, SMALLEST));
        TEST_ASSERT_FALSE(is_clear(inside, SIDE * CELL - far, inside, inside, SMALLEST));
        TEST_ASSERT_FALSE(is_clear(inside, far, inside, inside, SMALLEST));
        TEST_ASSERT_FALSE(is_clear(far, far, far, inside, SMALLEST));
        TEST_ASSERT_FALSE(is_clear(SIDE * CELL - far, inside, SIDE * CELL - far, far, SMALLEST));
    }
}

/* So far that its place in 1/1024 of a cell needs more than 32 bits, which would wrap into the middle of the map. */
static void test_far_beyond_a_map_of_small_cells_all_is_blocked(void)
{
    const int32_t cell = 16;
    const int32_t middle = SIDE / 2 * cell;
    const int32_t far = middle + ((int32_t)1 << 26);

    start(SIDE, SIDE, cell, false);
    TEST_ASSERT_TRUE(is_clear(middle, middle, middle, middle, cell));
    TEST_ASSERT_FALSE(is_clear(far, middle, far, middle, cell));
    TEST_ASSERT_FALSE(is_clear(middle, far, middle, far, cell));
    TEST_ASSERT_FALSE(is_clear(far - ((int32_t)1 << 27), middle, middle, middle, cell));
    TEST_ASSERT_FALSE(is_clear(middle, middle, middle, far - ((int32_t)1 << 27), cell));
}

static void test_unknown_cells_follow_the_configuration(void)
{
    for (int free = 0; free < 2; free++) {
        start(SIDE, SIDE, UNITS, free != 0);
        set(20, 20, JP_CELL_UNKNOWN);
        TEST_ASSERT_TRUE(is_clear(10 * CELL, 17 * CELL, 30 * CELL, 17 * CELL, 3 * CELL));
        TEST_ASSERT_TRUE(is_clear(10 * CELL, 18 * CELL, 30 * CELL, 18 * CELL, 3 * CELL) == (free != 0));
        TEST_ASSERT_TRUE(is_clear(10 * CELL, 10 * CELL, 30 * CELL, 30 * CELL, SMALLEST) == (free != 0));
        set(20, 20, JP_CELL_OCCUPIED);
        TEST_ASSERT_FALSE(is_clear(10 * CELL, 18 * CELL, 30 * CELL, 18 * CELL, 3 * CELL));
    }
}

/* Touching no more of it. */
static void test_lines_through_a_corner(void)
{
    const int32_t corner = 20 * CELL;

    set(20, 20, JP_CELL_OCCUPIED);
    for (int32_t along = 1; along < 8 * CELL; along += 97) {
        const int32_t across = 8 * CELL - along;

        TEST_ASSERT_FALSE(is_clear(corner - along, corner + across, corner + along, corner - across, SMALLEST));
        TEST_ASSERT_FALSE(is_clear(corner - along, corner - across, corner, corner, SMALLEST));
    }
    /* Past it: √2 · 512 = 724.1 of a cell, to either side. */
    expect_touch((struct jp_point){16 * CELL - CELL, 24 * CELL}, (struct jp_point){24 * CELL - CELL, 16 * CELL}, 723);
    TEST_ASSERT_FALSE(is_clear(16 * CELL - 350, 24 * CELL, 24 * CELL - 350, 16 * CELL, SMALLEST));
    TEST_ASSERT_TRUE(is_clear(16 * CELL - 365, 24 * CELL, 24 * CELL - 365, 16 * CELL, SMALLEST));
}

/* However it runs through a cell, a corner, an end or the middle is near. */
static void test_the_smallest_radius_finds_each_cell_that_is_crossed(void)
{
    set(20, 20, JP_CELL_OCCUPIED);
    for (int i = 0; i < 3000; i++) {
        const int32_t x = between(20 * CELL, 21 * CELL);
        const int32_t y = between(20 * CELL, 21 * CELL);
        const int32_t along = between(-8 * CELL, 8 * CELL);
        const int32_t across = between(-8 * CELL, 8 * CELL);

        TEST_ASSERT_FALSE(is_clear(x - along, y - across, x + along, y + across, SMALLEST));
    }
}

/* About a cell long, it passes at 10 413, which it must be divided by more exactly than to a unit to say. */
static void test_a_short_line_far_from_a_cell(void)
{
    set(20, 20, JP_CELL_OCCUPIED);
    TEST_ASSERT_TRUE(is_clear(28583, 12828, 27822, 12187, 10411));
    TEST_ASSERT_FALSE(is_clear(28583, 12828, 27822, 12187, 10415));
}
