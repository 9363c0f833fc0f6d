/** Any frames in any order, any numbers to be sent, for ever. */
#include "hal/can/jp_can.h"
#include "hal/can/wheel_link.h"

#include "tests/proof/any.h"

static void send(void)
{
    struct jp_can_frame targets[JP_WHEELS];
    struct jp_can_frame sample[JP_WHEEL_SAMPLE_FRAMES];
    struct jp_four_wheel_actuation actuation;
    struct jp_four_wheel_sensors sensors;
    uint8_t counter = (uint8_t)any_unsigned(UINT8_MAX);

    ANY(actuation);
    ANY(sensors);
    jp_wheel_targets_pack(targets, &counter, &actuation);
    jp_wheel_sample_pack(sample, &counter, &sensors);
}

int main(void)
{
    static struct jp_wheel_targets targets;
    static struct jp_wheel_link link;
    struct jp_four_wheel_actuation actuation;
    struct jp_four_wheel_sensors sensors;
    struct jp_can_frame frame;
    bool is_whole;

    ANY_TIMES
    {
        ANY(frame);
        frame.length = JP_CAN_WHEEL_TARGET_LENGTH;
        (void)jp_wheel_targets_accept(&targets, &frame, &actuation, &is_whole);
        frame.id = any_bool() ? JP_CAN_WHEEL_FEEDBACK_FRAME_ID : JP_CAN_SUPPLY_SENSORS_FRAME_ID;
        frame.length =
            frame.id == JP_CAN_WHEEL_FEEDBACK_FRAME_ID ? JP_CAN_WHEEL_FEEDBACK_LENGTH : JP_CAN_SUPPLY_SENSORS_LENGTH;
        (void)jp_wheel_link_accept(&link, &frame);
        (void)jp_wheel_link_read(&link, &sensors);
        send();
    }
    ARRIVED();
    return 0;
}
