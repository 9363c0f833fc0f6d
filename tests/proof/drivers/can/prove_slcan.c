/** Any bytes from the line, any frames to it, for ever. */
#include "hal/can/slcan.h"

#include "tests/proof/any.h"

int main(void)
{
    static struct jp_slcan_decoder decoder;
    static struct jp_slcan_adapter adapter;
    struct jp_can_frame frame;
    char line[JP_SLCAN_LINE_MAX];
    const char *answer;

    ANY_TIMES
    {
        ANY(frame);
        (void)jp_slcan_encode(line, &frame);
        (void)jp_slcan_decode(&decoder, (uint8_t)any_unsigned(UINT8_MAX));
        (void)jp_slcan_adapter_take(&adapter, (uint8_t)any_unsigned(UINT8_MAX), &answer);
    }
    ARRIVED();
    return 0;
}
