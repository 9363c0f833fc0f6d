// eva: -eva-slevel-function main:20,jp_energy_forecast:20,jp_energy_regressors:20,arguments_are_valid:60
// eva: -eva-slevel-function jp_horizon_check:60,first_bad_field:40
/** Any model and horizon that pass, any start and segment: those out of their ranges are refused. */
#include <joulepath/horizon.h>

#include "tests/proof/any.h"

int main(void)
{
    static struct jp_energy_model model;
    static struct jp_horizon horizon;
    struct jp_energy_start start;
    struct jp_energy_start end;
    struct jp_segment_command segment;
    jp_q16 regressor[JP_ENERGY_PARAMETERS];
    jp_q16 energy;
    const char *field;

    ANY(model);
    ANY(horizon);
    ANY(start);
    ANY(segment);
    start.is_forward = any_bool();
    if (jp_energy_model_check(&model, &field) != JP_OK || jp_horizon_check(&horizon, &field) != JP_OK) {
        return 0;
    }
    (void)jp_energy_forecast(&model, any_bool() ? &horizon : NULL, &start, &segment, &energy, &end);
    (void)jp_energy_regressors(&model, any_bool() ? &horizon : NULL, &start, &segment, regressor, &energy);
    ARRIVED();
    return 0;
}
