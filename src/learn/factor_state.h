/** What learners of factors share (factor_learning.h). Private to the core. */
#ifndef JOULEPATH_LEARN_FACTOR_STATE_H
#define JOULEPATH_LEARN_FACTOR_STATE_H

#include <joulepath/factor_learning.h>

#include "src/learn/learned_state.h"

/** The factors as learned, and their standard deviations. */
void jp_factors(const struct jp_factor_learning *learning, const struct jp_learned_state *state,
                jp_q16 factor[JP_LEARNING_DIRECTIONS]);
void jp_factor_deviations(const struct jp_factor_learning *learning, const struct jp_learned_state *state,
                          jp_q16 deviation[JP_LEARNING_DIRECTIONS]);

/** Learns from a leg. Beyond its bounds a factor would stand still while x went on, and not come back with it: x stays
 *  where the factor is. */
enum jp_learned jp_factor_update(const struct jp_factor_learning *learning, struct jp_learned_state *state,
                                 struct jp_learned_watch *watch, const struct jp_expectation *expected,
                                 jp_q16 measured);

/** What is expected of a drive of this energy and its changes by the factors. `variance`: of the noise that the kind
 *  adds, J² in Q32. False: a number exceeds its format. */
bool jp_factor_expect(const struct jp_factor_learning *learning, const struct jp_learned_state *state, int64_t energy,
                      const int64_t change[JP_LEARNING_DIRECTIONS], uint64_t variance, struct jp_expectation *expected);

#endif
