#include "src/trajectory/route_legs.h"

#include <stddef.h>

#include "src/base/plane.h"

#define Q16_ONE 65536.0f
#define Q24_ONE 16777216.0f

#define LN_2   0.693147181f
#define TWO_PI 6.28318531f

/* After so many halvings a mode has decayed. */
#define HALVINGS_MAX 24.0f

static float from_q16(jp_q16 x)
{
    return (float)x * (1.0f / Q16_ONE);
}

static float from_q24(jp_q24 x)
{
    return (float)x * (1.0f / Q24_ONE);
}

/* The settled energy */

/* The product of two linear forms of (v, w, σ, v before, w before), times a factor, to the Hessian. */
static void add_product(float hessian[5][5], const float left[5], const float right[5], float factor)
{
    for (unsigned i = 0; i < 5U; i++) {
        for (unsigned j = 0; j < 5U; j++) {
            hessian[i][j] += factor * (left[i] * right[j] + left[j] * right[i]);
        }
    }
}

void jp_route_hessian(const struct jp_energy_model *model, float hessian[5][5])
{
    static const float step[3][5] = {
        {1.0f, 0.0f, 0.0f, -1.0f, 0.0f}, {0.0f, 1.0f, 0.0f, 0.0f, -1.0f}, {0.0f, 0.0f, 1.0f, 0.0f, 0.0f}};
    /* a1…a6: which steps they multiply. */
    static const uint8_t factors[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    const float cv = from_q16(model->voltage_per_speed);
    const float cw = from_q16(model->voltage_per_turn_rate);
    const float left[5] = {0.0f, 0.0f, 0.0f, cv, -cw};
    const float right[5] = {0.0f, 0.0f, 0.0f, cv, cw};
    const float power = from_q16(model->a[12]) / from_q16(model->motor_resistance);
    const float settling = from_q16(model->settling_time);

    for (unsigned i = 0; i < 5U; i++) {
        for (unsigned j = 0; j < 5U; j++) {
            hessian[i][j] = 0.0f;
        }
    }
    for (unsigned i = 0; i < 6U; i++) {
        add_product(hessian, step[factors[i][0]], step[factors[i][1]], from_q16(model->a[i]));
    }
    for (unsigned i = 0; i < 3U; i++) {
        add_product(hessian, left, step[i], from_q16(model->a[6U + i]));
        add_product(hessian, right, step[i], from_q16(model->a[9U + i]));
    }
    add_product(hessian, left, left, power);
    add_product(hessian, right, right, power);
    hessian[JP_ROUTE_V][JP_ROUTE_V] -= 2.0f * from_q16(model->b[0]) * settling;
    hessian[JP_ROUTE_W][JP_ROUTE_W] -= 2.0f * from_q16(model->b[1]) * settling;
}

/* Geometry: L = d f(γ) with f = (γ/2)/sin(γ/2). */

struct stretch {
    float f;
    float arc;     /* df/dγ */
    float arc_arc; /* d²f/dγ² */
};

/* By the series of sin(h)/h in t = h² = γ²/4; within 2e-5 of f up to JP_ARC_ANGLE_MAX. */
static struct stretch stretch_of(float arc)
{
    const float t = 0.25f * arc * arc;
    const float sinc =
        1.0f +
        t * (-1.0f / 6.0f +
             t * (1.0f / 120.0f + t * (-1.0f / 5040.0f + t * (1.0f / 362880.0f + t * (-1.0f / 39916800.0f +
                                                                                      t * (1.0f / 6227020800.0f))))));
    const float slope =
        -1.0f / 6.0f +
        t * (2.0f / 120.0f +
             t * (-3.0f / 5040.0f + t * (4.0f / 362880.0f + t * (-5.0f / 39916800.0f + t * (6.0f / 6227020800.0f)))));
    const float bend =
        2.0f / 120.0f +
        t * (-6.0f / 5040.0f + t * (12.0f / 362880.0f + t * (-20.0f / 39916800.0f + t * (30.0f / 6227020800.0f))));
    const float f = 1.0f / sinc;
    const float by_t = -slope * f * f;
    const float by_t_t = (2.0f * slope * slope * f - bend) * f * f;

    return (struct stretch){f, by_t * 0.5f * arc, by_t_t * t + 0.5f * by_t};
}

static void evaluate_leg(struct jp_route_leg_internal *leg, float arc_before)
{
    const struct stretch stretch = stretch_of(leg->arc);

    leg->v_pace = leg->chord * stretch.f;
    leg->v_arc_pace = leg->chord * stretch.arc;
    leg->v_arc_arc = leg->chord * stretch.arc_arc * leg->pace;
    leg->v_arc = leg->v_arc_pace * leg->pace;
    leg->v = leg->v_pace * leg->pace;
    leg->w = leg->arc * leg->pace;
    leg->sigma = leg->turn - 0.5f * (arc_before + leg->arc);
}

/* Transients */

/* 2^−x for 0 <= x < HALVINGS_MAX, within 1e-6 of it. */
static float halvings(float x)
{
    const uint32_t whole = (uint32_t)x;
    const float part = (float)whole - x;
    const float power =
        1.0f + part * (0.693147181f + part * (0.240226507f + part * (0.0555041087f +
                                                                     part * (0.00961812911f + part * 0.00133335581f))));

    return power / (float)(1U << whole);
}

/* (cos, sin) of a mode's turn in `time`, times its decay; a real mode does not turn. */
struct phasor {
    float real;
    float imaginary;
};

static struct phasor phasor_of(const struct jp_mode *mode, float time)
{
    const float decayed = from_q24(mode->decay) * time;

    if (!(decayed < HALVINGS_MAX)) {
        return (struct phasor){0.0f, 0.0f};
    }

    const float size = halvings(decayed);

    if (mode->frequency == 0) {
        return (struct phasor){size, 0.0f};
    }

    /* At most 16 384 s. */
    const jp_angle angle = (jp_angle)(uint64_t)(jp_multiply(mode->frequency, (int32_t)(time * Q16_ONE)) >> 8);

    return (struct phasor){size * ((float)jp_cos(angle) * 0x1p-31f), size * ((float)jp_sin(angle) * 0x1p-31f)};
}

/* A pair takes two components, a real mode one. */
static unsigned components(const struct jp_mode *mode)
{
    return mode->frequency == 0 ? 1U : 2U;
}

/* m ← Φ(T) (m + j₀ Δ₀ + j₁ Δ₁). */
static void propagate(const struct jp_axis_modes *axis, float step_0, float step_1, float time,
                      const float before[JP_AXIS_MODES], float after[JP_AXIS_MODES])
{
    for (unsigned i = 0; i < axis->count; i += components(&axis->mode[i])) {
        const struct phasor p = phasor_of(&axis->mode[i], time);
        const float m = before[i] + from_q16(axis->step[0][i]) * step_0 + from_q16(axis->step[1][i]) * step_1;

        after[i] = p.real * m;
        if (axis->mode[i].frequency != 0) {
            const float n =
                before[i + 1U] + from_q16(axis->step[0][i + 1U]) * step_0 + from_q16(axis->step[1][i + 1U]) * step_1;

            after[i] -= p.imaginary * n;
            after[i + 1U] = p.imaginary * m + p.real * n;
        }
    }
}

struct leg_motion {
    float v;
    float w;
};

static struct leg_motion motion_before(const struct jp_route *route, unsigned k)
{
    if (k > 0U) {
        return (struct leg_motion){jp_route_leg_at(route, k - 1U)->v, jp_route_leg_at(route, k - 1U)->w};
    }
    return (struct leg_motion){from_q24(route->internal.before.motion.speed),
                               from_q24(route->internal.before.motion.turn_rate)};
}

static void start_transient(const jp_q16 stored[JP_AXIS_MODES], float transient[JP_AXIS_MODES])
{
    for (unsigned i = 0; i < JP_AXIS_MODES; i++) {
        transient[i] = from_q16(stored[i]);
    }
}

/* What is left when leg k begins. */
static void transient_before(const struct jp_route *route, unsigned k, float travel[JP_AXIS_MODES],
                             float yaw[JP_AXIS_MODES])
{
    if (k == 0U) {
        start_transient(route->internal.before.transient.travel, travel);
        start_transient(route->internal.before.transient.yaw, yaw);
        return;
    }
    for (unsigned i = 0; i < JP_AXIS_MODES; i++) {
        travel[i] = jp_route_leg_at(route, k - 1U)->travel[i];
        yaw[i] = jp_route_leg_at(route, k - 1U)->yaw[i];
    }
}

static void hand_on(const struct jp_route *route, unsigned k)
{
    const struct jp_horizon *horizon = route->config.horizon;
    struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
    const struct leg_motion before = motion_before(route, k);
    float travel[JP_AXIS_MODES];
    float yaw[JP_AXIS_MODES];

    transient_before(route, k, travel, yaw);
    propagate(&horizon->travel, leg->v - before.v, 0.0f, 1.0f / leg->pace, travel, leg->travel);
    propagate(&horizon->yaw, leg->w - before.w, leg->sigma, 1.0f / leg->pace, yaw, leg->yaw);
}

void jp_route_evaluate(struct jp_route *route)
{
    float arc_before = 0.0f;

    for (unsigned k = 0; k < route->length; k++) {
        struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);

        evaluate_leg(leg, arc_before);
        arc_before = leg->arc;
        if (route->config.horizon != NULL) {
            hand_on(route, k);
        }
    }
}

/* Adjoint of propagate() for the mode at component i: λ ← Φ(T)ᵀ λ; returns λ·dm/dT. */
static float turn_back(const struct jp_mode *mode, float time, const float after[2], float adjoint[2])
{
    const struct phasor p = phasor_of(mode, time);
    const float decay = from_q24(mode->decay) * LN_2;
    const float first = adjoint[0];
    float slope = -decay * after[0] * first;

    adjoint[0] = p.real * first;
    if (mode->frequency != 0) {
        const float turn = from_q24(mode->frequency) * TWO_PI;
        const float second = adjoint[1];

        slope += turn * (after[0] * second - after[1] * first) - decay * after[1] * second;
        adjoint[0] += p.imaginary * second;
        adjoint[1] = p.real * second - p.imaginary * first;
    }
    return slope;
}

/* Gradient of the energy of all later legs over one axis: dE/dT and dE/dΔ. */
struct axis_gradient {
    float time;
    float step[2];
};

/* Replaces the adjoint of the segment's end by that of its start. */
static struct axis_gradient hand_axis_back(const struct jp_axis_modes *axis, float step_0, float step_1, float time,
                                           const float before[JP_AXIS_MODES], const float after[JP_AXIS_MODES],
                                           float adjoint[JP_AXIS_MODES])
{
    struct axis_gradient gradient = {0.0f, {0.0f, 0.0f}};

    for (unsigned i = 0; i < axis->count; i += components(&axis->mode[i])) {
        gradient.time += turn_back(&axis->mode[i], time, &after[i], &adjoint[i]);
    }
    for (unsigned i = 0; i < axis->count; i++) {
        /* A step acts on the transient by g and, as it changes the steady voltage, by h. */
        const float cross_0 = from_q16(axis->cross[0][i]) + from_q16(axis->steady[i]);
        const float cross_1 = from_q16(axis->cross[1][i]);

        gradient.step[0] += from_q16(axis->step[0][i]) * adjoint[i] + cross_0 * before[i];
        gradient.step[1] += from_q16(axis->step[1][i]) * adjoint[i] + cross_1 * before[i];
        adjoint[i] += cross_0 * step_0 + cross_1 * step_1;
    }
    return gradient;
}

void jp_route_hand_back(const struct jp_route *route, unsigned k, struct jp_route_adjoint *adjoint,
                        struct jp_route_handed *handed)
{
    const struct jp_horizon *horizon = route->config.horizon;
    const struct jp_route_leg_internal *leg = jp_route_leg_at(route, k);
    const struct leg_motion before = motion_before(route, k);
    const float time = 1.0f / leg->pace;
    float travel[JP_AXIS_MODES];
    float yaw[JP_AXIS_MODES];

    transient_before(route, k, travel, yaw);

    const struct axis_gradient by_travel =
        hand_axis_back(&horizon->travel, leg->v - before.v, 0.0f, time, travel, leg->travel, adjoint->travel);
    const struct axis_gradient by_yaw =
        hand_axis_back(&horizon->yaw, leg->w - before.w, leg->sigma, time, yaw, leg->yaw, adjoint->yaw);

    *handed = (struct jp_route_handed){.pace = -(by_travel.time + by_yaw.time) * time * time,
                                       .v = by_travel.step[0],
                                       .w = by_yaw.step[0],
                                       .sigma = by_yaw.step[1]};
}
