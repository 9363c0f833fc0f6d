// eva: -eva-slevel 100
/** Any robot that passes, any twists and wheels: those out of their ranges are refused. */
#include <joulepath/four_wheel.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_four_wheel_config config;
    struct jp_twist twist;
    struct jp_wheels wheels;
    enum jp_steering steering;
    jp_q24 slip;
    const char *field;

    ANY(config);
    if (jp_four_wheel_check(&config, &field) != JP_OK) {
        return 0;
    }
    ANY(twist);
    ANY(wheels);
    (void)jp_four_wheel_radius_min(&config);
    (void)jp_four_wheel_inverse(&config, &twist, &wheels);
    ANY(wheels);
    (void)jp_four_wheel_tick(&config, &twist, &wheels, &steering);
    (void)jp_four_wheel_twist(&config, any_int(), any_int(), &twist);
    jp_four_wheel_forward(&config, &wheels, &twist, &slip);
    ARRIVED();
    return 0;
}
