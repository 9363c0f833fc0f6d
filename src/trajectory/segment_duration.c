#include "src/trajectory/segment_duration.h"

#include "src/base/compiler.h"
#include "src/base/integer.h"
#include "src/trajectory/segment_math.h"

enum { NEWTON_STEPS_MAX = 8 };

/* J at a fixed arc: a ξ²/2 + b ξ + P/ξ and a constant. */
struct cubic {
    int32_t a;
    int32_t b;
};

static struct cubic cubic_of(const struct jp_segment_problem *p, int32_t x, int32_t s, const struct jp_arc *arc)
{
    int32_t r = arc->shape;
    int32_t rr = multiply31(r, r);
    int32_t rx = multiply31(r, x);
    int64_t friction = ((int64_t)p->fv2 * rr + (int64_t)p->fw2 * arc->square) >> 1;

    return (struct cubic){
        .a = (int32_t)(((int64_t)p->vv2 * rr + (int64_t)p->vw * rx * 2 + (int64_t)p->ww2 * arc->square) >> 31),
        .b = (int32_t)(((int64_t)p->vs * multiply31(r, s) + (int64_t)p->ws * multiply31(x, s) + (int64_t)p->lv * r +
                        (int64_t)p->lw * x + friction) >>
                       31),
    };
}

/* Largest ξ within the limits, and the limit that sets it. */
static int32_t xi_limit(const struct jp_segment_problem *p, int32_t x, const struct jp_arc *arc,
                        enum jp_acting_limit *limit)
{
    int32_t xi = Q30_ONE;
    int64_t by_speed = ((int64_t)p->speed_limit * arc->sinc) >> 26;

    *limit = JP_ACTING_NONE;
    if (by_speed < xi) {
        xi = (int32_t)by_speed;
        *limit = JP_ACTING_SPEED;
    }
    if (jp_magnitude32(x) > (uint32_t)p->turn_rate_limit) {
        int32_t by_turn_rate = jp_fraction30((uint32_t)p->turn_rate_limit, jp_magnitude32(x));

        if (by_turn_rate < xi) {
            xi = by_turn_rate;
            *limit = JP_ACTING_TURN_RATE;
        }
    }
    return xi > p->xi_min ? xi : p->xi_min; /* below it by rounding only */
}

static int32_t shift_signed(int32_t a, int shift)
{
    return shift >= 0 ? (int32_t)((uint32_t)a << shift) : a >> -shift;
}

static JP_INLINE_FOR_SPEED int bits(int32_t a)
{
    return a == 0 ? 0 : 32 - (int)jp_leading_zeros(jp_magnitude32(a));
}

/* The scale 2ᵏ that brings the largest root of P τ³ = b τ + a below 1. */
static int root_scale(const struct cubic *c, int power_shift)
{
    int from_b = (bits(c->b) + power_shift - 26) >> 1;
    int from_a = ((bits(c->a) + power_shift - 25) * 21846) >> 16; /* a third */
    int k = from_a > from_b ? from_a : from_b;

    return k < 0 ? 0 : k;
}

/* Newton's step on P τ³ − b τ − a, limited to 1 in Q30. */
static int32_t newton_step(int32_t power, int32_t a, int32_t b, int32_t tau)
{
    int32_t square = multiply30(multiply30(power, tau), tau);
    int32_t numerator = 2 * multiply30(square, tau) + a;
    int32_t denominator = 3 * square - b;

    if (denominator <= 0) {
        return Q30_ONE;
    }
    if (numerator <= 0) {
        return 1;
    }
    return numerator >= denominator ? Q30_ONE : jp_fraction30((uint32_t)numerator, (uint32_t)denominator);
}

/*
 * The ξ where a ξ³ + b ξ² = P, in Q30, at most 1, to about 2⁻⁹ of itself: E changes only to second order.
 *
 * Newton on P τ³ − b τ − a with τ = 1/ξ scaled by 2⁻ᵏ, so that the largest root is below 1. From above it converges
 * without overshoot; from anywhere else the first step leads above. Without a root the result has no meaning.
 */
static int32_t stationary(const struct jp_segment_problem *p, const struct cubic *c, const struct jp_inverse *guess)
{
    int shift = (int)p->power_shift;
    int k = root_scale(c, shift);
    int32_t power = (int32_t)((uint32_t)p->power << shift);
    int32_t a = shift_signed(c->a, shift - 3 * k);
    int32_t b = shift_signed(c->b, shift - 2 * k);
    uint32_t one = (uint32_t)Q30_ONE >> k;
    int32_t tau = Q30_ONE;

    if (guess->mantissa != 0U && guess->exponent < k) {
        tau = (int32_t)(guess->mantissa >> (k - guess->exponent));
    }
    for (int i = 0; i < NEWTON_STEPS_MAX; i++) {
        int32_t last = tau;

        tau = newton_step(power, a, b, tau);
        if (jp_magnitude32(last - tau) <= (uint32_t)tau >> 5) {
            break;
        }
    }
    return one < (uint32_t)tau ? jp_fraction30(one, (uint32_t)tau) : Q30_ONE;
}

/* J at a fixed arc, less a constant. */
static int32_t cubic_energy(const struct jp_segment_problem *p, const struct cubic *c, int32_t xi)
{
    unsigned zeros;
    uint32_t inverse = jp_reciprocal((uint32_t)xi, &zeros);
    uint32_t power = (uint32_t)p->power << zeros;
    int32_t idle = (int32_t)(((uint64_t)power * inverse) >> 32);

    return multiply30(multiply30(c->a / 2, xi) + c->b, xi) + idle;
}

int32_t jp_segment_best_xi(const struct jp_segment_problem *p, int32_t x, int32_t s, const struct jp_arc *arc,
                           const struct jp_inverse *guess, enum jp_acting_limit *limit)
{
    struct cubic c = cubic_of(p, x, s, arc);
    int32_t high = xi_limit(p, x, arc, limit);
    int32_t slope = multiply30(multiply30(multiply30(c.a, high) + c.b, high), high) - p->power; /* ξ² dJ/dξ */

    if (slope <= 0 && c.a >= 0) {
        return high;
    }

    int32_t xi = jp_clamp32(stationary(p, &c, guess), p->xi_min, high);

    if (slope <= 0 && cubic_energy(p, &c, high) <= cubic_energy(p, &c, xi)) {
        return high;
    }
    *limit = JP_ACTING_NONE;
    return xi;
}
