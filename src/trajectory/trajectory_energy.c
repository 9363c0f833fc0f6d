#include <joulepath/trajectory_energy.h>

#include <stddef.h>

#include "src/energy/energy_terms.h"
#include "src/trajectory/trajectory_blend.h"

#define Q30_ONE ((int32_t)1 << 30)

#define CRUISE_MIN JP_Q24(0.01)
#define CRUISE_MAX JP_Q24(8)

/** (2π)², rad²/turn², Q10. */
#define RADIANS_SQUARED 40426

/** Most that a voltage's square counts, 4 096² V², in Q16 and Q20. */
#define SQUARE_MAX_Q16 ((int64_t)1 << 40)
#define SQUARE_MAX_Q20 ((int64_t)1 << 44)
/** Most that a duration counts, s: it fits far less. */
#define SECONDS_MAX 65536U
/** No energy of so many V²·s in Q20 fits, at any resistance. */
#define INTEGRAL_MAX ((int64_t)1 << 49)

/** A leg's energy in the making. */
struct sum {
    const struct jp_trajectory_config *config;
    const struct jp_back_emf *back_emf;
    jp_q24 *modes;
    uint32_t set_points;
    int64_t squares;                      /**< ∫ (uc (uc − ec v) + ud (ud − ed φ̇)) dt, V²·s in Q20 */
    int64_t travel;                       /**< m²/s in Q20 */
    int64_t turning;                      /**< turn²/s in Q20 */
    int64_t transient[JP_LEG_TRANSIENTS]; /**< V²·s in Q20 */
    bool is_cut;                          /**< a part of it was too large to be counted */
};

static int64_t cut(int64_t value, int64_t limit)
{
    if (value > limit) {
        return limit;
    }
    return value < -limit ? -limit : value;
}

/** The value, of which the sum has room for ±limit. */
static int64_t part_of(struct sum *sum, int64_t value, int64_t limit)
{
    const int64_t part = cut(value, limit);

    sum->is_cut = sum->is_cut || part != value;
    return part;
}

static int32_t part32_of(struct sum *sum, int64_t value)
{
    return (int32_t)part_of(sum, value, INT32_MAX);
}

jp_q24 jp_cruise_speed(const struct jp_energy_model *model)
{
    const int64_t square = ((int64_t)model->electronics_power << 31) / (model->b[0] > 0 ? model->b[0] : 1); /* Q31 */
    const uint64_t root =
        (uint64_t)jp_square_root((uint64_t)(square < (int64_t)64 << 31 ? square : (int64_t)64 << 31) << 17);

    return jp_clamp32((int32_t)root, CRUISE_MIN, CRUISE_MAX);
}

/** What the modes add to the mean voltage and to the speed at a share of so many set_points. */
static void add_modes(const struct sum *sum, uint32_t set_points, int32_t share, jp_q16 *volts, jp_q24 *speed)
{
    int64_t added = 0; /* Q40 */

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const jp_q24 mode = jp_mode_after(sum->config, i, sum->modes[i], set_points, share);

        added += jp_multiply(sum->config->modes.volts[i], mode);
        *speed = jp_add(*speed, mode);
    }
    *volts = jp_add(*volts, jp_round_shift(added, 24));
}

/** u less e·rate, V. */
static jp_q16 kept_of(jp_q16 volts, jp_q16 back_emf, jp_q24 rate)
{
    return jp_sub(volts, jp_multiply_shift(back_emf, rate, 24));
}

/** What the changes of speed and turn rate take of a set-point's voltages, V² in Q16, is added with its weight, Q20. */
static void add_transient(struct sum *sum, const struct jp_set_point *at, jp_q24 speed, int32_t weight,
                          int64_t transient[JP_LEG_TRANSIENTS])
{
    const struct jp_trajectory_config *config = sum->config;
    const jp_q16 steady = jp_multiply_shift(config->volts[0], speed, 24);
    const jp_q16 turning = jp_multiply_shift(config->turning[0], at->yaw_rate, 24);
    const jp_q16 changing = jp_sub(at->common, steady);

    transient[0] += part_of(sum, jp_multiply(steady, changing) >> 15, SQUARE_MAX_Q16) * weight;
    transient[1] += part_of(sum, jp_multiply(changing, changing) >> 16, SQUARE_MAX_Q16) * weight;
    transient[2] += part_of(sum, jp_multiply(turning, jp_sub(at->difference, turning)) >> 15, SQUARE_MAX_Q16) * weight;
}

static void pass(struct sum *sum, uint32_t set_points)
{
    jp_modes_decay(sum->config, sum->modes, set_points);
    sum->set_points += set_points;
}

/** A mean within ±2⁴⁴ over so many set_points, by their time. */
static int64_t over_time(struct sum *sum, int64_t mean, uint32_t set_points)
{
    const uint32_t rate = sum->config->tick_rate;
    const uint32_t ticks = set_points * JP_TICKS_PER_SET_POINT;
    const uint32_t seconds = ticks / rate;
    const uint32_t rest = ticks % rate;

    if (seconds >= SECONDS_MAX) {
        sum->is_cut = true;
        return mean * (int64_t)SECONDS_MAX;
    }
    return mean * (int64_t)seconds + mean * (int64_t)rest / (int64_t)rate;
}

static void add_blend(struct sum *sum, const struct jp_blend *blend)
{
    const uint32_t set_points = blend->set_points;
    const bool is_plain = blend->common[1] == 0 && jp_modes_are_gone(sum->modes);
    int64_t squares = 0; /* Q36 */
    int64_t travel = 0;
    int64_t turning = 0;
    int64_t transient[JP_LEG_TRANSIENTS] = {0};
    unsigned count;
    const struct jp_node *nodes = jp_blend_nodes(is_plain, &count);

    for (unsigned k = 0; k < count; k++) {
        struct jp_set_point at;

        jp_blend_at(blend, nodes[k].share, &at);

        const jp_q24 steady = jp_q24_divide(at.wheel_rate, sum->config->turns_per_metre);
        jp_q24 speed = steady;

        add_modes(sum, set_points, nodes[k].share, &at.common, &speed);

        const int64_t square =
            jp_multiply_accumulate(jp_multiply(at.common, kept_of(at.common, sum->back_emf->travel, speed)),
                                   at.difference, kept_of(at.difference, sum->back_emf->turning, at.yaw_rate));

        squares += part_of(sum, square >> 16, SQUARE_MAX_Q16) * (nodes[k].weight >> 10);
        add_transient(sum, &at, speed, nodes[k].weight >> 10, transient);
        travel += jp_multiply(jp_q24_multiply(steady, steady), nodes[k].weight);            /* Q54 */
        turning += jp_multiply(jp_q24_multiply(at.yaw_rate, at.yaw_rate), nodes[k].weight); /* Q54 */
    }
    sum->squares += over_time(sum, squares >> 16, set_points);
    sum->travel += over_time(sum, travel >> 34, set_points);
    sum->turning += over_time(sum, turning >> 34, set_points);
    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        sum->transient[i] += over_time(sum, transient[i] >> 16, set_points);
    }
    pass(sum, set_points);
}

/** ∫ of two modes' product, Q24 (m/s)² by Q16 1/s, with the voltages that they are: V²·s in Q20. */
static int64_t product_of_modes(struct sum *sum, const jp_q24 *left, unsigned i, unsigned j)
{
    const struct jp_travel_modes *modes = &sum->config->modes;
    const int64_t gone = (jp_multiply(sum->modes[i], sum->modes[j]) - jp_multiply(left[i], left[j])) >> 16; /* Q32 */
    const int64_t rate = (int64_t)jp_mode_rate(sum->config, i) + jp_mode_rate(sum->config, j);              /* Q16 */
    const jp_q16 kept = jp_sub(modes->volts[j], sum->back_emf->travel);
    const int64_t volts = jp_multiply(modes->volts[i], kept) >> 16; /* Q16 */

    return jp_term_scale(volts, part32_of(sum, gone * 256 / rate), 20);
}

static void add_middle(struct sum *sum, const struct jp_cruise *cruise, jp_q24 speed)
{
    const struct jp_travel_modes *modes = &sum->config->modes;
    const jp_q16 back_emf = sum->back_emf->travel;
    const jp_q16 steady = cruise->common;
    const jp_q16 kept = kept_of(steady, back_emf, speed);
    const uint32_t set_points = cruise->set_points;
    jp_q24 left[JP_TRAVEL_MODES];

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        left[i] = jp_mode_after(sum->config, i, sum->modes[i], set_points, Q30_ONE);
    }
    sum->squares += over_time(sum, part_of(sum, jp_multiply(steady, kept) >> 12, SQUARE_MAX_Q20), set_points);
    sum->travel += over_time(sum, jp_multiply(speed, speed) >> 28, set_points);
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const int64_t beside =
            jp_multiply(steady, jp_sub(modes->volts[i], back_emf)) + jp_multiply(modes->volts[i], kept);
        const int64_t once = beside >> 16; /* V²·s/m in Q16 */
        const int64_t way = ((int64_t)sum->modes[i] - left[i]) * JP_Q16_ONE / jp_mode_rate(sum->config, i);

        sum->squares += jp_term_scale(once, part32_of(sum, way), 20);
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

/** b of the voltage that a steady motion takes: 2 u (u − e)/Rm. */
static jp_q16 steady_power(const struct jp_energy_model *model, jp_q16 volts, jp_q16 back_emf)
{
    return jp_divide(2 * jp_multiply(volts, jp_sub(volts, back_emf)), model->motor_resistance);
}

/** What the model says of the steady motion beyond its voltages, J in Q16. */
static int64_t beyond_voltages(const struct sum *sum, const struct jp_energy_model *model,
                               const struct jp_leg_energy *leg)
{
    const jp_q16 travel = steady_power(model, sum->config->volts[0], sum->back_emf->travel);
    const jp_q16 by_turns = steady_power(model, sum->config->turning[0], sum->back_emf->turning);
    const jp_q16 turning = jp_divide((int64_t)by_turns * 1024, RADIANS_SQUARED);

    return jp_multiply_accumulate(jp_multiply(jp_sub(model->b[0], travel), leg->travel), jp_sub(model->b[1], turning),
                                  leg->turning) >>
           16;
}

static bool finish(struct sum *sum, const struct jp_energy_model *model, struct jp_leg_energy *result)
{
    const int64_t motors = part_of(sum, sum->squares, INTEGRAL_MAX) * 8192 / model->motor_resistance; /* J in Q16 */
    const int64_t electronics = over_time(sum, model->electronics_power, sum->set_points);
    const int64_t duration = over_time(sum, JP_Q16_ONE, sum->set_points);
    const bool travel_fits = narrow(sum->travel >> 4, &result->travel);
    const bool turning_fits = narrow((sum->turning * RADIANS_SQUARED) >> 14, &result->turning);
    const bool duration_fits = narrow(duration, &result->duration);
    bool transients_fit = true;

    for (unsigned i = 0; i < JP_LEG_TRANSIENTS; i++) {
        const int64_t transient = cut(sum->transient[i], INTEGRAL_MAX) * 8192 / model->motor_resistance;

        transients_fit = narrow(transient, &result->transient[i]) && transients_fit;
    }

    const int64_t energy = motors + electronics + beyond_voltages(sum, model, result);
    const bool energy_fits = narrow(sum->is_cut ? INT64_MAX : energy, &result->energy);

    return transients_fit && energy_fits && duration_fits && travel_fits && turning_fits;
}

void jp_trajectory_modes(const struct jp_trajectory *trajectory, jp_q24 modes[JP_TRAVEL_MODES])
{
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        modes[i] = trajectory->transient[i] / 16;
    }
}

enum jp_status jp_trajectory_leg_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                        const struct jp_back_emf *back_emf, const struct jp_trajectory_leg *leg,
                                        jp_q24 modes[JP_TRAVEL_MODES], struct jp_leg_energy *result)
{
    struct sum sum = {.config = config, .back_emf = back_emf, .modes = modes};

    if (config == NULL || model == NULL || back_emf == NULL || leg == NULL || modes == NULL || result == NULL) {
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
    static const struct jp_back_emf of_voltages = {0, 0};
    jp_q24 modes[JP_TRAVEL_MODES];
    enum jp_status status = JP_OK;
    int64_t total = 0;

    if (config == NULL || model == NULL || trajectory == NULL || energy == NULL) {
        return JP_ERR_ARGUMENT;
    }
    jp_trajectory_modes(trajectory, modes);
    for (uint16_t i = 0; i < trajectory->count; i++) {
        struct jp_leg_energy leg;

        if (jp_trajectory_leg_energy(config, model, &of_voltages, &trajectory->legs[i], modes, &leg) != JP_OK) {
            status = JP_ERR_OVERFLOW;
        }
        total += leg.energy;
    }
    return narrow(total, energy) ? status : JP_ERR_OVERFLOW;
}
