#include <joulepath/skid_control.h>

#include <stdbool.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"

#define AMPERES_MAX JP_Q16(2047)
#define VOLTAGE_MAX JP_Q16(1000)
#define PRODUCT_MAX JP_Q24(1.5)

#define FIELD(member, low, high) JP_CONFIG_FIELD("control.", struct jp_skid_control_config, member, low, high)

/** Above 0, at most a turn. */
static bool is_step(jp_phase angle)
{
    return (uint32_t)((angle - 1U) >> 56) == 0U;
}

enum jp_status jp_skid_control_check(const struct jp_skid_control_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(tracking_gain, 1, JP_Q16_ONE),
        FIELD(tracking_rate_gain, 1, INT32_MAX),
        FIELD(turns_per_metre, JP_Q24(0.03), JP_Q24(32)),
        FIELD(turns_per_radian, JP_Q24(0.001), JP_Q24(4)),
        FIELD(back_emf, 1, JP_Q16(256) - 1),
        FIELD(resistance, JP_Q16(0.001), JP_Q16(100)),
        FIELD(current_limit, 1, INT32_MAX),
        FIELD(rolling, 0, AMPERES_MAX),
        FIELD(creep, 1, INT32_MAX),
        FIELD(climbing, 0, AMPERES_MAX),
        FIELD(acceleration, 0, AMPERES_MAX),
        FIELD(turn_acceleration, 0, AMPERES_MAX),
        FIELD(turning, 0, AMPERES_MAX),
        FIELD(turning_decrease, 0, JP_Q24(8)),
        FIELD(turning_creep, JP_Q24(0.0001), JP_Q24(1)),
        FIELD(braking, 0, JP_Q24_ONE),
        FIELD(proportional, 0, JP_Q16(2047)),
        FIELD(integral, 1, INT32_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status != JP_OK) {
        return status;
    }
    if (!is_step(config->wheel_per_count)) {
        return jp_config_refuse("control.wheel_per_count", field);
    }
    if ((uint32_t)config->tracking_rate_gain > config->tick_rate * (uint32_t)JP_Q16_ONE) {
        return jp_config_refuse("control.tracking_rate_gain", field);
    }
    if ((int64_t)config->resistance * config->current_limit > (int64_t)VOLTAGE_MAX * JP_Q16_ONE) {
        return jp_config_refuse("control.current_limit", field);
    }
    return JP_OK;
}

static jp_q24 limited_steering(jp_q24 steering)
{
    return jp_clamp32(steering, JP_SKID_STEERING_MIN, JP_SKID_STEERING_MAX);
}

void jp_skid_control_start(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                           jp_q24 steering)
{
    const jp_q24 unsteering = jp_q24_divide(JP_Q24_ONE, limited_steering(steering));
    const jp_q16 current_voltage = jp_q16_multiply(config->resistance, config->current_limit);

    *control = (struct jp_skid_control){
        .spread = jp_q24_multiply(config->turns_per_radian, unsteering),
        .unsteering = unsteering,
        .phase_per_rate = jp_phase_per_rate(config->tick_rate),
        .current_voltage = current_voltage,
        .rolling_slope = jp_q24_divide(config->rolling, config->creep),
        .behind_limit = jp_q24_divide(current_voltage, config->integral),
    };
}

void jp_skid_control_count_from(struct jp_skid_control *control, uint32_t encoder_left, uint32_t encoder_right)
{
    control->sides[JP_SKID_LEFT] = (struct jp_skid_side){.encoder = encoder_left};
    control->sides[JP_SKID_RIGHT] = (struct jp_skid_side){.encoder = encoder_right};
}

void jp_skid_control_forget(struct jp_skid_control *control)
{
    for (unsigned i = 0; i < (unsigned)JP_SKID_SIDES; i++) {
        control->sides[i].behind = 0;
        control->sides[i].reference = 0;
    }
}

/* Rates. */

/** Follows the counts with angle and rate (an alpha-beta filter). */
static JP_INLINE_FOR_SPEED void measure(struct jp_skid_side *side, const struct jp_skid_control_config *config,
                                        int32_t phase_per_rate, uint32_t encoder)
{
    const int64_t counts = (int32_t)(encoder - side->encoder);
    const jp_phase rolled = (jp_phase)counts * config->wheel_per_count;
    const int64_t error = (int64_t)(side->untracked + rolled - jp_phase_step(side->rate, phase_per_rate));

    side->encoder = encoder;
    side->rolled = rolled;
    side->untracked = (jp_phase)error - (jp_phase)(error >> 16) * (uint32_t)config->tracking_gain;
    side->rate = jp_add(side->rate, jp_q16_multiply(jp_round_shift(error, 32), config->tracking_rate_gain));
}

void jp_skid_control_measure(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                             uint32_t encoder_left, uint32_t encoder_right)
{
    measure(&control->sides[JP_SKID_LEFT], config, control->phase_per_rate, encoder_left);
    measure(&control->sides[JP_SKID_RIGHT], config, control->phase_per_rate, encoder_right);
}

void jp_skid_control_steer(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                           jp_q24 steering)
{
    const jp_q24 product = jp_q24_multiply(limited_steering(steering), control->unsteering);

    /* Limited, a step at most halves the inverse, and so it never changes its sign. */
    control->unsteering = jp_q24_multiply(control->unsteering, 2 * JP_Q24_ONE - jp_clamp32(product, 0, PRODUCT_MAX));
    control->spread = jp_q24_multiply(config->turns_per_radian, control->unsteering);
}

/* Loads. */

/** What the ground takes against the turn, A of the right side. */
static jp_q16 turning_load(const struct jp_skid_control_config *config, const struct jp_skid_set_point *set_point)
{
    if (config->turning == 0) {
        return 0;
    }
    const uint32_t turn = jp_magnitude32(set_point->turn_rate);
    const uint32_t driving =
        (uint32_t)jp_q24_multiply((int32_t)jp_magnitude32(set_point->speed), config->turning_decrease);
    const uint32_t slip = turn + driving + (uint32_t)config->turning_creep;
    const uint32_t share = (turn << 4) / (slip >> 8); /* Q12 */
    const jp_q16 load = jp_multiply_shift(config->turning, (int32_t)share, 12);

    return set_point->turn_rate < 0 ? -load : load;
}

/** What a side should do. The wheel is expected to go along: its rate is off by what it does not, and lags behind no
 *  acceleration. */
static JP_INLINE_FOR_SPEED void follow_side(struct jp_skid_side *side, const struct jp_skid_control_config *config,
                                            jp_q16 rolling_slope, jp_turns_per_s reference, jp_q16 pushing)
{
    const jp_q16 rolling =
        jp_clamp32(jp_multiply_shift(reference, rolling_slope, 24), -config->rolling, config->rolling);
    const jp_q16 load = jp_add(pushing, rolling);
    const bool drives = (load > 0 && reference > 0) || (load < 0 && reference < 0);

    side->rate = jp_add(side->rate, jp_sub(reference, side->reference));
    side->reference = reference;
    side->load = drives ? load : jp_share(load, config->braking, 24);
}

/** References and loads of both sides. */
static void follow(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                   const struct jp_skid_set_point *set_point)
{
    const jp_turns_per_s ahead = jp_q24_multiply(set_point->speed, config->turns_per_metre);
    const jp_turns_per_s across = jp_q24_multiply(set_point->turn_rate, control->spread);
    const jp_q16 common = jp_add(jp_multiply_shift(config->acceleration, set_point->acceleration, 24),
                                 jp_multiply_shift(config->climbing, set_point->rise, 24));
    const jp_q16 difference = jp_add(jp_multiply_shift(config->turn_acceleration, set_point->turn_acceleration, 24),
                                     turning_load(config, set_point));

    follow_side(&control->sides[JP_SKID_LEFT], config, control->rolling_slope, jp_sub(ahead, across),
                jp_sub(common, difference));
    follow_side(&control->sides[JP_SKID_RIGHT], config, control->rolling_slope, jp_add(ahead, across),
                jp_add(common, difference));
}

/* Voltages. */

/** As far behind as the integral may be. */
static JP_INLINE_FOR_SPEED jp_phase limited_behind(jp_phase behind, jp_q24 limit)
{
    const jp_q24 turns = jp_phase_difference(behind, 0);

    return jp_is_beyond(turns, limit) ? (jp_phase)(int64_t)jp_clamp32(turns, -limit, limit) << 32 : behind;
}

/** V of one side; true: a limit changed it. */
static JP_INLINE_FOR_SPEED bool set_voltage(struct jp_skid_side *side, const struct jp_skid_control *control,
                                            const struct jp_skid_control_config *config, jp_q16 limit, jp_q16 *voltage)
{
    const jp_phase gained = jp_phase_step(side->reference, control->phase_per_rate) - side->rolled;
    const jp_phase behind = limited_behind(side->behind + gained, control->behind_limit);
    const int64_t sum = jp_multiply(config->back_emf, side->reference) +
                        jp_multiply(config->proportional, jp_sub(side->reference, side->rate)) +
                        jp_multiply(config->integral, jp_phase_difference(behind, 0)) +
                        jp_multiply(config->resistance * 256, side->load); /* Q40 */
    const jp_q16 wanted = jp_saturate32((sum + JP_Q24_ONE / 2) >> 24);
    const jp_q16 back_emf = jp_multiply_shift(config->back_emf, side->rate, 24);
    const jp_q16 low = jp_sub(back_emf, control->current_voltage);
    const jp_q16 high = jp_add(back_emf, control->current_voltage);
    const jp_q16 given = jp_clamp32(jp_clamp32(wanted, low, high), -limit, limit);
    const bool is_limited = wanted != given;
    const bool winds_up = is_limited && ((int64_t)gained < 0) == (wanted < given);

    if (!winds_up) {
        side->behind = behind;
    }
    *voltage = given;
    return is_limited;
}

void jp_skid_control_update(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                            const struct jp_skid_set_point *set_point, jp_q16 limit, struct jp_voltages *voltages)
{
    follow(control, config, set_point);

    const bool left_limited = set_voltage(&control->sides[JP_SKID_LEFT], control, config, limit, &voltages->left);
    const bool right_limited = set_voltage(&control->sides[JP_SKID_RIGHT], control, config, limit, &voltages->right);

    voltages->saturated = left_limited || right_limited;
}

static JP_INLINE_FOR_SPEED jp_q16 expected_voltage(const struct jp_skid_side *side,
                                                   const struct jp_skid_control_config *config, jp_q16 limit)
{
    const jp_q16 voltage = jp_add(jp_multiply_shift(config->back_emf, side->reference, 24),
                                  jp_q16_multiply(config->resistance, side->load));

    return jp_clamp32(voltage, -limit, limit);
}

void jp_skid_control_blindly(struct jp_skid_control *control, const struct jp_skid_control_config *config,
                             const struct jp_skid_set_point *set_point, jp_q16 limit, struct jp_voltages *voltages)
{
    follow(control, config, set_point);
    voltages->left = expected_voltage(&control->sides[JP_SKID_LEFT], config, limit);
    voltages->right = expected_voltage(&control->sides[JP_SKID_RIGHT], config, limit);
    voltages->saturated = false;
}
