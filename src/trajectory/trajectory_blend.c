#include "src/trajectory/trajectory_blend.h"

#include "src/base/integer.h"
#include "src/base/power_of_half.h"

#define Q30_ONE  ((int32_t)1 << 30)
#define LN_2_Q30 744261118

/** Modes below this, 5e-5 m/s, are as good as gone. */
#define GONE 839

#define FEW  4U
#define MANY JP_NODES_MAX

/** A blend in the share of its time that has passed. Angles in 2⁻³² turn. */
struct blend {
    jp_angle heading; /**< at its begin */
    int32_t turned;   /**< in all, 2⁻³¹ turn */
    int32_t lead;     /**< what the turn rate at its begin would turn in its time, 2⁻²⁸ turn */
    int32_t trail;    /**< what that at its end would, 2⁻²⁸ turn */
    jp_q24 speed;     /**< at its begin, m/s */
    jp_q24 change;
    jp_q24 swing; /**< lag of the change, by the duration twice: m/s */
};

/** a·b in Q30, of what fits it: rounded down. */
static inline int32_t multiply30(int32_t a, int32_t b)
{
    return (int32_t)(jp_multiply(a, b) >> 30);
}

/* Modes. */

jp_q16 jp_mode_rate(const struct jp_trajectory_config *config, unsigned mode)
{
    return jp_multiply_shift(config->modes.decay[mode], LN_2_Q30, 30);
}

jp_q24 jp_mode_after(const struct jp_trajectory_config *config, unsigned mode, jp_q24 value, uint32_t set_points,
                     int32_t share)
{
    if (value == 0) {
        return 0;
    }

    const int32_t halvings =
        jp_saturate32(jp_multiply(config->modes.decay[mode], jp_seconds(config, set_points, 20)) >> 20); /* Q16 */

    return multiply30(value, jp_power_of_half((uint64_t)jp_multiply(halvings, share) >> 14));
}

bool jp_modes_are_gone(const jp_q24 *modes)
{
    return jp_is_between(modes[0], -GONE, GONE) && jp_is_between(modes[1], -GONE, GONE) &&
           jp_is_between(modes[2], -GONE, GONE);
}

void jp_modes_decay(const struct jp_trajectory_config *config, jp_q24 *modes, uint32_t set_points)
{
    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        modes[i] = jp_mode_after(config, i, modes[i], set_points, Q30_ONE);
    }
}

int32_t jp_modes_way(const struct jp_trajectory_config *config, const jp_q24 *modes, uint32_t set_points)
{
    int64_t sum = 0;

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        const int64_t gone = (int64_t)modes[i] - jp_mode_after(config, i, modes[i], set_points, Q30_ONE);

        sum += gone == 0 ? 0 : jp_divide(gone * ((int64_t)1 << 12), jp_mode_rate(config, i));
    }
    return jp_saturate32(sum);
}

const struct jp_node *jp_blend_nodes(bool is_plain, unsigned *count)
{
    static const struct jp_node few[FEW] = {
        {74551875, 186753148}, {354344979, 350117764}, {719396845, 350117764}, {999189949, 186753148}};
    /* Some modes decay in a small part of a blend. */
    static const struct jp_node many[MANY] = {
        {21319221, 54346657},   {109163854, 119389909}, {254727848, 168419973}, {438390188, 194714374},
        {635351636, 194714374}, {819013976, 168419973}, {964577970, 119389909}, {1052422603, 54346657},
    };

    if (is_plain) {
        *count = FEW;
        return few;
    }
    *count = MANY;
    return many;
}

/* Blends. */

/** lag ν̈ by 60 p(1 − 2s). */
static jp_q24 swing_of(const struct jp_trajectory_config *config, jp_q24 change, jp_q24 duration)
{
    const jp_q24 pace = jp_q24_divide(JP_Q24_ONE, duration);

    return jp_q24_multiply(jp_q24_multiply(jp_q24_multiply(config->lag, pace), pace), change);
}

static struct blend blend_of(const struct jp_trajectory_config *config, const struct jp_waypoint_motion *from,
                             const struct jp_waypoint_motion *to, int32_t turned, jp_q24 duration)
{
    const jp_q24 change = to->speed - from->speed;

    return (struct blend){
        .heading = from->heading,
        .turned = turned,
        .lead = jp_multiply_shift(from->turn_rate, duration, 20),
        .trail = jp_multiply_shift(to->turn_rate, duration, 20),
        .speed = from->speed,
        .change = change,
        .swing = change == 0 ? 0 : swing_of(config, change, duration),
    };
}

static jp_angle heading_at(const struct blend *blend, int32_t share)
{
    const int32_t rest = Q30_ONE - share;
    const int32_t product = multiply30(share, rest);
    const int32_t risen = multiply30(multiply30(share, share), 3 * (Q30_ONE >> 1) - share); /* Q29 */

    return blend->heading + (jp_angle)(jp_multiply(blend->turned, risen) >> 28) +
           (jp_angle)jp_multiply_shift(blend->lead, multiply30(product, rest), 26) -
           (jp_angle)jp_multiply_shift(blend->trail, multiply30(product, share), 26);
}

/** v = ν − lag ν̈ of the quintic. */
static jp_q24 speed_at(const struct blend *blend, int32_t share)
{
    if (blend->change == 0) {
        return blend->speed;
    }

    const int32_t square = multiply30(share, share);
    const int32_t rest = 10 * (Q30_ONE >> 3) - 15 * (share >> 3) + 6 * (square >> 3); /* Q27 */
    const int32_t risen = multiply30(multiply30(square, share), rest);                /* Q27 */
    const int32_t product = multiply30(share, Q30_ONE - share);
    const int32_t bend = multiply30(60 * (product >> 4), Q30_ONE - share - share); /* Q26 */

    return jp_add(blend->speed,
                  jp_sub(jp_multiply_shift(blend->change, risen, 27), jp_multiply_shift(blend->swing, bend, 26)));
}

void jp_modes_roll(const struct jp_trajectory_config *config, const jp_q24 *modes, uint32_t set_points, bool is_even,
                   struct jp_rolling *rolling)
{
    const bool are_gone = jp_modes_are_gone(modes);

    rolling->nodes = jp_blend_nodes(is_even && are_gone, &rolling->count);
    for (unsigned k = 0; k < rolling->count; k++) {
        rolling->speed[k] = 0;
        for (unsigned i = 0; i < JP_TRAVEL_MODES && !are_gone; i++) {
            const jp_q24 left = jp_mode_after(config, i, modes[i], set_points, rolling->nodes[k].share);

            rolling->speed[k] = jp_add(rolling->speed[k], left);
        }
    }
}

struct jp_way jp_blend_way(const struct jp_trajectory_config *config, const struct jp_waypoint_motion *from,
                           const struct jp_waypoint_motion *to, int32_t turned, jp_q24 duration,
                           const struct jp_rolling *rolling)
{
    const struct blend blend = blend_of(config, from, to, turned, duration);
    int64_t x = 0;
    int64_t y = 0;

    for (unsigned k = 0; k < rolling->count; k++) {
        const struct jp_node *node = &rolling->nodes[k];
        const jp_angle heading = heading_at(&blend, node->share);
        const jp_q24 speed = multiply30(jp_add(speed_at(&blend, node->share), rolling->speed[k]), node->weight);

        x += jp_multiply(speed, jp_cos(heading));
        y += jp_multiply(speed, jp_sin(heading));
    }

    /* Q55 of m/s by Q24 of s to Q20 of m. */
    return (struct jp_way){jp_multiply_shift(jp_round_shift(x, 31), duration, 28),
                           jp_multiply_shift(jp_round_shift(y, 31), duration, 28)};
}
