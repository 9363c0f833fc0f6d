/* Waypoints from routes: straight, round a wall, beside the route, over slopes, by margins; and what is refused. */
#include <joulepath/tables.h>
#include <joulepath/waypoints.h>

#include <string.h>

#include "src/base/integer.h"
#include "src/navigate/waypoint_arc.h"
#include "tests/support/energy_unit.h"
#include "unity.h"

enum { WIDTH = 14, HEIGHT = 12, POSES_MAX = 5, WAYPOINTS_MAX = 3 * POSES_MAX - 4 };

static const struct jp_segment_limits limits = {
    .speed = JP_Q24(1), .turn_rate = JP_Q24(0.35), .turn = JP_Q24(1.396263), .duration = JP_Q16(16000)};

static struct jp_terrain terrain;
static uint64_t map_block[160];
static struct jp_lattice lattice;
static struct jp_waypoints_config config;
static struct jp_waypoints waypoints;
static uint64_t block[WAYPOINTS_MAX * JP_WAYPOINTS_SECTORS * sizeof(struct jp_waypoints_label) / sizeof(uint64_t)];
static struct jp_waypoint list[WAYPOINTS_MAX];
static size_t count;

static void make_map(uint16_t width, uint16_t height, bool has_elevation)
{
    const struct jp_terrain_config map = {.width = width,
                                          .height = height,
                                          .resolution = JP_Q16(0.2),
                                          .has_elevation = has_elevation,
                                          .unknown_is_free = true};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &map, map_block, sizeof map_block, &field));
}

void setUp(void)
{
    const char *field = "";

    lattice = jp_lattice_gao2018;
    config = (struct jp_waypoints_config){.terrain = &terrain,
                                          .lattice = &lattice,
                                          .model = &jp_energy_model_gao2018,
                                          .limits = &limits,
                                          .length = JP_Q24(0.30),
                                          .width = JP_Q24(0.35),
                                          .reach = 96,
                                          .margin_min = 2};
    make_map(WIDTH, HEIGHT, false);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_init(&waypoints, &config, block, sizeof block, &field));
    TEST_ASSERT_NULL(field);
}

void tearDown(void)
{
}

static void occupy(int x, int y, int width, int height)
{
    for (int i = 0; i < width * height; i++) {
        (void)jp_terrain_set_cell(&terrain, x + i % width, y + i / width, JP_CELL_OCCUPIED);
    }
}

static void begin(const struct jp_lattice_pose *route, size_t poses)
{
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_init(&waypoints, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_start(&waypoints, route, poses));
}

/* One pair at a time. */
static enum jp_waypoints_answer choose(const struct jp_lattice_pose *route, size_t poses)
{
    begin(route, poses);
    while (jp_waypoints_work(&waypoints, 1) == JP_WAYPOINTS_CHOOSING) {
        TEST_ASSERT_EQUAL_UINT(0, jp_waypoints_count(&waypoints));
        TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_waypoints_read(&waypoints, list, WAYPOINTS_MAX));
    }
    count = jp_waypoints_count(&waypoints);
    return waypoints.answer;
}

static void choose_some(const struct jp_lattice_pose *route, size_t poses)
{
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_FOUND, choose(route, poses));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_read(&waypoints, list, WAYPOINTS_MAX));
}

static void test_a_straight_route_takes_its_ends(void)
{
    const struct jp_lattice_pose route[] = {{2, 6, 0}, {11, 6, 0}};
    const struct jp_motion rest = {0, 0};
    struct jp_segment segment;

    choose_some(route, 2);
    TEST_ASSERT_EQUAL_UINT(2, count);
    TEST_ASSERT_EQUAL_UINT16(0, list[0].pose);
    TEST_ASSERT_EQUAL_UINT32(0, list[0].heading);
    TEST_ASSERT_EQUAL_INT32(0, list[0].segment.length);
    TEST_ASSERT_EQUAL_UINT16(1, list[1].pose);
    TEST_ASSERT_EQUAL_INT32(9 * JP_Q16(0.2), list[1].point.x);
    TEST_ASSERT_EQUAL_INT32(0, list[1].point.y);
    TEST_ASSERT_EQUAL_UINT8(JP_WAYPOINTS_MARGIN_STEPS, list[1].margin);
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_segment_optimise(config.model, config.limits, &rest, &list[0].point, 0, &list[1].point, &segment));
    TEST_ASSERT_EQUAL_MEMORY(&segment, &list[1].segment, sizeof segment);
}

/* Headings after turns and arcs, as jp_segment_end() says. */
static void test_segments_follow_each_other(void)
{
    const struct jp_lattice_pose route[] = {{2, 2, 4}, {6, 9, 0}, {11, 2, 0}};

    occupy(6, 0, 1, 6);
    choose_some(route, 3);
    TEST_ASSERT_EQUAL_UINT(3, count);
    for (size_t i = 1; i < count; i++) {
        struct jp_point end;
        jp_angle heading;

        TEST_ASSERT_EQUAL_INT(
            JP_OK, jp_segment_end(&list[i].segment, &list[i - 1U].point, list[i - 1U].heading, &end, &heading));
        TEST_ASSERT_INT32_WITHIN(20, list[i].point.x, end.x);
        TEST_ASSERT_INT32_WITHIN(20, list[i].point.y, end.y);
        TEST_ASSERT_INT32_WITHIN(1000, 0, (int32_t)(list[i].heading - heading));
    }
}

/* What each attempt finds that those before it do not. */
static void test_four_attempts(void)
{
    static const struct {
        struct jp_lattice_pose route[4];
        int blocks[4][4];
        size_t count;
        int chosen[4][3]; /* pose, side, margin */
    } cases[] = {
        {{{2, 6, 11}, {5, 5, 0}, {7, 7, 0}, {6, 5, 0}}, {{3, 10, 3, 4}}, 2, {{0}, {3, 0, 3}}},
        {{{9, 8, 9}, {10, 5, 0}, {12, 4, 0}, {11, 5, 0}},
         {{6, 3, 3, 3}, {2, 6, 1, 4}, {2, 3, 3, 3}, {3, 5, 3, 4}},
         3,
         {{0}, {1, 1, 0}, {3, 0, 3}}},
        {{{7, 5, 12}, {4, 7, 0}, {7, 9, 0}, {10, 8, 0}},
         {{11, 5, 2, 1}, {7, 7, 2, 1}},
         4,
         {{0}, {1, 0, 0}, {2, 0, 1}, {3, 0, 0}}},
        {{{5, 1, 6}, {4, 1, 0}, {3, 4, 0}, {1, 6, 0}}, {{0, 0, 4, 3}}, 4, {{0}, {1, -1, 0}, {2, -1, 0}, {3, 0, 1}}},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        setUp();
        for (size_t j = 0; j < 4; j++) {
            occupy(cases[i].blocks[j][0], cases[i].blocks[j][1], cases[i].blocks[j][2], cases[i].blocks[j][3]);
        }
        choose_some(cases[i].route, 4);
        TEST_ASSERT_EQUAL_UINT(cases[i].count, count);
        for (size_t j = 0; j < count; j++) {
            TEST_ASSERT_EQUAL_INT(cases[i].chosen[j][0], list[j].pose);
            TEST_ASSERT_EQUAL_INT(cases[i].chosen[j][1], list[j].side);
            TEST_ASSERT_EQUAL_INT(cases[i].chosen[j][2], list[j].margin);
        }
    }
}

/* A cell to the left of where the route leads. */
static void test_places_beside_the_route(void)
{
    const struct jp_lattice_pose route[] = {{9, 8, 9}, {10, 5, 0}, {12, 4, 0}, {11, 5, 0}};

    occupy(6, 3, 3, 3);
    occupy(2, 6, 1, 4);
    occupy(2, 3, 3, 3);
    occupy(3, 5, 3, 4);
    choose_some(route, 4);
    /* The neighbours lead by (3, −4): left of it is (4, 3)/5. */
    TEST_ASSERT_INT32_WITHIN(1, JP_Q16(0.2) + JP_Q16(0.16), list[1].point.x);
    TEST_ASSERT_INT32_WITHIN(1, -3 * JP_Q16(0.2) + JP_Q16(0.12), list[1].point.y);
}

static void test_no_room_is_no_choice(void)
{
    const struct jp_lattice_pose route[] = {{7, 6, 0}, {6, 6, 0}};

    occupy(0, 0, WIDTH, 5);
    occupy(0, 8, WIDTH, HEIGHT - 8);
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NONE, choose(route, 2));
    TEST_ASSERT_EQUAL_UINT(0, count);
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NONE, jp_waypoints_work(&waypoints, 10));
}

static void test_the_reach_of_a_segment(void)
{
    const struct jp_lattice_pose route[] = {{2, 6, 0}, {5, 6, 0}, {8, 6, 0}, {11, 6, 0}};

    config.reach = 1;
    choose_some(route, 4);
    TEST_ASSERT_EQUAL_UINT(4, count);
    config.reach = 3;
    choose_some(route, 4);
    TEST_ASSERT_TRUE(count < 4);
}

/* A place twice has no direction to go on in. */
static void test_places_that_coincide(void)
{
    const struct jp_lattice_pose route[] = {{2, 6, 0}, {2, 6, 0}, {11, 6, 0}};

    choose_some(route, 3);
    TEST_ASSERT_EQUAL_UINT(2, count);
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NONE, choose(route, 2));
}

/* The optimiser finds no segment within the limits. */
static void test_segments_that_would_last_too_long(void)
{
    static struct jp_segment_limits brief;
    const struct jp_lattice_pose route[] = {{2, 6, 0}, {11, 6, 0}};

    brief = limits;
    brief.duration = JP_Q16(2.5);
    config.limits = &brief;
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NONE, choose(route, 2));
}

static void raise(int32_t x, int32_t first, int32_t last, jp_elevation elevation)
{
    for (int32_t y = first; y <= last; y++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_elevation(&terrain, x, y, elevation));
    }
}

static void test_slopes_are_paid_for_and_gone_round(void)
{
    const struct jp_lattice_pose route[] = {{2, 3, 2}, {6, 8, 0}, {11, 3, 0}};

    make_map(WIDTH, HEIGHT, true);
    choose_some(route, 3);
    TEST_ASSERT_EQUAL_UINT(2, count);
    for (int32_t x = 5; x <= 8; x++) {
        raise(x, 0, 5, JP_ELEVATION_ONE / 4);
    }
    choose_some(route, 3);
    TEST_ASSERT_EQUAL_UINT(3, count);
    /* A wall of ground cannot be climbed at all. */
    raise(4, 0, HEIGHT - 1, 10 * JP_ELEVATION_ONE);
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NONE, choose(route, 3));
}

/* Of the goal's best label. */
static int64_t price_of_goal(void)
{
    const struct jp_waypoints_internal *internal = &waypoints.internal;
    int64_t least = INT64_MAX;

    for (unsigned i = 0; i < JP_WAYPOINTS_SECTORS; i++) {
        const int64_t price = internal->labels[(internal->places - 1U) * JP_WAYPOINTS_SECTORS + i].price;

        least = price < least ? price : least;
    }
    return least;
}

/* Beside the energies of segments in any unit, slopes count as many joules. */
static void test_slopes_cost_joules_in_every_unit(void)
{
    const struct jp_lattice_pose route[] = {{2, 6, 0}, {11, 6, 0}};

    make_map(WIDTH, HEIGHT, true);
    raise(6, 0, HEIGHT - 1, JP_ELEVATION_ONE / 32);
    choose_some(route, 2);

    const int64_t joules = price_of_goal();

    for (int32_t exponent = -4; exponent <= 4; exponent += 8) {
        const struct jp_energy_model model = energy_model_in_unit(&jp_energy_model_gao2018, exponent);

        config.model = &model;
        choose_some(route, 2);
        TEST_ASSERT_INT64_WITHIN(joules / 1000, joules, jp_times_power(price_of_goal(), exponent));
    }
}

static void test_arcs_too_long_for_the_arithmetic(void)
{
    const struct jp_lattice_pose route[] = {{1, 1, 0}, {1010, 1, 0}};

    make_map(1024, 3, false);
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NONE, choose(route, 2));
}

static void test_the_slopes_of_an_arc(void)
{
    const struct jp_slope_cost *step = &lattice.move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS];
    const struct jp_waypoint_arc arc = {3 * JP_CELLS_ONE / 2, 3 * JP_CELLS_ONE / 2, 0, 0, 3 * (int64_t)JP_CELLS_ONE};
    int64_t cost = -1;

    TEST_ASSERT_TRUE(jp_waypoint_arc_slopes(&terrain, step, &arc, &cost));
    TEST_ASSERT_EQUAL_INT64(0, cost);
    make_map(WIDTH, HEIGHT, true);
    raise(3, 1, 1, 20);
    TEST_ASSERT_TRUE(jp_waypoint_arc_slopes(&terrain, step, &arc, &cost));
    TEST_ASSERT_EQUAL_INT64(
        (int64_t)jp_move_cost(step, 20) + jp_move_cost(step, -20) - 2 * (int64_t)jp_move_cost(step, 0), cost);
}

static void test_sizes(void)
{
    TEST_ASSERT_EQUAL_UINT(0, jp_waypoints_size(0));
    TEST_ASSERT_EQUAL_UINT(0, jp_waypoints_size(1));
    TEST_ASSERT_EQUAL_UINT(2 * 16 * sizeof(struct jp_waypoints_label), jp_waypoints_size(2));
    TEST_ASSERT_EQUAL_UINT(11 * 16 * sizeof(struct jp_waypoints_label), jp_waypoints_size(5));
    TEST_ASSERT_EQUAL_UINT(0, jp_waypoints_size(JP_WAYPOINTS_ROUTE_MAX + 1));
    TEST_ASSERT_TRUE(jp_waypoints_size(1000) <= 1536U * 1000U);
}

static void expect_field(const char *expected)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_waypoints_init(&waypoints, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    setUp();
}

/* So that with its margins it is within the widest footprint. */
static jp_q24 longest_side(void)
{
    return terrain.config.resolution * 256 * JP_WAYPOINTS_FOOTPRINT_MAX - 2 * JP_Q24(JP_WAYPOINTS_MARGIN_M);
}

static void test_configurations_out_of_range(void)
{
    config.terrain = NULL;
    expect_field("terrain");
    config.lattice = NULL;
    expect_field("lattice");
    config.model = NULL;
    expect_field("model");
    config.limits = NULL;
    expect_field("limits");
    lattice.resolution++;
    expect_field("terrain.resolution");
    terrain.config.resolution = JP_Q16(3000);
    lattice.resolution = JP_Q16(3000);
    expect_field("terrain.resolution");
    config.length = 0;
    expect_field("length");
    config.length = longest_side() + 1;
    expect_field("length");
    config.width = 0;
    expect_field("width");
    config.width = longest_side() + 1;
    expect_field("width");
    config.reach = 0;
    expect_field("reach");
    config.margin_min = JP_WAYPOINTS_MARGIN_STEPS + 1;
    expect_field("margin_min");
}

static void test_configurations_at_their_limits(void)
{
    const char *field = "";

    config.length = 1;
    config.width = longest_side();
    config.reach = 1;
    config.margin_min = JP_WAYPOINTS_MARGIN_STEPS;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_init(&waypoints, &config, block, sizeof block, &field));
    config.length = longest_side();
    config.width = 1;
    config.reach = UINT16_MAX;
    config.margin_min = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_waypoints_init(&waypoints, &config, block, sizeof block, &field));
}

static void test_arguments_that_are_refused(void)
{
    const struct jp_lattice_pose route[] = {{2, 6, 0}, {11, 6, 0}};
    const struct jp_lattice_pose outside[] = {{2, 6, 0}, {WIDTH, 6, 0}};
    const struct jp_lattice_pose turned[] = {{2, 6, 0}, {3, 6, JP_HEADINGS}};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_init(NULL, &config, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_init(&waypoints, NULL, block, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_init(&waypoints, &config, NULL, sizeof block, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_init(&waypoints, &config, block, sizeof block, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT,
                          jp_waypoints_init(&waypoints, &config, (char *)block + 4, sizeof block - 4, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_start(NULL, route, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_start(&waypoints, NULL, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_start(&waypoints, route, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_waypoints_start(&waypoints, route, POSES_MAX + 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_waypoints_start(&waypoints, outside, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_start(&waypoints, turned, 2));
    TEST_ASSERT_EQUAL_INT(JP_WAYPOINTS_NO_ROUTE, jp_waypoints_work(&waypoints, 10));
    TEST_ASSERT_EQUAL_INT(JP_ERR_NO_PLAN, jp_waypoints_read(&waypoints, list, WAYPOINTS_MAX));
    choose_some(route, 2);
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_waypoints_read(&waypoints, list, 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_read(&waypoints, NULL, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_waypoints_read(NULL, list, 2));
}
