#include <joulepath/lqr.h>

#include <stdbool.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"

/** Errors are limited to [−64, 64) turns, so that eight products fit 64 bits. */
#define ERROR_BITS 31

/** The integrators hold 31 bits above this many bits of 2⁻²⁴ turn·tick. */
#define INTEGRAL_SHIFT 10
#define INTEGRAL_LIMIT ((int64_t)INT32_MAX << INTEGRAL_SHIFT)

/** Error (Q24) times gain (Q16) in V. */
#define PRODUCT_BITS 40

#define FIELD(member, low, high) JP_CONFIG_FIELD("lqr.", struct jp_lqr_config, member, low, high)

/** Saturated. */
static JP_INLINE_FOR_SPEED uint32_t add_magnitude(uint32_t sum, jp_q16 gain)
{
    const uint32_t more = sum + jp_magnitude32(gain);

    return more < sum ? UINT32_MAX : more;
}

static bool row_is_valid(uint32_t sum)
{
    return sum != 0U && sum <= (uint32_t)INT32_MAX;
}

/** Whether of a tick, 2^INTEGRAL_SHIFT / tick_rate of it, it fits too. */
static bool integral_is_valid(jp_q16 gain, uint32_t tick_rate)
{
    return jp_magnitude32(gain) >> (31 - INTEGRAL_SHIFT) < tick_rate;
}

static enum jp_status check_rows(const struct jp_lqr_config *config, const char **field)
{
    uint32_t common = jp_magnitude32(config->wheel);
    uint32_t difference = jp_magnitude32(config->yaw);

    common = add_magnitude(common, config->pitch);
    common = add_magnitude(common, config->wheel_rate);
    common = add_magnitude(common, config->pitch_rate);
    common = add_magnitude(common, config->wheel_integral);
    difference = add_magnitude(difference, config->yaw_rate);
    difference = add_magnitude(difference, config->yaw_integral);
    if (!row_is_valid(common)) {
        return jp_config_refuse("lqr.wheel", field);
    }
    if (!row_is_valid(difference)) {
        return jp_config_refuse("lqr.yaw", field);
    }
    if (!integral_is_valid(config->wheel_integral, config->tick_rate)) {
        return jp_config_refuse("lqr.wheel_integral", field);
    }
    if (!integral_is_valid(config->yaw_integral, config->tick_rate)) {
        return jp_config_refuse("lqr.yaw_integral", field);
    }
    return JP_OK;
}

enum jp_status jp_lqr_check(const struct jp_lqr_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(tick_rate, JP_TICK_RATE_MIN, JP_TICK_RATE_MAX),
        FIELD(pitch_reserve, 0, INT32_MAX),
    };
    const enum jp_status status = jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);

    return status == JP_OK ? check_rows(config, field) : status;
}

/** V per turn·s as V per 2⁻¹⁴ turn·tick, in Q40, rounded; tick_rate is at most 10 000. */
static int32_t integral_gain(jp_q16 gain, uint32_t tick_rate)
{
    uint32_t size = jp_magnitude32(gain);
    uint32_t rest = (size % tick_rate) << (PRODUCT_BITS - 16 - 24 + INTEGRAL_SHIFT);
    uint32_t quotient =
        ((size / tick_rate) << (PRODUCT_BITS - 16 - 24 + INTEGRAL_SHIFT)) + (rest + tick_rate / 2U) / tick_rate;

    return gain < 0 ? -(int32_t)quotient : (int32_t)quotient;
}

void jp_lqr_start(struct jp_lqr *lqr, const struct jp_lqr_config *config)
{
    *lqr = (struct jp_lqr){
        .integral_gain_wheel = integral_gain(config->wheel_integral, config->tick_rate),
        .integral_gain_yaw = integral_gain(config->yaw_integral, config->tick_rate),
    };
}

void jp_lqr_restart(struct jp_lqr *lqr)
{
    lqr->wheel_integral = 0;
    lqr->yaw_integral = 0;
}

static jp_q24 limited_error(jp_q24 error)
{
    return jp_saturate_bits(error, ERROR_BITS);
}

static JP_INLINE_FOR_SPEED jp_q16 volts(int64_t product)
{
    const int64_t half = (int64_t)1 << (PRODUCT_BITS - 16 - 1);

    return jp_saturate32((product + half) >> (PRODUCT_BITS - 16));
}

/** Adds the error unless the limit holds back a voltage that the error would push further. */
static void integrate(int64_t *integral, jp_q24 error, int32_t gain, jp_q16 wanted, jp_q16 given)
{
    jp_q24 push = gain < 0 ? -error : error;

    if ((wanted > given && push > 0) || (wanted < given && push < 0)) {
        return;
    }

    int64_t sum = *integral + error;

    *integral = sum > INTEGRAL_LIMIT ? INTEGRAL_LIMIT : sum < -INTEGRAL_LIMIT ? -INTEGRAL_LIMIT : sum;
}

static int64_t integral_product(int64_t integral, int32_t gain)
{
    return jp_multiply((int32_t)(integral >> INTEGRAL_SHIFT), gain);
}

void jp_lqr_update(struct jp_lqr *lqr, const struct jp_lqr_config *config, const struct jp_reference *reference,
                   const struct jp_motion_state *state, jp_q16 limit, struct jp_voltages *voltages)
{
    jp_q24 wheel = limited_error(jp_phase_difference(reference->wheel.angle, state->wheel));
    jp_q24 wheel_rate = limited_error(jp_sub(reference->wheel.rate, state->wheel_rate));
    jp_q24 yaw = limited_error(jp_phase_difference(reference->yaw.angle, state->yaw));
    jp_q24 yaw_rate = limited_error(jp_sub(reference->yaw.rate, state->yaw_rate));
    jp_q24 pitch = limited_error(jp_sub(reference->pitch, state->pitch));
    jp_q24 pitch_rate = limited_error(jp_sub(reference->pitch_rate, state->pitch_rate));

    jp_q16 travel_limit = limit > config->pitch_reserve ? limit - config->pitch_reserve : 0;
    jp_q16 travel_wanted = jp_add(
        reference->common, volts(jp_multiply(config->wheel, wheel) + jp_multiply(config->wheel_rate, wheel_rate) +
                                 integral_product(lqr->wheel_integral, lqr->integral_gain_wheel)));
    jp_q16 travel = jp_clamp32(travel_wanted, -travel_limit, travel_limit);
    jp_q16 balance = volts(jp_multiply(config->pitch, pitch) + jp_multiply(config->pitch_rate, pitch_rate));
    jp_q16 common_wanted = jp_add(travel, balance);
    jp_q16 common = jp_clamp32(common_wanted, -limit, limit);

    jp_q16 yaw_limit = limit - (common < 0 ? -common : common);
    jp_q16 difference_wanted =
        jp_add(reference->difference, volts(jp_multiply(config->yaw, yaw) + jp_multiply(config->yaw_rate, yaw_rate) +
                                            integral_product(lqr->yaw_integral, lqr->integral_gain_yaw)));
    jp_q16 difference = jp_clamp32(difference_wanted, -yaw_limit, yaw_limit);

    integrate(&lqr->wheel_integral, wheel, lqr->integral_gain_wheel, jp_add(travel_wanted, balance), common);
    integrate(&lqr->yaw_integral, yaw, lqr->integral_gain_yaw, difference_wanted, difference);

    voltages->left = common - difference;
    voltages->right = common + difference;
    voltages->saturated = travel != travel_wanted || common != common_wanted || difference != difference_wanted;
}
