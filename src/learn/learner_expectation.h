/** What a learner expects of a segment or a leg. Private to the core. */
#ifndef JOULEPATH_LEARN_LEARNER_EXPECTATION_H
#define JOULEPATH_LEARN_LEARNER_EXPECTATION_H

#include "src/learn/learned_state.h"

/** Failures as jp_learner_update(). */
enum jp_status jp_learner_expect(const struct jp_learner *learner, const struct jp_energy_start *start,
                                 const struct jp_segment_command *segment, struct jp_expectation *expected);

/** Failures as jp_learner_update_leg(). */
enum jp_status jp_learner_expect_leg(const struct jp_learner *learner, const struct jp_leg_energy *leg,
                                     struct jp_expectation *expected);

#endif
