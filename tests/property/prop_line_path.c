/* Paths along straight lines: pieces that join, turns on the spot between them, and what is refused. */
#include <joulepath/line_path.h>
#include <math.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define PLACES  11
#define TARGETS 5

#define Q16  65536.0
#define Q24  16777216.0
#define TURN 4294967296.0
#define PI   3.14159265358979323846

static const struct options defaults = {.count = 500, .seed = 2018};
static struct options options;

static struct jp_path_piece pieces[PLACES];
static struct jp_lattice_path path;
static struct jp_point targets[TARGETS];
static struct jp_line_route route;

void setUp(void)
{
    memset(pieces, 0, sizeof pieces);
    route = (struct jp_line_route){.targets = targets, .count = 1};
}

void tearDown(void)
{
}

static void set_target(unsigned i, double x, double y)
{
    targets[i] = (struct jp_point){(jp_q16)lround(x * Q16), (jp_q16)lround(y * Q16)};
}

static void make(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PLACES, &route));
}

static double radians(jp_angle angle)
{
    return (int32_t)angle * (2 * PI / TURN);
}

struct pose {
    double x;
    double y;
    double heading;
};

/* At a share of a piece, by circles. */
static struct pose pose_on(const struct jp_path_piece *piece, double share)
{
    const double way = share * piece->length / Q24;
    const double bend = piece->bend / Q24;
    struct pose pose = {piece->begin.x / Q16, piece->begin.y / Q16, radians(piece->heading)};

    if (piece->kind != JP_PIECE_CURVE) {
        pose.heading += piece->kind == JP_PIECE_TURN_LEFT ? way : -way;
    } else {
        const double half = bend * way / 2;
        const double chord = half == 0 ? way : way * sin(half) / half;
        pose.x += chord * cos(pose.heading + half);
        pose.y += chord * sin(pose.heading + half);
        pose.heading += bend * way;
    }
    return pose;
}

static void check_meets(const struct pose *end, const struct jp_point *point, jp_angle heading)
{
    TEST_ASSERT_TRUE(fabs(end->x - point->x / Q16) < 2e-4);
    TEST_ASSERT_TRUE(fabs(end->y - point->y / Q16) < 2e-4);
    TEST_ASSERT_TRUE(fabs(remainder(end->heading - radians(heading), 2 * PI)) < 1e-3);
}

/* Each piece ends where the next one begins, the first begins at the start and the last ends at the last target. */
static void check_joined(void)
{
    TEST_ASSERT_EQUAL_INT32(route.start.x, pieces[0].begin.x);
    TEST_ASSERT_EQUAL_INT32(route.start.y, pieces[0].begin.y);
    for (unsigned i = 0; i < path.count; i++) {
        const struct pose end = pose_on(&pieces[i], 1);
        const bool is_last = i + 1U == path.count;
        check_meets(&end, is_last ? &path.end.position : &pieces[i + 1U].begin,
                    is_last ? path.end.heading : pieces[i + 1U].heading);
    }
    TEST_ASSERT_EQUAL_INT32(targets[route.count - 1U].x, path.end.position.x);
    TEST_ASSERT_EQUAL_INT32(targets[route.count - 1U].y, path.end.position.y);
}

static double distance_from_line(const struct pose *pose, unsigned line)
{
    const struct jp_point *a = line == 0U ? &route.start : &targets[line - 1U];
    const double dx = (targets[line].x - a->x) / Q16;
    const double dy = (targets[line].y - a->y) / Q16;
    const double x = pose->x - a->x / Q16;
    const double y = pose->y - a->y / Q16;
    const double share = fmin(fmax((x * dx + y * dy) / (dx * dx + dy * dy), 0), 1);

    return hypot(x - share * dx, y - share * dy);
}

static double distance_from_lines(const struct pose *pose)
{
    double least = INFINITY;

    for (unsigned line = 0; line < route.count; line++) {
        least = fmin(least, distance_from_line(pose, line));
    }
    return least;
}

static double farthest_from_lines(void)
{
    double farthest = 0;

    for (unsigned i = 0; i < path.count; i++) {
        for (int step = 0; step <= 16; step++) {
            const struct pose pose = pose_on(&pieces[i], step / 16.0);
            farthest = fmax(farthest, distance_from_lines(&pose));
        }
    }
    return farthest;
}

static void test_straight_ahead_is_one_piece(void)
{
    set_target(0, 3, 0);
    make();
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    TEST_ASSERT_EQUAL_INT(JP_PIECE_CURVE, pieces[0].kind);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(3), pieces[0].length);
    TEST_ASSERT_EQUAL_INT32(0, pieces[0].bend);
    check_joined();
}

static void test_it_turns_towards_the_first_target(void)
{
    set_target(0, 0, -2);
    make();
    TEST_ASSERT_EQUAL_UINT(2, path.count);
    TEST_ASSERT_EQUAL_INT(JP_PIECE_TURN_RIGHT, pieces[0].kind);
    TEST_ASSERT_INT32_WITHIN(64, JP_Q24(PI / 2), pieces[0].length);
    check_joined();
    route.heading = JP_ANGLE_DEGREES(-120);
    make();
    TEST_ASSERT_EQUAL_INT(JP_PIECE_TURN_LEFT, pieces[0].kind);
    TEST_ASSERT_INT32_WITHIN(64, JP_Q24(PI / 6), pieces[0].length);
    check_joined();
}

static void test_a_corner_is_a_turn_on_the_spot(void)
{
    route.count = 2;
    set_target(0, 2, 0);
    set_target(1, 2, 2);
    make();
    TEST_ASSERT_EQUAL_UINT(3, path.count);
    TEST_ASSERT_EQUAL_INT(JP_PIECE_TURN_LEFT, pieces[1].kind);
    check_joined();
    TEST_ASSERT_TRUE(farthest_from_lines() < 1e-4);
}

static void test_turns_on_the_spot_alone(void)
{
    const struct jp_line_route start = {.start = {JP_Q16(1), JP_Q16(-2)}, .heading = JP_ANGLE_DEGREES(170)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_turn_path(&path, pieces, 1, &start, JP_ANGLE_DEGREES(-100)));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    TEST_ASSERT_EQUAL_INT(JP_PIECE_TURN_LEFT, pieces[0].kind);
    TEST_ASSERT_INT32_WITHIN(64, JP_Q24(PI / 2), pieces[0].length);
    TEST_ASSERT_EQUAL_INT32(start.start.x, path.end.position.x);
    TEST_ASSERT_EQUAL_INT32(start.start.y, path.end.position.y);
    TEST_ASSERT_EQUAL_UINT32(JP_ANGLE_DEGREES(-100), path.end.heading);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_turn_path(&path, pieces, 1, &start, start.heading));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_turn_path(NULL, pieces, 1, &start, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_turn_path(&path, NULL, 1, &start, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_turn_path(&path, pieces, 0, &start, 0));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_turn_path(&path, pieces, 1, NULL, 0));
}

static void test_what_is_refused(void)
{
    struct jp_line_route without = route;

    without.targets = NULL;
    set_target(0, 1, 0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_line_path(NULL, pieces, PLACES, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_line_path(&path, NULL, PLACES, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_line_path(&path, pieces, 0, &route));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_line_path(&path, pieces, PLACES, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_line_path(&path, pieces, PLACES, &without));
    route.count = 0;
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_line_path(&path, pieces, PLACES, &route));
    route.count = 1;
    set_target(0, 0.0009, 0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_ZERO_LENGTH, jp_line_path(&path, pieces, PLACES, &route));
    set_target(0, 64.001, 0);
    TEST_ASSERT_EQUAL_INT(JP_ERR_INFEASIBLE, jp_line_path(&path, pieces, PLACES, &route));
    set_target(0, 64, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PLACES, &route));
}

static void test_each_place_that_is_missing(void)
{
    route.count = 3;
    route.heading = JP_ANGLE_DEGREES(90);
    set_target(0, 2, 0);
    set_target(1, 2, 2);
    set_target(2, 1, 2.1);
    make();
    TEST_ASSERT_EQUAL_UINT(6, path.count); /* three turns, three lines */
    for (uint16_t places = 1; places < 6; places++) {
        TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_line_path(&path, pieces, places, &route));
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, 6, &route));
}

static void test_random_routes(void)
{
    begin_random(options.seed, 0);
    for (unsigned long i = 0; i < options.count; i++) {
        double x = uniform(-20, 20);
        double y = uniform(-20, 20);
        route.start = (struct jp_point){(jp_q16)lround(x * Q16), (jp_q16)lround(y * Q16)};
        route.heading = random_word();
        route.count = (uint16_t)(1 + below(TARGETS));
        for (unsigned k = 0; k < route.count; k++) {
            const double length = uniform(0.05, 4);
            const double direction = uniform(-PI, PI);
            x += length * cos(direction);
            y += length * sin(direction);
            set_target(k, x, y);
        }
        make();
        TEST_ASSERT_TRUE(path.count <= JP_LINE_PATH_PIECES(route.count));
        check_joined();
        TEST_ASSERT_TRUE(farthest_from_lines() < 2e-4);
    }
}

/* ---- Hills ---- */

#define HILLY_PLACES 40

static struct jp_path_piece hilly[HILLY_PLACES];

/* Waves of 6 m and 9 m, m. */
static double hills_at(double x, double y)
{
    return 0.15 * sin(2 * PI * x / 6) + 0.2 * sin(2 * PI * (x + 2 * y) / 9);
}

static jp_q16 hills(const void *context, const struct jp_point *point)
{
    (void)context;
    return (jp_q16)lround(hills_at(point->x / Q16, point->y / Q16) * Q16);
}

static const struct jp_ground ground = {hills, NULL, NULL, JP_Q16(0.2), 0};

static bool is_straight(const struct jp_path_piece *piece)
{
    return piece->kind == JP_PIECE_CURVE;
}

/* Pieces rise as their ground does, and those of a line that follow each other differ. */
static void check_rises(unsigned places)
{
    unsigned lines = 0;

    TEST_ASSERT_TRUE(path.count <= places);
    for (unsigned i = 0; i < path.count; i++) {
        const struct jp_path_piece *piece = &hilly[i];
        const struct pose end = pose_on(piece, 1);
        const double rise = hills_at(end.x, end.y) - hills_at(piece->begin.x / Q16, piece->begin.y / Q16);

        TEST_ASSERT_TRUE(!is_straight(piece) || fabs(piece->rise / Q16 - rise) < 2e-3);
        TEST_ASSERT_TRUE(is_straight(piece) || piece->rise == 0);
        if (piece->is_joined) {
            TEST_ASSERT_TRUE(i > 0 && is_straight(piece) && is_straight(&hilly[i - 1U]));
            TEST_ASSERT_EQUAL_UINT32(hilly[i - 1U].heading, piece->heading);
        }
        lines += is_straight(piece) && !piece->is_joined;
    }
    TEST_ASSERT_EQUAL_UINT(route.count, lines);
}

static void test_random_routes_over_hills(void)
{
    unsigned joined = 0;

    begin_random(options.seed, 1);
    for (unsigned long i = 0; i < options.count; i++) {
        const uint16_t places = (uint16_t)(2 * TARGETS + below(HILLY_PLACES - 2 * TARGETS + 1));
        double x = uniform(-20, 20);
        double y = uniform(-20, 20);
        route = (struct jp_line_route){.start = {(jp_q16)lround(x * Q16), (jp_q16)lround(y * Q16)},
                                       .heading = random_word(),
                                       .targets = targets,
                                       .count = (uint16_t)(1 + below(TARGETS)),
                                       .ground = &ground};
        for (unsigned k = 0; k < route.count; k++) {
            x += uniform(0.3, 6);
            y += uniform(-4, 4);
            set_target(k, x, y);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, hilly, places, &route));
        check_rises(places);
        for (unsigned k = 0; k < path.count; k++) {
            joined += hilly[k].is_joined;
        }
    }
    TEST_ASSERT_TRUE(joined > options.count);
}

/* With places for all of it no piece rises unlike its ground by more than the spread of its grades. */
static void test_pieces_follow_the_ground(void)
{
    route.ground = &ground;
    set_target(0, 12, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, hilly, HILLY_PLACES, &route));
    TEST_ASSERT_TRUE(path.count > 8);
    for (unsigned i = 0; i < path.count; i++) {
        const struct pose middle = pose_on(&hilly[i], 0.5);
        const double begin = hills_at(hilly[i].begin.x / Q16, 0);

        TEST_ASSERT_TRUE(fabs(hills_at(middle.x, 0) - begin - hilly[i].rise / Q16 / 2) < 0.05);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, hilly, 1, &route));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
}

/* On level ground each line is one piece. */
static jp_q16 plain(const void *context, const struct jp_point *point)
{
    (void)context;
    (void)point;
    return JP_Q16(3);
}

static void test_plains_are_one_piece(void)
{
    const struct jp_ground level = {plain, NULL, NULL, JP_Q16(0.05), 0};

    route.ground = &level;
    set_target(0, 7, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, hilly, HILLY_PLACES, &route));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    TEST_ASSERT_EQUAL_INT32(JP_Q24(7), hilly[0].length);
    TEST_ASSERT_EQUAL_INT32(0, hilly[0].rise);
}

/* Mud from 2 to 3 m. */
static uint8_t mud_at(const void *context, const struct jp_point *point)
{
    (void)context;
    return point->x >= JP_Q16(2) && point->x < JP_Q16(3) ? 1 : 0;
}

static void test_lines_are_divided_where_the_ground_is_another(void)
{
    const struct jp_ground muddy = {plain, mud_at, NULL, JP_Q16(0.1), 0};
    static const uint8_t grounds[] = {0, 1, 0};
    static const jp_q24 lengths[] = {JP_Q24(2), JP_Q24(1), JP_Q24(4)};
    const struct jp_line_route in_mud = {.start = {JP_Q16(2.5), 0}, .ground = &muddy};

    route.ground = &muddy;
    set_target(0, 7, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, hilly, HILLY_PLACES, &route));
    TEST_ASSERT_EQUAL_UINT(3, path.count);
    for (unsigned i = 0; i < path.count; i++) {
        TEST_ASSERT_EQUAL_UINT8(grounds[i], hilly[i].ground_left);
        TEST_ASSERT_EQUAL_UINT8(grounds[i], hilly[i].ground_right);
        TEST_ASSERT_INT32_WITHIN(JP_Q24(0.2), lengths[i], hilly[i].length);
        TEST_ASSERT_EQUAL_INT(i > 0, hilly[i].is_joined);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_turn_path(&path, hilly, 1, &in_mud, JP_ANGLE_DEGREES(30)));
    TEST_ASSERT_EQUAL_UINT8(1, hilly[0].ground_left);
}

/* To the left of the x axis. */
static uint8_t class_to_the_left(const void *context, const struct jp_point *point)
{
    (void)context;
    return point->y > 0 ? 3 : 0;
}

static void test_the_wheels_of_each_side_are_on_their_own_ground(void)
{
    const struct jp_ground edge = {plain, class_to_the_left, NULL, JP_Q16(0.5), 0};
    const struct jp_line_route there = {.heading = JP_ANGLE_DEGREES(180), .ground = &edge, .half_track = JP_Q16(0.3)};

    route.ground = &edge;
    route.half_track = JP_Q16(0.3);
    set_target(0, 7, 0);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, hilly, HILLY_PLACES, &route));
    TEST_ASSERT_EQUAL_UINT(1, path.count);
    TEST_ASSERT_EQUAL_UINT8(3, hilly[0].ground_left);
    TEST_ASSERT_EQUAL_UINT8(0, hilly[0].ground_right);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_turn_path(&path, hilly, 1, &there, 0));
    TEST_ASSERT_EQUAL_UINT8(0, hilly[0].ground_left);
    TEST_ASSERT_EQUAL_UINT8(3, hilly[0].ground_right);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, defaults);
    return RUN_PROPERTY(options, NULL);
}
