/* What ways cost by prices, and by it which is taken: rings around what is blocked, slopes, lines, shortcuts. */
#define LEVEL_MAP_BYTES 1024
#include "src/search/grid_cost.h"

#include "tests/support/grid_rig.h"

/* Of a metre, J; by a ring as much more, and by a grade. */
#define METRE JP_Q16(32)

static struct jp_grid_prices prices;

void setUp(void)
{
    rig_reset();
    prices = (struct jp_grid_prices){.metre = METRE, .ring = CELL, .near = {4 * METRE, 2 * METRE, METRE}};
    config.prices = &prices;
}

void tearDown(void)
{
}

static void expect_field(const char *expected)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, init(sizeof block, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    setUp();
}

static void test_prices_out_of_range(void)
{
    config.method = JP_GRID_JUMP_POINTS;
    expect_field("method");
    prices.metre = 0;
    expect_field("prices");
    prices.ring = CELL / 64 - 1;
    expect_field("prices");
    prices.near[JP_GRID_RINGS - 1] = -1;
    expect_field("prices");
    prices.slope[0] = -1;
    expect_field("prices");
}

static uint32_t level_price(int x, int y)
{
    return jp_grid_level_price(&planner.internal, x, y);
}

static bool has_rings(void)
{
    return planner.internal.has_rings;
}

static void measure(void)
{
    begin(JP_GRID_ANY_ANGLE, 0, 0, 1, 0);
    work_until(has_rings);
}

static void make_map(uint16_t width, uint16_t height)
{
    map.width = width;
    map.height = height;
    make_level_map(&map);
}

/* ---- Rings ---- */

static void expect_ring(unsigned ring, int x, int y)
{
    TEST_ASSERT_EQUAL_UINT32(256U * (1U + (ring == 0U ? 0U : ring)), level_price(x, y));
}

/* Each ring costs as much more as its number. */
static void number_rings(void)
{
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        prices.near[i] = (jp_q16)(i + 1U) * METRE;
    }
}

static void test_rings_around_a_cell(void)
{
    number_rings();
    make_map(15, 15);
    put_column(7, 7, 7, JP_CELL_OCCUPIED);
    measure();
    expect_ring(1, 7, 7);
    expect_ring(1, 8, 7);
    expect_ring(2, 8, 8);
    expect_ring(2, 7, 5);
    expect_ring(3, 9, 9);
    expect_ring(4, 4, 8);
    expect_ring(4, 10, 6);
    expect_ring(4, 6, 4);
}

/* Everything outside the map is blocked. */
static void test_rings_along_the_border(void)
{
    number_rings();
    make_map(16, 15);
    measure();
    expect_ring(1, 0, 7);
    expect_ring(3, 2, 7);
    expect_ring(4, 12, 7);
    expect_ring(7, 7, 6);
    expect_ring(0, 7, 7);
    expect_ring(2, 1, 1);
    expect_ring(5, 8, 10);
}

static void test_wide_and_narrow_rings(void)
{
    number_rings();
    prices.ring = 2 * CELL;
    make_map(16, 15);
    measure();
    expect_ring(1, 0, 7);
    expect_ring(1, 1, 7);
    expect_ring(2, 2, 7);
    expect_ring(4, 7, 7);
    prices.ring = CELL / 3;
    measure();
    expect_ring(4, 0, 7); /* a ring is narrower by rounding */
    expect_ring(7, 1, 7);
    expect_ring(0, 2, 7);
}

static void test_a_part_is_limited(void)
{
    prices.near[0] = 1000 * METRE;
    measure();
    TEST_ASSERT_EQUAL_UINT32(256U * (1U + JP_GRID_PART_MAX), level_price(0, 0));
}

static void test_rings_follow_the_map(void)
{
    make_map(9, 9);
    number_rings();
    begin(JP_GRID_ANY_ANGLE, 0, 0, 8, 8);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(50));
    expect_ring(5, 4, 4);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(8, 0, 0, 8));
    TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 1));
    TEST_ASSERT_EQUAL_INT(JP_GRID_CLEAR, planner.internal.phase); /* the map has not changed */
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(50));
    put_column(4, 3, 3, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(8, 0, 0, 8));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(50));
    expect_ring(1, 4, 4);
    expect_ring(2, 4, 5);
}

static bool is_measuring_back(void)
{
    return planner.internal.phase == JP_GRID_MEASURE_BACK;
}

static void test_a_task_while_it_measures(void)
{
    number_rings();
    make_map(9, 9);
    begin(JP_GRID_ANY_ANGLE, 0, 0, 8, 8);
    work_until(is_measuring_back);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 4, 8, 4));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(3));
    (void)expect_way(0, 4, 8, 4);
    expect_ring(5, 4, 4);
    expect_ring(2, 1, 4);
}

/* ---- Steps and lines ---- */

/* Costs of level cells: 4 096 each, 5 793 along a diagonal. */
static void test_steps(void)
{
    make_map(9, 9);
    measure();
    TEST_ASSERT_EQUAL_UINT32(4096, jp_grid_step_cost(&planner.internal, 4, 4, 0));
    TEST_ASSERT_EQUAL_UINT32(5793, jp_grid_step_cost(&planner.internal, 4, 4, 1));
    TEST_ASSERT_EQUAL_UINT32(4096 * (2 + 1) / 2, jp_grid_step_cost(&planner.internal, 3, 4, 4));
    TEST_ASSERT_EQUAL_UINT32(5793 * (5 + 3) / 2, jp_grid_step_cost(&planner.internal, 0, 0, 1));
    TEST_ASSERT_EQUAL_UINT32(4096 * 5, jp_grid_step_cost(&planner.internal, 0, 4, 2));
}

/* In level metres. */
static void expect_line(jp_q16 metres, struct jp_point from, struct jp_point to)
{
    const uint64_t price = jp_grid_line_price(&planner.internal, &from, &to);
    const uint64_t back = jp_grid_line_price(&planner.internal, &to, &from);

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0003), metres, (int32_t)(price >> 8));
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.0003), metres, (int32_t)(back >> 8));
}

static struct jp_point corner(int x, int y)
{
    return (struct jp_point){x * CELL, y * CELL};
}

static void test_lines(void)
{
    make_map(9, 9);
    measure();
    expect_line(JP_Q16(0.1 * (5 + 3 + 3 + 2 + 2 + 1)), centre(0, 4), centre(3, 4));
    expect_line(JP_Q16(0.2 * 1.41421 * (2.5 + 3 + 2 + 0.5)), centre(0, 0), centre(3, 3));
    expect_line(JP_Q16(0.2 * 1.41421 * (2.5 + 3 + 2 + 0.5)), centre(8, 0), centre(5, 3));
    expect_line(JP_Q16(0.2 * 9 * 5), corner(0, 0), corner(9, 0));
    expect_line(JP_Q16(0.2 * 9 * 5), corner(9, 0), corner(9, 9)); /* nothing is nearer than off the map */
    expect_line(JP_Q16(0), centre(2, 2), centre(2, 2));
    /* Two across for one up, from a corner: half a cell's diagonal in each. */
    expect_line(JP_Q16(0.1 * 2.23607 * (5 + 3 + 2 + 2)), corner(0, 1), corner(4, 3));
}

static void test_lines_without_prices(void)
{
    config.prices = NULL;
    start_planner();
    expect_line(JP_Q16(0.2 * 5), centre(0, 0), centre(3, 4));
}

/* ---- Slopes ---- */

static jp_elevation east_up(int32_t x, int32_t y)
{
    (void)y;
    return (jp_elevation)(x * 51); /* of a cell of 205 units: a grade of 0.249 */
}

/* By a grade 64 times its square, downhill twice as much. */
static void make_slopes(void)
{
    for (int i = 0; i < (int)JP_GRID_GRADES; i++) {
        const int square = (i - 16) * (i - 16) * (METRE / 16);

        prices.slope[i] = i < 16 ? 2 * square : square;
    }
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        prices.near[i] = 0;
    }
    map.has_elevation = true;
}

static void test_steps_on_a_slope(void)
{
    make_slopes();
    make_map(8, 8);
    raise_map(east_up);
    measure();
    TEST_ASSERT_INT32_WITHIN(150, 4096 * 5, (int32_t)jp_grid_step_cost(&planner.internal, 3, 3, 0));
    TEST_ASSERT_INT32_WITHIN(300, 4096 * 9, (int32_t)jp_grid_step_cost(&planner.internal, 3, 3, 4));
    TEST_ASSERT_EQUAL_UINT32(4096, jp_grid_step_cost(&planner.internal, 3, 3, 2));
    /* 0.176 up along a diagonal: between the grades that are given it is linear. */
    TEST_ASSERT_INT32_WITHIN(100, 5793 * 3, (int32_t)jp_grid_step_cost(&planner.internal, 3, 3, 1));
    TEST_ASSERT_INT32_WITHIN(150, 5793 * 5, (int32_t)jp_grid_step_cost(&planner.internal, 3, 3, 3));
}

static void expect_one_way(jp_q16 metres, struct jp_point from, struct jp_point to)
{
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.08), metres, (int32_t)(jp_grid_line_price(&planner.internal, &from, &to) >> 8));
}

static void test_lines_on_a_slope(void)
{
    make_slopes();
    make_map(8, 8);
    raise_map(east_up);
    measure();
    expect_one_way(JP_Q16(5), centre(1, 3), centre(6, 3));
    expect_one_way(JP_Q16(9), centre(6, 3), centre(1, 3));
    expect_one_way(JP_Q16(1), centre(3, 1), centre(3, 6));
}

static jp_elevation cliff(int32_t x, int32_t y)
{
    (void)y;
    return x < 4 ? 0 : 20000;
}

/* Steeper ground costs as the steepest that is given. */
static void test_a_cliff(void)
{
    make_slopes();
    make_map(8, 8);
    raise_map(cliff);
    measure();
    TEST_ASSERT_EQUAL_UINT32(4096 * 17, jp_grid_step_cost(&planner.internal, 3, 3, 0));
    TEST_ASSERT_EQUAL_UINT32(4096 * 32, jp_grid_step_cost(&planner.internal, 4, 3, 4));
}

/* ---- Ways ---- */

/* The gap is one cell wide, the way round through the open leads over four cells more. */
static void draw_gap(void)
{
    DRAW("...............", //
         "...............", //
         "...............", //
         "...............", //
         "...............", //
         "...............", //
         ".......@.......", //
         ".......@.......", //
         ".......@.......", //
         ".......@.......", //
         "...............", //
         ".......@.......", //
         ".......@.......", //
         ".......@.......");
}

static int32_t highest(void)
{
    size_t count = 0;
    const struct jp_point *way = jp_grid_planner_path(&planner, &count);
    int32_t most = 0;

    for (size_t i = 0; i < count; i++) {
        most = way[i].y > most ? way[i].y : most;
    }
    return most;
}

static void test_a_gap_is_taken_where_it_is_cheap(void)
{
    draw_gap();
    for (int i = 0; i < 2; i++) {
        const bool is_dear = i == 1;

        for (unsigned ring = 0; ring < JP_GRID_RINGS; ring++) {
            prices.near[ring] = ring == 0U ? (is_dear ? 20 * METRE : METRE / 4) : 0;
        }
        begin(JP_GRID_ANY_ANGLE, 3, 3, 11, 3);
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
        (void)expect_way(3, 3, 11, 3);
        TEST_ASSERT_EQUAL_INT(is_dear, highest() > 8 * CELL);
    }
}

/* Where a wall is dear to be near, no shortcut hugs it, and the way costs no more than the best in eight directions. */
static void test_no_shortcut_along_a_dear_wall(void)
{
    jp_energy by_octile;
    jp_energy by_lines;

    DRAW("................", //
         "................", //
         "................", //
         "................", //
         "................", //
         "................", //
         "....@@@@@@@@....", //
         "................", //
         "................", //
         "................", //
         "................", //
         "................");
    begin(JP_GRID_OCTILE, 2, 4, 13, 6);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    by_octile = jp_grid_planner_price(&planner);
    begin(JP_GRID_ANY_ANGLE, 2, 4, 13, 6);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    by_lines = jp_grid_planner_price(&planner);
    TEST_ASSERT_TRUE(by_lines <= by_octile);
    TEST_ASSERT_TRUE(way_count() >= 3);
}

static jp_elevation ridge(int32_t x, int32_t y)
{
    return (jp_elevation)(x >= 5 && x <= 7 && y < 9 ? 60 : 0);
}

/* Round a ridge, where it is dear to climb and to descend. */
static void test_round_a_ridge(void)
{
    make_slopes();
    make_map(13, 13);
    raise_map(ridge);
    begin(JP_GRID_ANY_ANGLE, 1, 6, 11, 6);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    (void)expect_way(1, 6, 11, 6);
    TEST_ASSERT_TRUE(highest() > 9 * CELL);
    for (unsigned i = 0; i < JP_GRID_GRADES; i++) {
        prices.slope[i] = 0;
    }
    begin(JP_GRID_ANY_ANGLE, 1, 6, 11, 6);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    TEST_ASSERT_EQUAL_UINT32(2, (uint32_t)way_count());
}

/* ---- What a way costs ---- */

static void expect_joules(jp_q16 joules)
{
    const jp_energy price = jp_grid_planner_price(&planner);

    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.05), joules, (int32_t)(price >> 16));
}

static void test_price_of_a_way(void)
{
    make_map(15, 15);
    begin(JP_GRID_ANY_ANGLE, 4, 7, 10, 7);
    expect_joules(JP_Q16(0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    expect_joules(JP_Q16(6 * 0.2 * 32));
    TEST_ASSERT_EQUAL_INT32(6 * JP_Q16_ONE, jp_grid_planner_statistics(&planner)->octile_length);
    config.prices = NULL;
    begin(JP_GRID_ANY_ANGLE, 4, 7, 10, 7);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    expect_joules(JP_Q16(0));
}

static void test_price_of_a_climb(void)
{
    make_slopes();
    for (unsigned i = 0; i < JP_GRID_GRADES; i++) {
        prices.slope[i] = 0;
    }
    prices.rise = JP_Q16(1000);
    make_map(8, 8);
    raise_map(east_up);
    begin(JP_GRID_ANY_ANGLE, 1, 3, 6, 3);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    expect_joules(JP_Q16(32 + 5 * 51.0 / 1024 * 1000));
    begin(JP_GRID_ANY_ANGLE, 6, 3, 1, 3);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    expect_joules(JP_Q16(32 - 5 * 51.0 / 1024 * 1000));
}

/* The price saturates; a way that is dearer than counts go is none. */
static void test_the_dearest_ways(void)
{
    for (unsigned i = 0; i < JP_GRID_RINGS; i++) {
        prices.near[i] = 31 * METRE;
    }
    begin(JP_GRID_OCTILE, 0, 0, 7, 0);
    planner.internal.length_max = 7 * 32 * 4096 - 1;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(20));
    begin(JP_GRID_OCTILE, 0, 0, 7, 0);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(20));
    expect_joules(JP_Q16(7 * 0.2 * 32 * 32));
    planner.internal.metre = INT32_MAX;
    planner.internal.path.points[1].x = 5000 * JP_Q16_ONE; /* no planner's map is so wide */
    TEST_ASSERT_TRUE(jp_grid_planner_price(&planner) > 0);
}
