// eva: -eva-slevel-function main:20
/** Any configuration that passes, any trajectory, driven to its end or begun anew at any time. */
#include "tests/proof/any_trajectory.h"

static struct jp_trajectory_config config;
static struct jp_trajectory trajectory;

static void drive(void)
{
    struct jp_trajectory_drive drive;
    struct jp_set_point set_point;

    jp_trajectory_begin(&drive, &trajectory);
    ANY_TIMES
    {
        if (any_bool()) {
            jp_trajectory_begin(&drive, &trajectory);
        }
        (void)jp_trajectory_advance(&drive, &config, &set_point);
        (void)jp_trajectory_next_leg(&drive);
        (void)jp_trajectory_leg_now(&drive);
    }
}

int main(void)
{
    const char *field;
    jp_q16 seconds;

    ANY(config);
    if (jp_trajectory_check(&config, &field) != JP_OK) {
        return 0;
    }
    any_trajectory(&trajectory);
    drive();
    (void)jp_trajectory_leg_extent(&config, &any_legs[0], any_unsigned(UINT32_MAX));
    trajectory.count = (uint16_t)any_unsigned(ANY_LEGS);
    (void)jp_trajectory_duration(&config, &trajectory, &seconds);
    ARRIVED();
    return 0;
}
