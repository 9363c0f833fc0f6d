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

#define XI_BITS 30
#define XI_ONE  ((int32_t)1 << XI_BITS)

#define TWO_PI         JP_Q24(6.283185307179586)
#define PI_Q29         ((int32_t)1686629713)
#define FOUR_PI_Q27    PI_Q29
#define INVERSE_PI_Q30 ((int32_t)341782638)

/* 162° as a binary angle, and sinc there. */
#define HALF_ARC_MAX         ((int32_t)1932735283)
#define SINC_ONE             ((int32_t)1 << 29)
#define SINC_AT_HALF_ARC_MAX ((int32_t)58675913)

/* Gains below these parts (2⁻ⁿ) of Ps T end the search: between tangents, at a limit, and without a limit, where one
 * evaluation more also gives the direction of a flat minimum. */
#define FLAT_SHIFT        14
#define GAIN_SHIFT        15
#define GAIN_SHIFT_SMOOTH 20

/* Of x: a point this far outside a kink is outside in spite of rounding. */
#define KINK_MARGIN 1024

enum { INNER_STEPS_MAX = 8 };

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

/* 1/ξ = mantissa 2^exponent, the mantissa 1…2 in Q30; 0 if unknown. */
struct inverse {
    uint32_t mantissa;
    int exponent;
};

/* J*(x) = min over ξ, and its slope by the envelope theorem. */
struct evaluation {
    int32_t x;
    int32_t xi;           /* Q30 */
    int32_t energy;       /* J less a constant, in the scale of the problem */
    int32_t slope;        /* dJ/dx / 16, saturated */
    int32_t slope_inside; /* the same where the limit does not act */
    int32_t idle;         /* P/ξ */
    struct inverse inverse;
    enum limit limit;
};

/* A search for the minimum over x: the ends of its bracket, which have ξ = 0 until they are found. */
struct search {
    struct evaluation left, right;
    int32_t low, high;
    uint32_t step, slope; /* of the last step down */
    uint32_t width_expected;
    bool flat;                          /* the tangents promised no gain */
    enum limit left_limit, right_limit; /* of the last bracket */
    enum limit inside;                  /* that acts inside the last kink */
    int32_t kink_xi;
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

/* a/b in Q31 for 0 <= a < b, to 2⁻²⁸, saturated. */
static int32_t fraction_q31(uint32_t a, uint32_t b)
{
    return jp_saturate32(2 * (int64_t)fraction(a, b));
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
    return SINC_ONE + multiply_high(value, square);
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
    return shift >= 0 ? (int32_t)((uint32_t)a << shift) : a >> (shift < -30 ? 30 : -shift);
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
static int32_t stationary(const struct problem *p, int32_t a, int32_t b, const struct inverse *guess)
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
    int32_t tau = XI_ONE;
    if (guess->mantissa != 0 && guess->exponent < k) {
        tau = (int32_t)(guess->mantissa >> (k - guess->exponent));
    }
    for (int i = 0; i < INNER_STEPS_MAX; i++) {
        int32_t square = (int32_t)(((int64_t)power * tau >> XI_BITS) * tau >> XI_BITS);
        int32_t numerator = 2 * (int32_t)((int64_t)square * tau >> XI_BITS) + a;
        int32_t denominator = 3 * square - b;
        int32_t last = tau;
        if (numerator <= 0 || denominator <= 0) {
            tau = denominator <= 0 ? XI_ONE : 1;
        } else {
            tau = numerator >= denominator ? XI_ONE : fraction((uint32_t)numerator, (uint32_t)denominator);
        }
        if (magnitude(last - tau) <= (uint32_t)tau >> 5) {
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
static int32_t best_xi(const struct problem *p, int32_t x, int32_t s, const struct arc *arc,
                       const struct inverse *guess, enum limit *limit)
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
    int32_t xi = stationary(p, a, b, guess);
    xi = jp_clamp32(xi, p->xi_min, high);
    if (slope <= 0 && energy_at_fixed_arc(p, a, b, high) <= energy_at_fixed_arc(p, a, b, xi)) {
        return high;
    }
    *limit = LIMIT_NONE;
    return xi;
}

/* `slope` at fixed ξ becomes the slope along a limit, ξ dJ/dξ = push < 0. */
static int32_t slope_on_limit(int32_t slope, int32_t push, enum limit limit, const struct arc *arc, int32_t x)
{
    if (limit == LIMIT_NONE) {
        return slope;
    }
    if (limit == LIMIT_SPEED) {
        return slope - multiply31(push, arc->stretch);
    }
    unsigned zeros;
    uint32_t inverse = reciprocal(magnitude(x) | 1U, &zeros);
    int64_t by_turn_rate = ((int64_t)push * inverse) >> (35 - zeros);
    return jp_saturate32(x > 0 ? slope - by_turn_rate : slope + by_turn_rate);
}

/* `inside` is the limit on the inner side of x, where x is a kink. Before the call *e holds an evaluation near by. */
static void evaluate(const struct problem *p, int32_t x, enum limit inside, struct evaluation *e)
{
    struct arc arc;
    enum limit limit;
    arc_at(x, &arc);
    int32_t s = (int32_t)((uint32_t)p->bearing - (uint32_t)x);
    int32_t xi = best_xi(p, x, s, &arc, &e->inverse, &limit);
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
    e->inverse.mantissa = reciprocal((uint32_t)xi, &zeros);
    e->inverse.exponent = (int)zeros - 2;
    e->idle = (int32_t)(((uint64_t)((uint32_t)p->power << zeros) * e->inverse.mantissa) >> 32);
    e->x = x;
    e->xi = xi;
    e->energy =
        (int32_t)(((int64_t)(by_v + p->lv) * v + (int64_t)(by_w + p->lw) * w + (int64_t)(by_s + p->ls) * s) >> 32) +
        e->idle;
    int32_t v_part = multiply31(by_v, v);
    int32_t slope = multiply31(v_part, arc.stretch) + (int32_t)((int64_t)by_w * xi >> 34) - (by_s >> 4);
    e->limit = limit;
    e->slope_inside = slope;
    if (limit != LIMIT_NONE) {
        int32_t push = v_part + (int32_t)(((int64_t)by_w * w) >> 31) -
                       (int32_t)(((int64_t)friction_v * v + (int64_t)friction_w * w) >> 32) - e->idle;
        e->slope_inside = slope_on_limit(slope, push, inside, &arc, x);
        slope = limit == inside ? e->slope_inside : slope_on_limit(slope, push, limit, &arc, x);
    }
    e->slope = slope;
}

/* √a for a > 0, at most 1 too large. */
static uint32_t square_root32(uint32_t a)
{
    uint32_t root = (uint32_t)1 << ((32 - leading_zeros(a)) / 2);
    for (int i = 0; i < 3; i++) {
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

/* Energy along a slope; twice what a parabola gains when the step leads to its minimum. */
static int64_t gain(uint32_t slope, uint32_t step)
{
    return (int64_t)(((uint64_t)slope * step) >> 27);
}

/* From the nearer end up to four times as far as the cubic's minimum, but not beyond where the tangents meet. */
static uint32_t overshoot(uint32_t cubic, uint32_t tangents, uint32_t width)
{
    if (cubic < width / 2) {
        uint32_t far = cubic < width / 8 ? 4 * cubic : width / 2;
        return far < tangents ? far : tangents;
    }
    uint32_t left = width - cubic;
    uint32_t far = width - (left < width / 8 ? 4 * left : width / 2);
    return far > tangents ? far : tangents;
}

/* Where in a bracket to look next: at the cubic's minimum, or after a step that narrowed it little, at the tangents'.
 * False if neither promises a gain on `best`. */
static bool step_inside(struct search *search, const struct evaluation *best, int32_t *x)
{
    const struct evaluation *a = &search->left;
    const struct evaluation *b = &search->right;
    uint32_t width = (uint32_t)b->x - (uint32_t)a->x;
    uint32_t half = width >> 1;
    uint32_t down = magnitude(a->slope);
    uint32_t up = (uint32_t)b->slope;
    uint64_t all = ((uint64_t)down + up) * half;
    int64_t part = (int64_t)((uint64_t)up * half) + ((int64_t)a->energy - b->energy) * ((int64_t)1 << 26);
    unsigned shift = (all >> 32) == 0 ? 0 : 32 - leading_zeros((uint32_t)(all >> 32));
    uint32_t whole = (uint32_t)(all >> shift);
    part >>= shift;
    bool convex = part > 0 && part < whole; /* the tangents meet between the ends */
    uint32_t meet = convex ? (uint32_t)fraction((uint32_t)part, whole) : XI_ONE / 2;
    uint32_t step = (uint32_t)(((uint64_t)width * meet) >> XI_BITS);
    int64_t floor = a->energy - gain(down, step);
    uint32_t cubic = cubic_minimum((uint32_t)fraction(down, down + up), meet);
    uint32_t cubic_step = (uint32_t)(((uint64_t)width * cubic) >> XI_BITS);

    bool smooth = a->limit == LIMIT_NONE && b->limit == LIMIT_NONE;
    bool flat = !smooth && best->energy - floor <= best->idle >> FLAT_SHIFT;
    int64_t least_gain = best->idle >> (smooth ? GAIN_SHIFT_SMOOTH : GAIN_SHIFT);
    if (convex && (floor > best->energy || (flat && search->flat) || gain(down, cubic_step) <= least_gain ||
                   gain(up, width - cubic_step) <= least_gain)) {
        return false;
    }
    search->flat = flat;
    if (width < search->width_expected) {
        step = cubic_step;
    } else {
        step = overshoot(cubic_step, step, width);
    }
    search->width_expected = width - width / 4;
    uint32_t margin = width >> 8;
    step = step < margin ? margin : step > width - margin ? width - margin : step;
    *x = (int32_t)((uint32_t)a->x + step);
    return true;
}

/* The x of 0…0.9 where sinc x = value in Q29: a series in 1 − sinc for x², then Newton. */
static int32_t inverse_sinc(int32_t value)
{
    int32_t u = (SINC_ONE - value) << 1; /* Q30 */
    u = u < 1 ? 1 : u;
    int32_t series = XI_ONE + multiply_high(u, 1288490189) + multiply_high(multiply_high(u, u) << 2, 1202590843);
    int32_t square = multiply_high(multiply_high(u, 1305455232) << 2, series) << 1;
    int32_t x = (int32_t)(square_root32((uint32_t)square + 1U) << 16);
    for (int i = 0; i < 2; i++) {
        int32_t derivative;
        int32_t excess = sinc(multiply31(x, x), &derivative) - value;
        uint32_t fall = magnitude(multiply_high(x, derivative)); /* -dsinc/dx in Q27 */
        uint32_t gap = magnitude(excess) >> 2;
        int32_t step = gap < fall ? fraction(gap, fall) >> 2 : 0; /* Q28 */
        x = excess > 0 ? x + step * 8 : x - step * 8;
    }
    return x < 0 ? 0 : x > HALF_ARC_MAX ? HALF_ARC_MAX : x;
}

/* The x up to ½ where x sinc x = chord in Q30. */
static int32_t half_arc_of_chord(int32_t chord)
{
    int32_t sine = chord >= INVERSE_PI_Q30 ? XI_ONE : (int32_t)((int64_t)chord * PI_Q29 >> 29);
    int32_t square = XI_ONE - (int32_t)((int64_t)sine * sine >> XI_BITS);
    int32_t x = (int32_t)jp_atan2(sine >> 1, (int32_t)(square_root32((uint32_t)square + 1U) << 14));
    int32_t derivative;
    int32_t s = multiply31(x, x);
    int32_t value = sinc(s, &derivative);
    int32_t slope = value + 4 * multiply_high(s, derivative); /* Q29 */
    int32_t missing = 2 * chord - multiply31(x, value) * 4;   /* Q31 */
    return slope > SINC_ONE / 16 ? x + (int32_t)((int64_t)missing * SINC_ONE / slope) : x;
}

/* Where another limit begins to act between `inner` and `outer`: J* has a kink there. *xi is the ξ at the kink. */
static bool find_kink(const struct problem *p, const struct evaluation *inner, const struct evaluation *outer,
                      int32_t *x, int32_t *xi)
{
    int32_t size = INT32_MAX;
    *xi = inner->xi;
    if (inner->limit == LIMIT_NONE && outer->limit == LIMIT_TURN_RATE) {
        uint32_t half = (uint32_t)p->turn_rate_limit >> 1;
        size = half < (uint32_t)inner->xi ? fraction_q31(half, (uint32_t)inner->xi) : INT32_MAX;
    } else if (inner->limit == LIMIT_NONE && outer->limit == LIMIT_SPEED) {
        uint32_t part = (uint32_t)inner->xi >> 3;
        size = part < (uint32_t)p->speed_limit ? inverse_sinc(fraction(part, (uint32_t)p->speed_limit) >> 1) : 0;
    } else if (inner->limit != LIMIT_NONE && outer->limit != inner->limit && outer->limit != LIMIT_NONE) {
        uint32_t part = (uint32_t)p->turn_rate_limit >> 4;
        size =
            part < (uint32_t)p->speed_limit ? half_arc_of_chord(fraction(part, (uint32_t)p->speed_limit)) : INT32_MAX;
        size = outer->limit == LIMIT_TURN_RATE ? size : INT32_MAX - size;
        *xi = p->turn_rate_limit < size ? fraction((uint32_t)p->turn_rate_limit, (uint32_t)size) : XI_ONE;
    }
    if (size >= HALF_ARC_MAX - KINK_MARGIN) {
        return false;
    }
    *x = outer->x < 0 ? -size - KINK_MARGIN : size + KINK_MARGIN;
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
    uint32_t ahead = (uint32_t)(((uint64_t)step * (uint32_t)fraction(slope >> 2, change)) >> (XI_BITS - 2));
    ahead += ahead / 4;
    return ahead < longest ? ahead : longest;
}

/* Whether the minimum is at the kink just inside e; if it is further inside, e becomes the end of its bracket. */
static bool settles_kink(const struct search *search, struct evaluation *e)
{
    if (magnitude(e->xi - search->kink_xi) > (uint32_t)search->kink_xi >> 14) {
        return false; /* another limit acts */
    }
    if ((e->slope < 0) != (e->slope_inside < 0)) {
        return true;
    }
    if ((e->slope > 0) == (e->x > 0)) {
        e->slope = e->slope_inside;
        e->limit = search->inside;
    }
    return false;
}

/* Whether a kink lies in the bracket that was not looked at yet. */
static bool step_to_kink(const struct problem *p, struct search *search, int32_t *x)
{
    const struct evaluation *left = &search->left;
    const struct evaluation *right = &search->right;
    if (left->limit == search->left_limit && right->limit == search->right_limit) {
        return false;
    }
    search->left_limit = left->limit;
    search->right_limit = right->limit;
    int32_t kink;
    bool left_inside = magnitude(left->x) < magnitude(right->x);
    search->inside = left_inside ? left->limit : right->limit;
    if (!find_kink(p, left_inside ? left : right, left_inside ? right : left, &kink, &search->kink_xi)) {
        return false;
    }
    if (kink <= left->x || kink >= right->x) {
        return false;
    }
    *x = kink;
    return true;
}

/*
 * Where to look next on the way down from e, before there is a bracket. False if J* will not fall below `best` there
 * or hardly at all. J* is not quite convex and the step is a guess, so twice the tangent's fall over twice the step
 * is allowed for: eight times what a parabola would give.
 */
static bool step_down(const struct problem *p, struct search *search, const struct evaluation *e,
                      const struct evaluation *best, int32_t *x)
{
    int32_t end = e->slope < 0 ? search->high : search->low;
    uint32_t room = e->slope < 0 ? (uint32_t)end - (uint32_t)e->x : (uint32_t)e->x - (uint32_t)end;
    uint32_t slope = magnitude(e->slope);
    uint32_t step = search->slope == 0 ? first_step(p, e) : next_step(search->step, search->slope, slope);
    if (e->energy - 2 * gain(slope, step < room / 2 ? 2 * step : room) > best->energy ||
        gain(slope, step) <= e->idle >> GAIN_SHIFT_SMOOTH) {
        return false;
    }
    search->step = step;
    search->slope = slope;
    if (step >= room) {
        *x = end;
    } else {
        *x = (int32_t)(e->slope < 0 ? (uint32_t)e->x + step : (uint32_t)e->x - step);
    }
    return true;
}

/* Leaves the ends of the bracket open: clearing them costs more than a step. */
static void begin(struct search *search, int32_t low, int32_t high)
{
    search->left.xi = 0;
    search->right.xi = 0;
    search->low = low;
    search->high = high;
    search->step = 0;
    search->slope = 0;
    search->width_expected = UINT32_MAX;
    search->flat = false;
    search->left_limit = LIMIT_NONE;
    search->right_limit = LIMIT_NONE;
    search->inside = LIMIT_NONE;
    search->kink_xi = 0;
}

/* The minimum over [low, high], where J* has one; *best keeps the best of all calls. */
static void find_minimum(const struct problem *p, int32_t low, int32_t high, int *evaluations, struct evaluation *best)
{
    struct search search;
    struct evaluation e;
    begin(&search, low, high);
    e.inverse.mantissa = 0;
    int32_t x = jp_clamp32(-best->x, low, high); /* the mirror image of the other side's minimum */
    bool at_kink = false;
    bool more = true;
    for (; more && *evaluations > 0; (*evaluations)--) {
        evaluate(p, x, search.inside, &e);
        if (best->xi == 0 || e.energy < best->energy) {
            *best = e;
        }
        if ((at_kink && settles_kink(&search, &e)) || e.slope == 0 || x == (e.slope < 0 ? high : low)) {
            more = false;
            continue;
        }
        *(e.slope < 0 ? &search.left : &search.right) = e;
        if (search.left.xi == 0 || search.right.xi == 0) {
            more = step_down(p, &search, &e, best, &x);
        } else {
            at_kink = step_to_kink(p, &search, &x);
            more = at_kink || step_inside(&search, best, &x);
        }
    }
}

static int64_t absolute64(int64_t a)
{
    return a < 0 ? -a : a;
}

/* Has the highest bit of a, or of −a − 1. */
static uint64_t magnitude_bits(int64_t a)
{
    uint64_t sign = 0U - (uint64_t)(a < 0);
    return (uint64_t)a ^ sign;
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

/* The scaled problem; d in Q22, Tmin in Q16. Every term is in J, Q28. */
static void build(struct problem *p, const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                  const struct jp_motion *before, const struct jp_voltage_terms *voltage, uint32_t distance,
                  jp_q16 time_min)
{
    const jp_q16 *a = model->a;
    unsigned zeros;
    uint32_t inverse = reciprocal((uint32_t)time_min, &zeros);
    int32_t speed = (int32_t)(((uint64_t)distance * inverse) >> (41 - zeros));             /* 16 d/Tmin in Q23 */
    int32_t turn_rate = (int32_t)(((uint64_t)(uint32_t)TWO_PI * inverse) >> (46 - zeros)); /* Q24 */
    int32_t v = before->speed;
    int32_t w = before->turn_rate;
    int64_t transient_v = ((int64_t)a[0] * 65536 - (int64_t)model->b[0] * model->settling_time) >> 4;
    int64_t transient_w = ((int64_t)a[1] * 65536 - (int64_t)model->b[1] * model->settling_time) >> 4;
    int64_t vv2 = jp_term_scale(jp_term_scale(2 * transient_v, speed, 23), speed, 23);
    int64_t vw = jp_term_scale(jp_term_scale((int64_t)a[3] * 4096, speed, 23), turn_rate, 24);
    int64_t ww2 = jp_term_scale(jp_term_scale(2 * transient_w, turn_rate, 24), turn_rate, 24);
    int64_t vs = jp_term_scale(jp_term_scale((int64_t)a[4] * 4096, speed, 23), PI_Q29, 29);
    int64_t ws = jp_term_scale(jp_term_scale((int64_t)a[5] * 4096, turn_rate, 24), PI_Q29, 29);
    int64_t ss2 = jp_term_scale(jp_term_scale((int64_t)a[2] * 8192, PI_Q29, 29), PI_Q29, 29);
    int64_t lv = jp_term_scale(voltage->speed - (((int64_t)a[0] * 2 * v + (int64_t)a[3] * w) >> 12), speed, 23);
    int64_t lw = jp_term_scale(voltage->turn_rate - (((int64_t)a[1] * 2 * w + (int64_t)a[3] * v) >> 12), turn_rate, 24);
    int64_t ls = jp_term_scale(voltage->turn - (((int64_t)a[4] * v + (int64_t)a[5] * w) >> 12), PI_Q29, 29);
    int64_t fv2 = jp_term_scale(jp_term_scale((int64_t)model->b[0] << 13, speed, 23), (int32_t)(distance >> 1), 17);
    int64_t fw2 = jp_term_scale(jp_term_scale((int64_t)model->b[1] << 13, turn_rate, 24), TWO_PI, 24);
    int64_t power = ((int64_t)model->electronics_power * time_min) >> 4;
    uint64_t doubled = magnitude_bits(vv2) | magnitude_bits(ww2) | magnitude_bits(ss2) | (uint64_t)fv2 | (uint64_t)fw2;
    uint64_t single = magnitude_bits(vw) | magnitude_bits(vs) | magnitude_bits(ws) | magnitude_bits(lv) |
                      magnitude_bits(lw) | magnitude_bits(ls) |
                      (((uint64_t)(uint32_t)model->electronics_power * (uint32_t)limits->duration) >> 4);
    unsigned shift = excess_bits(single | doubled >> 1);
    p->vv2 = (int32_t)(vv2 >> shift);
    p->vw = (int32_t)(vw >> shift);
    p->ww2 = (int32_t)(ww2 >> shift);
    p->vs = (int32_t)(vs >> shift);
    p->ws = (int32_t)(ws >> shift);
    p->ss2 = (int32_t)(ss2 >> shift);
    p->lv = (int32_t)(lv >> shift);
    p->lw = (int32_t)(lw >> shift);
    p->ls = (int32_t)(ls >> shift);
    p->fv2 = (int32_t)(fv2 >> shift);
    p->fw2 = (int32_t)(fw2 >> shift);
    p->power = (int32_t)(power >> shift);
    p->power = p->power < 1 ? 1 : p->power;
    p->power_shift = leading_zeros((uint32_t)p->power) - 3;
    uint32_t half_limit = (uint32_t)limits->speed >> 1;
    p->speed_limit = half_limit < (uint32_t)speed ? fraction_q31(half_limit, (uint32_t)speed) : INT32_MAX;
    p->turn_rate_limit =
        limits->turn_rate < turn_rate ? fraction_q31((uint32_t)limits->turn_rate, (uint32_t)turn_rate) : INT32_MAX;
    p->xi_min = fraction((uint32_t)time_min, (uint32_t)limits->duration);
}

/* The largest |x| whose duration the limits allow. */
static int32_t longest_half_arc(const struct problem *p)
{
    int32_t x = HALF_ARC_MAX;
    int32_t turn_rate = p->turn_rate_limit >> 1;
    if (turn_rate < multiply31(p->xi_min, x)) {
        x = fraction_q31((uint32_t)turn_rate, (uint32_t)p->xi_min);
    }
    uint32_t slowest = (uint32_t)p->xi_min >> 3;
    int32_t sinc_min = slowest < (uint32_t)p->speed_limit ? fraction(slowest, (uint32_t)p->speed_limit) >> 1 : SINC_ONE;
    if (sinc_min > SINC_AT_HALF_ARC_MAX) {
        int32_t by_speed = inverse_sinc(sinc_min);
        x = by_speed < x ? by_speed : x;
    }
    return x;
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
    unsigned zeros;
    uint32_t inverse = reciprocal((uint32_t)best->xi, &zeros);
    jp_q16 duration = (jp_q16)(((uint64_t)(uint32_t)time_min * inverse) >> (32 - zeros));
    duration = jp_clamp32(duration, time_min, limits->duration);
    if ((uint64_t)duration * (uint32_t)limits->speed < length << 18) {
        duration = ceiling_quotient(length << 18, (uint32_t)limits->speed);
    }
    if ((uint64_t)duration * (uint32_t)limits->turn_rate < (uint64_t)magnitude(angle) << 16) {
        duration = ceiling_quotient((uint64_t)magnitude(angle) << 16, (uint32_t)limits->turn_rate);
    }
    duration = jp_clamp32(duration, model->settling_time, limits->duration);
    inverse = reciprocal((uint32_t)duration, &zeros);
    unsigned drop = (length >> 31) == 0 ? 0 : 4;
    jp_q24 speed = jp_round_shift((int64_t)((length >> drop) * inverse), 44 - zeros - drop);
    jp_q24 turn_rate = jp_round_shift((int64_t)angle * inverse, 46 - zeros);
    *segment = (struct jp_segment){
        .command = {.motion = {.speed = jp_clamp32(speed, 0, limits->speed),
                               .turn_rate = jp_clamp32(turn_rate, -limits->turn_rate, limits->turn_rate)},
                    .turn = jp_clamp32(jp_angle_to_radians(bearing - (uint32_t)best->x), -limits->turn, limits->turn),
                    .duration = duration},
        .arc = angle,
        .length = (jp_q16)((length + 32) >> 6),
    };
}

/* Distance in Q22 and direction of `to`. */
static enum jp_status polar(const struct jp_point *from, const struct jp_point *to, uint32_t *distance,
                            jp_angle *direction)
{
    int64_t dx = (int64_t)to->x - from->x;
    int64_t dy = (int64_t)to->y - from->y;
    if (absolute64(dx) > JP_SEGMENT_LENGTH_MAX || absolute64(dy) > JP_SEGMENT_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    int64_t square = dx * dx + dy * dy;
    if (square > (int64_t)JP_SEGMENT_LENGTH_MAX * JP_SEGMENT_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    if (square < (int64_t)JP_SEGMENT_LENGTH_MIN * JP_SEGMENT_LENGTH_MIN) {
        return JP_ERR_ZERO_LENGTH;
    }
    *direction = jp_atan2((int32_t)dy, (int32_t)dx);
    *distance = (uint32_t)((dx * jp_cos(*direction) + dy * jp_sin(*direction)) >> 25);
    return JP_OK;
}

/* The shortest duration of any arc, in Q16. */
static jp_q16 shortest_duration(const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                                uint32_t distance)
{
    jp_q16 duration = model->settling_time < JP_SEGMENT_DURATION_MIN ? JP_SEGMENT_DURATION_MIN : model->settling_time;
    uint64_t scaled = (uint64_t)distance << 18;
    return (uint64_t)(uint32_t)duration * (uint32_t)limits->speed >= scaled
               ? duration
               : ceiling_quotient(scaled, (uint32_t)limits->speed);
}

/* The limit of |σ| as a binary angle, rounded to the safe side. */
static int32_t largest_turn(const struct jp_segment_limits *limits)
{
    jp_angle turn = jp_angle_from_radians(limits->turn);
    if (turn == 0) {
        return 0;
    }
    return turn > INT32_MAX ? INT32_MAX : (int32_t)(turn - 1U);
}

enum jp_status jp_segment_optimise(const struct jp_energy_model *model, const struct jp_segment_limits *limits,
                                   const struct jp_motion *before, const struct jp_point *start, jp_angle heading,
                                   const struct jp_point *target, struct jp_segment *segment)
{
    if (!model || !limits || !before || !start || !target || !segment || !jp_motion_in_range(before)) {
        return JP_ERR_ARGUMENT;
    }
    uint32_t distance;
    jp_angle direction;
    enum jp_status status = polar(start, target, &distance, &direction);
    if (status != JP_OK) {
        return status;
    }
    jp_q16 time_min = shortest_duration(model, limits, distance);
    if (time_min > limits->duration) {
        return JP_ERR_INFEASIBLE;
    }
    struct problem p;
    struct jp_voltage_terms voltage;
    jp_voltage_terms(model, before, &voltage);
    build(&p, model, limits, before, &voltage, distance, time_min);
    jp_angle bearing = direction - heading;
    p.bearing = (int32_t)bearing;
    int32_t reach = longest_half_arc(&p);
    int64_t turn = largest_turn(limits);
    int evaluations = JP_SEGMENT_EVALUATIONS;
    struct evaluation best;
    best.x = 0;
    best.xi = 0;
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
            find_minimum(&p, (int32_t)low, (int32_t)high, &evaluations, &best);
        }
    }
    if (best.xi == 0) {
        return JP_ERR_INFEASIBLE;
    }
    struct jp_segment result;
    store(model, limits, distance, bearing, time_min, &best, &result);
    status = jp_energy_total(model, before, &voltage, &result.command, &result.energy);
    if (result.energy <= 0) {
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
