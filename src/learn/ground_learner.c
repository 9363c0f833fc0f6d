#include <joulepath/ground_learner.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/compiler.h"
#include "src/learn/factor_state.h"
#include "src/learn/learner_filter.h"

#define N JP_LEARNING_DIRECTIONS

_Static_assert((int)JP_GROUND_FACTORS <= N, "each factor is a direction");

/** The least number of classes that are learned. */
#define FIRST 1U

/** Limit of a forecast's changes, so that their variance has its format. */
#define CHANGE_MAX ((int64_t)JP_Q16(8192))

const struct jp_factor_learning jp_ground_learning = {
    .deviation = {JP_Q16(1), JP_Q16(0.5), 1, 1}, /* the last two are of no factor */
    .noise_relative = JP_Q16(0.03125),
    .noise = JP_Q16(0.0625),
    .spread = JP_Q16_ONE,
    .memory = 256,
    .identity = 1,
};

void jp_ground_learner_start(struct jp_ground_learner *learner, const struct jp_factor_learning *learning)
{
    *learner = (struct jp_ground_learner){.learning = learning};
    for (unsigned k = 0; k < JP_GROUND_CLASSES; k++) {
        jp_learned_state_start(&learner->states[k], learning->identity);
    }
}

enum jp_status jp_ground_learner_restore(struct jp_ground_learner *learner, uint8_t ground,
                                         const struct jp_learned_state *state, const char **field)
{
    if (learner == NULL || ground < FIRST || ground >= JP_GROUND_CLASSES) {
        return JP_ERR_ARGUMENT;
    }
    return jp_learned_state_restore(&learner->states[ground], state, learner->learning->identity, field);
}

/* ---- Factors ---- */

static bool is_learned(uint8_t ground)
{
    return ground >= FIRST && ground < JP_GROUND_CLASSES;
}

void jp_ground_learner_factors(const struct jp_ground_learner *learner, uint8_t ground,
                               jp_q16 factor[JP_GROUND_FACTORS])
{
    jp_q16 factors[N];

    jp_factors(learner->learning, &learner->states[is_learned(ground) ? ground : 0U], factors);
    for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
        factor[j] = factors[j];
    }
}

void jp_ground_learner_deviations(const struct jp_ground_learner *learner, uint8_t ground,
                                  jp_q16 deviation[JP_GROUND_FACTORS])
{
    jp_q16 deviations[N];

    jp_factor_deviations(learner->learning, &learner->states[is_learned(ground) ? ground : 0U], deviations);
    for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
        deviation[j] = is_learned(ground) ? deviations[j] : 0;
    }
}

/* ---- Forecast ---- */

void jp_ground_change_add(struct jp_ground_change *sum, const struct jp_ground_change *change)
{
    for (unsigned k = FIRST; k < JP_GROUND_CLASSES; k++) {
        for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
            sum->by_factor[k][j] += change->by_factor[k][j];
        }
    }
}

/** J per unit of x. */
static int32_t sensitivity(int64_t change, jp_q16 deviation, jp_q16 factor)
{
    return jp_divide(change * deviation, factor);
}

/** Variance of a leg's energy by what is not known of a class, Q32. */
static uint64_t variance_by(const struct jp_ground_learner *learner, unsigned ground,
                            const struct jp_ground_change *change)
{
    const struct jp_learned_state *state = &learner->states[ground];
    int32_t gradient[N] = {0};
    jp_q16 factor[N];

    jp_factors(learner->learning, state, factor);
    for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
        gradient[j] = jp_clamp32(sensitivity(change->by_factor[ground][j], learner->learning->deviation[j], factor[j]),
                                 -(int32_t)CHANGE_MAX, (int32_t)CHANGE_MAX);
    }
    return jp_filter_variance(state->s, gradient);
}

/** Of all classes that are learned. */
static JP_INLINE_FOR_SPEED uint64_t variance_of(const struct jp_ground_learner *learner,
                                                const struct jp_ground_change *change)
{
    uint64_t sum = 0;

    for (unsigned k = FIRST; k < JP_GROUND_CLASSES; k++) {
        sum += variance_by(learner, k, change);
    }
    return sum;
}

static JP_INLINE_FOR_SPEED bool is_within(const struct jp_ground_change *change, int64_t most)
{
    for (unsigned k = FIRST; k < JP_GROUND_CLASSES; k++) {
        for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
            if (change->by_factor[k][j] < -most || change->by_factor[k][j] > most) {
                return false;
            }
        }
    }
    return true;
}

enum jp_status jp_ground_learner_widen(const struct jp_ground_learner *learner, const struct jp_ground_change *change,
                                       struct jp_forecast *forecast)
{
    if (learner == NULL || change == NULL || forecast == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!is_within(change, CHANGE_MAX)) {
        forecast->deviation = INT32_MAX;
        return JP_ERR_OVERFLOW;
    }
    const uint32_t root = jp_square_root(jp_square(forecast->deviation) + variance_of(learner, change));

    forecast->deviation = jp_saturate32((int64_t)root);
    return root <= (uint32_t)INT32_MAX ? JP_OK : JP_ERR_OVERFLOW;
}

/* ---- Update ---- */

static bool crosses(const struct jp_ground_change *change, unsigned ground)
{
    return change->by_factor[ground][JP_GROUND_ROLLING] != 0 || change->by_factor[ground][JP_GROUND_FRICTION] != 0;
}

/** With the noise of what is not known besides the class. */
static void expect(const struct jp_ground_learner *learner, const struct jp_forecast *expected,
                   const struct jp_ground_change *change, unsigned ground, struct jp_expectation *leg)
{
    int64_t by_factor[N] = {0};
    const uint64_t others = variance_of(learner, change) - variance_by(learner, ground, change);

    for (int j = 0; j < (int)JP_GROUND_FACTORS; j++) {
        by_factor[j] = change->by_factor[ground][j];
    }
    (void)jp_factor_expect(learner->learning, &learner->states[ground], expected->energy, by_factor,
                           jp_square(expected->deviation) + others, leg);
}

static void count(struct jp_ground_learner *learner, enum jp_learned learned)
{
    if (learned == JP_LEARNED_OUTLIER) {
        learner->outliers = jp_one_more32(learner->outliers);
    }
    if (learned == JP_LEARNED_CHANGE) {
        learner->changes = jp_one_more32(learner->changes);
    }
}

/** By how much one counts before another one. */
static int rank(enum jp_learned learned)
{
    static const int8_t ranks[4] = {
        [JP_LEARNED] = 1, [JP_LEARNED_NOTHING] = 0, [JP_LEARNED_OUTLIER] = 2, [JP_LEARNED_CHANGE] = 3};

    return ranks[learned];
}

enum jp_status jp_ground_learner_update(struct jp_ground_learner *learner, const struct jp_forecast *expected,
                                        const struct jp_ground_change *change, jp_q16 measured,
                                        enum jp_learned *learned)
{
    if (learner == NULL || expected == NULL || change == NULL || learned == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (!is_within(change, INT32_MAX)) {
        return JP_ERR_OVERFLOW;
    }
    struct jp_expectation legs[JP_GROUND_CLASSES];
    enum jp_learned most = JP_LEARNED_NOTHING;

    /* Before any of them has learned. */
    for (unsigned k = FIRST; k < JP_GROUND_CLASSES; k++) {
        expect(learner, expected, change, k, &legs[k]);
    }
    for (unsigned k = FIRST; k < JP_GROUND_CLASSES; k++) {
        if (crosses(change, k)) {
            const enum jp_learned here =
                jp_factor_update(learner->learning, &learner->states[k], &learner->watches[k], &legs[k], measured);
            count(learner, here);
            most = rank(here) > rank(most) ? here : most;
        }
    }
    *learned = most;
    return JP_OK;
}
