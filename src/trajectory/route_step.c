#include "src/trajectory/route_step.h"

#include <stddef.h>

#include "src/base/plane.h"
#include "src/trajectory/route_legs.h"

/* How near to a limit a leg may start, as a share of the limit. */
#define SLACK_MIN 0.02f

/* Fraction to the boundary: a step covers at most this share of the distance to a limit. */
#define BOUNDARY_SHARE 0.95f

/* A step makes a segment at most this much longer, and turns an arc by at most this, rad. */
#define PACE_FALL_MAX  0.7f
#define ARC_CHANGE_MAX 1.0f

/* The barrier falls by this factor with every step. */
#define BARRIER_FALL 0.3f

/* A pivot below this share of its diagonal element is not positive definite enough for a descent direction. */
#define PIVOT_MIN 1e-3f

/* Least limit of |σ|, rad: a limit of 0 would leave no interior. */
#define TURN_MIN 0.01f

#define Q16_ONE 65536.0f
#define Q24_ONE 16777216.0f

enum { SHORTEST, SPEED, TURN_LEFT, TURN_RIGHT, SIGMA_LEFT, SIGMA_RIGHT };

struct bounds {
    float v;
    float w;
    float sigma;
};

static struct bounds bounds_of(const struct jp_segment_limits *limits)
{
    const float sigma = (float)limits->turn * (1.0f / Q24_ONE);

    return (struct bounds){(float)limits->speed * (1.0f / Q24_ONE), (float)limits->turn_rate * (1.0f / Q24_ONE),
                           sigma > TURN_MIN ? sigma : TURN_MIN};
}

/* The distance (slack) of each limit, as a share of it. */
static void distances(const struct jp_route_leg_internal *leg, const struct bounds *bounds,
                      float distance[JP_ROUTE_LIMITS])
{
    const float w = leg->w / bounds->w;
    const float sigma = leg->sigma / bounds->sigma;

    distance[SHORTEST] = 1.0f - leg->pace / leg->pace_max;
    distance[SPEED] = 1.0f - leg->v / bounds->v;
    distance[TURN_LEFT] = 1.0f - w;
    distance[TURN_RIGHT] = 1.0f + w;
    distance[SIGMA_LEFT] = 1.0f - sigma;
    distance[SIGMA_RIGHT] = 1.0f + sigma;
}

void jp_route_enter(struct jp_route *route)
{
    const struct bounds bounds = bounds_of(route->config.limits);

    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);

        distances(leg, &bounds, leg->slack);
        for (unsigned i = 0; i < JP_ROUTE_LIMITS; i++) {
            leg->slack[i] = leg->slack[i] > SLACK_MIN ? leg->slack[i] : SLACK_MIN;
            leg->price[i] = route->internal.barrier / leg->slack[i];
        }
    }
}

/* Terms of the barrier over 1/T, v, w and σ: gradient, curvature, and the weight of the curvature of v and w. */
struct barrier {
    float pace, v, w, sigma;
    float pace_pace, v_v, w_w, sigma_sigma;
    float v_price, w_price;
};

static struct barrier barrier_of(const struct jp_route_leg_internal *leg, const struct bounds *bounds, float barrier)
{
    float distance[JP_ROUTE_LIMITS];
    float push[JP_ROUTE_LIMITS];
    float stiffness[JP_ROUTE_LIMITS];

    distances(leg, bounds, distance);
    for (unsigned i = 0; i < JP_ROUTE_LIMITS; i++) {
        const float inverse = 1.0f / leg->slack[i];

        stiffness[i] = leg->price[i] * inverse;
        push[i] = barrier * inverse - stiffness[i] * (distance[i] - leg->slack[i]);
    }

    const float by_pace = 1.0f / leg->pace_max;
    const float by_v = 1.0f / bounds->v;
    const float by_w = 1.0f / bounds->w;
    const float by_sigma = 1.0f / bounds->sigma;

    return (struct barrier){
        .pace = push[SHORTEST] * by_pace,
        .v = push[SPEED] * by_v,
        .w = (push[TURN_LEFT] - push[TURN_RIGHT]) * by_w,
        .sigma = (push[SIGMA_LEFT] - push[SIGMA_RIGHT]) * by_sigma,
        .pace_pace = stiffness[SHORTEST] * by_pace * by_pace,
        .v_v = stiffness[SPEED] * by_v * by_v,
        .w_w = (stiffness[TURN_LEFT] + stiffness[TURN_RIGHT]) * by_w * by_w,
        .sigma_sigma = (stiffness[SIGMA_LEFT] + stiffness[SIGMA_RIGHT]) * by_sigma * by_sigma,
        .v_price = leg->price[SPEED] * by_v,
        .w_price = (leg->price[TURN_LEFT] - leg->price[TURN_RIGHT]) * by_w,
    };
}

/* What the backward elimination passes from a leg to the one before it. */
struct carried {
    struct jp_route_adjoint adjoint;
    float v, w, sigma; /* gradient by the motion before, and by σ */
    float sigma_sigma; /* curvature */
    bool next;         /* there is a later leg */
    float block[3];    /* of the later legs' elimination: arc arc, arc pace, pace pace */
    float right[2];
};

/* One leg's part of the system, over its arc and pace. */
struct equations {
    float block[3];
    float right[2];
};

struct leg_terms {
    float v, w, sigma; /* gradient of the settled energy and of the transients */
    float v_before, w_before;
    float pace;
};

/* Of the settled energy and what unsettled steps add. */
static struct leg_terms leg_terms(const struct jp_route *route, unsigned k, struct carried *carried)
{
    const struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
    const float v_before =
        k > 0U ? jp_route_leg_at(route, k - 1U)->v : (float)route->internal.before.motion.speed * (1.0f / Q24_ONE);
    const float w_before =
        k > 0U ? jp_route_leg_at(route, k - 1U)->w : (float)route->internal.before.motion.turn_rate * (1.0f / Q24_ONE);
    const float x[5] = {leg->v, leg->w, leg->sigma, v_before, w_before};
    struct leg_terms terms;
    float gradient[5];

    for (unsigned i = 0; i < 5U; i++) {
        const float *row = route->internal.hessian[i];

        gradient[i] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3] * x[3] + row[4] * x[4];
    }
    terms = (struct leg_terms){gradient[JP_ROUTE_V],        gradient[JP_ROUTE_W],        gradient[JP_ROUTE_SIGMA],
                               gradient[JP_ROUTE_V_BEFORE], gradient[JP_ROUTE_W_BEFORE], 0.0f};
    if (route->config.horizon != NULL) {
        struct jp_route_handed handed;

        jp_route_hand_back(route, k, &carried->adjoint, &handed);
        terms.v += handed.v;
        terms.v_before -= handed.v;
        terms.w += handed.w;
        terms.w_before -= handed.w;
        terms.sigma += handed.sigma;
        terms.pace = handed.pace;
    }
    return terms;
}

/* The friction of the whole segment and the electronics: (b1 v² + b2 w² + Ps) T. */
static void add_steady(const struct jp_energy_model *model, const struct jp_route_leg_internal *leg,
                       struct equations *system)
{
    const float b1 = (float)model->b[0] * (2.0f / Q16_ONE);
    const float b2 = (float)model->b[1] * (2.0f / Q16_ONE);
    const float time = 1.0f / leg->pace;
    const float idle = (float)model->electronics_power * (1.0f / Q16_ONE) * time * time;

    system->block[0] += b1 * (leg->v_arc * leg->v_arc_pace + leg->v_pace * leg->v_arc_arc) + b2 * leg->pace;
    system->block[1] += b1 * leg->v_pace * leg->v_arc_pace + b2 * leg->arc;
    system->block[2] += 2.0f * idle * time;
    system->right[0] -= b1 * leg->v_pace * leg->v_arc + b2 * leg->arc * leg->pace;
    system->right[1] -= 0.5f * (b1 * leg->v_pace * leg->v_pace + b2 * leg->arc * leg->arc) - idle;
}

static void write_system(const struct jp_route *route, const struct jp_route_leg_internal *leg,
                         const struct leg_terms *terms, const struct barrier *barrier, const struct carried *carried,
                         struct equations *system)
{
    const float(*h)[5] = route->internal.hessian;
    const float next = carried->next ? 1.0f : 0.0f;
    const float vv = h[JP_ROUTE_V][JP_ROUTE_V] + barrier->v_v + next * h[JP_ROUTE_V_BEFORE][JP_ROUTE_V_BEFORE];
    const float vw = h[JP_ROUTE_V][JP_ROUTE_W] + next * h[JP_ROUTE_V_BEFORE][JP_ROUTE_W_BEFORE];
    const float ww = h[JP_ROUTE_W][JP_ROUTE_W] + barrier->w_w + next * h[JP_ROUTE_W_BEFORE][JP_ROUTE_W_BEFORE];
    const float v_sigma = -0.5f * (h[JP_ROUTE_V][JP_ROUTE_SIGMA] + next * h[JP_ROUTE_V_BEFORE][JP_ROUTE_SIGMA]);
    const float w_sigma = -0.5f * (h[JP_ROUTE_W][JP_ROUTE_SIGMA] + next * h[JP_ROUTE_W_BEFORE][JP_ROUTE_SIGMA]);
    const float sigma_sigma = 0.25f * (h[JP_ROUTE_SIGMA][JP_ROUTE_SIGMA] + barrier->sigma_sigma + carried->sigma_sigma);
    const float v_energy = terms->v + carried->v;
    const float w_energy = terms->w + carried->w;
    const float v = v_energy + barrier->v;
    const float w = w_energy + barrier->w;
    const float sigma = terms->sigma + barrier->sigma + carried->sigma;
    const float v_curvature = v_energy + barrier->v_price;
    const float w_curvature = w_energy + barrier->w_price;

    const float arc_v = vv * leg->v_arc + vw * leg->pace + v_sigma;
    const float arc_w = vw * leg->v_arc + ww * leg->pace + w_sigma;
    const float pace_v = vv * leg->v_pace + vw * leg->arc;
    const float pace_w = vw * leg->v_pace + ww * leg->arc;

    *system = (struct equations){
        .block = {leg->v_arc * (arc_v + v_sigma) + leg->pace * (arc_w + w_sigma) + sigma_sigma +
                      v_curvature * leg->v_arc_arc,
                  leg->v_pace * arc_v + leg->arc * arc_w + v_curvature * leg->v_arc_pace + w_curvature,
                  leg->v_pace * pace_v + leg->arc * pace_w + barrier->pace_pace},
        .right = {0.5f * sigma - leg->v_arc * v - leg->pace * w,
                  -(leg->v_pace * v + leg->arc * w + terms->pace + barrier->pace)},
    };
}

/* The second derivatives by this leg's (arc, pace), rows, and those of the leg before, columns. */
static void couple(const struct jp_route *route, unsigned k, float sigma_sigma, float coupling[2][2])
{
    const float(*h)[5] = route->internal.hessian;
    const struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
    const struct jp_route_leg_internal *before = jp_route_leg_at(route, k - 1U);
    const float by[2][3] = {{before->v_arc, before->pace, -0.5f}, {before->v_pace, before->arc, 0.0f}};

    for (unsigned j = 0; j < 2U; j++) {
        const float v = h[JP_ROUTE_V][JP_ROUTE_V_BEFORE] * by[j][0] + h[JP_ROUTE_V][JP_ROUTE_W_BEFORE] * by[j][1] +
                        h[JP_ROUTE_V][JP_ROUTE_SIGMA] * by[j][2];
        const float w = h[JP_ROUTE_W][JP_ROUTE_V_BEFORE] * by[j][0] + h[JP_ROUTE_W][JP_ROUTE_W_BEFORE] * by[j][1] +
                        h[JP_ROUTE_W][JP_ROUTE_SIGMA] * by[j][2];
        const float sigma = h[JP_ROUTE_SIGMA][JP_ROUTE_V_BEFORE] * by[j][0] +
                            h[JP_ROUTE_SIGMA][JP_ROUTE_W_BEFORE] * by[j][1] + sigma_sigma * by[j][2];

        coupling[0][j] = leg->v_arc * v + leg->pace * w - 0.5f * sigma;
        coupling[1][j] = leg->v_pace * v + leg->arc * w;
    }
}

/* The pivot made positive: its magnitude, at least PIVOT_MIN of the one before elimination. So the step descends. */
static float pivot_of(float pivot, float original)
{
    const float least = PIVOT_MIN * jp_plane_magnitude(original) + FLT_MIN;
    const float size = jp_plane_magnitude(pivot);

    return size > least ? size : least;
}

/* The inverse of a 2 × 2 block, made positive definite. */
static void invert(const float original[3], const float block[3], float inverse[3])
{
    const float arc = 1.0f / pivot_of(block[0], original[0]);
    const float ratio = block[1] * arc;
    const float pace = 1.0f / pivot_of(block[2] - ratio * block[1], original[2]);

    inverse[2] = pace;
    inverse[1] = -ratio * pace;
    inverse[0] = arc + ratio * ratio * pace;
}

/* Eliminates a leg: step = y − G · (step of the leg before). */
static void eliminate(struct jp_route_leg_internal *leg, const struct equations *system, const float coupling[2][2],
                      struct carried *carried)
{
    float inverse[3];
    float block[3];
    float right[2];

    for (unsigned i = 0; i < 3U; i++) {
        block[i] = system->block[i] - carried->block[i];
    }
    right[0] = system->right[0] - carried->right[0];
    right[1] = system->right[1] - carried->right[1];
    invert(system->block, block, inverse);
    leg->step[0] = inverse[0] * right[0] + inverse[1] * right[1];
    leg->step[1] = inverse[1] * right[0] + inverse[2] * right[1];
    for (unsigned j = 0; j < 2U; j++) {
        leg->coupling[0][j] = inverse[0] * coupling[0][j] + inverse[1] * coupling[1][j];
        leg->coupling[1][j] = inverse[1] * coupling[0][j] + inverse[2] * coupling[1][j];
    }
    carried->block[0] = coupling[0][0] * leg->coupling[0][0] + coupling[1][0] * leg->coupling[1][0];
    carried->block[1] = coupling[0][0] * leg->coupling[0][1] + coupling[1][0] * leg->coupling[1][1];
    carried->block[2] = coupling[0][1] * leg->coupling[0][1] + coupling[1][1] * leg->coupling[1][1];
    carried->right[0] = coupling[0][0] * leg->step[0] + coupling[1][0] * leg->step[1];
    carried->right[1] = coupling[0][1] * leg->step[0] + coupling[1][1] * leg->step[1];
}

static void backward(struct jp_route *route, const struct bounds *bounds)
{
    struct carried carried = {.next = false};

    unsigned k = route->length;

    while (k > 0U) {
        k--;

        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
        const struct leg_terms terms = leg_terms(route, k, &carried);
        const struct barrier barrier = barrier_of(leg, bounds, route->internal.barrier);
        struct equations system;
        float coupling[2][2] = {{0.0f, 0.0f}, {0.0f, 0.0f}};

        write_system(route, leg, &terms, &barrier, &carried, &system);
        add_steady(route->config.model, leg, &system);
        carried.sigma_sigma = route->internal.hessian[JP_ROUTE_SIGMA][JP_ROUTE_SIGMA] + barrier.sigma_sigma;
        if (k > 0U) {
            couple(route, k, carried.sigma_sigma, coupling);
        }
        eliminate(leg, &system, coupling, &carried);
        carried.v = terms.v_before;
        carried.w = terms.w_before;
        carried.sigma = terms.sigma + barrier.sigma;
        carried.next = true;
    }
}

/* Changes of the slacks by the step of a leg and of the arc before it. */
static void limit_steps(const struct jp_route_leg_internal *leg, const struct bounds *bounds, float arc_step_before,
                        float change[JP_ROUTE_LIMITS])
{
    float distance[JP_ROUTE_LIMITS];
    const float w = (leg->pace * leg->step[0] + leg->arc * leg->step[1]) / bounds->w;
    const float sigma = -0.5f * (arc_step_before + leg->step[0]) / bounds->sigma;

    distances(leg, bounds, distance);
    change[SHORTEST] = -leg->step[1] / leg->pace_max;
    change[SPEED] = -(leg->v_arc * leg->step[0] + leg->v_pace * leg->step[1]) / bounds->v;
    change[TURN_LEFT] = -w;
    change[TURN_RIGHT] = w;
    change[SIGMA_LEFT] = -sigma;
    change[SIGMA_RIGHT] = sigma;
    for (unsigned i = 0; i < JP_ROUTE_LIMITS; i++) {
        change[i] += distance[i] - leg->slack[i];
    }
}

/* The largest share of a step that stays within `room`. */
static float shorter(float share, float room, float step)
{
    return share * step > room ? room / step : share;
}

struct shares {
    float primal;
    float dual;
};

static float price_step(const struct jp_route_leg_internal *leg, unsigned i, float barrier, float change)
{
    return (barrier - leg->price[i] * change) / leg->slack[i] - leg->price[i];
}

/* Forward substitution from the first leg to the last: the steps, and the share of all that the limits allow. */
static struct shares forward(struct jp_route *route, const struct bounds *bounds)
{
    struct shares shares = {1.0f, 1.0f};
    float arc_step = 0.0f;
    float pace_step = 0.0f;

    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
        float change[JP_ROUTE_LIMITS];

        leg->step[0] -= leg->coupling[0][0] * arc_step + leg->coupling[0][1] * pace_step;
        leg->step[1] -= leg->coupling[1][0] * arc_step + leg->coupling[1][1] * pace_step;
        limit_steps(leg, bounds, arc_step, change);
        arc_step = leg->step[0];
        pace_step = leg->step[1];
        shares.primal = shorter(shares.primal, ARC_CHANGE_MAX, jp_plane_magnitude(arc_step));
        shares.primal = shorter(shares.primal, PACE_FALL_MAX * leg->pace, -pace_step);
        for (unsigned i = 0; i < JP_ROUTE_LIMITS; i++) {
            shares.primal = shorter(shares.primal, BOUNDARY_SHARE * leg->slack[i], -change[i]);
            shares.dual = shorter(shares.dual, BOUNDARY_SHARE * leg->price[i],
                                  -price_step(leg, i, route->internal.barrier, change[i]));
        }
    }
    return shares;
}

/* x limited to [low, high]. What is not a number, because models that are not physical let steps grow without bound,
 * becomes `low`. */
static float kept_between(float x, float low, float high)
{
    if (x > low) {
        return x < high ? x : high;
    }
    return low;
}

static void take(struct jp_route *route, const struct bounds *bounds, const struct shares *shares)
{
    const float arc_max = (float)JP_ARC_ANGLE_MAX * (1.0f / Q24_ONE);
    const float pace_min = Q16_ONE / (float)route->config.limits->duration;
    float arc_step = 0.0f;

    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
        float change[JP_ROUTE_LIMITS];

        limit_steps(leg, bounds, arc_step, change);
        arc_step = leg->step[0];
        for (unsigned i = 0; i < JP_ROUTE_LIMITS; i++) {
            leg->price[i] += shares->dual * price_step(leg, i, route->internal.barrier, change[i]);
            leg->slack[i] += shares->primal * change[i];
        }
        leg->arc = kept_between(leg->arc + shares->primal * leg->step[0], -arc_max, arc_max);
        leg->pace = kept_between(leg->pace + shares->primal * leg->step[1], pace_min, leg->pace_max);
    }
}

void jp_route_step(struct jp_route *route)
{
    const struct bounds bounds = bounds_of(route->config.limits);

    backward(route, &bounds);

    const struct shares shares = forward(route, &bounds);

    take(route, &bounds, &shares);
    jp_route_evaluate(route);
    route->internal.barrier *= BARRIER_FALL;
    route->internal.barrier =
        route->internal.barrier > route->internal.barrier_min ? route->internal.barrier : route->internal.barrier_min;
}
