/** Any factors and deviations. */
#include "hal/app/ecu_factors.h"
#include "tests/proof/any.h"

int main(void)
{
    struct jp_ecu_factors learned;
    struct jp_ecu_factors deviations;
    struct jp_can_frame frames[JP_ECU_LEARNED_FRAMES];

    ANY(learned);
    ANY(deviations);
    (void)jp_ecu_tell_factors(&learned, &deviations, frames);
    ARRIVED();
    return 0;
}
