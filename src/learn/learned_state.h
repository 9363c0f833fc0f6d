/** What learners of every kind do with a measurement. Private to the core. */
#ifndef JOULEPATH_LEARN_LEARNED_STATE_H
#define JOULEPATH_LEARN_LEARNED_STATE_H

#include <joulepath/learner.h>

/** What is expected of a drive. */
struct jp_expectation {
    jp_q16 energy;                              /**< J */
    jp_q16 sensitivity[JP_LEARNING_DIRECTIONS]; /**< f, J per unit of x */
    jp_q16 noise;                               /**< standard deviation, J; above 0 */
    jp_q16 spread;                              /**< by which single ones exceed it */
};

/** Takes a stored state of the learning of an identity. Failures as jp_learner_restore(). */
enum jp_status jp_learned_state_restore(struct jp_learned_state *state, const struct jp_learned_state *stored,
                                        uint32_t identity, const char **field);

/** Takes a measurement, J, and forgets by one of `memory`. When JP_LEARNED_CHANGE is returned, watch->before_change is
 *  the state before. */
enum jp_learned jp_learned_state_update(struct jp_learned_state *state, struct jp_learned_watch *watch, uint32_t memory,
                                        const struct jp_expectation *expected, jp_q16 measured);

/** Standard deviation as the learner has found it, of this variance in Q32; above 0. */
jp_q16 jp_learned_noise(const struct jp_learned_state *state, uint64_t variance);

#endif
