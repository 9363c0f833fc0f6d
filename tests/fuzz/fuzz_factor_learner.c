/**
 * Energy models of robots that learn factors, skid-steered and with four wheels, with any numbers that pass their
 * checks, on drives of any pieces: energies stay in their formats, factors in their range, and no deviation is below 0.
 */
#include <joulepath/four_wheel_learner.h>
#include <joulepath/skid_learner.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_input.h"

static struct jp_skid_learning skid_learning;
static struct jp_skid_energy_model skid_model;
static struct jp_skid_learner skid;
static struct jp_factor_learning wheel_learning;
static struct jp_four_wheel_energy_model wheel_model;
static struct jp_four_wheel_learner wheels;

static void check_factors(const jp_q16 *factor, const jp_q16 *deviation, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        fuzz_require(factor[i] >= JP_FACTOR_MIN && factor[i] <= JP_FACTOR_MAX, "a factor out of range");
        fuzz_require(deviation[i] >= 0, "a deviation below 0");
    }
}

static void check_forecast(enum jp_status status, const struct jp_forecast *forecast)
{
    fuzz_require(status == JP_OK || status == JP_ERR_OVERFLOW, "a status of a forecast");
    fuzz_require(forecast->deviation >= 0, "a deviation of a forecast below 0");
}

static jp_q16 draw_energy(struct fuzz_input *input)
{
    return fuzz_bool(input) ? fuzz_range(input, 0, JP_Q16(500)) : (jp_q16)fuzz_u32(input);
}

static struct jp_skid_drive draw_skid_drive(struct fuzz_input *input)
{
    struct jp_skid_drive drive = {.energy = 0};

    for (unsigned left = fuzz_below(input, 6); left > 0U; left--) {
        struct jp_skid_piece piece = {
            .start = {fuzz_range(input, -JP_Q24(2), JP_Q24(2)), fuzz_range(input, -JP_Q24(2), JP_Q24(2))},
            .end = {fuzz_range(input, -JP_Q24(2), JP_Q24(2)), fuzz_range(input, -JP_Q24(2), JP_Q24(2))},
            .grade = fuzz_range(input, -JP_Q24(0.5), JP_Q24(0.5)),
            .duration = fuzz_range(input, 1, JP_Q16(60)),
        };

        FUZZ_CHANGE(input, piece);
        (void)jp_skid_energy_add(&skid.model, &drive, &piece);
    }
    return drive;
}

static struct jp_four_wheel_drive draw_wheel_drive(struct fuzz_input *input)
{
    struct jp_four_wheel_drive drive = {.energy = 0};

    for (unsigned left = fuzz_below(input, 6); left > 0U; left--) {
        struct jp_four_wheel_piece piece = {
            .start = {.x = fuzz_range(input, -JP_Q24(2), JP_Q24(2)),
                      .turn_rate = fuzz_range(input, -JP_Q24(2), JP_Q24(2))},
            .end = {.x = fuzz_range(input, -JP_Q24(2), JP_Q24(2)),
                    .turn_rate = fuzz_range(input, -JP_Q24(2), JP_Q24(2))},
            .grade = fuzz_range(input, -JP_Q24(0.5), JP_Q24(0.5)),
            .travel = fuzz_range(input, 0, JP_Q16(6)),
            .duration = fuzz_range(input, 1, JP_Q16(60)),
        };

        FUZZ_CHANGE(input, piece);
        (void)jp_four_wheel_energy_add(&wheels.model, &drive, &piece);
    }
    return drive;
}

static void learn_skid(struct fuzz_input *input)
{
    struct jp_forecast_sum sum = {.energy = 0};
    struct jp_forecast forecast;
    jp_q16 factor[JP_SKID_FACTORS], deviation[JP_SKID_FACTORS];
    enum jp_learned learned = JP_LEARNED;
    const struct jp_skid_drive drive = draw_skid_drive(input);
    const char *field = NULL;

    (void)jp_skid_learner_update(&skid, &drive, draw_energy(input), &learned);
    jp_skid_learner_factors(&skid, factor);
    jp_skid_learner_deviations(&skid, deviation);
    check_factors(factor, deviation, JP_SKID_FACTORS);
    fuzz_require(jp_skid_energy_check(&skid.model, &field) == JP_OK, "a model that cannot be planned with");
    for (unsigned left = 1U + fuzz_below(input, 4); left > 0U; left--) {
        (void)jp_skid_forecast_add(&skid, &sum, &drive);
    }
    check_forecast(jp_skid_forecast_total(&skid, &sum, &forecast), &forecast);
}

static void learn_wheels(struct fuzz_input *input)
{
    struct jp_forecast_sum sum = {.energy = 0};
    struct jp_forecast forecast;
    jp_q16 factor[JP_FOUR_WHEEL_FACTORS], deviation[JP_FOUR_WHEEL_FACTORS];
    enum jp_learned learned = JP_LEARNED;
    const struct jp_four_wheel_drive drive = draw_wheel_drive(input);
    const char *field = NULL;

    (void)jp_four_wheel_learner_update(&wheels, &drive, draw_energy(input), &learned);
    jp_four_wheel_learner_factors(&wheels, factor);
    jp_four_wheel_learner_deviations(&wheels, deviation);
    check_factors(factor, deviation, JP_FOUR_WHEEL_FACTORS);
    fuzz_require(jp_four_wheel_energy_check(&wheels.model, &field) == JP_OK, "a model that cannot be planned with");
    for (unsigned left = 1U + fuzz_below(input, 4); left > 0U; left--) {
        (void)jp_four_wheel_forecast_add(&wheels, &sum, &drive);
    }
    check_forecast(jp_four_wheel_forecast_total(&wheels, &sum, &forecast), &forecast);
}

static void restore(struct fuzz_input *input)
{
    struct jp_learned_state state = fuzz_bool(input) ? skid.state : wheels.state;
    const char *field = NULL;

    FUZZ_CHANGE(input, state);
    (void)fuzz_accepted(jp_skid_learner_restore(&skid, &state, &field), field);
    (void)fuzz_accepted(jp_four_wheel_learner_restore(&wheels, &state, &field), field);
}

static bool start(struct fuzz_input *input)
{
    const char *field = NULL;

    skid_learning = fuzz_bool(input) ? jp_skid_learning_zhang2018 : jp_skid_learning_burger;
    skid_model = fuzz_bool(input) ? jp_skid_energy_zhang2018 : jp_skid_energy_burger;
    wheel_learning = jp_four_wheel_learning_patrol;
    wheel_model = jp_four_wheel_energy_patrol;
    FUZZ_CHANGE(input, skid_learning);
    FUZZ_CHANGE(input, skid_model);
    FUZZ_CHANGE(input, wheel_learning);
    FUZZ_CHANGE(input, wheel_model);
    if (!fuzz_accepted(jp_skid_learning_check(&skid_learning, &field), field) ||
        !fuzz_accepted(jp_skid_energy_check(&skid_model, &field), field) ||
        !fuzz_accepted(jp_factor_learning_check(&wheel_learning, &field), field) ||
        !fuzz_accepted(jp_four_wheel_energy_check(&wheel_model, &field), field)) {
        return false;
    }
    jp_skid_learner_start(&skid, &skid_learning, &skid_model);
    jp_four_wheel_learner_start(&wheels, &wheel_learning, &wheel_model);
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    if (!start(&input)) {
        return 0;
    }
    for (unsigned left = 60; left > 0U && fuzz_more(&input); left--) {
        switch (fuzz_below(&input, 8)) {
        case 0:
            restore(&input);
            break;
        case 1:
        case 2:
        case 3:
            learn_skid(&input);
            break;
        default:
            learn_wheels(&input);
            break;
        }
    }
    return 0;
}
