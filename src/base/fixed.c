#include <joulepath/fixed.h>

#include "src/base/integer.h"

_Static_assert(-3 >> 1 == -2, "right shift of a negative number must be arithmetic");
_Static_assert((int32_t)UINT32_MAX == -1, "conversion to a signed type must wrap");

#define QUARTER_TURN ((jp_angle)1 << 30)
#define HALF_TURN    ((jp_angle)1 << 31)
#define EIGHTH_TURN  ((jp_angle)1 << 29)

/* The copies that are called where the compiler does not write the function in line. */
extern inline int32_t jp_saturate32(int64_t x);
extern inline int32_t jp_add(int32_t a, int32_t b);
extern inline int32_t jp_multiply_shift(int32_t a, int32_t b, unsigned shift);
extern inline int32_t jp_round_shift(int64_t x, unsigned shift);

#if JP_LONG_MULTIPLY
extern inline int64_t jp_multiply(int32_t a, int32_t b);

/** Upper half of the product. */
static inline uint32_t multiply_high(uint32_t a, uint32_t b)
{
    return (uint32_t)(((uint64_t)a * b) >> 32);
}
#else
/* By halves: no partial sum leaves 32 bits. */
int64_t jp_multiply(int32_t a, int32_t b)
{
    uint32_t a_low = (uint32_t)a & UINT16_MAX;
    uint32_t b_low = (uint32_t)b & UINT16_MAX;
    int32_t a_high = a >> 16;
    int32_t b_high = b >> 16;
    uint32_t low = a_low * b_low;
    int32_t middle = a_high * (int32_t)b_low + (int32_t)(low >> 16);
    int32_t rest = b_high * (int32_t)a_low + (int32_t)(uint16_t)middle;
    int32_t high = a_high * b_high + (middle >> 16) + (rest >> 16);

    return (int64_t)(uint64_t)(((uint64_t)(uint32_t)high << 32) | ((uint32_t)rest << 16) | (low & UINT16_MAX));
}

/** Upper half of the product. */
static uint32_t multiply_high(uint32_t a, uint32_t b)
{
    uint32_t a_low = a & UINT16_MAX;
    uint32_t b_low = b & UINT16_MAX;
    uint32_t middle = (a >> 16) * b_low + ((a_low * b_low) >> 16);
    uint32_t rest = (b >> 16) * a_low + (middle & UINT16_MAX);

    return (a >> 16) * (b >> 16) + (middle >> 16) + (rest >> 16);
}
#endif

static uint64_t magnitude64(int64_t x)
{
    return x < 0 ? 0u - (uint64_t)x : (uint64_t)x;
}

static int32_t signed_saturate(int negative, uint64_t magnitude)
{
    if (negative != 0) {
        return magnitude > (uint64_t)INT32_MAX ? INT32_MIN : -(int32_t)magnitude;
    }
    return magnitude > (uint64_t)INT32_MAX ? INT32_MAX : (int32_t)magnitude;
}

int32_t jp_divide(int64_t numerator, int32_t denominator)
{
    if (denominator == 0) {
        return numerator > 0 ? INT32_MAX : numerator < 0 ? INT32_MIN : 0;
    }
    uint64_t dividend = magnitude64(numerator);
    uint32_t divisor = jp_magnitude32(denominator);
    uint64_t quotient = dividend / divisor;
    uint32_t remainder = (uint32_t)(dividend - quotient * divisor);
    if (remainder >= divisor - remainder) {
        quotient++;
    }
    return signed_saturate((numerator < 0) != (denominator < 0), quotient);
}

uint32_t jp_square_root(uint64_t x)
{
    uint64_t remainder = x;
    uint64_t root = 0; /* scaled: its last digit stands at `bit` */
    for (uint64_t bit = (uint64_t)1 << 62; bit != 0U; bit >>= 2) {
        uint64_t trial = root + bit;
        root >>= 1;
        if (remainder >= trial) {
            remainder -= trial;
            root += bit;
        }
    }
    return (uint32_t)root;
}

jp_q16 jp_q16_square_root(jp_q16 x)
{
    if (x <= 0) {
        return 0;
    }
    uint32_t square = (uint32_t)x;
    uint64_t scaled = (uint64_t)square << 16;
    uint32_t root = jp_square_root(scaled);
    uint64_t remainder = scaled - (uint64_t)root * root;
    return (jp_q16)(remainder > root ? root + 1U : root);
}

/*
 * sin(πx/2) = x + x (1 − x²) R(x²) for x in [−1, 1]. The form makes the quarter turns exact.
 * R: minimax coefficients by tools/design/fixed_polynomials.py; their signs alternate, so the nested differences stay
 * positive. With x² in Q31 each Horner step drops one fraction bit, which suits coefficients that shrink.
 */
jp_q31 jp_sin(jp_angle angle)
{
    uint32_t folded = angle;
    if ((int32_t)(angle ^ (angle << 1)) < 0) {
        folded = HALF_TURN - angle; /* the left half turn mirrors the right one */
    }
    jp_q31 x = jp_add((int32_t)folded, (int32_t)folded);
    uint32_t square = (uint32_t)((uint64_t)jp_multiply(x, x) >> 31);

    uint32_t r = 234719u;                       /* Q36 */
    r = 5387438u - multiply_high(square, r);    /* Q35 */
    r = 77735804u - multiply_high(square, r);   /* Q34 */
    r = 645686191u - multiply_high(square, r);  /* Q33 */
    r = 2451551555u - multiply_high(square, r); /* Q32 */

    uint32_t complement = ((uint32_t)1 << 31) - square;
    int64_t correction = jp_multiply(x, (int32_t)multiply_high(complement, r));
    return jp_add(x, (int32_t)((correction + ((int64_t)1 << 30)) >> 31));
}

jp_q31 jp_cos(jp_angle angle)
{
    return jp_sin(angle + QUARTER_TURN);
}

/*
 * atan(t) in turns, Q32, for t in [0, 1) in Q32: t P(t²) with P in Q34.
 * P: minimax coefficients by tools/design/fixed_polynomials.py; their signs alternate, so the nested differences stay
 * positive.
 */
static uint32_t arctangent(uint32_t t)
{
    static const uint32_t coefficients[] = {26159609u,  77901226u,  150461201u, 224585694u, 297433195u,
                                            389556268u, 546754794u, 911416185u, 2734261049u};
    uint32_t z = multiply_high(t, t);
    uint32_t p = 4126830u;
    for (unsigned i = 0; i < sizeof coefficients / sizeof coefficients[0]; i++) {
        p = coefficients[i] - multiply_high(z, p);
    }
    return (multiply_high(t, p) + 2U) >> 2;
}

/** Angle of the first octant, 0 <= low <= high. */
static jp_angle octant_angle(uint32_t low, uint32_t high)
{
    if (high == 0U) {
        return 0;
    }
    if (low == high) {
        return EIGHTH_TURN;
    }
    return arctangent((uint32_t)(((uint64_t)low << 32) / high));
}

jp_angle jp_atan2(int32_t y, int32_t x)
{
    uint32_t size_x = jp_magnitude32(x);
    uint32_t size_y = jp_magnitude32(y);
    jp_angle angle = size_y > size_x ? QUARTER_TURN - octant_angle(size_x, size_y) : octant_angle(size_y, size_x);
    if (x < 0) {
        angle = HALF_TURN - angle;
    }
    return y < 0 ? 0u - angle : angle;
}

jp_angle jp_angle_from_radians(jp_q24 radians)
{
    const uint64_t units_per_step = 174992710548u; /* 2⁸/2π in Q32 */
    uint64_t units = (uint64_t)(int64_t)radians * units_per_step;
    return (jp_angle)((units + HALF_TURN) >> 32);
}

jp_q24 jp_angle_to_radians(jp_angle angle)
{
    const int64_t steps_per_unit = 3373259426; /* 2π/2⁸ in Q37 */
    const int64_t steps_fraction = 560513589;  /* what is missing from it, in Q69 */
    int64_t units = angle > HALF_TURN ? (int64_t)angle - ((int64_t)1 << 32) : (int64_t)angle;
    int64_t scaled = units * steps_per_unit + ((units * steps_fraction) >> 32);
    return jp_round_shift(scaled, 37);
}
