/**
 * Energy-optimal segment to a target point (paper eq. 20–28).
 *
 * The segment is an arc: the heading turns by σ at its start, then by the arc angle γ at constant rate, so that
 *
 *   d, β = distance of the target and its bearing relative to the heading
 *   L = d (γ/2)/sin(γ/2),  v = L/T,  w = γ/T,  σ = β − γ/2 (in half a turn either way)
 *
 * and (γ, T) minimise the energy model's E within the limits. At fixed γ the best T is the root of a cubic, so one
 * search over γ is left. An optimum on a limit is found on that limit. |γ| is at most JP_ARC_ANGLE_MAX.
 */
#ifndef JOULEPATH_SEGMENT_H
#define JOULEPATH_SEGMENT_H

#include <joulepath/energy.h>
#include <joulepath/point.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Largest arc angle, rad (324°): beyond it an arc is more than nine times its chord. */
#define JP_ARC_ANGLE_MAX JP_Q24(5.654866776461628)

/** Targets nearer than this, m, have no direction. */
#define JP_SEGMENT_LENGTH_MIN JP_Q16(0.001)

/** Targets farther than this, m, are outside the arithmetic. */
#define JP_SEGMENT_LENGTH_MAX JP_Q16(512)

/** Shorter segments are not planned, s, whatever Ts. */
#define JP_SEGMENT_DURATION_MIN JP_Q16(0.125)

/** Most evaluations of the energy over one duration-optimal arc in one jp_segment_optimise(). */
#define JP_SEGMENT_EVALUATIONS 10

struct jp_segment_limits {
    jp_q24 speed;               /**< v, m/s; above 0, at most 8 */
    jp_radians_per_s turn_rate; /**< |w|, rad/s; above 0, at most 8 */
    jp_q24 turn;                /**< |σ|, rad; 0…π */
    jp_q16 duration;            /**< T, s; at least Ts and JP_SEGMENT_DURATION_MIN, at most 16 384 */
};

/** A planned segment. */
struct jp_segment {
    struct jp_segment_command command;
    jp_q24 arc;    /**< γ, rad */
    jp_q16 length; /**< L, m */
    jp_q16 energy; /**< predicted E, J in the model's unit (energy.h) */
};

/** Checks every field, and against the model that segments are planned with; null: none are. JP_ERR_CONFIG: *field
 * names the first one out of range. JP_ERR_ARGUMENT: another pointer is null. Not for ISRs. */
enum jp_status jp_segment_limits_check(const struct jp_segment_limits *limits, const struct jp_energy_model *model,
                                       const char **field);

/**
 * Best segment from (`start`, `heading`), in the settled motion `before`, to `target`.
 * The model and the limits must have passed their checks.
 *
 * JP_ERR_ZERO_LENGTH: start and target are nearer than JP_SEGMENT_LENGTH_MIN.
 * JP_ERR_ARGUMENT: they are farther than JP_SEGMENT_LENGTH_MAX, `before` is out of its range, or a pointer is null.
 * JP_ERR_INFEASIBLE: no arc satisfies the limits (σ cannot reach the bearing, or the arc takes longer than the
 * duration allows); within 1e-4 of a limit either answer is possible.
 * JP_ERR_MODEL: the energy model's least energy is not above 0: its parameters are not physical.
 * On these failures *segment is not written.
 * JP_ERR_OVERFLOW: the energy exceeds 32 767 J: *segment is written with the energy saturated.
 *
 * The stored v, w, σ and T are within the limits to the last bit. Driven as stored they end within
 * 1e-5 d + 1e-5 m + T 2⁻²⁴ (1/s) (d + 1 m) of the target. If arcs to the left and to the right may reach the
 * target, both are searched; for a target exactly behind the answer is always the same.
 * For the published model the energy is within 1.0001 of the minimum over the feasible set, whatever the limits. A
 * model can have two minima over γ on one side, mostly for targets some centimetres away; the lesser may then be taken.
 * Of robots like the published one (each parameter 10 % off, Ts from 4 s to 8 s) that is less than one segment in a
 * thousand, with up to 1.005 of the minimum seen; for models far from it (parameters up to four times off, Ts from 0 s
 * to 6 s) up to 1.044 was seen. tests/property/prop_segment.c measures it.
 * At most JP_SEGMENT_EVALUATIONS evaluations, no other unbounded loop; Cortex-M4 instructions: tests/bench/FIGURES.md.
 * For the background, not for ISRs.
 */
enum jp_status jp_segment_optimise(const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                                   const struct jp_motion *before, const struct jp_point *start, jp_angle heading,
                                   const struct jp_point *target, struct jp_segment *segment);

/** End of a segment from (start, heading); the heading there is heading + σ + γ. JP_ERR_OVERFLOW: the end
 *  does not fit ±32 767 m; *end is saturated. JP_ERR_ARGUMENT: a pointer is null. `end` may be `start`,
 *  `end_heading` may point to the heading's variable. */
enum jp_status jp_segment_end(const struct jp_segment *segment, const struct jp_point *start, jp_angle heading,
                              struct jp_point *end, jp_angle *end_heading);

/**
 * While the shaped reference turns by `turn` rad, the robot drives on toward the old heading: by 2τ, the tracker's lag,
 * at the old speed. As if it had turned at once from the point returned instead of `start`: what plans a segment for a
 * robot in motion plans it anew from there. The bandwidth is that of struct jp_reference_config, above 0. Constant
 * time.
 */
struct jp_point jp_segment_turning_point(jp_q16 yaw_bandwidth, jp_q24 speed, const struct jp_point *start,
                                         jp_angle heading, jp_q24 turn);

#ifdef __cplusplus
}
#endif

#endif
