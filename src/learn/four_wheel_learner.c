#include <joulepath/four_wheel_learner.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/learn/factor_state.h"
#include "src/learn/forecast_sum.h"

_Static_assert(JP_LEARNING_DIRECTIONS == (int)JP_FOUR_WHEEL_FACTORS, "each factor is a direction");

static void set_model(struct jp_four_wheel_learner *learner)
{
    jp_q16 factor[JP_FOUR_WHEEL_FACTORS];

    jp_factors(learner->learning, &learner->state, factor);
    jp_four_wheel_energy_scale(learner->built_in, factor, &learner->model);
}

void jp_four_wheel_learner_start(struct jp_four_wheel_learner *learner, const struct jp_factor_learning *learning,
                                 const struct jp_four_wheel_energy_model *built_in)
{
    *learner = (struct jp_four_wheel_learner){.learning = learning, .built_in = built_in};
    jp_learned_state_start(&learner->state, learning->identity);
    set_model(learner);
}

enum jp_status jp_four_wheel_learner_restore(struct jp_four_wheel_learner *learner,
                                             const struct jp_learned_state *state, const char **field)
{
    if (learner == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_learned_state_restore(&learner->state, state, learner->learning->identity, field);

    if (status == JP_OK) {
        set_model(learner);
    }
    return status;
}

void jp_four_wheel_learner_factors(const struct jp_four_wheel_learner *learner, jp_q16 factor[JP_FOUR_WHEEL_FACTORS])
{
    jp_factors(learner->learning, &learner->state, factor);
}

void jp_four_wheel_learner_deviations(const struct jp_four_wheel_learner *learner,
                                      jp_q16 deviation[JP_FOUR_WHEEL_FACTORS])
{
    jp_factor_deviations(learner->learning, &learner->state, deviation);
}

static bool expect(const struct jp_four_wheel_learner *learner, const struct jp_four_wheel_drive *drive,
                   struct jp_expectation *expected)
{
    return jp_factor_expect(learner->learning, &learner->state, drive->energy, drive->change, 0, expected);
}

enum jp_status jp_four_wheel_learner_update(struct jp_four_wheel_learner *learner,
                                            const struct jp_four_wheel_drive *drive, jp_q16 measured,
                                            enum jp_learned *learned)
{
    struct jp_expectation expected;

    if (learner == NULL || drive == NULL || learned == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!expect(learner, drive, &expected)) {
        return JP_ERR_OVERFLOW;
    }
    *learned = jp_factor_update(learner->learning, &learner->state, &learner->watch, &expected, measured);
    if (*learned == JP_LEARNED_OUTLIER) {
        learner->outliers = jp_one_more32(learner->outliers);
    }
    if (*learned == JP_LEARNED_CHANGE) {
        learner->changes = jp_one_more32(learner->changes);
    }
    set_model(learner);
    return JP_OK;
}

enum jp_status jp_four_wheel_forecast_add(const struct jp_four_wheel_learner *learner, struct jp_forecast_sum *sum,
                                          const struct jp_four_wheel_drive *drive)
{
    struct jp_expectation expected;

    if (learner == NULL || sum == NULL || drive == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!expect(learner, drive, &expected)) {
        return JP_ERR_OVERFLOW;
    }
    jp_forecast_sum_add(sum, &expected);
    return JP_OK;
}

enum jp_status jp_four_wheel_forecast_total(const struct jp_four_wheel_learner *learner,
                                            const struct jp_forecast_sum *sum, struct jp_forecast *forecast)
{
    if (learner == NULL || sum == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    return jp_forecast_sum_total(&learner->state, sum, forecast);
}
