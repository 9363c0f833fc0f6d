/* The grid planner on drawn maps of a few cells: its statuses and answers, its three methods, clearance, and what it
 * does where its memory ends. */
#include "src/search/grid_edges.h"
#include "tests/support/grid_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
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
    terrain.config.height = JP_GRID_CELLS_MAX + 1;
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
    TEST_ASSERT_EQUAL_UINT8(2 * JP_GRID_CLEARANCE_MAX + 1, planner.internal.disc_rows);
    TEST_ASSERT_EQUAL_INT8(-JP_GRID_CLEARANCE_MAX, planner.internal.disc[0].y);
    TEST_ASSERT_EQUAL_INT8(JP_GRID_CLEARANCE_MAX, planner.internal.disc[JP_GRID_CLEARANCE_MAX].last);
    TEST_ASSERT_EQUAL_INT8(-JP_GRID_CLEARANCE_MAX, planner.internal.disc[JP_GRID_CLEARANCE_MAX].first);
}

static void test_config_at_its_least(void)
{
    config.method = JP_GRID_OCTILE;
    config.clearance = 0;
    config.tube = 1;
    terrain.config.resolution = JP_GRID_RESOLUTION_MIN;
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(1, planner.internal.disc_rows);
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
    TEST_ASSERT_EQUAL_UINT32(64, planner.internal.queue_max);
    map = (struct jp_terrain_config){.width = 16, .height = 8, .resolution = CELL};
    make_level_map(&map);
    TEST_ASSERT_EQUAL_INT(JP_OK, init(jp_grid_planner_size(&config, &map) + 80, &field));
    TEST_ASSERT_EQUAL_UINT32(90, planner.internal.queue_max);
}

static void test_task_arguments(void)
{
    const struct jp_grid_cell cell = {1, 1};

    DRAW("....", //
         "...@", //
         "....", //
         "....");
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_start(NULL, &cell, &cell));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_start(&planner, NULL, &cell));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_grid_planner_start(&planner, &cell, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start_task(-1, 0, 1, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start_task(0, 0, 1, 4));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, start_task(3, 2, 1, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, start_task(1, 1, 3, 2));
    TEST_ASSERT_EQUAL_INT(JP_GRID_NO_TASK, jp_grid_planner_work(&planner, 10));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)way_count());
}

static void test_bad_task_leaves_the_old_one(void)
{
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 0, 7, 3));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, start_task(0, 0, 8, 3));
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
        const struct jp_point *by_shortcut = planner.internal.path.points;
        TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(1));
        TEST_ASSERT_TRUE(expect_way(0, i % 8, 14, i / 8) <= jp_grid_planner_statistics(&planner)->octile_length);
        const uint64_t length = jp_grid_path_price(&planner.internal, &planner.internal.path);
        const uint64_t other = jp_grid_path_price(&planner.internal, &planner.internal.candidate);
        TEST_ASSERT_TRUE(length <= other);
        by_edges += length < other && planner.internal.path.points != by_shortcut;
        by_shortcuts += length < other && planner.internal.path.points == by_shortcut;
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
    struct jp_point first[8];
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
        const struct jp_point *way = jp_grid_planner_path(&planner, &count);
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
    TEST_ASSERT_EQUAL_UINT8(1, planner.internal.disc_rows);
    config.clearance = CELL / 2 + 1; /* the straight neighbours */
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(3, planner.internal.disc_rows);
    TEST_ASSERT_EQUAL_INT8(0, planner.internal.disc[0].last);
    TEST_ASSERT_EQUAL_INT8(1, planner.internal.disc[1].last);
    config.clearance = CELL; /* and the diagonal ones, 0.71 away */
    start_planner();
    TEST_ASSERT_EQUAL_UINT8(3, planner.internal.disc_rows);
    TEST_ASSERT_EQUAL_INT8(1, planner.internal.disc[0].last);
    TEST_ASSERT_EQUAL_INT8(-1, planner.internal.disc[2].first);
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
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, start_task(0, 1, 4, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_BLOCKED, start_task(4, 1, 4, 4));
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
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 0, 7, 7));
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
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 0, 7, 0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
    TEST_ASSERT_TRUE(way_count() > 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 0, 1, 0));
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(100));
    (void)expect_way(0, 0, 1, 0);
}

/* ---- Where memory ends ---- */

static void test_full_queue(void)
{
    begin(JP_GRID_OCTILE, 0, 0, 7, 7);
    planner.internal.queue_max = 5;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(10));
    TEST_ASSERT_EQUAL_UINT32(0, (uint32_t)way_count());
    TEST_ASSERT_EQUAL_UINT32(5, jp_grid_planner_statistics(&planner)->queue_most);
}

static void test_too_many_turning_points(void)
{
    begin(JP_GRID_OCTILE, 0, 0, 7, 3);
    planner.internal.points_max = 2;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(10));
}

static void test_too_long_way(void)
{
    begin(JP_GRID_OCTILE, 0, 0, 7, 3);
    planner.internal.length_max = 6 * GRID_STRAIGHT;
    TEST_ASSERT_EQUAL_INT(JP_GRID_OUT_OF_MEMORY, finish(10));
}

static bool has_octile_way(void)
{
    return planner.internal.counts.octile_length != 0;
}

static bool is_spreading(void)
{
    return planner.internal.counts.edge_nodes > 0;
}

static bool is_descending(void)
{
    return planner.internal.candidate.count > 0;
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
    planner.internal.queue_max = planner.internal.queue_count;
    expect_shortcuts_alone();
}

static void test_edges_do_not_reach_the_start(void)
{
    begin_round_a_corner(is_spreading);
    jp_grid_node(&planner.internal, 0, 0)->place &= ~GRID_IN_TUBE;
    expect_shortcuts_alone();
}

static void test_descent_runs_out_of_points(void)
{
    begin_round_a_corner(is_descending);
    planner.internal.points_max = 2;
    expect_shortcuts_alone();
}

static void test_descent_ends_nowhere(void)
{
    begin_round_a_corner(is_descending);
    planner.internal.place_cost = 1;
    expect_shortcuts_alone();
}

static void test_way_ends_with_many_passes(void)
{
    begin_round_a_corner(has_octile_way);
    TEST_ASSERT_EQUAL_INT(JP_GRID_FOUND, finish(1));
    (void)expect_way(0, 0, 6, 1);
}
