#include "src/learn/learned_state.h"

#include <joulepath/count.h>

#include "src/base/config_check.h"
#include "src/learn/learner_filter.h"

#define N JP_LEARNING_DIRECTIONS

/** Least |h|² of a segment to learn from, Q40: 64 such segments give as much information as the prior. */
#define INFORMATION_MIN ((uint64_t)1 << (2U * JP_FILTER_BITS - 6U))

/** Page's test on squared innovations, whose mean is 1 while the model holds: one outlier or two in a row are not a
 *  change, three are. Q20. */
#define ALARM_DRIFT (2 * JP_FILTER_ONE)
#define ALARM_MAX   (28 * JP_FILTER_ONE + JP_FILTER_ONE / 2)
#define GATE        (JP_OUTLIER_DEVIATIONS * JP_FILTER_ONE)

/** The scale of the noise follows over twice so many segments. */
#define NOISE_MEMORY_BITS 6U
/** Of noise that raises the alarm: the root of what three squares in a row have to be in the mean. */
#define NOISE_STEP_MIN  JP_Q16(3.39)
#define NOISE_SCALE_MIN JP_Q16(0.25)
#define NOISE_SCALE_MAX JP_Q16(256)

/** P <= I but for rounding, and no history that `memory` allows makes a row shorter than 2⁻¹⁷. */
static bool is_row(const int32_t row[N])
{
    uint64_t length = 0; /* squared, Q56 */

    for (int j = 0; j < N; j++) {
        length += jp_square(row[j]) >> 4;
    }
    return length >= (uint64_t)1 << 22 && length <= ((uint64_t)1 << 56) + ((uint64_t)1 << 47);
}

#define STATE_FIELD(member, low, high) JP_CONFIG_FIELD("state.", struct jp_learned_state, member, low, high)

enum jp_status jp_learned_state_check(const struct jp_learned_state *state, const char **field)
{
    static const struct jp_config_field fields[] = {
        STATE_FIELD(x, -JP_LEARNED_MAX, JP_LEARNED_MAX),
        STATE_FIELD(noise_scale, NOISE_SCALE_MIN, NOISE_SCALE_MAX),
    };
    const enum jp_status status = jp_config_check(state, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    for (int i = 0; i < N; i++) {
        if (!is_row(state->s[i])) {
            return jp_config_refuse("state.s", field);
        }
    }
    return JP_OK;
}

void jp_learned_state_start(struct jp_learned_state *state, uint32_t identity)
{
    *state = (struct jp_learned_state){.noise_scale = JP_Q16_ONE, .identity = identity};
    jp_filter_start(state->s);
}

enum jp_status jp_learned_state_restore(struct jp_learned_state *state, const struct jp_learned_state *stored,
                                        uint32_t identity, const char **field)
{
    const enum jp_status status = jp_learned_state_check(stored, field);

    if (status != JP_OK) {
        return status;
    }
    if (stored->identity != identity) {
        return jp_config_refuse("state.identity", field);
    }
    *state = *stored;
    return JP_OK;
}

/* ---- Update ---- */

/** A measurement in standard deviations of its noise. */
struct measurement {
    int32_t h[N];  /* per unit of x, Q20 */
    jp_q16 noise;  /* J */
    jp_q16 spread; /* by which single ones exceed it */
    int64_t error; /* measured − expected, J in Q16 */
};

/** Least standard deviation of the noise for which h fits its format. */
static jp_q16 least_noise(const struct jp_expectation *expected)
{
    int32_t least = expected->noise;

    for (int j = 0; j < N; j++) {
        const int32_t f = expected->sensitivity[j];
        const int32_t needed = (f < 0 ? -(f / JP_SENSITIVITY_MAX) : f / JP_SENSITIVITY_MAX) + 1;

        least = least < needed ? needed : least;
    }
    return least;
}

/** Divides by the noise. False: the segment gives too little information. */
static bool normalise(const struct jp_expectation *expected, jp_q16 measured, struct measurement *measurement)
{
    uint64_t information = 0;

    measurement->noise = least_noise(expected);
    measurement->spread = expected->spread;
    measurement->error = (int64_t)measured - expected->energy;
    for (int j = 0; j < N; j++) {
        measurement->h[j] = jp_divide((int64_t)expected->sensitivity[j] * JP_FILTER_ONE, measurement->noise);
        information += jp_square(measurement->h[j]);
    }
    return information >= INFORMATION_MIN;
}

/** The error in standard deviations of what was expected, Q20, saturated. */
static int32_t innovation_of(const struct measurement *measurement, const struct jp_filter_step *step)
{
    const uint64_t deviation = ((uint64_t)(uint32_t)measurement->noise * step->deviation) >> JP_FILTER_BITS;
    const int32_t divisor = deviation > (uint64_t)INT32_MAX ? INT32_MAX : (int32_t)deviation;

    return jp_divide(measurement->error * JP_FILTER_ONE, divisor);
}

/** The innovation as far as it counts. */
static int32_t gated(int32_t innovation, jp_q16 spread)
{
    const int32_t gate = jp_multiply_shift(GATE, spread, 16);

    return jp_clamp32(innovation, -gate, gate);
}

/** Of a gated innovation, in units of its spread, Q20. */
static int32_t square_of(int32_t innovation, jp_q16 spread)
{
    const int64_t usual = jp_divide((int64_t)innovation * JP_Q16_ONE, spread);

    return (int32_t)((usual * usual) >> JP_FILTER_BITS);
}

/** Sums up what is too large for chance. True: too much of it in a row, so something has changed. */
static bool update_alarm(int32_t *alarm, int32_t square)
{
    const int32_t sum = *alarm + square - ALARM_DRIFT;

    *alarm = sum < 0 ? 0 : sum;
    return sum > ALARM_MAX;
}

/** Adapts the scale of the noise. The part of the error that the uncertainty of x explains is not noise. */
static void follow_noise(struct jp_learned_state *state, const struct jp_filter_step *step, int32_t square)
{
    const int64_t excess = (int64_t)state->noise_scale * (square - JP_FILTER_ONE) >> JP_FILTER_BITS;
    const int64_t change = excess * jp_filter_noise_share(step) >> (30U + NOISE_MEMORY_BITS + 1U);

    state->noise_scale = jp_clamp32(state->noise_scale + (int32_t)change, NOISE_SCALE_MIN, NOISE_SCALE_MAX);
}

/** So many segments after a start or a change the next change is less likely than noise beyond what is believed. */
#define SETTLED (2U * (unsigned)N)

static bool is_settled(const struct jp_learned_state *state, const struct jp_learned_watch *watch)
{
    return state->version - watch->before_change.version >= SETTLED;
}

/** What was learned with so little noise is forgotten. */
static void believe_in_more_noise(struct jp_learned_state *state)
{
    const jp_q16 more = jp_q16_multiply(state->noise_scale, NOISE_STEP_MIN);

    state->noise_scale = jp_clamp32(more, NOISE_SCALE_MIN, NOISE_SCALE_MAX);
    jp_filter_start(state->s);
}

static void begin_anew(struct jp_learned_state *state)
{
    state->noise_scale = state->noise_scale < JP_Q16_ONE ? JP_Q16_ONE : state->noise_scale;
    jp_filter_start(state->s);
}

static void take(struct jp_learned_state *state, const struct jp_filter_step *step, int32_t innovation)
{
    jp_filter_take(state->s, state->x, step, jp_clamp32(innovation, -JP_INNOVATION_MAX, JP_INNOVATION_MAX));
    state->version = jp_one_more32(state->version);
}

enum jp_learned jp_learned_state_update(struct jp_learned_state *state, struct jp_learned_watch *watch, uint32_t memory,
                                        const struct jp_expectation *expected, jp_q16 measured)
{
    struct measurement measurement;
    struct jp_learned_state next;
    struct jp_filter_step step;

    if (!normalise(expected, measured, &measurement)) {
        return JP_LEARNED_NOTHING;
    }
    next = *state;
    jp_filter_forget(next.s, memory);
    jp_filter_expect(next.s, measurement.h, &step);

    const int32_t innovation = innovation_of(&measurement, &step);
    const int32_t counted = gated(innovation, measurement.spread);
    const int32_t square = square_of(counted, measurement.spread);

    if (update_alarm(&watch->alarm, square)) {
        watch->alarm = 0;
        if (!is_settled(state, watch)) {
            believe_in_more_noise(state);
            return JP_LEARNED_OUTLIER;
        }
        watch->before_change = *state;
        begin_anew(state);
        jp_filter_expect(state->s, measurement.h, &step);
        take(state, &step, innovation_of(&measurement, &step));
        return JP_LEARNED_CHANGE;
    }
    *state = next;
    follow_noise(state, &step, square);
    take(state, &step, counted);
    return counted == innovation ? JP_LEARNED : JP_LEARNED_OUTLIER;
}

jp_q16 jp_learned_noise(const struct jp_learned_state *state, uint64_t variance)
{
    const uint64_t noise = ((uint64_t)jp_square_root(variance) * (uint32_t)state->noise_scale) >> 16;

    if (noise == 0U) {
        return 1;
    }
    return noise > (uint64_t)INT32_MAX ? INT32_MAX : (jp_q16)noise;
}
