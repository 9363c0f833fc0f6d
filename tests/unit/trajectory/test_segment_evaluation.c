/* The energy over one arc, as segment_problem.h states it, in double: the best duration, its limits, the slope, and the
 * search over the arcs. */
#include <joulepath/tables.h>
#include <stddef.h>

#include "src/base/integer.h"
#include "src/trajectory/segment_geometry.h"
#include "src/trajectory/segment_math.h"
#include "src/trajectory/segment_search.h"
#include "unity.h"

/* Of coefficients with 27 bits: what roundings add up to. */
#define ROUNDING 48

enum { ARCS = 17, DURATIONS = 16, PROBLEMS = 24 };

static struct jp_segment_problem problem;
static int32_t reach;

void setUp(void)
{
}

void tearDown(void)
{
}

/* Robots that stand, are slow, fast and turn; targets near and far, to all sides; limits wide and narrow. */
static void make(unsigned number)
{
    static const struct jp_motion before[] = {
        {0, 0}, {JP_Q24(0.3), JP_Q24(0.05)}, {JP_Q24(0.8), -JP_Q24(0.2)}, {JP_Q24(0.1), JP_Q24(0.3)}};
    static const jp_q16 targets[][2] = {{JP_Q16(5), JP_Q16(1)},    {JP_Q16(-2), JP_Q16(3)}, {JP_Q16(0.3), JP_Q16(-0.2)},
                                        {JP_Q16(20), JP_Q16(-20)}, {JP_Q16(1), JP_Q16(4)},  {JP_Q16(-6), JP_Q16(-1)}};
    static const struct jp_segment_limits limits[] = {{JP_Q24(1), JP_Q24(0.35), JP_Q24(1.4), JP_Q16(600)},
                                                      {JP_Q24(0.15), JP_Q24(2), JP_Q24(1.4), JP_Q16(600)},
                                                      {JP_Q24(1), JP_Q24(0.03), JP_Q24(1.4), JP_Q16(600)},
                                                      {JP_Q24(0.2), JP_Q24(0.05), JP_Q24(1.4), JP_Q16(300)}};
    const struct jp_energy_model *model = &jp_energy_model_published;
    const struct jp_segment_limits *limit = &limits[number / 6U];
    const struct jp_point start = {0, 0};
    const struct jp_point target = {targets[number % 6U][0], targets[number % 6U][1]};
    struct jp_voltage_terms voltage;
    uint32_t distance;
    jp_angle direction;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_segment_polar(&start, &target, &distance, &direction));
    jp_voltage_terms(model, &before[number % 4U], &voltage);
    jp_segment_problem_build(&problem, model, limit, &before[number % 4U], &voltage, distance, direction,
                             jp_segment_shortest(model->settling_time, limit, distance));
    reach = jp_segment_longest_half_arc(&problem);
}

/* Of an x and a share of the shortest duration, in the unit of the problem. */
static double energy_at(int32_t at, double share)
{
    const struct jp_segment_problem *p = &problem;
    const int32_t turned = (int32_t)((uint32_t)p->bearing - (uint32_t)at);
    struct jp_arc arc;

    jp_arc_at(at, &arc);

    const double r = arc.shape * 0x1p-31;
    const double x = at * 0x1p-31;
    const double s = turned * 0x1p-31;
    const double v = r * share;
    const double w = x * share;

    return 0.5 * p->vv2 * v * v + (double)p->vw * v * w + 0.5 * p->ww2 * w * w + (p->vs * v + p->ws * w) * s +
           0.5 * p->ss2 * s * s + p->lv * v + p->lw * w + p->ls * s + 0.5 * (p->fv2 * r * r + p->fw2 * x * x) * share +
           p->power / share;
}

/* The largest share that the limits allow, and what of them sets it. */
static double largest_share(int32_t at, enum jp_acting_limit *limit)
{
    const double size = (at < 0 ? -(double)at : at) * 0x1p-31;
    struct jp_arc arc;
    double most = 1.0;

    jp_arc_at(at, &arc);
    *limit = JP_ACTING_NONE;
    if (problem.speed_limit < INT32_MAX && problem.speed_limit * 0x1p-27 * (arc.sinc * 0x1p-29) < most) {
        most = problem.speed_limit * 0x1p-27 * (arc.sinc * 0x1p-29);
        *limit = JP_ACTING_SPEED;
    }
    if (problem.turn_rate_limit * 0x1p-31 < most * size) {
        most = problem.turn_rate_limit * 0x1p-31 / size;
        *limit = JP_ACTING_TURN_RATE;
    }
    return most;
}

static struct jp_evaluation evaluate(int32_t at)
{
    struct jp_evaluation e;

    e.inverse.mantissa = 0;
    jp_segment_evaluate(&problem, at, JP_ACTING_NONE, &e);
    return e;
}

static int32_t arc_number(int i)
{
    return (int32_t)((int64_t)reach * (2 * i - (ARCS - 1)) / (ARCS - 1));
}

static void expect_best(int32_t at)
{
    const struct jp_evaluation e = evaluate(at);
    const double share = e.xi * 0x1p-30;
    const double shortest = problem.xi_min * 0x1p-30;
    enum jp_acting_limit limit;
    const double most = largest_share(at, &limit);
    const double best = energy_at(at, share);

    TEST_ASSERT_TRUE(share <= most * 1.000001 + 1e-7 || e.xi == problem.xi_min);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(problem.xi_min, e.xi);
    TEST_ASSERT_INT32_WITHIN(ROUNDING, (int32_t)best, e.energy);
    TEST_ASSERT_INT32_WITHIN(ROUNDING, (int32_t)(problem.power / share), e.idle);
    for (int i = 0; i <= DURATIONS && most > shortest; i++) {
        TEST_ASSERT_TRUE(best <= energy_at(at, shortest + (most - shortest) * i / DURATIONS) + ROUNDING);
        TEST_ASSERT_TRUE(best <= energy_at(at, share + (most - share) * i / DURATIONS) + ROUNDING);
    }
    if (e.limit != JP_ACTING_NONE) {
        TEST_ASSERT_EQUAL_INT(limit, e.limit);
        TEST_ASSERT_TRUE(share > most * 0.99999);
    } else {
        TEST_ASSERT_TRUE(limit == JP_ACTING_NONE || share < most || most <= shortest * 1.00001);
    }
}

static void test_the_best_duration_of_each_arc(void)
{
    for (unsigned k = 0; k < (unsigned)PROBLEMS; k++) {
        make(k);
        for (int i = 0; i < (int)ARCS; i++) {
            expect_best(arc_number(i));
        }
    }
}

/* A guess may be far off. */
static void test_a_guess_changes_nothing(void)
{
    for (unsigned k = 0; k < (unsigned)PROBLEMS; k++) {
        make(k);
        for (int exponent = 0; exponent < 12; exponent += 3) {
            struct jp_evaluation e = evaluate(reach / 3);
            const int32_t xi = e.xi;

            e.inverse = (struct jp_inverse){(uint32_t)Q30_ONE + ((uint32_t)Q30_ONE >> 1), exponent};
            jp_segment_evaluate(&problem, reach / 3, JP_ACTING_NONE, &e);
            TEST_ASSERT_INT32_WITHIN(xi >> 9, xi, e.xi);
        }
    }
}

static void test_the_slope_is_that_of_the_energy(void)
{
    const int32_t step = (int32_t)1 << 22;
    unsigned compared = 0;

    for (unsigned k = 0; k < (unsigned)PROBLEMS; k++) {
        make(k);
        for (int i = 1; i + 1 < (int)ARCS; i++) {
            const int32_t at = arc_number(i) + 12345;
            const struct jp_evaluation here = evaluate(at);
            const struct jp_evaluation more = evaluate(at + step);
            const struct jp_evaluation less = evaluate(at - step);

            if (more.limit == here.limit && less.limit == here.limit && jp_absolute32(at) < reach - 2 * step) {
                const int64_t slope = ((int64_t)more.energy - less.energy) * 16; /* by 2^-8, of dJ/dx/16 */

                TEST_ASSERT_INT32_WITHIN(800 + jp_absolute32(here.slope) / 50, (int32_t)slope, here.slope);
                TEST_ASSERT_TRUE(here.limit != JP_ACTING_NONE || here.slope_inside == here.slope);
                compared++;
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(200, compared);
}

/* No arc of a fine grid takes a ten-thousandth less, and few evaluations find it. */
static void test_the_search_finds_the_least_in_few_evaluations(void)
{
    int used = 0;

    for (unsigned k = 0; k < (unsigned)PROBLEMS; k++) {
        struct jp_evaluation best = {.x = 0, .xi = 0};
        int evaluations = JP_SEGMENT_EVALUATIONS;

        make(k);
        const int32_t low = jp_saturate32((int64_t)problem.bearing - 954437177); /* 80° of turn */
        const int32_t high = jp_saturate32((int64_t)problem.bearing + 954437177);
        const int32_t from = low < -reach ? -reach : low;
        const int32_t to = high > reach ? reach : high;

        if (from < to) {
            jp_segment_find_minimum(&problem, from, to, &evaluations, &best);
            used += JP_SEGMENT_EVALUATIONS - evaluations;
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(from, best.x);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(to, best.x);
            for (int i = 0; i <= 64; i++) {
                const struct jp_evaluation e = evaluate(from + (int32_t)(((int64_t)to - from) * i / 64));

                TEST_ASSERT_LESS_OR_EQUAL_INT32(e.energy + (e.idle >> 13), best.energy);
            }
        }
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT32(64, used);
}

static uint32_t state;

static int32_t any(int32_t low, int32_t high)
{
    state = state * 1664525U + 1013904223U;
    return low + (int32_t)(((uint64_t)state * (uint32_t)(high - low + 1)) >> 32);
}

/* Limits that act on a part of the arcs alone, so that the slope jumps in between. */
static void make_any(void)
{
    const struct jp_energy_model *model = &jp_energy_model_published;
    const struct jp_segment_limits limit = {any(JP_Q24(0.1), JP_Q24(0.7)), any(JP_Q24(0.01), JP_Q24(0.15)), JP_Q24(1.4),
                                            JP_Q16(600)};
    const struct jp_motion before = {any(0, JP_Q24(0.8)), any(-JP_Q24(0.2), JP_Q24(0.2))};
    const struct jp_point start = {0, 0};
    const struct jp_point target = {any(-JP_Q16(8), JP_Q16(8)), any(-JP_Q16(8), JP_Q16(8))};
    struct jp_voltage_terms voltage;
    uint32_t distance;
    jp_angle direction;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_segment_polar(&start, &target, &distance, &direction));
    jp_voltage_terms(model, &before, &voltage);
    jp_segment_problem_build(&problem, model, &limit, &before, &voltage, distance, direction,
                             jp_segment_shortest(model->settling_time, &limit, distance));
    reach = jp_segment_longest_half_arc(&problem);
}

/* The longest |x| whose duration is not beyond the longest: a little beyond it, it is. */
static void test_the_reach_is_where_the_longest_duration_ends(void)
{
    unsigned within = 0;

    state = 2;
    for (unsigned k = 0; k < 60U; k++) {
        make_any();
        enum jp_acting_limit limit;
        const double shortest = problem.xi_min * 0x1p-30;

        TEST_ASSERT_TRUE(largest_share(reach, &limit) >= shortest * 0.9999);
        if (reach < JP_HALF_ARC_MAX - (1 << 20)) {
            TEST_ASSERT_TRUE(largest_share(reach + (1 << 20), &limit) < shortest * 1.0001);
            within++;
        }
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, within);
}

static void test_the_search_passes_kinks_in_few_evaluations(void)
{
    int used = 0;

    state = 1;
    for (unsigned k = 0; k < 100U; k++) {
        struct jp_evaluation best = {.x = 0, .xi = 0};
        int evaluations = JP_SEGMENT_EVALUATIONS;

        make_any();
        const int32_t low = jp_saturate32((int64_t)problem.bearing - 954437177);
        const int32_t high = jp_saturate32((int64_t)problem.bearing + 954437177);
        const int32_t from = low < -reach ? -reach : low;
        const int32_t to = high > reach ? reach : high;

        if (from < to) {
            jp_segment_find_minimum(&problem, from, to, &evaluations, &best);
            used += JP_SEGMENT_EVALUATIONS - evaluations;
            for (int i = 0; i <= 16; i++) {
                const struct jp_evaluation e = evaluate(from + (int32_t)(((int64_t)to - from) * i / 16));

                TEST_ASSERT_LESS_OR_EQUAL_INT32(e.energy + (e.idle >> 13), best.energy);
            }
        }
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT32(229, used);
}

/* One evaluation more, and only a better one is kept. */
static void test_one_arc_more(void)
{
    for (unsigned k = 0; k < (unsigned)PROBLEMS; k++) {
        make(k);
        struct jp_evaluation best = evaluate(reach);
        const struct jp_evaluation worst = best;
        const struct jp_evaluation inner = evaluate(reach / 2);
        int evaluations = 0;

        jp_segment_try(&problem, reach / 2, &evaluations, &best);
        TEST_ASSERT_EQUAL_INT32(worst.x, best.x);
        evaluations = 2;
        jp_segment_try(&problem, reach / 2, &evaluations, &best);
        TEST_ASSERT_EQUAL_INT(1, evaluations);
        TEST_ASSERT_EQUAL_INT32(inner.energy + 8 < worst.energy ? reach / 2 : best.x, best.x);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(worst.energy, best.energy);
        best = inner;
        jp_segment_try(&problem, reach, &evaluations, &best);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(inner.energy, best.energy);
    }
}

/* J of the model for the same arc and duration. */
static double joules_of(const struct jp_energy_model *model, const struct jp_motion *before, double distance,
                        double time_min, int32_t at, double share)
{
    const double pi = 3.14159265358979323846;
    const int32_t turned = (int32_t)((uint32_t)problem.bearing - (uint32_t)at);
    const double duration = time_min / share;
    struct jp_arc arc;
    jp_q16 energy;

    jp_arc_at(at, &arc);
    const struct jp_segment_command command = {
        .motion = {.speed = (jp_q24)(16 * distance * (arc.shape * 0x1p-31) / duration * 0x1p24),
                   .turn_rate = (jp_q24)(2 * pi * (at * 0x1p-31) / duration * 0x1p24)},
        .turn = (jp_q24)(pi * (turned * 0x1p-31) * 0x1p24),
        .duration = (jp_q16)(duration * 65536)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_energy_predict(model, before, &command, &energy));
    return energy / 65536.0;
}

/* Of models of which every part counts, and robots in motion: the problem differs from the model by a factor, which is
 * that of the idle power, and a constant. */
static void test_a_problem_is_the_energy_of_its_model(void)
{
    static const struct jp_motion before = {JP_Q24(0.3), JP_Q24(0.15)};
    const struct jp_segment_limits limit = {JP_Q24(1), JP_Q24(0.9), JP_Q24(3), JP_Q16(200)};
    struct jp_voltage_terms voltage;

    for (int i = -1; i < JP_ENERGY_TERMS; i++) {
        struct jp_energy_model model = jp_energy_model_published;
        const double distance = 3.0;

        if (i >= 0) {
            model.a[i] += JP_Q16(12);
        }
        const jp_q16 time_min = jp_segment_shortest(model.settling_time, &limit, (uint32_t)(distance * 0x1p22));

        jp_voltage_terms(&model, &before, &voltage);
        jp_segment_problem_build(&problem, &model, &limit, &before, &voltage, (uint32_t)(distance * 0x1p22),
                                 JP_ANGLE_DEGREES(40), time_min);
        const double shortest = time_min / 65536.0;
        const double unit = model.electronics_power / 65536.0 * shortest / problem.power;
        const double constant = joules_of(&model, &before, distance, shortest, 0, 0.5) - energy_at(0, 0.5) * unit;

        for (int k = 0; k < 12; k++) {
            const int32_t at = (k - 5) * (1 << 27);
            const double share = 0.3 + 0.05 * k;
            const double joules = joules_of(&model, &before, distance, shortest, at, share);

            TEST_ASSERT_INT32_WITHIN(400, (int32_t)(joules * 1e4),
                                     (int32_t)((energy_at(at, share) * unit + constant) * 1e4));
        }
    }
}
