/* The best duration of one arc against a search through all of them, by the formula of segment_problem.h in double
 * precision. */
#include "src/trajectory/segment_duration.h"

#include "src/base/integer.h"
#include "src/trajectory/segment_math.h"
#include "tests/target/random.h"
#include "unity.h"

enum { GRID = 400 };

static uint32_t state;
static struct jp_segment_problem problem;
static struct jp_arc arc;

void setUp(void)
{
    state = 41;
}

void tearDown(void)
{
}

static int32_t between(int32_t low, int32_t high)
{
    return low + (int32_t)(target_random(&state) % ((uint32_t)high - (uint32_t)low + 1U));
}

static int32_t coefficient(void)
{
    return between(-(1 << 25), 1 << 25) >> (target_random(&state) % 6U);
}

/* Power that changes a duration within its bounds in about half of the cases. */
static void make_problem(void)
{
    problem = (struct jp_segment_problem){.vv2 = coefficient(),
                                          .vw = coefficient(),
                                          .ww2 = coefficient(),
                                          .vs = coefficient(),
                                          .ws = coefficient(),
                                          .lv = coefficient(),
                                          .lw = coefficient(),
                                          .fv2 = between(0, 1 << 25),
                                          .fw2 = between(0, 1 << 25),
                                          .power = between(1 << 10, 1 << 22) >> (target_random(&state) % 8U),
                                          .speed_limit = between(1 << 24, INT32_MAX),
                                          .turn_rate_limit = between(1 << 26, INT32_MAX),
                                          .xi_min = between(1 << 25, 1 << 28)};
    problem.power_shift = jp_leading_zeros((uint32_t)problem.power) - 3U;
}

static double fraction(int32_t value, int bits)
{
    return (double)value / (double)((int64_t)1 << bits);
}

/* Less what does not depend on the duration. */
static double energy_at(double xi, int32_t x, int32_t s)
{
    const double r = fraction(arc.shape, 31);
    const double bend = fraction(x, 31);
    const double v = r * xi;
    const double w = bend * xi;

    return 0.5 * problem.vv2 * v * v + (double)problem.vw * v * w + 0.5 * problem.ww2 * w * w +
           ((double)problem.vs * v + (double)problem.ws * w) * fraction(s, 31) + (double)problem.lv * v +
           (double)problem.lw * w + 0.5 * ((double)problem.fv2 * r * r + (double)problem.fw2 * bend * bend) * xi +
           (double)problem.power / xi;
}

/* The largest within both limits, and which it is. */
static double limit_at(int32_t x, enum jp_acting_limit *limit)
{
    const double by_speed = fraction(problem.speed_limit, 27) * fraction(arc.sinc, 29);
    const double by_turn = fraction(problem.turn_rate_limit, 31) / (fraction((int32_t)jp_magnitude32(x), 31) + 1.0e-12);
    double high = 1.0;

    *limit = JP_ACTING_NONE;
    if (by_speed < high) {
        high = by_speed;
        *limit = JP_ACTING_SPEED;
    }
    if (by_turn < high) {
        high = by_turn;
        *limit = JP_ACTING_TURN_RATE;
    }
    return high;
}

/* True: it ends at a limit. */
static bool expect_best(int32_t x, int32_t s, const struct jp_inverse *guess)
{
    const double low = fraction(problem.xi_min, 30);
    enum jp_acting_limit acting;
    enum jp_acting_limit found_limit;
    const double high = limit_at(x, &acting);
    const double top = high > low ? high : low;
    const double xi = fraction(jp_segment_best_xi(&problem, x, s, &arc, guess, &found_limit), 30);
    const double found = energy_at(xi, x, s);
    double best = energy_at(top, x, s);

    for (int i = 0; i <= GRID; i++) {
        const double energy = energy_at(low + (top - low) * i / GRID, x, s);

        best = energy < best ? energy : best;
    }
    TEST_ASSERT_TRUE(xi >= low - 1.0e-8 && xi <= top + 1.0e-7);
    /* To 2⁻⁹ of itself, by which the energy changes to second order, and by what rounding of its terms does. */
    TEST_ASSERT_TRUE(found <= best + 64.0 + 1.0e-4 * (double)problem.power / xi);
    if (found_limit != JP_ACTING_NONE) {
        TEST_ASSERT_EQUAL_INT(acting, found_limit);
        TEST_ASSERT_INT32_WITHIN(64, (int32_t)(top * 0x1p30), (int32_t)(xi * 0x1p30));
    }
    return found_limit != JP_ACTING_NONE;
}

static void test_the_best_duration_of_random_problems(void)
{
    unsigned limited = 0;

    for (int i = 0; i < 400; i++) {
        const struct jp_inverse unknown = {0, 0};
        const int32_t x = between(-JP_HALF_ARC_MAX / 2, JP_HALF_ARC_MAX / 2);

        make_problem();
        jp_arc_at(x, &arc);
        limited += expect_best(x, between(-(1 << 30), 1 << 30), &unknown) ? 1U : 0U;
    }
    TEST_ASSERT_TRUE(limited > 20U && limited < 380U);
}

/* From any guess it is the same. */
static void test_a_guess_does_not_matter(void)
{
    for (int i = 0; i < 100; i++) {
        const int32_t x = between(-JP_HALF_ARC_MAX / 2, JP_HALF_ARC_MAX / 2);
        const int32_t s = between(-(1 << 30), 1 << 30);

        make_problem();
        jp_arc_at(x, &arc);
        for (int exponent = 0; exponent < 6; exponent += 2) {
            const struct jp_inverse guess = {(1U << 30) + (target_random(&state) >> 2), exponent};

            (void)expect_best(x, s, &guess);
        }
    }
}
