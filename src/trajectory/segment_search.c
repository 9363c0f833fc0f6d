#include "src/trajectory/segment_search.h"

#include <stdbool.h>

#include "src/base/compiler.h"
#include "src/base/integer.h"
#include "src/trajectory/segment_arc.h"
#include "src/trajectory/segment_math.h"

/* Gains below these parts (2⁻ⁿ) of Ps T end the search: between tangents, at a limit, and without a limit, where one
 * evaluation more also gives the direction of a flat minimum. */
#define FLAT_SHIFT        14
#define GAIN_SHIFT        14
#define GAIN_SHIFT_SMOOTH 18

/* Of x: a point this far outside a kink is outside in spite of rounding. */
#define KINK_MARGIN 1024

/* The ends of the bracket have ξ = 0 until they are found. */
struct search {
    const struct jp_segment_problem *problem;
    struct jp_evaluation left, right;
    int32_t low, high;
    uint32_t step, slope;                         /* of the last step down */
    bool flat;                                    /* the tangents promised no gain */
    enum jp_acting_limit left_limit, right_limit; /* of the last bracket */
    enum jp_acting_limit inside;                  /* that acts inside the last kink */
    int32_t kink_xi;
};

/* Energy along a slope; twice what a parabola gains when the step leads to its minimum. */
static JP_INLINE_FOR_SPEED int64_t gain(uint32_t slope, uint32_t step)
{
    return (int64_t)(((uint64_t)slope * step) >> 27);
}

/* Before there is a bracket */

/* A first step from one evaluation by the curvature of σ² and of the arc's length. */
static uint32_t first_step(const struct jp_segment_problem *p, const struct jp_evaluation *e)
{
    int64_t curvature = ((int64_t)p->ss2 + 6 * (int64_t)e->idle) >> 5; /* below 2²⁹ */
    uint32_t slope = jp_magnitude32(e->slope) >> 1;

    if (curvature <= 0) {
        curvature = 1;
    }
    if (slope >= (uint32_t)curvature) {
        return (uint32_t)1 << 31;
    }
    return (uint32_t)jp_fraction30(slope, (uint32_t)curvature) << 1;
}

/* A further step in the same direction: to where the slopes lead, at most four times the last. */
static uint32_t next_step(uint32_t step, uint32_t last_slope, uint32_t slope)
{
    uint32_t longest = step < (1U << 29) ? 4U * step : 1U << 31;
    uint32_t change = last_slope > slope ? last_slope - slope : 0U;

    if (slope / 4U >= change) {
        return longest;
    }

    uint32_t ahead = (uint32_t)(((uint64_t)step * (uint32_t)jp_fraction30(slope >> 2, change)) >> 28);

    return ahead < longest ? ahead : longest;
}

/*
 * Where to look next on the way down from e. False if J* will not fall below `best` there or hardly at all. J* is not
 * quite convex and the step is a guess, so twice the tangent's fall over twice the step is allowed for: eight times
 * what a parabola would give.
 */
static bool step_down(struct search *search, const struct jp_evaluation *e, const struct jp_evaluation *best,
                      int32_t *x)
{
    bool rightward = e->slope < 0;
    int32_t end = rightward ? search->high : search->low;
    uint32_t room = rightward ? (uint32_t)end - (uint32_t)e->x : (uint32_t)e->x - (uint32_t)end;
    uint32_t slope = jp_magnitude32(e->slope);
    uint32_t step =
        search->slope == 0U ? first_step(search->problem, e) : next_step(search->step, search->slope, slope);

    if (e->energy - 2 * gain(slope, step < room / 2U ? 2U * step : room) > best->energy ||
        gain(slope, step) <= e->idle >> GAIN_SHIFT_SMOOTH) {
        return false;
    }
    search->step = step;
    search->slope = slope;
    if (step >= room) {
        *x = end;
    } else {
        *x = (int32_t)(rightward ? (uint32_t)e->x + step : (uint32_t)e->x - step);
    }
    return true;
}

/* Inside a bracket */

/* What the energies and slopes at the ends of a bracket say about the minimum; steps from the left end. */
struct forecast {
    bool convex;    /* the tangents meet between the ends */
    uint32_t cubic; /* the step to the minimum of the cubic */
    int64_t floor;  /* the energy where the tangents meet */
};

/*
 * The minimum of the cubic through two energies and slopes, as a fraction of the bracket in Q30: the root t of
 * 6k t² + (1 − 6k) t = secant, where k + ½ is the place at which the tangents meet.
 */
static uint32_t cubic_minimum(uint32_t secant, uint32_t tangents)
{
    int32_t k6 = 6 * (int32_t)(((int32_t)tangents - Q30_ONE / 2) >> 4); /* Q26, within ±3 */
    int32_t linear = (Q30_ONE >> 4) - k6;
    int64_t square = (int64_t)linear * linear + 4 * (int64_t)k6 * (int32_t)(secant >> 4); /* Q52, 0…16 */
    uint32_t radicand = (uint32_t)(square >> 26);
    int64_t root = (int64_t)jp_square_root32(radicand | (uint32_t)(radicand == 0U)) << 13;
    int64_t denominator = linear + root;

    if (denominator <= (int64_t)(secant >> 3)) {
        return Q30_ONE;
    }
    return (uint32_t)jp_fraction30(secant >> 3, (uint32_t)denominator);
}

static uint32_t part_of(uint32_t width, uint32_t fraction)
{
    return (uint32_t)(((uint64_t)width * fraction) >> 30);
}

static struct forecast forecast(const struct jp_evaluation *a, const struct jp_evaluation *b)
{
    uint32_t width = (uint32_t)b->x - (uint32_t)a->x;
    uint32_t half = width >> 1;
    uint32_t down = jp_magnitude32(a->slope);
    uint32_t up = (uint32_t)b->slope;
    uint64_t all = ((uint64_t)down + up) * half;
    int64_t part = (int64_t)((uint64_t)up * half) + ((int64_t)a->energy - b->energy) * ((int64_t)1 << 26);
    unsigned shift = (all >> 32) == 0U ? 0U : 32U - jp_leading_zeros((uint32_t)(all >> 32));
    uint32_t whole = (uint32_t)(all >> shift);

    part >>= shift;

    bool convex = part > 0 && part < (int64_t)whole;
    uint32_t meet = convex ? (uint32_t)jp_fraction30((uint32_t)part, whole) : Q30_ONE / 2;
    uint32_t tangents = part_of(width, meet);

    return (struct forecast){
        .convex = convex,
        .cubic = part_of(width, cubic_minimum((uint32_t)jp_fraction30(down, down + up), meet)),
        .floor = a->energy - gain(down, tangents),
    };
}

/* Where in a bracket to look next: at the cubic's minimum. False if that promises no gain on `best`. */
static bool step_inside(struct search *search, const struct jp_evaluation *best, int32_t *x)
{
    const struct jp_evaluation *a = &search->left;
    const struct jp_evaluation *b = &search->right;
    struct forecast f = forecast(a, b);
    uint32_t width = (uint32_t)b->x - (uint32_t)a->x;
    uint32_t margin = width >> 8;
    bool smooth = a->limit == JP_ACTING_NONE && b->limit == JP_ACTING_NONE;
    bool flat = !smooth && best->energy - f.floor <= best->idle >> FLAT_SHIFT;
    int64_t least_gain = best->idle >> (smooth ? GAIN_SHIFT_SMOOTH : GAIN_SHIFT);

    if (f.convex &&
        (f.floor > best->energy || (flat && search->flat) || gain(jp_magnitude32(a->slope), f.cubic) <= least_gain ||
         gain((uint32_t)b->slope, width - f.cubic) <= least_gain)) {
        return false;
    }

    search->flat = flat;

    uint32_t step = f.cubic < margin ? margin : f.cubic > width - margin ? width - margin : f.cubic;

    *x = (int32_t)((uint32_t)a->x + step);
    return true;
}

/* Kinks: where another limit begins to act, the slope of J* jumps, and J* may have its minimum there. */

/* The |x| at which the limit of the turn rate allows this ξ. */
static int32_t turn_rate_kink(const struct jp_segment_problem *p, int32_t xi)
{
    return jp_quotient31(p->turn_rate_limit >> 1, xi);
}

/* The |x| at which the limit of the speed allows this ξ. */
static int32_t speed_kink(const struct jp_segment_problem *p, int32_t xi)
{
    uint32_t part = (uint32_t)xi >> 3;

    if (part >= (uint32_t)p->speed_limit) {
        return 0;
    }
    return jp_arc_of_sinc(jp_fraction30(part, (uint32_t)p->speed_limit) >> 1);
}

/* The |x| up to ½ at which both limits allow the same ξ; beyond ½ it is 1 − x. Where both act the limit of the turn
 * rate is below 1/π of that of the speed. */
static int32_t corner(const struct jp_segment_problem *p)
{
    return jp_arc_of_half_chord(jp_fraction30((uint32_t)p->turn_rate_limit >> 4, (uint32_t)p->speed_limit));
}

/* Where another limit begins to act between `inner` and `outer`, just outside, and the ξ there. */
static bool find_kink(const struct jp_segment_problem *p, const struct jp_evaluation *inner,
                      const struct jp_evaluation *outer, int32_t *x, int32_t *xi)
{
    int32_t size;

    if (outer->limit == JP_ACTING_NONE || outer->limit == inner->limit) {
        return false;
    }
    *xi = inner->xi;
    if (inner->limit != JP_ACTING_NONE) {
        size = outer->limit == JP_ACTING_TURN_RATE ? corner(p) : INT32_MAX - corner(p);
        *xi = p->turn_rate_limit < size ? jp_fraction30((uint32_t)p->turn_rate_limit, (uint32_t)size) : Q30_ONE;
    } else if (outer->limit == JP_ACTING_TURN_RATE) {
        size = turn_rate_kink(p, inner->xi);
    } else {
        size = speed_kink(p, inner->xi);
    }
    if (size >= JP_HALF_ARC_MAX - KINK_MARGIN) {
        return false;
    }
    *x = outer->x < 0 ? -size - KINK_MARGIN : size + KINK_MARGIN;
    return true;
}

/* Whether a kink lies in the bracket that was not looked at yet. */
static bool step_to_kink(struct search *search, int32_t *x)
{
    const struct jp_evaluation *left = &search->left;
    const struct jp_evaluation *right = &search->right;
    bool left_inside = jp_magnitude32(left->x) < jp_magnitude32(right->x);
    const struct jp_evaluation *inner = left_inside ? left : right;
    const struct jp_evaluation *outer = left_inside ? right : left;
    int32_t kink;

    if (left->limit == search->left_limit && right->limit == search->right_limit) {
        return false;
    }
    search->left_limit = left->limit;
    search->right_limit = right->limit;
    search->inside = inner->limit;
    if (!find_kink(search->problem, inner, outer, &kink, &search->kink_xi) || kink <= left->x || kink >= right->x) {
        return false;
    }
    *x = kink;
    return true;
}

/* True: the minimum is at the kink just inside e. If it is further inside, e becomes the end of its bracket. */
static bool settle_at_kink(const struct search *search, struct jp_evaluation *e)
{
    if (jp_magnitude32(e->xi - search->kink_xi) > (uint32_t)search->kink_xi >> 14) {
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

/* The whole search */

/* Leaves the ends of the bracket open: clearing them costs more than a step. */
static void begin(struct search *search, const struct jp_segment_problem *problem, int32_t low, int32_t high)
{
    search->problem = problem;
    search->left.xi = 0;
    search->right.xi = 0;
    search->low = low;
    search->high = high;
    search->step = 0;
    search->slope = 0;
    search->flat = false;
    search->left_limit = JP_ACTING_NONE;
    search->right_limit = JP_ACTING_NONE;
    search->inside = JP_ACTING_NONE;
    search->kink_xi = 0;
}

void jp_segment_find_minimum(const struct jp_segment_problem *p, int32_t low, int32_t high, int *evaluations,
                             struct jp_evaluation *best)
{
    struct search search;
    struct jp_evaluation e;
    int32_t x = jp_clamp32(-best->x, low, high); /* the mirror image of the other side's minimum */
    bool at_kink = false;

    begin(&search, p, low, high);
    e.inverse.mantissa = 0;
    while (*evaluations > 0) {
        jp_segment_evaluate(p, x, search.inside, &e);
        (*evaluations)--;
        if (best->xi == 0 || e.energy < best->energy) {
            *best = e;
        }
        if (*evaluations == 0 || (at_kink && settle_at_kink(&search, &e)) || e.slope == 0 ||
            x == (e.slope < 0 ? high : low)) {
            return;
        }
        *(e.slope < 0 ? &search.left : &search.right) = e;

        bool bracketed = search.left.xi != 0 && search.right.xi != 0;

        at_kink = bracketed && step_to_kink(&search, &x);
        if (!at_kink && !(bracketed ? step_inside(&search, best, &x) : step_down(&search, &e, best, &x))) {
            return;
        }
    }
}

void jp_segment_try(const struct jp_segment_problem *p, int32_t x, int *evaluations, struct jp_evaluation *best)
{
    struct jp_evaluation e;

    if (*evaluations == 0) {
        return;
    }
    e.inverse = best->inverse;
    jp_segment_evaluate(p, x, JP_ACTING_NONE, &e);
    (*evaluations)--;
    if (e.energy < best->energy) {
        *best = e;
    }
}
