#include <joulepath/skid_learner.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/learn/factor_state.h"
#include "src/learn/forecast_sum.h"
#include "src/learn/learner_filter.h"

_Static_assert(JP_LEARNING_DIRECTIONS == (int)JP_SKID_FACTORS, "each factor is a direction");

enum jp_status jp_skid_learning_check(const struct jp_skid_learning *learning, const char **field)
{
    static const struct jp_config_field fields[] = {
        JP_CONFIG_FIELD("learning.", struct jp_skid_learning, noise_slopes, 0, JP_Q16_ONE),
    };
    const enum jp_status status = jp_config_check(learning, fields, JP_CONFIG_COUNT(fields), field);

    return status == JP_OK ? jp_factor_learning_check(&learning->factors, field) : status;
}

static void set_model(struct jp_skid_learner *learner)
{
    jp_q16 factor[JP_SKID_FACTORS];

    jp_factors(&learner->learning->factors, &learner->state, factor);
    jp_skid_energy_scale(learner->built_in, factor, &learner->model);
}

void jp_skid_learner_start(struct jp_skid_learner *learner, const struct jp_skid_learning *learning,
                           const struct jp_skid_energy_model *built_in)
{
    *learner = (struct jp_skid_learner){.learning = learning, .built_in = built_in};
    jp_learned_state_start(&learner->state, learning->factors.identity);
    set_model(learner);
}

enum jp_status jp_skid_learner_restore(struct jp_skid_learner *learner, const struct jp_learned_state *state,
                                       const char **field)
{
    if (learner == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status =
        jp_learned_state_restore(&learner->state, state, learner->learning->factors.identity, field);

    if (status == JP_OK) {
        set_model(learner);
    }
    return status;
}

void jp_skid_learner_factors(const struct jp_skid_learner *learner, jp_q16 factor[JP_SKID_FACTORS])
{
    jp_factors(&learner->learning->factors, &learner->state, factor);
}

void jp_skid_learner_deviations(const struct jp_skid_learner *learner, jp_q16 deviation[JP_SKID_FACTORS])
{
    jp_factor_deviations(&learner->learning->factors, &learner->state, deviation);
}

/* False: a number exceeds its format. */
static bool expect(const struct jp_skid_learner *learner, const struct jp_skid_drive *drive,
                   struct jp_expectation *expected)
{
    const struct jp_skid_learning *learning = learner->learning;
    const jp_q16 slope_work = jp_saturate32(drive->slope_work);
    const uint64_t of_slopes = jp_variance_of(learning->noise_slopes, slope_work);

    return slope_work == drive->slope_work &&
           jp_factor_expect(&learning->factors, &learner->state, drive->energy, drive->change, of_slopes, expected);
}

enum jp_status jp_skid_learner_update(struct jp_skid_learner *learner, const struct jp_skid_drive *drive,
                                      jp_q16 measured, enum jp_learned *learned)
{
    struct jp_expectation expected;

    if (learner == NULL || drive == NULL || learned == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!expect(learner, drive, &expected)) {
        return JP_ERR_OVERFLOW;
    }
    *learned = jp_factor_update(&learner->learning->factors, &learner->state, &learner->watch, &expected, measured);
    if (*learned == JP_LEARNED_OUTLIER) {
        learner->outliers = jp_one_more32(learner->outliers);
    }
    if (*learned == JP_LEARNED_CHANGE) {
        learner->changes = jp_one_more32(learner->changes);
    }
    set_model(learner);
    return JP_OK;
}

enum jp_status jp_skid_forecast_add(const struct jp_skid_learner *learner, struct jp_forecast_sum *sum,
                                    const struct jp_skid_drive *drive)
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

enum jp_status jp_skid_forecast_total(const struct jp_skid_learner *learner, const struct jp_forecast_sum *sum,
                                      struct jp_forecast *forecast)
{
    if (learner == NULL || sum == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    return jp_forecast_sum_total(&learner->state, sum, forecast);
}
