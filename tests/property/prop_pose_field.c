/*
 * Pose fields and return maps on random maps, by lattices made at random, some of which lack steps or turns, against
 * relaxing all motions until nothing changes; and the ways that lead along them.
 *
 * prop_pose_field [--count N] [--seed S]
 */
#include <joulepath/return_map.h>

#include "tests/support/options.h"
#include "tests/support/toy_lattice.h"
#include "unity.h"

enum {
    WIDTH = 15,
    HEIGHT = 11,
    CELLS = WIDTH * HEIGHT,
    POSES = CELLS * JP_HEADINGS,
    CALLS_MAX = 100000,
    STEPS_MAX = 2000
};
enum {
    LIMIT = JP_COST_MAX - 2,
    BLOCK_BYTES = (HEIGHT * 4 + 7) / 8 * 8 + (POSES * 3 + CELLS * 2 + 7) / 8 * 8 + (CELLS * 2 + 7) / 8 * 8
};

static struct options options = {.count = 60, .seed = 2027};
static struct toy_lattice toy;
static const struct jp_lattice *const lattice = &toy.lattice;
static struct jp_terrain terrain;
static struct jp_pose_field field;
static struct jp_return_map out_and_back;
static uint64_t map_block[(2 * 2 * HEIGHT * 4 + 5 * CELLS + 64) / 8];
static uint64_t block[2 * BLOCK_BYTES / 8];
static uint32_t expected[HEIGHT][WIDTH][JP_HEADINGS];
static uint32_t out[HEIGHT][WIDTH][JP_HEADINGS];
static struct jp_turns turns;

void setUp(void)
{
}

void tearDown(void)
{
}

static void make_map(void)
{
    const struct jp_terrain_config config = {.width = WIDTH,
                                             .height = HEIGHT,
                                             .resolution = JP_Q16(0.2),
                                             .has_elevation = below(2) == 0U,
                                             .has_costs = below(3) == 0U,
                                             .has_classes = below(4) == 0U};
    const uint32_t free_percent = 70 + below(30);
    const char *wrong = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, map_block, sizeof map_block, &wrong));
    for (int32_t i = 0; i < CELLS; i++) {
        (void)jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH,
                                  below(100) < free_percent ? JP_CELL_FREE : JP_CELL_OCCUPIED);
        if (config.has_elevation) {
            (void)jp_terrain_set_elevation(&terrain, i % WIDTH, i / WIDTH, (jp_elevation)below(60));
        }
        if (config.has_costs) {
            (void)jp_terrain_set_cost(&terrain, i % WIDTH, i / WIDTH, (uint8_t)below(4));
        }
    }
}

/** Some steps are no unit steps of their heading. */
static void spoil_lattice(void)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (below(8) == 0U) {
            struct jp_primitive *step = &toy.primitives[toy.lattice.first_from[heading]];

            step->end = (uint8_t)((step->end + 1U) % JP_HEADINGS);
        }
    }
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

        if (other != heading && turn != UINT16_MAX) {
            struct jp_primitive motion = {.start = (uint8_t)(is_from ? other : heading)};

            motion.base[JP_COST_PHYSICAL] = turn == 0U ? 1U : turn;
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

static struct jp_lattice_pose anywhere(void)
{
    return (struct jp_lattice_pose){(int16_t)below(WIDTH), (int16_t)below(HEIGHT), (uint8_t)below(JP_HEADINGS)};
}

/** In slices of any size. */
static void grow(void)
{
    const unsigned slice = 1 + below(3000);

    for (unsigned i = 0;; i++) {
        unsigned poses = slice;

        if (jp_pose_field_grow(&field, &poses)) {
            return;
        }
        TEST_ASSERT_TRUE(i < CALLS_MAX && poses == 0U);
    }
}

/** Motion by motion each pose costs less, by what the motion costs, and the last one is a root. */
static void expect_way(const struct jp_lattice_pose *from)
{
    struct jp_lattice_pose pose = *from;
    jp_cost before = jp_pose_field_cost(&field, pose.x, pose.y, pose.heading);

    for (unsigned i = 0; jp_pose_field_next(&field, &pose); i++) {
        const jp_cost cost = jp_pose_field_cost(&field, pose.x, pose.y, pose.heading);

        TEST_ASSERT_TRUE(i < STEPS_MAX && cost < before);
        before = cost;
    }
    TEST_ASSERT_EQUAL_UINT32(0, before);
}

static void expect_ways(void)
{
    for (unsigned i = 0; i < 20; i++) {
        struct jp_lattice_pose pose = anywhere();

        if (jp_pose_field_cost(&field, pose.x, pose.y, pose.heading) != JP_COST_MAX) {
            expect_way(&pose);
        } else {
            TEST_ASSERT_FALSE(jp_pose_field_next(&field, &pose));
        }
    }
}

static void test_costs_are_least_on_any_map_and_lattice(void)
{
    for (uint64_t i = 0; i < options.count; i++) {
        begin_random(options.seed, i);
        toy_lattice_make(&toy, JP_Q16(0.2));
        spoil_lattice();
        make_map();
        const enum jp_pose_field_sense sense = below(2) == 0U ? JP_POSE_FIELD_FROM_ROOT : JP_POSE_FIELD_TO_ROOT;
        const struct jp_lattice_pose root = anywhere();
        const uint16_t headings = (uint16_t)(1U + below(UINT16_MAX));
        const jp_cost limit = below(3) == 0U ? below(5000) : (jp_cost)LIMIT;

        relax_all(sense, root.x, root.y, headings);
        TEST_ASSERT_EQUAL_INT(JP_OK,
                              jp_pose_field_init(&field, lattice, JP_COST_PHYSICAL, &terrain, block, sizeof block));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, sense, root.x, root.y, headings, limit));
        grow();
        expect_exact(limit);
        expect_ways();
    }
    (void)printf("%lu maps from seed %llu\n", options.count, (unsigned long long)options.seed);
}

/** Of each cell the least sum of both. */
static void expect_return_map(void)
{
    for (int32_t i = 0; i < CELLS; i++) {
        uint32_t least = JP_COST_MAX;

        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            const uint32_t both = out[i / WIDTH][i % WIDTH][heading] + expected[i / WIDTH][i % WIDTH][heading];

            least = both < least ? both : least;
        }
        TEST_ASSERT_EQUAL_UINT32(least, jp_return_map_cost(&out_and_back, i % WIDTH, i / WIDTH));
    }
}

static void test_a_return_map_is_the_cheapest_way_out_and_back(void)
{
    for (uint64_t i = 0; i < options.count; i++) {
        begin_random(options.seed, options.count + i);
        toy_lattice_make(&toy, JP_Q16(0.2));
        make_map();
        const struct jp_lattice_pose from = anywhere();
        const struct jp_lattice_pose home = anywhere();
        const unsigned slice = 1 + below(3000);

        relax_all(JP_POSE_FIELD_FROM_ROOT, from.x, from.y, (uint16_t)(1U << from.heading));
        memcpy(out, expected, sizeof out);
        relax_all(JP_POSE_FIELD_TO_ROOT, home.x, home.y, JP_ANY_HEADING);
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_init(&out_and_back, lattice, &terrain, block, sizeof block));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_return_map_start(&out_and_back, &from, home.x, home.y, LIMIT));
        for (unsigned calls = 0; !jp_return_map_work(&out_and_back, slice); calls++) {
            TEST_ASSERT_TRUE(calls < CALLS_MAX);
        }
        expect_return_map();
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
