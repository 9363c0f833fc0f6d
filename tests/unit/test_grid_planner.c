/* The grid planner on drawn maps of a few cells: its statuses and answers, its three methods, lines of sight,
 * clearance, and what it does where its memory ends. */
#include <joulepath/grid_planner.h>
#include <string.h>

#include "level_map.h"
#include "src/grid_edges.h"
#include "unity.h"

enum {
    BLOCK_BYTES = 6 * 1024,
    SIDE = 12, /* units of a cell in the tests of lines */
    SLICES_MAX = 100000,
    ROWS_MAX = 16,
};

#define CELL JP_Q16(0.2)

static struct jp_terrain_config map;
static struct jp_grid_planner_config config;
static struct jp_grid_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];

void setUp(void)
{
    map = (struct jp_terrain_config){.width = 8, .height = 8, .resolution = CELL};
    config = (struct jp_grid_planner_config){.method = JP_GRID_ANY_ANGLE, .tube = 2};
    memset(block, 0x5A, sizeof block);
    make_level_map(&map);
}

void tearDown(void)
{
}

/* Rows from north to south, '@' is occupied; a null ends them. */
static void draw(const char *const *rows)
{
    uint16_t height = 0;

    while (rows[height] != NULL) {
        height++;
    }
    map.width = (uint16_t)strlen(rows[0]);
    map.height = height;
    make_level_map(&map);
    for (int32_t y = 0; y < height; y++) {
        for (int32_t x = 0; x < map.width; x++) {
            if (rows[height - 1 - y][x] == '@') {
                put_column(x, y, y, JP_CELL_OCCUPIED);
            }
        }
    }
}

#define DRAW(...)                                                                                                      \
    do {                                                                                                               \
        static const char *const rows[] = {__VA_ARGS__, NULL};                                                         \
        draw(rows);                                                                                                    \
    } while (0)

static enum jp_status init(size_t size, const char **field)
{
    return jp_grid_planner_init(&planner, &config, &terrain, block, size, field);
}

static void start_planner(void)
{
    const char *field = "";

    TEST_ASSERT_TRUE(jp_grid_planner_size(&config, &map) <= sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, init(jp_grid_planner_size(&config, &map), &field));
    TEST_ASSERT_NULL(field);
}

static enum jp_status set_task(int start_x, int start_y, int goal_x, int goal_y)
{
    const struct jp_grid_cell start = {(int16_t)start_x, (int16_t)start_y};
    const struct jp_grid_cell goal = {(int16_t)goal_x, (int16_t)goal_y};

    return jp_grid_planner_set_task(&planner, &start, &goal);
}

static enum jp_grid_answer finish(unsigned slice)
{
    enum jp_grid_answer answer = JP_GRID_SEARCHING;

    for (int i = 0; answer == JP_GRID_SEARCHING; i++) {
        TEST_ASSERT_TRUE(i < SLICES_MAX);
        answer = jp_grid_planner_work(&planner, slice);
    }
    return answer;
}

static void begin(enum jp_grid_method method, int start_x, int start_y, int goal_x, int goal_y)
{
    config.method = method;
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_OK, set_task(start_x, start_y, goal_x, goal_y));
}

/* Works in slices of one unit until a function of the phase would be next. */
static void work_until(bool (*is_there)(void))
{
    for (int i = 0; !is_there(); i++) {
        TEST_ASSERT_TRUE(i < SLICES_MAX);
        TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 1));
    }
}

static struct jp_path_point centre(int x, int y)
{
    return (struct jp_path_point){x * map.resolution + map.resolution / 2, y * map.resolution + map.resolution / 2};
}

static void expect_point(const struct jp_path_point *point, int x, int y)
{
    const struct jp_path_point expected = centre(x, y);

    TEST_ASSERT_EQUAL_INT32(expected.x, point->x);
    TEST_ASSERT_EQUAL_INT32(expected.y, point->y);
}

/* The way's ends, that its lines are free, and its length. */
static jp_q16 expect_way(int start_x, int start_y, int goal_x, int goal_y)
{
    size_t count = 0;
    const struct jp_path_point *way = jp_grid_planner_path(&planner, &count);
    uint64_t length = 0;

    TEST_ASSERT_NOT_NULL(way);
    TEST_ASSERT_TRUE(count >= 1);
    expect_point(&way[0], start_x, start_y);
    expect_point(&way[count - 1], goal_x, goal_y);
    for (size_t i = 1; i < count; i++) {
        const int64_t dx = way[i].x - way[i - 1].x;
        const int64_t dy = way[i].y - way[i - 1].y;
        TEST_ASSERT_TRUE(jp_grid_planner_line_is_free(&planner, &way[i - 1], &way[i]));
        length += jp_square_root((uint64_t)(dx * dx + dy * dy));
    }
    return (jp_q16)(length * 65536U / (uint64_t)map.resolution);
}

static size_t way_count(void)
{
    size_t count = 99;

    (void)jp_grid_planner_path(&planner, &count);
    return count;
}

/* The optimum of every method, in straight and diagonal steps; the any-angle way is no longer. */
static void expect_optimum(int start_x, int start_y, int goal_x, int goal_y, uint32_t straight, uint32_t diagonal)
{
    const jp_q16 cost = (jp_q16)(straight * GRID_STRAIGHT + diagonal * GRID_DIAGONAL);

    for (enum jp_grid_method method = JP_GRID_OCTILE; method <= JP_GRID_ANY_ANGLE; method++) {
        begin(method, start_x, start_y, goal_x, goal_y);
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(7));
        TEST_ASSERT_EQUAL_INT32(cost, jp_grid_planner_statistics(&planner)->octile_length);
        const jp_q16 length = expect_way(start_x, start_y, goal_x, goal_y);
        TEST_ASSERT_TRUE(length <= cost);
        if (method != JP_GRID_ANY_ANGLE) {
            TEST_ASSERT_INT32_WITHIN(100, cost, length);
        }
    }
}

/* ---- Configuration and tasks ---- */

static void expect_field(const char *expected)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)jp_grid_planner_size(&config, &terrain.config));
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, init(sizeof block, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    setUp();
}

static void test_config_out_of_range(void)
{
    terrain.config.resolution = JP_GRID_RESOLUTION_MIN - 1;
    expect_field("resolution");
    terrain.config.resolution = JP_GRID_SIDE_MAX / 8 + 1;
    expect_field("resolution");
    terrain.config.height = 9;
    terrain.config.resolution = JP_GRID_SIDE_MAX / 8;
    expect_field("resolution");
    terrain.config.width = 0;
    expect_field("resolution");
    terrain.config.height = JP_TERRAIN_SIDE_MAX + 1;
    expect_field("resolution");
    config.method = (enum jp_grid_method)(JP_GRID_ANY_ANGLE + 1);
    expect_field("method");
    config.clearance = -1;
    expect_field("clearance");
    config.clearance = JP_GRID_CLEARANCE_MAX * CELL + 1;
    expect_field("clearance");
    config.tube = 0;
    expect_field("tube");
    config.tube = JP_GRID_TUBE_MAX + 1;
    expect_field("tube");
}

static void test_config_at_its_limits(void)
{
    config.clearance = JP_GRID_CLEARANCE_MAX * CELL;
    config.tube = JP_GRID_TUBE_MAX;
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(2 * JP_GRID_CLEARANCE_MAX + 1, planner.disc_rows);
    TEST_ASSERT_EQUAL_INT8(-JP_GRID_CLEARANCE_MAX, planner.disc[0].y);
    TEST_ASSERT_EQUAL_INT8(JP_GRID_CLEARANCE_MAX, planner.disc[JP_GRID_CLEARANCE_MAX].last);
    TEST_ASSERT_EQUAL_INT8(-JP_GRID_CLEARANCE_MAX, planner.disc[JP_GRID_CLEARANCE_MAX].first);
}

static void test_init_arguments(void)
{
    const size_t size = jp_grid_planner_size(&config, &map);
    const char *field = "";

    TEST_ASSERT_TRUE(size > 0);
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)jp_grid_planner_size(NULL, &map));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)jp_grid_planner_size(&config, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_init(NULL, &config, &terrain, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_init(&planner, NULL, &terrain, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_init(&planner, &config, NULL, block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_init(&planner, &config, &terrain, NULL, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_init(&planner, &config, &terrain, block, size, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, init(size - 1, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT, jp_grid_planner_init(&planner, &config, &terrain, (uint8_t *)block + 4,
                                                                 sizeof block - 4, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, init(size, &field));
    TEST_ASSERT_EQUAL_UINT32((uint32_t)size, jp_grid_planner_statistics(&planner)->bytes);
}

/* A larger block gives the queue more, but not more than a cell can use. */
static void test_size_of_the_queue(void)
{
    const char *field = "";
    const size_t size = jp_grid_planner_size(&config, &map);

    config.method = JP_GRID_OCTILE;
    TEST_ASSERT_EQUAL_INT(JP_OK, init(size, &field));
    TEST_ASSERT_EQUAL_UINT32(64, planner.queue_max);
    map = (struct jp_terrain_config){.width = 16, .height = 8, .resolution = CELL};
    make_level_map(&map);
    TEST_ASSERT_EQUAL_INT(JP_OK, init(jp_grid_planner_size(&config, &map) + 80, &field));
    TEST_ASSERT_EQUAL_UINT32(90, planner.queue_max);
}

static void test_task_arguments(void)
{
    const struct jp_grid_cell cell = {1, 1};

    DRAW("....", //
         "...@", //
         "....", //
         "....");
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_set_task(NULL, &cell, &cell));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_set_task(&planner, NULL, &cell));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_set_task(&planner, &cell, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, set_task(-1, 0, 1, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, set_task(0, 0, 1, 4));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, set_task(3, 2, 1, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, set_task(1, 1, 3, 2));
    TEST_ASSERT_EQUAL_INT(JP_GRID_NO_TASK, jp_grid_planner_work(&planner, 10));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)way_count());
}

static void test_bad_task_leaves_the_old_one(void)
{
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_OK, set_task(0, 0, 7, 3));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, set_task(0, 0, 8, 3));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(10));
    (void)expect_way(0, 0, 7, 3);
}

static void test_no_way_before_it_is_found(void)
{
    size_t count = 5;

    begin(JP_GRID_ANY_ANGLE, 0, 0, 7, 7);
    TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 1));
    TEST_ASSERT_NULL(jp_grid_planner_path(&planner, &count));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)count);
}

static void test_start_is_goal(void)
{
    expect_optimum(3, 4, 3, 4, 0, 0);
    TEST_ASSERT_EQUAL_UINT32(1, (uint32_t)way_count());
}

/* ---- Ways ---- */

static void test_open_map(void)
{
    expect_optimum(0, 0, 7, 3, 4, 3);
    TEST_ASSERT_EQUAL_UINT32(2, (uint32_t)way_count());
    expect_optimum(7, 7, 0, 7, 7, 0);
    expect_optimum(7, 0, 0, 7, 0, 7);
    expect_optimum(2, 7, 3, 0, 6, 1);
}

static void test_no_cut_corners(void)
{
    DRAW("....", //
         ".@..", //
         "....", //
         "....");
    expect_optimum(0, 2, 1, 3, 2, 0);
    expect_optimum(0, 1, 2, 3, 4, 0);
    TEST_ASSERT_EQUAL_UINT32(3, (uint32_t)way_count());
}

static void test_wall_with_a_gap(void)
{
    DRAW("......@.", //
         "......@.", //
         "......@.", //
         "........", //
         "......@.", //
         "......@.");
    expect_optimum(0, 5, 7, 0, 6, 3);
    expect_optimum(7, 0, 0, 5, 6, 3);
    expect_optimum(7, 5, 4, 5, 7, 1);
}

static void test_winding_way(void)
{
    DRAW(".......@.......", //
         ".@@@@@.@.@@@@@.", //
         ".@...@.@.@.....", //
         ".@.@.@.@.@.@@@@", //
         ".@.@...@.@.....", //
         ".@.@@@@@.@@@@@.", //
         ".@.............");
    expect_optimum(2, 4, 10, 2, 22, 0);
}

/* Runs of more than a word, to the east, west, north and south. */
static void test_long_runs(void)
{
    map = (struct jp_terrain_config){.width = 70, .height = 4, .resolution = CELL};
    make_level_map(&map);
    expect_optimum(0, 0, 69, 0, 69, 0);
    expect_optimum(69, 3, 0, 0, 66, 3);
    put_column(40, 0, 2, JP_CELL_OCCUPIED);
    put_column(20, 1, 3, JP_CELL_OCCUPIED);
    expect_optimum(0, 3, 69, 0, 60, 9);
    expect_optimum(69, 0, 0, 3, 60, 9);
    map = (struct jp_terrain_config){.width = 4, .height = 70, .resolution = CELL};
    make_level_map(&map);
    put_column(1, 32, 32, JP_CELL_OCCUPIED);
    put_column(0, 32, 32, JP_CELL_OCCUPIED);
    put_column(2, 64, 64, JP_CELL_OCCUPIED);
    put_column(3, 64, 64, JP_CELL_OCCUPIED);
    expect_optimum(0, 0, 3, 69, 64, 5);
    expect_optimum(3, 69, 0, 0, 64, 5);
}

static void test_jump_points_open_fewer_nodes(void)
{
    uint32_t expansions[2];

    for (int method = JP_GRID_OCTILE; method <= JP_GRID_JUMP_POINTS; method++) {
        begin((enum jp_grid_method)method, 0, 0, 7, 4);
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
        expansions[method] = jp_grid_planner_statistics(&planner)->expansions;
    }
    TEST_ASSERT_TRUE(expansions[1] < expansions[0]);
    TEST_ASSERT_EQUAL_UINT32(2, expansions[1]);
}

/* Round the corner of an obstacle on a line that no eight directions have. */
static void test_any_angle_is_taut(void)
{
    DRAW("............", //
         "............", //
         "............", //
         "......@@....", //
         "......@@....", //
         "......@@....", //
         "......@@....");
    begin(JP_GRID_ANY_ANGLE, 0, 0, 11, 1);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(3));
    const jp_q16 length = expect_way(0, 0, 11, 1);

    /* √(5.5² + 3.5²) + 2 + √(3.5² + 2.5²) over the corners. */
    TEST_ASSERT_TRUE(length >= JP_Q16(12.820));
    TEST_ASSERT_TRUE(length <= JP_Q16(12.90));
    TEST_ASSERT_EQUAL_UINT32(4, (uint32_t)way_count());
    TEST_ASSERT_TRUE(jp_grid_planner_statistics(&planner)->edge_nodes > 12);
}

/* Of the way by shortcuts and the way over the edges: on this map each is the shorter one of some tasks. */
static void test_the_shorter_way_is_the_answer(void)
{
    unsigned by_edges = 0;
    unsigned by_shortcuts = 0;

    DRAW("...............", //
         ".....@.........", //
         "...@.....@.....", //
         ".......@...@...", //
         "..@............", //
         "....@...@...@..", //
         "..........@....", //
         "......@........");
    for (int i = 0; i < 64; i++) {
        begin(JP_GRID_ANY_ANGLE, 0, i % 8, 14, i / 8);
        const struct jp_path_point *by_shortcut = planner.way.points;
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(1));
        TEST_ASSERT_TRUE(expect_way(0, i % 8, 14, i / 8) <= jp_grid_planner_statistics(&planner)->octile_length);
        const uint64_t length = jp_grid_way_length(&planner.way);
        const uint64_t other = jp_grid_way_length(&planner.other);
        TEST_ASSERT_TRUE(length <= other);
        by_edges += length < other && planner.way.points != by_shortcut;
        by_shortcuts += length < other && planner.way.points == by_shortcut;
    }
    TEST_ASSERT_TRUE(by_edges > 0);
    TEST_ASSERT_TRUE(by_shortcuts > 0);
}

static void test_unreachable(void)
{
    DRAW("....@...", //
         "...@....", //
         "..@.....", //
         ".@......", //
         "@.......");
    for (int method = JP_GRID_OCTILE; method <= JP_GRID_ANY_ANGLE; method++) {
        begin((enum jp_grid_method)method, 0, 4, 7, 0);
        TEST_ASSERT_EQUAL_INT(JP_GRID_UNREACHABLE, finish(1));
        TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)way_count());
    }
}

static void test_same_way_in_any_slices(void)
{
    struct jp_path_point first[8];
    size_t count = 0;

    DRAW("........", //
         ".@@@.@@.", //
         ".@....@.", //
         "...@@...", //
         ".@....@.", //
         "........");
    for (unsigned slice = 1; slice < 1000; slice = slice * 3 + 1) {
        begin(JP_GRID_ANY_ANGLE, 0, 0, 7, 5);
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(slice));
        const struct jp_path_point *way = jp_grid_planner_path(&planner, &count);
        TEST_ASSERT_TRUE(count <= 8);
        if (slice == 1) {
            memcpy(first, way, count * sizeof *way);
        }
        TEST_ASSERT_EQUAL_MEMORY(first, way, count * sizeof *way);
    }
}

/* ---- Clearance ---- */

static void test_disc(void)
{
    config.clearance = CELL / 2; /* touches the neighbours */
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(1, planner.disc_rows);
    config.clearance = CELL / 2 + 1; /* the straight neighbours */
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(3, planner.disc_rows);
    TEST_ASSERT_EQUAL_INT8(0, planner.disc[0].last);
    TEST_ASSERT_EQUAL_INT8(1, planner.disc[1].last);
    config.clearance = CELL; /* and the diagonal ones, 0.71 away */
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(3, planner.disc_rows);
    TEST_ASSERT_EQUAL_INT8(1, planner.disc[0].last);
    TEST_ASSERT_EQUAL_INT8(-1, planner.disc[2].first);
}

static void test_clearance_blocks(void)
{
    DRAW(".........", //
         ".........", //
         ".........", //
         "@@@@...@@", //
         ".........", //
         ".........", //
         ".........");
    config.clearance = CELL;
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, set_task(0, 1, 4, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, set_task(4, 1, 4, 4));
    expect_optimum(3, 1, 3, 5, 8, 0);
    put_column(6, 3, 3, JP_CELL_OCCUPIED);
    begin(JP_GRID_JUMP_POINTS, 3, 1, 3, 5);
    TEST_ASSERT_EQUAL_INT(JP_GRID_UNREACHABLE, finish(50));
}

/* ---- Changes of the map ---- */

static void test_change_during_a_search(void)
{
    begin(JP_GRID_ANY_ANGLE, 0, 0, 7, 7);
    TEST_ASSERT_EQUAL_INT(JP_GRID_SEARCHING, jp_grid_planner_work(&planner, 2));
    put_column(3, 0, 6, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_GRID_STALE, jp_grid_planner_work(&planner, 2));
    TEST_ASSERT_EQUAL_INT(JP_GRID_STALE, jp_grid_planner_work(&planner, 2));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)way_count());
    TEST_ASSERT_EQUAL_INT(JP_OK, set_task(0, 0, 7, 7));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(2));
    (void)expect_way(0, 0, 7, 7);
    TEST_ASSERT_TRUE(way_count() > 2);
}

/* A change after the answer leaves it; the next task sees the new map. Without one the planes stay. */
static void test_change_between_tasks(void)
{
    begin(JP_GRID_ANY_ANGLE, 0, 0, 7, 0);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
    put_column(3, 0, 6, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, jp_grid_planner_work(&planner, 1));
    TEST_ASSERT_EQUAL_UINT32(2, (uint32_t)way_count());
    TEST_ASSERT_EQUAL_INT(JP_OK, set_task(0, 0, 7, 0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
    TEST_ASSERT_TRUE(way_count() > 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, set_task(0, 0, 1, 0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
    (void)expect_way(0, 0, 1, 0);
}

/* ---- Lines ---- */

static bool is_free(int x0, int y0, int x1, int y1)
{
    const struct jp_path_point from = {x0 * map.resolution / SIDE, y0 * map.resolution / SIDE};
    const struct jp_path_point to = {x1 * map.resolution / SIDE, y1 * map.resolution / SIDE};
    const bool there = jp_grid_planner_line_is_free(&planner, &from, &to);

    TEST_ASSERT_EQUAL_INT(there, jp_grid_planner_line_is_free(&planner, &to, &from));
    return there;
}

/* The same line on the map as it is and mirrored, which the four mirrored maps of a test are. */
static void expect_line(bool expected, int x0, int y0, int x1, int y1)
{
    TEST_ASSERT_EQUAL_INT(expected, is_free(x0, y0, x1, y1));
}

static void start_lines(void)
{
    map.resolution = SIDE * JP_Q16(0.01);
    terrain.config.resolution = map.resolution;
    start_planner();
}

/* One cell, 24…36, is blocked. */
static void expect_lines_round_a_cell(void)
{
    expect_line(false, 0, 0, 0, 0); /* a corner of the map */
    expect_line(true, 1, 0, 1, 0);
    expect_line(true, 60, 1, 60, 59);
    expect_line(true, 59, 60, 1, 60);
    expect_line(false, -1, 0, 5, 5);
    expect_line(false, 5, 5, 0, -1);
    expect_line(false, 61, 0, 5, 5);
    expect_line(false, 5, 5, 5, 61);
    expect_line(false, 0, 30, 60, 30);
    expect_line(false, 30, 0, 30, 60);
    expect_line(false, 0, 0, 60, 60);
    expect_line(false, 0, 60, 60, 0);
    expect_line(false, 30, 30, 30, 30);
    /* along its sides and past its corners */
    expect_line(true, 0, 24, 60, 24);
    expect_line(true, 0, 36, 60, 36);
    expect_line(true, 24, 0, 24, 60);
    expect_line(true, 36, 0, 36, 60);
    expect_line(false, 25, 0, 25, 60);
    expect_line(false, 35, 0, 35, 60);
    expect_line(true, 0, 48, 48, 0);
    expect_line(false, 0, 49, 49, 0);
    expect_line(true, 12, 48, 24, 36);
    expect_line(true, 24, 24, 36, 24);
    expect_line(true, 24, 30, 24, 30);
    expect_line(true, 36, 36, 36, 36);
    /* to its sides and corners, and in */
    expect_line(true, 0, 30, 24, 30);
    expect_line(false, 0, 30, 25, 30);
    expect_line(true, 1, 1, 24, 24);
    expect_line(false, 1, 1, 25, 25);
    expect_line(true, 60, 54, 36, 36);
    expect_line(false, 60, 52, 35, 35);
}

static void test_lines_round_a_cell(void)
{
    DRAW(".....", //
         ".....", //
         "..@..", //
         ".....", //
         ".....");
    start_lines();
    expect_lines_round_a_cell(); /* without planes: by the map */
    TEST_ASSERT_EQUAL_INT(JP_OK, set_task(0, 0, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
    expect_lines_round_a_cell();
    expect_line(true, 6, 6, 54, 6);
    put_column(3, 0, 0, JP_CELL_OCCUPIED); /* lines are those of the map as it is now */
    expect_line(false, 6, 6, 54, 6);
}

/* Cells 12…24 and 24…36 of two rows meet at (24, 24). */
static void expect_lines_between_two(void)
{
    expect_line(false, 12, 12, 36, 36);
    expect_line(false, 12, 36, 36, 12);
    expect_line(false, 24, 0, 24, 48);
    expect_line(false, 0, 24, 48, 24);
    expect_line(false, 24, 24, 24, 24);
    expect_line(false, 18, 30, 24, 24);
    expect_line(false, 24, 24, 30, 18);
    expect_line(true, 18, 30, 23, 25);
    expect_line(true, 12, 24, 12, 48);
}

static void test_lines_between_two_that_meet(void)
{
    DRAW("....", //
         "..@.", //
         ".@..", //
         "....");
    start_lines();
    expect_lines_between_two();
    DRAW("....", //
         ".@..", //
         "..@.", //
         "....");
    start_lines();
    expect_line(false, 12, 12, 36, 36);
    expect_line(false, 24, 0, 24, 48);
    expect_line(false, 0, 24, 48, 24);
    expect_line(false, 24, 24, 24, 24);
    expect_line(false, 18, 18, 24, 24);
}

static void test_lines_between_neighbours(void)
{
    DRAW("......", //
         "..@@..", //
         "......", //
         "......");
    start_lines();
    expect_line(false, 36, 0, 36, 48);
    expect_line(true, 36, 0, 36, 24);
    expect_line(false, 36, 0, 36, 25);
    expect_line(true, 24, 0, 24, 48);
    expect_line(true, 0, 24, 72, 24);
    DRAW("....", //
         ".@..", //
         ".@..", //
         "....");
    start_lines();
    expect_line(false, 0, 24, 48, 24);
    expect_line(true, 0, 24, 12, 24);
    expect_line(true, 0, 12, 48, 12);
}

/* ---- Where memory ends ---- */

static void test_full_queue(void)
{
    begin(JP_GRID_OCTILE, 0, 0, 7, 7);
    planner.queue_max = 5;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(10));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)way_count());
    TEST_ASSERT_EQUAL_UINT32(5, jp_grid_planner_statistics(&planner)->queue_most);
}

static void test_too_many_turning_points(void)
{
    begin(JP_GRID_OCTILE, 0, 0, 7, 3);
    planner.points_max = 2;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(10));
}

static void test_too_long_way(void)
{
    begin(JP_GRID_OCTILE, 0, 0, 7, 3);
    planner.length_max = 6 * GRID_STRAIGHT;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(10));
}

static bool has_octile_way(void)
{
    return planner.counts.octile_length != 0;
}

static bool is_spreading(void)
{
    return planner.counts.edge_nodes > 0;
}

static bool is_descending(void)
{
    return planner.other.count > 0;
}

/* The way by shortcuts stays the answer. */
static void expect_shortcuts_alone(void)
{
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(1));
    TEST_ASSERT_TRUE(expect_way(0, 0, 6, 1) <= jp_grid_planner_statistics(&planner)->octile_length);
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

static void test_edges_run_out_of_queue(void)
{
    begin_round_a_corner(is_spreading);
    planner.queue_max = planner.queue_count;
    expect_shortcuts_alone();
}

static void test_edges_do_not_reach_the_start(void)
{
    begin_round_a_corner(is_spreading);
    jp_grid_node(&planner, 0, 0)->place &= ~GRID_IN_TUBE;
    expect_shortcuts_alone();
}

static void test_descent_runs_out_of_points(void)
{
    begin_round_a_corner(is_descending);
    planner.points_max = 2;
    expect_shortcuts_alone();
}

static void test_descent_ends_nowhere(void)
{
    begin_round_a_corner(is_descending);
    planner.place_cost = 1;
    expect_shortcuts_alone();
}

static void test_way_ends_with_many_passes(void)
{
    begin_round_a_corner(has_octile_way);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(1));
    (void)expect_way(0, 0, 6, 1);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_config_out_of_range);
    RUN_TEST(test_config_at_its_limits);
    RUN_TEST(test_init_arguments);
    RUN_TEST(test_size_of_the_queue);
    RUN_TEST(test_task_arguments);
    RUN_TEST(test_bad_task_leaves_the_old_one);
    RUN_TEST(test_no_way_before_it_is_found);
    RUN_TEST(test_start_is_goal);
    RUN_TEST(test_open_map);
    RUN_TEST(test_no_cut_corners);
    RUN_TEST(test_wall_with_a_gap);
    RUN_TEST(test_winding_way);
    RUN_TEST(test_long_runs);
    RUN_TEST(test_jump_points_open_fewer_nodes);
    RUN_TEST(test_any_angle_is_taut);
    RUN_TEST(test_the_shorter_way_is_the_answer);
    RUN_TEST(test_unreachable);
    RUN_TEST(test_same_way_in_any_slices);
    RUN_TEST(test_disc);
    RUN_TEST(test_clearance_blocks);
    RUN_TEST(test_change_during_a_search);
    RUN_TEST(test_change_between_tasks);
    RUN_TEST(test_lines_round_a_cell);
    RUN_TEST(test_lines_between_two_that_meet);
    RUN_TEST(test_lines_between_neighbours);
    RUN_TEST(test_full_queue);
    RUN_TEST(test_too_many_turning_points);
    RUN_TEST(test_too_long_way);
    RUN_TEST(test_edges_run_out_of_queue);
    RUN_TEST(test_edges_do_not_reach_the_start);
    RUN_TEST(test_descent_runs_out_of_points);
    RUN_TEST(test_descent_ends_nowhere);
    RUN_TEST(test_way_ends_with_many_passes);
    return UNITY_END();
}
