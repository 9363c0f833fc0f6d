// eva: -eva-slevel-function main:20,jp_ground_learner_restore:20
/** Any learning that passes, any stored states, any legs and energies, for ever. */
#include <joulepath/ground_learner.h>

#include "tests/proof/any.h"

static struct jp_factor_learning learning;
static struct jp_ground_learner learner;

static void learn(void)
{
    struct jp_forecast expected;
    struct jp_ground_change change;
    enum jp_learned learned;

    ANY(expected);
    ANY(change);
    (void)jp_ground_learner_update(&learner, &expected, &change, any_int(), &learned);
}

static void look(void)
{
    const uint8_t ground = (uint8_t)any_unsigned(JP_GROUND_CLASSES - 1U);
    struct jp_ground_change change;
    struct jp_forecast forecast;
    jp_q16 factor[JP_GROUND_FACTORS];

    ANY(change);
    ANY(forecast);
    jp_ground_learner_factors(&learner, ground, factor);
    jp_ground_learner_deviations(&learner, ground, factor);
    (void)jp_ground_learner_widen(&learner, &change, &forecast);
}

int main(void)
{
    struct jp_learned_state state;
    const char *field;

    ANY(learning);
    ANY(state);
    if (jp_factor_learning_check(&learning, &field) != JP_OK) {
        return 0;
    }
    jp_ground_learner_start(&learner, &learning);
    (void)jp_ground_learner_restore(&learner, (uint8_t)any_unsigned(UINT8_MAX), &state, &field);
    ANY_TIMES
    {
        learn();
        look();
    }
    ARRIVED();
    return 0;
}
