/* Turns among the headings of a cell, against the least costs of turning from each. */
#include "src/map/pose_turns.h"

#include <joulepath/tables.h>
#include <string.h>

#define LEVEL_MAP_BYTES 512
#include "tests/support/level_map.h"
#include "tests/target/random.h"

enum {
    SIDE = 8,
    BLOCK_BYTES = SIDE * SIDE * (JP_HEADINGS * 3 + 4) + SIDE * 4,
    CELLS = 200,
    THRESHOLD = 8000,
    DEAR = 1000000
};

static struct jp_pose_field field;
static uint64_t block[BLOCK_BYTES / 8];
static struct jp_cell_poses cell;
static jp_cost before[JP_HEADINGS];
static uint32_t due;
static uint32_t state;

static void start(enum jp_pose_field_sense sense, bool has_costs, jp_cost threshold)
{
    const struct jp_terrain_config map = {
        .width = SIDE, .height = SIDE, .resolution = jp_lattice_zhang2018.resolution, .has_costs = has_costs};

    make_level_map(&map);
    if (has_costs) {
        (void)jp_terrain_set_cost(&terrain, 3, 4, 1);
    }
    TEST_ASSERT_EQUAL_INT(
        JP_OK, jp_pose_field_init(&field, &jp_lattice_zhang2018, JP_COST_PHYSICAL, &terrain, block, sizeof block));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_pose_field_start(&field, sense, 3, 4, JP_ANY_HEADING, JP_COST_MAX - 2U));
    field.wave.threshold = threshold;
}

void setUp(void)
{
    state = 20261126;
}

void tearDown(void)
{
}

/* Those that are not due have not been reached, or by a way that is dearer than any turn. */
static void make_cell(void)
{
    due = 1U + target_random(&state) % UINT16_MAX;
    cell = (struct jp_cell_poses){.x = 3, .y = 4, .open = due};
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const bool is_due = ((due >> heading) & 1U) != 0U;

        before[heading] = is_due                             ? target_random(&state) % THRESHOLD
                          : target_random(&state) % 2U == 0U ? JP_COST_MAX
                                                             : DEAR;
        cell.value[heading] = before[heading];
    }
}

/* The least over all headings that are due, by the single turn of the lattice, times what the ground multiplies. */
static jp_cost least_of(unsigned to, uint32_t factor)
{
    jp_cost least = before[to];

    for (unsigned from = 0; from < JP_HEADINGS; from++) {
        const jp_cost value = before[from] + field.turns.cost[from][to] * factor;

        if (from != to && ((due >> from) & 1U) != 0U && value < least) {
            least = value;
        }
    }
    return least;
}

static void expect_cell(unsigned count, uint32_t factor)
{
    unsigned settled = 0;

    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        const jp_cost least = least_of(heading, factor);
        const bool is_due = ((due >> heading) & 1U) != 0U;
        const bool is_settled = ((cell.settled >> heading) & 1U) != 0U;
        const bool is_lowered = ((cell.lowered >> heading) & 1U) != 0U;

        settled += is_settled ? 1U : 0U;
        TEST_ASSERT_EQUAL_INT(cell.value[heading] < before[heading], is_lowered);
        TEST_ASSERT_EQUAL_INT(is_due || (is_lowered && least <= field.wave.threshold), is_settled);
        TEST_ASSERT_TRUE(is_settled ? cell.value[heading] == least : cell.value[heading] >= least);
    }
    TEST_ASSERT_EQUAL_UINT32(settled, count);
    TEST_ASSERT_EQUAL_UINT32(0, cell.open);
}

static void expect_cells(uint32_t factor)
{
    for (unsigned i = 0; i < CELLS; i++) {
        make_cell();
        expect_cell(jp_pose_turns_settle(&field, &cell), factor);
    }
}

static void test_turns_lead_everywhere_at_least_cost(void)
{
    start(JP_POSE_FIELD_FROM_ROOT, false, JP_COST_MAX - 2U);
    expect_cells(1);
    start(JP_POSE_FIELD_TO_ROOT, false, JP_COST_MAX - 2U);
    expect_cells(1);
}

static void test_no_turn_leads_on_from_beyond_the_threshold(void)
{
    start(JP_POSE_FIELD_FROM_ROOT, false, THRESHOLD);
    expect_cells(1);
}

/* A cost of 1 doubles what motions cost, where the map says no other shift. */
static void test_the_ground_multiplies_turns(void)
{
    start(JP_POSE_FIELD_FROM_ROOT, true, JP_COST_MAX - 2U);
    expect_cells(2);
}

/* By the sense of the field from one heading to the other, or back. */
static void test_turns_of_the_way_home_are_taken_backward(void)
{
    jp_cost there = 0;

    start(JP_POSE_FIELD_FROM_ROOT, false, THRESHOLD);
    there = jp_pose_turns_cost(&field, 3, 4, 1, 6);
    TEST_ASSERT_EQUAL_UINT32(field.turns.cost[1][6], there);
    start(JP_POSE_FIELD_TO_ROOT, false, THRESHOLD);
    TEST_ASSERT_EQUAL_UINT32(there, field.turns.cost[6][1]);
}

/* A curve may cost no more than its moves: a turn by it is not for nothing, so that no way goes round in circles. */
static void test_no_turn_is_for_nothing(void)
{
    enum { PRIMITIVES_MAX = 160 };
    static struct jp_primitive primitives[PRIMITIVES_MAX];
    struct jp_lattice curves = jp_lattice_zhang2018;
    struct jp_turns turns;
    unsigned free_turns = 0;

    TEST_ASSERT_TRUE(curves.first_from[JP_HEADINGS] <= PRIMITIVES_MAX);
    memcpy(primitives, curves.primitives, curves.first_from[JP_HEADINGS] * sizeof *primitives);
    for (unsigned i = 0; i < curves.first_from[JP_HEADINGS]; i++) {
        const bool is_free = primitives[i].start < 4U && primitives[i].move_count > 0U;

        primitives[i].base[JP_COST_PHYSICAL] = is_free ? 0U : primitives[i].base[JP_COST_PHYSICAL];
    }
    curves.primitives = primitives;
    jp_lattice_turns(&curves, JP_COST_PHYSICAL, &turns);
    for (unsigned sense = 0; sense < 2U; sense++) {
        start((enum jp_pose_field_sense)sense, false, THRESHOLD);
        jp_pose_field_set_lattice(&field, &curves);
        jp_pose_turns_take(&field);
        for (unsigned i = 0; i < JP_HEADINGS * JP_HEADINGS; i++) {
            const unsigned from = i / JP_HEADINGS;
            const unsigned to = i % JP_HEADINGS;
            const uint16_t cost = turns.cost[from][to];

            free_turns += from != to && cost == 0U;
            TEST_ASSERT_EQUAL_UINT32(cost == 0U ? 1U : cost, sense == (unsigned)JP_POSE_FIELD_FROM_ROOT
                                                                 ? field.turns.cost[from][to]
                                                                 : field.turns.cost[to][from]);
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, free_turns);
}

/* A turn leads on where none by a third heading is as cheap. */
static void test_turns_that_lead_on_have_none_between(void)
{
    unsigned single = 0;

    start(JP_POSE_FIELD_FROM_ROOT, false, THRESHOLD);
    for (unsigned seed = 0; seed < 40U; seed++) {
        /* Random turns of the lattice: what costs least is theirs. */
        static struct jp_primitive primitives[JP_HEADINGS * 4];
        struct jp_lattice random = jp_lattice_zhang2018;

        for (unsigned i = 0; i < JP_HEADINGS * 4U; i++) {
            primitives[i] = (struct jp_primitive){.start = (uint8_t)(i / 4U),
                                                  .end = (uint8_t)(target_random(&state) % JP_HEADINGS),
                                                  .base = {(uint16_t)(1U + target_random(&state) % 9U)}};
        }
        random.primitives = primitives;
        for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
            random.first_from[heading + 1U] = (uint16_t)(4U * heading + 4U);
        }
        jp_pose_field_set_lattice(&field, &random);
        jp_pose_turns_take(&field);
        for (unsigned i = 0; i < JP_HEADINGS * JP_HEADINGS; i++) {
            const unsigned from = i / JP_HEADINGS;
            const unsigned to = i % JP_HEADINGS;
            const uint32_t cost = field.turns.cost[from][to];
            bool leads_on = from != to && cost != UINT16_MAX;

            for (unsigned by = 0; by < JP_HEADINGS; by++) {
                const uint32_t over = (uint32_t)field.turns.cost[from][by] + field.turns.cost[by][to];

                leads_on = leads_on && (by == from || by == to || over > cost);
            }
            TEST_ASSERT_EQUAL_INT(leads_on, ((unsigned)field.onward[from] >> to) & 1U);
            single += leads_on;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(40 * JP_HEADINGS, single);
}
