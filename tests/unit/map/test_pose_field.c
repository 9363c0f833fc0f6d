/* The least costs between a root and every pose, both ways, against relaxing all motions until nothing changes; and the
 * way that leads along them. */
#include <joulepath/pose_field.h>
#include <joulepath/return_map.h>
#include <joulepath/tables.h>
#include <stddef.h>

#include "tests/support/level_map.h"
#include "tests/target/random.h"
#include "unity.h"

enum {
    WIDTH = 14,
    HEIGHT = 12,
    POSES = WIDTH * HEIGHT * JP_HEADINGS,
    BLOCK_BYTES = POSES * 3 + HEIGHT * JP_HEADINGS * 4
};
enum { LIMIT = JP_COST_MAX - 2, MAPS = 6, CALLS_MAX = 100000, STEPS_MAX = 400 };

static const struct jp_lattice *lattice;
static struct jp_terrain_config map;
static struct jp_pose_field field;
static uint64_t block[2 * BLOCK_BYTES / 8 + 2];
static uint32_t expected[HEIGHT][WIDTH][JP_HEADINGS];
static struct jp_turns turns;
static struct jp_lattice copy;
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t bound)
{
    return target_random(&random_state) % bound;
}

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

/* ---- The oracle ---- */

static const struct jp_primitive *straight(unsigned heading)
{
    for (unsigned i = 0; i < lattice->first_from[JP_HEADINGS]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];

        if (primitive->start == heading && primitive->end == heading && primitive->move_count == 1U &&
            lattice->moves[primitive->first_move] == heading) {
            return primitive;
        }
    }
    return NULL;
}

static bool lower(uint32_t *value, uint32_t other)
{
    const bool is_lower = other < *value;

    *value = is_lower ? other : *value;
    return is_lower;
}

/* The motions that lead here from a pose, or of a field to its root, from here to it. */
static bool relax_pose(enum jp_pose_field_sense sense, int32_t x, int32_t y, unsigned heading)
{
    const bool is_from = sense == JP_POSE_FIELD_FROM_ROOT;
    const int32_t sign = is_from ? -1 : 1;
    const int32_t px = x + sign * jp_move_offsets[heading].dx;
    const int32_t py = y + sign * jp_move_offsets[heading].dy;
    const struct jp_primitive *step = straight(heading);
    bool is_better = false;

    for (unsigned other = 0; other < JP_HEADINGS; other++) {
        const uint16_t turn = is_from ? turns.cost[other][heading] : turns.cost[heading][other];

        if (turn != UINT16_MAX) {
            struct jp_primitive motion = {.start = (uint8_t)(is_from ? other : heading)};

            motion.base[JP_COST_PHYSICAL] = turn;
            is_better =
                lower(&expected[y][x][heading],
                      expected[y][x][other] + jp_lattice_energy(lattice, JP_COST_PHYSICAL, &terrain, &motion, x, y)) ||
                is_better;
        }
    }
    if (step != NULL && jp_terrain_contains(&terrain, px, py)) {
        const jp_cost cost = is_from ? jp_lattice_cost(lattice, JP_COST_PHYSICAL, &terrain, step, px, py)
                                     : jp_lattice_cost(lattice, JP_COST_PHYSICAL, &terrain, step, x, y);

        is_better =
            (cost != JP_COST_MAX && lower(&expected[y][x][heading], expected[py][px][heading] + cost)) || is_better;
    }
    return is_better;
}

static void relax_all(enum jp_pose_field_sense sense, int32_t root_x, int32_t root_y, uint16_t headings)
{
    bool is_better = true;

    jp_lattice_turns(lattice, JP_COST_PHYSICAL, &turns);
    for (int32_t i = 0; i < POSES; i++) {
        expected[i / JP_HEADINGS / WIDTH][i / JP_HEADINGS % WIDTH][i % JP_HEADINGS] = JP_COST_MAX;
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if ((((uint32_t)headings >> heading) & 1U) != 0U) {
            expected[root_y][root_x][heading] = 0;
        }
    }
    while (is_better) {
        is_better = false;
        for (int32_t i = 0; i < POSES; i++) {
            is_better =
                relax_pose(sense, i / JP_HEADINGS % WIDTH, i / JP_HEADINGS / WIDTH, (unsigned)(i % JP_HEADINGS)) ||
                is_better;
        }
    }
}

static void expect_exact(jp_cost limit)
{
    for (int32_t i = 0; i < POSES; i++) {
        const int32_t x = i / JP_HEADINGS % WIDTH;
        const int32_t y = i / JP_HEADINGS / WIDTH;
        const uint32_t least = expected[y][x][i % JP_HEADINGS];

        TEST_ASSERT_EQUAL_UINT32(least <= limit ? least : JP_COST_MAX,
                                 jp_pose_field_cost(&field, x, y, (unsigned)(i % JP_HEADINGS)));
    }
}

static void make_random_map(void)
{
    make_level_map(&map);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const bool is_near_root = i % WIDTH > 2 && i % WIDTH < 9 && i / WIDTH > 2 && i / WIDTH < 9;

        (void)jp_terrain_set_elevation(&terrain, i % WIDTH, i / WIDTH, (jp_elevation)random_below(30));
        if (!is_near_root && random_below(100) < 5) {
            (void)jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH, JP_CELL_OCCUPIED);
        }
    }
}

/* ---- Tests ---- */

static void test_size_is_three_bytes_and_a_bit_a_pose(void)
{
    TEST_ASSERT_EQUAL_UINT32(BLOCK_BYTES, jp_pose_field_size(&map));
    TEST_ASSERT_EQUAL_UINT32(2 * BLOCK_BYTES, jp_return_map_size(&map));
    map.height = JP_POSE_FIELD_HEIGHT_MAX + 1;
    TEST_ASSERT_EQUAL_UINT32(0, jp_pose_field_size(&map));
    map.height = 0;
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
    terrain.config.height = JP_POSE_FIELD_HEIGHT_MAX + 1;
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_pose_field_init(&field, lattice, kind, &terrain, block, sizeof block));
}

static void test_refuses_roots(void)
{
    init();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_start(NULL, JP_POSE_FIELD_TO_ROOT, 5, 5, 1, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, 5, 5, 0, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, 5, 5, 1, LIMIT + 1));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, WIDTH, 5, 1, LIMIT));
}

static void test_says_nothing_until_it_is_done(void)
{
    unsigned poses = 1;

    init();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, JP_POSE_FIELD_TO_ROOT, 5, 5, JP_ANY_HEADING, LIMIT));
    TEST_ASSERT_FALSE(jp_pose_field_grow(&field, &poses));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, 5, 5, 0));
    grow(100);
    TEST_ASSERT_EQUAL_UINT32(0, jp_pose_field_cost(&field, 5, 5, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, -1, 5, 0));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_least(&field, 5, HEIGHT));
    jp_pose_field_set_lattice(&field, lattice);
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_pose_field_cost(&field, 5, 5, 0));
}

static void test_is_outdated_when_the_map_changes(void)
{
    init();
    start(JP_POSE_FIELD_TO_ROOT, 5, 5, JP_ANY_HEADING, LIMIT);
    TEST_ASSERT_FALSE(jp_pose_field_is_outdated(&field));
    (void)jp_terrain_set_cell(&terrain, 1, 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_TRUE(jp_pose_field_is_outdated(&field));
}

static void expect_random_maps_exact(enum jp_pose_field_sense sense, uint16_t headings)
{
    for (unsigned i = 0; i < MAPS; i++) {
        make_random_map();
        init();
        relax_all(sense, 5, 6, headings);
        start(sense, 5, 6, headings, LIMIT);
        expect_exact(LIMIT);
    }
}

static void test_costs_from_the_root_are_exact(void)
{
    expect_random_maps_exact(JP_POSE_FIELD_FROM_ROOT, 1U << 3);
}

static void test_costs_to_the_root_are_exact(void)
{
    expect_random_maps_exact(JP_POSE_FIELD_TO_ROOT, JP_ANY_HEADING);
}

static void test_goes_no_farther_than_its_limit(void)
{
    init();
    relax_all(JP_POSE_FIELD_TO_ROOT, 6, 6, JP_ANY_HEADING);
    for (jp_cost limit = 0; limit < 300; limit += 37) {
        start(JP_POSE_FIELD_TO_ROOT, 6, 6, JP_ANY_HEADING, limit);
        expect_exact(limit);
    }
}

static void test_charges_what_the_ground_costs(void)
{
    map.has_elevation = false;
    map.has_costs = true;
    make_level_map(&map);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cost(&terrain, i % WIDTH, i / WIDTH, (uint8_t)random_below(4)));
    }
    init();
    relax_all(JP_POSE_FIELD_TO_ROOT, 6, 6, JP_ANY_HEADING);
    start(JP_POSE_FIELD_TO_ROOT, 6, 6, JP_ANY_HEADING, LIMIT);
    expect_exact(LIMIT);
}

/* A lattice that has no straight step at a heading, and turns in one direction only. */
static void test_does_without_motions_that_a_lattice_lacks(void)
{
    static struct jp_primitive primitives[1000];
    const unsigned count = jp_lattice_courier24.first_from[JP_HEADINGS];

    TEST_ASSERT_LESS_OR_EQUAL_UINT32(sizeof primitives / sizeof primitives[0], count);
    copy = jp_lattice_courier24;
    for (unsigned i = 0; i < count; i++) {
        const struct jp_primitive *primitive = &jp_lattice_courier24.primitives[i];

        primitives[i] = *primitive;
        if (primitive->start == 2U && primitive->end == 2U) {
            primitives[i].move_count = 0;
            primitives[i].base[JP_COST_PHYSICAL] = 1;
        }
        if ((primitive->end + JP_HEADINGS - primitive->start) % JP_HEADINGS > JP_HEADINGS / 2) {
            primitives[i].end = primitive->start;
            primitives[i].base[JP_COST_PHYSICAL] = 1;
        }
    }
    copy.primitives = primitives;
    lattice = &copy;
    init();
    relax_all(JP_POSE_FIELD_FROM_ROOT, 6, 6, 1U);
    start(JP_POSE_FIELD_FROM_ROOT, 6, 6, 1U, LIMIT);
    expect_exact(LIMIT);
}

/* Motion by motion each pose costs less, and the last one is a root. */
static void expect_way(const struct jp_lattice_pose *from)
{
    struct jp_lattice_pose pose = *from;
    jp_cost before = jp_pose_field_cost(&field, pose.x, pose.y, pose.heading);

    for (unsigned i = 0; jp_pose_field_next(&field, &pose); i++) {
        const jp_cost cost = jp_pose_field_cost(&field, pose.x, pose.y, pose.heading);

        TEST_ASSERT_TRUE(i < STEPS_MAX);
        TEST_ASSERT_TRUE(cost < before);
        before = cost;
    }
    TEST_ASSERT_EQUAL_UINT32(0, before);
}

static void test_a_way_leads_to_the_root(void)
{
    make_random_map();
    for (int sense = 0; sense < 2; sense++) {
        init();
        start((enum jp_pose_field_sense)sense, 5, 6, JP_ANY_HEADING, LIMIT);
        for (int16_t i = 0; i < WIDTH * HEIGHT; i++) {
            const struct jp_lattice_pose pose = {(int16_t)(i % WIDTH), (int16_t)(i / WIDTH), (uint8_t)random_below(16)};

            if (jp_pose_field_cost(&field, pose.x, pose.y, pose.heading) != JP_COST_MAX) {
                expect_way(&pose);
            }
        }
    }
}

static void test_no_way_leads_from_where_it_has_not_been_or_over_what_was_built_since(void)
{
    struct jp_lattice_pose pose = {11, 6, 8};

    init();
    start(JP_POSE_FIELD_TO_ROOT, 3, 6, JP_ANY_HEADING, 60);
    TEST_ASSERT_FALSE(jp_pose_field_next(&field, &pose));
    start(JP_POSE_FIELD_TO_ROOT, 3, 6, JP_ANY_HEADING, LIMIT);
    put_column(9, 0, HEIGHT - 1, JP_CELL_OCCUPIED);
    TEST_ASSERT_FALSE(jp_pose_field_next(&field, &pose));
}

/* ---- Out and back ---- */

static struct jp_return_map out_and_back;

static void work_map(unsigned slice)
{
    for (unsigned i = 0; !jp_return_map_work(&out_and_back, slice); i++) {
        TEST_ASSERT_TRUE(i < CALLS_MAX);
    }
}

static void test_a_return_map_is_the_cheapest_way_out_and_back(void)
{
    const struct jp_lattice_pose from = {4, 5, 2};

    make_random_map();
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_init(&out_and_back, lattice, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_start(&out_and_back, &from, 7, 6, LIMIT));
    TEST_ASSERT_FALSE(jp_return_map_work(&out_and_back, 1));
    TEST_ASSERT_EQUAL_UINT32(JP_COST_MAX, jp_return_map_cost(&out_and_back, 4, 5));
    work_map(500);

    static uint32_t out[HEIGHT][WIDTH][JP_HEADINGS];

    relax_all(JP_POSE_FIELD_FROM_ROOT, 4, 5, 1U << 2);
    for (int32_t i = 0; i < POSES; i++) {
        out[i / JP_HEADINGS / WIDTH][i / JP_HEADINGS % WIDTH][i % JP_HEADINGS] =
            expected[i / JP_HEADINGS / WIDTH][i / JP_HEADINGS % WIDTH][i % JP_HEADINGS];
    }
    relax_all(JP_POSE_FIELD_TO_ROOT, 7, 6, JP_ANY_HEADING);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        uint32_t least = JP_COST_MAX;

        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const uint32_t both = out[i / WIDTH][i % WIDTH][heading] + expected[i / WIDTH][i % WIDTH][heading];

            least = both < least ? both : least;
        }
        TEST_ASSERT_EQUAL_UINT32(least, jp_return_map_cost(&out_and_back, i % WIDTH, i / WIDTH));
    }
}

static void test_a_return_map_refuses(void)
{
    const struct jp_lattice_pose from = {4, 5, 2};
    const struct jp_lattice_pose turned = {4, 5, JP_HEADINGS};
    const struct jp_lattice_pose outside = {WIDTH, 5, 2};

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_init(NULL, lattice, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_init(&out_and_back, lattice, NULL, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY, jp_return_map_init(&out_and_back, lattice, &terrain, block, BLOCK_BYTES - 8));
    TEST_ASSERT_EQUAL_INT(JP_ERR_MEMORY,
                          jp_return_map_init(&out_and_back, lattice, &terrain, block, 2 * BLOCK_BYTES - 8));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_init(&out_and_back, lattice, &terrain, block, 2 * BLOCK_BYTES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_start(NULL, &from, 7, 6, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_start(&out_and_back, NULL, 7, 6, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_return_map_start(&out_and_back, &turned, 7, 6, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_return_map_start(&out_and_back, &outside, 7, 6, LIMIT));
    TEST_ASSERT_EQUAL_INT(JP_ERR_OUTSIDE, jp_return_map_start(&out_and_back, &from, 7, -1, LIMIT));
}
