#include <joulepath/segment.h>

#include "energy_terms.h"

/*
 * Scaled problem. With Tmin = max(Ts, JP_SEGMENT_DURATION_MIN, d/vmax), half the arc angle h = π x and the shape
 * r = h/sin h of the arc
 *
 *   ξ = Tmin/T,  v = (16 d/Tmin) r′ ξ,  r′ = r/16,  w = (2π/Tmin) x ξ,  σ = π s,  s = β/π − x
 *
 * every unknown is a fraction below 1, x and s are the bits of a binary angle, and E less its constant is
 *
 *   vv v′² + vw v′w′ + ww w′² + (vs v′ + ws w′) s + ss s² + lv v′ + lw w′ + ls s + (fv r′² + fw x²) ξ + P/ξ
 *
 * with v′ = r′ξ, w′ = xξ and thirteen numbers in J, which share one power of two so that the largest has
 * COEFFICIENT_BITS.
 */
#define COEFFICIENT_BITS 27
#define KINK_MARGIN      1024 /* of x: outside the kink in spite of rounding */
#define XI_ONE           ((int32_t)1 << 30)
#define XI_BITS          30
#define HALF_ARC_MAX     ((int32_t)1932735283) /* 162° as a binary angle */
#define TWO_PI           JP_Q24(6.283185307179586)
#define PI_Q29           ((int32_t)1686629713)
#define SQUARE_MAX       ((int64_t)1739461755) /* 0.81 in Q31 */
#define FOUR_PI_Q27      ((int32_t)1686629713)

enum { EVALUATIONS_PER_INTERVAL = JP_SEGMENT_EVALUATIONS / 2, INNER_STEPS_MAX = 8 };

struct problem {
    int32_t vv2, vw, ww2, vs, ws, ss2; /* quadratic; vv, ww and ss doubled */
    int32_t lv, lw, ls;                /* linear */
    int32_t fv2, fw2;                  /* friction, doubled */
    int32_t power;                     /* P */
    int32_t bearing;                   /* β as a binary angle */
    int32_t speed_limit;               /* vmax Tmin/d in Q27, saturated */
    int32_t turn_rate_limit;           /* wmax Tmin/2π in Q31, saturated */
    int32_t xi_min;                    /* Tmin/Tmax in Q30 */
    unsigned power_shift;              /* left shift that brings P to 29 bits */
};

enum limit { LIMIT_NONE, LIMIT_SPEED, LIMIT_TURN_RATE };

/* J*(x) = min over ξ, and its slope by the envelope theorem. */
struct evaluation {
    int32_t x;
    int32_t xi;           /* Q30 */
    int32_t energy;       /* J less a constant, in the scale of the problem */
    int32_t slope;        /* dJ/dx / 16, saturated */
    int32_t slope_inside; /* the same where the limit does not act */
    int32_t idle;         /* P/ξ */
    enum limit limit;
};

/* The arc at x. */
struct arc {
    int32_t square;  /* x² in Q31 */
    int32_t sinc;    /* 1/r in Q29 */
    int32_t shape;   /* r′ in Q31 */
    int32_t stretch; /* (dr/dx)/r in Q27 */
};

static int32_t multiply_high(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 32);
}

static int32_t multiply31(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 31);
}

static uint32_t magnitude(int32_t a)
{
    return a < 0 ? 0U - (uint32_t)a : (uint32_t)a;
}

static unsigned leading_zeros(uint32_t a)
{
#if defined(__GNUC__)
    return (unsigned)__builtin_clz(a);
#else
    unsigned zeros = 0;
    for (; a < ((uint32_t)1 << 31); a <<= 1) {
        zeros++;
    }
    return zeros;
#endif
}

/* 2³⁰ / (a 2^zeros/2³²) for a > 0: the reciprocal of the normalised mantissa, 1…2 in Q30, to 2⁻²⁸. */
static uint32_t reciprocal(uint32_t a, unsigned *zeros)
{
    *zeros = leading_zeros(a);
    uint32_t mantissa = a << *zeros;
    uint32_t guess = UINT32_MAX / ((mantissa >> 16) + 1U);                                                   /* Q16 */
    int32_t error = (int32_t)(((int64_t)((uint64_t)1 << 48) - (int64_t)((uint64_t)mantissa * guess)) >> 18); /* Q30 */
    return (guess << 14) + (uint32_t)(((uint64_t)guess * (uint32_t)error) >> 16);
}

/* a/b in Q30 for 0 <= a <= b, b > 0. */
static int32_t fraction(uint32_t a, uint32_t b)
{
    unsigned zeros;
    uint32_t inverse = reciprocal(b, &zeros);
    return (int32_t)(((uint64_t)(a << zeros) * inverse) >> 32);
}

/* sin(πx)/(πx) in Q29 and its derivative with respect to x²: minimax polynomials, 6·10⁻⁹ of the value. With x² in
 * Q31 each Horner step drops one fraction bit. */
static int32_t sinc(int32_t square, int32_t *derivative)
{
    static const int32_t c[] = {4548457, -40058541, 224556901, -819267988, 1743203416, -1766234504};
    static const int32_t d[] = {13645372, -100146353, 449113802, -1228901982, 1743203416, -883117252};
    int32_t value = c[0];
    int32_t slope = d[0];
    for (int i = 1; i < 6; i++) {
        value = c[i] + multiply_high(value, square);
        slope = d[i] + multiply_high(slope, square);
    }
    *derivative = slope;
    return ((int32_t)1 << 29) + multiply_high(value, square);
}

static void arc_at(int32_t x, struct arc *arc)
{
    int32_t derivative;
    arc->square = multiply31(x, x);
    arc->sinc = sinc(arc->square, &derivative);
    unsigned zeros;
    uint32_t inverse = reciprocal((uint32_t)arc->sinc, &zeros);
    arc->shape = (int32_t)(inverse >> (6 - zeros));
    arc->stretch = (int32_t)(((int64_t)multiply_high(x, -derivative) * arc->shape) >> 27);
}

/* Largest ξ within the limits, and the limit that sets it. */
static int32_t xi_limit(const struct problem *p, int32_t x, const struct arc *arc, enum limit *limit)
{
    int32_t xi = XI_ONE;
    *limit = LIMIT_NONE;
    int64_t by_speed = ((int64_t)p->speed_limit * arc->sinc) >> 26;
    if (by_speed < xi) {
        xi = (int32_t)by_speed;
        *limit = LIMIT_SPEED;
    }
    if (magnitude(x) > (uint32_t)p->turn_rate_limit) {
        int32_t by_turn_rate = fraction((uint32_t)p->turn_rate_limit, magnitude(x));
        if (by_turn_rate < xi) {
            xi = by_turn_rate;
            *limit = LIMIT_TURN_RATE;
        }
    }
    return xi > p->xi_min ? xi : p->xi_min; /* below it by rounding only */
}

static int32_t shift_signed(int32_t a, int shift)
{
    return shift >= 0 ? (int32_t)((uint32_t)a << shift) : a >> (shift < -31 ? 31 : -shift);
}

static int bits(int32_t a)
{
    return a == 0 ? 0 : 32 - (int)leading_zeros(magnitude(a));
}

/*
 * The ξ where a ξ³ + b ξ² = P, in Q30, at most 1, to about 2⁻¹⁵ of itself: E changes only to second order.
 *
 * Newton on P τ³ − b τ − a with τ = 1/ξ scaled by 2⁻ᵏ, so that the largest root is below 1. From above it converges
 * without overshoot; from anywhere else the first step leads above. Without a root the result has no meaning.
 */
static int32_t stationary(const struct problem *p, int32_t a, int32_t b, int32_t xi_guess)
{
    int shift = (int)p->power_shift;
    int from_b = (bits(b) + shift - 26) >> 1;
    int from_a = ((bits(a) + shift - 25) * 21846) >> 16;
    int k = from_a > from_b ? from_a : from_b;
    k = k < 0 ? 0 : k;
    int32_t power = (int32_t)((uint32_t)p->power << shift);
    a = shift_signed(a, shift - 3 * k);
    b = shift_signed(b, shift - 2 * k);
    uint32_t unit = (uint32_t)XI_ONE >> k;
    int32_t tau = xi_guess > 0 && unit < (uint32_t)xi_guess ? fraction(unit, (uint32_t)xi_guess) : XI_ONE;
    for (int i = 0; i < INNER_STEPS_MAX; i++) {
        int32_t square = (int32_t)(((int64_t)power * tau >> XI_BITS) * tau >> XI_BITS);
        int32_t numerator = 2 * (int32_t)((int64_t)square * tau >> XI_BITS) + a;
        int64_t denominator = (int64_t)3 * square - b;
        int32_t last = tau;
        if (numerator <= 0 || denominator <= 0) {
            tau = denominator <= 0 ? XI_ONE : 1;
        } else {
            tau = numerator >= denominator ? XI_ONE : fraction((uint32_t)numerator, (uint32_t)denominator);
        }
        if (magnitude(last - tau) <= (uint32_t)tau >> 7) {
            break;
        }
    }
    return unit < (uint32_t)tau ? fraction(unit, (uint32_t)tau) : XI_ONE;
}

/* J(ξ) at fixed x, less a constant. */
static int32_t energy_at_fixed_arc(const struct problem *p, int32_t a, int32_t b, int32_t xi)
{
    unsigned zeros;
    uint32_t inverse = reciprocal((uint32_t)xi, &zeros);
    int32_t idle = (int32_t)(((uint64_t)((uint32_t)p->power << zeros) * inverse) >> 32);
    int32_t slope = (int32_t)((int64_t)(a / 2) * xi >> XI_BITS) + b;
    return (int32_t)((int64_t)slope * xi >> XI_BITS) + idle;
}

/* The best ξ at x. */
static int32_t best_xi(const struct problem *p, int32_t x, int32_t s, const struct arc *arc, int32_t xi_guess,
                       enum limit *limit)
{
    int32_t r = arc->shape;
    int32_t rr = multiply31(r, r);
    int32_t rx = multiply31(r, x);
    int32_t a = (int32_t)(((int64_t)p->vv2 * rr + (int64_t)p->vw * rx * 2 + (int64_t)p->ww2 * arc->square) >> 31);
    int32_t b = (int32_t)(((int64_t)p->vs * multiply31(r, s) + (int64_t)p->ws * multiply31(x, s) + (int64_t)p->lv * r +
                           (int64_t)p->lw * x + (((int64_t)p->fv2 * rr + (int64_t)p->fw2 * arc->square) >> 1)) >>
                          31);
    int32_t high = xi_limit(p, x, arc, limit);
    int32_t slope = (int32_t)((int64_t)a * high >> XI_BITS) + b;
    slope = (int32_t)(((int64_t)slope * high >> XI_BITS) * high >> XI_BITS) - p->power;
    if (slope <= 0 && a >= 0) {
        return high;
    }
    int32_t xi = stationary(p, a, b, xi_guess);
    xi = jp_clamp32(xi, p->xi_min, high);
    if (slope <= 0 && energy_at_fixed_arc(p, a, b, high) <= energy_at_fixed_arc(p, a, b, xi)) {
        return high;
    }
    *limit = LIMIT_NONE;
    return xi;
}

static void evaluate(const struct problem *p, int32_t x, int32_t xi_guess, struct evaluation *e)
{
    struct arc arc;
    enum limit limit;
    arc_at(x, &arc);
    int32_t s = (int32_t)((uint32_t)p->bearing - (uint32_t)x);
    int32_t xi = best_xi(p, x, s, &arc, xi_guess, &limit);
    int32_t v = (int32_t)((int64_t)arc.shape * xi >> XI_BITS);
    int32_t w = (int32_t)((int64_t)x * xi >> XI_BITS);
    int32_t friction_v = multiply31(p->fv2, arc.shape);
    int32_t friction_w = multiply31(p->fw2, x);
    int32_t by_v =
        (int32_t)(((int64_t)p->vv2 * v + (int64_t)p->vw * w + (int64_t)p->vs * s) >> 31) + p->lv + friction_v;
    int32_t by_w =
        (int32_t)(((int64_t)p->ww2 * w + (int64_t)p->vw * v + (int64_t)p->ws * s) >> 31) + p->lw + friction_w;
    int32_t by_s = (int32_t)(((int64_t)p->ss2 * s + (int64_t)p->vs * v + (int64_t)p->ws * w) >> 31) + p->ls;
    unsigned zeros;
    uint32_t inverse = reciprocal((uint32_t)xi, &zeros);
    e->idle = (int32_t)(((uint64_t)((uint32_t)p->power << zeros) * inverse) >> 32);
    e->x = x;
    e->xi = xi;
    e->energy =
        (int32_t)(((int64_t)(by_v + p->lv) * v + (int64_t)(by_w + p->lw) * w + (int64_t)(by_s + p->ls) * s) >> 32) +
        e->idle;
    int32_t v_part = multiply31(by_v, v);
    int64_t slope = (int64_t)multiply31(v_part, arc.stretch) + ((int64_t)by_w * xi >> 34) - (by_s >> 4);
    e->limit = limit;
    e->slope_inside = jp_saturate32(slope);
    if (limit != LIMIT_NONE) {
        /* ξ dJ/dξ < 0 pushes against the limit, which moves with x. */
        int32_t push = v_part + (int32_t)(((int64_t)by_w * w) >> 31) -
                       (int32_t)(((int64_t)friction_v * v + (int64_t)friction_w * w) >> 32) - e->idle;
        if (limit == LIMIT_SPEED) {
            slope -= multiply31(push, arc.stretch);
        } else {
            inverse = reciprocal(magnitude(x), &zeros);
            int64_t by_turn_rate = ((int64_t)push * inverse) >> (35 - zeros);
            slope += x > 0 ? -by_turn_rate : by_turn_rate;
        }
    }
    e->slope = jp_saturate32(slope);
}

/* √a for a > 0, at most 1 too large. */
static uint32_t square_root32(uint32_t a)
{
    uint32_t root = (uint32_t)1 << ((32 - leading_zeros(a)) / 2);
    for (int i = 0; i < 4; i++) {
        root = (root + a / root) >> 1;
    }
    return root;
}

/*
 * The minimum of the cubic through two energies and slopes, as a fraction of the bracket in Q30: the root t of
 * 6k t² + (1 − 6k) t = secant, where k + ½ is the place at which the tangents meet.
 */
static uint32_t cubic_minimum(uint32_t secant, uint32_t tangents)
{
    int32_t k6 = 6 * (int32_t)(((int32_t)tangents - XI_ONE / 2) >> 4); /* Q26, within ±3 */
    int32_t linear = (XI_ONE >> 4) - k6;
    int64_t square = (int64_t)linear * linear + 4 * (int64_t)k6 * (int32_t)(secant >> 4); /* Q52, at most 16 */
    int64_t root = square > 0 ? (int64_t)square_root32((uint32_t)(square >> 26)) << 13 : 0;
    int64_t denominator = linear + root;
    if (denominator <= (int64_t)(secant >> 3)) {
        return XI_ONE;
    }
    return (uint32_t)fraction(secant >> 3, (uint32_t)denominator);
}

/* Where to look next between two evaluations of opposite slope, and what can still be gained there. */
static int32_t next_in_bracket(const struct evaluation *a, const struct evaluation *b, bool smooth, int32_t *floor)
{
    uint32_t width = (uint32_t)b->x - (uint32_t)a->x;
    uint32_t half = width >> 1;
    uint32_t down = magnitude(a->slope);
    uint32_t up = (uint32_t)b->slope;
    /* The tangents meet at a fraction of the width; no convex function lies below them. */
    uint64_t all = ((uint64_t)down + up) * half;
    int64_t part = (int64_t)((uint64_t)up * half) + ((int64_t)a->energy - b->energy) * ((int64_t)1 << 26);
    unsigned shift = (all >> 32) == 0 ? 0 : 32 - leading_zeros((uint32_t)(all >> 32));
    uint32_t whole = (uint32_t)(all >> shift) + 1U;
    part = part < 0 ? 0 : part >> shift;
    uint32_t meet = part >= whole ? (uint32_t)XI_ONE : (uint32_t)fraction((uint32_t)part, whole);
    uint32_t step = (uint32_t)(((uint64_t)width * meet) >> XI_BITS);
    *floor = jp_saturate32(a->energy - (int64_t)(((uint64_t)down * step) >> 27));
    if (smooth) {
        uint32_t secant = (uint32_t)fraction(down, down + up);
        step = (uint32_t)(((uint64_t)width * cubic_minimum(secant, meet)) >> XI_BITS);
    }
    uint32_t margin = width >> 8;
    step = step < margin ? margin : step > width - margin ? width - margin : step;
    return (int32_t)((uint32_t)a->x + step);
}

/* The |x| up to 0.9 where sinc x = value in Q29, from `x` on. */
static int32_t inverse_sinc(int32_t value, int32_t x)
{
    for (int i = 0; i < 4; i++) {
        int32_t derivative;
        int32_t excess = sinc(multiply31(x, x), &derivative) - value;
        uint32_t fall = magnitude(multiply_high(x, derivative)); /* -dsinc/dx in Q27 */
        uint32_t gap = magnitude(excess) >> 2;
        int32_t step = gap < fall ? fraction(gap, fall) : XI_ONE;
        int64_t next = excess > 0 ? (int64_t)x + 2 * (int64_t)step : (int64_t)x - 2 * (int64_t)step;
        x = next > HALF_ARC_MAX ? HALF_ARC_MAX : next < x / 2 ? x / 2 : (int32_t)next;
    }
    return x;
}

/* Where the limit that acts at `outer` but not at `inner` begins to act: J* has a kink there. */
static bool find_kink(const struct problem *p, const struct evaluation *inner, const struct evaluation *outer,
                      int32_t *x)
{
    int32_t size;
    if (inner->limit != LIMIT_NONE || outer->limit == LIMIT_NONE) {
        return false;
    }
    if (outer->limit == LIMIT_TURN_RATE) {
        uint32_t half = (uint32_t)p->turn_rate_limit >> 1;
        size = half < (uint32_t)inner->xi ? 2 * (fraction(half, (uint32_t)inner->xi) - 1) : INT32_MAX;
    } else {
        uint32_t half = (uint32_t)inner->xi >> 3;
        size = half < (uint32_t)p->speed_limit
                   ? inverse_sinc(fraction(half, (uint32_t)p->speed_limit) >> 1, (int32_t)magnitude(outer->x))
                   : 0;
    }
    *x = (outer->x < 0) ? -size - KINK_MARGIN : size + KINK_MARGIN;
    return true;
}

/* A first step from one evaluation by the curvature of σ² and of the arc's length. */
static uint32_t first_step(const struct problem *p, const struct evaluation *e)
{
    int64_t curvature = (int64_t)p->ss2 + 6 * (int64_t)e->idle;
    int64_t scaled = curvature >> 5;
    if (scaled <= 0 || scaled > INT32_MAX) {
        scaled = 1;
    }
    uint32_t slope = magnitude(e->slope) >> 1;
    if (slope >= (uint32_t)scaled) {
        return (uint32_t)1 << 31;
    }
    return (uint32_t)fraction(slope, (uint32_t)scaled) << 1;
}

/* A further step in the same direction: to a quarter beyond where the slopes lead, at most four times the last. */
static uint32_t next_step(uint32_t step, uint32_t last_slope, uint32_t slope)
{
    uint32_t longest = step < (1U << 29) ? 4 * step : 1U << 31;
    uint32_t change = last_slope > slope ? last_slope - slope : 0;
    if (slope / 3 >= change) {
        return longest;
    }
    uint32_t ahead =
        slope < change ? (uint32_t)(((uint64_t)step * (uint32_t)fraction(slope, change)) >> XI_BITS) : longest / 2;
    return ahead + ahead / 4;
}

/* Whether the minimum is at the kink just inside e; if it is further inside, e becomes its end. */
static bool settles_kink(struct evaluation *e)
{
    if ((e->slope < 0) != (e->slope_inside < 0)) {
        return true;
    }
    if ((e->slope > 0) == (e->x > 0)) {
        e->slope = e->slope_inside;
        e->limit = LIMIT_NONE;
    }
    return false;
}

/* The minimum over [low, high], where J* has one; *best keeps the best of all calls. */
static void search(const struct problem *p, int32_t low, int32_t high, struct evaluation *best)
{
    struct evaluation left = {.xi = 0};
    struct evaluation right = {.xi = 0};
    struct evaluation e = {.xi = 0};
    int32_t x = jp_clamp32(0, low, high);
    uint32_t step = 0;
    uint32_t last_slope = 0;
    uint32_t last_width = UINT32_MAX;
    bool kink_known = false;
    bool at_kink = false;
    for (int i = 0; i < EVALUATIONS_PER_INTERVAL; i++) {
        evaluate(p, x, e.xi, &e);
#ifdef EVAL_HOOK
        EVAL_HOOK;
#endif
        if (best->xi == 0 || e.energy < best->energy) {
            *best = e;
        }
        if (at_kink && settles_kink(&e)) {
            return;
        }
        if (e.slope == 0 || (e.slope < 0 && x == high) || (e.slope > 0 && x == low)) {
            return;
        }
        *(e.slope < 0 ? &left : &right) = e;
        at_kink = false;
        if (left.xi != 0 && right.xi != 0) {
            int32_t floor;
            if (!kink_known && (find_kink(p, &left, &right, &x) || find_kink(p, &right, &left, &x))) {
                kink_known = true;
                at_kink = x > left.x && x < right.x;
            }
            if (!at_kink) {
                uint32_t width = (uint32_t)right.x - (uint32_t)left.x;
                x = next_in_bracket(&left, &right, width < last_width, &floor);
                last_width = width - width / 4;
                if (best->energy - (int64_t)floor <= (best->idle >> 15) || right.x - (int64_t)left.x < 4) {
                    return;
                }
            }
        } else {
            step = i == 0 ? first_step(p, &e) : next_step(step, last_slope, magnitude(e.slope));
            last_slope = magnitude(e.slope);
            int64_t next = e.slope < 0 ? (int64_t)e.x + step : (int64_t)e.x - step;
            x = next > high ? high : next < low ? low : (int32_t)next;
        }
    }
}

static int64_t absolute64(int64_t a)
{
    return a < 0 ? -a : a;
}

/* How far right a must go to have COEFFICIENT_BITS. */
static unsigned excess_bits(uint64_t a)
{
    uint64_t high = a >> COEFFICIENT_BITS;
    if ((high >> 32) != 0) {
        return 64 - leading_zeros((uint32_t)(high >> 32));
    }
    return high == 0 ? 0 : 32 - leading_zeros((uint32_t)high);
}

/* d/Tmin and so on; d in Q22, Tmin in Q16. */
static void build(struct problem *p, const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                  const struct jp_motion *before, uint32_t distance, jp_q16 time_min)
{
    const jp_q16 *a = model->a;
    int32_t speed = (int32_t)(((uint64_t)distance << 21) / (uint32_t)time_min);   /* 16 d/Tmin in Q23 */
    int32_t turn_rate = (int32_t)(((uint64_t)TWO_PI << 16) / (uint32_t)time_min); /* Q24 */
    struct jp_voltage_terms voltage;
    jp_voltage_terms(model, before, &voltage);
    int32_t v = before->speed;
    int32_t w = before->turn_rate;
    int64_t transient_v = ((int64_t)a[0] * 65536 - (int64_t)model->b[0] * model->settling_time) >> 4;
    int64_t transient_w = ((int64_t)a[1] * 65536 - (int64_t)model->b[1] * model->settling_time) >> 4;
    int64_t term[12];
    term[0] = jp_term_scale(jp_term_scale(2 * transient_v, speed, 23), speed, 23);
    term[1] = jp_term_scale(jp_term_scale((int64_t)a[3] * 4096, speed, 23), turn_rate, 24);
    term[2] = jp_term_scale(jp_term_scale(2 * transient_w, turn_rate, 24), turn_rate, 24);
    term[3] = jp_term_scale(jp_term_scale((int64_t)a[4] * 4096, speed, 23), PI_Q29, 29);
    term[4] = jp_term_scale(jp_term_scale((int64_t)a[5] * 4096, turn_rate, 24), PI_Q29, 29);
    term[5] = jp_term_scale(jp_term_scale((int64_t)a[2] * 8192, PI_Q29, 29), PI_Q29, 29);
    term[6] = jp_term_scale(voltage.speed - (((int64_t)a[0] * 2 * v + (int64_t)a[3] * w) >> 12), speed, 23);
    term[7] = jp_term_scale(voltage.turn_rate - (((int64_t)a[1] * 2 * w + (int64_t)a[3] * v) >> 12), turn_rate, 24);
    term[8] = jp_term_scale(voltage.turn - (((int64_t)a[4] * v + (int64_t)a[5] * w) >> 12), PI_Q29, 29);
    term[9] =
        jp_term_scale(jp_term_scale(jp_term_scale((int64_t)model->b[0] << 13, speed, 23), time_min, 16), speed, 23);
    term[10] = jp_term_scale(jp_term_scale(jp_term_scale((int64_t)model->b[1] << 13, turn_rate, 24), time_min, 16),
                             turn_rate, 24);
    term[11] = ((int64_t)model->electronics_power * time_min) >> 4;
    int64_t all = ((int64_t)model->electronics_power * limits->duration) >> 4;
    for (int i = 0; i < 12; i++) {
        all |= absolute64(term[i]) >> (i == 0 || i == 2 || i == 5 || i == 9 || i == 10 ? 1 : 0);
    }
    unsigned shift = excess_bits((uint64_t)all);
    int32_t *out[12] = {&p->vv2, &p->vw, &p->ww2, &p->vs,  &p->ws,  &p->ss2,
                        &p->lv,  &p->lw, &p->ls,  &p->fv2, &p->fw2, &p->power};
    for (int i = 0; i < 12; i++) {
        *out[i] = (int32_t)(term[i] >> shift);
    }
    p->power = p->power < 1 ? 1 : p->power;
    p->power_shift = leading_zeros((uint32_t)p->power) - 3;
    p->speed_limit =
        speed == 0 ? INT32_MAX : jp_saturate32((int64_t)(((uint64_t)(uint32_t)limits->speed << 30) / (uint32_t)speed));
    p->turn_rate_limit = jp_saturate32((int64_t)(((uint64_t)(uint32_t)limits->turn_rate << 31) / (uint32_t)turn_rate));
    p->xi_min = (int32_t)(((uint64_t)(uint32_t)time_min << 30) / (uint32_t)limits->duration);
}

/* The largest |x| whose duration the limits allow: turn rate. */
static int32_t half_arc_by_turn_rate(const struct problem *p)
{
    uint64_t x = ((uint64_t)(uint32_t)p->turn_rate_limit << XI_BITS) / (uint32_t)p->xi_min;
    return x < (uint64_t)HALF_ARC_MAX ? (int32_t)x : HALF_ARC_MAX;
}

/*
 * The largest |x| whose duration the limits allow: speed, sinc x = ξmin/(vmax Tmin/d). sinc falls and is convex in x²,
 * so Newton from 0 stays on the feasible side.
 */
static int32_t half_arc_by_speed(const struct problem *p)
{
    uint64_t bound = ((uint64_t)(uint32_t)p->xi_min << 26) / (uint32_t)p->speed_limit + 1; /* Q29 */
    if (bound >= (uint64_t)1 << 29) {
        return 0;
    }
    int32_t square = 0;
    for (int i = 0; i < 5; i++) {
        int32_t derivative;
        int32_t excess = sinc(square, &derivative) - (int32_t)bound;
        if (excess <= 0) {
            break;
        }
        int64_t next = square + (((int64_t)fraction((uint32_t)excess, magnitude(derivative))) << 1);
        if (next >= SQUARE_MAX) {
            return HALF_ARC_MAX;
        }
        square = (int32_t)next;
    }
    return (int32_t)jp_square_root((uint64_t)(uint32_t)square << 31);
}

static jp_q16 ceiling_quotient(uint64_t numerator, uint32_t denominator)
{
    uint64_t quotient = (numerator + denominator - 1) / denominator;
    return quotient > INT32_MAX ? INT32_MAX : (jp_q16)quotient;
}

static jp_q24 arc_angle(int32_t x)
{
    return (jp_q24)(((int64_t)x * FOUR_PI_Q27 + ((int64_t)1 << 34)) >> 35);
}

/* The stored segment of an optimum; the duration is rounded so that no limit is passed. */
static void store(const struct jp_energy_model *model, const struct jp_segment_limits *limits, uint32_t distance,
                  jp_angle bearing, jp_q16 time_min, const struct evaluation *best, struct jp_segment *segment)
{
    struct arc arc;
    arc_at(best->x, &arc);
    uint64_t length = ((uint64_t)distance * (uint32_t)arc.shape) >> 27; /* Q22 */
    jp_q24 angle = arc_angle(best->x);
    jp_q16 duration = ceiling_quotient((uint64_t)(uint32_t)time_min << XI_BITS, (uint32_t)best->xi);
    if ((uint64_t)duration * (uint32_t)limits->speed < length << 18) {
        duration = ceiling_quotient(length << 18, (uint32_t)limits->speed);
    }
    if ((uint64_t)duration * (uint32_t)limits->turn_rate < (uint64_t)magnitude(angle) << 16) {
        duration = ceiling_quotient((uint64_t)magnitude(angle) << 16, (uint32_t)limits->turn_rate);
    }
    duration = jp_clamp32(duration, model->settling_time, limits->duration);
    jp_q24 speed = jp_divide((int64_t)(length << 18), duration);
    jp_q24 turn_rate = jp_divide((int64_t)angle * 65536, duration);
    *segment = (struct jp_segment){
        .command = {.motion = {.speed = jp_clamp32(speed, 0, limits->speed),
                               .turn_rate = jp_clamp32(turn_rate, -limits->turn_rate, limits->turn_rate)},
                    .turn = jp_clamp32(jp_angle_to_radians(bearing - (uint32_t)best->x), -limits->turn, limits->turn),
                    .duration = duration},
        .arc = angle,
        .length = (jp_q16)((length + 32) >> 6),
    };
}

static enum jp_status distance_between(const struct jp_point *from, const struct jp_point *to, int64_t *dx, int64_t *dy,
                                       uint32_t *distance)
{
    *dx = (int64_t)to->x - from->x;
    *dy = (int64_t)to->y - from->y;
    if (absolute64(*dx) > JP_SEGMENT_LENGTH_MAX || absolute64(*dy) > JP_SEGMENT_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    uint64_t square = (uint64_t)(*dx * *dx + *dy * *dy);
    if (square > (uint64_t)((int64_t)JP_SEGMENT_LENGTH_MAX * JP_SEGMENT_LENGTH_MAX)) {
        return JP_ERR_ARGUMENT;
    }
    if (square < (uint64_t)((int64_t)JP_SEGMENT_LENGTH_MIN * JP_SEGMENT_LENGTH_MIN)) {
        return JP_ERR_ZERO_LENGTH;
    }
    *distance = jp_square_root(square << 12);
    return JP_OK;
}

enum jp_status jp_segment_optimise(const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                                   const struct jp_motion *before, const struct jp_point *start, jp_angle heading,
                                   const struct jp_point *target, struct jp_segment *segment)
{
    if (!model || !limits || !before || !start || !target || !segment || !jp_motion_in_range(before)) {
        return JP_ERR_ARGUMENT;
    }
    int64_t dx;
    int64_t dy;
    uint32_t distance;
    enum jp_status status = distance_between(start, target, &dx, &dy, &distance);
    if (status != JP_OK) {
        return status;
    }
    jp_q16 time_min = ceiling_quotient((uint64_t)distance << 18, (uint32_t)limits->speed);
    time_min = time_min < model->settling_time ? model->settling_time : time_min;
    time_min = time_min < JP_SEGMENT_DURATION_MIN ? JP_SEGMENT_DURATION_MIN : time_min;
    if (time_min > limits->duration) {
        return JP_ERR_INFEASIBLE;
    }
    struct problem p;
    build(&p, model, limits, before, distance, time_min);
    jp_angle bearing = jp_atan2((int32_t)dy, (int32_t)dx) - heading;
    p.bearing = (int32_t)bearing;
    int32_t reach = half_arc_by_turn_rate(&p);
    int32_t by_speed = half_arc_by_speed(&p);
    reach = reach < by_speed ? reach : by_speed;
    uint32_t turn_angle = jp_angle_from_radians(limits->turn);
    int64_t turn = turn_angle > INT32_MAX ? INT32_MAX : turn_angle;
    turn = turn > 0 && turn < INT32_MAX ? turn - 1 : turn;
    struct evaluation best = {0};
    for (int side = 0; side < 2; side++) {
        int64_t centre = p.bearing;
        if (side == 1) {
            centre += centre > 0 ? -((int64_t)1 << 32) : (int64_t)1 << 32;
        }
        int64_t low = centre - turn;
        int64_t high = centre + turn;
        low = low < -reach ? -reach : low;
        high = high > reach ? reach : high;
        if (low <= high) {
            search(&p, (int32_t)low, (int32_t)high, &best);
        }
    }
    if (best.xi == 0) {
        return JP_ERR_INFEASIBLE;
    }
    struct jp_segment result;
    store(model, limits, distance, bearing, time_min, &best, &result);
    status = jp_energy_predict(model, before, &result.command, &result.energy);
    if (status == JP_OK && result.energy <= 0) {
        return JP_ERR_MODEL;
    }
    *segment = result;
    return status;
}

enum jp_status jp_segment_limits_check(const struct jp_segment_limits *limits, const struct jp_energy_model *model,
                                       const char **field)
{
    if (!limits || !model || !field) {
        return JP_ERR_ARGUMENT;
    }
    if (limits->speed <= 0 || limits->speed > JP_Q24(8)) {
        *field = "speed";
        return JP_ERR_CONFIG;
    }
    if (limits->turn_rate <= 0 || limits->turn_rate > JP_Q24(8)) {
        *field = "turn_rate";
        return JP_ERR_CONFIG;
    }
    if (limits->turn < 0 || limits->turn > JP_Q24(3.141592653589793)) {
        *field = "turn";
        return JP_ERR_CONFIG;
    }
    if (limits->duration < model->settling_time || limits->duration < JP_SEGMENT_DURATION_MIN ||
        limits->duration > JP_Q16(16384)) {
        *field = "duration";
        return JP_ERR_CONFIG;
    }
    return JP_OK;
}

enum jp_status jp_segment_end(const struct jp_segment *segment, const struct jp_point *start, jp_angle heading,
                              struct jp_point *end, jp_angle *end_heading)
{
    if (!segment || !start || !end || !end_heading) {
        return JP_ERR_ARGUMENT;
    }
    jp_angle turn = jp_angle_from_radians(segment->command.turn);
    jp_angle half = jp_angle_from_radians(segment->arc / 2);
    jp_angle direction = heading + turn + half;
    struct arc arc;
    int32_t x = jp_clamp32((int32_t)half, -HALF_ARC_MAX, HALF_ARC_MAX);
    arc_at(x, &arc);
    int64_t chord = ((int64_t)segment->length * arc.sinc) >> 21; /* Q24 */
    int64_t x_end = start->x + ((jp_term_scale(chord, jp_cos(direction), 31) + 128) >> 8);
    int64_t y_end = start->y + ((jp_term_scale(chord, jp_sin(direction), 31) + 128) >> 8);
    end->x = jp_saturate32(x_end);
    end->y = jp_saturate32(y_end);
    *end_heading = direction + half;
    return x_end == end->x && y_end == end->y ? JP_OK : JP_ERR_OVERFLOW;
}
