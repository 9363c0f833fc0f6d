/** Any bytes from the bus in frames of the right length, and any numbers to be sent, for ever. */
#include "hal/can/messages.h"

#include "tests/proof/any.h"

/** Of any length that a bus has. */
static void any_frames(struct jp_can_frame frames[JP_SAMPLE_PARTS])
{
    ANY(frames[0]);
    ANY(frames[1]);
    ANY(frames[2]);
    for (unsigned part = 0; part < (unsigned)JP_SAMPLE_PARTS; part++) {
        frames[part].length = (uint8_t)any_unsigned(JP_CAN_LENGTH_MAX);
    }
}

int main(void)
{
    struct jp_e2e_receiver actuation_receiver = {0};
    struct jp_e2e_receiver sensors_receiver = {0};
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    struct jp_actuation actuation;
    struct jp_sensors sensors;
    struct jp_point waypoint;
    uint8_t counter = (uint8_t)any_unsigned(UINT8_MAX);
    uint32_t crc = JP_ROUTE_CRC_START;

    ANY(sensors);
    ANY_TIMES
    {
        any_frames(frames);
        ANY(actuation);
        ANY(waypoint);
        (void)jp_message_to_actuation(&actuation_receiver, &frames[0], &actuation);
        (void)jp_message_to_sensors(&sensors_receiver, frames, &sensors);
        ANY(sensors);
        jp_message_from_actuation(&frames[0], &counter, &actuation);
        jp_message_from_sensors(frames, &counter, &sensors);
        crc = jp_route_crc(crc, &waypoint);
    }
    ARRIVED();
    return 0;
}
