/* Banded normal equations against dense ones in double. */
#include <string.h>

#include "src/local/teb_solve.h"

#include "tests/support/teb_rig.h"

/* Of steps of about 1: what keeps idle variables in their places moves the others a little, and so does rounding. */
#define TOLERANCE 5.0e-4f

enum { WIDTHS = 3 };
static const unsigned widths[WIDTHS] = {4, 7, 11};

static double normal[JP_TEB_ROWS][JP_TEB_ROWS];
static double gradient[JP_TEB_ROWS];
static double step[JP_TEB_ROWS];

static unsigned rows(void)
{
    return (unsigned)JP_TEB_BLOCK * teb.count;
}

void setUp(void)
{
    rig_reset();
    memset(normal, 0, sizeof normal);
    memset(gradient, 0, sizeof gradient);
}

void tearDown(void)
{
}

/* ---- Dense, in double ---- */

static void add_dense(unsigned first, unsigned width, const float *derivatives, float residual)
{
    const unsigned row = first * JP_TEB_BLOCK;

    for (unsigned a = 0; a < width; a++) {
        gradient[row + a] += (double)derivatives[a] * (double)residual;
        for (unsigned b = 0; b < width; b++) {
            normal[row + a][row + b] += (double)derivatives[a] * (double)derivatives[b];
        }
    }
}

static void fix_dense(unsigned row)
{
    for (unsigned i = 0; i < rows(); i++) {
        normal[row][i] = 0.0;
        normal[i][row] = 0.0;
    }
    normal[row][row] = 1.0;
    gradient[row] = 0.0;
}

/* Gaussian elimination, which knows nothing of symmetry or bands. */
static void solve_dense(double damping)
{
    for (unsigned i = 0; i < rows(); i++) {
        normal[i][i] *= 1.0 + damping;
        step[i] = -gradient[i];
    }
    for (unsigned i = 0; i < rows(); i++) {
        for (unsigned below = i + 1U; below < rows(); below++) {
            const double factor = normal[below][i] / normal[i][i];

            for (unsigned k = i; k < rows() && factor != 0.0; k++) {
                normal[below][k] -= factor * normal[i][k];
            }
            step[below] -= factor * step[i];
        }
    }
    for (unsigned i = rows(); i > 0U; i--) {
        for (unsigned k = i; k < rows(); k++) {
            step[i - 1U] -= normal[i - 1U][k] * step[k];
        }
        step[i - 1U] /= normal[i - 1U][i - 1U];
    }
}

/* ---- Random equations ---- */

static void add_residual(unsigned first, unsigned width, const float *derivatives)
{
    const float residual = rig_random(1.0f);

    jp_teb_add_residual(&teb, first, width, derivatives, residual);
    add_dense(first, width, derivatives, residual);
}

/* One that acts on each variable alone, and some that tie neighbours together. */
static void add_residuals(unsigned poses)
{
    teb.count = (uint8_t)poses;
    jp_teb_clear_equations(&teb);
    for (unsigned i = 0; i < rows(); i++) {
        float derivatives[JP_TEB_BLOCK] = {0};

        derivatives[i % JP_TEB_BLOCK] = 1.0f;
        add_residual(i / JP_TEB_BLOCK, JP_TEB_BLOCK, derivatives);
    }
    for (unsigned i = 0; i < poses; i++) {
        for (unsigned k = 0; k < WIDTHS && i * JP_TEB_BLOCK + widths[k] <= rows(); k++) {
            float derivatives[JP_TEB_BAND] = {0};

            for (unsigned d = 0; d < widths[k]; d++) {
                derivatives[d] = rig_random(1.0f);
            }
            add_residual(i, widths[k], derivatives);
        }
    }
}

static void assert_same_step(void)
{
    for (unsigned i = 0; i < rows(); i++) {
        TEST_ASSERT_NEAR(TOLERANCE, (float)step[i], teb.internal.equations.gradient[i]);
    }
}

static void test_normal_equations_are_those_of_the_residuals(void)
{
    add_residuals(7);
    for (unsigned i = 0; i < rows(); i++) {
        const unsigned block = i / JP_TEB_BLOCK;

        TEST_ASSERT_NEAR(1e-6f, (float)gradient[i], teb.internal.equations.gradient[i]);
        for (unsigned k = 0; k <= i; k++) {
            if (k / JP_TEB_BLOCK + 2U >= block) {
                TEST_ASSERT_NEAR(2e-6f, (float)normal[i][k],
                                 teb.internal.equations.normal[i][k + 2U * JP_TEB_BLOCK - block * JP_TEB_BLOCK]);
            } else {
                TEST_ASSERT_TRUE(normal[i][k] == 0.0);
            }
        }
    }
}

static void test_solution_of_bands_of_every_length(void)
{
    for (unsigned poses = JP_TEB_POSES_MIN; poses <= 12U; poses++) {
        setUp();
        add_residuals(poses);
        TEST_ASSERT_TRUE(jp_teb_solve(&teb));
        solve_dense(0.0);
        assert_same_step();
    }
}

static void test_solution_of_the_longest_band(void)
{
    add_residuals(JP_TEB_POSES_MAX);
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    solve_dense(0.0);
    assert_same_step();
}

static void test_damping_scales_the_diagonal(void)
{
    add_residuals(9);
    teb.internal.damping = 0.5f;
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    solve_dense(0.5);
    assert_same_step();
}

static void test_much_damping_is_a_short_step_downhill(void)
{
    add_residuals(9);
    teb.internal.damping = 1.0e4f;
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    for (unsigned i = 0; i < rows(); i++) {
        TEST_ASSERT_NEAR(2e-6f, (float)(-gradient[i] / (1.0e4 * normal[i][i])), teb.internal.equations.gradient[i]);
    }
}

static void test_fixed_variables_do_not_move_and_the_others_know(void)
{
    static const unsigned fixed[] = {0, 1, 2, 17, 30, 31, 35};

    add_residuals(9);
    for (unsigned i = 0; i < sizeof fixed / sizeof fixed[0]; i++) {
        jp_teb_fix(&teb, fixed[i]);
        fix_dense(fixed[i]);
    }
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    solve_dense(0.0);
    for (unsigned i = 0; i < sizeof fixed / sizeof fixed[0]; i++) {
        TEST_ASSERT_TRUE(teb.internal.equations.gradient[fixed[i]] == 0.0f);
    }
    assert_same_step();
}

static void test_variable_that_nothing_acts_on_stays(void)
{
    const float derivatives[JP_TEB_BLOCK] = {1.0f, 0.0f, 2.0f, 0.0f};

    teb.count = 4;
    jp_teb_clear_equations(&teb);
    for (unsigned i = 0; i < teb.count; i++) {
        jp_teb_add_residual(&teb, i, JP_TEB_BLOCK, derivatives, 1.0f);
    }
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    for (unsigned i = 0; i < teb.count; i++) {
        TEST_ASSERT_TRUE(teb.internal.equations.gradient[i * JP_TEB_BLOCK + 1U] == 0.0f);
        TEST_ASSERT_TRUE(teb.internal.equations.gradient[i * JP_TEB_BLOCK + 3U] == 0.0f);
        TEST_ASSERT_TRUE(teb.internal.equations.gradient[i * JP_TEB_BLOCK] < 0.0f);
    }
}

static void test_equations_that_are_not_positive_definite_are_refused(void)
{
    for (unsigned i = 0; i < (unsigned)JP_TEB_BLOCK * 6U; i++) {
        setUp();
        add_residuals(6);
        teb.internal.equations.normal[i][2U * JP_TEB_BLOCK + i % JP_TEB_BLOCK] = -1.0f;
        TEST_ASSERT_FALSE(jp_teb_solve(&teb));
    }
}

static void test_equations_that_are_not_numbers_are_refused(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;

    add_residuals(6);
    teb.internal.equations.normal[9][4] = infinity - infinity;
    TEST_ASSERT_FALSE(jp_teb_solve(&teb));
}

static void test_clear_leaves_nothing_of_the_last_equations(void)
{
    add_residuals(6);
    jp_teb_clear_equations(&teb);
    for (unsigned i = 0; i < rows(); i++) {
        TEST_ASSERT_TRUE(teb.internal.equations.gradient[i] == 0.0f);
        for (unsigned k = 0; k < JP_TEB_BAND; k++) {
            TEST_ASSERT_TRUE(teb.internal.equations.normal[i][k] == 0.0f);
        }
    }
}
