/* The path along a plan of the lattice. */
#include <joulepath/lattice_path.h>

#include "tests/support/planner_rig.h"

enum { PLACES = 8 };

static struct jp_path_piece pieces[PLACES];
static struct jp_lattice_path path;

void setUp(void)
{
    rig_reset();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&path, pieces, PLACES));
}

void tearDown(void)
{
}

/* The primitive that leads so far from one heading to another. */
static const struct jp_primitive *primitive_to(int dx, int dy, unsigned start, unsigned end)
{
    for (unsigned i = lattice->first_from[start]; i < lattice->first_from[start + 1U]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];

        if (primitive->dx == dx && primitive->dy == dy && primitive->end == end) {
            return primitive;
        }
    }
    TEST_FAIL_MESSAGE("no such primitive");
    return NULL;
}

static enum jp_status add(struct jp_lattice_pose *pose, int dx, int dy, unsigned end)
{
    const struct jp_primitive *primitive = primitive_to(dx, dy, pose->heading, end);
    const enum jp_status status = jp_lattice_path_add(&path, lattice, &terrain, pose, primitive);

    pose->x = (int16_t)(pose->x + dx);
    pose->y = (int16_t)(pose->y + dy);
    pose->heading = (uint8_t)end;
    return status;
}

static void expect_point(int32_t x, int32_t y, struct jp_point point)
{
    TEST_ASSERT_EQUAL_INT32((2 * x + 1) * lattice->resolution / 2, point.x);
    TEST_ASSERT_EQUAL_INT32((2 * y + 1) * lattice->resolution / 2, point.y);
}

static void test_start_refuses(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_start(NULL, pieces, PLACES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_start(&path, NULL, PLACES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_start(&path, pieces, 0));
}

static void test_add_refuses(void)
{
    const struct jp_primitive *straight = primitive_to(1, 0, 0, 0);

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_add(NULL, lattice, &terrain, &west, straight));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_add(&path, NULL, &terrain, &west, straight));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_add(&path, lattice, NULL, &west, straight));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_add(&path, lattice, &terrain, NULL, straight));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_add(&path, lattice, &terrain, &west, NULL));
    TEST_ASSERT_EQUAL_UINT(0, path.count);
}

static void test_straight_lines_become_one_piece(void)
{
    struct jp_lattice_pose pose = west;

    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    }
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    expect_point(west.x, west.y, pieces[0].begin);
    expect_point(west.x + 3, west.y, path.end.position);
    TEST_ASSERT_EQUAL_UINT32(0, pieces[0].heading);
    TEST_ASSERT_EQUAL_INT32(JP_PIECE_CURVE, pieces[0].kind);
    TEST_ASSERT_INT32_WITHIN(8, 3 * lattice->resolution * 256, pieces[0].length);
    TEST_ASSERT_EQUAL_INT32(0, pieces[0].bend);
    TEST_ASSERT_EQUAL_INT32(0, pieces[0].bend_rate);
}

static void test_turns_in_one_direction_become_one_piece(void)
{
    struct jp_lattice_pose pose = west;

    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 0, 0, 1));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 0, 0, 2));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    TEST_ASSERT_EQUAL_INT32(JP_PIECE_TURN_LEFT, pieces[0].kind);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q24(0.7853982), pieces[0].length);
    TEST_ASSERT_EQUAL_UINT32(lattice->heading[2], path.end.heading);
    expect_point(west.x, west.y, path.end.position);
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 0, 0, 1));
    TEST_ASSERT_EQUAL_UINT(2, path.count);
    TEST_ASSERT_EQUAL_INT32(JP_PIECE_TURN_RIGHT, pieces[1].kind);
    TEST_ASSERT_TRUE(pieces[1].length > 0);
    TEST_ASSERT_EQUAL_UINT32(lattice->heading[2], pieces[1].heading);
}

/* The curve of lattice_zhang2018 to (3, 1) and the next heading is 639 mm long by its table. */
static void test_curve(void)
{
    struct jp_lattice_pose pose = west;

    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 3, 1, 1));
    TEST_ASSERT_EQUAL_INT32(JP_PIECE_CURVE, pieces[0].kind);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0006), JP_Q24(0.639), pieces[0].length);
    TEST_ASSERT_INT32_WITHIN(
        16, 0,
        (int32_t)(jp_angle_from_radians(jp_piece_turned(&pieces[0], pieces[0].length)) - lattice->heading[1]) / 64);
    TEST_ASSERT_EQUAL_INT32(pieces[0].bend, jp_piece_bend(&pieces[0], 0));
    expect_point(west.x + 3, west.y + 1, path.end.position);
}

static void test_turned_of_turns(void)
{
    const struct jp_path_piece left = {.kind = JP_PIECE_TURN_LEFT};
    const struct jp_path_piece right = {.kind = JP_PIECE_TURN_RIGHT};

    TEST_ASSERT_EQUAL_INT32(77, jp_piece_turned(&left, 77));
    TEST_ASSERT_EQUAL_INT32(-77, jp_piece_turned(&right, 77));
}

/* Curves before and after straight lines stay pieces of their own, also where they go on alike. */
static void test_curves_are_not_joined(void)
{
    struct jp_lattice_pose pose = west;

    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 3, 1, 1));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 3, 2, 1));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 2, 1, 1));
    TEST_ASSERT_EQUAL_UINT(4, path.count);
}

static void raise_from(int32_t first_x, jp_elevation rise)
{
    for (int32_t y = 0; y < map.height; y++) {
        for (int32_t x = first_x; x < map.width; x++) {
            const jp_elevation level = jp_terrain_elevation(&terrain, x, y);

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(level + rise)));
        }
    }
}

static void test_the_ground_rises_with_a_piece(void)
{
    struct jp_lattice_pose pose = west;

    raise_from(west.x + 1, 2);
    raise_from(west.x + 2, 3);
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    TEST_ASSERT_EQUAL_INT32(5 * (JP_Q16_ONE / JP_ELEVATION_ONE), pieces[0].rise);
}

/* By the difference alone, not by how high it lies. */
static void test_high_ground_that_is_level_does_not_rise(void)
{
    struct jp_lattice_pose pose = west;

    raise_from(0, 10);
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT32(0, pieces[0].rise);
    raise_from(west.x + 2, -3);
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT32(-3 * (JP_Q16_ONE / JP_ELEVATION_ONE), pieces[path.count - 1U].rise);
}

/* The level map with classes of ground. */
static void classify(void)
{
    map.has_classes = true;
    make_level_map(&map);
}

static void lay(int32_t low_x, int32_t high_x, int32_t low_y, int32_t high_y, uint8_t ground)
{
    for (int32_t y = low_y; y <= high_y; y++) {
        for (int32_t x = low_x; x <= high_x; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, x, y, ground));
        }
    }
}

static void expect_ground(unsigned left, unsigned right)
{
    TEST_ASSERT_EQUAL_UINT8(left, pieces[path.count - 1U].ground_left);
    TEST_ASSERT_EQUAL_UINT8(right, pieces[path.count - 1U].ground_right);
}

static void test_the_ground_beside_a_line_is_that_of_its_sides(void)
{
    struct jp_lattice wide = *lattice;

    wide.sides[0] = (struct jp_cell_offset){0, 2};
    classify();
    lay(0, map.width - 1, west.y + 2, west.y + 2, 1);
    lay(0, map.width - 1, west.y - 2, west.y - 2, 2);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_add(&path, &wide, &terrain, &west, primitive_to(1, 0, 0, 0)));
    expect_ground(1, 2);
}

/* Of curves that lead to all four sides, the row or column halfway. */
static void test_the_ground_beside_a_curve_is_that_halfway(void)
{
    static const int8_t ways[][2] = {{3, 1}, {-1, 3}, {-3, -1}, {1, -3}};

    for (unsigned quarter = 0; quarter < 4U; quarter++) {
        const int dx = ways[quarter][0];
        const int dy = ways[quarter][1];
        struct jp_lattice_pose pose = {8, 4, (uint8_t)(4U * quarter)};
        const int x = pose.x + dx / 2;
        const int y = pose.y + dy / 2;

        setUp();
        classify();
        if (dx / 2 != 0) {
            lay(x, x, 0, map.height - 1, 3);
        } else {
            lay(0, map.width - 1, y, y, 3);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, dx, dy, 4U * quarter + 1U));
        expect_ground(3, 3);
    }
}

static void test_a_steeper_part_is_a_piece_of_its_own(void)
{
    struct jp_lattice_pose pose = west;

    raise_from(west.x + 2, 40);
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT(3, path.count);
    TEST_ASSERT_EQUAL_INT32(0, pieces[0].rise);
    TEST_ASSERT_EQUAL_INT32(40 * (JP_Q16_ONE / JP_ELEVATION_ONE), pieces[1].rise);
    TEST_ASSERT_EQUAL_INT32(0, pieces[2].rise);
}

static void test_pieces_do_not_outgrow_their_format(void)
{
    struct jp_lattice_pose pose = west;

    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    pieces[0].length = JP_PIECE_LENGTH_MAX - JP_Q24(0.1);
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_UINT(2, path.count);
}

static void test_memory_that_is_full(void)
{
    struct jp_lattice_pose pose = west;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&path, pieces, 1));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_OK, add(&pose, 1, 0, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, add(&pose, 0, 0, 1));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    expect_point(west.x + 2, west.y, path.end.position);
    TEST_ASSERT_EQUAL_UINT32(0, path.end.heading);
}

/* Cells so small, or large, that a piece cannot be as short, as long or as bent. */
static void expect_infeasible(jp_q16 cell, int dx, int dy, unsigned start, unsigned end)
{
    const struct jp_lattice_pose from = {4, 4, (uint8_t)start};

    terrain.config.resolution = cell;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE,
                          jp_lattice_path_add(&path, lattice, &terrain, &from, primitive_to(dx, dy, start, end)));
    TEST_ASSERT_EQUAL_UINT(0, path.count);
}

static void test_curves_that_no_piece_can_be(void)
{
    expect_infeasible(JP_Q16(0.0005), 1, 0, 0, 0);
    expect_infeasible(JP_Q16(65), 1, 0, 0, 0);
    expect_infeasible(JP_Q16(0.002), 3, 1, 0, 1);
    expect_infeasible(JP_Q16(0.002), 2, 0, 1, 15);
    expect_infeasible(JP_Q16(0.002), 1, 1, 1, 3);
    expect_infeasible(JP_Q16(0.002), 3, -1, 15, 0);
}

static void test_a_primitive_that_leads_back(void)
{
    const struct jp_primitive back = {.dx = -2, .dy = 1, .end = 13, .move_count = 1};

    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_lattice_path_add(&path, lattice, &terrain, &west, &back));
}

static void find_plan(void)
{
    start_planner(sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &west));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &east));
    for (unsigned i = 0; i < BUDGET_MAX && !jp_planner_is_idle(&planner); i++) {
        (void)jp_planner_work(&planner, 1);
    }
}

static void test_path_of_a_plan(void)
{
    find_plan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_of_plan(&path, &planner, pieces, PLACES));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    expect_point(west.x, west.y, pieces[0].begin);
    expect_point(east.x, east.y, path.end.position);
}

static void test_plan_without_a_step(void)
{
    start_planner(sizeof block);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_lattice_path_of_plan(&path, &planner, pieces, PLACES));
    find_plan();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &(struct jp_lattice_pose){east.x, east.y, 0}));
    for (unsigned i = 0; i < BUDGET_MAX && !jp_planner_is_idle(&planner); i++) {
        (void)jp_planner_work(&planner, 1);
    }
    TEST_ASSERT_EQUAL_UINT(0, jp_planner_plan(&planner)->step_count);
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_lattice_path_of_plan(&path, &planner, pieces, PLACES));
}

static void test_path_of_a_plan_refuses(void)
{
    find_plan();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_of_plan(&path, NULL, pieces, PLACES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_of_plan(NULL, &planner, pieces, PLACES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_lattice_path_of_plan(&path, &planner, NULL, PLACES));
}

/* A frame at (2 m, 1 m) that looks along y. */
static void test_path_in_the_frame_of_a_place(void)
{
    struct jp_path_piece two[2] = {{.begin = {JP_Q16(2), JP_Q16(1)}, .heading = JP_ANGLE_DEGREES(90)},
                                   {.begin = {JP_Q16(2), JP_Q16(4)}, .heading = JP_ANGLE_DEGREES(45)}};
    struct jp_lattice_path moved = {
        .pieces = two, .places = 2, .count = 2, .end = {{JP_Q16(1), JP_Q16(4)}, JP_ANGLE_DEGREES(-90)}};
    const struct jp_path_pose origin = {{JP_Q16(2), JP_Q16(1)}, JP_ANGLE_DEGREES(90)};

    jp_lattice_path_in_frame(&moved, &origin);
    TEST_ASSERT_INT32_WITHIN(4, 0, two[0].begin.x);
    TEST_ASSERT_INT32_WITHIN(4, 0, two[0].begin.y);
    TEST_ASSERT_EQUAL_UINT32(0, two[0].heading);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(3), two[1].begin.x);
    TEST_ASSERT_INT32_WITHIN(4, 0, two[1].begin.y);
    TEST_ASSERT_EQUAL_UINT32(JP_ANGLE_DEGREES(-45), two[1].heading);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(3), moved.end.position.x);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(1), moved.end.position.y);
    TEST_ASSERT_EQUAL_UINT32(JP_ANGLE_DEGREES(180), moved.end.heading);
}

/* To the left and to the right: each turns as far as its headings differ, and ends in its cell. */
static void test_every_primitive_is_a_piece(void)
{
    for (unsigned start = 0; start < JP_HEADINGS; start++) {
        for (unsigned i = lattice->first_from[start]; i < lattice->first_from[start + 1U]; i++) {
            const struct jp_primitive *primitive = &lattice->primitives[i];
            const struct jp_lattice_pose from = {8, 4, (uint8_t)start};
            const struct jp_path_piece *piece = &pieces[0];

            TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&path, pieces, PLACES));
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_add(&path, lattice, &terrain, &from, primitive));
            const jp_q24 turned = piece->kind == JP_PIECE_CURVE       ? jp_piece_turned(piece, piece->length)
                                  : piece->kind == JP_PIECE_TURN_LEFT ? piece->length
                                                                      : -piece->length;

            TEST_ASSERT_EQUAL_UINT(1, path.count);
            TEST_ASSERT_EQUAL_UINT(primitive->move_count == 0U, piece->kind != JP_PIECE_CURVE);
            TEST_ASSERT_INT32_WITHIN(JP_Q24(0.0005),
                                     jp_angle_to_radians(lattice->heading[primitive->end] - lattice->heading[start]),
                                     turned);
            expect_point(8 + primitive->dx, 4 + primitive->dy, path.end.position);
        }
    }
}
