/*
 * Primitives that sweep cells up to 127 cells off: after each random edit of the map the repaired plan costs as much as
 * that of a planner that begins anew.
 *
 * prop_far_sweep [--count N] [--seed S]
 * --count is the number of edits.
 */
#include <joulepath/planner.h>

#include "tests/support/options.h"
#include "tests/support/random.h"

enum {
    WIDTH = 200,
    HEIGHT = 24,
    KINDS = 4, /* of motions at each heading: short, long, turns to both sides */
    PRIMITIVES = JP_HEADINGS * KINDS,
    REACH_MAX = 127,
    MOVES = REACH_MAX * JP_MOVE_DIRECTIONS,
    SPANS = (REACH_MAX + 1) * JP_HEADINGS,
    EDITS_PER_MAP = 25,
    BLOCK = 1 << 22,
    SLICE = 5000,
};

static struct jp_primitive primitives[PRIMITIVES];
static uint16_t by_end[PRIMITIVES];
static uint8_t moves[MOVES];
static struct jp_span spans[SPANS];
static struct jp_lattice lattice;
static struct jp_terrain terrain;
static uint64_t terrain_block[1024];
static struct jp_planner repaired;
static struct jp_planner fresh;
static _Alignas(8) uint8_t repaired_block[BLOCK];
static _Alignas(8) uint8_t fresh_block[BLOCK];
static const struct jp_lattice_pose start = {4, 12, 0};
static const struct jp_goal goal = {195, 12, JP_ANY_HEADING};
static struct options options = {.count = 200, .seed = 1};

/* Moves and swept cells of a straight way from a heading, cell by cell. */
static void lay_way(unsigned heading, int steps)
{
    const struct jp_cell_offset offset = jp_move_offsets[heading];
    struct jp_span *span = &spans[heading * (REACH_MAX + 1)];

    for (int i = 0; i <= steps; i++) {
        span[i] = (struct jp_span){(int8_t)(i * offset.dy), (int8_t)(i * offset.dx), (int8_t)(i * offset.dx)};
        moves[heading * REACH_MAX + (unsigned)i % REACH_MAX] = (uint8_t)heading;
    }
}

static void add_primitive(unsigned heading, int turn, int steps, unsigned base)
{
    const struct jp_cell_offset offset = jp_move_offsets[heading];
    struct jp_primitive *primitive = &primitives[lattice.first_from[heading + 1U]++];

    *primitive = (struct jp_primitive){.dx = (int8_t)(steps * offset.dx),
                                       .dy = (int8_t)(steps * offset.dy),
                                       .start = (uint8_t)heading,
                                       .end = (uint8_t)((heading + JP_HEADINGS + (unsigned)turn) % JP_HEADINGS),
                                       .base = {(uint16_t)base, (uint16_t)base, (uint16_t)base},
                                       .first_move = (uint16_t)(heading * REACH_MAX),
                                       .first_span = (uint16_t)(heading * (REACH_MAX + 1)),
                                       .move_count = (uint8_t)steps,
                                       .span_count = (uint8_t)(steps + 1)};
}

static void add_heading(unsigned heading, int reach)
{
    const int steps = heading % 2 != 0 ? reach / 2 : reach;
    const struct jp_cells way = {(uint16_t)(heading * (REACH_MAX + 1)), (uint16_t)(steps + 1)};

    lay_way(heading, steps);
    lattice.heading[heading] = (jp_angle)heading << 28;
    lattice.first_from[heading + 1U] = lattice.first_from[heading];
    add_primitive(heading, 0, 1, 6);
    add_primitive(heading, 0, steps, 1);
    add_primitive(heading, 1, 0, 5);
    add_primitive(heading, -1, 0, 5);
    lattice.reach[heading] = way;
    lattice.footprint[heading] = (struct jp_cells){way.first_span, 1};
    lattice.core = lattice.footprint[heading];
}

static void make_lattice(int reach)
{
    static const int32_t costs[JP_MOVE_KINDS] = {10, 22, 14};
    uint16_t placed = 0;
    const char *field = "";

    lattice = (struct jp_lattice){.name = "far",
                                  .resolution = JP_Q16(0.1),
                                  .primitives = primitives,
                                  .by_end = by_end,
                                  .moves = moves,
                                  .spans = spans};
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        add_heading(heading, reach);
    }
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        for (uint16_t i = 0; i < PRIMITIVES; i++) {
            if (primitives[i].end == heading) {
                by_end[placed++] = i;
            }
        }
        lattice.first_to[heading + 1U] = placed;
    }
    for (unsigned i = 0; i < JP_COST_KINDS * JP_MOVE_KINDS; i++) {
        const struct jp_polynomial level = {costs[i % JP_MOVE_KINDS] * 65536, 0, 0};
        lattice.move_costs[i / JP_MOVE_KINDS][i % JP_MOVE_KINDS] = (struct jp_slope_cost){level, level, 0, 1, 1};
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_lattice_check(&lattice, &field), field);
}

static void begin(struct jp_planner *planner, void *block)
{
    const struct jp_planner_config config = {&lattice, JP_COST_DISTANCE, {JP_EPSILON_ONE}};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_OK, jp_planner_init(planner, &config, &terrain, block, BLOCK, &field), field);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_start(planner, &start));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_planner_set_goal(planner, &goal));
}

static void make_map(void)
{
    const struct jp_terrain_config config = {.width = WIDTH, .height = HEIGHT, .resolution = lattice.resolution};
    const char *field = "";

    TEST_ASSERT_EQUAL_INT_MESSAGE(
        JP_OK, jp_terrain_init(&terrain, &config, terrain_block, sizeof terrain_block, &field), field);
    for (int32_t i = 0; i < WIDTH * HEIGHT; i++) {
        (void)jp_terrain_set_cell(&terrain, i % WIDTH, i / WIDTH, one_in(40) ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
    (void)jp_terrain_set_cell(&terrain, start.x, start.y, JP_CELL_FREE);
    (void)jp_terrain_set_cell(&terrain, goal.x, goal.y, JP_CELL_FREE);
}

/* Cells beside each other, or as far off as are still repaired together; not under start and goal. */
static void edit(void)
{
    const int32_t x = (int32_t)below(WIDTH);

    for (unsigned i = 1 + below(12); i > 0; i--) {
        const int32_t at_x = x + (int32_t)below(16);
        const int32_t at_y = (int32_t)below(16);
        if (at_x != start.x && at_x < goal.x) {
            TEST_ASSERT_EQUAL_INT(
                JP_OK, jp_planner_set_cell(&repaired, at_x, at_y, one_in(2) ? JP_CELL_OCCUPIED : JP_CELL_FREE));
        }
    }
}

static enum jp_answer work(struct jp_planner *planner)
{
    enum jp_answer answer = jp_planner_work(planner, SLICE);

    while (!jp_planner_is_idle(planner)) {
        answer = jp_planner_work(planner, SLICE);
    }
    return answer;
}

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_repaired_plans_cost_as_much_as_new_ones(void)
{
    static const int reaches[] = {127, 20, 25, 40, 64, 100};
    unsigned long optimal = 0;
    unsigned long kept = 0; /* searches that went on */

    begin_random(options.seed, 1);
    for (unsigned long i = 0; i < options.count; i++) {
        if (i % EDITS_PER_MAP == 0) {
            make_lattice(reaches[i / EDITS_PER_MAP % (sizeof reaches / sizeof reaches[0])]);
            make_map();
            begin(&repaired, repaired_block);
        }
        const uint32_t restarts = jp_planner_statistics(&repaired)->restarts;
        const enum jp_answer answer = work(&repaired);
        kept += jp_planner_statistics(&repaired)->restarts == restarts;
        begin(&fresh, fresh_block);
        TEST_ASSERT_EQUAL_INT(work(&fresh), answer);
        TEST_ASSERT_EQUAL_UINT32(jp_planner_plan(&fresh)->cost, jp_planner_plan(&repaired)->cost);
        optimal += answer == JP_ANSWER_OPTIMAL;
        edit();
    }
    printf("edits %lu, optimal %lu, searches that went on %lu\n", options.count, optimal, kept);
    TEST_ASSERT_GREATER_THAN_UINT(options.count / 2, optimal);
    TEST_ASSERT_GREATER_THAN_UINT(options.count / 2, kept);
}

static void add_figures(json_t *figures)
{
    (void)figures;
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, add_figures);
}
