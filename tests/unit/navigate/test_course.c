/* Courses: what is refused, lines along a plan with their margins and ends, where there is no room, and random maps. */
#include <joulepath/course.h>
#include <joulepath/tables.h>
#include <stddef.h>
#include <string.h>

#include "src/map/capsule.h"
#include "src/map/line_cost.h"
#define LEVEL_MAP_BYTES 1344 /* 24 × 24 cells with elevation */
#include "tests/support/level_map.h"
#include "tests/target/random.h"
#include "unity.h"

enum {
    SIDE = 24,
    BLOCK_BYTES = 7 * 1024,
    LEGS_MAX = 16,
    MAPS = 400,
    BUDGET_MAX = 20000, /* expansions, or lines, after which a search hangs */
    GAP_X = 12,         /* of the wall */
    GAP_FIRST = 3,
    GAP_LAST = 8 /* the lattice needs five cells */
};

static const struct jp_lattice *lattice;
static const struct jp_lattice_pose west = {4, 18, 0};
static const struct jp_goal east = {19, 18, JP_ANY_HEADING};

static struct jp_terrain_config map;
static struct jp_planner planner;
static uint64_t block[BLOCK_BYTES / sizeof(uint64_t)];
static struct jp_course_leg legs[LEGS_MAX];
static struct jp_course_config config;
static struct jp_course course;

/* ---- The rig ---- */

static void make_map(uint16_t width, uint16_t height)
{
    map = (struct jp_terrain_config){.width = width, .height = height, .resolution = lattice->resolution};
    make_level_map(&map);
}

void setUp(void)
{
    lattice = &jp_lattice_courier24;
    make_map(SIDE, SIDE);
    memset(legs, 0x5A, sizeof legs);
    config = (struct jp_course_config){
        .terrain = &terrain, .radius = JP_Q16(0.16), .margin = JP_Q16(0.05), .legs = legs, .legs_max = LEGS_MAX};
}

void tearDown(void)
{
}

static void init(void)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_course_init(&course, &config, &field));
    TEST_ASSERT_NULL(field);
}

static void start_planner(void)
{
    const struct jp_planner_config greedy = {
        .lattice = lattice, .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(4), JP_EPSILON(1.5)}};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&planner, &greedy, &terrain, block, sizeof block, &field));
}

static enum jp_answer finish_plan(void)
{
    for (int i = 0; !jp_planner_is_idle(&planner); i++) {
        TEST_ASSERT_TRUE(i < BUDGET_MAX);
        (void)jp_planner_work(&planner, 1);
    }
    return jp_planner_work(&planner, 1);
}

static enum jp_answer plan(const struct jp_lattice_pose *from, const struct jp_goal *to)
{
    start_planner();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, from));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, to));
    return finish_plan();
}

static void plan_route(const struct jp_lattice_pose *from, const struct jp_goal *to)
{
    const enum jp_answer answer = plan(from, to);

    TEST_ASSERT_TRUE(answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND);
}

static struct jp_point centre(int32_t x, int32_t y)
{
    return (struct jp_point){(2 * x + 1) * map.resolution / 2, (2 * y + 1) * map.resolution / 2};
}

/* Of the robot in its cell, m. */
static struct jp_point beside(const struct jp_lattice_pose *pose, jp_q16 dx, jp_q16 dy)
{
    const struct jp_point middle = centre(pose->x, pose->y);

    return (struct jp_point){middle.x + dx, middle.y + dy};
}

static enum jp_course_answer join(const struct jp_point *from)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_course_start(&course, &planner, from));
    for (int i = 0; course.answer == JP_COURSE_JOINING; i++) {
        const enum jp_course_answer answer = jp_course_work(&course);

        TEST_ASSERT_TRUE(i < BUDGET_MAX);
        TEST_ASSERT_EQUAL_INT(answer, course.answer);
    }
    return course.answer;
}

static enum jp_course_answer join_from_pose(const struct jp_lattice_pose *pose)
{
    const struct jp_point from = beside(pose, 0, 0);

    init();
    return join(&from);
}

static void build_wall(void)
{
    put_column(GAP_X, 0, GAP_FIRST - 1, JP_CELL_OCCUPIED);
    put_column(GAP_X, GAP_LAST + 1, map.height - 1, JP_CELL_OCCUPIED);
}

static int64_t square_of_length(const struct jp_point *a, const struct jp_point *b)
{
    const int64_t dx = (int64_t)b->x - a->x;
    const int64_t dy = (int64_t)b->y - a->y;

    return dx * dx + dy * dy;
}

static void expect_point(const struct jp_point *expected, const struct jp_point *actual)
{
    TEST_ASSERT_EQUAL_INT32(expected->x, actual->x);
    TEST_ASSERT_EQUAL_INT32(expected->y, actual->y);
}

static void expect_leg(unsigned index)
{
    const int64_t reach = (int64_t)JP_COURSE_REACH * map.resolution;
    const struct jp_course_leg *leg = &legs[index];
    const struct jp_point from = jp_course_begin(&course, index);
    const struct jp_capsule capsule = {from, leg->end, config.radius + leg->margin};

    TEST_ASSERT_TRUE(leg->margin == config.margin || (index == 0U && leg->margin == 0));
    TEST_ASSERT_EQUAL_INT32(0, leg->aside);
    TEST_ASSERT_EQUAL_INT(index + 1U == course.count, leg->is_stop);
    TEST_ASSERT_TRUE(jp_capsule_is_clear(&terrain, &capsule));
    TEST_ASSERT_TRUE(jp_course_is_clear(&course, index, &from));
    TEST_ASSERT_TRUE(square_of_length(&from, &leg->end) <= reach * reach);
}

/* A course from the point to the end of the plan. */
static void expect_course(const struct jp_point *from)
{
    const struct jp_lattice_pose *goal = &jp_planner_plan(&planner)->end;
    const struct jp_point end = centre(goal->x, goal->y);
    struct jp_point begin = jp_course_begin(&course, 0);

    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, course.answer);
    TEST_ASSERT_TRUE(course.count > 0U && course.count <= config.legs_max);
    expect_point(from, &begin);
    for (unsigned i = 0; i < course.count; i++) {
        expect_leg(i);
        begin = jp_course_begin(&course, i + 1U);
        expect_point(&legs[i].end, &begin);
    }
    expect_point(&end, &legs[course.count - 1U].end);
}

static void join_west(void)
{
    const struct jp_point from = beside(&west, 0, 0);

    plan_route(&west, &east);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&from));
    expect_course(&from);
}

/* ---- Arguments ---- */

static void test_null_is_refused(void)
{
    const struct jp_point from = beside(&west, 0, 0);
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_init(NULL, &config, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_init(&course, NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_init(&course, &config, NULL));
    init();
    plan_route(&west, &east);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start(NULL, &planner, &from));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start(&course, NULL, &from));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start(&course, &planner, NULL));
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROUTE, course.answer);
}

static void expect_bad_field(const char *expected)
{
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_course_init(&course, &config, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    setUp();
}

static void test_fields_out_of_range(void)
{
    config.terrain = NULL;
    expect_bad_field("terrain");
    config.radius = (map.resolution - 1) / 4;
    expect_bad_field("radius");
    config.radius = 32 * map.resolution + 1;
    expect_bad_field("radius");
    config.radius = -1;
    expect_bad_field("radius");
    config.margin = -1;
    expect_bad_field("margin");
    config.margin = 16 * map.resolution + 1;
    expect_bad_field("margin");
    config.legs = NULL;
    expect_bad_field("legs");
    config.legs_max = 0;
    expect_bad_field("legs_max");
}

static void test_fields_at_their_limits(void)
{
    terrain.config.resolution = JP_Q16(0.125);
    config.radius = JP_Q16(0.03125);
    config.margin = 0;
    config.legs_max = 1;
    init();
    config.radius = JP_Q16(4);
    config.margin = JP_Q16(2);
    config.legs_max = UINT16_MAX;
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROUTE, course.answer);
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
}

static void test_no_work_before_a_start(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROUTE, jp_course_work(&course));
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROUTE, jp_course_work(&course));
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
}

static void expect_no_plan(void)
{
    const struct jp_point from = beside(&west, 0, 0);

    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_course_start(&course, &planner, &from));
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROUTE, jp_course_work(&course));
}

static void test_a_planner_without_a_plan(void)
{
    start_planner();
    expect_no_plan();
    put_column(GAP_X, 0, SIDE - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_UNREACHABLE, plan(&west, &east));
    expect_no_plan();
}

/* ---- Lines ---- */

static void test_an_empty_map_takes_one_line(void)
{
    const struct jp_point end = centre(east.x, east.y);

    join_west();
    TEST_ASSERT_EQUAL_UINT16(1, course.count);
    expect_point(&end, &legs[0].end);
    TEST_ASSERT_TRUE(legs[0].is_stop);
    TEST_ASSERT_EQUAL_INT32(config.margin, legs[0].margin);
}

static void test_lines_through_a_gap(void)
{
    build_wall();
    join_west();
    TEST_ASSERT_TRUE(course.count > 2U);
}

static void test_the_last_leg_alone_is_a_stop(void)
{
    const struct jp_point from = beside(&west, 0, 0);

    build_wall();
    plan_route(&west, &east);
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_course_start(&course, &planner, &from));
    while (jp_course_work(&course) == JP_COURSE_JOINING) {
        for (unsigned i = 0; i < course.count; i++) {
            TEST_ASSERT_FALSE(legs[i].is_stop);
        }
    }
    expect_course(&from);
}

static void test_the_answer_stays(void)
{
    uint16_t count;

    build_wall();
    join_west();
    count = course.count;
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, jp_course_work(&course));
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, jp_course_work(&course));
    TEST_ASSERT_EQUAL_UINT16(count, course.count);
}

/* Nothing is left of the course before. */
static void test_another_course(void)
{
    build_wall();
    join_west();
    make_map(SIDE, SIDE);
    join_west();
    TEST_ASSERT_EQUAL_UINT16(1, course.count);
}

static void expect_no_legs(const struct jp_lattice_pose *from, const struct jp_goal *to, unsigned steps_min)
{
    plan_route(from, to);
    TEST_ASSERT_TRUE(jp_planner_plan(&planner)->step_count >= steps_min);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_from_pose(from));
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, jp_course_work(&course));
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
}

/* Walls all round leave it no way but to turn where it is. */
static void test_routes_that_stay_in_their_cell(void)
{
    const struct jp_goal here = {west.x, west.y, JP_ANY_HEADING};
    const struct jp_goal turned = {west.x, west.y, 1U << 2};

    expect_no_legs(&west, &here, 0);
    make_map(5, 5);
    expect_no_legs(&(struct jp_lattice_pose){2, 2, 0}, &(struct jp_goal){2, 2, 1U << 3}, 3);
    make_map(SIDE, SIDE);
    put_column(west.x - 3, 0, SIDE - 1, JP_CELL_OCCUPIED);
    put_column(west.x + 3, 0, SIDE - 1, JP_CELL_OCCUPIED);
    expect_no_legs(&west, &turned, 2);
}

/* The robot turns at the begin, on the way, and at the end. */
static void test_turns_on_the_spot_between_lines(void)
{
    const struct jp_lattice_pose from = {4, 18, 8};
    const struct jp_goal to = {19, 18, 1U << 12};
    const struct jp_point begin = beside(&from, 0, 0);

    build_wall();
    put_column(7, 16, SIDE - 1, JP_CELL_OCCUPIED);
    plan_route(&from, &to);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_from_pose(&from));
    expect_course(&begin);
}

static void test_a_robot_beside_the_middle_of_its_cell(void)
{
    const jp_q16 aside = map.resolution / 2 - 1;

    build_wall();
    plan_route(&west, &east);
    init();
    for (int i = 0; i < 4; i++) {
        const struct jp_point from = beside(&west, i % 2 == 0 ? aside : -aside, i < 2 ? aside : -aside);

        TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&from));
        expect_course(&from);
    }
}

/* It has driven on meanwhile, and is at the second place of the plan but for a few millimetres. */
static void test_places_where_the_robot_is_are_passed_over(void)
{
    const struct jp_goal ahead = {west.x + 3, west.y, 1};
    const struct jp_point from = beside(&west, map.resolution + JP_Q16(0.003), -JP_Q16(0.003));

    plan_route(&west, &ahead);
    TEST_ASSERT_EQUAL_UINT16(3, jp_planner_plan(&planner)->step_count);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&from));
    expect_course(&from);
    TEST_ASSERT_EQUAL_UINT16(1, course.count);
}

/* So long a plan takes more states than the block holds: it begins far ahead of the robot. */
static void test_no_line_is_longer_than_the_reach(void)
{
    const struct jp_lattice_pose ahead = {100, 2, 0};
    const struct jp_goal to = {135, 2, 1};
    const struct jp_point from = centre(3, 2);
    const struct jp_point end = centre(3 + JP_COURSE_REACH, 2);

    make_map(140, 5);
    plan_route(&ahead, &to);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&from));
    expect_course(&from);
    TEST_ASSERT_EQUAL_UINT16(2, course.count);
    expect_point(&end, &legs[0].end);
}

/* ---- What cannot be joined ---- */

static void test_too_few_legs(void)
{
    const struct jp_point from = beside(&west, 0, 0);
    uint16_t needed;

    build_wall();
    join_west();
    needed = course.count;
    config.legs_max = needed;
    join_west();
    config.legs_max = (uint16_t)(needed - 1U);
    legs[needed - 1U].end = (struct jp_point){-1, -1};
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_TOO_LONG, join(&from));
    TEST_ASSERT_EQUAL_UINT16(needed - 1U, course.count);
    TEST_ASSERT_EQUAL_INT32(-1, legs[needed - 1U].end.x);
    TEST_ASSERT_FALSE(legs[needed - 2U].is_stop);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_TOO_LONG, jp_course_work(&course));
}

static void expect_no_room(uint16_t count)
{
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROOM, join_from_pose(&west));
    TEST_ASSERT_EQUAL_UINT16(count, course.count);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROOM, jp_course_work(&course));
}

/* With a margin it is tried again without one. */
static void test_a_robot_larger_than_the_lattice_is_for(void)
{
    build_wall();
    plan_route(&west, &east);
    config.radius = JP_Q16(0.6);
    expect_no_room(0);
    config.margin = 0;
    expect_no_room(0);
}

/* The gap is as narrow as the lattice allows, where there would be room without the margin: it is the first line alone
 * that may do without. */
static void test_no_room_later_on(void)
{
    put_column(GAP_X, 0, GAP_FIRST - 1, JP_CELL_OCCUPIED);
    put_column(GAP_X, GAP_FIRST + 5, SIDE - 1, JP_CELL_OCCUPIED);
    plan_route(&west, &east);
    config.radius = JP_Q16(0.22);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROOM, join_from_pose(&west));
    TEST_ASSERT_GREATER_THAN_UINT32(0, course.count);
    TEST_ASSERT_EQUAL_INT32(config.margin, legs[0].margin);
}

/* It has room where it is, and a few millimetres from there; no line is as short as that. */
static void test_no_room_but_to_stand(void)
{
    const struct jp_lattice_pose from = {4, 12, 0};
    const struct jp_goal to = {19, 12, JP_ANY_HEADING};
    const struct jp_point near = beside(&from, -JP_Q16(0.003), 0);

    put_column(9, 0, from.y - 3, JP_CELL_OCCUPIED);
    put_column(9, from.y + 3, SIDE - 1, JP_CELL_OCCUPIED);
    plan_route(&from, &to);
    config.radius = JP_Q16(0.44);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROOM, join(&near));
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
}

/* ---- Margins ---- */

/* 20 cm from a wall: more than the radius, less than what it keeps elsewhere. */
static void test_a_begin_nearer_to_obstacles_than_the_margin(void)
{
    const struct jp_lattice_pose from = {4, 4, 4};
    const struct jp_point near = beside(&from, -map.resolution / 2 + 1, 0);
    const struct jp_point middle = beside(&from, 0, 0);

    build_wall();
    put_column(1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    plan_route(&from, &east);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&near));
    expect_course(&near);
    TEST_ASSERT_TRUE(course.count > 1U);
    TEST_ASSERT_EQUAL_INT32(0, legs[0].margin);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&middle));
    expect_course(&middle);
    TEST_ASSERT_EQUAL_INT32(config.margin, legs[0].margin);
}

/* 15 cm from a wall, with a disc of 16 cm. */
static void test_from_within_the_radius_it_comes_no_nearer(void)
{
    const struct jp_lattice_pose from = {4, 4, 4};
    const struct jp_point near = beside(&from, -map.resolution, 0);

    put_column(1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    plan_route(&from, &east);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&near));
    TEST_ASSERT_EQUAL_INT32(jp_course_room(&course, &near), legs[0].margin);
    TEST_ASSERT_INT32_WITHIN(map.resolution / 8, JP_Q16(-0.01), legs[0].margin);
    TEST_ASSERT_TRUE(jp_course_is_clear(&course, 0, &near));
    for (unsigned i = 1; i < course.count; i++) {
        TEST_ASSERT_EQUAL_INT32(config.margin, legs[i].margin);
    }
}

static void test_room_where_the_robot_stands(void)
{
    put_column(1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    init();
    for (jp_q16 away = 0; away < JP_Q16(0.4); away += JP_Q16(0.01)) {
        const struct jp_point from = {2 * map.resolution + away, JP_Q16(1)};
        const jp_q16 room = jp_course_room(&course, &from);
        const jp_q16 beyond = config.radius - away; /* of the disc, in the wall */
        const jp_q16 expected = beyond <= 0 ? 0 : beyond < map.resolution ? -beyond : -map.resolution;

        TEST_ASSERT_INT32_WITHIN(map.resolution / 8, expected, room);
        TEST_ASSERT_TRUE(room <= 0 && room >= -map.resolution);
    }
}

/* Of a disc of half a cell a quarter must stay. */
static void test_room_of_a_small_disc(void)
{
    const struct jp_point inside = {map.resolution + map.resolution / 2, JP_Q16(1)};

    config.radius = map.resolution / 2;
    put_column(1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    init();
    TEST_ASSERT_EQUAL_INT32(map.resolution / 4 - config.radius, jp_course_room(&course, &inside));
}

/* Cells of which an eighth is less than a unit. */
static void test_room_on_a_map_of_the_smallest_cells(void)
{
    map = (struct jp_terrain_config){.width = SIDE, .height = SIDE, .resolution = 4};
    make_level_map(&map);
    config.radius = 4;
    config.margin = 0;
    init();
    const struct jp_point from = centre(12, 12);

    TEST_ASSERT_EQUAL_INT32(0, jp_course_room(&course, &from));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, 12, 12, JP_CELL_OCCUPIED));
    TEST_ASSERT_EQUAL_INT32(map.resolution / 4 - config.radius, jp_course_room(&course, &from));
}

/* A disc and its margin may be wider than a length can be: nothing is clear for it. */
static void test_no_room_for_the_widest_disc(void)
{
    map = (struct jp_terrain_config){.width = SIDE, .height = SIDE, .resolution = JP_Q16(1200)};
    make_level_map(&map);
    config.radius = JP_Q16(32000);
    config.margin = JP_Q16(19000);
    legs[0] = (struct jp_course_leg){.margin = config.margin};
    init();
    const struct jp_point from = centre(12, 12);

    TEST_ASSERT_FALSE(jp_course_is_clear(&course, 0, &from));
}

/* Nearer than the radius by more than a cell. */
static void test_a_begin_without_room(void)
{
    const struct jp_lattice_pose from = {4, 4, 4};
    const struct jp_point near = beside(&from, -2 * map.resolution, 0);

    put_column(1, 0, SIDE - 1, JP_CELL_OCCUPIED);
    plan_route(&from, &east);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROOM, join(&near));
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
}

/* ---- Whether a line is clear ---- */

static void occupy_middle_of(unsigned index)
{
    const struct jp_point from = jp_course_begin(&course, index);
    const int32_t x = (from.x + legs[index].end.x) / 2 / map.resolution;
    const int32_t y = (from.y + legs[index].end.y) / 2 / map.resolution;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED));
}

static bool is_clear(unsigned index)
{
    const struct jp_point from = jp_course_begin(&course, index);

    return jp_course_is_clear(&course, index, &from);
}

static void test_an_obstacle_on_a_line(void)
{
    unsigned blocked;

    build_wall();
    join_west();
    blocked = course.count - 1U;
    occupy_middle_of(blocked);
    for (unsigned i = 0; i < course.count; i++) {
        TEST_ASSERT_EQUAL_INT(i != blocked, is_clear(i));
    }
}

/* The robot has passed it. */
static void test_an_obstacle_behind_the_robot(void)
{
    struct jp_point from;

    join_west();
    occupy_middle_of(0);
    TEST_ASSERT_FALSE(is_clear(0));
    from = (struct jp_point){legs[0].end.x - JP_Q16(0.4), legs[0].end.y};
    TEST_ASSERT_TRUE(jp_course_is_clear(&course, 0, &from));
    from.x = legs[0].end.x - (JP_COURSE_REACH + 1) * map.resolution;
    TEST_ASSERT_FALSE(jp_course_is_clear(&course, 0, &from));
}

/* The obstacle is 35 cm from the line, of which radius and margin take 21. */
static void test_what_the_robot_leaves_aside(void)
{
    join_west();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&terrain, GAP_X, west.y - 4, JP_CELL_OCCUPIED));
    TEST_ASSERT_TRUE(is_clear(0));
    legs[0].aside = JP_Q16(0.13);
    TEST_ASSERT_TRUE(is_clear(0));
    legs[0].aside = JP_Q16(0.15);
    TEST_ASSERT_FALSE(is_clear(0));
    legs[0].margin = 0;
    TEST_ASSERT_TRUE(is_clear(0));
}

/* ---- Random maps ---- */

static uint32_t random_state;

static int32_t below(int32_t bound)
{
    return (int32_t)(target_random(&random_state) % (uint32_t)bound);
}

static void occupy_at_random(void)
{
    for (int32_t i = below(6); i >= 0; i--) {
        const int32_t x = below(SIDE);
        const int32_t y = below(SIDE);
        const int32_t last = y + below(6);

        put_column(x, y, last < SIDE ? last : SIDE - 1, JP_CELL_OCCUPIED);
    }
}

static struct jp_lattice_pose random_pose(void)
{
    const int32_t x = below(SIDE);
    const int32_t y = below(SIDE);

    return (struct jp_lattice_pose){(int16_t)x, (int16_t)y, (uint8_t)below(JP_HEADINGS)};
}

/* False: the robot cannot stand there, or there is no way. */
static bool plan_at_random(struct jp_lattice_pose *from)
{
    const struct jp_lattice_pose to = random_pose();
    const uint16_t headings = (uint16_t)(below(2) == 0 ? (unsigned)JP_ANY_HEADING : 1U << to.heading);
    const struct jp_goal goal = {to.x, to.y, headings};

    *from = random_pose();
    make_map(SIDE, SIDE);
    occupy_at_random();
    start_planner();
    if (jp_planner_set_start(&planner, from) != JP_OK || jp_planner_set_goal(&planner, &goal) != JP_OK) {
        return false;
    }
    const enum jp_answer answer = finish_plan();

    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND;
}

/* Lines cut corners: with a disc 2.5 cm smaller than that of the lattice there is always a course. */
static void test_random_maps(void)
{
    unsigned courses = 0;
    unsigned with_corners = 0;

    random_state = 1;
    init();
    for (unsigned i = 0; i < MAPS; i++) {
        struct jp_lattice_pose pose;

        if (!plan_at_random(&pose)) {
            continue;
        }
        const jp_q16 dx = below(map.resolution) - map.resolution / 2;
        const struct jp_point from = beside(&pose, dx, below(map.resolution) - map.resolution / 2);

        TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&from));
        if (course.count > 0U) {
            expect_course(&from);
            courses++;
            with_corners += course.count > 1U;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 4, courses);
    TEST_ASSERT_GREATER_THAN_UINT32(MAPS / 40, with_corners);
}

/* It has no format, and no room either. */
static void test_a_robot_that_leaves_its_line_by_kilometres(void)
{
    plan_route(&west, &east);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_from_pose(&west));
    const struct jp_point begin = jp_course_begin(&course, 0);

    legs[0].aside = INT32_MAX;
    TEST_ASSERT_FALSE(jp_course_is_clear(&course, 0, &begin));
}

static void test_a_start_on_another_continent(void)
{
    const struct jp_point far = {INT32_MIN, INT32_MAX};

    plan_route(&west, &east);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_NO_ROOM, join(&far));
}

/* ---- Along a way of unit steps ---- */

static struct jp_lattice_way way;
static uint64_t way_block[3 * SIDE * SIDE / 64 + 1];

static enum jp_course_answer join_way(const struct jp_way_cell *from, const struct jp_way_cell *to)
{
    const struct jp_point start = centre(from->x, from->y);

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_way_start(&way, lattice, &terrain, from, to, way_block, sizeof way_block));
    while (jp_lattice_way_work(&way, 100) == JP_WAY_WORKING) {
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_course_start_on_way(&course, &way, from, &start));
    while (jp_course_work(&course) == JP_COURSE_JOINING) {
    }
    return course.answer;
}

static void test_refuses_a_way(void)
{
    const struct jp_way_cell from = {4, 18};
    const struct jp_point start = centre(4, 18);

    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_way(NULL, &way, &from, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_way(&course, NULL, &from, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_way(&course, &way, NULL, &start));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_course_start_on_way(&course, &way, &from, NULL));
}

static void test_a_way_over_free_ground_is_one_line(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_way(&(struct jp_way_cell){4, 18}, &(struct jp_way_cell){19, 5}));
    TEST_ASSERT_EQUAL_UINT16(1, course.count);
    TEST_ASSERT_EQUAL_INT32(centre(19, 5).x, legs[0].end.x);
    TEST_ASSERT_EQUAL_INT32(centre(19, 5).y, legs[0].end.y);
    TEST_ASSERT_TRUE(legs[0].is_stop);
}

static void test_a_way_round_a_wall_is_some_clear_lines(void)
{
    put_column(GAP_X, 0, 14, JP_CELL_OCCUPIED);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_way(&(struct jp_way_cell){4, 4}, &(struct jp_way_cell){19, 4}));
    TEST_ASSERT_GREATER_THAN_UINT16(1, course.count);
    TEST_ASSERT_LESS_THAN_UINT16(5, course.count);
    for (uint16_t i = 0; i < course.count; i++) {
        const struct jp_point begin = jp_course_begin(&course, i);
        TEST_ASSERT_TRUE(jp_course_is_clear(&course, i, &begin));
    }
    TEST_ASSERT_EQUAL_INT32(centre(19, 4).x, legs[course.count - 1U].end.x);
}

static void test_a_way_that_does_not_leave_its_cell_has_no_legs(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_way(&(struct jp_way_cell){9, 9}, &(struct jp_way_cell){9, 9}));
    TEST_ASSERT_EQUAL_UINT16(0, course.count);
}

/* ---- Along part of a route ---- */

static void test_a_partial_route_is_followed_to_its_end(void)
{
    put_column(8, 0, 17, JP_CELL_OCCUPIED);
    put_column(16, 6, SIDE - 1, JP_CELL_OCCUPIED);
    const struct jp_planner_config greedy = {.lattice = lattice, .cost = JP_COST_PHYSICAL, .epsilon = {JP_EPSILON(4)}};
    const struct jp_lattice_pose from = {4, 4, 0};
    const struct jp_point start = centre(4, 4);
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_init(&planner, &greedy, &terrain, block, jp_planner_size(&map), &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(&planner, &from));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(&planner, &(struct jp_goal){20, 18, JP_ANY_HEADING}));
    TEST_ASSERT_EQUAL_INT(JP_ANSWER_PARTIAL, finish_plan());
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join(&start));
    const struct jp_lattice_pose *end = &jp_planner_plan(&planner)->end;

    TEST_ASSERT_GREATER_THAN_UINT16(0, course.count);
    TEST_ASSERT_EQUAL_INT32(centre(end->x, end->y).x, legs[course.count - 1U].end.x);
}

/* ---- Over hills ---- */

static const struct jp_way_cell west_cell = {4, 18};
static const struct jp_way_cell east_cell = {19, 18};

static void make_hills(jp_elevation (*elevation)(int32_t x, int32_t y))
{
    map = (struct jp_terrain_config){
        .width = SIDE, .height = SIDE, .resolution = lattice->resolution, .has_elevation = true};
    make_level_map(&map);
    raise_map(elevation);
}

/* By a quarter, 15 cm high, across the straight way, up to its south end. */
static jp_elevation ridge(int32_t x, int32_t y)
{
    const int32_t off = x < 12 ? 12 - x : x - 12;
    const int32_t height = off < 6 ? 150 - 25 * off : 0;

    return (jp_elevation)(y > 16 ? height : 0);
}

/* Of 0.3 m, as far as a robot can pass round it in the south. */
static jp_elevation cliff(int32_t x, int32_t y)
{
    return (jp_elevation)(x >= 11 && x <= 13 && y >= 10 ? 300 : 0);
}

static int64_t cost_of_course(void)
{
    int64_t sum = 0;

    for (unsigned i = 0; i < course.count; i++) {
        const struct jp_point from = jp_course_begin(&course, i);

        sum += jp_line_cost(lattice, &terrain, &from, &legs[i].end);
    }
    return sum;
}

/* Single steps of the route may. */
static void expect_no_line_over_the_cliff(void)
{
    for (unsigned i = 0; i < course.count; i++) {
        const struct jp_point from = jp_course_begin(&course, i);
        const int64_t step = 3 * (int64_t)map.resolution;

        TEST_ASSERT_TRUE(square_of_length(&from, &legs[i].end) < step * step ||
                         jp_line_cost(lattice, &terrain, &from, &legs[i].end) < JP_COST_MAX);
    }
}

static int64_t cost_of_straight_line(void)
{
    const struct jp_point from = centre(west.x, west.y);
    const struct jp_point to = centre(east.x, east.y);

    return jp_line_cost(lattice, &terrain, &from, &to);
}

/* Another robot's. */
static struct jp_lattice other;

/* A robot for which climbing is dear. */
static void make_heavy(void)
{
    other = jp_lattice_courier24;
    for (unsigned move = 0; move < (unsigned)JP_MOVE_KINDS; move++) {
        other.move_costs[JP_COST_PHYSICAL][move].climb.linear += 20 * 65536;
        other.move_costs[JP_COST_PHYSICAL][move].bend = 0;
    }
    lattice = &other;
}

/* Where the plan goes round a hill lines do not lead over it. */
static void test_lines_keep_what_the_plan_saves(void)
{
    make_heavy();
    make_hills(ridge);
    plan_route(&west, &east);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_from_pose(&west));
    TEST_ASSERT_GREATER_THAN_UINT16(1, course.count);
    TEST_ASSERT_TRUE(cost_of_course() < cost_of_straight_line());
    TEST_ASSERT_EQUAL_INT32(centre(east.x, east.y).x, legs[course.count - 1U].end.x);
}

/* It has no price: the straight line is taken. */
static void test_a_way_over_a_hill_is_one_line(void)
{
    make_hills(ridge);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_way(&west_cell, &east_cell));
    TEST_ASSERT_EQUAL_UINT16(1, course.count);
}

static void test_lines_do_not_lead_over_what_is_too_steep(void)
{
    make_hills(cliff);
    init();
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_way(&west_cell, &east_cell));
    TEST_ASSERT_GREATER_THAN_UINT16(1, course.count);
    expect_no_line_over_the_cliff();
    plan_route(&west, &east);
    TEST_ASSERT_EQUAL_INT(JP_COURSE_FOUND, join_from_pose(&west));
    TEST_ASSERT_GREATER_THAN_UINT16(1, course.count);
}

/* Level, with mud across the straight way, up to its south end, that takes so much more. */
static void make_mud(uint16_t price)
{
    enum { MUD = 2 };

    other = jp_lattice_courier24;
    other.ground[MUD] = (struct jp_ground_price){price, price};
    lattice = &other;
    map = (struct jp_terrain_config){
        .width = SIDE, .height = SIDE, .resolution = lattice->resolution, .has_classes = true};
    make_level_map(&map);
    for (int32_t y = 14; y < SIDE; y++) {
        for (int32_t x = 9; x < 15; x++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_class(&terrain, x, y, MUD));
        }
    }
}

static void test_lines_do_not_cut_through_the_mud_that_the_plan_avoids(void)
{
    make_mud(0);
    join_west();
    TEST_ASSERT_EQUAL_UINT16(1, course.count);
    make_mud(4U * JP_GROUND_ONE);
    join_west();
    TEST_ASSERT_GREATER_THAN_UINT16(1, course.count);
    TEST_ASSERT_TRUE(cost_of_course() < cost_of_straight_line());
}

static void test_a_leg_begins_elsewhere(void)
{
    const struct jp_point first = beside(&west, JP_Q16(0.04), JP_Q16(0.02));
    const struct jp_point second = beside(&west, JP_Q16(0.6), JP_Q16(0.1));
    struct jp_point begin;

    build_wall();
    join_west();
    jp_course_begin_at(&course, 0, &first);
    begin = jp_course_begin(&course, 0);
    expect_point(&first, &begin);
    jp_course_begin_at(&course, 1, &second);
    begin = jp_course_begin(&course, 1);
    expect_point(&second, &begin);
    expect_point(&second, &legs[0].end);
}
