/** The pieces of a trajectory: their polynomials, and their way, which the planner adds up. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_TRAJECTORY_BLEND_H
#define JOULEPATH_TRAJECTORY_TRAJECTORY_BLEND_H

#include <joulepath/trajectory_rule.h>

/** Fills in what the tick needs of a leg that begins so; headings, speeds and set_points are there. */
void jp_leg_shape(const struct jp_trajectory_config *config, const struct jp_waypoint_motion *from,
                  struct jp_trajectory_leg *leg);

/** What a blend says after that share of its duration, Q30. */
void jp_blend_at(const struct jp_blend *blend, int32_t share, struct jp_set_point *at);

/** Gauss's and Legendre's, Q30. */
struct jp_node {
    int32_t share;
    int32_t weight;
};

/** Nodes of a blend: few for a plain turn, more where speed changes or modes decay. */
const struct jp_node *jp_blend_nodes(bool is_plain, unsigned *count);

/** What is left of a mode after that share, Q30, of so many set_points. */
jp_q24 jp_mode_after(const struct jp_trajectory_config *config, unsigned mode, jp_q24 value, uint32_t set_points,
                     int32_t share);

/** λ, 1/s. */
jp_q16 jp_mode_rate(const struct jp_trajectory_config *config, unsigned mode);

/** No difference from the start is left. */
bool jp_modes_are_gone(const jp_q24 *modes);

/** What is left of the modes after that many set_points. */
void jp_modes_decay(const struct jp_trajectory_config *config, jp_q24 *modes, uint32_t set_points);

/** The way that they roll meanwhile if the robot goes straight, 2⁻²⁰ m. */
int32_t jp_modes_way(const struct jp_trajectory_config *config, const jp_q24 *modes, uint32_t set_points);

/** Most nodes of a blend. */
#define JP_NODES_MAX 8U

/** What the modes add to the speed at each node of a blend, m/s. */
struct jp_rolling {
    const struct jp_node *nodes;
    unsigned count;
    jp_q24 speed[JP_NODES_MAX];
};

/** In a blend at whose begin the modes are these. An even one turns and changes speed so little that few nodes do. */
void jp_modes_roll(const struct jp_trajectory_config *config, const jp_q24 *modes, uint32_t set_points, bool is_even,
                   struct jp_rolling *rolling);

/** From a heading by another to a third, each half a turn away at most: 2⁻³¹ turn. */
static inline int32_t jp_turn_by(jp_angle from, jp_angle by, jp_angle to)
{
    return (int32_t)(((int64_t)(int32_t)(by - from) + (int32_t)(to - by)) / 2);
}

/** Seconds of that many set_points in Q`bits`, 1…32, saturated. */
static inline int32_t jp_seconds(const struct jp_trajectory_config *config, uint32_t set_points, unsigned bits)
{
    const uint64_t tick = (uint32_t)jp_phase_per_rate(config->tick_rate); /* 2⁻³² s */
    const unsigned shift = 32U - bits;
    const uint64_t seconds = (set_points * tick * JP_TICKS_PER_SET_POINT) >> shift;

    return seconds > (uint64_t)INT32_MAX ? INT32_MAX : (int32_t)seconds;
}

/** The way between two motions that turns so much, 2⁻³¹ turn, in that time, s. */
struct jp_way jp_blend_way(const struct jp_trajectory_config *config, const struct jp_waypoint_motion *from,
                           const struct jp_waypoint_motion *to, int32_t turned, jp_q24 duration,
                           const struct jp_rolling *rolling);

#endif
