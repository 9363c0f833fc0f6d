/**
 * Energy-optimal route: the segments through a sequence of targets, optimised together.
 *
 * Segment by segment (segment.h) is greedy: no segment takes into account with which heading, speed and turn rate the
 * next one must begin. Here all arc angles γ and durations T are found at once: minimise Σ E over (γ₁, T₁ … γₙ, Tₙ)
 * with σₖ = δₖ − (γₖ₋₁ + γₖ)/2, where δ is the turn from chord to chord, within the limits on v, w, σ and T.
 *
 * E of a segment depends on its own (γ, T) and those before it, so that the Hessian is block-tridiagonal with 2 × 2
 * blocks: a primal-dual interior-point method takes JP_ROUTE_ITERATIONS Newton steps of O(n) each, from the greedy
 * route. With a horizon (horizon.h) the energy includes what unsettled steps hand on to all later segments: their
 * gradient is exact by an adjoint sweep, the Hessian stays that of the settled energy.
 * The cost of the last segment's step is counted until it has settled.
 *
 * A longer route is planned over a receding horizon: plan as many targets as there are legs, drive the first segment,
 * plan again from its end.
 *
 * In libjoulepath_float, for cores with single-precision arithmetic in hardware; the segments are fixed-point.
 */
#ifndef JOULEPATH_ROUTE_H
#define JOULEPATH_ROUTE_H

#include <joulepath/horizon.h>
#include <joulepath/segment.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Newton steps. */
#define JP_ROUTE_ITERATIONS 8

/** Most legs at once. */
#define JP_ROUTE_LEGS_MAX 64

/** Limits of one leg: T, v, w to the left, w to the right, σ to the left, σ to the right. */
#define JP_ROUTE_LIMITS 6

/** Private: a leg in floating point. */
struct jp_route_leg_internal {
    struct jp_segment greedy;
    uint32_t distance;  /**< 2⁻²² m */
    jp_angle direction; /**< of the chord */
    float chord;        /**< m */
    float turn;         /**< δ, rad */
    float arc;          /**< γ, rad */
    float pace;         /**< 1/T, 1/s */
    float pace_max;     /**< 1/s */
    float slack[JP_ROUTE_LIMITS];
    float price[JP_ROUTE_LIMITS]; /**< multipliers, J */
    float v, w, sigma;
    float v_arc, v_pace, v_arc_arc, v_arc_pace;
    float travel[JP_AXIS_MODES]; /**< transient at the end of the segment, V */
    float yaw[JP_AXIS_MODES];
    float coupling[2][2]; /**< of this leg's step to the one before */
    float step[2];        /**< of arc and pace */
};

struct jp_route_leg {
    struct jp_segment segment; /**< the plan, once jp_route_work() returned JP_OK */
    struct jp_route_leg_internal internal;
};

struct jp_route_config {
    const struct jp_energy_model *model;
    const struct jp_horizon *horizon; /**< null: the paper's model, T >= Ts */
    const struct jp_segment_limits *limits;
    jp_q16 yaw_bandwidth; /**< of the shaped reference, as in struct jp_reference_config, rad/s; 0.1…100: a turn in
                               motion lags and the arc begins beside the target before; 0: not shaped */
    struct jp_route_leg *legs; /**< the caller's memory */
    uint16_t leg_count;        /**< 1…JP_ROUTE_LEGS_MAX */
};

/** Private. */
struct jp_route_internal {
    struct jp_point start;
    jp_angle heading;
    struct jp_energy_start before;
    const struct jp_point *targets;
    uint16_t iterations; /**< Newton steps taken */
    enum jp_status status;
    float barrier; /**< J */
    float barrier_min;
    float hessian[5][5]; /**< of the settled energy over v, w, σ, v before, w before */
};

/** The members but `internal` may be read. */
struct jp_route {
    struct jp_route_config config;
    uint16_t length;      /**< legs of the plan */
    uint16_t planned;     /**< legs of the greedy start */
    jp_q16 greedy_energy; /**< J, of all legs, segment by segment */
    jp_q16 energy;        /**< J, of all legs as planned */
    struct jp_route_internal internal;
};

/** Keeps the configuration. JP_ERR_ARGUMENT: a null pointer. JP_ERR_CONFIG: *field names the first field that is null,
 * but for the horizon, or out of range. The model, the horizon and the limits must have passed their checks; the
 * limits' duration is at least that of the horizon. */
enum jp_status jp_route_init(struct jp_route *route, const struct jp_route_config *config, const char **field);

/**
 * Begins a plan from `start` with `heading`, moving as `before`, through the first min(count, leg_count) of `targets`,
 * which must stay until the plan is made. JP_ERR_ARGUMENT: null, or count is 0.
 */
enum jp_status jp_route_start(struct jp_route *route, const struct jp_point *start, jp_angle heading,
                              const struct jp_energy_start *before, const struct jp_point *targets, uint16_t count);

/**
 * One slice: a leg of the greedy start, or one Newton step over all legs. JP_WORKING: there is more to do, call again.
 * JP_OK: the plan is made: every segment is within the limits, ends at its target as jp_segment_optimise() states, and
 * the route takes at most the energy of the greedy one. JP_ERR_STATE: nothing was begun. JP_ERR_ARGUMENT: also that the
 * transient is out of its range, or a greedy segment is shorter than the horizon allows. Else what
 * jp_segment_optimise() says of leg `planned`.
 * length + JP_ROUTE_ITERATIONS + 1 slices in all; their instructions: tests/bench/FIGURES.md. Not for ISRs.
 */
enum jp_status jp_route_work(struct jp_route *route);

#ifdef __cplusplus
}
#endif

#endif
