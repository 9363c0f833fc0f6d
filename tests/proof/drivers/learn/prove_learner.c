// eva: -eva-slevel-function jp_energy_regressors:20,arguments_are_valid:60,jp_horizon_check:60,first_bad_field:40
// eva: -eva-slevel-function main:30,jp_learner_expect:20,expect:20,jp_learner_update:20,jp_learner_restore:20
// eva: -eva-slevel-function jp_learned_state_update:20,jp_learned_state_check:20,jp_learned_state_restore:20
/** Any tables that pass, any state that is stored, any segments and energies, for ever. */
#include <joulepath/learner.h>

#include "tests/proof/any.h"

static struct jp_learning learning;
static struct jp_energy_model built_in;
static struct jp_horizon horizon;
static struct jp_learner learner;

static void learn(void)
{
    struct jp_energy_start start;
    struct jp_segment_command segment;
    enum jp_learned learned;

    ANY(start);
    ANY(segment);
    start.is_forward = any_bool();
    (void)jp_learner_update(&learner, &start, &segment, any_int(), &learned);
}

static void look(void)
{
    struct jp_energy_model model;
    jp_q16 ground;
    jp_q16 payload;

    jp_learner_model(&learner, &model);
    jp_learner_causes(&learner, &ground, &payload);
    jp_learner_cause_deviations(&learner, &ground, &payload);
}

int main(void)
{
    struct jp_learned_state state;
    const char *field;

    ANY(learning);
    ANY(built_in);
    ANY(horizon);
    ANY(state);
    if (jp_learning_check(&learning, &field) != JP_OK || jp_energy_model_check(&built_in, &field) != JP_OK ||
        jp_horizon_check(&horizon, &field) != JP_OK) {
        return 0;
    }
    jp_learner_start(&learner, &learning, &built_in, any_bool() ? &horizon : NULL);
    (void)jp_learner_restore(&learner, &state, &field);
    ANY_TIMES
    {
        learn();
        look();
    }
    ARRIVED();
    return 0;
}
