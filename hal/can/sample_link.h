/**
 * The sensors at the far end of a CAN bus: puts the frames of a sample together and bridges those that are lost.
 *
 * For up to JP_SAMPLE_HOLD_MS the encoders go on as before and the rest keeps its value: a balancer cannot just
 * wait. After that there is no measurement. When samples come again, counts and rates go to where they are in steps
 * that the monitor takes for plausible, for as many ticks as were bridged: after that a jump is a jump.
 */
#ifndef JOULEPATH_HAL_CAN_SAMPLE_LINK_H
#define JOULEPATH_HAL_CAN_SAMPLE_LINK_H

#include <joulepath/monitor.h>

#include "hal/can/messages.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Without a sample, or without a bus to send on, for so long is ridden out. */
#define JP_SAMPLE_HOLD_MS 40U

/** The same in ticks, of which there are tick_rate a second. */
static inline uint16_t jp_sample_hold_ticks(uint32_t tick_rate)
{
    return (uint16_t)(tick_rate * JP_SAMPLE_HOLD_MS / 1000U);
}

/** Differences of counts whose median is the pace: one corrupt count makes two wrong ones. */
#define JP_SAMPLE_PACES 5U

/** One encoder over the gaps between samples. */
struct jp_sample_encoder {
    uint32_t base;                  /**< what the next sample's bits are put on */
    uint32_t last;                  /**< count of the last sample */
    int32_t paces[JP_SAMPLE_PACES]; /**< counts a tick between the last samples */
};

struct jp_sample_link {
    const struct jp_monitor_config *limits;
    uint16_t hold_ticks;
    struct jp_e2e_receiver receiver;
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    uint8_t parts;            /**< bit for each frame of the present sample that came */
    bool fresh;               /**< a sample that was not read yet */
    bool started;             /**< there was one */
    uint8_t newest;           /**< in paces */
    uint16_t lost;            /**< ticks without a sample since the first one, saturating */
    uint16_t missed;          /**< ticks since the last sample */
    uint16_t catch_up;        /**< ticks that are left to get to where the samples are */
    struct jp_sensors sample; /**< the last */
    struct jp_sample_encoder left;
    struct jp_sample_encoder right;
};

/** No sample yet. `limits` say what is plausible, and must stay. */
void jp_sample_link_start(struct jp_sample_link *link, const struct jp_monitor_config *limits, uint32_t tick_rate);

/** Before the first sample: its counts are those nearest to these. */
void jp_sample_link_resume(struct jp_sample_link *link, uint32_t encoder_left, uint32_t encoder_right);

/** Takes a frame of a sample; the frames of one sample come in order. JP_E2E_OK also for a part that waits for the
 *  rest. Constant time; for the receive interrupt. */
enum jp_e2e_result jp_sample_link_accept(struct jp_sample_link *link, enum jp_sample_part part,
                                         const struct jp_can_frame *frame);

/** The sample of this tick. `good` is the last plausible one, which is held while none comes: JP_HELD, and where the
 *  encoders must be by now. JP_ERR_HARDWARE: none for more than JP_SAMPLE_HOLD_MS, or none yet; *sensors is not
 * written. For the control ISR. */
enum jp_status jp_sample_link_read(struct jp_sample_link *link, const struct jp_sensors *good,
                                   struct jp_sensors *sensors);

#ifdef __cplusplus
}
#endif

#endif
