#include "src/learn/learner_filter.h"

#include "src/base/compiler.h"

#define N      JP_LEARNING_DIRECTIONS
#define S_BITS 30U
#define S_ONE  ((int32_t)1 << S_BITS)

/** Of SᵀS, whose elements are at most 4. */
#define GRAM_BITS 28U

static JP_INLINE_FOR_SPEED int64_t rounded(int64_t x, unsigned shift)
{
    return (x + ((int64_t)1 << (shift - 1U))) >> shift;
}

void jp_filter_start(jp_square_root_matrix s)
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            s[i][j] = i == j ? S_ONE : 0;
        }
    }
}

/** I − SᵀS, the lower triangle, Q28. */
static void defect(const jp_square_root_matrix s, int32_t lower[N][N])
{
    for (int i = 0; i < N; i++) {
        for (int j = 0; j <= i; j++) {
            int64_t sum = 0;

            for (int k = 0; k < N; k++) {
                sum += (int64_t)s[k][i] * s[k][j];
            }
            lower[i][j] = (i == j ? (int32_t)1 << GRAM_BITS : 0) - (int32_t)rounded(sum, 2U * S_BITS - GRAM_BITS);
        }
    }
}

void jp_filter_forget(jp_square_root_matrix s, uint32_t memory)
{
    const uint32_t half = ((uint32_t)1 << 30) / memory; /* 1/(2 memory), Q31 */
    const int32_t half_rate = (int32_t)half;
    int32_t gap[N][N];

    defect(s, gap);
    for (int i = 0; i < N; i++) {
        int32_t row[N];

        for (int j = 0; j < N; j++) {
            int64_t sum = 0;

            for (int k = 0; k < N; k++) {
                sum += (int64_t)s[i][k] * (k < j ? gap[j][k] : gap[k][j]);
            }
            row[j] = (int32_t)rounded((sum >> GRAM_BITS) * half_rate, 31U);
        }
        for (int j = 0; j < N; j++) {
            s[i][j] += row[j];
        }
    }
}

void jp_filter_expect(const jp_square_root_matrix s, const int32_t h[N], struct jp_filter_step *step)
{
    uint64_t variance = (uint64_t)1 << (2U * JP_FILTER_BITS);

    for (int j = 0; j < N; j++) {
        int64_t sum = 0;

        for (int i = 0; i < N; i++) {
            sum += (int64_t)s[i][j] * h[i];
        }
        step->v[j] = (int32_t)rounded(sum, S_BITS);
        variance += jp_square(step->v[j]);
    }
    step->deviation = jp_square_root(variance);
}

/** 1/√(vᵀ v + 1), Q30. */
static uint32_t inverse(const struct jp_filter_step *step)
{
    return (uint32_t)(((uint64_t)1 << (S_BITS + JP_FILTER_BITS)) / step->deviation);
}

int32_t jp_filter_noise_share(const struct jp_filter_step *step)
{
    const uint64_t share = jp_square((int32_t)inverse(step)) >> S_BITS;

    return (int32_t)share;
}

void jp_filter_take(jp_square_root_matrix s, jp_q24 x[N], const struct jp_filter_step *step, int32_t innovation)
{
    /* With v̂ = v/d: gain S v̂, and S ← S (I − d/(d + 1) v̂ v̂ᵀ). */
    const uint32_t d = step->deviation;
    const int32_t share = (int32_t)(((uint64_t)d << S_BITS) / (d + (uint32_t)JP_FILTER_ONE));
    const int64_t scale = (int64_t)inverse(step);
    int32_t unit[N];
    int32_t fraction[N];

    for (int j = 0; j < N; j++) {
        unit[j] = (int32_t)rounded(step->v[j] * scale, JP_FILTER_BITS);
        fraction[j] = (int32_t)rounded((int64_t)unit[j] * share, S_BITS);
    }
    for (int i = 0; i < N; i++) {
        int64_t sum = 0;

        for (int j = 0; j < N; j++) {
            sum += (int64_t)s[i][j] * unit[j];
        }

        const int32_t gain = (int32_t)rounded(sum, S_BITS);

        for (int j = 0; j < N; j++) {
            s[i][j] -= (int32_t)rounded((int64_t)gain * fraction[j], S_BITS);
        }
        x[i] = jp_clamp32(x[i] + (int32_t)rounded((int64_t)gain * innovation, S_BITS + JP_FILTER_BITS - 24U),
                          -JP_LEARNED_MAX, JP_LEARNED_MAX);
    }
}

uint64_t jp_filter_variance(const jp_square_root_matrix s, const int32_t g[N])
{
    uint64_t variance = 0;

    for (int j = 0; j < N; j++) {
        int64_t sum = 0;

        for (int i = 0; i < N; i++) {
            sum += (int64_t)s[i][j] * g[i];
        }
        variance += jp_square(jp_saturate32(rounded(sum, S_BITS)));
    }
    return variance;
}
