#include <joulepath/trajectory_energy.h>

#include <stddef.h>

#include "src/trajectory/trajectory_blend.h"

#define Q30_ONE ((int32_t)1 << 30)

#define CRUISE_MIN JP_Q24(0.01)
#define CRUISE_MAX JP_Q24(8)

/** A trajectory's energy in the making. */
struct sum {
    const struct jp_trajectory_config *config;
    jp_q24 modes[JP_TRAVEL_MODES];
    uint64_t set_points;
    int64_t squares; /**< ∫ (uc² + ud²) dt, V²·s in Q20 */
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

static void add_blend(struct sum *sum, const struct jp_blend *blend)
{
    const uint32_t set_points = blend->set_points;
    const bool is_plain = blend->common[1] == 0 && jp_modes_are_gone(sum->modes);
    int64_t squares = 0; /* Q36 */
    unsigned count;
    const struct jp_node *nodes = jp_blend_nodes(is_plain, &count);

    for (unsigned k = 0; k < count; k++) {
        struct jp_set_point at;

        jp_blend_at(blend, nodes[k].share, &at);
        at.common = jp_add(at.common, voltage_of_modes(sum, set_points, nodes[k].share));

        const int64_t square = (jp_multiply(at.common, at.common) + jp_multiply(at.difference, at.difference)) >> 12;

        squares += (square >> 4) * (nodes[k].weight >> 10);
    }
    sum->squares += (squares >> 16) * set_points * JP_TICKS_PER_SET_POINT / sum->config->tick_rate;
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

static void add_middle(struct sum *sum, const struct jp_cruise *cruise)
{
    const struct jp_travel_modes *modes = &sum->config->modes;
    const jp_q16 steady = cruise->common;
    const uint32_t set_points = cruise->set_points;
    jp_q24 left[JP_TRAVEL_MODES];

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        left[i] = jp_mode_after(sum->config, i, sum->modes[i], set_points, Q30_ONE);
    }
    sum->squares += (jp_multiply(steady, steady) >> 12) * set_points * JP_TICKS_PER_SET_POINT / sum->config->tick_rate;
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

enum jp_status jp_trajectory_energy(const struct jp_trajectory_config *config, const struct jp_energy_model *model,
                                    const struct jp_trajectory *trajectory, jp_q16 *energy)
{
    struct sum sum = {.config = config};

    if (config == NULL || model == NULL || trajectory == NULL || energy == NULL) {
        return JP_ERR_ARGUMENT;
    }
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        sum.modes[i] = trajectory->transient[i] / 16;
    }
    for (uint16_t i = 0; i < trajectory->count; i++) {
        add_blend(&sum, &trajectory->legs[i].begin);
        add_middle(&sum, &trajectory->legs[i].middle);
        add_blend(&sum, &trajectory->legs[i].end);
    }

    const int64_t motors = (sum.squares << 13) / model->motor_resistance; /* J in Q16 */
    const uint64_t electronics =
        JP_TICKS_PER_SET_POINT * sum.set_points * (uint32_t)model->electronics_power / config->tick_rate;
    const int64_t total = motors + (int64_t)electronics;

    *energy = jp_saturate32(total);
    return total > INT32_MAX ? JP_ERR_OVERFLOW : JP_OK;
}
