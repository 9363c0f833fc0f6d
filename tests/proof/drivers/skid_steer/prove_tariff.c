// eva: -eva-slevel 100
/** Any two models that pass, any usual motion. */
#include <joulepath/skid_tariff.h>

#include "tests/proof/any.h"

int main(void)
{
    struct jp_skid_steer_config priced;
    struct jp_skid_energy_model learned;
    struct jp_tariff_factors factors;
    struct jp_motion usual;
    const char *field;

    ANY(priced);
    ANY(learned);
    ANY(usual);
    if (jp_skid_steer_check(&priced, &field) != JP_OK || jp_skid_energy_check(&learned, &field) != JP_OK) {
        return 0;
    }
    (void)jp_skid_tariff_factors(&priced, &learned, &usual, any_unsigned(UINT32_MAX), &factors);
    ARRIVED();
    return 0;
}
