/** Any bytes where a record may stand, any crashes, any causes of a reset, for ever. */
#include "hal/storage/post_mortem.h"
#include "tests/proof/any.h"

int main(void)
{
    static struct jp_post_mortem record;
    struct jp_reset_report report;
    struct jp_crash crash;

    ANY(record);
    ANY_TIMES
    {
        jp_post_mortem_open(&record, (enum jp_reset_cause)any_between(JP_RESET_POWER_ON, JP_RESET_STACK), &report);
        if (any_bool()) {
            jp_post_mortem_forgive(&record);
        }
        ANY(crash);
        jp_post_mortem_write(&record, &crash);
    }
    ARRIVED();
    return 0;
}
