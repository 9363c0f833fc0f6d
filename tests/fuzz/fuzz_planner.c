/**
 * The lattice planner on small maps that the input draws and changes while it searches in slices, in blocks with room
 * for few states or many: the plan costs what it says by the lattice and touches nothing, its bound holds when it says
 * optimal, and a search begun anew agrees.
 */
#include <joulepath/lattice_path.h>
#include <joulepath/planner.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_input.h"

#define SIDE_MAX 24U
#define ROOM     (48U * 1024U)
#define WORK_MAX 4000U
#define PIECES   64U

static const struct jp_lattice *const all[] = {&jp_lattice_zhang2018, &jp_lattice_gao2018, &jp_lattice_courier24,
                                               &jp_lattice_burger, &jp_lattice_zhang2018_navigation};

static struct jp_lattice lattice;
static struct jp_terrain terrain;
static struct jp_planner planner;
static struct jp_planner_config config;
static uint64_t map_block[4096];
static uint64_t block[ROOM / sizeof(uint64_t)];
static uint64_t second_block[ROOM / sizeof(uint64_t)];
static struct jp_path_piece pieces[PIECES];

static void draw_map(struct fuzz_input *input)
{
    const struct jp_terrain_config map = {.width = (uint16_t)(8U + fuzz_below(input, SIDE_MAX - 7U)),
                                          .height = (uint16_t)(8U + fuzz_below(input, SIDE_MAX - 7U)),
                                          .resolution = lattice.resolution,
                                          .has_elevation = fuzz_bool(input),
                                          .unknown_is_free = fuzz_below(input, 4) != 0U,
                                          .has_costs = fuzz_bool(input),
                                          .cost_shift = (uint8_t)fuzz_below(input, JP_CELL_COST_SHIFT_MAX + 1U),
                                          .has_classes = fuzz_bool(input)};
    const char *field = NULL;

    fuzz_require(jp_terrain_init(&terrain, &map, map_block, sizeof map_block, &field) == JP_OK, "a small map");
    for (uint32_t y = 0; fuzz_below(input, 4) != 3U && y < map.height; y++) {
        for (uint32_t x = 0; x < map.width; x++) {
            (void)jp_terrain_set_cell(&terrain, (int32_t)x, (int32_t)y, JP_CELL_FREE);
        }
    }
}

static bool start(struct fuzz_input *input)
{
    const char *field = NULL;
    const size_t sizes[] = {sizeof block, 2048U + fuzz_below(input, ROOM - 2047U)};

    config = (struct jp_planner_config){
        .lattice = &lattice,
        .cost = (enum jp_cost_kind)fuzz_below(input, JP_COST_KINDS),
        .epsilon = {JP_EPSILON(3), JP_EPSILON_ONE},
    };
    if (fuzz_below(input, 4) == 0U) {
        for (unsigned i = 0; i < JP_EPSILON_LEVELS; i++) {
            config.epsilon[i] = fuzz_u16(input);
        }
    }

    const enum jp_status status =
        jp_planner_init(&planner, &config, &terrain, block, sizes[fuzz_below(input, 2)], &field);

    fuzz_require(status == JP_OK || status == JP_ERR_MEMORY ||
                     (status == JP_ERR_CONFIG && field != NULL && field[0] != '\0'),
                 "a status of the planner");
    return status == JP_OK;
}

/** The steps lead from start to end over free cells at what the lattice says. */
static void check_plan(const struct jp_planner *of)
{
    const struct jp_plan *plan = jp_planner_plan(of);
    struct jp_lattice_pose pose = plan->start;
    uint64_t cost = 0;

    for (unsigned i = 0; i < plan->step_count; i++) {
        const struct jp_lattice_pose from = pose;
        const struct jp_primitive *primitive = jp_planner_step(of, i, &pose);

        fuzz_require(primitive != NULL && primitive->start == from.heading, "a step that does not follow");

        const jp_cost step = jp_lattice_cost(&lattice, config.cost, &terrain, primitive, from.x, from.y);

        fuzz_require(step < JP_COST_MAX, "a plan that touches something");
        cost += step;
    }
    fuzz_require(cost == plan->cost, "a plan of another cost");
    fuzz_require(plan->end.x == pose.x && plan->end.y == pose.y && plan->end.heading == pose.heading, "another end");
}

static bool has_plan(enum jp_answer answer)
{
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND || answer == JP_ANSWER_PARTIAL;
}

/** What one finds that begins anew on this map. */
static void compare_with_new(enum jp_answer answer)
{
    static struct jp_planner second;
    const struct jp_plan *plan = jp_planner_plan(&planner);
    const struct jp_plan *other = jp_planner_plan(&second);
    const struct jp_goal goal = {plan->end.x, plan->end.y, (uint16_t)(1U << plan->end.heading)};
    const char *field = NULL;
    enum jp_answer found = JP_ANSWER_OUT_OF_BUDGET;

    /* Who is at the goal stays there, also where a change blocks it. */
    if (answer == JP_ANSWER_PARTIAL || plan->step_count == 0U ||
        jp_planner_init(&second, &config, &terrain, second_block, sizeof second_block, &field) != JP_OK) {
        return;
    }
    fuzz_require(jp_planner_set_start(&second, &plan->start) == JP_OK && jp_planner_set_goal(&second, &goal) == JP_OK,
                 "a plan between places where the robot cannot be");
    for (unsigned left = WORK_MAX; left > 0U && !jp_planner_is_idle(&second); left--) {
        found = jp_planner_work(&second, 64);
    }
    fuzz_require(found != JP_ANSWER_UNREACHABLE, "a plan where there is none");
    if (found == JP_ANSWER_OPTIMAL) {
        fuzz_require(other->cost <= plan->cost, "a plan that costs less than the optimum");
        fuzz_require(answer != JP_ANSWER_OPTIMAL || other->cost == plan->cost, "an optimum that is none");
    }
}

static void edit(struct fuzz_input *input)
{
    const int32_t x = (int32_t)fuzz_below(input, SIDE_MAX + 2U) - 1;
    const int32_t y = (int32_t)fuzz_below(input, SIDE_MAX + 2U) - 1;

    switch (fuzz_below(input, 8)) {
    case 0:
        (void)jp_planner_set_elevation(&planner, x, y, (jp_elevation)fuzz_range(input, -2048, 2048));
        break;
    case 1:
        (void)jp_planner_set_cost(&planner, x, y, fuzz_u8(input));
        break;
    case 2:
        (void)jp_planner_set_class(&planner, x, y, (uint8_t)fuzz_below(input, JP_GROUND_CLASSES + 1U));
        break;
    default:
        (void)jp_planner_set_cell(&planner, x, y, (enum jp_cell)fuzz_below(input, 3));
        break;
    }
}

static void place(struct fuzz_input *input)
{
    const struct jp_lattice_pose from = {(int16_t)(fuzz_below(input, SIDE_MAX + 2U)),
                                         (int16_t)(fuzz_below(input, SIDE_MAX + 2U)),
                                         (uint8_t)fuzz_below(input, JP_HEADINGS + 1U)};
    const struct jp_goal to = {(int16_t)(fuzz_below(input, SIDE_MAX + 2U)), (int16_t)(fuzz_below(input, SIDE_MAX + 2U)),
                               fuzz_bool(input) ? JP_ANY_HEADING : fuzz_u16(input)};

    if (fuzz_bool(input)) {
        (void)jp_planner_set_start(&planner, &from);
    } else {
        (void)jp_planner_set_goal(&planner, &to);
    }
}

/** Along the plan, as a robot drives it. */
static void drive_on(struct fuzz_input *input)
{
    const struct jp_plan *plan = jp_planner_plan(&planner);
    struct jp_lattice_pose pose = plan->start;

    for (unsigned i = 0, steps = fuzz_below(input, 4); i < steps && i < plan->step_count; i++) {
        (void)jp_planner_step(&planner, i, &pose);
    }
    (void)jp_planner_set_start(&planner, &pose);
}

static void work(struct fuzz_input *input)
{
    const enum jp_answer answer = jp_planner_work(&planner, 1U + fuzz_below(input, 64));
    const bool idle = jp_planner_is_idle(&planner);

    if (has_plan(answer)) {
        const struct jp_plan *plan = jp_planner_plan(&planner);

        fuzz_require(plan->answer == answer, "another answer");
        check_plan(&planner);
        if (idle && fuzz_below(input, 4) == 3U) {
            struct jp_lattice_path path;

            compare_with_new(answer);
            (void)jp_lattice_path_of_plan(&path, &planner, pieces, PIECES);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    lattice = *all[fuzz_below(&input, sizeof all / sizeof all[0])];
    draw_map(&input);
    if (!start(&input)) {
        return 0;
    }
    for (unsigned left = 200; left > 0U && fuzz_more(&input); left--) {
        switch (fuzz_below(&input, 8)) {
        case 0:
            place(&input);
            break;
        case 1:
            drive_on(&input);
            break;
        case 2:
        case 3:
            edit(&input);
            break;
        case 4:
            if (fuzz_below(&input, 8) == 0U) {
                jp_planner_restart(&planner);
            }
            break;
        default:
            work(&input);
            break;
        }
    }
    return 0;
}
