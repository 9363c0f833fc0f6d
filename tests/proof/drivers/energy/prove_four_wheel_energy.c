// eva: -eva-slevel 100
/** Any model that passes, any piece: one out of its ranges is refused; factors above 0. */
#include <joulepath/four_wheel_energy.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_four_wheel_energy_model model;
    struct jp_four_wheel_energy_model scaled;
    struct jp_four_wheel_drive drive = {0};
    struct jp_four_wheel_piece piece;
    jp_q16 factor[JP_FOUR_WHEEL_FACTORS];
    jp_q16 joules;
    const char *field;

    ANY(model);
    ANY(piece);
    if (jp_four_wheel_energy_check(&model, &field) != JP_OK) {
        return 0;
    }
    for (unsigned i = 0; i < (unsigned)JP_FOUR_WHEEL_FACTORS; i++) {
        factor[i] = any_between(1, INT32_MAX);
    }
    (void)jp_four_wheel_energy_add(&model, &drive, &piece);
    (void)jp_four_wheel_energy_metre(&model, any_between(INT32_MIN, INT32_MAX), any_between(INT32_MIN, INT32_MAX),
                                     &joules);
    jp_four_wheel_energy_scale(&model, factor, &scaled);
    ARRIVED();
    return 0;
}
