// eva: -eva-slevel-function main:20,jp_learner_restore:20,jp_learner_update_leg:20,jp_forecast_add_leg:20
/** Any tables that pass, any state that is stored, any legs of trajectories and energies, for ever. */
#include <joulepath/learner.h>

#include "tests/proof/any.h"

static struct jp_learning learning;
static struct jp_energy_model built_in;
static struct jp_learner learner;

static void learn(void)
{
    struct jp_leg_energy leg;
    enum jp_learned learned;

    ANY(leg);
    (void)jp_learner_update_leg(&learner, &leg, any_int(), &learned);
}

static void foretell(void)
{
    struct jp_forecast_sum sum = {0};
    struct jp_forecast forecast;
    struct jp_leg_energy leg;

    ANY(leg);
    if (jp_forecast_add_leg(&learner, &sum, &leg) == JP_OK) {
        (void)jp_forecast_total(&learner, &sum, &forecast);
    }
}

int main(void)
{
    struct jp_learned_state state;
    const char *field;

    ANY(learning);
    ANY(built_in);
    ANY(state);
    if (jp_learning_check(&learning, &field) != JP_OK || jp_energy_model_check(&built_in, &field) != JP_OK) {
        return 0;
    }
    jp_learner_start(&learner, &learning, &built_in, NULL);
    (void)jp_learner_restore(&learner, &state, &field);
    ANY_TIMES
    {
        learn();
        foretell();
    }
    ARRIVED();
    return 0;
}
