// eva: -eva-precision 0 -eva-auto-loop-unroll 32
// eva: -eva-slevel-function main:200,jp_config_check:200,is_within:50,require_within:50,jp_energy_model_check:200
/** Any model that passes, any budget, any task: what is refused before the search, which has no driver. */
#include <joulepath/trajectory_budget.h>

#include "tests/proof/any_task.h"

int main(void)
{
    static struct jp_trajectory_config config;
    static struct jp_trajectory trajectory;
    static struct jp_trajectory_leg legs[ANY_TARGETS];
    struct jp_trajectory_budget_config budget_config;
    struct jp_trajectory_budget budget;
    struct jp_energy_model model;
    const char *field;

    ANY(model);
    if (jp_energy_model_check(&model, &field) != JP_OK) {
        return 0;
    }
    any_places();
    any_task(&budget_config.task, &config);
    budget_config.model = any_bool() ? &model : NULL;
    budget_config.kind = (enum jp_budget_kind)any_int();
    budget_config.limit = any_int();
    budget_config.legs = any_bool() ? legs : NULL;
    budget_config.trajectory = any_bool() ? &trajectory : NULL;
    (void)jp_trajectory_budget_start(&budget, &budget_config);
    ARRIVED();
    return 0;
}
