/*
 * The planner at the far corner of the largest map: a walled room there has the routes that it has alone. And a planner
 * in a block that its energy field fits in only after the search, beside one that proves its routes.
 *
 * prop_planner_large [--count N] [--seed S] [--json FILE]
 */
#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <stdlib.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

enum {
    ROOM = 60, /* cells, its walls among them */
    EDITS = 6,
    TIGHT_BLOCK = 30 * 1024, /* the energy field fits in the states' place only */
    SMALL_BLOCK = 1024 * 1024,
    LARGE_BLOCK = 160 * 1024 * 1024, /* with the energy field: 3 bytes a cell and more */
    SLICE = 64,
};

static const struct jp_lattice *const lattice = &jp_lattice_zhang2018;
static struct options options = {.count = 10, .seed = 1};

/* A map with the room at (corner, corner), and a planner on it. */
struct site {
    int32_t corner;
    struct jp_terrain terrain;
    struct jp_planner planner;
    void *terrain_block;
    void *block;
};

static struct site alone;
static struct site far_off;

void setUp(void)
{
}

void tearDown(void)
{
}

static void *allocate(size_t size)
{
    void *block = malloc(size);

    TEST_ASSERT_NOT_NULL(block);
    return block;
}

static void open_site(struct site *site, uint16_t side, size_t block_size)
{
    const struct jp_terrain_config map = {
        .width = side, .height = side, .resolution = lattice->resolution, .has_elevation = true};
    const struct jp_planner_config config = {lattice, JP_COST_PHYSICAL, {JP_EPSILON(1.35), JP_EPSILON_ONE}};
    const size_t size = jp_terrain_size(&map);
    const char *field = "";

    site->corner = side - ROOM;
    site->terrain_block = allocate(size);
    site->block = allocate(block_size);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&site->terrain, &map, site->terrain_block, size, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_planner_init(&site->planner, &config, &site->terrain, site->block, block_size, &field));
    TEST_ASSERT_TRUE((jp_planner_statistics(&site->planner)->field_bytes > 0) == (block_size > TIGHT_BLOCK));
}

static void close_site(struct site *site)
{
    free(site->terrain_block);
    free(site->block);
}

static void put(struct site *site, int32_t x, int32_t y, enum jp_cell cell, int elevation)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&site->terrain, site->corner + x, site->corner + y, cell));
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_terrain_set_elevation(&site->terrain, site->corner + x, site->corner + y, (jp_elevation)elevation));
}

static void change(struct site *site, int32_t x, int32_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_cell(&site->planner, site->corner + x, site->corner + y, cell));
}

static void furnish(void)
{
    for (int32_t y = 0; y < ROOM; y++) {
        for (int32_t x = 0; x < ROOM; x++) {
            const bool is_wall = x == 0 || y == 0 || x == ROOM - 1 || y == ROOM - 1;
            const enum jp_cell cell = is_wall || below(150) == 0 ? JP_CELL_OCCUPIED : JP_CELL_FREE;
            const int elevation = (int)below(20);
            put(&alone, x, y, cell, elevation);
            put(&far_off, x, y, cell, elevation);
        }
    }
}

static void edit(void)
{
    const int32_t x = 1 + (int32_t)below(ROOM - 2);
    const int32_t y = 1 + (int32_t)below(ROOM - 2);
    const enum jp_cell cell = below(2) == 0 ? JP_CELL_OCCUPIED : JP_CELL_FREE;

    change(&alone, x, y, cell);
    change(&far_off, x, y, cell);
}

/* False where the robot cannot stand. */
static bool go(struct site *site, const struct jp_lattice_pose *from, const struct jp_goal *to)
{
    const struct jp_lattice_pose start = {(int16_t)(site->corner + from->x), (int16_t)(site->corner + from->y),
                                          from->heading};
    const struct jp_goal goal = {(int16_t)(site->corner + to->x), (int16_t)(site->corner + to->y), to->headings};

    return jp_planner_set_start(&site->planner, &start) == JP_OK && jp_planner_set_goal(&site->planner, &goal) == JP_OK;
}

static enum jp_answer finish(struct site *site)
{
    while (!jp_planner_is_idle(&site->planner)) {
        (void)jp_planner_work(&site->planner, SLICE);
    }
    return jp_planner_work(&site->planner, 0);
}

/* True when there is a route. */
static bool expect_equal_plans(void)
{
    const enum jp_answer answer = finish(&alone);

    TEST_ASSERT_EQUAL_INT(answer, finish(&far_off));
    TEST_ASSERT_TRUE(answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_UNREACHABLE);
    if (answer == JP_ANSWER_UNREACHABLE) {
        return false;
    }
    TEST_ASSERT_EQUAL_UINT32(jp_planner_plan(&alone.planner)->cost, jp_planner_plan(&far_off.planner)->cost);
    TEST_ASSERT_EQUAL_INT(far_off.corner - alone.corner,
                          jp_planner_plan(&far_off.planner)->end.x - jp_planner_plan(&alone.planner)->end.x);
    return true;
}

static void test_a_room_far_off_has_the_routes_that_it_has_alone(void)
{
    unsigned routes = 0;

    open_site(&alone, ROOM, SMALL_BLOCK);
    open_site(&far_off, JP_TERRAIN_SIDE_MAX, LARGE_BLOCK);
    for (unsigned i = 0; i < options.count; i++) {
        begin_random(options.seed, i);
        const struct jp_lattice_pose from = {6, 6, (uint8_t)below(JP_HEADINGS)};
        const struct jp_goal to = {ROOM - 7, ROOM - 7, JP_ANY_HEADING};
        furnish();
        if (!go(&alone, &from, &to) || !go(&far_off, &from, &to)) {
            continue;
        }
        routes += expect_equal_plans();
        for (unsigned k = 0; k < EDITS; k++) {
            edit();
            routes += expect_equal_plans();
        }
    }
    close_site(&alone);
    close_site(&far_off);
    printf("%u plans\n", routes);
    TEST_ASSERT_TRUE(routes > 0);
}

/* The map changes when the states are cleared for the exact search beside the field, and anywhere else. */
static void work_on(struct site *site)
{
    unsigned slices = below(2) == 0 ? below(3000) : 1000000;

    for (; slices > 0 && !jp_planner_is_idle(&site->planner); slices--) {
        (void)jp_planner_work(&site->planner, 1);
        if (site->planner.internal.lent != JP_PLANNER_LENT_TO_NONE &&
            site->planner.internal.phase == JP_PLANNER_CLEAR) {
            return;
        }
    }
}

static bool expect_true_bound(void)
{
    const struct jp_plan *plan = jp_planner_plan(&alone.planner);
    const struct jp_plan *best = jp_planner_plan(&far_off.planner);
    const enum jp_answer answer = finish(&alone);

    if (finish(&far_off) != JP_ANSWER_OPTIMAL || (answer != JP_ANSWER_OPTIMAL && answer != JP_ANSWER_WITHIN_BOUND)) {
        return false;
    }
    TEST_ASSERT_TRUE(plan->cost >= best->cost);
    TEST_ASSERT_TRUE((uint64_t)plan->cost * JP_EPSILON_ONE <= (uint64_t)plan->bound * best->cost);
    return true;
}

static void test_a_bound_in_the_states_place_is_true(void)
{
    unsigned routes = 0;

    open_site(&alone, ROOM, TIGHT_BLOCK);
    open_site(&far_off, ROOM, SMALL_BLOCK);
    for (unsigned i = 0; i < options.count; i++) {
        begin_random(options.seed, 1000 + i);
        const struct jp_lattice_pose from = {6, 6, (uint8_t)below(JP_HEADINGS)};
        const struct jp_goal to = {ROOM - 7, ROOM - 7, JP_ANY_HEADING};
        furnish();
        if (!go(&alone, &from, &to) || !go(&far_off, &from, &to)) {
            continue;
        }
        for (unsigned k = 0; k < EDITS; k++) {
            work_on(&alone);
            edit();
            routes += expect_true_bound();
        }
    }
    close_site(&alone);
    close_site(&far_off);
    printf("%u bounds\n", routes);
    TEST_ASSERT_TRUE(routes > 0);
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
