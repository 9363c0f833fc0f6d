/* The least costs between a root and every pose on level ground and slopes, what is refused, and the way along them. */
#include <joulepath/pose_field.h>
#include <joulepath/return_map.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "src/map/unit_step.h"
#include "tests/support/level_map.h"
#include "unity.h"

enum {
    WIDTH = 12,
    HEIGHT = 6,
    POSES = WIDTH * HEIGHT * JP_HEADINGS,
    BLOCK_BYTES = POSES * 3 + HEIGHT * WIDTH * 4 + HEIGHT * 4
};
enum { LIMIT = JP_COST_MAX - 2, CALLS_MAX = 100000 };

static const struct jp_lattice *lattice;
static struct jp_terrain_config map;
static struct jp_pose_field field;
static uint64_t block[2 * BLOCK_BYTES / 8];

void setUp(void)
{
    lattice = &jp_lattice_courier24;
    map = (struct jp_terrain_config){
        .width = WIDTH, .height = HEIGHT, .resolution = lattice->resolution, .has_elevation = true};
    make_level_map(&map);
}

void tearDown(void)
{
}

static void init(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_init(&field, lattice, JP_COST_PHYSICAL, &terrain, block, sizeof block));
}

static void grow(unsigned slice)
{
    for (unsigned i = 0; i < CALLS_MAX; i++) {
        unsigned poses = slice;

        if (jp_pose_field_grow(&field, &poses)) {
            return;
        }
        TEST_ASSERT_EQUAL_UINT32(0, poses);
    }
    TEST_ASSERT_TRUE(false);
}

static void start(enum jp_pose_field_sense sense, int32_t x, int32_t y, uint16_t headings, jp_cost limit)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, sense, x, y, headings, limit));
    grow(997);
}

/* ---- Tests ---- */

static void test_size_is_three_bytes_and_two_bits_a_pose_and_four_bytes_a_row(void)
{
    TEST_ASSERT_EQUAL_UINT32(BLOCK_BYTES, jp_pose_field_size(&map));
    TEST_ASSERT_EQUAL_UINT32(2 * BLOCK_BYTES, jp_return_map_size(&map));
    map.width = 0;
    TEST_ASSERT_EQUAL_UINT32(0, jp_pose_field_size(&map));
}

static void test_refuses_what_it_cannot_be_bound_to(void)
{
    const enum jp_cost_kind kind = JP_COST_PHYSICAL;

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_init(NULL, lattice, kind, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_init(&field, NULL, kind, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_init(&field, lattice, kind, NULL, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_init(&field, lattice, kind, &terrain, NULL, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_pose_field_init(&field, lattice, kind, &terrain, block, BLOCK_BYTES - 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ALIGNMENT,
                          jp_pose_field_init(&field, lattice, kind, &terrain, (uint8_t *)block + 4, BLOCK_BYTES));
}

static void test_refuses_roots(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_start(NULL, JP_POSE_FIELD_TO_ROOT, 5, 3, 1, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, 5, 3, 0, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, 5, 3, 1, LIMIT + 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, WIDTH, 5, 1, LIMIT));
}

static void test_says_nothing_until_it_is_done(void)
{
    unsigned poses = 1;

    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, 5, 3, JP_ANY_HEADING, LIMIT));
    TEST_ASSERT_FALSE(jp_pose_field_grow(&field, &poses));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, 5, 3, 0));
    grow(100);
    TEST_ASSERT_EQUAL_UINT32(0, jp_pose_field_cost(&field, 5, 3, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, -1, 5, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_least(&field, 5, HEIGHT));
    jp_pose_field_set_lattice(&field, lattice);
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, 5, 3, 0));
}

static void test_is_outdated_when_the_map_changes(void)
{
    init();
    start(JP_POSE_FIELD_TO_ROOT, 5, 3, JP_ANY_HEADING, LIMIT);
    TEST_ASSERT_FALSE(jp_pose_field_is_outdated(&field));
    (void)jp_terrain_set_cell(&terrain, 1, 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_TRUE(jp_pose_field_is_outdated(&field));
}

/* Of an axis. */
static jp_cost step_cost(int32_t rise)
{
    return jp_move_cost(&lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS], rise) +
           jp_unit_step(lattice, 0)->base[JP_COST_PHYSICAL];
}

/* Three of them up a slope, from west to east or back. */
static void raise_to_the_east(void)
{
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        (void)jp_terrain_set_elevation(&terrain, i % WIDTH, i / WIDTH, (jp_elevation)(8 * (i % WIDTH)));
    }
}

static void test_straight_on_it_is_so_many_steps(void)
{
    init();
    start(JP_POSE_FIELD_FROM_ROOT, 4, 3, 1U, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(3 * step_cost(0), jp_pose_field_cost(&field, 7, 3, 0));
    start(JP_POSE_FIELD_TO_ROOT, 7, 3, 1U, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(3 * step_cost(0), jp_pose_field_cost(&field, 4, 3, 0));
}

static void test_uphill_is_dearer_than_downhill_both_ways(void)
{
    raise_to_the_east();
    init();
    start(JP_POSE_FIELD_FROM_ROOT, 4, 3, 1U, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(3 * step_cost(8), jp_pose_field_cost(&field, 7, 3, 0));
    start(JP_POSE_FIELD_TO_ROOT, 4, 3, 1U << 8, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(3 * step_cost(-8), jp_pose_field_cost(&field, 7, 3, 8));
    TEST_ASSERT_TRUE(step_cost(-8) < step_cost(8));
}

/* Northward, both ways: twice, where one of the cells has a cost of 1. */
static void test_cells_with_costs_multiply(void)
{
    map = (struct jp_terrain_config){
        .width = WIDTH, .height = HEIGHT, .resolution = lattice->resolution, .has_costs = true};
    make_level_map(&map);
    (void)jp_terrain_set_cost(&terrain, 6, 2, 1);
    init();
    start(JP_POSE_FIELD_FROM_ROOT, 6, 2, 1U << 4, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(2 * step_cost(0), jp_pose_field_cost(&field, 6, 3, 4));
    start(JP_POSE_FIELD_TO_ROOT, 6, 3, 1U << 4, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(2 * step_cost(0), jp_pose_field_cost(&field, 6, 2, 4));
}

static void test_turns_are_charged_where_it_stands(void)
{
    struct jp_turns turns;

    init();
    jp_lattice_turns(lattice, JP_COST_PHYSICAL, &turns);
    start(JP_POSE_FIELD_FROM_ROOT, 6, 3, 1U, LIMIT);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        TEST_ASSERT_EQUAL_UINT32(turns.cost[0][heading], jp_pose_field_cost(&field, 6, 3, heading));
    }
    start(JP_POSE_FIELD_TO_ROOT, 6, 3, 1U, LIMIT);
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        TEST_ASSERT_EQUAL_UINT32(turns.cost[heading][0], jp_pose_field_cost(&field, 6, 3, heading));
    }
}

static void test_goes_no_farther_than_its_limit(void)
{
    init();
    start(JP_POSE_FIELD_FROM_ROOT, 4, 3, 1U, 2 * step_cost(0));
    TEST_ASSERT_EQUAL_UINT32(2 * step_cost(0), jp_pose_field_cost(&field, 6, 3, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, 7, 3, 0));
}

static void test_no_way_through_a_wall(void)
{
    put_column(7, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    init();
    start(JP_POSE_FIELD_FROM_ROOT, 4, 3, 1U, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(0, jp_pose_field_least(&field, 4, 3));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_least(&field, 10, 3));
}

/* Step by step, and where it looks the other way it turns first. */
static void test_a_way_leads_to_the_root(void)
{
    struct jp_lattice_pose pose = {8, 3, 8};
    unsigned steps = 0;

    init();
    start(JP_POSE_FIELD_TO_ROOT, 3, 3, JP_ANY_HEADING, LIMIT);
    while (jp_pose_field_next(&field, &pose)) {
        steps++;
    }
    TEST_ASSERT_EQUAL_UINT32(5, steps);
    TEST_ASSERT_EQUAL_INT(3, pose.x);
    pose = (struct jp_lattice_pose){8, 3, 0};
    TEST_ASSERT_TRUE(jp_pose_field_next(&field, &pose));
    TEST_ASSERT_EQUAL_INT(8, pose.x);
    while (jp_pose_field_next(&field, &pose)) {
        steps++;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(10, steps);
    TEST_ASSERT_EQUAL_INT(3, pose.x);
}

/* From every pose that has a cost a step or a turn leads on to one that has less, but from the root. */
static void test_each_pose_leads_to_a_cheaper_one(void)
{
    unsigned across = 0;
    unsigned reached = 0;

    map.width = map.height;
    make_level_map(&map);
    init();
    start(JP_POSE_FIELD_TO_ROOT, 3, 3, 1U, LIMIT);
    for (int32_t i = 0; i < map.width * map.height * JP_HEADINGS; i++) {
        const struct jp_lattice_pose from = {(int16_t)(i / JP_HEADINGS % map.width),
                                             (int16_t)(i / JP_HEADINGS / map.width), (uint8_t)(i % JP_HEADINGS)};
        const jp_cost cost = jp_pose_field_cost(&field, from.x, from.y, from.heading);
        struct jp_lattice_pose to = from;
        if (cost == 0 || cost == JP_COST_MAX) {
            TEST_ASSERT_FALSE(jp_pose_field_next(&field, &to));
            continue;
        }
        TEST_ASSERT_TRUE(jp_pose_field_next(&field, &to));
        TEST_ASSERT_TRUE(jp_pose_field_cost(&field, to.x, to.y, to.heading) < cost);
        reached++;
        across += to.y != from.y;
    }
    TEST_ASSERT_TRUE(reached > JP_HEADINGS);
    TEST_ASSERT_TRUE(across > 0);
}

static void test_no_way_leads_from_where_it_has_not_been_or_over_what_was_built_since(void)
{
    struct jp_lattice_pose pose = {8, 3, 8};

    init();
    start(JP_POSE_FIELD_TO_ROOT, 3, 3, JP_ANY_HEADING, 2 * step_cost(0));
    TEST_ASSERT_FALSE(jp_pose_field_next(&field, &pose));
    start(JP_POSE_FIELD_TO_ROOT, 3, 3, JP_ANY_HEADING, LIMIT);
    TEST_ASSERT_EQUAL_UINT32(5 * step_cost(0), jp_pose_field_cost(&field, 8, 3, 8));
    put_column(7, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_FALSE(jp_pose_field_next(&field, &pose));
}

/* On the way to the root the robot turns from the farther heading to the nearer one. */
static void expect_motion(const struct jp_turns *turns, const struct jp_lattice_pose *from,
                          const struct jp_lattice_pose *to)
{
    if (to->heading == from->heading) {
        TEST_ASSERT_EQUAL_INT(from->x + jp_move_offsets[from->heading].dx, to->x);
        TEST_ASSERT_EQUAL_INT(from->y + jp_move_offsets[from->heading].dy, to->y);
        return;
    }
    const uint16_t cost = turns->cost[from->heading][to->heading];

    TEST_ASSERT_TRUE(cost != UINT16_MAX && to->x == from->x && to->y == from->y);
    for (unsigned by = 0; by < JP_HEADINGS; by++) {
        TEST_ASSERT_TRUE(by == from->heading || by == to->heading ||
                         (uint32_t)turns->cost[from->heading][by] + turns->cost[by][to->heading] > cost);
    }
}

/* A step of the heading, or a turn between whose headings there is no other on the way. */
static void test_a_way_takes_one_motion_at_a_time(void)
{
    struct jp_turns turns;
    unsigned count = 0;

    init();
    jp_lattice_turns(lattice, JP_COST_PHYSICAL, &turns);
    for (unsigned root = 0; root < JP_HEADINGS; root++) {
        start(JP_POSE_FIELD_TO_ROOT, 6, 3, (uint16_t)(1U << root), LIMIT);
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            struct jp_lattice_pose from = {6, 3, (uint8_t)heading};
            struct jp_lattice_pose to = from;

            for (; jp_pose_field_next(&field, &to); from = to) {
                expect_motion(&turns, &from, &to);
                count++;
            }
            TEST_ASSERT_EQUAL_UINT32(root, to.heading);
        }
    }
    TEST_ASSERT_TRUE(count > 2U * JP_HEADINGS * JP_HEADINGS);
}

/* Without elevations a map is level, and costs what one of equal elevations does; slices change nothing. */
static void test_a_map_without_elevations_is_level(void)
{
    jp_cost expected[WIDTH * HEIGHT];

    init();
    start(JP_POSE_FIELD_FROM_ROOT, 6, 3, 1U << 3, LIMIT);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        expected[i] = jp_pose_field_least(&field, i % WIDTH, i / WIDTH);
    }
    map.has_elevation = false;
    make_level_map(&map);
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, JP_POSE_FIELD_FROM_ROOT, 6, 3, 1U << 3, LIMIT));
    grow(1);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_UINT32(expected[i], jp_pose_field_least(&field, i % WIDTH, i / WIDTH));
    }
}

static void test_the_least_of_a_cell_is_over_its_headings(void)
{
    init();
    start(JP_POSE_FIELD_FROM_ROOT, 5, 3, 1U << 8, LIMIT);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        jp_cost least = JP_COST_MAX;

        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const jp_cost cost = jp_pose_field_cost(&field, i % WIDTH, i / WIDTH, heading);

            least = cost < least ? cost : least;
        }
        TEST_ASSERT_EQUAL_UINT32(least, jp_pose_field_least(&field, i % WIDTH, i / WIDTH));
    }
    TEST_ASSERT_EQUAL_UINT32(0, jp_pose_field_least(&field, 5, 3));
}

/* ---- Out and back ---- */

static struct jp_return_map out_and_back;

static void work_map(unsigned slice)
{
    for (unsigned i = 0; !jp_return_map_work(&out_and_back, slice); i++) {
        TEST_ASSERT_TRUE(i < CALLS_MAX);
    }
}

static void test_a_return_map_is_out_and_back_with_the_turn_between(void)
{
    const struct jp_lattice_pose from = {4, 3, 0};
    struct jp_turns turns;

    jp_lattice_turns(lattice, JP_COST_PHYSICAL, &turns);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_init(&out_and_back, lattice, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_start(&out_and_back, &from, 4, 3, LIMIT));
    TEST_ASSERT_FALSE(jp_return_map_work(&out_and_back, 1));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_return_map_cost(&out_and_back, 4, 3));
    work_map(500);
    TEST_ASSERT_EQUAL_UINT32(0, jp_return_map_cost(&out_and_back, 4, 3));
    TEST_ASSERT_EQUAL_UINT32(6 * step_cost(0) + turns.cost[0][8], jp_return_map_cost(&out_and_back, 7, 3));
}

static void test_a_return_map_refuses(void)
{
    const struct jp_lattice_pose from = {4, 3, 2};
    const struct jp_lattice_pose turned = {4, 3, JP_HEADINGS};
    const struct jp_lattice_pose outside = {WIDTH, 3, 2};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_init(NULL, lattice, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_init(&out_and_back, lattice, NULL, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_return_map_init(&out_and_back, lattice, &terrain, block, BLOCK_BYTES - 8));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY,
                          jp_return_map_init(&out_and_back, lattice, &terrain, block, 2 * BLOCK_BYTES - 8));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_init(&out_and_back, lattice, &terrain, block, 2 * BLOCK_BYTES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_start(NULL, &from, 7, 3, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_start(&out_and_back, NULL, 7, 3, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_start(&out_and_back, &turned, 7, 3, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_return_map_start(&out_and_back, &outside, 7, 3, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_return_map_start(&out_and_back, &from, 7, -1, LIMIT));
}

/* On a slope with a dear cell: each step to the root costs what the lattice charges where it begins. */
static void test_each_step_is_charged_where_it_begins(void)
{
    map.has_costs = true;
    map.width = 8;
    make_level_map(&map);
    raise_to_the_east();
    (void)jp_terrain_set_cost(&terrain, 4, 2, 3);
    init();
    for (unsigned sense = 0; sense < 2U; sense++) {
        unsigned steps = 0;

        start(sense == 0U ? JP_POSE_FIELD_FROM_ROOT : JP_POSE_FIELD_TO_ROOT, 4, 3, JP_ANY_HEADING, LIMIT);
        for (int32_t i = 0; i < map.width * map.height * JP_HEADINGS; i++) {
            const struct jp_lattice_pose far = {(int16_t)(i / JP_HEADINGS % map.width),
                                                (int16_t)(i / JP_HEADINGS / map.width), (uint8_t)(i % JP_HEADINGS)};
            struct jp_lattice_pose near = far;

            if (!jp_pose_field_next(&field, &near) || near.heading != far.heading) {
                continue;
            }
            const struct jp_lattice_pose *from = sense == 0U ? &near : &far;
            const jp_cost cost = jp_lattice_energy(lattice, JP_COST_PHYSICAL, &terrain,
                                                   jp_unit_step(lattice, far.heading), from->x, from->y);

            TEST_ASSERT_EQUAL_UINT32(jp_pose_field_cost(&field, near.x, near.y, near.heading) + cost,
                                     jp_pose_field_cost(&field, far.x, far.y, far.heading));
            steps++;
        }
        TEST_ASSERT_TRUE(steps > 0U);
    }
}

/* A row is prepared for one heading at a time, which is counted as a pose for each 8 cells that are begun; then each
 * pose that is reached is counted, few more than once. */
static void test_what_it_takes_to_grow(void)
{
    enum { POSES_OF_A_ROW = WIDTH / 8 + 1 };
    unsigned poses = 100000;
    unsigned reached = 0;

    raise_to_the_east();
    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, JP_POSE_FIELD_FROM_ROOT, 4, 3, 1U, LIMIT));
    for (unsigned rows = 0; rows < HEIGHT * JP_HEADINGS; rows++) {
        unsigned budget = POSES_OF_A_ROW;

        TEST_ASSERT_EQUAL_UINT32(rows, field.prepared);
        TEST_ASSERT_FALSE(jp_pose_field_grow(&field, &budget));
        TEST_ASSERT_EQUAL_UINT32(0, budget);
    }
    TEST_ASSERT_EQUAL_UINT32(HEIGHT * JP_HEADINGS, field.prepared);
    TEST_ASSERT_TRUE(jp_pose_field_grow(&field, &poses));
    for (int32_t i = 0; i < POSES; i++) {
        reached += jp_pose_field_cost(&field, i / JP_HEADINGS % WIDTH, i / JP_HEADINGS / WIDTH,
                                      (unsigned)(i % JP_HEADINGS)) != JP_COST_MAX;
    }
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(reached, 100000U - poses);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(reached + reached / 4U, 100000U - poses);
    TEST_ASSERT_TRUE(jp_pose_field_grow(&field, &poses));
}

/* Steps over ground that takes more cost what the lattice says of them, with and without cells that multiply. */
static void test_grounds_charge_steps(void)
{
    struct jp_lattice priced = *lattice;

    priced.ground[1] = (struct jp_ground_price){JP_GROUND_ONE, 2U * JP_GROUND_ONE};
    for (unsigned i = 0; i < 2U; i++) {
        map = (struct jp_terrain_config){.width = WIDTH,
                                         .height = HEIGHT,
                                         .resolution = lattice->resolution,
                                         .has_classes = true,
                                         .has_costs = i == 1U};
        make_level_map(&map);
        for (int32_t cell = 0; cell < WIDTH * HEIGHT; cell++) {
            (void)jp_terrain_set_class(&terrain, cell % WIDTH, cell / WIDTH, cell % WIDTH >= 6 ? 1 : 0);
        }
        TEST_ASSERT_EQUAL_INT(JP_OK,
                              jp_pose_field_init(&field, &priced, JP_COST_PHYSICAL, &terrain, block, sizeof block));
        start(JP_POSE_FIELD_FROM_ROOT, 4, 3, 1U, LIMIT);
        jp_cost expected = 0;
        for (int32_t x = 4; x < 9; x++) {
            TEST_ASSERT_EQUAL_UINT32(expected, jp_pose_field_cost(&field, x, 3, 0));
            expected += jp_lattice_cost(&priced, JP_COST_PHYSICAL, &terrain, jp_unit_step(&priced, 0), x, 3);
        }
        TEST_ASSERT_TRUE(expected > 5U * step_cost(0));
    }
}
