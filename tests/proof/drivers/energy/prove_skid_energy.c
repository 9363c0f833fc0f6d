// eva: -eva-slevel 100
/** Any model that passes, any pieces and motions: those out of their ranges are refused; factors above 0. */
#include <joulepath/skid_energy.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_skid_energy_model model;
    struct jp_skid_energy_model scaled;
    struct jp_skid_drive drive = {0};
    struct jp_skid_piece piece;
    struct jp_motion motion;
    jp_q16 factor[JP_SKID_FACTORS];
    jp_q16 power;
    const char *field;

    ANY(model);
    ANY(piece);
    ANY(motion);
    if (jp_skid_energy_check(&model, &field) != JP_OK) {
        return 0;
    }
    for (unsigned i = 0; i < (unsigned)JP_SKID_FACTORS; i++) {
        factor[i] = any_between(1, INT32_MAX);
    }
    (void)jp_skid_energy_power(&model, &motion, any_int(), &power);
    (void)jp_skid_energy_add(&model, &drive, &piece);
    jp_skid_energy_scale(&model, factor, &scaled);
    ARRIVED();
    return 0;
}
