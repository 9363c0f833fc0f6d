#include "src/trajectory/segment_evaluation.h"

#include "src/base/integer.h"
#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_duration.h"
#include "src/trajectory/segment_math.h"

/* `slope` at fixed ξ becomes the slope along a limit, ξ dJ/dξ = push < 0. */
static int32_t slope_on_limit(int32_t slope, int32_t push, enum jp_acting_limit limit, const struct jp_arc *arc,
                              int32_t x)
{
    if (limit == JP_ACTING_SPEED) {
        return slope - multiply31(push, arc->stretch);
    }

    unsigned zeros;
    uint32_t inverse = jp_reciprocal(jp_magnitude32(x) | 1U, &zeros);
    int64_t by_turn_rate = ((int64_t)push * inverse) >> (35 - zeros);

    return jp_saturate32(x > 0 ? slope - by_turn_rate : slope + by_turn_rate);
}

/* P/ξ and the energy, less a constant, with 1/ξ kept as the next guess. */
static void set_xi(struct jp_evaluation *e, const struct jp_segment_problem *p, int32_t xi)
{
    unsigned zeros;

    e->xi = xi;
    e->inverse.mantissa = jp_reciprocal((uint32_t)xi, &zeros);
    e->inverse.exponent = (int)zeros - 2;

    uint32_t power = (uint32_t)p->power << zeros;

    e->idle = (int32_t)(((uint64_t)power * e->inverse.mantissa) >> 32);
}

void jp_segment_evaluate(const struct jp_segment_problem *p, int32_t x, enum jp_acting_limit inside,
                         struct jp_evaluation *e)
{
    struct jp_arc arc;

    jp_arc_at(x, &arc);
    e->x = x;

    int32_t s = (int32_t)((uint32_t)p->bearing - (uint32_t)x);

    set_xi(e, p, jp_segment_best_xi(p, x, s, &arc, &e->inverse, &e->limit));

    int32_t v = multiply30(arc.shape, e->xi);
    int32_t w = multiply30(x, e->xi);
    int32_t friction_v = multiply31(p->fv2, arc.shape);
    int32_t friction_w = multiply31(p->fw2, x);

    /* Partial derivatives of J with respect to v′, w′ and s; the friction's with respect to the arc. */
    int32_t by_v =
        (int32_t)(((int64_t)p->vv2 * v + (int64_t)p->vw * w + (int64_t)p->vs * s) >> 31) + p->lv + friction_v;
    int32_t by_w =
        (int32_t)(((int64_t)p->ww2 * w + (int64_t)p->vw * v + (int64_t)p->ws * s) >> 31) + p->lw + friction_w;
    int32_t by_s = (int32_t)(((int64_t)p->ss2 * s + (int64_t)p->vs * v + (int64_t)p->ws * w) >> 31) + p->ls;

    e->energy =
        (int32_t)(((int64_t)(by_v + p->lv) * v + (int64_t)(by_w + p->lw) * w + (int64_t)(by_s + p->ls) * s) >> 32) +
        e->idle;

    int32_t v_part = multiply31(by_v, v);
    int32_t slope = multiply31(v_part, arc.stretch) + (int32_t)((int64_t)by_w * e->xi >> 34) - (by_s >> 4);

    e->slope = slope;
    e->slope_inside = slope;
    if (e->limit != JP_ACTING_NONE) {
        /* Along ξ the friction grows once, not twice. */
        int32_t push = v_part + multiply31(by_w, w) -
                       (int32_t)(((int64_t)friction_v * v + (int64_t)friction_w * w) >> 32) - e->idle;

        e->slope = slope_on_limit(slope, push, e->limit, &arc, x);
        if (inside != JP_ACTING_NONE) {
            e->slope_inside = inside == e->limit ? e->slope : slope_on_limit(slope, push, inside, &arc, x);
        }
    }
}
