#include "src/trajectory/segment_arc.h"

#include <joulepath/fixed.h>

#include "src/base/integer.h"
#include "src/trajectory/segment_math.h"

#define PI_Q29         ((int32_t)1686629713)
#define INVERSE_PI_Q30 ((int32_t)341782638)

static int32_t horner(int32_t value, int32_t square, int32_t coefficient)
{
    return coefficient + multiply32(value, square);
}

/* sin(πx)/(πx) in Q29 and its derivative with respect to x²: minimax polynomials, 6·10⁻⁹ of the value. With x² in
 * Q31 each Horner step drops one fraction bit. Without a loop, because every evaluation comes here. */
static int32_t sinc_of_square(int32_t square, int32_t *derivative)
{
    int32_t value = horner(4548457, square, -40058541);
    int32_t slope = horner(13645372, square, -100146353);

    value = horner(value, square, 224556901);
    slope = horner(slope, square, 449113802);
    value = horner(value, square, -819267988);
    slope = horner(slope, square, -1228901982);
    value = horner(value, square, 1743203416);
    slope = horner(slope, square, 1743203416);
    value = horner(value, square, -1766234504);
    *derivative = horner(slope, square, -883117252);
    return horner(value, square, JP_SINC_ONE);
}

void jp_arc_at(int32_t x, struct jp_arc *arc)
{
    int32_t derivative;
    unsigned zeros;

    arc->square = multiply31(x, x);
    arc->sinc = sinc_of_square(arc->square, &derivative);

    uint32_t inverse = jp_reciprocal((uint32_t)arc->sinc, &zeros);

    arc->shape = (int32_t)(uint32_t)(inverse >> (6U - zeros));
    arc->stretch = (int32_t)(((int64_t)multiply32(x, -derivative) * arc->shape) >> 27);
}

/* x² ≈ 6/π² u (1 + 0.3 u + 0.28 u²) in Q30 with u = 1 − sinc. */
static int32_t square_of_sinc(int32_t sinc)
{
    int32_t u = (JP_SINC_ONE - sinc) * 2; /* Q30 */

    u = u < 1 ? 1 : u;

    int32_t series = Q30_ONE + multiply32(u, 1288490189) + multiply32(multiply32(u, u) << 2, 1202590843);

    return multiply32(multiply32(u, 1305455232) << 2, series) << 1;
}

int32_t jp_arc_of_sinc(int32_t sinc)
{
    int32_t x = (int32_t)(jp_square_root32((uint32_t)square_of_sinc(sinc) + 1U) << 16);

    for (int i = 0; i < 2; i++) { /* Newton; gap is always below fall */
        int32_t derivative;
        int32_t excess = sinc_of_square(multiply31(x, x), &derivative) - sinc;
        uint32_t fall = jp_magnitude32(multiply32(x, derivative)); /* -dsinc/dx in Q27 */
        uint32_t gap = jp_magnitude32(excess) >> 2;
        int32_t step = jp_fraction30(gap, fall) >> 2; /* Q28 */

        x = excess > 0 ? x + step * 8 : x - step * 8;
    }
    return jp_clamp32(x, 0, JP_HALF_ARC_MAX);
}

int32_t jp_arc_of_half_chord(int32_t half_chord)
{
    int32_t sine = half_chord >= INVERSE_PI_Q30 ? Q30_ONE : (int32_t)((int64_t)half_chord * PI_Q29 >> 29);
    int32_t cosine_squared = Q30_ONE - multiply30(sine, sine);
    int32_t x = (int32_t)jp_atan2(sine >> 1, (int32_t)(jp_square_root32((uint32_t)cosine_squared + 1U) << 14));

    /* Newton; |missing| is always below the slope */
    int32_t derivative;
    int32_t square = multiply31(x, x);
    int32_t sinc = sinc_of_square(square, &derivative);
    int32_t slope = sinc + 4 * multiply32(square, derivative);  /* Q29 */
    int32_t missing = 2 * half_chord - multiply31(x, sinc) * 4; /* Q31 */
    int32_t step = jp_fraction30(jp_magnitude32(missing), (uint32_t)slope) >> 1;

    return missing < 0 ? x - step : x + step;
}
