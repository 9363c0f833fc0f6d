/* Range reduction in parts (W. J. Cody and W. Waite, Software Manual for the Elementary Functions, 1980), then series
 * within 2⁻⁵⁷: of Taylor, whose coefficients need no table. Where the last place asks for it a number is the sum of
 * two, high + low, as in fdlibm (Sun Microsystems, 1993). */
#include "sim/base/strict_math.h"

#include <float.h>
#include <limits.h>
#include <stddef.h>

_Static_assert(FLT_EVAL_METHOD == 0, "double must be rounded after each operation: on x86 compile with -mfpmath=sse");

/* The first parts of π/2 and the first of ln 2 have 32 or 33 bits: times a count below 2²⁰ they are exact. */
#define HALF_PI_1 0x1.921fb544p+0
#define HALF_PI_2 0x1.0b4611a6p-34
#define HALF_PI_3 0x1.3198a2e037073p-69
#define LN2_1     0x1.62e42feep-1
#define LN2_2     0x1.a39ef35793c76p-33
#define PI        0x1.921fb54442d18p+1
#define PI_LOW    0x1.1a62633145c07p-53

#define LENGTH(array) (sizeof(array) / sizeof *(array))

struct pair {
    double high;
    double low;
};

/* c₀ + c₁ z + c₂ z² + … */
static double series(const double *coefficients, size_t length, double z)
{
    double sum = coefficients[length - 1];

    for (size_t i = length - 1; i > 0; i--) {
        sum = sum * z + coefficients[i - 1];
    }
    return sum;
}

/* a + b, |a| ≥ |b|, without an error. */
static struct pair sum_of(double a, double b)
{
    const double high = a + b;

    return (struct pair){high, (a - high) + b};
}

/* ---- Angles ---- */

/* Which of four a multiple is. */
static unsigned quarter_of(double count)
{
    return (unsigned)(int)(fabs(count) < INT_MAX ? count : fmod(count, 4)) % 4;
}

/* x less the nearest multiple of π/2, and which that is of four. */
static struct pair within_eighth(double x, unsigned *quarter)
{
    const double count = rint(x / (PI / 2));
    const double first = x - count * HALF_PI_1;
    const double second = count * HALF_PI_2;
    const double high = first - second;
    const double rest = (first - high) - second;

    *quarter = quarter_of(count);
    return sum_of(high, rest - count * HALF_PI_3);
}

/* |angle| ≤ π/4. */
static double sine_of(struct pair angle)
{
    static const double terms[] = {-1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
                                   -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
    const double x = angle.high;
    const double z = x * x;

    return x + (x * z * series(terms, LENGTH(terms), z) + angle.low * (1 - z / 2));
}

static double cosine_of(struct pair angle)
{
    static const double terms[] = {1.0 / 24,        -1.0 / 720,         1.0 / 40320,         -1.0 / 3628800,
                                   1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000};
    const double x = angle.high;
    const double z = x * x;
    const struct pair begin = sum_of(1, -z / 2);

    return begin.high + (begin.low + (z * z * series(terms, LENGTH(terms), z) - x * angle.low));
}

/* The sine `quarters` of a turn further. */
static double sine_after(double x, unsigned quarters)
{
    unsigned quarter;

    if (!isfinite(x)) {
        return NAN;
    }
    const struct pair angle = within_eighth(x, &quarter);
    const double size = (quarter + quarters) % 2 == 0 ? sine_of(angle) : cosine_of(angle);

    return (quarter + quarters) % 4 < 2 ? size : -size;
}

double strict_sin(double x)
{
    return x == 0 ? x : sine_after(x, 0);
}

double strict_cos(double x)
{
    return sine_after(x, 1);
}

struct strict_turn strict_sin_cos(double x)
{
    unsigned quarter;

    if (!isfinite(x)) {
        return (struct strict_turn){NAN, NAN};
    }
    const struct pair angle = within_eighth(x, &quarter);
    const double size[] = {sine_of(angle), cosine_of(angle)};
    static const double signs[] = {1, 1, -1, -1};

    return (struct strict_turn){
        .sine = x == 0 ? x : signs[quarter] * size[quarter % 2],
        .cosine = signs[(quarter + 1) % 4] * size[(quarter + 1) % 2],
    };
}

double strict_tan(double x)
{
    const struct strict_turn turn = strict_sin_cos(x);

    return turn.sine / turn.cosine;
}

/* ---- Their inverses ---- */

/* |t| ≤ tan(π/8). */
static double small_arc_tangent(double t)
{
    static const double terms[] = {-1.0 / 3,  1.0 / 5,   -1.0 / 7,  1.0 / 9,   -1.0 / 11, 1.0 / 13,  -1.0 / 15,
                                   1.0 / 17,  -1.0 / 19, 1.0 / 21,  -1.0 / 23, 1.0 / 25,  -1.0 / 27, 1.0 / 29,
                                   -1.0 / 31, 1.0 / 33,  -1.0 / 35, 1.0 / 37,  -1.0 / 39, 1.0 / 41};
    const double z = t * t;

    return t + t * z * series(terms, LENGTH(terms), z);
}

double strict_atan2(double y, double x)
{
    static const double tangent_of_eighth = 0x1.a827999fcef32p-2;
    const double less = fmin(fabs(x), fabs(y));
    const double more = fmax(fabs(x), fabs(y));
    int eighths = 0; /* of half a turn's quarters: the angle is so many π/4, and side × rest */
    double side = 1;
    double rest = 0;

    if (isnan(x) || isnan(y)) {
        return NAN;
    }
    if (less > tangent_of_eighth * more) {
        eighths = 1;
        rest = small_arc_tangent((less - more) / (less + more));
    } else if (less > 0) {
        rest = small_arc_tangent(less / more);
    }
    if (fabs(y) > fabs(x)) {
        eighths = 2 - eighths;
        side = -side;
    }
    if (signbit(x)) {
        eighths = 4 - eighths;
        side = -side;
    }
    return copysign(eighths * (PI / 4) + (side * rest + eighths * (PI_LOW / 4)), y);
}

double strict_atan(double x)
{
    return strict_atan2(x, 1);
}

double strict_asin(double x)
{
    return fabs(x) <= 1 ? strict_atan2(x, sqrt((1 - x) * (1 + x))) : NAN;
}

/* ---- Exponentials ---- */

/* exp(x) − 1 for |x| ≤ ln(2)/2, of the angle's two parts. */
static double small_growth(struct pair x)
{
    static const double terms[] = {1.0 / 2,       1.0 / 6,        1.0 / 24,        1.0 / 120,
                                   1.0 / 720,     1.0 / 5040,     1.0 / 40320,     1.0 / 362880,
                                   1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};

    return x.high + (x.high * x.high * series(terms, LENGTH(terms), x.high) + x.low);
}

double strict_exp(double x)
{
    static const double beyond = 1000; /* overflows, and its negative underflows */

    if (isnan(x)) {
        return NAN;
    }
    if (fabs(x) > beyond) {
        return x > 0 ? INFINITY : 0;
    }
    const double count = rint(x / LN2_1);
    const struct pair rest = sum_of(x - count * LN2_1, -count * LN2_2);

    return ldexp(1 + small_growth(rest), (int)count);
}

double strict_log(double x)
{
    static const double terms[] = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11,
                                   2.0 / 13, 2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21};
    int count = 0;

    if (!(x > 0)) {
        return x == 0 ? -INFINITY : NAN;
    }
    if (isinf(x)) {
        return x;
    }
    double mantissa = frexp(x, &count);
    if (mantissa < M_SQRT1_2) {
        mantissa *= 2;
        count--;
    }
    /* log(1 + f) = 2 atanh(s) with s = f/(2 + f), where 2 s = f − f²/2 + s f²/2. */
    const double f = mantissa - 1;
    const double s = f / (2 + f);
    const double half_square = f * f / 2;
    const double more = s * (half_square + s * s * series(terms, LENGTH(terms), s * s));

    return count * LN2_1 - ((half_square - (more + count * LN2_2)) - f);
}

double strict_tanh(double x)
{
    static const double saturated = 20; /* 1 − tanh(20) is below half a last place */
    const double size = fabs(x);

    if (!(size < saturated)) {
        return isnan(x) ? NAN : copysign(1, x);
    }
    const double growth = size < 0.15 ? small_growth((struct pair){2 * size, 0}) : strict_exp(2 * size) - 1;

    return copysign(growth / (growth + 2), x);
}
