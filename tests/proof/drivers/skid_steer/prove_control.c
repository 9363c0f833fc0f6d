/** Any gains that pass, any counts, steering ratios and set-points within the header's ranges, for ever. */
#include <joulepath/skid_control.h>

#include "tests/proof/any.h"

static void any_set_point(struct jp_skid_set_point *set_point)
{
    set_point->speed = any_between(-JP_Q24(8), JP_Q24(8));
    set_point->turn_rate = any_between(-JP_Q24(8), JP_Q24(8));
    set_point->acceleration = any_int();
    set_point->turn_acceleration = any_int();
    set_point->rise = any_between(-JP_Q24_ONE, JP_Q24_ONE);
}

int main(void)
{
    struct jp_skid_control_config config;
    struct jp_skid_control control;
    struct jp_skid_set_point set_point;
    struct jp_voltages voltages;
    const char *field;

    ANY(config);
    if (jp_skid_control_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_skid_control_start(&control, &config, any_int());
    jp_skid_control_count_from(&control, any_unsigned(UINT32_MAX), any_unsigned(UINT32_MAX));
    ANY_TIMES
    {
        any_set_point(&set_point);
        jp_skid_control_measure(&control, &config, any_unsigned(UINT32_MAX), any_unsigned(UINT32_MAX));
        jp_skid_control_steer(&control, &config, any_int());
        if (any_bool()) {
            jp_skid_control_forget(&control);
        }
        if (any_bool()) {
            jp_skid_control_blindly(&control, &config, &set_point, any_between(0, JP_Q16(1000)), &voltages);
        } else {
            jp_skid_control_update(&control, &config, &set_point, any_between(0, JP_Q16(1000)), &voltages);
        }
    }
    ARRIVED();
    return 0;
}
