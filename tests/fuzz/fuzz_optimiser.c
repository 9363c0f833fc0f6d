/**
 * The searches over trajectories, for least energy and within a budget, with any energy model and configuration that
 * pass their checks, over any points: they end within the slices that are stated, and what they find the rule can plan.
 */
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_budget.h>
#include <joulepath/trajectory_optimiser.h>
#include <math.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

#define LEGS 6U

static struct jp_trajectory_config config;
static struct jp_energy_model model;
static struct jp_point targets[LEGS];
static struct jp_passage given[LEGS];
static struct jp_passage found[LEGS];
static struct jp_optimiser_place places[LEGS];
static struct jp_trajectory_leg legs[LEGS];

static struct jp_trajectory_task draw_task(struct fuzz_input *input)
{
    const int32_t most = fuzz_bool(input) ? JP_Q16(8) : fuzz_bool(input) ? JP_Q16(300) : INT32_MAX;
    struct jp_trajectory_task task = {
        .config = &config,
        .cruise = fuzz_range(input, JP_Q24(0.01), JP_Q24(2)),
        .start = {fuzz_range(input, -most, most), fuzz_range(input, -most, most)},
        .heading = fuzz_u32(input),
        .targets = targets,
        .passages = fuzz_bool(input) ? given : NULL,
        .count = (uint16_t)fuzz_below(input, LEGS + 1U),
        .to_stand = fuzz_bool(input),
    };

    if (fuzz_bool(input)) {
        FUZZ_CHANGE(input, task.motion);
    }
    for (unsigned i = 0; i < LEGS; i++) {
        targets[i] = (struct jp_point){fuzz_range(input, -most, most), fuzz_range(input, -most, most)};
        given[i] = (struct jp_passage){(uint8_t)fuzz_below(input, 4), fuzz_u32(input),
                                       fuzz_range(input, JP_Q24(0.01), JP_Q24(2))};
    }
    return task;
}

static void optimise(struct fuzz_input *input)
{
    static struct jp_trajectory_optimiser optimiser;
    const struct jp_trajectory_optimiser_config search = {
        .task = draw_task(input),
        .model = &model,
        .back_emf = {fuzz_range(input, 0, JP_Q16(4096)), fuzz_range(input, 0, JP_Q16(4096))},
        .goes_on = fuzz_bool(input),
        .held = (uint16_t)fuzz_below(input, LEGS + 1U),
        .passages = found,
        .places = places,
        .place_count = (uint16_t)fuzz_below(input, LEGS + 1U),
    };
    unsigned slices = (JP_OPTIMISER_EVALUATIONS + 1U) * LEGS;
    enum jp_status status = jp_trajectory_optimiser_start(&optimiser, &search);

    memset(found, 0, sizeof found);
    if (status != JP_OK) {
        return;
    }
    do {
        status = jp_trajectory_optimiser_work(&optimiser);
    } while (status == JP_WORKING && slices-- > 0U);
    fuzz_require(status != JP_WORKING, "a search that takes more slices than it may");
    if (status == JP_OK) {
        fuzz_require(isfinite(optimiser.rule) && isfinite(optimiser.found) && optimiser.found <= optimiser.rule,
                     "passages that cost more than the rule's own");
    }
}

static void keep_budget(struct fuzz_input *input)
{
    static struct jp_trajectory_budget budget;
    static struct jp_trajectory trajectory;
    const struct jp_trajectory_budget_config search = {
        .task = draw_task(input),
        .model = &model,
        .kind = (enum jp_budget_kind)fuzz_below(input, 2),
        .limit = fuzz_range(input, 0, INT32_MAX),
        .legs = legs,
        .trajectory = &trajectory,
    };
    unsigned slices = JP_BUDGET_SLICES;
    enum jp_status status = jp_trajectory_budget_start(&budget, &search);

    if (status != JP_OK) {
        return;
    }
    do {
        status = jp_trajectory_budget_work(&budget);
    } while (status == JP_WORKING && slices-- > 0U);
    fuzz_require(status != JP_WORKING, "a search that takes more slices than it may");
    if (status == JP_OK) {
        const jp_q16 takes = search.kind == JP_BUDGET_SECONDS ? budget.best.seconds : budget.best.energy;

        fuzz_require(takes <= search.limit, "a trajectory beyond its budget");
        fuzz_require(trajectory.count == search.task.count, "a trajectory that is not whole");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    const char *field = NULL;
    const bool small = fuzz_bool(&input);

    config = small ? jp_robot_gao2018.trajectory : jp_robot_courier24.trajectory;
    model = small ? jp_energy_model_gao2018 : jp_energy_model_courier24_battery;
    FUZZ_CHANGE(&input, config);
    FUZZ_CHANGE(&input, model);
    if (!fuzz_accepted(jp_trajectory_check(&config, &field), field) ||
        !fuzz_accepted(jp_energy_model_check(&model, &field), field)) {
        return 0;
    }
    for (unsigned left = 6; left > 0U && fuzz_more(&input); left--) {
        if (fuzz_bool(&input)) {
            optimise(&input);
        } else {
            keep_budget(&input);
        }
    }
    return 0;
}
