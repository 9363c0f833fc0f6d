/** Quantile of the normal distribution. Private to the core. */
#ifndef JOULEPATH_LEARN_NORMAL_QUANTILE_H
#define JOULEPATH_LEARN_NORMAL_QUANTILE_H

#include <joulepath/fixed.h>

/** Least and greatest probability. */
#define JP_PROBABILITY_MIN ((jp_q31)1 << 30)
#define JP_PROBABILITY_MAX ((jp_q31)2147268900) /* 0.9999 */

/** Standard deviations below which a value is with this probability, which must be in range: within 0.001. */
jp_q16 jp_normal_quantile(jp_q31 probability);

/** Its inverse: the largest probability in range whose quantile is at most so many standard deviations, of either sign;
 *  below the least quantile 1 − JP_PROBABILITY_MAX. Work: 31 quantiles. */
jp_q31 jp_normal_probability(jp_q16 deviations);

#endif
