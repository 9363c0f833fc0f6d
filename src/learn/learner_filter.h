/** Recursive least squares in square-root form: P = S Sᵀ with S in Q2.30, no row of it longer than 1 + 2⁻¹⁰. Private to
 *  the core. */
#ifndef JOULEPATH_LEARN_LEARNER_FILTER_H
#define JOULEPATH_LEARN_LEARNER_FILTER_H

#include <joulepath/learner.h>

#define JP_FILTER_BITS     20U /* fraction bits of values in standard deviations of the noise */
#define JP_FILTER_ONE      ((int32_t)1 << JP_FILTER_BITS)
#define JP_SENSITIVITY_MAX 1000 /* |h| that still fits */
#define JP_INNOVATION_MAX  (64 * JP_FILTER_ONE)

/** x², exact. */
static inline uint64_t jp_square(int32_t x)
{
    const int64_t square = jp_multiply(x, x);

    return (uint64_t)square;
}

/** Variance of a share of an energy, Q32. */
static inline uint64_t jp_variance_of(jp_q16 share, jp_q16 energy)
{
    return jp_square(jp_multiply_shift(share, energy, 16));
}

typedef int32_t jp_square_root_matrix[JP_LEARNING_DIRECTIONS][JP_LEARNING_DIRECTIONS];

/** A measurement h x + noise of variance 1, before the update. */
struct jp_filter_step {
    int32_t v[JP_LEARNING_DIRECTIONS]; /**< Sᵀ h, Q20 */
    uint32_t deviation;                /**< √(vᵀ v + 1), standard deviation of the innovation, Q20 */
};

/** P = I. */
void jp_filter_start(jp_square_root_matrix s);

/** Forgetting: moves P towards I by one segment of `memory`. */
void jp_filter_forget(jp_square_root_matrix s, uint32_t memory);

/** Expectation of a measurement; h in Q20, within ±JP_SENSITIVITY_MAX. One square root. */
void jp_filter_expect(const jp_square_root_matrix s, const int32_t h[JP_LEARNING_DIRECTIONS],
                      struct jp_filter_step *step);

/** 1/(vᵀ v + 1), Q30: the share of the noise in the variance of the innovation. */
int32_t jp_filter_noise_share(const struct jp_filter_step *step);

/** Takes the measurement, `innovation` in Q20 standard deviations of what was expected, within ±JP_INNOVATION_MAX: S
 * and x follow. Two divisions. */
void jp_filter_take(jp_square_root_matrix s, jp_q24 x[JP_LEARNING_DIRECTIONS], const struct jp_filter_step *step,
                    int32_t innovation);

/** |Sᵀ g|², the variance of g x; |g| <= 2²⁹. */
uint64_t jp_filter_variance(const jp_square_root_matrix s, const int32_t g[JP_LEARNING_DIRECTIONS]);

#endif
