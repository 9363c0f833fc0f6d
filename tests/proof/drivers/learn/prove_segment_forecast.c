// eva: -eva-slevel-function main:200,jp_forecast_add:100,jp_energy_forecast:100,jp_energy_regressors:20
// eva: -eva-slevel-function arguments_are_valid:60,jp_horizon_check:60,first_bad_field:40,jp_learner_expect:20
/** Any tables that pass, with a horizon or without, any route of two segments: those out of their ranges are refused.
 */
#include <joulepath/learner.h>

#include "tests/proof/any.h"

static struct jp_learning learning;
static struct jp_energy_model built_in;
static struct jp_horizon horizon;
static struct jp_learner learner;

int main(void)
{
    struct jp_forecast_sum sum = {0};
    struct jp_energy_start start;
    struct jp_segment_command segments[2];
    struct jp_forecast forecast;
    const char *field;

    ANY(learning);
    ANY(built_in);
    ANY(horizon);
    ANY(start);
    ANY(segments);
    start.is_forward = any_bool();
    if (jp_learning_check(&learning, &field) != JP_OK || jp_energy_model_check(&built_in, &field) != JP_OK ||
        jp_horizon_check(&horizon, &field) != JP_OK) {
        return 0;
    }
    jp_learner_start(&learner, &learning, &built_in, any_bool() ? &horizon : NULL);
    if (jp_forecast_add(&learner, &sum, &start, &segments[0]) == JP_OK) {
        (void)jp_forecast_add(&learner, &sum, &start, &segments[1]);
    }
    (void)jp_forecast_total(&learner, &sum, &forecast);
    ARRIVED();
    return 0;
}
