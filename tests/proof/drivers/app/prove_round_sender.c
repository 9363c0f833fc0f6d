// eva: -eva-slevel-function main:20
/** Any round, again and again, any status that is heard, any time that passes, a port that takes or refuses, for ever.
 */
#include "hal/app/round_sender.h"
#include "tests/proof/any_port.h"

static uint8_t bytes[JP_ROUND_BYTES_MAX];

static void begin(struct jp_round_sender *sender)
{
    const struct jp_round_bytes round = {.bytes = bytes, .stops = (uint8_t)any_between(1, JP_ROUND_STOPS_MAX)};

    jp_round_sender_begin(sender, &round, (uint8_t)any_unsigned(UINT8_MAX), (uint8_t)any_unsigned(UINT8_MAX));
}

int main(void)
{
    static struct jp_round_sender sender;
    struct jp_can_round_status_t status;

    ANY(bytes);
    begin(&sender);
    ANY_TIMES
    {
        if (any_bool()) {
            begin(&sender);
        }
        ANY(status);
        (void)jp_round_sender_hear(&sender, &status);
        jp_round_sender_pass(&sender, any_unsigned(UINT32_MAX));
        jp_round_sender_send(&sender, &any_port);
    }
    ARRIVED();
    return 0;
}
