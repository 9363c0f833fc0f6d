/*
 * Ways of unit steps on random maps, by lattices made at random, some of whose steps sweep other cells there than back,
 * or are missing, against a relaxation of all cells until nothing changes.
 *
 * prop_lattice_way [--count N] [--seed S]
 */
#include <joulepath/lattice_way.h>

#include "tests/support/options.h"
#include "tests/support/toy_lattice.h"
#include "tests/support/way_oracle.h"
#include "unity.h"

enum { WIDTH = 37, HEIGHT = 21, LOOKS_MAX = 100000 };

static struct options options = {.count = 600, .seed = 4711};
static struct toy_lattice toy;
static struct jp_terrain terrain;
static struct jp_lattice_way way;
static uint64_t map_block[(2 * 2 * HEIGHT * 4 + 2 * WIDTH * HEIGHT + 7) / 8];
static uint64_t block[3 * (WIDTH * HEIGHT + 31) / 32];

void setUp(void)
{
}

void tearDown(void)
{
}

static struct jp_primitive *unit_of(unsigned heading)
{
    return &toy.primitives[toy.lattice.first_from[heading]];
}

/** Some steps sweep what others do, and some are no unit steps. */
static void spoil_lattice(void)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        struct jp_primitive *step = unit_of(heading);

        if (below(6) == 0U) {
            const struct jp_primitive *other = unit_of(below(JP_HEADINGS));
            step->first_span = other->first_span;
            step->span_count = other->span_count;
        }
        if (below(6) == 0U) {
            step->end = (uint8_t)((step->end + 1U) % JP_HEADINGS);
        }
    }
}

static void make_map(void)
{
    const struct jp_terrain_config config = {
        .width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.2), .has_elevation = below(2) == 0U};
    const uint32_t free_percent = 55 + below(45);
    const uint32_t relief = 1 + below(120);
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&terrain, &config, map_block, sizeof map_block, &field));
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        (void)jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH,
                                  below(100) < free_percent ? JP_CELL_FREE : JP_CELL_OCCUPIED);
        if (config.has_elevation) {
            (void)jp_terrain_set_elevation(&terrain, i % WIDTH, i / WIDTH, (jp_elevation)below(relief));
        }
    }
}

static struct jp_way_cell anywhere(void)
{
    return (struct jp_way_cell){(int16_t)below(WIDTH), (int16_t)below(HEIGHT)};
}

static enum jp_way_answer finish(unsigned slice)
{
    for (unsigned i = 0; i < LOOKS_MAX; i++) {
        const enum jp_way_answer answer = jp_lattice_way_work(&way, slice);

        if (answer != JP_WAY_WORKING) {
            return answer;
        }
    }
    return JP_WAY_WORKING;
}

static void test_fewest_steps_on_any_map_and_lattice(void)
{
    unsigned found = 0;

    for (uint64_t i = 0; i < options.count; i++) {
        begin_random(options.seed, i);
        toy_lattice_make(&toy, JP_Q16(0.2));
        spoil_lattice();
        make_map();
        const struct jp_way_cell start = anywhere();
        const struct jp_way_cell goal = anywhere();

        way_oracle_solve(&toy.lattice, &terrain, &goal);
        TEST_ASSERT_EQUAL_INT(JP_OK,
                              jp_lattice_way_start(&way, &toy.lattice, &terrain, &start, &goal, block, sizeof block));
        const bool is_near = *way_oracle_at(&terrain, start.x, start.y) < WAY_ORACLE_FAR;

        TEST_ASSERT_EQUAL_INT(is_near ? JP_WAY_FOUND : JP_WAY_NONE, finish(1 + below(400)));
        if (is_near) {
            way_oracle_expect(&terrain, &way, start);
            found++;
        }
    }
    (void)printf("%lu maps from seed %llu: a way on %u\n", options.count, (unsigned long long)options.seed, found);
    TEST_ASSERT_TRUE(found > options.count / 8 && found < options.count);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    UNITY_BEGIN();
    run_tests();
    return UNITY_END();
}
