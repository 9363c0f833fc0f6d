#include <joulepath/horizon.h>

#include <stddef.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/base/power_of_half.h"
#include "src/energy/energy_terms.h"

#define FREQUENCY_MAX    JP_Q24(64)
#define STEP_MAX         JP_Q16(512)
#define SHARE_MAX        JP_Q16(4096)
#define TRANSIENT_MAX    JP_Q16(4096)
#define PASSED_MAX       JP_Q16(4096)
#define DURATION_MIN_MAX JP_Q16(60)
#define REST_MAX         JP_Q16(1000)
#define TRANSIENTS_MAX   ((int64_t)1 << 61) /* Q28 J; far beyond what an energy may be, so that two more axes fit */

/** How an axis is driven in a segment, in m/s for travel, in rad/s and rad for yaw. */
struct axis_command {
    jp_q24 speed;   /**< v or w */
    jp_q24 step[2]; /**< Δv or Δw, and σ */
};

enum axis_field { FIELD_MODE, FIELD_PASSED, FIELD_STEP, FIELD_CROSS, FIELD_STEADY, FIELDS };

static bool all_within(const jp_q16 *values, uint32_t count, jp_q16 limit)
{
    for (uint32_t i = 0; i < count; i++) {
        if (values[i] < -limit || values[i] > limit) {
            return false;
        }
    }
    return true;
}

static bool is_paired(const struct jp_mode *mode)
{
    return mode->frequency != 0;
}

static bool is_mode(const struct jp_mode *mode)
{
    return mode->decay > 0 && mode->frequency >= 0 && mode->frequency <= FREQUENCY_MAX;
}

static bool match(const struct jp_mode *a, const struct jp_mode *b)
{
    return a->decay == b->decay && a->frequency == b->frequency;
}

static bool modes_are_valid(const struct jp_axis_modes *axis)
{
    bool second = false; /* of a pair */

    for (uint32_t i = 0; i < axis->count; i++) {
        const struct jp_mode *mode = &axis->mode[i];

        if (!is_mode(mode) || (second && !match(mode, &axis->mode[i - 1U]))) {
            return false;
        }
        second = is_paired(mode) && !second;
    }
    return !second;
}

/** A sum is of two real modes. */
static bool sums_are_valid(const struct jp_axis_modes *axis)
{
    for (uint32_t i = 0; i < axis->count; i++) {
        const bool may_pass = i + 1U < axis->count && !is_paired(&axis->mode[i]) && !is_paired(&axis->mode[i + 1U]);

        if (!jp_is_between(axis->passed[i], 0, may_pass ? PASSED_MAX : 0)) {
            return false;
        }
    }
    return true;
}

/** Of the modes in use; FIELDS: none. */
static enum axis_field first_bad_field(const struct jp_axis_modes *axis)
{
    if (!modes_are_valid(axis)) {
        return FIELD_MODE;
    }
    if (!sums_are_valid(axis)) {
        return FIELD_PASSED;
    }
    if (!all_within(axis->step[0], axis->count, STEP_MAX) || !all_within(axis->step[1], axis->count, STEP_MAX)) {
        return FIELD_STEP;
    }
    if (!all_within(axis->cross[0], axis->count, SHARE_MAX) || !all_within(axis->cross[1], axis->count, SHARE_MAX)) {
        return FIELD_CROSS;
    }
    if (!all_within(axis->steady, axis->count, SHARE_MAX)) {
        return FIELD_STEADY;
    }
    return FIELDS;
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("horizon.", struct jp_horizon, member, low, high)

enum jp_status jp_horizon_check(const struct jp_horizon *horizon, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(duration_min, 1, DURATION_MIN_MAX),
        FIELD(reversal_rest, 0, REST_MAX),
        FIELD(travel.count, 0, JP_AXIS_MODES),
        FIELD(yaw.count, 0, JP_AXIS_MODES),
    };
    static const char *const travel_names[FIELDS] = {"horizon.travel.mode", "horizon.travel.passed",
                                                     "horizon.travel.step", "horizon.travel.cross",
                                                     "horizon.travel.steady"};
    static const char *const yaw_names[FIELDS] = {"horizon.yaw.mode", "horizon.yaw.passed", "horizon.yaw.step",
                                                  "horizon.yaw.cross", "horizon.yaw.steady"};
    const enum jp_status status = jp_config_check(horizon, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }

    const enum axis_field travel = first_bad_field(&horizon->travel);
    const enum axis_field yaw = first_bad_field(&horizon->yaw);

    if (travel != FIELDS) {
        return jp_config_refuse(travel_names[travel], field);
    }
    return yaw == FIELDS ? JP_OK : jp_config_refuse(yaw_names[yaw], field);
}

/** Share of a mode that is left after a time, Q30. */
static int32_t decayed_share(const struct jp_mode *mode, jp_q16 duration)
{
    return jp_power_of_half((uint64_t)jp_multiply(mode->decay, duration) >> 8);
}

static jp_angle turned_by(const struct jp_mode *mode, jp_q16 duration)
{
    return (jp_angle)((uint64_t)jp_multiply(mode->frequency, duration) >> 8);
}

/** Turns the two modes of a pair. */
static void rotate(jp_q16 *modes, jp_angle angle)
{
    jp_q31 cosine = jp_cos(angle);
    jp_q31 sine = jp_sin(angle);
    int64_t first = jp_multiply(modes[0], cosine) - jp_multiply(modes[1], sine);
    int64_t second = jp_multiply(modes[0], sine) + jp_multiply(modes[1], cosine);

    modes[0] = jp_round_shift(first, 31);
    modes[1] = jp_round_shift(second, 31);
}

/** A mode in a segment, as its successor needs it. */
struct mode_before {
    jp_q16 start;  /**< at the segment's begin, at most 22 000 V */
    int32_t share; /**< that is left at its end, Q30 */
    jp_q16 sum;    /**< what it got of those before it */
    jp_q16 passed;
};

/** What a mode gets of those before it. */
static jp_q16 passed_on(const struct mode_before *before, int32_t share)
{
    int64_t decayed = jp_round_shift64(jp_multiply(before->start, before->share - share), 30);

    return jp_saturate32(jp_round_shift64((before->sum + decayed) * before->passed, 16));
}

/** Propagates `modes` from the begin of a segment to its end. */
static void advance(const struct jp_axis_modes *axis, const struct axis_command *command, jp_q16 duration,
                    const jp_q16 *modes, jp_q16 *left)
{
    struct mode_before before = {0, 0, 0, 0};

    for (uint32_t i = 0; i < axis->count; i++) {
        int64_t added =
            jp_multiply(axis->step[0][i], command->step[0]) + jp_multiply(axis->step[1][i], command->step[1]);
        jp_q16 start = modes[i] + jp_round_shift(added, 24);
        int32_t share = decayed_share(&axis->mode[i], duration);
        jp_q16 sum = before.passed == 0 ? 0 : passed_on(&before, share);

        left[i] = jp_saturate32((int64_t)jp_multiply_shift(start, share, 30) + sum);
        before = (struct mode_before){start, share, sum, axis->passed[i]};
    }
    bool second = false; /* of a pair */
    for (uint32_t i = 0; i < axis->count; i++) {
        bool first = is_paired(&axis->mode[i]) && !second;

        if (first) {
            rotate(&left[i], turned_by(&axis->mode[i], duration));
        }
        second = first;
    }
}

static bool limit_transient(const struct jp_axis_modes *axis, jp_q16 *modes)
{
    bool within = all_within(modes, axis->count, TRANSIENT_MAX);

    for (uint32_t i = 0; i < axis->count; i++) {
        modes[i] = jp_clamp32(modes[i], -TRANSIENT_MAX, TRANSIENT_MAX);
    }
    return within;
}

/** S(m, v) + Σ Δ gᵀ m in Q28 J, below 2³³ J. */
static int64_t stored_energy(const struct jp_axis_modes *axis, const struct axis_command *command, const jp_q16 *modes)
{
    const int32_t *storage = axis->storage;
    int64_t energy = 0;

    for (uint32_t i = 0; i < axis->count; i++) {
        int64_t linear = jp_multiply(axis->steady[i], command->speed) +
                         jp_multiply(axis->cross[0][i], command->step[0]) +
                         jp_multiply(axis->cross[1][i], command->step[1]); /* Q40 */
        int64_t square = 0;                                                /* Q44 */

        for (uint32_t k = i; k < axis->count; k++) {
            square += jp_multiply(*storage, modes[k]);
            storage++;
        }
        energy += jp_term_scale((linear >> 12) + (square >> 16), modes[i], 16);
    }
    return energy;
}

/** Adds the energy of an axis's transient in a segment. False: that, or its transient at the end, had to be limited. */
static bool drive_axis(const struct jp_axis_modes *axis, const struct axis_command *command, jp_q16 duration,
                       const jp_q16 *modes, jp_q16 *left, int64_t *energy)
{
    const struct axis_command steady = {.speed = command->speed};

    advance(axis, command, duration, modes, left);
    bool within = limit_transient(axis, left);
    int64_t total = *energy + stored_energy(axis, command, modes) - stored_energy(axis, &steady, left);

    if (total < -TRANSIENTS_MAX || total > TRANSIENTS_MAX) {
        total = total < 0 ? -TRANSIENTS_MAX : TRANSIENTS_MAX;
        within = false;
    }
    *energy = total;
    return within;
}

/** What a robot does between two directions: in a rest at speed 0, and after it. Alone where there is no rest. */
struct pieces {
    struct jp_segment_command piece[2];
    uint32_t count;
};

static JP_INLINE_FOR_SPEED void split(const struct jp_horizon *horizon, const struct jp_energy_start *start,
                                      const struct jp_segment_command *segment, struct pieces *pieces)
{
    const jp_q24 speed = segment->motion.speed;

    pieces->piece[0] = *segment;
    pieces->piece[1] = *segment;
    pieces->count = 1;
    if (!horizon || start->reversal_rest == 0 || speed == 0 || (speed > 0) == start->is_forward) {
        return;
    }
    pieces->piece[0].motion.speed = 0;
    if (segment->duration > start->reversal_rest) {
        pieces->piece[0].duration = start->reversal_rest;
        pieces->piece[1].turn = 0;
        pieces->piece[1].duration -= start->reversal_rest;
        pieces->count = 2;
    }
}

/** How long the direction may not change after a piece. */
static void count_rest(const struct jp_horizon *horizon, const struct jp_energy_start *start,
                       const struct jp_segment_command *piece, struct jp_energy_start *end)
{
    if (piece->motion.speed != 0) {
        end->is_forward = piece->motion.speed > 0;
        end->reversal_rest = horizon->reversal_rest;
    } else {
        end->is_forward = start->is_forward;
        end->reversal_rest = piece->duration < start->reversal_rest ? start->reversal_rest - piece->duration : 0;
    }
}

/** *end; adds in Q28 J what the transients spend beside the settled energy; false when *end had to be limited. */
static bool drive(const struct jp_horizon *horizon, const struct jp_energy_start *start,
                  const struct jp_segment_command *piece, struct jp_energy_start *end, int64_t *energy)
{
    *end = (struct jp_energy_start){.motion = piece->motion};
    if (!horizon) {
        return true;
    }
    count_rest(horizon, start, piece, end);

    jp_q24 speed = piece->motion.speed;
    jp_q24 turn_rate = piece->motion.turn_rate;
    const struct axis_command travel = {speed, {speed - start->motion.speed, 0}};
    const struct axis_command yaw = {turn_rate, {turn_rate - start->motion.turn_rate, piece->turn}};
    bool travel_within =
        drive_axis(&horizon->travel, &travel, piece->duration, start->transient.travel, end->transient.travel, energy);
    bool yaw_within =
        drive_axis(&horizon->yaw, &yaw, piece->duration, start->transient.yaw, end->transient.yaw, energy);
    return travel_within && yaw_within;
}

static bool arguments_are_valid(const struct jp_energy_model *model, const struct jp_horizon *horizon,
                                const struct jp_energy_start *start, const struct jp_segment_command *segment)
{
    if (!model || !start || !segment || !jp_motion_in_range(&start->motion)) {
        return false;
    }
    if (!horizon) {
        return jp_segment_in_range(segment, model->settling_time);
    }
    return jp_segment_in_range(segment, horizon->duration_min) && jp_is_between(start->reversal_rest, 0, REST_MAX) &&
           all_within(start->transient.travel, JP_AXIS_MODES, TRANSIENT_MAX) &&
           all_within(start->transient.yaw, JP_AXIS_MODES, TRANSIENT_MAX);
}

enum jp_status jp_energy_forecast(const struct jp_energy_model *model, const struct jp_horizon *horizon,
                                  const struct jp_energy_start *start, const struct jp_segment_command *segment,
                                  jp_q16 *energy, struct jp_energy_start *end)
{
    if (!energy || !end || !arguments_are_valid(model, horizon, start, segment)) {
        return JP_ERR_ARGUMENT;
    }
    struct pieces pieces;
    struct jp_energy_start at = *start;
    int64_t settled = 0;
    int64_t transient = 0;
    bool fits = true;

    split(horizon, start, segment, &pieces);
    for (uint32_t i = 0; i < pieces.count; i++) {
        const struct jp_segment_command *piece = &pieces.piece[i];
        struct jp_voltage_terms voltage;
        struct jp_energy_start next;
        jp_q16 of_piece;

        jp_voltage_terms(model, &at.motion, &voltage);
        fits = drive(horizon, &at, piece, &next, &transient) && fits;
        fits = jp_energy_total(model, &at.motion, &voltage, piece, &of_piece) == JP_OK && fits;
        settled += of_piece;
        at = next;
    }

    int64_t total = settled + jp_round_shift64(transient, JP_TERM_BITS - 16);
    *energy = jp_saturate32(total);
    *end = at;
    return fits && *energy == total ? JP_OK : JP_ERR_OVERFLOW;
}

/** a b with a in Q24 and b in Q24 or Q18, in Q16. */
static JP_INLINE_FOR_SPEED int64_t scaled_product(int32_t a, int32_t b, unsigned shift)
{
    return jp_round_shift64(jp_multiply(a, b), shift);
}

/** What multiplies each parameter in a piece. */
static void add_regressors(const struct jp_energy_model *model, const struct jp_motion *motion,
                           const struct jp_segment_command *piece, int64_t sum[JP_ENERGY_PARAMETERS])
{
    struct jp_steady_voltages before;
    jp_steady_voltages(model, motion, &before);
    int32_t v = piece->motion.speed;
    int32_t w = piece->motion.turn_rate;
    int32_t dv = v - motion->speed;
    int32_t dw = w - motion->turn_rate;
    int32_t turn = piece->turn;
    int32_t line = piece->duration - model->settling_time; /* where b counts, Q16 */
    const int64_t exact[JP_ENERGY_PARAMETERS] = {
        scaled_product(dv, dv, 32),
        scaled_product(dw, dw, 32),
        scaled_product(turn, turn, 32),
        scaled_product(dv, dw, 32),
        scaled_product(dv, turn, 32),
        scaled_product(dw, turn, 32),
        scaled_product(dv, before.left, 26),
        scaled_product(dw, before.left, 26),
        scaled_product(turn, before.left, 26),
        scaled_product(dv, before.right, 26),
        scaled_product(dw, before.right, 26),
        scaled_product(turn, before.right, 26),
        before.power,
        scaled_product((int32_t)scaled_product(v, v, 24), line, 24),
        scaled_product((int32_t)scaled_product(w, w, 24), line, 24),
    };

    for (int i = 0; i < JP_ENERGY_PARAMETERS; i++) {
        sum[i] += exact[i];
    }
}

enum jp_status jp_energy_regressors(const struct jp_energy_model *model, const struct jp_horizon *horizon,
                                    const struct jp_energy_start *start, const struct jp_segment_command *segment,
                                    jp_q16 regressor[JP_ENERGY_PARAMETERS], jp_q16 *rest)
{
    if (!regressor || !rest || !arguments_are_valid(model, horizon, start, segment)) {
        return JP_ERR_ARGUMENT;
    }
    struct pieces pieces;
    struct jp_energy_start at = *start;
    int64_t sum[JP_ENERGY_PARAMETERS] = {0};
    int64_t transient = 0;
    bool fits = true;

    split(horizon, start, segment, &pieces);
    for (uint32_t i = 0; i < pieces.count; i++) {
        struct jp_energy_start next;

        fits = drive(horizon, &at, &pieces.piece[i], &next, &transient) && fits;
        add_regressors(model, &at.motion, &pieces.piece[i], sum);
        at = next;
    }
    for (int i = 0; i < JP_ENERGY_PARAMETERS; i++) {
        regressor[i] = jp_saturate32(sum[i]);
        fits = fits && regressor[i] == sum[i];
    }

    int64_t electronics = jp_multiply(model->electronics_power, segment->duration); /* Q32 */
    int64_t total = jp_round_shift64(transient + (electronics >> (32 - JP_TERM_BITS)), JP_TERM_BITS - 16);
    *rest = jp_saturate32(total);
    return fits && *rest == total ? JP_OK : JP_ERR_OVERFLOW;
}
