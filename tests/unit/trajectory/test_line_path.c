/* The ground of paths along lines: pieces by the class under each side's wheels, edges beside them, too few places. */
#include <joulepath/line_path.h>
#include <stddef.h>

#include "unity.h"

enum { PLACES = 8, ELSEWHERE = 2 };

/* Of other ground, m; without the points of its high sides. */
struct patch {
    jp_q16 left, bottom, right, top;
};

static struct patch patch;
static struct jp_ground ground;
static struct jp_point target;
static struct jp_line_route route;
static struct jp_path_piece pieces[PLACES];
static struct jp_lattice_path path;

static jp_q16 level(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return 0;
}

static uint8_t class_at(const void *context, const struct jp_point *point)
{
    const struct patch *other = context;
    const bool is_in =
        point->x >= other->left && point->x < other->right && point->y >= other->bottom && point->y < other->top;

    return is_in ? ELSEWHERE : 0;
}

/* 4 m along the x axis, by wheels half a metre aside of it, told by points every half a metre. */
void setUp(void)
{
    patch = (struct patch){0, 0, 0, 0};
    ground = (struct jp_ground){.elevation = level, .class_at = class_at, .context = &patch, .spacing = JP_Q16(0.5)};
    target = (struct jp_point){JP_Q16(4), 0};
    route = (struct jp_line_route){.targets = &target, .count = 1, .ground = &ground, .half_track = JP_Q16(0.5)};
}

void tearDown(void)
{
}

static void make(uint16_t places, uint16_t count)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, places, &route));
    TEST_ASSERT_EQUAL_UINT16(count, path.count);
    TEST_ASSERT_EQUAL_INT32(target.x, path.end.position.x);
    TEST_ASSERT_EQUAL_INT32(target.y, path.end.position.y);
}

static void expect_piece(unsigned index, jp_q24 length, uint8_t left, uint8_t right, bool is_at_edge)
{
    TEST_ASSERT_EQUAL_INT(JP_PIECE_CURVE, pieces[index].kind);
    TEST_ASSERT_EQUAL_INT32(length, pieces[index].length);
    TEST_ASSERT_EQUAL_UINT8(left, pieces[index].ground_left);
    TEST_ASSERT_EQUAL_UINT8(right, pieces[index].ground_right);
    TEST_ASSERT_EQUAL_INT(is_at_edge, pieces[index].is_at_edge);
    TEST_ASSERT_EQUAL_INT(index > 0U, pieces[index].is_joined);
}

static void test_one_class_is_one_piece(void)
{
    make(PLACES, 1);
    expect_piece(0, JP_Q24(4), 0, 0, false);
}

static void test_each_class_has_a_piece(void)
{
    patch = (struct patch){JP_Q16(1), JP_Q16(-2), JP_Q16(2.5), JP_Q16(2)};
    make(PLACES, 3);
    expect_piece(0, JP_Q24(1), 0, 0, false);
    expect_piece(1, JP_Q24(1.5), ELSEWHERE, ELSEWHERE, false);
    expect_piece(2, JP_Q24(1.5), 0, 0, false);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(1), pieces[1].begin.x);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(2.5), pieces[2].begin.x);
}

static void test_the_sides_may_be_on_different_classes(void)
{
    patch = (struct patch){JP_Q16(1), 0, JP_Q16(4), JP_Q16(2)};
    make(PLACES, 2);
    expect_piece(1, JP_Q24(3), ELSEWHERE, 0, false);
    patch = (struct patch){JP_Q16(1.5), JP_Q16(-2), JP_Q16(4), 0};
    make(PLACES, 2);
    expect_piece(0, JP_Q24(1.5), 0, 0, false);
    expect_piece(1, JP_Q24(2.5), 0, ELSEWHERE, false);
}

/* From 1 m on there is other ground from `low` up to `high`, which begins or ends 5 cm beside wheels. */
static void expect_edge(jp_q16 low, jp_q16 high, uint8_t left, uint8_t right)
{
    patch = (struct patch){JP_Q16(1), low, JP_Q16(4), high};
    ground.margin = JP_Q16(0.1);
    make(PLACES, 2);
    expect_piece(0, JP_Q24(1), 0, 0, false);
    expect_piece(1, JP_Q24(3), left, right, true);
    ground.margin = JP_Q16(0.04);
    const bool is_other = left != 0U || right != 0U;

    make(PLACES, is_other ? 2 : 1);
    expect_piece(path.count - 1U, is_other ? JP_Q24(3) : JP_Q24(4), left, right, false);
}

static void test_edges_on_either_side_of_the_wheels(void)
{
    expect_edge(JP_Q16(0.55), JP_Q16(2), 0, 0);                     /* left of the left wheels */
    expect_edge(JP_Q16(-2), JP_Q16(0.45), 0, ELSEWHERE);            /* right of them */
    expect_edge(JP_Q16(-0.45), JP_Q16(2), ELSEWHERE, 0);            /* left of the right wheels */
    expect_edge(JP_Q16(-2), JP_Q16(-0.55), 0, 0);                   /* right of them */
    expect_edge(JP_Q16(-0.45), JP_Q16(0.45), 0, 0);                 /* between the wheels */
    expect_edge(JP_Q16(-0.55), JP_Q16(0.55), ELSEWHERE, ELSEWHERE); /* under the whole robot */
}

/* The last piece takes what there is no place for. */
static void test_more_changes_than_places(void)
{
    patch = (struct patch){JP_Q16(1), JP_Q16(-2), JP_Q16(2), JP_Q16(2)};
    make(2, 2);
    expect_piece(0, JP_Q24(1), 0, 0, false);
    expect_piece(1, JP_Q24(3), ELSEWHERE, ELSEWHERE, false);
    make(1, 1);
    expect_piece(0, JP_Q24(4), 0, 0, false);
}

static void test_where_it_turns_first(void)
{
    route.heading = (jp_angle)1 << 30;
    patch = (struct patch){JP_Q16(-2), JP_Q16(-2), 0, JP_Q16(2)};
    make(PLACES, 2);
    TEST_ASSERT_EQUAL_INT(JP_PIECE_TURN_RIGHT, pieces[0].kind);
    TEST_ASSERT_EQUAL_UINT8(ELSEWHERE, pieces[0].ground_left);
    TEST_ASSERT_EQUAL_UINT8(0, pieces[0].ground_right);
}

static void test_ground_without_classes(void)
{
    patch = (struct patch){JP_Q16(-9), JP_Q16(-9), JP_Q16(9), JP_Q16(9)};
    ground.class_at = NULL;
    make(PLACES, 1);
    expect_piece(0, JP_Q24(4), 0, 0, false);
    route.ground = NULL;
    make(PLACES, 1);
    expect_piece(0, JP_Q24(4), 0, 0, false);
}

static struct jp_path_piece turns[2];

/* A turn on the spot to a heading: one piece, to the nearer side; none where it looks there already. */
static void test_a_turn_on_the_spot(void)
{
    route = (struct jp_line_route){.start = {JP_Q16(2), JP_Q16(3)}, .heading = JP_ANGLE_DEGREES(20)};
    for (int sign = -1; sign <= 1; sign += 2) {
        const jp_angle heading = route.heading + (jp_angle)(sign * (int32_t)JP_ANGLE_DEGREES(90));

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_turn_path(&path, turns, 2, &route, heading));
        TEST_ASSERT_EQUAL_UINT16(1, path.count);
        TEST_ASSERT_EQUAL_INT(sign < 0 ? JP_PIECE_TURN_RIGHT : JP_PIECE_TURN_LEFT, turns[0].kind);
        TEST_ASSERT_INT32_WITHIN(4, JP_Q24(1.5707963), turns[0].length);
        TEST_ASSERT_EQUAL_INT32(route.start.x, turns[0].begin.x);
        TEST_ASSERT_EQUAL_INT32(route.start.y, turns[0].begin.y);
        TEST_ASSERT_EQUAL_HEX32(route.heading, turns[0].heading);
        TEST_ASSERT_EQUAL_HEX32(heading, path.end.heading);
        TEST_ASSERT_EQUAL_INT32(route.start.x, path.end.position.x);
        TEST_ASSERT_EQUAL_INT32(route.start.y, path.end.position.y);
    }
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_turn_path(&path, turns, 2, &route, route.heading));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_turn_path(&path, turns, 2, NULL, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_turn_path(&path, NULL, 2, &route, 0));
}

static jp_q16 rising(const void *context, const struct jp_point *point)
{
    (void)context;
    return point->x / 10 + point->y / 5;
}

/* Each piece rises as its ground does between its ends, and all of them as the whole line. */
static void test_pieces_rise_with_their_ground(void)
{
    static const struct jp_point corners[2] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(2)}};

    ground.elevation = rising;
    ground.class_at = NULL;
    route.targets = corners;
    route.count = 2;
    route.start = (struct jp_point){JP_Q16(1), 0};
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PLACES, &route));
    jp_q16 sums[2] = {0, 0};

    for (unsigned i = 0; i < path.count; i++) {
        if (pieces[i].kind == JP_PIECE_CURVE) {
            sums[pieces[i].heading == 0U ? 0 : 1] += pieces[i].rise;
        }
    }
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(0.3), sums[0]);
    TEST_ASSERT_INT32_WITHIN(4, JP_Q16(0.4), sums[1]);
}

/* Two pieces are kept for each line that follows, whatever the ground of the first. */
static void test_lines_share_the_places(void)
{
    static const struct jp_point corners[3] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(2)}, {0, JP_Q16(2)}};

    for (uint16_t places = 5; places <= (uint16_t)PLACES; places++) {
        patch = (struct patch){JP_Q16(1), -JP_Q16(1), JP_Q16(1.5), JP_Q16(1)};
        route.targets = corners;
        route.count = 3;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, places, &route));
        TEST_ASSERT_LESS_OR_EQUAL_UINT16(places, path.count);
        TEST_ASSERT_EQUAL_INT32(0, path.end.position.x);
        TEST_ASSERT_EQUAL_INT32(JP_Q16(2), path.end.position.y);
    }
}

/* Stripes of half a metre, across both axes. */
static uint8_t striped(const void *context, const struct jp_point *point)
{
    (void)context;
    return (uint8_t)(((point->x >> 15) + (point->y >> 15)) & 1);
}

/* More changes than places on each line: none takes those of the lines after it. */
static void test_no_line_takes_the_places_of_others(void)
{
    static const struct jp_point corners[3] = {{JP_Q16(4), 0}, {JP_Q16(4), JP_Q16(4)}, {0, JP_Q16(4)}};

    ground.class_at = striped;
    route.half_track = JP_Q16(0.125);
    route.targets = corners;
    for (uint16_t count = 1; count <= 3U; count++) {
        route.count = count;
        for (uint16_t places = (uint16_t)(2U * count); places <= (uint16_t)PLACES; places++) {
            TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, places, &route));
            TEST_ASSERT_LESS_OR_EQUAL_UINT16(places, path.count);
            TEST_ASSERT_EQUAL_INT32(corners[count - 1U].x, path.end.position.x);
            TEST_ASSERT_EQUAL_INT32(corners[count - 1U].y, path.end.position.y);
        }
    }
    route.count = 3;
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_line_path(&path, pieces, 2, &route));
}

static void test_the_longest_line(void)
{
    ground.class_at = NULL;
    ground.spacing = JP_Q16(64);
    target.x = (jp_q16)(JP_PIECE_LENGTH_MAX >> 8);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PLACES, &route));
    target.x += 2;
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_line_path(&path, pieces, PLACES, &route));
    target.x = JP_Q16(0.001) - 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_line_path(&path, pieces, PLACES, &route));
    target.x = JP_Q16(0.001);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PLACES, &route));
}
