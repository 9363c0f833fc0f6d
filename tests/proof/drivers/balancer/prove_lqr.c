/** Any gains that pass, any references and motions, for ever. */
#include <joulepath/lqr.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_lqr_config config;
    struct jp_reference reference;
    struct jp_motion_state motion;
    struct jp_voltages voltages;
    struct jp_lqr lqr;
    const char *field;

    ANY(config);
    if (jp_lqr_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_lqr_start(&lqr, &config);
    ANY_TIMES
    {
        ANY(reference);
        ANY(motion);
        if (any_bool()) {
            jp_lqr_restart(&lqr);
        }
        jp_lqr_update(&lqr, &config, &reference, &motion, any_between(0, INT32_MAX), &voltages);
    }
    ARRIVED();
    return 0;
}
