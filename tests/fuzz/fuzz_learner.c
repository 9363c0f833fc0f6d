/**
 * The learner of a balancer and its forecasts, with any tables that pass their checks, from any legs, segments and
 * measured energies: the state that it came to by itself can be stored, its model planned with, and no deviation is
 * below 0; from a state that flash made up, too, but that this one need not pass for one that a history leads to.
 */
#include <joulepath/learner.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

static struct jp_learning learning;
static struct jp_energy_model model;
static struct jp_horizon horizon;
static struct jp_learner learner;
static bool is_made_up; /* the state that it learned on from */

static void check_learner(void)
{
    struct jp_energy_model learned;
    const char *field = NULL;
    jp_q16 ground, payload;

    fuzz_require(is_made_up || jp_learned_state_check(&learner.state, &field) == JP_OK,
                 "a state that cannot be stored");
    jp_learner_model(&learner, &learned);
    fuzz_require(jp_energy_model_check(&learned, &field) == JP_OK, "a model that cannot be planned with");
    jp_learner_causes(&learner, &ground, &payload);
    fuzz_require(ground >= 0, "friction below 0");
    jp_learner_cause_deviations(&learner, &ground, &payload);
    fuzz_require(ground >= 0 && payload >= 0, "a deviation below 0");
}

static struct jp_segment_command draw_segment(struct fuzz_input *input)
{
    struct jp_segment_command segment = {
        .motion = {fuzz_range(input, -JP_Q24(1), JP_Q24(1)), fuzz_range(input, -JP_Q24(2), JP_Q24(2))},
        .turn = fuzz_range(input, -JP_Q24(3), JP_Q24(3)),
        .duration = fuzz_range(input, 0, JP_Q16(20)),
    };

    if (fuzz_below(input, 8) == 7U) {
        FUZZ_CHANGE(input, segment);
    }
    return segment;
}

static struct jp_leg_energy draw_leg(struct fuzz_input *input)
{
    struct jp_leg_energy leg;

    if (fuzz_below(input, 4) == 3U) {
        fuzz_fill(input, &leg, sizeof leg);
        return leg;
    }
    leg = (struct jp_leg_energy){.energy = fuzz_range(input, 0, JP_Q16(500)),
                                 .duration = fuzz_range(input, 0, JP_Q16(60)),
                                 .travel = fuzz_range(input, 0, JP_Q16(60)),
                                 .turning = fuzz_range(input, 0, JP_Q16(60))};
    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        leg.transient[i] = fuzz_range(input, -JP_Q16(10), JP_Q16(10));
    }
    return leg;
}

static jp_q16 draw_energy(struct fuzz_input *input)
{
    return fuzz_bool(input) ? fuzz_range(input, 0, JP_Q16(500)) : (jp_q16)fuzz_u32(input);
}

static void forecast(struct fuzz_input *input)
{
    struct jp_forecast_sum sum = {.energy = 0};
    struct jp_energy_start start = {.is_forward = true};
    struct jp_forecast whole;
    jp_q16 spare = 0;

    for (unsigned left = fuzz_below(input, 32); left > 0U; left--) {
        if (fuzz_bool(input)) {
            const struct jp_segment_command segment = draw_segment(input);

            (void)jp_forecast_add(&learner, &sum, &start, &segment);
        } else {
            const struct jp_leg_energy leg = draw_leg(input);

            (void)jp_forecast_add_leg(&learner, &sum, &leg);
        }
    }

    const enum jp_status status = jp_forecast_total(&learner, &sum, &whole);

    fuzz_require(status == JP_OK || status == JP_ERR_OVERFLOW, "a status of a forecast");
    fuzz_require(whole.deviation >= 0, "a deviation of a forecast below 0");

    const jp_q31 confidence = (jp_q31)fuzz_u32(input);
    const jp_q16 available = draw_energy(input);

    if (jp_forecast_reserve(&whole, available, confidence, &spare) == JP_OK && status == JP_OK) {
        fuzz_require(spare <= jp_saturate32((int64_t)available - whole.energy), "a reserve above what is left");
    }
}

static void learn(struct fuzz_input *input)
{
    struct jp_energy_start start = {.is_forward = fuzz_bool(input)};
    enum jp_learned learned = JP_LEARNED;

    FUZZ_CHANGE(input, start.motion);
    if (fuzz_bool(input)) {
        const struct jp_segment_command segment = draw_segment(input);

        (void)jp_learner_update(&learner, &start, &segment, draw_energy(input), &learned);
    } else {
        const struct jp_leg_energy leg = draw_leg(input);

        (void)jp_learner_update_leg(&learner, &leg, draw_energy(input), &learned);
    }
    fuzz_require(learned <= JP_LEARNED_CHANGE, "what became of a measurement");
    check_learner();
}

static void restore(struct fuzz_input *input)
{
    struct jp_learned_state state = learner.state;
    const char *field = NULL;

    FUZZ_CHANGE(input, state);
    is_made_up = fuzz_accepted(jp_learner_restore(&learner, &state, &field), field) || is_made_up;
    check_learner();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    const char *field = NULL;

    learning = fuzz_bool(&input) ? jp_learning_courier24 : jp_learning_gao2018_battery;
    model = fuzz_bool(&input) ? jp_energy_model_courier24 : jp_energy_model_gao2018_battery;
    horizon = fuzz_bool(&input) ? jp_horizon_courier24 : jp_horizon_gao2018_battery;
    FUZZ_CHANGE(&input, learning);
    FUZZ_CHANGE(&input, model);
    FUZZ_CHANGE(&input, horizon);
    if (!fuzz_accepted(jp_learning_check(&learning, &field), field) ||
        !fuzz_accepted(jp_energy_model_check(&model, &field), field) ||
        !fuzz_accepted(jp_horizon_check(&horizon, &field), field)) {
        return 0;
    }
    jp_learner_start(&learner, &learning, &model, fuzz_below(&input, 8) == 7U ? NULL : &horizon);
    is_made_up = false;
    check_learner();
    for (unsigned left = 100; left > 0U && fuzz_more(&input); left--) {
        switch (fuzz_below(&input, 8)) {
        case 0:
            restore(&input);
            break;
        case 1:
            forecast(&input);
            break;
        default:
            learn(&input);
            break;
        }
    }
    return 0;
}
