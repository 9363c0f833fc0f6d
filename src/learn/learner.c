#include <joulepath/learner.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/learn/learner_expectation.h"
#include "src/learn/learner_filter.h"

#define N JP_LEARNING_DIRECTIONS

#define PARAMETER_MAX JP_Q16(4096)

/** Least |h|² of a segment to learn from, Q40: 64 such segments give as much information as the prior. */
#define INFORMATION_MIN ((uint64_t)1 << (2U * JP_FILTER_BITS - 6U))

/** Page's test on squared innovations, whose mean is 1 while the model holds: one outlier or two in a row are not a
 *  change, three are. Q20. */
#define ALARM_DRIFT (2 * JP_FILTER_ONE)
#define ALARM_MAX   (28 * JP_FILTER_ONE + JP_FILTER_ONE / 2)
#define GATE        (JP_OUTLIER_DEVIATIONS * JP_FILTER_ONE)

/** The scale of the noise follows over twice so many segments. */
#define NOISE_MEMORY_BITS 6U
#define NOISE_SCALE_MIN   JP_Q16(0.25)
#define NOISE_SCALE_MAX   JP_Q16(8)

/** After a change its cause is judged every CAUSE_EVERY segments up to CAUSE_LAST; a cause must have moved by
 *  CAUSE_MOVE_MIN standard deviations. */
#define CAUSE_EVERY    10U
#define CAUSE_LAST     40U
#define CAUSE_MOVE_MIN JP_Q16(2)

/* ---- Checks ---- */

#define FIELD(member, low, high) JP_CONFIG_FIELD("learning.", struct jp_learning, member, low, high)

enum jp_status jp_learning_check(const struct jp_learning *learning, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(direction, -PARAMETER_MAX, PARAMETER_MAX), FIELD(ground, -JP_Q16(16), JP_Q16(16)),
        FIELD(payload, -JP_Q16(256), JP_Q16(256)),       FIELD(ground_deviation, 1, JP_Q16(16)),
        FIELD(payload_deviation, 1, JP_Q16(256)),        FIELD(noise_relative, 0, JP_Q16_ONE),
        FIELD(noise_transient, 0, JP_Q16(16)),           FIELD(noise, 1, JP_Q16(1024)),
        FIELD(leg, -JP_Q16(256), JP_Q16(256)),           FIELD(leg_noise_relative, 0, JP_Q16_ONE),
        FIELD(leg_noise_transient, 0, JP_Q16(16)),       FIELD(leg_noise, 1, JP_Q16(1024)),
        FIELD(leg_spread, JP_Q16_ONE, JP_Q16(16)),       FIELD(memory, 8, 1024),
    };
    const enum jp_status status = jp_config_check(learning, fields, JP_CONFIG_COUNT(fields), field);

    return status == JP_OK && learning->identity == 0U ? jp_config_refuse("learning.identity", field) : status;
}

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

/* ---- Start ---- */

void jp_learned_state_start(struct jp_learned_state *state, uint32_t identity)
{
    *state = (struct jp_learned_state){.noise_scale = JP_Q16_ONE, .identity = identity};
    jp_filter_start(state->s);
}

void jp_learner_start(struct jp_learner *learner, const struct jp_learning *learning,
                      const struct jp_energy_model *built_in, const struct jp_horizon *horizon)
{
    *learner = (struct jp_learner){.learning = learning, .built_in = built_in, .horizon = horizon};
    jp_learned_state_start(&learner->state, learning->identity);
}

enum jp_status jp_learner_restore(struct jp_learner *learner, const struct jp_learned_state *state, const char **field)
{
    if (learner == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_learned_state_check(state, field);

    if (status != JP_OK) {
        return status;
    }
    if (state->identity != learner->learning->identity) {
        return jp_config_refuse("state.identity", field);
    }
    learner->state = *state;
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
static bool update_alarm(struct jp_learner *learner, int32_t square)
{
    const int32_t alarm = learner->alarm + square - ALARM_DRIFT;

    learner->alarm = alarm < 0 ? 0 : alarm;
    return alarm > ALARM_MAX;
}

/** Adapts the scale of the noise. The part of the error that the uncertainty of x explains is not noise. */
static void follow_noise(struct jp_learned_state *state, const struct jp_filter_step *step, int32_t square)
{
    const int64_t excess = (int64_t)state->noise_scale * (square - JP_FILTER_ONE) >> JP_FILTER_BITS;
    const int64_t change = excess * jp_filter_noise_share(step) >> (30U + NOISE_MEMORY_BITS + 1U);

    state->noise_scale = jp_clamp32(state->noise_scale + (int32_t)change, NOISE_SCALE_MIN, NOISE_SCALE_MAX);
}

/** The value of a cause that x implies. */
static jp_q16 cause_value(const struct jp_learned_state *state, const jp_q16 share[N])
{
    int64_t sum = 0;

    for (int j = 0; j < N; j++) {
        sum += (int64_t)share[j] * state->x[j];
    }
    return (jp_q16)(sum >> 24);
}

/** Variance of the value of a cause, Q32. */
static uint64_t cause_variance(const struct jp_learner *learner, const jp_q16 share[N], jp_q16 deviation)
{
    return jp_square(deviation) + jp_filter_variance(learner->state.s, share);
}

/** How far a cause moved since before the change, in standard deviations. */
static jp_q16 moved(const struct jp_learner *learner, const jp_q16 share[N], jp_q16 deviation)
{
    const jp_q16 change = cause_value(&learner->state, share) - cause_value(&learner->before_change, share);
    const uint64_t variance =
        cause_variance(learner, share, deviation) + jp_filter_variance(learner->before_change.s, share);

    return jp_divide((int64_t)(change < 0 ? -change : change) * JP_Q16_ONE, (int32_t)jp_square_root(variance));
}

static enum jp_cause likeliest_cause(const struct jp_learner *learner)
{
    const struct jp_learning *learning = learner->learning;
    const jp_q16 ground = moved(learner, learning->ground, learning->ground_deviation);
    const jp_q16 payload = moved(learner, learning->payload, learning->payload_deviation);

    if (ground < CAUSE_MOVE_MIN && payload < CAUSE_MOVE_MIN) {
        return JP_CAUSE_OTHER;
    }
    return ground < payload ? JP_CAUSE_PAYLOAD : JP_CAUSE_GROUND;
}

static void begin_anew(struct jp_learner *learner)
{
    learner->before_change = learner->state;
    learner->changes = jp_one_more32(learner->changes);
    learner->cause = JP_CAUSE_NONE;
    learner->since_change = 0;
    learner->alarm = 0;
    learner->state.noise_scale = learner->state.noise_scale < JP_Q16_ONE ? JP_Q16_ONE : learner->state.noise_scale;
    jp_filter_start(learner->state.s);
}

static void take(struct jp_learner *learner, const struct jp_filter_step *step, int32_t innovation)
{
    jp_filter_take(learner->state.s, learner->state.x, step,
                   jp_clamp32(innovation, -JP_INNOVATION_MAX, JP_INNOVATION_MAX));
    learner->state.version = jp_one_more32(learner->state.version);
    if (learner->changes > 0U && learner->since_change < CAUSE_LAST) {
        learner->since_change++;
        if (learner->since_change % CAUSE_EVERY == 0U) {
            learner->cause = likeliest_cause(learner);
        }
    }
}

static enum jp_learned learn(struct jp_learner *learner, const struct measurement *measurement)
{
    struct jp_learned_state state;
    struct jp_filter_step step;

    state = learner->state;
    jp_filter_forget(state.s, learner->learning->memory);
    jp_filter_expect(state.s, measurement->h, &step);

    const int32_t innovation = innovation_of(measurement, &step);
    const int32_t counted = gated(innovation, measurement->spread);
    const int32_t square = square_of(counted, measurement->spread);

    if (update_alarm(learner, square)) {
        begin_anew(learner);
        jp_filter_expect(learner->state.s, measurement->h, &step);
        take(learner, &step, innovation_of(measurement, &step));
        return JP_LEARNED_CHANGE;
    }
    learner->state = state;
    follow_noise(&learner->state, &step, square);
    take(learner, &step, counted);
    if (counted == innovation) {
        return JP_LEARNED;
    }
    learner->outliers = jp_one_more32(learner->outliers);
    return JP_LEARNED_OUTLIER;
}

static enum jp_learned learn_from(struct jp_learner *learner, const struct jp_expectation *expected, jp_q16 measured)
{
    struct measurement measurement;

    return normalise(expected, measured, &measurement) ? learn(learner, &measurement) : JP_LEARNED_NOTHING;
}

enum jp_status jp_learner_update(struct jp_learner *learner, const struct jp_energy_start *start,
                                 const struct jp_segment_command *segment, jp_q16 measured, enum jp_learned *learned)
{
    struct jp_expectation expected;

    if (learner == NULL || learned == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_learner_expect(learner, start, segment, &expected);

    if (status == JP_OK) {
        *learned = learn_from(learner, &expected, measured);
    }
    return status;
}

enum jp_status jp_learner_update_leg(struct jp_learner *learner, const struct jp_leg_energy *leg, jp_q16 measured,
                                     enum jp_learned *learned)
{
    struct jp_expectation expected;

    if (learner == NULL || leg == NULL || learned == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_learner_expect_leg(learner, leg, &expected);

    if (status == JP_OK) {
        *learned = learn_from(learner, &expected, measured);
    }
    return status;
}

/* ---- What was learned ---- */

/** A learned parameter, limited to its range. */
static jp_q16 learned_parameter(const struct jp_learner *learner, int i, jp_q16 built_in, jp_q16 low)
{
    int64_t sum = (int64_t)built_in * JP_Q24_ONE + JP_Q24_ONE / 2;

    for (int j = 0; j < N; j++) {
        sum += (int64_t)learner->learning->direction[i][j] * learner->state.x[j];
    }
    return jp_clamp32(jp_saturate32(sum >> 24), low, PARAMETER_MAX);
}

void jp_learner_model(const struct jp_learner *learner, struct jp_energy_model *model)
{
    const struct jp_energy_model *built_in = learner->built_in;

    *model = *built_in;
    for (int i = 0; i < JP_ENERGY_TERMS; i++) {
        model->a[i] = learned_parameter(learner, i, built_in->a[i], -PARAMETER_MAX);
    }
    for (int i = 0; i < JP_ENERGY_PARAMETERS - JP_ENERGY_TERMS; i++) {
        model->b[i] = learned_parameter(learner, JP_ENERGY_TERMS + i, built_in->b[i], 0);
    }
}

void jp_learner_causes(const struct jp_learner *learner, jp_q16 *ground, jp_q16 *payload)
{
    const jp_q16 factor = JP_Q16_ONE + cause_value(&learner->state, learner->learning->ground);

    *ground = factor < 0 ? 0 : factor;
    *payload = cause_value(&learner->state, learner->learning->payload);
}

void jp_learner_cause_deviations(const struct jp_learner *learner, jp_q16 *ground, jp_q16 *payload)
{
    const struct jp_learning *learning = learner->learning;

    *ground = (jp_q16)jp_square_root(cause_variance(learner, learning->ground, learning->ground_deviation));
    *payload = (jp_q16)jp_square_root(cause_variance(learner, learning->payload, learning->payload_deviation));
}
