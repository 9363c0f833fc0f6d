/* Parts of the grid planner: its memory, its queue, jump points against the plain search on random maps, prices of
 * lines and steps in all directions, and ends of its work in slices of any size. */
#include "src/search/grid_path.h"
#include "tests/support/grid_rig.h"

#define METRE JP_Q16(32)

static struct jp_grid_prices prices;
static uint32_t seed;

void setUp(void)
{
    rig_reset();
    seed = 1;
    prices = (struct jp_grid_prices){.metre = METRE, .ring = CELL, .near = {4 * METRE, 2 * METRE, METRE}};
}

void tearDown(void)
{
}

static uint32_t pick(uint32_t bound)
{
    seed = seed * UINT32_C(1664525) + UINT32_C(1013904223);
    return (uint32_t)(((uint64_t)(seed >> 8) * bound) >> 24);
}

/* ---- Memory ---- */

static const uint8_t *end_of(const void *first, size_t bytes)
{
    return (const uint8_t *)first + bytes;
}

/* Nodes, planes, paths and queue follow one another in the block, each aligned, none over another. */
static void test_parts_of_the_block(void)
{
    for (uint16_t width = 1; width <= 18; width += 17) {
        for (uint16_t height = 3; height <= 12; height += 3) {
            map = (struct jp_terrain_config){.width = width, .height = height, .resolution = CELL};
            make_level_map(&map);
            start_planner();
            const struct jp_grid_planner_internal *inner = &planner.internal;
            const size_t cells = (size_t)width * height;
            const size_t points = inner->points_max * sizeof(struct jp_point);
            TEST_ASSERT_EQUAL_PTR(block, inner->nodes);
            TEST_ASSERT_TRUE((const uint8_t *)inner->rows >= end_of(inner->nodes, cells * sizeof *inner->nodes));
            TEST_ASSERT_TRUE((const uint8_t *)inner->columns >= end_of(inner->rows, (height + 2U) * 4U));
            TEST_ASSERT_TRUE((const uint8_t *)inner->path.points >= end_of(inner->columns, (width + 2U) * 4U));
            TEST_ASSERT_TRUE((const uint8_t *)inner->candidate.points >= end_of(inner->path.points, points));
            TEST_ASSERT_TRUE((const uint8_t *)inner->queue >= end_of(inner->candidate.points, points));
            TEST_ASSERT_TRUE(end_of(inner->queue, inner->queue_max * sizeof *inner->queue) <=
                             end_of(block, jp_grid_planner_size(&config, &map)));
            TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)((uintptr_t)inner->rows % 4));
            TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)((uintptr_t)inner->columns % 4));
            TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)((uintptr_t)inner->path.points % 4));
            TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)((uintptr_t)inner->queue % 4));
            TEST_ASSERT_NULL(inner->config.prices);
        }
    }
}

/* 9.3 bytes a cell in all, of which 8 are the nodes', and 32 for each row and column. */
static void test_bytes_of_a_large_map(void)
{
    map = (struct jp_terrain_config){.width = 1024, .height = 512, .resolution = CELL};
    const size_t cells = (size_t)map.width * map.height;
    const size_t lines = (size_t)map.width + map.height;
    const size_t bytes = jp_grid_planner_size(&config, &map);

    TEST_ASSERT_TRUE(bytes >= cells * 9 + cells / 4 + 32 * lines);
    TEST_ASSERT_TRUE(bytes <= cells * 9 + cells / 4 + 42 * lines + 1024);
}

/* The caller's prices are not kept: they may be gone after init. */
static void test_prices_are_read_by_init_alone(void)
{
    config.prices = &prices;
    start_planner();
    TEST_ASSERT_NULL(planner.internal.config.prices);
    prices.metre = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 0, 7, 7));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(50));
    TEST_ASSERT_TRUE(jp_grid_planner_price(&planner) > 0);
}

/* ---- Queue ---- */

static bool is_searching(void)
{
    return planner.internal.phase == JP_GRID_SEARCH;
}

static void put(int32_t x, int32_t y, uint32_t cost)
{
    jp_grid_node(&planner.internal, x, y)->g = cost;
    TEST_ASSERT_TRUE(jp_grid_queue_put(&planner.internal, x, y, 0));
}

/* The least first, whatever the order in which they came, also where a cell's cost has fallen in between; each once. */
static void test_queue_gives_the_least_first(void)
{
    for (int round = 0; round < 20; round++) {
        uint32_t last = 0;
        uint32_t count = 0;
        int32_t x;
        int32_t y;
        begin(JP_GRID_OCTILE, 0, 0, 7, 7);
        work_until(is_searching);
        TEST_ASSERT_TRUE(jp_grid_queue_take(&planner.internal, &x, &y)); /* the start */
        for (int32_t i = 0; i < 60; i++) {
            put(i % 8, i / 8, 1000 + pick(1000));
        }
        for (int32_t i = 0; i < 60; i += 3) {
            put(i % 8, i / 8, jp_grid_node(&planner.internal, i % 8, i / 8)->g - pick(900));
        }
        while (jp_grid_queue_take(&planner.internal, &x, &y)) {
            const struct jp_grid_node *node = jp_grid_node(&planner.internal, x, y);
            TEST_ASSERT_TRUE(node->g >= last);
            TEST_ASSERT_TRUE(jp_grid_is_settled(node));
            last = node->g;
            count++;
        }
        TEST_ASSERT_EQUAL_UINT32(60, count);
    }
}

/* ---- Jump points ---- */

/* At random an eighth of the cells of a long map is blocked, but for the ends. */
static void make_random_map(uint16_t width, uint16_t height)
{
    map = (struct jp_terrain_config){.width = width, .height = height, .resolution = CELL};
    make_level_map(&map);
    for (int32_t i = 2; i + 2 < width * height; i++) {
        if (pick(8) == 0) {
            put_column(i % width, i / width, i / width, JP_CELL_OCCUPIED);
        }
    }
}

/* They give what the plain search does: the same length, or that there is no way. */
static void test_jump_points_keep_the_optimum(void)
{
    int found = 0;

    for (int round = 0; round < 60; round++) {
        jp_q16 lengths[2];
        enum jp_grid_answer answers[2];
        make_random_map(round % 2 == 0 ? 70 : 4, round % 2 == 0 ? 4 : 70);
        const int x = map.width - 1;
        const int y = map.height - 1;
        for (int method = 0; method < 2; method++) {
            if (round % 4 < 2) {
                begin((enum jp_grid_method)method, 0, 0, x, y);
            } else {
                begin((enum jp_grid_method)method, x, y, 0, 0);
            }
            answers[method] = finish(100);
            lengths[method] = jp_grid_planner_statistics(&planner)->octile_length;
        }
        TEST_ASSERT_EQUAL_INT(answers[0], answers[1]);
        TEST_ASSERT_EQUAL_INT32(lengths[0], lengths[1]);
        found += answers[0] == JP_GRID_FOUND;
    }
    TEST_ASSERT_TRUE(found > 10 && found < 60);
}

/* ---- Prices in all directions ---- */

static jp_elevation slanted(int32_t x, int32_t y)
{
    return (jp_elevation)(11 * x + 29 * y); /* of a cell of 205 units */
}

static bool has_rings(void)
{
    return planner.internal.has_rings;
}

/* A plane has one grade in each direction: what a step over it costs is what a long line does. */
static void test_steps_cost_what_lines_do(void)
{
    map = (struct jp_terrain_config){.width = 11, .height = 11, .resolution = CELL, .has_elevation = true};
    make_level_map(&map);
    raise_map(slanted);
    for (int i = 0; i < (int)JP_GRID_GRADES; i++) {
        prices.slope[i] = (jp_q16)((i < 16 ? 2 * (16 - i) : i - 16) * (METRE / 4));
    }
    memset(prices.near, 0, sizeof prices.near);
    config.prices = &prices;
    begin(JP_GRID_ANY_ANGLE, 0, 0, 1, 0);
    work_until(has_rings);
    for (unsigned direction = 0; direction < GRID_DIRECTIONS; direction++) {
        const struct jp_grid_direction *d = &jp_grid_directions[direction];
        const struct jp_point from = centre(5, 5);
        const struct jp_point to = centre(5 + 4 * d->dx, 5 + 4 * d->dy);
        const uint32_t line = jp_grid_line_cost(&planner.internal, &from, &to);
        const uint32_t step = jp_grid_step_cost(&planner.internal, 5, 5, direction);
        TEST_ASSERT_UINT32_WITHIN(line / 100, line, 4 * step);
    }
}

/* A line costs the same there and back, also where it begins on the border of a cell; and as much work. */
static void test_lines_cost_the_same_back(void)
{
    map.width = 9;
    map.height = 9;
    make_level_map(&map);
    config.prices = &prices;
    begin(JP_GRID_ANY_ANGLE, 0, 0, 1, 0);
    work_until(has_rings);
    for (int i = 0; i < 60; i++) {
        const struct jp_point from = {(jp_q16)pick(19) * CELL / 2, (jp_q16)pick(19) * CELL / 2};
        const struct jp_point to = {(jp_q16)pick(19) * CELL / 2, (jp_q16)pick(18) * CELL / 2 + 11};
        const uint64_t there = jp_grid_line_price(&planner.internal, &from, &to);
        const uint64_t back = jp_grid_line_price(&planner.internal, &to, &from);
        if (from.x % CELL != 0 || from.x != to.x) {
            TEST_ASSERT_UINT32_WITHIN((uint32_t)(there / 500 + 60), (uint32_t)there, (uint32_t)back);
        }
        TEST_ASSERT_EQUAL_UINT32(jp_grid_line_units(&planner.internal, &from, &to),
                                 jp_grid_line_units(&planner.internal, &to, &from));
    }
}

/* A unit for every four cells, along both axes. */
static void test_work_of_a_line(void)
{
    const struct jp_point middle = centre(4, 4);

    map.width = 9;
    map.height = 9;
    make_level_map(&map);
    config.prices = &prices;
    start_planner();
    for (int i = 0; i < 4; i++) {
        const struct jp_point corner = centre(i % 2 * 8, i / 2 * 8);
        TEST_ASSERT_EQUAL_UINT32(1 + 8 / 4, jp_grid_line_units(&planner.internal, &middle, &corner));
    }
    TEST_ASSERT_EQUAL_UINT32(1, jp_grid_line_units(&planner.internal, &middle, &middle));
    config.prices = NULL;
    start_planner();
    TEST_ASSERT_EQUAL_UINT32(1, jp_grid_line_units(&planner.internal, &middle, &(struct jp_point){0, 0}));
}

/* ---- Ends of the work ---- */

static bool is_spreading(void)
{
    return planner.internal.counts.edge_nodes > 0;
}

static bool is_descending(void)
{
    return planner.internal.candidate.count > 0;
}

static void begin_round_a_corner(bool (*is_there)(void))
{
    DRAW(".......", //
         ".......", //
         "...@...", //
         "...@...");
    begin(JP_GRID_ANY_ANGLE, 0, 0, 6, 1);
    work_until(is_there);
}

/* Where the search over edges ends in vain, the way by shortcuts is the answer, whatever is left of the slice. */
static void test_vain_ends_in_one_slice(void)
{
    for (int end = 0; end < 4; end++) {
        begin_round_a_corner(end < 2 ? is_spreading : is_descending);
        const struct jp_point *shortcuts = planner.internal.path.points;
        struct jp_grid_planner_internal *inner = &planner.internal;
        inner->queue_max = end == 0 ? inner->queue_count : inner->queue_max;
        if (end == 1) {
            jp_grid_node(inner, 0, 0)->place &= ~GRID_IN_TUBE;
        }
        inner->points_max = end == 2 ? 2 : inner->points_max;
        inner->place_cost = end == 3 ? 1 : inner->place_cost;
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, jp_grid_planner_work(&planner, 500));
        TEST_ASSERT_EQUAL_PTR(shortcuts, inner->path.points);
        (void)expect_way(0, 0, 6, 1);
    }
}

/* One slice is enough that is as large as what the header says of the work. */
static void test_work_of_a_search(void)
{
    for (enum jp_grid_method method = JP_GRID_OCTILE; method <= JP_GRID_ANY_ANGLE; method++) {
        for (int is_priced = 0; is_priced < 2; is_priced++) {
            begin_round_a_corner(is_searching);
            config.prices = is_priced == 1 && method != JP_GRID_JUMP_POINTS ? &prices : NULL;
            begin(method, 0, 0, 6, 1);
            TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, jp_grid_planner_work(&planner, 900));
            (void)expect_way(0, 0, 6, 1);
        }
    }
}

/* ---- The heuristic ---- */

/* On open ground it says what is left, so that no node is opened that is not on a best way. */
static void test_open_ground_is_crossed_without_detours(void)
{
    for (int32_t start = 0; start < 64; start += 5) {
        for (int32_t goal = 0; goal < 64; goal += 3) {
            const int32_t dx = goal % 8 > start % 8 ? goal % 8 - start % 8 : start % 8 - goal % 8;
            const int32_t dy = goal / 8 > start / 8 ? goal / 8 - start / 8 : start / 8 - goal / 8;

            begin(JP_GRID_OCTILE, start % 8, start / 8, goal % 8, goal / 8);
            TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(50));
            TEST_ASSERT_LESS_OR_EQUAL_UINT32((dx > dy ? dx : dy) + 1, planner.internal.counts.expansions);
        }
    }
}
