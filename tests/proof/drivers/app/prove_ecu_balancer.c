// eva: -eva-slevel-function main:1000,any_balancer:200,passes:200,jp_robot_init:1000,check:200
// eva: -eva-slevel-function learn:100,jp_ecu_balancer_init:1000,jp_ecu_balancer_learn:50,jp_pilot_init:100
/** Any configuration, model and learning that pass, any state that is stored: how a balancing robot and its pilot are
 *  prepared for the application. */
#include "hal/app/ecu_balancer.h"
#include "tests/proof/any_balancer.h"

static struct jp_ecu_balancer balancer;
static struct jp_energy_model model;
static struct jp_learning learning;
static struct jp_learned_state state;

static void learn(void)
{
    const struct jp_ecu_learning what = {.learning = any_bool() ? &learning : NULL,
                                         .of_battery = any_bool(),
                                         .stored = (enum jp_stored)any_between(JP_STORED_TAKEN, JP_STORED_OTHER_TABLES),
                                         .state = any_bool() ? &state : NULL};
    const char *field;

    ANY(learning);
    ANY(state);
    (void)jp_ecu_balancer_learn(&balancer, &what, &field);
}

static void look(const struct jp_ecu_robot *robot)
{
    (void)jp_ecu_balancer_model(&balancer);
    (void)robot->kind->state(robot->self);
    (void)robot->kind->parameter(robot->self, (uint8_t)any_unsigned(robot->kind->parameters - 1U));
    robot->kind->set_out(robot->self, any_bool());
}

int main(void)
{
    struct jp_ecu_robot robot;
    const char *field;

    ANY(any_balancer_config);
    any_balancer_config.name = "any";
    ANY(model);
    if (!passes(&any_balancer_config) ||
        jp_ecu_balancer_init(&balancer, &any_balancer_config, &model, &robot, &field) != JP_OK) {
        return 0;
    }
    if (any_bool()) {
        learn();
    }
    look(&robot);
    ARRIVED();
    return 0;
}
