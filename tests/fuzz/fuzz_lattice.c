/**
 * Lattices whose tables hold other numbers: one that passes its check can be priced by any tariff and planned on, and a
 * plan costs what the lattice says.
 */
#include <joulepath/planner.h>
#include <joulepath/tables.h>
#include <joulepath/tariff.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

/** Any index of the tables is within them, as their check cannot know how long they are. */
#define ENTRIES (2U * 65536U)
#define SIDE    14U
#define ROOM    (64U * 1024U)
#define SLICES  60U

static struct jp_lattice lattice;
static struct jp_primitive primitives[ENTRIES];
static uint16_t by_end[ENTRIES];
static uint8_t moves[ENTRIES];
static struct jp_span spans[ENTRIES];
static struct jp_primitive priced[4096];
static struct jp_terrain terrain;
static uint64_t map_block[512];
static struct jp_planner planner;
static uint64_t block[ROOM / sizeof(uint64_t)];

struct lengths {
    uint32_t primitives;
    uint32_t moves;
    uint32_t spans;
};

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static struct lengths lengths_of(const struct jp_lattice *of)
{
    struct lengths lengths = {.primitives = of->first_from[JP_HEADINGS]};

    for (uint32_t i = 0; i < lengths.primitives; i++) {
        const struct jp_primitive *primitive = &of->primitives[i];

        lengths.moves = larger(lengths.moves, primitive->first_move + (uint32_t)primitive->move_count);
        lengths.spans = larger(lengths.spans, primitive->first_span + (uint32_t)primitive->span_count);
    }
    for (unsigned i = 0; i < JP_HEADINGS; i++) {
        lengths.spans = larger(lengths.spans, of->footprint[i].first_span + (uint32_t)of->footprint[i].span_count);
        lengths.spans = larger(lengths.spans, of->reach[i].first_span + (uint32_t)of->reach[i].span_count);
    }
    lengths.spans = larger(lengths.spans, of->core.first_span + (uint32_t)of->core.span_count);
    return lengths;
}

static void change(struct fuzz_input *input, const struct lengths *lengths)
{
    switch (fuzz_below(input, 8)) {
    case 0:
        fuzz_change(input, primitives, lengths->primitives * sizeof primitives[0]);
        break;
    case 1:
        fuzz_change(input, moves, lengths->moves);
        break;
    case 2:
        fuzz_change(input, spans, lengths->spans * sizeof spans[0]);
        break;
    case 3:
        fuzz_change(input, by_end, lengths->primitives * sizeof by_end[0]);
        break;
    case 4:
        FUZZ_CHANGE_FROM(input, lattice, first_from);
        break;
    case 5:
        FUZZ_CHANGE(input, lattice.move_costs);
        break;
    case 6:
        FUZZ_CHANGE(input, lattice.ground);
        FUZZ_CHANGE(input, lattice.sides);
        break;
    default:
        break;
    }
}

static bool draw_lattice(struct fuzz_input *input)
{
    static struct lengths before;
    const struct jp_lattice *from = fuzz_bool(input) ? &jp_lattice_burger : &jp_lattice_zhang2018;
    const struct lengths lengths = lengths_of(from);
    const char *field = NULL;

    /* What an earlier input changed lies within what it had. */
    memset(primitives, 0, larger(before.primitives, lengths.primitives) * sizeof primitives[0]);
    memset(by_end, 0, larger(before.primitives, lengths.primitives) * sizeof by_end[0]);
    memset(moves, 0, larger(before.moves, lengths.moves));
    memset(spans, 0, larger(before.spans, lengths.spans) * sizeof spans[0]);
    before = lengths;
    memcpy(primitives, from->primitives, lengths.primitives * sizeof primitives[0]);
    memcpy(by_end, from->by_end, lengths.primitives * sizeof by_end[0]);
    memcpy(moves, from->moves, lengths.moves);
    memcpy(spans, from->spans, lengths.spans * sizeof spans[0]);
    lattice = *from;
    lattice.primitives = primitives;
    lattice.by_end = by_end;
    lattice.moves = moves;
    lattice.spans = spans;
    change(input, &lengths);

    const enum jp_status status = jp_lattice_check(&lattice, &field);

    return fuzz_accepted(status, field);
}

/** The lattice to plan on: as it is, or by a tariff. */
static struct jp_lattice price(struct fuzz_input *input)
{
    static struct jp_tariff tariff;
    struct jp_tariff_factors factors = {.version = 1};
    const char *field = NULL;

    tariff = (struct jp_tariff){.primitives = priced, .primitives_max = sizeof priced / sizeof priced[0]};
    FUZZ_CHANGE(input, factors);
    if (fuzz_bool(input) && jp_tariff_by_factors(&tariff, &lattice, &factors, &field) == JP_OK) {
        fuzz_require(jp_lattice_check(&tariff.lattice, &field) == JP_OK, "a tariff that makes a lattice wrong");
        return tariff.lattice;
    }
    return lattice;
}

static void draw_map(struct fuzz_input *input)
{
    const struct jp_terrain_config map = {.width = SIDE,
                                          .height = SIDE,
                                          .resolution = lattice.resolution,
                                          .has_elevation = fuzz_bool(input),
                                          .unknown_is_free = true,
                                          .has_costs = fuzz_bool(input),
                                          .has_classes = fuzz_bool(input)};
    const char *field = NULL;

    fuzz_require(jp_terrain_init(&terrain, &map, map_block, sizeof map_block, &field) == JP_OK, "a small map");
    for (unsigned left = fuzz_below(input, 32); left > 0U; left--) {
        const int32_t x = (int32_t)fuzz_below(input, SIDE);
        const int32_t y = (int32_t)fuzz_below(input, SIDE);

        (void)jp_terrain_set_elevation(&terrain, x, y, (jp_elevation)(int8_t)fuzz_u8(input));
        (void)jp_terrain_set_cost(&terrain, x, y, fuzz_u8(input));
        (void)jp_terrain_set_class(&terrain, x, y, (uint8_t)fuzz_below(input, JP_GROUND_CLASSES));
        if (fuzz_below(input, 8) == 7U) {
            (void)jp_terrain_set_cell(&terrain, x, y, JP_CELL_OCCUPIED);
        }
    }
}

static void check_plan(const struct jp_lattice *of, enum jp_cost_kind kind)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_lattice_pose pose = plan->start;
    uint64_t cost = 0;

    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *primitive = jp_planner_step(&planner, i, &pose);

        fuzz_require(primitive != NULL && primitive->start == from.heading, "a step that does not follow");
        cost += jp_lattice_cost(of, kind, &terrain, primitive, from.x, from.y);
    }
    fuzz_require(cost == plan->cost, "a plan of another cost");
}

static void plan(struct fuzz_input *input)
{
    static struct jp_lattice of;
    struct jp_planner_config config = {.lattice = &of,
                                       .cost = (enum jp_cost_kind)fuzz_below(input, JP_COST_KINDS),
                                       .epsilon = {JP_EPSILON(2), JP_EPSILON_ONE}};
    const struct jp_lattice_pose from = {(int16_t)fuzz_below(input, SIDE), (int16_t)fuzz_below(input, SIDE),
                                         (uint8_t)fuzz_below(input, JP_HEADINGS)};
    const struct jp_goal to = {(int16_t)fuzz_below(input, SIDE), (int16_t)fuzz_below(input, SIDE), JP_ANY_HEADING};
    const char *field = NULL;

    of = price(input);
    if (jp_planner_init(&planner, &config, &terrain, block, sizeof block, &field) != JP_OK ||
        jp_planner_set_start(&planner, &from) != JP_OK || jp_planner_set_goal(&planner, &to) != JP_OK) {
        return;
    }
    for (unsigned left = SLICES; left > 0U && !jp_planner_is_idle(&planner); left--) {
        const enum jp_answer answer = jp_planner_work(&planner, 32);

        if (answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND || answer == JP_ANSWER_PARTIAL) {
            check_plan(&of, config.cost);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    if (!draw_lattice(&input)) {
        return 0;
    }
    draw_map(&input);
    for (unsigned left = 4; left > 0U && fuzz_more(&input); left--) {
        plan(&input);
    }
    return 0;
}
