/** Any gains that pass, any frames, for ever; begun at rest, or in motion with any bias that a robot may have learned.
 */
#include <joulepath/estimator.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_estimator_config config;
    struct jp_estimator estimator;
    struct jp_motion_state motion;
    struct jp_sensors sensors;
    const char *field;

    ANY(config);
    ANY(sensors);
    if (jp_estimator_check(&config, &field) != JP_OK) {
        return 0;
    }
    jp_estimator_start(&estimator, &config, &sensors);
    ANY_TIMES
    {
        ANY(sensors);
        if (any_bool()) {
            jp_estimator_resume(&estimator, &config, &sensors, &motion);
        } else {
            jp_estimator_update(&estimator, &config, &sensors, &motion);
        }
    }
    ARRIVED();
    return 0;
}
