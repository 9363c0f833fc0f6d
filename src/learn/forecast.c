#include <joulepath/learner.h>

#include <stddef.h>

#include "src/learn/learner_expectation.h"
#include "src/learn/learner_filter.h"
#include "src/learn/normal_quantile.h"

/** Limits of the sum's gradient and variance, so that neither overflows. */
#define GRADIENT_MAX ((int64_t)JP_Q16(8192))
#define VARIANCE_MAX ((uint64_t)1 << 46)

static void add(struct jp_forecast_sum *sum, const struct jp_expectation *expected)
{
    sum->energy += expected->energy;
    for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        sum->gradient[j] += expected->sensitivity[j];
    }
    sum->variance += jp_square(expected->noise) >> 16;
}

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
    add(sum, &expected);
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
        add(sum, &expected);
    }
    return status;
}

/** Standard deviation of the sum, J. False, and INT32_MAX: it does not fit. */
static bool deviation_of(const struct jp_learner *learner, const struct jp_forecast_sum *sum, jp_q16 *deviation)
{
    int32_t gradient[JP_LEARNING_DIRECTIONS];

    *deviation = INT32_MAX;
    for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        if (sum->gradient[j] < -GRADIENT_MAX || sum->gradient[j] > GRADIENT_MAX) {
            return false;
        }
        gradient[j] = (int32_t)sum->gradient[j];
    }
    if (sum->variance > VARIANCE_MAX) {
        return false;
    }

    const uint32_t root = jp_square_root((sum->variance << 16) + jp_filter_variance(learner->state.s, gradient));

    if (root > (uint32_t)INT32_MAX) {
        return false;
    }
    *deviation = (jp_q16)root;
    return true;
}

enum jp_status jp_forecast_total(const struct jp_learner *learner, const struct jp_forecast_sum *sum,
                                 struct jp_forecast *forecast)
{
    if (learner == NULL || sum == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const bool is_known = deviation_of(learner, sum, &forecast->deviation);

    forecast->energy = jp_saturate32(sum->energy);
    return is_known && forecast->energy == sum->energy ? JP_OK : JP_ERR_OVERFLOW;
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
