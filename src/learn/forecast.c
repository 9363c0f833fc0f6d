#include <joulepath/learner.h>

#include <stddef.h>

#include "src/learn/forecast_sum.h"
#include "src/learn/learner_expectation.h"
#include "src/learn/learner_filter.h"
#include "src/learn/normal_quantile.h"

enum jp_status jp_forecast_add(const struct jp_learner *learner, struct jp_forecast_sum *sum,
                               struct jp_energy_start *start, const struct jp_segment_command *segment)
{
    struct jp_expectation expected;
    struct jp_energy_start end;
    jp_q16 energy;

    if (learner == NULL || sum == NULL) {
        return JP_ERR_ARGUMENT;
    }

    enum jp_status status = jp_learner_expect(learner, start, segment, &expected);

    if (status == JP_OK) {
        status = jp_energy_forecast(learner->built_in, learner->horizon, start, segment, &energy, &end);
    }
    if (status != JP_OK) {
        return status;
    }
    *start = end;
    jp_forecast_sum_add(sum, &expected);
    return JP_OK;
}

enum jp_status jp_forecast_add_leg(const struct jp_learner *learner, struct jp_forecast_sum *sum,
                                   const struct jp_leg_energy *leg)
{
    struct jp_expectation expected;

    if (learner == NULL || sum == NULL || leg == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_learner_expect_leg(learner, leg, &expected);

    if (status == JP_OK) {
        jp_forecast_sum_add(sum, &expected);
    }
    return status;
}

enum jp_status jp_forecast_total(const struct jp_learner *learner, const struct jp_forecast_sum *sum,
                                 struct jp_forecast *forecast)
{
    if (learner == NULL || sum == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }

    return jp_forecast_sum_total(&learner->state, sum, forecast);
}

enum jp_status jp_forecast_reserve(const struct jp_forecast *forecast, jp_q16 available, jp_q31 confidence,
                                   jp_q16 *spare)
{
    if (forecast == NULL || spare == NULL || confidence < JP_PROBABILITY_MIN || confidence > JP_PROBABILITY_MAX) {
        return JP_ERR_ARGUMENT;
    }

    const int64_t margin = ((int64_t)jp_normal_quantile(confidence) * forecast->deviation + (JP_Q16_ONE - 1)) >> 16;

    *spare = jp_saturate32((int64_t)available - forecast->energy - margin);
    return JP_OK;
}

/** How many of its deviations what is spare of a way is. */
static jp_q16 deviations_spare(const struct jp_forecast *left, const struct jp_forecast *way)
{
    const int64_t spare = (int64_t)left->energy - way->energy;
    const uint32_t deviation = jp_square_root(jp_square(left->deviation) + jp_square(way->deviation));

    if (deviation == 0U) {
        return spare < 0 ? INT32_MIN : INT32_MAX;
    }
    return jp_saturate32(spare * JP_Q16_ONE / (int64_t)deviation);
}

enum jp_status jp_forecast_suffices(const struct jp_forecast *left, const struct jp_forecast *way, jp_q31 *probability)
{
    if (left == NULL || way == NULL || probability == NULL || left->deviation < 0 || way->deviation < 0) {
        return JP_ERR_ARGUMENT;
    }
    *probability = jp_normal_probability(deviations_spare(left, way));
    return JP_OK;
}
