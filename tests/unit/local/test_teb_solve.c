/* The solution of banded normal equations against that of the same as dense ones in double; what they are is tested
 * with the residuals. */
#include <string.h>

#include "src/local/teb_solve.h"

#include "src/local/teb_band.h"
#include "src/local/teb_residuals.h"
#include "tests/support/teb_rig.h"

/* Of steps of about 1: what keeps idle variables in their places moves the others a little, and so does rounding. */
#define TOLERANCE 5.0e-4f

/* What the solver adds to the diagonal. */
#define DIAGONAL 1.0e-4

enum { ROWS_MAX = JP_TEB_BLOCK * JP_TEB_POSES_MAX };

static double normal[ROWS_MAX][ROWS_MAX];
static double step[ROWS_MAX];

static unsigned rows(void)
{
    return (unsigned)JP_TEB_BLOCK * teb.count;
}

void setUp(void)
{
    rig_reset();
    memset(normal, 0, sizeof normal);
}

void tearDown(void)
{
}

/* ---- Dense, in double ---- */

static void put(unsigned row, unsigned column, const struct jp_teb_row *values)
{
    const float all[JP_TEB_BLOCK] = {values->x, values->y, values->heading, values->interval};

    for (unsigned k = 0; k < JP_TEB_BLOCK; k++) {
        normal[row][column + k] = (double)all[k];
        normal[column + k][row] = (double)all[k];
    }
}

/* As they are put together; far blocks of the first poses and the near one of the first are empty. */
static void put_pose(unsigned pose)
{
    const unsigned row = JP_TEB_BLOCK * pose;
    struct jp_teb_factor equations;
    const struct jp_teb_triangle *const own = &equations.own;

    jp_teb_assemble(&teb, pose, &equations);
    for (unsigned i = 0; i < JP_TEB_BLOCK; i++) {
        if (pose > 1U && i + 1U < JP_TEB_BLOCK) {
            put(row + i, row - 2U * JP_TEB_BLOCK, &equations.far[i]);
        }
        if (pose > 0U) {
            put(row + i, row - JP_TEB_BLOCK, &equations.near[i]);
        }
    }
    put(row, row, &(struct jp_teb_row){own->xx, own->yx, own->heading_x, own->interval_x});
    put(row + 1U, row, &(struct jp_teb_row){own->yx, own->yy, own->heading_y, own->interval_y});
    put(row + 2U, row,
        &(struct jp_teb_row){own->heading_x, own->heading_y, own->heading_heading, own->interval_heading});
    put(row + 3U, row,
        &(struct jp_teb_row){own->interval_x, own->interval_y, own->interval_heading, own->interval_interval});
    step[row] = (double)equations.step.x;
    step[row + 1U] = (double)equations.step.y;
    step[row + 2U] = (double)equations.step.heading;
    step[row + 3U] = (double)equations.step.interval;
}

/* Gaussian elimination, which knows nothing of symmetry or bands. */
static void solve_dense(double damping)
{
    for (unsigned pose = 0; pose < teb.count; pose++) {
        put_pose(pose);
    }
    for (unsigned i = 0; i < rows(); i++) {
        normal[i][i] += damping * normal[i][i] + DIAGONAL;
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

/* ---- Random bands ---- */

/* All of it acts: bends, changes of speed, obstacles on the way. */
static void linearise_band(unsigned poses)
{
    struct jp_teb_config config = rig_band();
    float x = 0.0f;
    float heading = 0.0f;

    config.weights =
        (struct jp_teb_weights){5.0f, 3.0f, 4.0f, 2.0f, 1.0f, 2.0f, 7.0f, 2.0f, 3.0f, 1.0f, 2.0f, 4.0f, 2.0f, 5.0f};
    rig_init(&config);
    rig_straight(20.0f);
    task.measured = task.start;
    task.is_measured = true;
    teb.internal.task = task;
    teb.internal.obstacles = &obstacles;
    teb.count = (uint8_t)poses;
    for (unsigned i = 0; i < poses; i++) {
        jp_teb_set_pose(&teb.poses[i], &(struct jp_plane_pose){x, rig_random(0.1f), heading});
        teb.poses[i].interval = 0.25f + rig_random(0.1f);
        x += 0.2f + rig_random(0.2f);
        heading = rig_random(0.5f);
        if (i % 4U == 0U && obstacles.count < JP_OBSTACLES_MAX) {
            rig_disc(x, 0.35f, 0.1f);
        }
    }
    teb.internal.work = 0;
    jp_teb_find_feet(&teb);
    jp_teb_find_obstacles(&teb);
    (void)jp_teb_linearise(&teb, FLT_MAX);
    teb.internal.kept_terms ^= 1U;
}

static struct jp_teb_terms *kept(unsigned pose)
{
    return &teb.internal.terms[teb.internal.kept_terms][pose];
}

static void assert_same_step(void)
{
    for (unsigned i = 0; i < teb.count; i++) {
        const struct jp_teb_row *const found = &teb.internal.factor[i].step;
        const double *const exact = &step[JP_TEB_BLOCK * i];

        TEST_ASSERT_NEAR(TOLERANCE, (float)exact[0], found->x);
        TEST_ASSERT_NEAR(TOLERANCE, (float)exact[1], found->y);
        TEST_ASSERT_NEAR(TOLERANCE, (float)exact[2], found->heading);
        TEST_ASSERT_NEAR(TOLERANCE, (float)exact[3], found->interval);
    }
}

static void assert_solution(float damping)
{
    teb.internal.damping = damping;
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    solve_dense((double)damping);
    assert_same_step();
}

static void test_solution_of_bands_of_every_length(void)
{
    for (unsigned poses = JP_TEB_POSES_MIN; poses <= 12U; poses++) {
        setUp();
        linearise_band(poses);
        assert_solution(0.01f);
    }
}

static void test_solution_of_the_longest_band(void)
{
    linearise_band(JP_TEB_POSES_MAX);
    assert_solution(0.01f);
}

static void test_damping_scales_the_diagonal(void)
{
    linearise_band(9);
    assert_solution(0.5f);
}

static void test_much_damping_is_a_short_step_downhill(void)
{
    linearise_band(9);
    assert_solution(1.0e4f);
    for (unsigned i = 0; i < teb.count; i++) {
        TEST_ASSERT_NEAR(1e-3f, 0.0f, teb.internal.factor[i].step.x);
    }
}

static void test_fixed_start_and_goal_do_not_move_and_the_others_know(void)
{
    for (unsigned run = 0; run < 4U; run++) {
        setUp();
        linearise_band(9);
        teb.internal.task.is_measured = run % 2U == 0U;
        teb.internal.task.is_heading_free = run < 2U;
        assert_solution(0.01f);

        const struct jp_teb_row *const first = &teb.internal.factor[0].step;
        const struct jp_teb_row *const last = &teb.internal.factor[8].step;

        TEST_ASSERT_TRUE((first->x == 0.0f && first->y == 0.0f && first->heading == 0.0f) == (run % 2U == 1U));
        TEST_ASSERT_TRUE(last->x == 0.0f && last->y == 0.0f && last->interval == 0.0f);
        TEST_ASSERT_TRUE((last->heading == 0.0f) == (run >= 2U));
    }
}

static void test_variable_that_nothing_acts_on_stays(void)
{
    linearise_band(6);
    memset(teb.internal.terms, 0, sizeof teb.internal.terms);
    for (unsigned i = 0; i < teb.count; i++) {
        kept(i)->pose = (struct jp_teb_pose_terms){.xx = 1.0f, .heading_heading = 4.0f, .x = 1.0f, .heading = 2.0f};
    }
    TEST_ASSERT_TRUE(jp_teb_solve(&teb));
    for (unsigned i = 0; i + 1U < teb.count; i++) {
        TEST_ASSERT_TRUE(teb.internal.factor[i].step.y == 0.0f && teb.internal.factor[i].step.interval == 0.0f);
        TEST_ASSERT_TRUE(teb.internal.factor[i].step.x < 0.0f && teb.internal.factor[i].step.heading < 0.0f);
    }
}

static float *diagonal(unsigned row)
{
    struct jp_teb_terms *const terms = kept(row / JP_TEB_BLOCK);
    float *const entries[JP_TEB_BLOCK] = {&terms->pose.xx, &terms->pose.yy, &terms->pose.heading_heading,
                                          &terms->step.interval_interval};

    return entries[row % JP_TEB_BLOCK];
}

static void test_equations_that_are_not_positive_definite_are_refused(void)
{
    for (unsigned i = 0; i < (unsigned)JP_TEB_BLOCK * 5U; i++) {
        setUp();
        linearise_band(6);
        *diagonal(i) = -1.0e6f;
        TEST_ASSERT_FALSE(jp_teb_solve(&teb));
    }
}

static void test_equations_that_are_not_numbers_are_refused(void)
{
    volatile float large = FLT_MAX; /* the compiler must not see that it overflows */
    const float infinity = large * 2.0f;

    linearise_band(6);
    kept(2)->step.length_turn = infinity - infinity;
    TEST_ASSERT_FALSE(jp_teb_solve(&teb));
}
