/** The minimum of the energy over the arc. Private to the core. */
#ifndef JOULEPATH_TRAJECTORY_SEGMENT_SEARCH_H
#define JOULEPATH_TRAJECTORY_SEGMENT_SEARCH_H

#include "src/trajectory/segment_evaluation.h"

/**
 * The minimum over x in [low, high], where J* has one: *best keeps the best of all calls; its ξ is 0 before the first.
 * *evaluations are left; the search ends when there are none.
 */
void jp_segment_find_minimum(const struct jp_segment_problem *problem, int32_t low, int32_t high, int *evaluations,
                             struct jp_evaluation *best);

/** One x more, after a search and if an evaluation is left. */
void jp_segment_try(const struct jp_segment_problem *problem, int32_t x, int *evaluations, struct jp_evaluation *best);

#endif
