/** Any frames in any order, any good samples, for ever. */
#include "hal/can/sample_link.h"

#include "tests/proof/any.h"

int main(void)
{
    struct jp_monitor_config limits;
    struct jp_sample_link link;
    struct jp_can_frame frame;
    struct jp_sensors good;
    struct jp_sensors sensors;
    const char *field;

    ANY(limits);
    if (jp_monitor_check(&limits, &field) != JP_OK) {
        return 0;
    }
    jp_sample_link_start(&link, &limits, 100U + any_unsigned(9900));
    if (any_bool()) {
        jp_sample_link_resume(&link, any_unsigned(UINT32_MAX), any_unsigned(UINT32_MAX));
    }
    ANY_TIMES
    {
        ANY(frame);
        frame.length = (uint8_t)any_unsigned(JP_CAN_LENGTH_MAX);
        ANY(good);
        (void)jp_sample_link_accept(&link, (enum jp_sample_part)any_between(0, JP_SAMPLE_PARTS - 1), &frame);
        if (any_bool()) {
            (void)jp_sample_link_read(&link, &good, &sensors);
        }
    }
    ARRIVED();
    return 0;
}
