/* Lines on the grid: along borders, past corners, between cells. */
#include "tests/support/grid_rig.h"

void setUp(void)
{
    rig_reset();
}

void tearDown(void)
{
}

static bool is_free(int x0, int y0, int x1, int y1)
{
    const struct jp_point from = {x0 * map.resolution / SIDE, y0 * map.resolution / SIDE};
    const struct jp_point to = {x1 * map.resolution / SIDE, y1 * map.resolution / SIDE};
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
    TEST_ASSERT_EQUAL_INT(JP_OK, start_task(0, 0, 0, 0));
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
