// eva: -eva-slevel-function main:20,jp_skid_learner_restore:20
/** Any tables that pass, any stored state, any drives and energies, for ever. */
#include <joulepath/skid_learner.h>

#include "tests/proof/any.h"

static struct jp_skid_learning learning;
static struct jp_skid_energy_model built_in;
static struct jp_skid_learner learner;

static void learn(void)
{
    struct jp_skid_drive drive;
    enum jp_learned learned;

    ANY(drive);
    (void)jp_skid_learner_update(&learner, &drive, any_int(), &learned);
}

static void look(void)
{
    struct jp_skid_drive drive;
    struct jp_forecast_sum sum = {0};
    struct jp_forecast forecast;
    jp_q16 factor[JP_SKID_FACTORS];

    ANY(drive);
    jp_skid_learner_factors(&learner, factor);
    jp_skid_learner_deviations(&learner, factor);
    if (jp_skid_forecast_add(&learner, &sum, &drive) == JP_OK) {
        (void)jp_skid_forecast_total(&learner, &sum, &forecast);
    }
}

int main(void)
{
    struct jp_learned_state state;
    const char *field;

    ANY(learning);
    ANY(built_in);
    ANY(state);
    if (jp_skid_learning_check(&learning, &field) != JP_OK || jp_skid_energy_check(&built_in, &field) != JP_OK) {
        return 0;
    }
    jp_skid_learner_start(&learner, &learning, &built_in);
    (void)jp_skid_learner_restore(&learner, &state, &field);
    ANY_TIMES
    {
        learn();
        look();
    }
    ARRIVED();
    return 0;
}
