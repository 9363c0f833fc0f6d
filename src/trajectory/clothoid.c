#include "src/trajectory/clothoid.h"

#include "src/base/integer.h"

/** No headings are known that take more rounds than five. */
enum { NODES = 6, ROUNDS = 6 };

#define Q31_ONE  ((int64_t)1 << 31)
#define Q30_HALF ((int32_t)1 << 29)

/** 2²⁸/2π and 2π·2²⁸. */
#define STEPS_PER_RADIAN  42722830
#define RADIANS_PER_STEPS 1686629713

/** Headings at the ends that are nothing but rounding, 2⁻³² turn. */
#define ROUNDING 8

/** At least this share of a curve is its chord, Q30. */
#define CHORD_MIN ((int32_t)1 << 28)

/** A is at most 4 turns, Q28. */
#define SHAPE_MAX ((int32_t)1 << 30)

/** Integrals over the curve, Q30. */
struct integrals {
    int32_t across; /**< of sin(φ) */
    int32_t along;  /**< of cos(φ) */
    int32_t slope;  /**< of u(1 − u) cos(φ): how `across` falls with A */
};

/** `turned` and `shape`: δ and A, turn in Q28. */
static struct integrals integrate(int32_t from, int32_t turned, int32_t shape)
{
    /* Gauss–Legendre of six points: where φ is taken, and with what weight, Q31. */
    static const struct {
        jp_q31 at;
        jp_q31 weight;
    } nodes[NODES] = {{72510307, 183958273},   {363773651, 387364789},  {817526424, 502418762},
                      {1329957224, 502418762}, {1783709997, 387364789}, {2074973341, 183958273}};
    int64_t across = 0;
    int64_t along = 0;
    int64_t slope = 0;

    for (unsigned i = 0; i < (unsigned)NODES; i++) {
        const jp_q31 u = nodes[i].at;
        const jp_q31 rest = (jp_q31)(Q31_ONE - u);
        const int32_t by_u = turned - jp_multiply_shift(shape, rest, 31);
        const jp_angle phi = (jp_angle)from + 16U * (jp_angle)jp_multiply_shift(by_u, u, 31);
        const jp_q31 cosine = jp_cos(phi);

        across += jp_multiply(nodes[i].weight, jp_sin(phi));
        along += jp_multiply(nodes[i].weight, cosine);
        slope += jp_multiply(jp_q31_multiply(nodes[i].weight, jp_q31_multiply(u, rest)), cosine);
    }
    return (struct integrals){(int32_t)(across / (2 * Q31_ONE)), (int32_t)(along / (2 * Q31_ONE)),
                              (int32_t)(slope / (2 * Q31_ONE))};
}

/** Turn in Q28 to rad. */
static jp_q24 radians(int32_t turn)
{
    return jp_multiply_shift(turn, RADIANS_PER_STEPS, 32);
}

bool jp_clothoid_fit(int32_t from, int32_t to, struct jp_clothoid *curve)
{
    if (jp_is_between(from, -ROUNDING, ROUNDING) && jp_is_between(to, -ROUNDING, ROUNDING)) {
        *curve = (struct jp_clothoid){.chord_share = 2 * Q30_HALF};
        return true;
    }

    const int32_t turned = to / 16 - from / 16;
    int32_t shape = 3 * (to / 16 + from / 16); /* where angles are small */
    struct integrals now = integrate(from, turned, shape);

    for (unsigned round = 0; round < (unsigned)ROUNDS; round++) {
        const int32_t step = jp_divide(jp_multiply(now.across, STEPS_PER_RADIAN), now.slope);

        shape = jp_clamp32(jp_add(shape, step), -SHAPE_MAX, SHAPE_MAX);
        now = integrate(from, turned, shape);
    }
    *curve = (struct jp_clothoid){now.along, radians(turned - shape), radians(turned + shape)};
    return now.along >= CHORD_MIN;
}
