// eva: -eva-slevel 100
/** Any configuration that passes, any steps within the header's ranges, any set-points, for ever. */
#include <joulepath/reference.h>

#include "tests/proof/any.h"

static void step(struct jp_reference *reference, const struct jp_reference_config *config)
{
    const struct jp_motion motion = {any_between(-JP_Q24(8), JP_Q24(8)), any_between(-JP_Q24(8), JP_Q24(8))};
    const struct jp_reference_step next = jp_reference_step_to(config, &motion, any_int());

    jp_reference_apply(reference, &next);
}

static void track(struct jp_reference *reference)
{
    struct jp_set_point set_point;

    ANY(set_point);
    jp_reference_track(reference, &set_point);
    if (any_bool()) {
        jp_reference_leave_track(reference);
    }
}

int main(void)
{
    struct jp_reference_config config;
    struct jp_reference reference;
    jp_phase angle;
    const char *field;

    ANY(config);
    ANY(angle);
    if (jp_reference_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_reference_start(&reference, &config, angle, angle);
    ANY_TIMES
    {
        if (any_bool()) {
            step(&reference, &config);
        }
        if (any_bool()) {
            jp_reference_coast(&reference, &config, any_int(), any_int());
        }
        if (any_bool()) {
            track(&reference);
        } else {
            jp_reference_update(&reference, &config);
        }
    }
    ARRIVED();
    return 0;
}
