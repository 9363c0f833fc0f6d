#include "src/trajectory/segment_problem.h"

#include "src/base/compiler.h"
#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_math.h"

#define TWO_PI JP_Q24(6.283185307179586)
#define PI_Q29 ((int32_t)1686629713)

/* Of the largest coefficient: sums of a few products with fractions still fit 32 bits. */
#define COEFFICIENT_BITS 27

#define SPEED_BITS     23
#define TURN_RATE_BITS 24

/* What turns the unknowns into speeds. */
struct units {
    uint32_t speed;     /* below 2³¹: 16 d/Tmin with SPEED_BITS */
    uint32_t turn_rate; /* below 2³¹: 2π/Tmin with TURN_RATE_BITS */
};

/* The coefficients: those of squares, which are doubled, first. */
enum { VV2, WW2, SS2, FV2, FW2, VW, VS, WS, LV, LW, LS, POWER, COEFFICIENTS };
enum { SQUARES = VW };

/* The coefficients in Q28. */
struct terms {
    int64_t of[COEFFICIENTS];
};

static struct units units_of(uint32_t distance, jp_q16 time_min)
{
    unsigned zeros;
    uint32_t inverse = jp_reciprocal((uint32_t)time_min, &zeros);

    return (struct units){
        .speed = (uint32_t)(((uint64_t)distance * inverse) >> (41U - zeros)),
        .turn_rate = (uint32_t)(((uint64_t)(uint32_t)TWO_PI * inverse) >> (46U - zeros)),
    };
}

/* jp_term_scale() for a factor that is not negative, which takes fewer instructions. */
static JP_INLINE_FOR_SPEED int64_t scale_by(int64_t a, uint32_t factor, unsigned shift)
{
    int64_t high = (a >> 32) * (int32_t)factor;
    uint64_t low = (uint64_t)(uint32_t)a * factor;

    return high * ((int64_t)1 << (32 - shift)) + (int64_t)(low >> shift);
}

static int64_t per_speed(int64_t a, const struct units *units)
{
    return scale_by(a, units->speed, SPEED_BITS);
}

static int64_t per_turn_rate(int64_t a, const struct units *units)
{
    return scale_by(a, units->turn_rate, TURN_RATE_BITS);
}

static int64_t per_half_turn(int64_t a)
{
    return scale_by(a, PI_Q29, 29);
}

/* A parameter of the model in Q16 times a factor with `bits` fraction bits. */
static int64_t term(jp_q16 a, uint32_t factor, unsigned bits)
{
    return ((int64_t)a * (int32_t)factor) >> (bits + 16U - JP_TERM_BITS);
}

static int64_t doubled_term(jp_q16 a, uint32_t factor, unsigned bits)
{
    return term(a, factor, bits - 1U);
}

/* Twice what a step costs by its square, without the friction during Ts, which E does not count. */
static JP_INLINE_FOR_SPEED int64_t doubled_transient(jp_q16 a, jp_q16 b, jp_q16 settling_time)
{
    return 2 * (((int64_t)a * 65536 - (int64_t)b * settling_time) >> 4);
}

static void quadratic_terms(struct terms *t, const struct jp_energy_model *model, const struct units *units)
{
    const jp_q16 *a = model->a;
    int64_t transient_v = doubled_transient(a[0], model->b[0], model->settling_time);
    int64_t transient_w = doubled_transient(a[1], model->b[1], model->settling_time);

    t->of[VV2] = per_speed(per_speed(transient_v, units), units);
    t->of[VW] = per_turn_rate(term(a[3], units->speed, SPEED_BITS), units);
    t->of[WW2] = per_turn_rate(per_turn_rate(transient_w, units), units);
    t->of[VS] = per_half_turn(term(a[4], units->speed, SPEED_BITS));
    t->of[WS] = per_half_turn(term(a[5], units->turn_rate, TURN_RATE_BITS));
    t->of[SS2] = per_half_turn(doubled_term(a[2], PI_Q29, 29));
}

static void linear_terms(struct terms *t, const struct jp_energy_model *model, const struct jp_motion *before,
                         const struct jp_voltage_terms *voltage, const struct units *units)
{
    const jp_q16 *a = model->a;
    int32_t v = before->speed;
    int32_t w = before->turn_rate;

    t->of[LV] = per_speed(voltage->speed - (((int64_t)a[0] * 2 * v + (int64_t)a[3] * w) >> 12), units);
    t->of[LW] = per_turn_rate(voltage->turn_rate - (((int64_t)a[1] * 2 * w + (int64_t)a[3] * v) >> 12), units);
    t->of[LS] = per_half_turn(voltage->turn - (((int64_t)a[4] * v + (int64_t)a[5] * w) >> 12));
}

/* v² T is the speed times the length of the arc. */
static void friction_terms(struct terms *t, const struct jp_energy_model *model, uint32_t distance,
                           const struct units *units)
{
    t->of[FV2] = scale_by(doubled_term(model->b[0], units->speed, SPEED_BITS), distance >> 1, 17);
    t->of[FW2] = scale_by(doubled_term(model->b[1], units->turn_rate, TURN_RATE_BITS), TWO_PI, 24);
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

    if ((high >> 32) != 0U) {
        return 64U - jp_leading_zeros((uint32_t)(high >> 32));
    }
    return high == 0U ? 0U : 32U - jp_leading_zeros((uint32_t)high);
}

/* So that every coefficient and P/ξ at the longest duration fit. */
static unsigned common_shift(const struct terms *t, uint64_t longest_idle)
{
    uint64_t all = 0;

    for (unsigned i = 0; i < (unsigned)SQUARES; i++) {
        all |= magnitude_bits(t->of[i]);
    }
    all = (all >> 1) | longest_idle;
    for (unsigned i = SQUARES; i < (unsigned)COEFFICIENTS; i++) {
        all |= magnitude_bits(t->of[i]);
    }
    return excess_bits(all);
}

static void scale(struct jp_segment_problem *p, const struct terms *t, unsigned shift)
{
    int32_t fitted[COEFFICIENTS];

    for (unsigned i = 0; i < (unsigned)COEFFICIENTS; i++) {
        fitted[i] = (int32_t)(t->of[i] >> shift);
    }
    p->vv2 = fitted[VV2];
    p->vw = fitted[VW];
    p->ww2 = fitted[WW2];
    p->vs = fitted[VS];
    p->ws = fitted[WS];
    p->ss2 = fitted[SS2];
    p->lv = fitted[LV];
    p->lw = fitted[LW];
    p->ls = fitted[LS];
    p->fv2 = fitted[FV2];
    p->fw2 = fitted[FW2];
    p->power = fitted[POWER] < 1 ? 1 : fitted[POWER];
    p->power_shift = jp_leading_zeros((uint32_t)p->power) - 3U;
}

void jp_segment_problem_build(struct jp_segment_problem *p, const struct jp_energy_model *model,
                              const struct jp_segment_limits *limits, const struct jp_motion *before,
                              const struct jp_voltage_terms *voltage, uint32_t distance, jp_angle bearing,
                              jp_q16 time_min)
{
    struct units units = units_of(distance, time_min);
    struct terms t;
    uint64_t longest_idle = ((uint64_t)(uint32_t)model->electronics_power * (uint32_t)limits->duration) >> 4;

    quadratic_terms(&t, model, &units);
    linear_terms(&t, model, before, voltage, &units);
    friction_terms(&t, model, distance, &units);
    t.of[POWER] = ((int64_t)model->electronics_power * time_min) >> 4;
    scale(p, &t, common_shift(&t, longest_idle));
    p->bearing = (int32_t)bearing;
    p->speed_limit = jp_quotient31(limits->speed >> 1, (int32_t)units.speed);
    p->turn_rate_limit = jp_quotient31(limits->turn_rate, (int32_t)units.turn_rate);
    p->xi_min = jp_fraction30((uint32_t)time_min, (uint32_t)limits->duration);
}

int32_t jp_segment_longest_half_arc(const struct jp_segment_problem *p)
{
    int32_t x = JP_HALF_ARC_MAX;
    int32_t turn_rate = p->turn_rate_limit >> 1;
    uint32_t slowest = (uint32_t)p->xi_min >> 3;
    int32_t sinc_min = JP_SINC_ONE;

    if (turn_rate < multiply31(p->xi_min, x)) {
        x = jp_quotient31(turn_rate, p->xi_min);
    }
    if (slowest < (uint32_t)p->speed_limit) {
        sinc_min = jp_fraction30(slowest, (uint32_t)p->speed_limit) >> 1;
    }
    if (sinc_min > JP_SINC_AT_HALF_ARC_MAX) {
        int32_t by_speed = jp_arc_of_sinc(sinc_min);

        x = by_speed < x ? by_speed : x;
    }
    return x;
}
