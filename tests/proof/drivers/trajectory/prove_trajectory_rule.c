// eva: -eva-precision 0 -eva-auto-loop-unroll 32
// eva: -eva-slevel-function main:1000,plan:200,is_within:50,require_within:50,jp_trajectory_check:200
// eva: -eva-slevel-function jp_config_check:200,jp_chord_to:50,demands_of:20,jp_leg_outline:20,chord_after:20
// eva: -eva-slevel-function first_chords:20,jp_plan_begin:100,jp_trajectory_plan_leg:100
// eva: -eva-slevel-function jp_trajectory_plan_start:100,jp_trajectory_plan_redirect:100
// eva: -eva-slevel-function jp_trajectory_by_rule:200
/** Any configuration that passes, any tasks, planned leg by leg, sent on to others at any time, or planned whole. */
#include "tests/proof/any_task.h"

static struct jp_trajectory_config config;
static struct jp_trajectory trajectory;
static struct jp_trajectory_leg legs[ANY_TARGETS];

static void plan(void)
{
    static struct jp_trajectory_plan plan;
    struct jp_trajectory_task task;

    any_task(&task, &config);
    if (jp_trajectory_plan_start(&plan, &task, legs, (uint16_t)any_unsigned(ANY_TARGETS), &trajectory) != JP_OK) {
        return;
    }
    ANY_TIMES
    {
        (void)jp_trajectory_plan_leg(&plan, &legs[any_unsigned(ANY_TARGETS - 1U)]);
        if (any_bool()) {
            any_task(&task, &config);
            (void)jp_trajectory_plan_redirect(&plan, &task);
        }
    }
}

int main(void)
{
    struct jp_trajectory_task task;
    const char *field;

    ANY(config);
    if (jp_trajectory_check(&config, &field) != JP_OK) {
        return 0;
    }
    any_places();
    plan();
    any_task(&task, &config);
    (void)jp_trajectory_by_rule(&task, legs, &trajectory);
    ARRIVED();
    return 0;
}
