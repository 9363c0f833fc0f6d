/** Any telemetry. */
#include <joulepath/evidence.h>

#include "tests/proof/any.h"

static void any_telemetry(struct jp_telemetry *telemetry)
{
    ANY(*telemetry);
    telemetry->voltages.saturated = any_bool();
}

int main(void)
{
    struct jp_telemetry telemetry;
    struct jp_segment_watch watch;

    any_telemetry(&telemetry);
    jp_segment_watch_begin(&watch, &telemetry);
    ANY_TIMES
    {
        jp_segment_watch_note(&watch, (uint8_t)any_unsigned(UINT8_MAX), (uint8_t)any_unsigned(UINT8_MAX));
    }
    any_telemetry(&telemetry);
    (void)jp_segment_evidence(&watch, &telemetry, any_bool());
    ARRIVED();
    return 0;
}
