#include "src/learn/forecast_sum.h"

#include "src/learn/learner_filter.h"

/** Limits of the sum's gradient and variance, so that neither overflows. */
#define GRADIENT_MAX ((int64_t)JP_Q16(8192))
#define VARIANCE_MAX ((uint64_t)1 << 46)

void jp_forecast_sum_add(struct jp_forecast_sum *sum, const struct jp_expectation *expected)
{
    sum->energy += expected->energy;
    for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        sum->gradient[j] += expected->sensitivity[j];
    }
    sum->variance += jp_square(expected->noise) >> 16;
}

/** Standard deviation of the sum, J. False, and INT32_MAX: it does not fit. */
static bool deviation_of(const struct jp_learned_state *state, const struct jp_forecast_sum *sum, jp_q16 *deviation)
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

    const uint32_t root = jp_square_root((sum->variance << 16) + jp_filter_variance(state->s, gradient));

    if (root > (uint32_t)INT32_MAX) {
        return false;
    }
    *deviation = (jp_q16)root;
    return true;
}

enum jp_status jp_forecast_sum_total(const struct jp_learned_state *state, const struct jp_forecast_sum *sum,
                                     struct jp_forecast *forecast)
{
    const bool is_known = deviation_of(state, sum, &forecast->deviation);

    forecast->energy = jp_saturate32(sum->energy);
    return is_known && forecast->energy == sum->energy ? JP_OK : JP_ERR_OVERFLOW;
}
