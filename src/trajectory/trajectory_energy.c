#include <joulepath/trajectory_energy.h>

#include <stddef.h>

#include "src/trajectory/trajectory_blend.h"

#define Q30_ONE ((int32_t)1 << 30)

#define CRUISE_MIN JP_Q24(0.01)
#define CRUISE_MAX JP_Q24(8)

/** (2π)², rad²/turn², Q10. */
#define RADIANS_SQUARED 40426

/** A leg's energy in the making. */
struct sum {
    const struct jp_trajectory_config *config;
    jp_q24 *modes;
    uint32_t set_points;
    int64_t squares; /**< ∫ (uc² + ud²) dt, V²·s in Q20 */
    int64_t travel;  /**< m²/s in Q20 */
    int64_t turning; /**< turn²/s in Q20 */
};

jp_q24 jp_cruise_speed(const struct jp_energy_model *model)
{
    const int64_t square = ((int64_t)model->electronics_power << 31) / (model->b[0] > 0 ? model->b[0] : 1); /* Q31 */
    const uint64_t root =
        (uint64_t)jp_square_root((uint64_t)(square < (int64_t)64 << 31 ? square : (int64_t)64 << 31) << 17);

    return jp_clamp32((int32_t)root, CRUISE_MIN, CRUISE_MAX);
}

/** What the modes add to the mean voltage at a share of so many set_points, V. */
static jp_q16 voltage_of_modes(const struct sum *sum, uint32_t set_points, int32_t share)
{
    int64_t volts = 0; /* Q40 */

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        volts +=
            jp_multiply(sum->config->modes.volts[i], jp_mode_after(sum->config, i, sum->modes[i], set_points, share));
    }
    return jp_round_shift(volts, 24);
}

static void pass(struct sum *sum, uint32_t set_points)
{
    jp_modes_decay(sum->config, sum->modes, set_points);
    sum->set_points += set_points;
}

/** A mean over so many set_points, by their time. */
static int64_t over_time(const struct sum *sum, int64_t mean, uint32_t set_points)
{
    return mean * set_points * JP_TICKS_PER_SET_POINT / sum->config->tick_rate;
}

static void add_blend(struct sum *sum, const struct jp_blend *blend)
{
    const uint32_t set_points = blend->set_points;
    const bool is_plain = blend->common[1] == 0 && jp_modes_are_gone(sum->modes);
    int64_t squares = 0; /* Q36 */
    int64_t travel = 0;
    int64_t turning = 0;
    unsigned count;
    const struct jp_node *nodes = jp_blend_nodes(is_plain, &count);

    for (unsigned k = 0; k < count; k++) {
        struct jp_set_point at;

        jp_blend_at(blend, nodes[k].share, &at);
        at.common = jp_add(at.common, voltage_of_modes(sum, set_points, nodes[k].share));

        const int64_t square = (jp_multiply(at.common, at.common) + jp_multiply(at.difference, at.difference)) >> 12;
        const jp_q24 speed = jp_q24_divide(at.wheel_rate, sum->config->turns_per_metre);

        squares += (square >> 4) * (nodes[k].weight >> 10);
        travel += jp_multiply(jp_q24_multiply(speed, speed), nodes[k].weight);              /* Q54 */
        turning += jp_multiply(jp_q24_multiply(at.yaw_rate, at.yaw_rate), nodes[k].weight); /* Q54 */
    }
    sum->squares += over_time(sum, squares >> 16, set_points);
    sum->travel += over_time(sum, travel >> 34, set_points);
    sum->turning += over_time(sum, turning >> 34, set_points);
    pass(sum, set_points);
}

/** ∫ of two modes' product, Q24 (m/s)² by Q16 1/s: V²·s in Q20. */
static int64_t product_of_modes(const struct sum *sum, const jp_q24 *left, unsigned i, unsigned j)
{
    const struct jp_travel_modes *modes = &sum->config->modes;
    const int64_t gone = (jp_multiply(sum->modes[i], sum->modes[j]) - jp_multiply(left[i], left[j])) >> 16; /* Q32 */
    const int64_t rate = (int64_t)jp_mode_rate(sum->config, i) + jp_mode_rate(sum->config, j);              /* Q16 */
    const int64_t volts = jp_multiply(modes->volts[i], modes->volts[j]) >> 16;                              /* Q16 */

    return (gone * 256 / rate * volts) >> 20;
}

static void add_middle(struct sum *sum, const struct jp_cruise *cruise, jp_q24 speed)
{
    const struct jp_travel_modes *modes = &sum->config->modes;
    const jp_q16 steady = cruise->common;
    const uint32_t set_points = cruise->set_points;
    jp_q24 left[JP_TRAVEL_MODES];

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        left[i] = jp_mode_after(sum->config, i, sum->modes[i], set_points, Q30_ONE);
    }
    sum->squares += over_time(sum, jp_multiply(steady, steady) >> 12, set_points);
    sum->travel += over_time(sum, jp_multiply(speed, speed) >> 28, set_points);
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const int64_t once = jp_multiply(modes->volts[i], steady) >> 16; /* V²·s/m in Q16 */
        const int64_t way = ((int64_t)sum->modes[i] - left[i]) * JP_Q16_ONE / jp_mode_rate(sum->config, i);

        sum->squares += (once * way) >> 19;
        for (unsigned j = 0; j < JP_TRAVEL_MODES; j++) {
            sum->squares += product_of_modes(sum, left, i, j);
        }
    }
    pass(sum, set_points);
}

/** False: it does not fit, and is saturated. */
static bool narrow(int64_t value, jp_q16 *result)
{
    *result = jp_saturate32(value);
    return *result == value;
}

/** b of the voltage that a steady motion takes: 2 u²/Rm. */
static jp_q16 steady_power(const struct jp_energy_model *model, jp_q16 volts)
{
    return jp_divide(2 * jp_multiply(volts, volts), model->motor_resistance);
}

/** What the model says of the steady motion beyond its voltages, J in Q16. */
static int64_t beyond_voltages(const struct sum *sum, const struct jp_energy_model *model,
                               const struct jp_leg_energy *leg)
{
    const jp_q16 turning = jp_divide(steady_power(model, sum->config->turning[0]) * (int64_t)1024, RADIANS_SQUARED);

    return (jp_multiply(jp_sub(model->b[0], steady_power(model, sum->config->volts[0])), leg->travel) +
            jp_multiply(jp_sub(model->b[1], turning), leg->turning)) >>
           16;
}

static bool finish(const struct sum *sum, const struct jp_energy_model *model, struct jp_leg_energy *result)
{
    const int64_t motors = (sum->squares << 13) / model->motor_resistance; /* J in Q16 */
    const int64_t electronics = over_time(sum, model->electronics_power, sum->set_points);
    const int64_t duration = over_time(sum, JP_Q16_ONE, sum->set_points);
    const bool travel_fits = narrow(sum->travel >> 4, &result->travel);
    const bool turning_fits = narrow((sum->turning * RADIANS_SQUARED) >> 14, &result->turning);
    const bool duration_fits = narrow(duration, &result->duration);
    const bool energy_fits = narrow(motors + electronics + beyond_voltages(sum, model, result), &result->energy);

    return energy_fits && duration_fits && travel_fits && turning_fits;
}

enum jp_status jp_trajectory_leg_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                        const struct jp_trajectory_leg *leg, jp_q24 modes[JP_TRAVEL_MODES],
                                        struct jp_leg_energy *result)
{
    struct sum sum = {.config = config, .modes = modes};

    if (config == NULL || model == NULL || leg == NULL || modes == NULL || result == NULL) {
        return JP_ERR_ARGUMENT;
    }
    add_blend(&sum, &leg->begin);
    add_middle(&sum, &leg->middle, leg->speed);
    add_blend(&sum, &leg->end);
    return finish(&sum, model, result) ? JP_OK : JP_ERR_OVERFLOW;
}

enum jp_status jp_trajectory_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                    const struct jp_trajectory *trajectory, jp_q16 *energy)
{
    jp_q24 modes[JP_TRAVEL_MODES];
    enum jp_status status = JP_OK;
    int64_t total = 0;

    if (config == NULL || model == NULL || trajectory == NULL || energy == NULL) {
        return JP_ERR_ARGUMENT;
    }
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        modes[i] = trajectory->transient[i] / 16;
    }
    for (uint16_t i = 0; i < trajectory->count; i++) {
        struct jp_leg_energy leg;

        if (jp_trajectory_leg_energy(config, model, &trajectory->legs[i], modes, &leg) != JP_OK) {
            status = JP_ERR_OVERFLOW;
        }
        total += leg.energy;
    }
    return narrow(total, energy) ? status : JP_ERR_OVERFLOW;
}
