#include <joulepath/energy.h>

#include "src/base/compiler.h"
#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/energy/energy_terms.h"

#define MOTION_MAX   JP_Q24(8)
#define TURN_MAX     JP_Q24(6.283185307179586)
#define DURATION_MAX JP_Q16(16384)
#define POWER_MAX    ((int64_t)1 << 36) /* 2²⁰ W in Q16 */

bool jp_motion_in_range(const struct jp_motion *motion)
{
    return jp_is_between(motion->speed, -MOTION_MAX, MOTION_MAX) &&
           jp_is_between(motion->turn_rate, -MOTION_MAX, MOTION_MAX);
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("model.", struct jp_energy_model, member, low, high)

enum jp_status jp_energy_model_check(const struct jp_energy_model *model, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(a, -JP_Q16(4096), JP_Q16(4096)),
        FIELD(b, 0, JP_Q16(4096)),
        FIELD(electronics_power, 1, JP_Q16(4096)),
        FIELD(settling_time, 0, JP_Q16(60)),
        FIELD(voltage_per_speed, 0, JP_Q16(256)),
        FIELD(voltage_per_turn_rate, 0, JP_Q16(256)),
        FIELD(motor_resistance, 1, INT32_MAX),
        FIELD(unit_exponent, -JP_ENERGY_UNIT_EXPONENT_MAX, JP_ENERGY_UNIT_EXPONENT_MAX),
    };

    return jp_config_check(model, fields, JP_CONFIG_COUNT(fields), field);
}

static JP_INLINE_FOR_SPEED int64_t scaled_term(int64_t a, int32_t b, unsigned shift)
{
    int64_t high = (a >> 32) * b;
    int64_t low = (int64_t)(uint32_t)a * b;
    return high * ((int64_t)1 << (32 - shift)) + (low >> shift);
}

int64_t jp_term_scale(int64_t a, int32_t b, unsigned shift)
{
    return scaled_term(a, b, shift);
}

void jp_steady_voltages(const struct jp_energy_model *model, const struct jp_motion *motion,
                        struct jp_steady_voltages *steady)
{
    int64_t common = (int64_t)model->voltage_per_speed * motion->speed;
    int64_t difference = (int64_t)model->voltage_per_turn_rate * motion->turn_rate;
    steady->left = (int32_t)((common - difference) >> 22);
    steady->right = (int32_t)((common + difference) >> 22);
    int64_t squares = (int64_t)steady->left * steady->left + (int64_t)steady->right * steady->right; /* Q36, <= 2⁶¹ */
    int64_t power = (squares >> 4) / model->motor_resistance;                                        /* Q16 */
    steady->power = power > POWER_MAX ? POWER_MAX : power;
}

/* V in Q18 times J/V in Q16: Q34 to Q28. */
static JP_INLINE_FOR_SPEED int64_t voltage_term(const struct jp_steady_voltages *steady, jp_q16 a_left, jp_q16 a_right)
{
    return ((int64_t)steady->left * a_left + (int64_t)steady->right * a_right) >> (34 - JP_TERM_BITS);
}

void jp_voltage_terms(const struct jp_energy_model *model, const struct jp_motion *before,
                      struct jp_voltage_terms *terms)
{
    struct jp_steady_voltages steady;
    jp_steady_voltages(model, before, &steady);
    const jp_q16 *a = model->a;
    terms->speed = voltage_term(&steady, a[6], a[9]);
    terms->turn_rate = voltage_term(&steady, a[7], a[10]);
    terms->turn = voltage_term(&steady, a[8], a[11]);
    terms->power = scaled_term(steady.power, a[12], 32 - JP_TERM_BITS);
}

/* a·x·y with a in Q16, x and y in Q24: Q28. */
static JP_INLINE_FOR_SPEED int64_t product_term(jp_q16 a, int32_t x, int32_t y)
{
    return scaled_term(((int64_t)a * x) >> 8, y, 28);
}

enum jp_status jp_energy_total(const struct jp_energy_model *model, const struct jp_motion *before,
                               const struct jp_voltage_terms *voltage, const struct jp_segment_command *segment,
                               jp_q16 *energy)
{
    const jp_q16 *a = model->a;
    int32_t v = segment->motion.speed;
    int32_t w = segment->motion.turn_rate;
    int32_t dv = v - before->speed;
    int32_t dw = w - before->turn_rate;
    int32_t turn = segment->turn;
    int64_t state = product_term(a[0], dv, dv) + product_term(a[1], dw, dw) + product_term(a[2], turn, turn) +
                    product_term(a[3], dv, dw) + product_term(a[4], dv, turn) + product_term(a[5], dw, turn) +
                    scaled_term(voltage->speed, dv, 24) + scaled_term(voltage->turn_rate, dw, 24) +
                    scaled_term(voltage->turn, turn, 24) + voltage->power;
    int64_t friction = product_term(model->b[0], v, v) + product_term(model->b[1], w, w);
    int64_t total = state + scaled_term(friction, segment->duration - model->settling_time, 16) +
                    (((int64_t)model->electronics_power * segment->duration) >> (32 - JP_TERM_BITS));
    int64_t rounded = (total + ((int64_t)1 << (JP_TERM_BITS - 17))) >> (JP_TERM_BITS - 16);
    *energy = jp_saturate32(rounded);
    return rounded == *energy ? JP_OK : JP_ERR_OVERFLOW;
}

bool jp_segment_in_range(const struct jp_segment_command *segment, jp_q16 duration_min)
{
    return jp_motion_in_range(&segment->motion) && jp_is_between(segment->turn, -TURN_MAX, TURN_MAX) &&
           jp_is_between(segment->duration, duration_min, DURATION_MAX);
}

enum jp_status jp_energy_predict(const struct jp_energy_model *model, const struct jp_motion *before,
                                 const struct jp_segment_command *segment, jp_q16 *energy)
{
    if (!model || !before || !segment || !energy || !jp_motion_in_range(before) ||
        !jp_segment_in_range(segment, model->settling_time)) {
        return JP_ERR_ARGUMENT;
    }
    struct jp_voltage_terms voltage;
    jp_voltage_terms(model, before, &voltage);
    return jp_energy_total(model, before, &voltage, segment, energy);
}
