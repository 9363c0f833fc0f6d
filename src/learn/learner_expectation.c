#include "src/learn/learner_expectation.h"

#include "src/base/integer.h"
#include "src/learn/learner_filter.h"

/** Q32 to Q16, rounded; false: it does not fit. */
static bool narrow(int64_t sum, jp_q16 *value)
{
    const int64_t rounded = jp_round_shift64(sum, 16);

    *value = jp_saturate32(rounded);
    return *value == rounded;
}

static bool sensitivities(const struct jp_learning *learning, const jp_q16 regressor[JP_ENERGY_PARAMETERS],
                          jp_q16 sensitivity[JP_LEARNING_DIRECTIONS])
{
    bool fits = true;

    for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        int64_t sum = 0;

        for (int i = 0; i < JP_ENERGY_PARAMETERS; i++) {
            sum += (int64_t)learning->direction[i][j] * regressor[i];
        }
        fits = narrow(sum, &sensitivity[j]) && fits;
    }
    return fits;
}

static bool expected_energy(const struct jp_learner *learner, const jp_q16 regressor[JP_ENERGY_PARAMETERS], jp_q16 rest,
                            struct jp_expectation *expected)
{
    const struct jp_energy_model *model = learner->built_in;
    int64_t sum = (int64_t)rest * JP_Q16_ONE;

    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        sum += (int64_t)model->a[i] * regressor[i];
    }
    for (int i = JP_ENERGY_TERMS; i < JP_ENERGY_PARAMETERS; i++) {
        sum += (int64_t)model->b[i - JP_ENERGY_TERMS] * regressor[i];
    }
    for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        sum += ((int64_t)expected->sensitivity[j] * learner->state.x[j]) >> 8;
    }
    return narrow(sum, &expected->energy);
}

/** `rest`: what no parameter changes; `transient`: the part of it that earlier steps left. */
static enum jp_status expect(const struct jp_learner *learner, const jp_q16 regressor[JP_ENERGY_PARAMETERS],
                             jp_q16 rest, jp_q16 transient, struct jp_expectation *expected)
{
    if (!sensitivities(learner->learning, regressor, expected->sensitivity) ||
        !expected_energy(learner, regressor, rest, expected)) {
        return JP_ERR_OVERFLOW;
    }

    const struct jp_learning *learning = learner->learning;

    expected->noise = jp_learned_noise(&learner->state, jp_variance_of(learning->noise, JP_Q16_ONE) +
                                                            jp_variance_of(learning->noise_relative, expected->energy) +
                                                            jp_variance_of(learning->noise_transient, transient));
    expected->spread = JP_Q16_ONE;
    return JP_OK;
}

enum jp_status jp_learner_expect(const struct jp_learner *learner, const struct jp_energy_start *start,
                                 const struct jp_segment_command *segment, struct jp_expectation *expected)
{
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 rest;
    const enum jp_status status =
        jp_energy_regressors(learner->built_in, learner->horizon, start, segment, regressor, &rest);

    if (status != JP_OK) {
        return status;
    }

    const jp_q16 electronics = jp_q16_multiply(learner->built_in->electronics_power, segment->duration);

    return expect(learner, regressor, rest, jp_sub(rest, electronics), expected);
}

/** J per unit of x, Q32. */
static int64_t leg_sensitivity(const struct jp_learning *learning, const struct jp_leg_energy *leg, int j)
{
    int64_t sum = (int64_t)learning->direction[JP_ENERGY_TERMS][j] * leg->travel +
                  (int64_t)learning->direction[JP_ENERGY_TERMS + 1][j] * leg->turning;

    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        sum += (int64_t)learning->leg[i][j] * leg->transient[i];
    }
    return sum;
}

/** What its transients take, J, all counted as spent. */
static jp_q16 transients_of(const struct jp_leg_energy *leg)
{
    jp_q16 sum = 0;

    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        sum = jp_add(sum, leg->transient[i] < 0 ? jp_sub(0, leg->transient[i]) : leg->transient[i]);
    }
    return sum;
}

enum jp_status jp_learner_expect_leg(const struct jp_learner *learner, const struct jp_leg_energy *leg,
                                     struct jp_expectation *expected)
{
    const struct jp_learning *learning = learner->learning;
    int64_t sum = (int64_t)leg->energy * JP_Q16_ONE;
    bool fits = true;

    for (int j = 0; j < JP_LEARNING_DIRECTIONS; j++) {
        fits = narrow(leg_sensitivity(learning, leg, j), &expected->sensitivity[j]) && fits;
        sum += ((int64_t)expected->sensitivity[j] * learner->state.x[j]) >> 8;
    }
    if (!narrow(sum, &expected->energy) || !fits) {
        return JP_ERR_OVERFLOW;
    }
    expected->noise =
        jp_learned_noise(&learner->state, jp_variance_of(learning->leg_noise, JP_Q16_ONE) +
                                              jp_variance_of(learning->leg_noise_relative, expected->energy) +
                                              jp_variance_of(learning->leg_noise_transient, transients_of(leg)));
    expected->spread = learning->leg_spread;
    return JP_OK;
}
