/** Any model that passes, any motions and segments: those out of their ranges are refused. */
#include <joulepath/energy.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_energy_model model;
    struct jp_motion before;
    struct jp_segment_command segment;
    jp_q16 energy;
    const char *field;

    ANY(model);
    ANY(before);
    ANY(segment);
    if (jp_energy_model_check(&model, &field) != JP_OK) {
        return 0;
    }
    (void)jp_energy_predict(&model, &before, &segment, &energy);
    ARRIVED();
    return 0;
}
