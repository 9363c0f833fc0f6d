/* How the grid planner works: within its budget; the tube that it looks at; the costs-to-go that it interpolates there,
 * and the way that they lead down. */
#include "src/search/grid_edges.h"
#include "src/search/grid_path.h"
#include "tests/support/grid_rig.h"

#define METRE JP_Q16(32)

enum { PARTS = 64 /* of an edge, over which a way is sought */ };

static struct jp_grid_prices prices;

void setUp(void)
{
    rig_reset();
    prices = (struct jp_grid_prices){.metre = METRE, .ring = CELL, .near = {2 * METRE, METRE}};
}

void tearDown(void)
{
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

/* ---- Budget ---- */

static uint32_t places(void)
{
    return planner.internal.phase == JP_GRID_DESCEND ? planner.internal.candidate.count : 0U;
}

/* No slice does more than it may, in cells, nodes and places; and each does something. */
static void expect_slices_of(unsigned slice)
{
    const struct jp_grid_counts *counts = jp_grid_planner_statistics(&planner);
    enum jp_grid_answer answer = JP_GRID_SEARCHING;

    for (int i = 0; answer == JP_GRID_SEARCHING; i++) {
        const struct jp_grid_counts before = *counts;
        const enum jp_grid_phase phase = planner.internal.phase;
        const uint32_t cursor = planner.internal.cursor;
        const uint32_t descended = places();
        TEST_ASSERT_TRUE(i < 2000);
        answer = jp_grid_planner_work(&planner, slice);
        TEST_ASSERT_TRUE(counts->expansions <= before.expansions + slice);
        TEST_ASSERT_TRUE(counts->edge_nodes <= before.edge_nodes + slice);
        if (phase == planner.internal.phase && phase >= JP_GRID_MEASURE && phase <= JP_GRID_CLEAR) {
            TEST_ASSERT_TRUE(planner.internal.cursor > cursor && planner.internal.cursor <= cursor + 64 * slice);
        }
        if (slice <= 8 && places() > 0) {
            TEST_ASSERT_TRUE(places() <= descended + 1);
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, answer);
}

static void test_slices_keep_to_their_budget(void)
{
    for (int is_priced = 0; is_priced < 2; is_priced++) {
        for (unsigned slice = 1; slice < 30; slice += 7) {
            draw_rooms();
            config.prices = is_priced == 1 ? &prices : NULL;
            begin(JP_GRID_ANY_ANGLE, 0, 0, 10, 0);
            expect_slices_of(slice);
            (void)expect_way(0, 0, 10, 0);
        }
    }
}

/* ---- Tube ---- */

static bool is_in_tube(int x, int y)
{
    return (jp_grid_node(&planner.internal, x, y)->place & GRID_IN_TUBE) != 0U;
}

static bool is_propagating(void)
{
    return planner.internal.phase == JP_GRID_PROPAGATE;
}

/* Around a straight way the tube is a box; what is blocked is not part of it. */
static void test_tube_round_a_straight_way(void)
{
    map = (struct jp_terrain_config){.width = 14, .height = 12, .resolution = CELL};
    for (int i = 0; i < 2; i++) {
        make_level_map(&map);
        put_column(4, 3, 3, JP_CELL_OCCUPIED);
        begin(JP_GRID_ANY_ANGLE, 3, 5, i == 0 ? 9 : 3, i == 0 ? 5 : 9);
        work_until(is_propagating);
        for (int y = 0; y < map.height; y++) {
            for (int x = 0; x < map.width; x++) {
                const bool is_near =
                    x >= 1 && x <= (i == 0 ? 11 : 5) && y >= 3 && y <= (i == 0 ? 7 : 11) && !(x == 4 && y == 3);
                TEST_ASSERT_EQUAL_INT(is_near, is_in_tube(x, y));
            }
        }
    }
}

/* Wherever the way leads, the cells beside it are in the tube, and none that is farther than its diagonal. */
static void test_tube_round_a_slanted_way(void)
{
    map = (struct jp_terrain_config){.width = 14, .height = 12, .resolution = CELL};
    make_level_map(&map);
    config.tube = 1;
    begin(JP_GRID_ANY_ANGLE, 1, 2, 12, 8);
    work_until(is_propagating);
    for (int y = 0; y < map.height; y++) {
        for (int x = 0; x < map.width; x++) {
            const int off = (y - 2) * 11 - (x - 1) * 6; /* 12.5 for a cell */
            const int away = off < 0 ? -off : off;
            const bool is_beside = x >= 1 && x <= 12;
            if (is_beside && away <= 11) {
                TEST_ASSERT_TRUE(is_in_tube(x, y));
            }
            if (away > 28) {
                TEST_ASSERT_FALSE(is_in_tube(x, y));
            }
        }
    }
}

/* ---- Cost-to-go ---- */

static bool is_settled(int x, int y)
{
    return jp_terrain_contains(&terrain, x, y) && jp_grid_is_settled(jp_grid_node(&planner.internal, x, y));
}

static uint32_t cost_at(int x, int y)
{
    return jp_grid_node(&planner.internal, x, y)->g;
}

/* Over the points of an edge from a straight to a diagonal neighbour, by what is interpolated there and the line to it:
 * √(1 + t²) cells. */
static uint32_t least_over_edge(uint32_t straight, uint32_t diagonal)
{
    uint32_t least = UINT32_MAX;

    for (uint32_t t = 0; t <= PARTS; t++) {
        const int64_t on_edge = straight + ((int64_t)diagonal - straight) * t / PARTS;
        const uint64_t line = jp_square_root(((uint64_t)PARTS * PARTS + t * t) << 32) / PARTS;
        const uint32_t cost = (uint32_t)on_edge + (uint32_t)line;
        least = cost < least ? cost : least;
    }
    return least;
}

/* The least over all edges round a node whose ends are settled and cheaper, in eight triangles. */
static uint32_t least_around(int x, int y)
{
    static const int8_t around[9][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
    uint32_t least = UINT32_MAX;

    for (int i = 0; i < 8; i++) {
        const int8_t *straight = around[i % 2 == 0 ? i : i + 1];
        const int8_t *diagonal = around[i % 2 == 0 ? i + 1 : i];
        const int sx = x + straight[0];
        const int sy = y + straight[1];
        const bool has_straight = is_settled(sx, sy) && cost_at(sx, sy) < cost_at(x, y);
        if (jp_grid_is_blocked(&planner.internal, sx, sy)) {
            continue;
        }
        const int dx = x + diagonal[0];
        const int dy = y + diagonal[1];
        const bool has_diagonal = is_settled(dx, dy) && cost_at(dx, dy) < cost_at(x, y);
        uint32_t cost = UINT32_MAX;
        if (has_straight && has_diagonal) {
            cost = least_over_edge(cost_at(sx, sy), cost_at(dx, dy));
        } else if (has_straight) {
            cost = cost_at(sx, sy) + GRID_STRAIGHT;
        } else if (has_diagonal) {
            cost = cost_at(dx, dy) + GRID_DIAGONAL;
        } else {
            /* nothing leads on over this edge */
        }
        least = cost < least ? cost : least;
    }
    return least;
}

static bool is_descending(void)
{
    return planner.internal.phase == JP_GRID_DESCEND;
}

static void test_costs_are_least_over_the_edges(void)
{
    int settled = 0;

    draw_rooms();
    config.tube = 8;
    begin(JP_GRID_ANY_ANGLE, 0, 0, 10, 7);
    work_until(is_descending);
    for (int y = 0; y < map.height; y++) {
        for (int x = 0; x < map.width; x++) {
            if (is_settled(x, y) && cost_at(x, y) > 0) {
                TEST_ASSERT_UINT32_WITHIN(GRID_STRAIGHT / 1000, least_around(x, y), cost_at(x, y));
                settled++;
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, cost_at(10, 7));
    TEST_ASSERT_TRUE(settled > 40);
}

/* ---- Descent ---- */

static bool is_down(void)
{
    return planner.internal.phase == JP_GRID_TIGHTEN_CANDIDATE;
}

/* Ends at start and goal, over free lines; and costs what the cost-to-go says, but for what interpolation is off. */
static void expect_descent(int start_x, int start_y, int goal_x, int goal_y, unsigned percent)
{
    begin(JP_GRID_ANY_ANGLE, start_x, start_y, goal_x, goal_y);
    work_until(is_down);
    const struct jp_grid_path *way = &planner.internal.candidate;
    uint32_t cost = 0;

    expect_point(&way->points[0], start_x, start_y);
    expect_point(&way->points[way->count - 1], goal_x, goal_y);
    for (uint32_t i = 1; i < way->count; i++) {
        TEST_ASSERT_TRUE(jp_grid_planner_line_is_free(&planner, &way->points[i - 1], &way->points[i]));
        cost += jp_grid_line_cost(&planner.internal, &way->points[i - 1], &way->points[i]);
    }
    const uint32_t to_go = cost_at(start_x, start_y);
    TEST_ASSERT_TRUE(cost <= to_go + to_go / 200);
    TEST_ASSERT_TRUE(cost >= to_go - to_go * percent / 100);
}

static void test_descents_cost_what_is_to_go(void)
{
    static const int8_t ends[][4] = {{0, 0, 10, 7}, {10, 7, 0, 0}, {0, 7, 10, 0}, {10, 0, 0, 7},
                                     {8, 4, 3, 5},  {3, 5, 8, 4},  {5, 7, 5, 0},  {0, 3, 10, 4}};

    draw_rooms();
    for (int is_priced = 0; is_priced < 2; is_priced++) {
        config.prices = is_priced == 1 ? &prices : NULL;
        config.tube = 4;
        for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
            expect_descent(ends[i][0], ends[i][1], ends[i][2], ends[i][3], is_priced == 1 ? 10 : 5);
        }
    }
}

/* ---- Paths ---- */

static void test_points_of_a_path(void)
{
    static const struct jp_point row[] = {{0, 0}, {CELL, 0}, {2 * CELL, 0}, {3 * CELL, CELL}, {4 * CELL, CELL}};
    struct jp_grid_path *path = &planner.internal.path;

    begin(JP_GRID_OCTILE, 0, 0, 7, 7);
    path->count = 0;
    for (size_t i = 0; i < 5; i++) {
        TEST_ASSERT_TRUE(jp_grid_path_add(&planner.internal, path, row[i], false));
        TEST_ASSERT_EQUAL_UINT32(i < 2 ? i + 1 : i, path->count); /* the second is on the way to the third */
    }
    TEST_ASSERT_EQUAL_MEMORY(&row[2], &path->points[1], sizeof *row);
    jp_grid_path_reverse(path);
    TEST_ASSERT_EQUAL_MEMORY(&row[4], &path->points[0], sizeof *row);
    TEST_ASSERT_EQUAL_MEMORY(&row[3], &path->points[1], sizeof *row);
    TEST_ASSERT_EQUAL_MEMORY(&row[2], &path->points[2], sizeof *row);
    TEST_ASSERT_EQUAL_MEMORY(&row[0], &path->points[3], sizeof *row);
    path->count = 3;
    TEST_ASSERT_UINT32_WITHIN(2,
                              (uint32_t)jp_grid_line_price(&planner.internal, &row[4], &row[3]) +
                                  (uint32_t)jp_grid_line_price(&planner.internal, &row[3], &row[2]),
                              (uint32_t)jp_grid_path_price(&planner.internal, path));
    path->count = 1;
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)jp_grid_path_price(&planner.internal, path));
}
