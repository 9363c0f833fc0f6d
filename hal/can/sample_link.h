/**
 * The sensors at the far end of a CAN bus: puts the frames of a sample together and bridges those that are lost.
 *
 * For up to JP_SAMPLE_HOLD_TICKS the encoders go on as before and the rest keeps its value: a balancer cannot just
 * wait. After that there is no measurement.
 */
#ifndef JOULEPATH_HAL_CAN_SAMPLE_LINK_H
#define JOULEPATH_HAL_CAN_SAMPLE_LINK_H

#include "messages.h"

/** Ticks without a sample, or without a bus to send on, that are ridden out. */
#define JP_SAMPLE_HOLD_TICKS 20U

struct jp_sample_link {
    struct jp_e2e_receiver receiver;
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    uint8_t parts; /**< bit for each frame of the present sample that came */
    bool fresh;    /**< a sample that was not read yet */
    bool started;  /**< there was one */
    uint16_t lost; /**< ticks without a sample since the first one, saturating */
    uint16_t missed;
    struct jp_sensors sample;   /**< the last */
    struct jp_sensors read;     /**< what the last tick used */
    int32_t counts_a_tick_left; /**< encoder counts from sample to sample, for each tick between */
    int32_t counts_a_tick_right;
};

/** Zero-initialises. */
void jp_sample_link_start(struct jp_sample_link *link);

/** Takes a frame of a sample; the frames of one sample come in order. JP_E2E_OK also for a part that waits for the
 *  rest. Constant time; for the receive interrupt. */
enum jp_e2e_result jp_sample_link_accept(struct jp_sample_link *link, enum jp_sample_part part,
                                         const struct jp_can_frame *frame);

/** The sample of this tick. JP_ERR_HARDWARE: none for more than JP_SAMPLE_HOLD_TICKS, or none yet. For the control ISR.
 */
enum jp_status jp_sample_link_read(struct jp_sample_link *link, struct jp_sensors *sensors);

#endif
