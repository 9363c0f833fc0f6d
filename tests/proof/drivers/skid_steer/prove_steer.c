// eva: -eva-slevel 100
/** Any configuration and arguments: those out of their ranges are refused. */
#include <joulepath/skid_steer.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_skid_steer_config config;
    struct jp_skid_steer_sides sides;
    struct jp_motion motion;
    jp_q16 result;
    const char *field;

    ANY(config);
    ANY(motion);
    if (jp_skid_steer_check(&config, &field) != JP_OK) {
        return 0;
    }
    (void)jp_skid_steer_wheel_speeds(&config, &motion, &sides);
    (void)jp_skid_steer_torques(&config, &motion, any_int(), &sides);
    (void)jp_skid_steer_power(&config, (enum jp_cost_kind)any_between(0, 3), &motion, any_int(), &result);
    (void)jp_skid_steer_power_of(&config, &motion, any_int());
    (void)jp_skid_steer_energy(&config, (enum jp_cost_kind)any_between(0, 3), &motion, any_int(), any_int(), &result);
    ARRIVED();
    return 0;
}
