// eva: -eva-slevel-function main:20,jp_blend_nodes:10,add_blend:100
/** Any configuration and model that pass, any trajectory, any motors, and modes within their range. */
#include <joulepath/trajectory_energy.h>

#include "tests/proof/any_trajectory.h"

#define MODE_MAX (INT32_MAX / 16)

static struct jp_trajectory_config config;
static struct jp_energy_model model;
static struct jp_trajectory trajectory;

static void price_a_leg(void)
{
    struct jp_back_emf back_emf = {any_between(0, JP_Q16(4096)), any_between(0, JP_Q16(4096))};
    struct jp_leg_energy result;
    jp_q24 modes[JP_TRAVEL_MODES];

    for (unsigned i = 0; i < JP_TRAVEL_MODES; i++) {
        modes[i] = any_between(-MODE_MAX - 1, MODE_MAX);
    }
    (void)jp_trajectory_leg_energy(&config, &model, &back_emf, &any_legs[0], modes, &result);
}

int main(void)
{
    const char *field;
    jp_q16 energy;

    ANY(config);
    ANY(model);
    if (jp_trajectory_check(&config, &field) != JP_OK || jp_energy_model_check(&model, &field) != JP_OK) {
        return 0;
    }
    any_trajectory(&trajectory);
    price_a_leg();
    trajectory.count = (uint16_t)any_unsigned(ANY_LEGS);
    (void)jp_trajectory_energy(&config, &model, &trajectory, &energy);
    ARRIVED();
    return 0;
}
