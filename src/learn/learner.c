#include <joulepath/learner.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/config_check.h"
#include "src/learn/learner_expectation.h"
#include "src/learn/learner_filter.h"

#define N JP_LEARNING_DIRECTIONS

#define PARAMETER_MAX JP_Q16(4096)

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

/* ---- Start ---- */

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

    return jp_learned_state_restore(&learner->state, state, learner->learning->identity, field);
}

/* ---- Update ---- */

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
    const jp_q16 change = cause_value(&learner->state, share) - cause_value(&learner->watch.before_change, share);
    const uint64_t variance =
        cause_variance(learner, share, deviation) + jp_filter_variance(learner->watch.before_change.s, share);

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

static void follow_cause(struct jp_learner *learner)
{
    if (learner->changes > 0U && learner->since_change < CAUSE_LAST) {
        learner->since_change++;
        if (learner->since_change % CAUSE_EVERY == 0U) {
            learner->cause = likeliest_cause(learner);
        }
    }
}

static enum jp_learned learn_from(struct jp_learner *learner, const struct jp_expectation *expected, jp_q16 measured)
{
    const enum jp_learned learned =
        jp_learned_state_update(&learner->state, &learner->watch, learner->learning->memory, expected, measured);

    if (learned == JP_LEARNED_NOTHING) {
        return learned;
    }
    if (learned == JP_LEARNED_OUTLIER) {
        learner->outliers = jp_one_more32(learner->outliers);
    }
    if (learned == JP_LEARNED_CHANGE) {
        learner->changes = jp_one_more32(learner->changes);
        learner->cause = JP_CAUSE_NONE;
        learner->since_change = 0;
    }
    follow_cause(learner);
    return learned;
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
