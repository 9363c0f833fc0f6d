#include <joulepath/skid_learner.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/learn/forecast_sum.h"
#include "src/learn/learned_state.h"
#include "src/learn/learner_filter.h"

#define N JP_LEARNING_DIRECTIONS

_Static_assert(N == (int)JP_SKID_FACTORS, "each factor is a direction");

#define FIELD(member, low, high) JP_CONFIG_FIELD("skid_learning.", struct jp_skid_learning, member, low, high)

enum jp_status jp_skid_learning_check(const struct jp_skid_learning *learning, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(deviation, 1, JP_Q16_ONE),    FIELD(noise, 1, JP_Q16(1024)),         FIELD(noise_relative, 0, JP_Q16_ONE),
        FIELD(noise_slopes, 0, JP_Q16_ONE), FIELD(spread, JP_Q16_ONE, JP_Q16(16)), FIELD(memory, 8, 1024),
    };
    const enum jp_status status = jp_config_check(learning, fields, JP_CONFIG_COUNT(fields), field);

    return status == JP_OK && learning->identity == 0U ? jp_config_refuse("skid_learning.identity", field) : status;
}

/* ---- Factors ---- */

void jp_skid_learner_factors(const struct jp_skid_learner *learner, jp_q16 factor[N])
{
    for (int j = 0; j < N; j++) {
        const jp_q16 change = jp_multiply_shift(learner->learning->deviation[j], learner->state.x[j], 24);

        factor[j] = jp_clamp32(jp_add(JP_Q16_ONE, change), JP_SKID_FACTOR_MIN, JP_SKID_FACTOR_MAX);
    }
}

void jp_skid_learner_deviations(const struct jp_skid_learner *learner, jp_q16 deviation[N])
{
    for (int j = 0; j < N; j++) {
        int32_t direction[N] = {0};

        direction[j] = learner->learning->deviation[j];
        deviation[j] = (jp_q16)jp_square_root(jp_filter_variance(learner->state.s, direction));
    }
}

static void set_model(struct jp_skid_learner *learner)
{
    jp_q16 factor[N];

    jp_skid_learner_factors(learner, factor);
    jp_skid_energy_scale(learner->built_in, factor, &learner->model);
}

/* ---- Start ---- */

void jp_skid_learner_start(struct jp_skid_learner *learner, const struct jp_skid_learning *learning,
                           const struct jp_skid_energy_model *built_in)
{
    *learner = (struct jp_skid_learner){.learning = learning, .built_in = built_in};
    jp_learned_state_start(&learner->state, learning->identity);
    set_model(learner);
}

enum jp_status jp_skid_learner_restore(struct jp_skid_learner *learner, const struct jp_learned_state *state,
                                       const char **field)
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

/* ---- Update ---- */

static bool narrow(int64_t value, jp_q16 *narrowed)
{
    *narrowed = jp_saturate32(value);
    return *narrowed == value;
}

/* False: a number exceeds its format. */
static bool expect(const struct jp_skid_learner *learner, const struct jp_skid_drive *drive,
                   struct jp_expectation *expected)
{
    const struct jp_skid_learning *learning = learner->learning;
    jp_q16 factor[N];
    jp_q16 slope_work = 0;
    bool fits = narrow(drive->energy, &expected->energy) && narrow(drive->slope_work, &slope_work);

    jp_skid_learner_factors(learner, factor);
    for (int j = 0; j < N; j++) {
        jp_q16 change = 0;

        fits = narrow(drive->change[j], &change) && fits;
        expected->sensitivity[j] = jp_divide((int64_t)change * learning->deviation[j], factor[j]);
    }
    expected->noise = jp_learned_noise(&learner->state, jp_variance_of(learning->noise, JP_Q16_ONE) +
                                                            jp_variance_of(learning->noise_relative, expected->energy) +
                                                            jp_variance_of(learning->noise_slopes, slope_work));
    expected->spread = learning->spread;
    return fits;
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
    *learned =
        jp_learned_state_update(&learner->state, &learner->watch, learner->learning->memory, &expected, measured);
    if (*learned == JP_LEARNED_OUTLIER) {
        learner->outliers = jp_one_more32(learner->outliers);
    }
    if (*learned == JP_LEARNED_CHANGE) {
        learner->changes = jp_one_more32(learner->changes);
    }
    set_model(learner);
    return JP_OK;
}

/* ---- Forecast ---- */

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
