#include "src/local/teb_solve.h"

#include <string.h>

#include "src/base/plane.h"

/* Keeps a variable that nothing acts on where it is. */
#define DIAGONAL_MIN 1.0e-4f

/* Where a row keeps its block of the diagonal. */
#define DIAGONAL_BLOCK (2U * (unsigned)JP_TEB_BLOCK)

static unsigned row_count(const struct jp_teb *teb)
{
    return (unsigned)JP_TEB_BLOCK * teb->count;
}

/* Where row `row` keeps column `column`, which is in the same block or one of the two before. */
static unsigned place(unsigned row, unsigned column)
{
    return column + DIAGONAL_BLOCK - row / JP_TEB_BLOCK * JP_TEB_BLOCK;
}

void jp_teb_clear_equations(struct jp_teb *teb)
{
    const unsigned rows = row_count(teb);

    (void)memset(teb->internal.equations.normal, 0, rows * sizeof teb->internal.equations.normal[0]);
    (void)memset(teb->internal.equations.gradient, 0, rows * sizeof teb->internal.equations.gradient[0]);
}

void jp_teb_add_residual(struct jp_teb *teb, unsigned first, unsigned width, const float *derivatives, float residual)
{
    const unsigned row = first * JP_TEB_BLOCK;
    float *const gradient = &teb->internal.equations.gradient[row];

    for (unsigned a = 0; a < width; a++) {
        const float derivative = derivatives[a];

        if (derivative != 0.0f) {
            float *const entries =
                &teb->internal.equations.normal[row + a][DIAGONAL_BLOCK - a / JP_TEB_BLOCK * JP_TEB_BLOCK];

            gradient[a] += derivative * residual;
            for (unsigned b = 0; b <= a; b++) {
                entries[b] += derivative * derivatives[b];
            }
        }
    }
}

void jp_teb_fix(struct jp_teb *teb, unsigned row)
{
    const unsigned rows = row_count(teb);
    const unsigned block_end = (row / JP_TEB_BLOCK + 3U) * JP_TEB_BLOCK;
    const unsigned end = block_end < rows ? block_end : rows;

    (void)memset(teb->internal.equations.normal[row], 0, sizeof teb->internal.equations.normal[row]);
    for (unsigned i = row + 1U; i < end; i++) {
        teb->internal.equations.normal[i][place(i, row)] = 0.0f;
    }
    teb->internal.equations.normal[row][place(row, row)] = 1.0f;
    teb->internal.equations.gradient[row] = 0.0f;
}

static float dot(const float *a, const float *b, unsigned count)
{
    float sum = 0.0f;

    for (unsigned i = 0; i < count; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static float dot_block(const float *a, const float *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/* entries −= block × othersᵀ */
static void subtract_product(float *restrict entries, const float *restrict block, const float *others)
{
    for (unsigned i = 0; i < JP_TEB_BLOCK; i++) {
        entries[i] -= dot_block(block, &others[i * JP_TEB_BAND]);
    }
}

/* entries × inverse of factorᵀ, where the factor is a block of the diagonal. */
static void divide_by_factor(float *restrict entries, const float *restrict factor)
{
    const float *const second = &factor[JP_TEB_BAND];
    const float *const third = &factor[2U * JP_TEB_BAND];
    const float *const fourth = &factor[3U * JP_TEB_BAND];
    const float a = entries[0] * factor[0];
    const float b = (entries[1] - a * second[0]) * second[1];
    const float c = (entries[2] - a * third[0] - b * third[1]) * third[2];

    entries[0] = a;
    entries[1] = b;
    entries[2] = c;
    entries[3] = (entries[3] - a * fourth[0] - b * fourth[1] - c * fourth[2]) * fourth[3];
}

/* The entries of a row left of the block of the diagonal. `first` is the first row of its block of rows. */
static void factor_left(struct jp_teb *teb, unsigned first, float *entries)
{
    if (first >= 2U * JP_TEB_BLOCK) {
        divide_by_factor(entries, &teb->internal.equations.normal[first - 2U * JP_TEB_BLOCK][DIAGONAL_BLOCK]);
    }
    if (first >= JP_TEB_BLOCK) {
        const float(*const above)[JP_TEB_BAND] = &teb->internal.equations.normal[first - JP_TEB_BLOCK];

        subtract_product(&entries[JP_TEB_BLOCK], entries, &above[0][JP_TEB_BLOCK]);
        divide_by_factor(&entries[JP_TEB_BLOCK], &above[0][DIAGONAL_BLOCK]);
    }
}

/* Product of two rows of one block over the columns left of that block and `count` within it. */
static float rest_of_product(const float *row, const float *other, unsigned count)
{
    return dot_block(row, other) + dot_block(&row[JP_TEB_BLOCK], &other[JP_TEB_BLOCK]) +
           dot(&row[DIAGONAL_BLOCK], &other[DIAGONAL_BLOCK], count);
}

/* One row of the factor, whose diagonal is kept as its inverse. Blocks before the first are 0. */
static bool factor_row(struct jp_teb *teb, unsigned row)
{
    const unsigned within = row % JP_TEB_BLOCK;
    const unsigned first = row - within;
    float *const entries = teb->internal.equations.normal[row];
    float *const diagonal = &entries[DIAGONAL_BLOCK + within];

    *diagonal += teb->internal.damping * *diagonal + DIAGONAL_MIN;
    factor_left(teb, first, entries);
    for (unsigned i = 0; i < within; i++) {
        const float *const other = teb->internal.equations.normal[first + i];
        float *const entry = &entries[DIAGONAL_BLOCK + i];

        *entry = (*entry - rest_of_product(entries, other, i)) * other[DIAGONAL_BLOCK + i];
    }

    const float pivot = *diagonal - rest_of_product(entries, entries, within);

    if (!(pivot > 0.0f)) {
        return false;
    }
    *diagonal = 1.0f / jp_plane_square_root(pivot);
    return true;
}

/* Of a pose's rows: 0 and 1, the blocks of two poses before and of the pose before, or 2, of the diagonal. */
static const float *block_of(const struct jp_teb *teb, unsigned pose, unsigned which)
{
    return &teb->internal.equations.normal[pose * JP_TEB_BLOCK][which * JP_TEB_BLOCK];
}

/* As another row of the factor: what becomes of it is L⁻¹ times the gradient. */
static void substitute_forward(struct jp_teb *teb, unsigned pose)
{
    float *const gradient = &teb->internal.equations.gradient[pose * JP_TEB_BLOCK];

    if (pose > 1U) {
        subtract_product(gradient, gradient - 2U * JP_TEB_BLOCK, block_of(teb, pose, 0));
    }
    if (pose > 0U) {
        subtract_product(gradient, gradient - JP_TEB_BLOCK, block_of(teb, pose, 1));
    }
    divide_by_factor(gradient, block_of(teb, pose, 2));
}

/* entries −= blockᵀ × step */
static void subtract_transposed(float *restrict entries, const float *block, const float *restrict step)
{
    for (unsigned i = 0; i < JP_TEB_BLOCK; i++) {
        entries[i] -= block[i] * step[0] + block[i + JP_TEB_BAND] * step[1] + block[i + 2U * JP_TEB_BAND] * step[2] +
                      block[i + 3U * JP_TEB_BAND] * step[3];
    }
}

/* Inverse of factorᵀ × entries, where the factor is a block of the diagonal. */
static void divide_by_transposed(float *restrict entries, const float *restrict factor)
{
    const float *const second = &factor[JP_TEB_BAND];
    const float *const third = &factor[2U * JP_TEB_BAND];
    const float *const fourth = &factor[3U * JP_TEB_BAND];
    const float d = entries[3] * fourth[3];
    const float c = (entries[2] - d * fourth[2]) * third[2];
    const float b = (entries[1] - d * fourth[1] - c * third[1]) * second[1];

    entries[3] = d;
    entries[2] = c;
    entries[1] = b;
    entries[0] = (entries[0] - d * fourth[0] - c * third[0] - b * second[0]) * factor[0];
}

static void substitute_backward(struct jp_teb *teb, unsigned pose)
{
    float *const gradient = &teb->internal.equations.gradient[pose * JP_TEB_BLOCK];

    divide_by_transposed(gradient, block_of(teb, pose, 2));
    if (pose > 0U) {
        subtract_transposed(gradient - JP_TEB_BLOCK, block_of(teb, pose, 1), gradient);
    }
    if (pose > 1U) {
        subtract_transposed(gradient - 2U * JP_TEB_BLOCK, block_of(teb, pose, 0), gradient);
    }
}

bool jp_teb_solve(struct jp_teb *teb)
{
    const unsigned rows = row_count(teb);

    for (unsigned row = 0; row < rows; row++) {
        if (!factor_row(teb, row)) {
            return false;
        }
        teb->internal.equations.gradient[row] = -teb->internal.equations.gradient[row];
    }
    for (unsigned pose = 0; pose < teb->count; pose++) {
        substitute_forward(teb, pose);
    }
    for (unsigned pose = teb->count; pose > 0U; pose--) {
        substitute_backward(teb, pose - 1U);
    }
    return true;
}
