/* The steps by which the grid planner's way descends, against all points around; what its parts take of the budget; and
 * that neither slices nor the tasks before leave a trace. */
#include "src/search/grid_edges.h"
#include "src/search/grid_path.h"
#include "tests/support/grid_rig.h"

#define METRE JP_Q16(32)

enum { PARTS = 32 /* of an edge, over which a better step is sought */, ONE = 65536, POINTS_KEPT = 12 };

static struct jp_grid_prices prices;
static uint32_t seed;

void setUp(void)
{
    rig_reset();
    seed = 1;
    prices = (struct jp_grid_prices){.metre = METRE, .ring = CELL, .near = {2 * METRE, METRE}};
}

void tearDown(void)
{
}

static uint32_t pick(uint32_t bound)
{
    seed = seed * UINT32_C(1664525) + UINT32_C(1013904223);
    return (uint32_t)(((uint64_t)(seed >> 8) * bound) >> 24);
}

static void draw_rooms(void)
{
    DRAW("...........", //
         "....@......", //
         "....@..@@@.", //
         "..@@@..@...", //
         ".......@...", //
         "...........", //
         "..@.....@..", //
         "..@.....@..");
}

/* ---- Steps of the descent ---- */

static bool is_settled(int32_t x, int32_t y)
{
    return jp_terrain_contains(&terrain, x, y) && jp_grid_is_settled(jp_grid_node(&planner.internal, x, y));
}

static uint32_t cost_at(int32_t x, int32_t y)
{
    return jp_grid_node(&planner.internal, x, y)->g;
}

static struct jp_point point_of(const struct jp_point *place)
{
    return (struct jp_point){(int32_t)(((int64_t)place->x * CELL) >> 16) + CELL / 2,
                             (int32_t)(((int64_t)place->y * CELL) >> 16) + CELL / 2};
}

/* The cost-to-go from a point of an edge, and that of the line to it; UINT32_MAX: no step leads there. */
static uint32_t total_over(const struct jp_point *from, uint32_t from_cost, int32_t x, int32_t y, bool is_north,
                           int32_t part)
{
    const int32_t x1 = x + (is_north ? 0 : 1);
    const int32_t y1 = y + (is_north ? 1 : 0);

    if ((part < PARTS && !is_settled(x, y)) || (part > 0 && !is_settled(x1, y1))) {
        return UINT32_MAX;
    }
    const int64_t first = part < PARTS ? cost_at(x, y) : 0;
    const int64_t second = part > 0 ? cost_at(x1, y1) : 0;
    const uint32_t cost = (uint32_t)((first * (PARTS - part) + second * part) / PARTS);
    const struct jp_point place = {x * ONE + (is_north ? 0 : part * (ONE / PARTS)),
                                   y * ONE + (is_north ? part * (ONE / PARTS) : 0)};
    const struct jp_point a = point_of(from);
    const struct jp_point b = point_of(&place);

    if (cost >= from_cost || (a.x == b.x && a.y == b.y) || !jp_grid_planner_line_is_free(&planner, &a, &b)) {
        return UINT32_MAX;
    }
    return cost + jp_grid_line_cost(&planner.internal, &a, &b);
}

/* Over all edges of the squares that a place touches, but for those that it lies on; at every `pace` of their parts. */
static uint32_t least_around(const struct jp_point *from, uint32_t from_cost, int32_t pace)
{
    const int32_t x = from->x / ONE;
    const int32_t y = from->y / ONE;
    const int32_t first_x = from->x % ONE == 0 ? x - 1 : x;
    const int32_t first_y = from->y % ONE == 0 ? y - 1 : y;
    uint32_t least = UINT32_MAX;

    for (int32_t i = first_x; i <= x + 1; i++) {
        for (int32_t j = first_y; j <= y + 1; j++) {
            for (int32_t part = 0; part <= PARTS; part += pace) {
                const uint32_t east =
                    i <= x && j * ONE != from->y ? total_over(from, from_cost, i, j, false, part) : UINT32_MAX;
                const uint32_t north =
                    j <= y && i * ONE != from->x ? total_over(from, from_cost, i, j, true, part) : UINT32_MAX;

                least = east < least ? east : least;
                least = north < least ? north : least;
            }
        }
    }
    return least;
}

static bool is_descending(void)
{
    return planner.internal.phase == JP_GRID_DESCEND;
}

/* Each step leads to the best point around, to a thousandth of a cell. Returns how many there were. */
static unsigned expect_best_steps(int32_t pace)
{
    const struct jp_grid_planner_internal *inner = &planner.internal;
    unsigned steps = 0;

    work_until(is_descending);
    while (is_descending()) {
        const struct jp_point before = inner->place;
        const uint32_t before_cost = inner->place_cost;

        TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 1));
        if (before_cost > 0U && is_descending()) {
            const struct jp_point a = point_of(&before);
            const struct jp_point b = point_of(&inner->place);
            const uint32_t total = inner->place_cost + jp_grid_line_cost(inner, &a, &b);
            const uint32_t least = least_around(&before, before_cost, pace);

            TEST_ASSERT_TRUE(inner->place_cost < before_cost);
            TEST_ASSERT_INT32_WITHIN(ONE, before.x, inner->place.x);
            TEST_ASSERT_INT32_WITHIN(ONE, before.y, inner->place.y);
            TEST_ASSERT_TRUE(least < UINT32_MAX);
            TEST_ASSERT_LESS_OR_EQUAL_UINT32(least + inner->straight / 1000U, total);
            steps++;
        }
    }
    return steps;
}

/* Where all ground is alike. Where it is not, a step is at least as good as one to any node around. */
static void test_each_step_leads_to_the_best_point_around(void)
{
    static const int8_t ends[][4] = {{0, 0, 10, 7}, {10, 7, 0, 0}, {0, 7, 10, 0}, {10, 0, 0, 7},
                                     {8, 4, 3, 5},  {3, 5, 8, 4},  {5, 7, 4, 0},  {0, 3, 10, 4}};
    unsigned steps = 0;

    draw_rooms();
    config.tube = 4;
    for (unsigned kind = 0; kind < 3U; kind++) {
        for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
            if (kind == 1U) {
                memset(prices.near, 0, sizeof prices.near);
            } else {
                prices.near[0] = 2 * METRE;
                prices.near[1] = METRE;
            }
            config.prices = kind > 0U ? &prices : NULL;
            begin(JP_GRID_ANY_ANGLE, ends[i][0], ends[i][1], ends[i][2], ends[i][3]);
            steps += expect_best_steps(kind == 2U ? PARTS : 1);
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(120, steps);
}

/* What lies beyond cells that meet corner to corner is not reached between them. */
static void test_no_cost_passes_between_two_that_meet(void)
{
    for (int i = 0; i < 2; i++) {
        DRAW("....@...", //
             "...@....", //
             "..@.....", //
             ".@......", //
             "@.......");
        config.tube = 4;
        begin(JP_GRID_ANY_ANGLE, 1, 0, i == 0 ? 7 : 5, i == 0 ? 0 : 4);
        work_until(is_descending);
        for (int32_t y = 0; y < map.height; y++) {
            for (int32_t x = 0; x < map.width; x++) {
                TEST_ASSERT_FALSE(x < y && is_settled(x, y));
            }
        }
    }
}

/* ---- What is taken of the budget ---- */

static enum jp_grid_phase awaited;

static bool is_awaited(void)
{
    return planner.internal.phase == awaited;
}

/* Units of one until a phase is over. */
static unsigned units_of(enum jp_grid_phase phase)
{
    unsigned units = 0;

    awaited = phase;
    work_until(is_awaited);
    while (planner.internal.phase == phase && jp_grid_planner_work(&planner, 1) == JP_GRID_SEARCHING) {
        units++;
    }
    return units;
}

static void make_open_map(void)
{
    map = (struct jp_terrain_config){.width = 15, .height = 12, .resolution = CELL};
    make_level_map(&map);
}

/* Of the tube's squares a unit for each row: around a point for each cell of the way along its longer side, and one
 * more at either end. */
static void test_work_of_the_tube(void)
{
    static const int8_t ends[][4] = {{2, 5, 12, 5}, {12, 5, 2, 5}, {7, 1, 7, 9},
                                     {7, 9, 7, 1},  {2, 2, 12, 5}, {12, 5, 9, 10}};

    make_open_map();
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        const unsigned dx = (unsigned)(ends[i][0] < ends[i][2] ? ends[i][2] - ends[i][0] : ends[i][0] - ends[i][2]);
        const unsigned dy = (unsigned)(ends[i][1] < ends[i][3] ? ends[i][3] - ends[i][1] : ends[i][1] - ends[i][3]);
        const unsigned cells = dx > dy ? dx : dy;

        begin(JP_GRID_ANY_ANGLE, ends[i][0], ends[i][1], ends[i][2], ends[i][3]);
        const unsigned units = units_of(JP_GRID_MARK);

        TEST_ASSERT_EQUAL_UINT32(2, planner.internal.path.count);
        TEST_ASSERT_EQUAL_UINT32((cells + 2U) * 5U, units);
    }
}

/* A unit for each cell; with prices also one for every four cells of the line to each, by which it may be shortened: as
 * much is done in a slice, and no more. */
static void test_work_of_the_trace(void)
{
    enum { CELLS = 13, ROW = 5 };

    make_open_map();
    memset(prices.near, 0, sizeof prices.near);
    for (unsigned is_priced = 0; is_priced < 2U; is_priced++) {
        config.prices = is_priced == 1U ? &prices : NULL;
        begin(JP_GRID_ANY_ANGLE, 1, ROW, CELLS, ROW);
        awaited = JP_GRID_TRACE;
        work_until(is_awaited); /* and over the first cell */
        for (unsigned i = 1; i < CELLS; i++) {
            TEST_ASSERT_TRUE(is_awaited());
            TEST_ASSERT_EQUAL_UINT32((uint32_t)ROW * map.width + CELLS - i, planner.internal.cursor);
            TEST_ASSERT_EQUAL_UINT32(i < 2U ? 1U : 2U, planner.internal.path.count);
            (void)jp_grid_planner_work(&planner, i >= 2U && is_priced == 1U ? 1U + i / 4U : 1U);
        }
        TEST_ASSERT_EQUAL_INT(JP_GRID_TIGHTEN, planner.internal.phase);
    }
}

/* A straight way is looked at from both ends. */
static void test_work_of_tightening(void)
{
    make_open_map();
    begin(JP_GRID_ANY_ANGLE, 1, 5, 13, 5);
    TEST_ASSERT_EQUAL_UINT32(2, units_of(JP_GRID_TIGHTEN));
    TEST_ASSERT_EQUAL_UINT32(2, planner.internal.passes);
}

/* ---- Slices, and tasks one after the other ---- */

struct outcome {
    struct jp_point points[POINTS_KEPT];
    size_t count;
    struct jp_grid_counts counts;
    jp_energy price;
};

static struct outcome outcome_of(enum jp_grid_answer answer)
{
    struct outcome outcome = {0};
    const struct jp_point *way = jp_grid_planner_path(&planner, &outcome.count);

    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, answer);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(POINTS_KEPT, (uint32_t)outcome.count);
    memcpy(outcome.points, way, outcome.count * sizeof *way);
    outcome.counts = *jp_grid_planner_statistics(&planner);
    outcome.price = jp_grid_planner_price(&planner);
    return outcome;
}

static void expect_same(const struct outcome *expected, const struct outcome *other)
{
    TEST_ASSERT_EQUAL_UINT32((uint32_t)expected->count, (uint32_t)other->count);
    TEST_ASSERT_EQUAL_MEMORY(expected->points, other->points, expected->count * sizeof *expected->points);
    TEST_ASSERT_EQUAL_UINT32(expected->counts.expansions, other->counts.expansions);
    TEST_ASSERT_EQUAL_UINT32(expected->counts.edge_nodes, other->counts.edge_nodes);
    TEST_ASSERT_EQUAL_UINT32(expected->counts.queue_most, other->counts.queue_most);
    TEST_ASSERT_EQUAL_INT32(expected->counts.octile_length, other->counts.octile_length);
    TEST_ASSERT_TRUE(expected->price == other->price);
}

static void draw_pillars(void)
{
    DRAW("...............", //
         ".....@.........", //
         "...@.....@.....", //
         ".......@...@...", //
         "..@............", //
         "....@...@...@..", //
         "..........@....", //
         "......@........");
}

/* Of any method, with prices and without, the way and what was counted are the same in any slices, and of a planner
 * that has had another task before. */
static void test_neither_slices_nor_other_tasks_change_a_way(void)
{
    draw_pillars();
    for (int i = 0; i < 12; i++) {
        const enum jp_grid_method method = (enum jp_grid_method)(i % 3);
        const int from_y = (int)pick(8);
        const int to_y = (int)pick(8);

        config.prices = i % 2 == 0 && method != JP_GRID_JUMP_POINTS ? &prices : NULL;
        begin(method, 0, from_y, 14, to_y);
        const struct outcome whole = outcome_of(finish(100000));
        for (unsigned slice = 1; slice < 60; slice += 1 + 3 * slice) {
            begin(method, 0, from_y, 14, to_y);
            const struct outcome other = outcome_of(finish(slice));
            expect_same(&whole, &other);
        }
        begin(method, 14, 3, 0, 6);
        (void)finish(17);
        TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, from_y, 14, to_y));
        const struct outcome later = outcome_of(finish(5));
        expect_same(&whole, &later);
    }
}

/* ---- Disc ---- */

static bool disc_holds(int32_t x, int32_t y)
{
    for (unsigned i = 0; i < planner.internal.disc_rows; i++) {
        const struct jp_span *row = &planner.internal.disc[i];

        if (row->y == y && row->first <= x && row->last >= x) {
            return true;
        }
    }
    return false;
}

/* Twice the distance at which a cell begins, along an axis, in cells. */
static int64_t begin_of(int32_t cell)
{
    return cell == 0 ? 0 : 2 * (int64_t)(cell < 0 ? -cell : cell) - 1;
}

static bool is_nearer(int32_t x, int32_t y, int64_t clearance)
{
    const int64_t square = begin_of(x) * begin_of(x) + begin_of(y) * begin_of(y);

    return square * map.resolution * map.resolution < 4 * clearance * clearance || (x == 0 && y == 0);
}

/* It holds all cells that begin nearer than the clearance, and none that begins farther, to 2⁻¹⁶ of a cell. */
static void test_disc_holds_what_is_nearer_than_the_clearance(void)
{
    static const jp_q16 resolutions[] = {JP_Q16(0.25), JP_Q16(2), 3277, JP_Q16(1.5)};

    for (size_t k = 0; k < sizeof resolutions / sizeof *resolutions; k++) {
        map.resolution = resolutions[k];
        make_level_map(&map);
        for (int32_t i = 0; i < 60; i++) {
            const jp_q16 half = map.resolution / 2;

            config.clearance =
                (i % 3 == 0 ? i * half : (i % 3 == 1 ? i * half / 2 : i * 577)) % (4 * map.resolution) + i % 4;
            start_planner();
            for (int32_t cell = 0; cell < 121; cell++) {
                const int32_t x = cell % 11 - 5;
                const int32_t y = cell / 11 - 5;

                TEST_ASSERT_TRUE(!is_nearer(x, y, config.clearance) || disc_holds(x, y));
                TEST_ASSERT_TRUE(is_nearer(x, y, config.clearance + map.resolution / 65536 + 1) || !disc_holds(x, y));
            }
        }
    }
}

/* ---- Queue ---- */

static bool is_searching(void)
{
    return planner.internal.phase == JP_GRID_SEARCH;
}

/* Of equal keys the cell of the greatest cost comes first, and then by row and column. */
static void test_order_of_equal_keys(void)
{
    for (unsigned round = 0; round < 20; round++) {
        int32_t x = 0;
        int32_t y = 0;
        uint32_t last_cost = UINT32_MAX;
        int32_t last_cell = -1;

        begin(JP_GRID_OCTILE, 0, 0, 7, 7);
        work_until(is_searching);
        TEST_ASSERT_TRUE(jp_grid_queue_take(&planner.internal, &x, &y)); /* the start */
        for (int32_t i = 0; i < 50; i++) {
            const int32_t cell = (i * 37 + (int32_t)round * 11) % 64;
            const uint32_t cost = 100U * (1U + pick(4));

            jp_grid_node(&planner.internal, cell % 8, cell / 8)->g = cost;
            TEST_ASSERT_TRUE(jp_grid_queue_put(&planner.internal, cell % 8, cell / 8, 1000U - cost));
        }
        for (int32_t i = 0; i < 50; i++) {
            TEST_ASSERT_TRUE(jp_grid_queue_take(&planner.internal, &x, &y));
            const uint32_t cost = cost_at(x, y);

            TEST_ASSERT_TRUE(cost < last_cost || (cost == last_cost && y * 8 + x > last_cell));
            last_cost = cost;
            last_cell = y * 8 + x;
        }
        TEST_ASSERT_FALSE(jp_grid_queue_take(&planner.internal, &x, &y));
    }
}

/* ---- Cells of a unit ---- */

static void test_work_of_looking_at_all_cells(void)
{
    make_open_map();
    config.prices = &prices;
    begin(JP_GRID_ANY_ANGLE, 1, 5, 13, 5);
    TEST_ASSERT_EQUAL_UINT32((15U * 12U + 7U) / 8U, units_of(JP_GRID_FILL_PLANES));
    TEST_ASSERT_EQUAL_UINT32((15U * 12U + 7U) / 8U, units_of(JP_GRID_MEASURE));
    TEST_ASSERT_EQUAL_UINT32((15U * 12U + 7U) / 8U, units_of(JP_GRID_MEASURE_BACK));
    TEST_ASSERT_EQUAL_UINT32((15U * 12U + 63U) / 64U, units_of(JP_GRID_CLEAR));
    TEST_ASSERT_EQUAL_UINT32((15U * 12U + 63U) / 64U, units_of(JP_GRID_CLEAR_AGAIN));
}

/* Round the corner of a pillar, taut: at each of two passes eight lines from before the turn to behind it are tried, of
 * which each takes a unit, and with prices one more for every four cells; then the way is turned round. */
static void test_work_of_a_turn_that_cannot_be_moved(void)
{
    make_open_map();
    put_column(7, 0, 5, JP_CELL_OCCUPIED);
    memset(prices.near, 0, sizeof prices.near);
    for (unsigned is_priced = 0; is_priced < 2U; is_priced++) {
        struct jp_grid_planner_internal *inner = &planner.internal;
        unsigned budget = 1000;

        config.prices = is_priced == 1U ? &prices : NULL;
        begin(JP_GRID_ANY_ANGLE, 1, 0, 13, 1);
        awaited = JP_GRID_TIGHTEN;
        work_until(is_awaited);
        inner->path.count = 3;
        inner->path.points[0] = (struct jp_point){1 * CELL, 4 * CELL};
        inner->path.points[1] = (struct jp_point){7 * CELL, 6 * CELL};
        inner->path.points[2] = (struct jp_point){8 * CELL, 6 * CELL};
        inner->cursor = 1;
        inner->passes = 0;
        inner->has_changed = false;
        TEST_ASSERT_EQUAL_INT(GRID_DONE, jp_grid_path_tighten(inner, &inner->path, &budget));
        TEST_ASSERT_EQUAL_UINT32(3, inner->path.count);
        TEST_ASSERT_EQUAL_UINT32(2, inner->passes);
        TEST_ASSERT_EQUAL_INT32(7 * CELL, inner->path.points[1].x);
        TEST_ASSERT_EQUAL_UINT32(1000U - 2U * (8U * (is_priced == 1U ? 1U + 9U / 4U : 1U) + 1U), budget);
    }
}

/* ---- Rings ---- */

enum { RING_SIDE = 14 };

static uint8_t away[RING_SIDE + 2][RING_SIDE + 2];

static uint8_t lesser(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* Steps of 5 and 7 from the nearest cell that is blocked, or off the map, by relaxing all until nothing changes. */
static void measure_all(int32_t blocked_x, int32_t blocked_y)
{
    bool has_changed = true;

    memset(away, 0, sizeof away);
    for (int32_t i = 0; i < RING_SIDE * RING_SIDE; i++) {
        const int32_t x = i % RING_SIDE;
        const int32_t y = i / RING_SIDE;

        away[y + 1][x + 1] = x == blocked_x && y == blocked_y ? 0U : 200U;
    }
    while (has_changed) {
        has_changed = false;
        for (int32_t i = 0; i < RING_SIDE * RING_SIDE; i++) {
            const int32_t x = i % RING_SIDE + 1;
            const int32_t y = i / RING_SIDE + 1;
            uint8_t least = away[y][x];

            for (int32_t k = 0; k < 9; k++) {
                const bool is_diagonal = k % 2 == 0;

                if (k != 4) {
                    least = lesser(least, (uint8_t)(away[y + k / 3 - 1][x + k % 3 - 1] + (is_diagonal ? 7U : 5U)));
                }
            }
            has_changed = has_changed || least < away[y][x];
            away[y][x] = least;
        }
    }
}

/* A cell is in the first ring that reaches as far as it is away, whatever the rings' width is. */
static void test_rings_reach_as_far_as_cells_are_away(void)
{
    static const jp_q16 rings[] = {65536, 340787, 91750, 91751, 150000, 45875, 7 * 65536 / 5};

    map = (struct jp_terrain_config){.width = RING_SIDE, .height = RING_SIDE, .resolution = JP_Q16_ONE};
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        prices.near[i] = (jp_q16)(i + 1U) * METRE;
    }
    for (size_t k = 0; k < sizeof rings / sizeof *rings; k++) {
        make_level_map(&map);
        put_column(4, 9, 9, JP_CELL_OCCUPIED);
        measure_all(4, 9);
        prices.ring = rings[k];
        config.prices = &prices;
        begin(JP_GRID_ANY_ANGLE, 0, 0, 1, 0);
        awaited = JP_GRID_CLEAR;
        work_until(is_awaited);
        for (int32_t i = 0; i < RING_SIDE * RING_SIDE; i++) {
            const int64_t far = (int64_t)away[i / RING_SIDE + 1][i % RING_SIDE + 1] * 65536;
            uint32_t ring = 1;

            while (ring <= JP_GRID_RINGS && far > (int64_t)ring * rings[k] * 5) {
                ring++;
            }
            TEST_ASSERT_EQUAL_UINT32(256U * (1U + (ring <= JP_GRID_RINGS ? ring : 0U)),
                                     jp_grid_level_price(&planner.internal, i % RING_SIDE, i / RING_SIDE));
        }
    }
}

/* ---- Lengths ---- */

/* Where every metre has one price a line costs its length, to 2⁻²³ m, however short it is. */
static void test_lines_cost_their_length(void)
{
    make_open_map();
    memset(prices.near, 0, sizeof prices.near);
    config.prices = &prices;
    begin(JP_GRID_ANY_ANGLE, 1, 5, 13, 5);
    awaited = JP_GRID_SEARCH;
    work_until(is_awaited);
    for (int i = 0; i < 400; i++) {
        const struct jp_point from = {(jp_q16)pick(15 * CELL), (jp_q16)pick(12 * CELL)};
        const struct jp_point to = {i % 2 == 0 ? (jp_q16)pick(15 * CELL) : from.x + (jp_q16)pick(300) - 150,
                                    i % 2 == 0 ? (jp_q16)pick(12 * CELL) : from.y + (jp_q16)pick(300) - 150};
        const int64_t dx = to.x - from.x;
        const int64_t dy = to.y - from.y;
        const int64_t price = (int64_t)jp_grid_line_price(&planner.internal, &from, &to);
        const int64_t square = (dx * dx + dy * dy) * 65536;

        TEST_ASSERT_TRUE((price + 2) * (price + 2) > square);
        TEST_ASSERT_TRUE(price < 2 || (price - 2) * (price - 2) < square);
    }
}

/* ---- Runs ---- */

/* A run over open ground has no point at which it might turn, also where a word of the plane ends. */
static void test_open_runs_have_no_points_between(void)
{
    for (int i = 0; i < 2; i++) {
        map = (struct jp_terrain_config){.width = i == 0 ? 70 : 4, .height = i == 0 ? 4 : 70, .resolution = CELL};
        make_level_map(&map);
        for (int k = 0; k < 4; k++) {
            begin(JP_GRID_JUMP_POINTS, i == 0 ? 69 * (k % 2) : k, i == 0 ? k : 69 * (k % 2),
                  i == 0 ? 69 - 69 * (k % 2) : k, i == 0 ? k : 69 - 69 * (k % 2));
            TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
            TEST_ASSERT_EQUAL_UINT32(1, jp_grid_planner_statistics(&planner)->expansions);
        }
    }
}

/* ---- Memory ---- */

/* A bit for each cell and the border round the map, row by row and column by column; nothing between them. */
static void test_memory_of_the_planes(void)
{
    for (uint16_t width = 1; width <= 18; width++) {
        const uint16_t height = (uint16_t)(19U - width);

        map = (struct jp_terrain_config){.width = width, .height = height, .resolution = CELL};
        make_level_map(&map);
        start_planner();
        const struct jp_grid_planner_internal *inner = &planner.internal;
        const size_t rows = ((size_t)height + 2U) * 4U;
        const size_t columns = ((size_t)width + 2U) * 4U;

        TEST_ASSERT_EQUAL_PTR((uint8_t *)inner->rows + (rows + 7U) / 8U * 8U, inner->columns);
        TEST_ASSERT_EQUAL_PTR((uint8_t *)inner->columns + (columns + 7U) / 8U * 8U, inner->path.points);
        TEST_ASSERT_EQUAL_UINT32(2U * 19U + 16U, inner->points_max);
        TEST_ASSERT_EQUAL_PTR(&inner->path.points[inner->points_max], inner->candidate.points);
        TEST_ASSERT_EQUAL_PTR(&inner->candidate.points[inner->points_max], inner->queue);
    }
}

/* ---- Slopes ---- */

/* Of a grade in 1/1024 what is given of the grades 1/32 apart, linear between them; beyond one half as of one half. */
static uint32_t part_of_grade(int32_t grade)
{
    const int32_t within = grade < -512 ? -512 : grade > 512 ? 512 : grade;
    const int32_t index = (within + 512) / 32;
    const int32_t rest = (within + 512) % 32;
    const int64_t first = (int64_t)prices.slope[index] * 256 / METRE;
    const int64_t next = index < 32 ? (int64_t)prices.slope[index + 1] * 256 / METRE : 0;
    const int64_t more = (next - first) * rest;

    return (uint32_t)(first + (more >= 0 ? more / 32 : -((31 - more) / 32)));
}

/* A step up or down costs as much more as the map is steep there, for both of its halves; exactly along the axes. */
static void test_steps_cost_as_much_more_as_they_are_steep(void)
{
    map = (struct jp_terrain_config){.width = 5, .height = 5, .resolution = JP_Q16_ONE, .has_elevation = true};
    make_level_map(&map);
    memset(prices.near, 0, sizeof prices.near);
    for (unsigned i = 0; i < JP_GRID_GRADES; i++) {
        prices.slope[i] = (jp_q16)pick(6 * METRE);
    }
    config.prices = &prices;
    begin(JP_GRID_OCTILE, 0, 0, 1, 0);
    awaited = JP_GRID_SEARCH;
    work_until(is_awaited);
    for (int32_t rise = -600; rise <= 600; rise += 13) {
        for (unsigned direction = 0; direction < GRID_DIRECTIONS; direction++) {
            const struct jp_grid_direction *d = &jp_grid_directions[direction];
            const bool is_diagonal = direction % 2U != 0U;

            /* Of a diagonal step a plane that rises along it: over a corner half as high as its end. */
            for (int32_t i = 0; i < 25; i++) {
                const int32_t along = (i % 5 - 2) * d->dx + (i / 5 - 2) * d->dy;

                TEST_ASSERT_EQUAL_INT(JP_OK,
                                      jp_terrain_set_elevation(&terrain, i % 5, i / 5, (jp_elevation)(along * rise)));
            }
            const uint32_t cost = jp_grid_step_cost(&planner.internal, 2, 2, direction);

            if (!is_diagonal) {
                TEST_ASSERT_EQUAL_UINT32(4096U * (2U * 256U + 2U * part_of_grade(rise)) / 512U, cost);
            } else {
                const int32_t grade = (int32_t)(((int64_t)rise * 92682) >> 16); /* twice the rise over √2 */
                const uint32_t low = part_of_grade(grade);
                const uint32_t high = part_of_grade(grade + 1);
                const uint32_t least = low < high ? low : high;
                const uint32_t most = low < high ? high : low;

                TEST_ASSERT_GREATER_OR_EQUAL_UINT32(5793U * (256U + least) / 256U - 24U, cost);
                TEST_ASSERT_LESS_OR_EQUAL_UINT32(5793U * (256U + most) / 256U + 24U, cost);
            }
        }
    }
}

/* A line over a plane costs its length by the price of the plane's grade, there and back. */
static void test_lines_cost_as_much_more_as_they_are_steep(void)
{
    map = (struct jp_terrain_config){.width = 6, .height = 5, .resolution = JP_Q16_ONE, .has_elevation = true};
    make_level_map(&map);
    memset(prices.near, 0, sizeof prices.near);
    for (unsigned i = 0; i < JP_GRID_GRADES; i++) {
        prices.slope[i] = (jp_q16)pick(6 * METRE);
    }
    config.prices = &prices;
    begin(JP_GRID_OCTILE, 0, 0, 1, 0);
    awaited = JP_GRID_SEARCH;
    work_until(is_awaited);
    for (int32_t rise = -448; rise <= 448; rise += 32) {
        for (int32_t i = 0; i < 30; i++) {
            TEST_ASSERT_EQUAL_INT(JP_OK,
                                  jp_terrain_set_elevation(&terrain, i % 6, i / 6, (jp_elevation)(rise * (i % 6))));
        }
        for (int32_t length = 16384; length <= 4 * JP_Q16_ONE; length += 16384) {
            const struct jp_point from = {JP_Q16_ONE / 2, 2 * JP_Q16_ONE + 20000};
            const struct jp_point to = {from.x + length, from.y};
            const uint64_t up = (uint64_t)length * (256U + part_of_grade(rise));
            const uint64_t down = (uint64_t)length * (256U + part_of_grade(-rise));

            TEST_ASSERT_UINT32_WITHIN((uint32_t)(up / 300U), (uint32_t)up,
                                      (uint32_t)jp_grid_line_price(&planner.internal, &from, &to));
            TEST_ASSERT_UINT32_WITHIN((uint32_t)(down / 300U), (uint32_t)down,
                                      (uint32_t)jp_grid_line_price(&planner.internal, &to, &from));
        }
    }
}
