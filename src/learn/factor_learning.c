#include "src/learn/factor_state.h"

#include "src/base/config_check.h"
#include "src/learn/learner_filter.h"

#define N JP_LEARNING_DIRECTIONS

#define FIELD(member, low, high) JP_CONFIG_FIELD("learning.", struct jp_factor_learning, member, low, high)

enum jp_status jp_factor_learning_check(const struct jp_factor_learning *learning, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(deviation, 1, JP_Q16_ONE), FIELD(noise_relative, 0, JP_Q16_ONE),
        FIELD(noise, 1, JP_Q16(1024)),   FIELD(spread, JP_Q16_ONE, JP_Q16(16)),
        FIELD(memory, 8, 1024),
    };
    const enum jp_status status = jp_config_check(learning, fields, JP_CONFIG_COUNT(fields), field);

    return status == JP_OK && learning->identity == 0U ? jp_config_refuse("learning.identity", field) : status;
}

void jp_factors(const struct jp_factor_learning *learning, const struct jp_learned_state *state, jp_q16 factor[N])
{
    for (int j = 0; j < N; j++) {
        const jp_q16 change = jp_multiply_shift(learning->deviation[j], state->x[j], 24);

        factor[j] = jp_clamp32(jp_add(JP_Q16_ONE, change), JP_FACTOR_MIN, JP_FACTOR_MAX);
    }
}

/** Of a factor, in its deviations. */
static jp_q24 away_from_one(jp_q16 factor, jp_q16 deviation)
{
    return jp_divide((int64_t)(factor - JP_Q16_ONE) * JP_Q24_ONE, deviation);
}

enum jp_learned jp_factor_update(const struct jp_factor_learning *learning, struct jp_learned_state *state,
                                 struct jp_learned_watch *watch, const struct jp_expectation *expected, jp_q16 measured)
{
    const enum jp_learned learned = jp_learned_state_update(state, watch, learning->memory, expected, measured);

    for (int j = 0; j < N; j++) {
        state->x[j] = jp_clamp32(state->x[j], away_from_one(JP_FACTOR_MIN, learning->deviation[j]),
                                 away_from_one(JP_FACTOR_MAX, learning->deviation[j]));
    }
    return learned;
}

void jp_factor_deviations(const struct jp_factor_learning *learning, const struct jp_learned_state *state,
                          jp_q16 deviation[N])
{
    for (int j = 0; j < N; j++) {
        int32_t direction[N] = {0};

        direction[j] = learning->deviation[j];
        deviation[j] = (jp_q16)jp_square_root(jp_filter_variance(state->s, direction));
    }
}

static bool narrow(int64_t value, jp_q16 *narrowed)
{
    *narrowed = jp_saturate32(value);
    return *narrowed == value;
}

bool jp_factor_expect(const struct jp_factor_learning *learning, const struct jp_learned_state *state, int64_t energy,
                      const int64_t change[N], uint64_t variance, struct jp_expectation *expected)
{
    jp_q16 factor[N];
    bool fits = narrow(energy, &expected->energy);

    jp_factors(learning, state, factor);
    for (int j = 0; j < N; j++) {
        jp_q16 by_factor = 0;

        fits = narrow(change[j], &by_factor) && fits;
        expected->sensitivity[j] = jp_divide((int64_t)by_factor * learning->deviation[j], factor[j]);
    }
    expected->noise = jp_learned_noise(state, variance + jp_variance_of(learning->noise, JP_Q16_ONE) +
                                                  jp_variance_of(learning->noise_relative, expected->energy));
    expected->spread = learning->spread;
    return fits;
}
