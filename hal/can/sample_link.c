#include "sample_link.h"

#define ALL_PARTS ((1U << JP_SAMPLE_PARTS) - 1U)

void jp_sample_link_start(struct jp_sample_link *link)
{
    *link = (struct jp_sample_link){.started = false};
}

/** In the first two frames the sample's counter stands in the low bits of byte 0, in the last in those of byte 1. */
static uint8_t counter_of(const struct jp_can_frame *frame, enum jp_sample_part part)
{
    return frame->data[part == JP_SAMPLE_CURRENTS ? 1 : 0] & 0x0FU;
}

static bool parts_belong_together(const struct jp_sample_link *link)
{
    const uint8_t counter = counter_of(&link->frames[JP_SAMPLE_CURRENTS], JP_SAMPLE_CURRENTS);

    return link->parts == ALL_PARTS && counter_of(&link->frames[JP_SAMPLE_WHEELS], JP_SAMPLE_WHEELS) == counter &&
           counter_of(&link->frames[JP_SAMPLE_BALANCE], JP_SAMPLE_BALANCE) == counter;
}

static int32_t counts_a_tick(uint32_t now, uint32_t before, uint16_t ticks)
{
    return (int32_t)(now - before) / (int32_t)ticks;
}

static void note_pace(struct jp_sample_link *link, const struct jp_sensors *before)
{
    const uint16_t ticks = (uint16_t)(link->missed + 1U);

    if (link->started) {
        link->counts_a_tick_left = counts_a_tick(link->sample.encoder_left, before->encoder_left, ticks);
        link->counts_a_tick_right = counts_a_tick(link->sample.encoder_right, before->encoder_right, ticks);
    }
}

static enum jp_e2e_result complete(struct jp_sample_link *link)
{
    const struct jp_sensors before = link->sample;
    enum jp_e2e_result result = jp_message_to_sensors(&link->receiver, link->frames, &link->sample);

    if (result == JP_E2E_OK) {
        note_pace(link, &before);
        link->fresh = true;
        link->started = true;
    }
    return result;
}

enum jp_e2e_result jp_sample_link_accept(struct jp_sample_link *link, enum jp_sample_part part,
                                         const struct jp_can_frame *frame)
{
    enum jp_e2e_result result;

    link->frames[part] = *frame;
    link->parts |= (uint8_t)(1U << (unsigned)part);
    if (part != JP_SAMPLE_CURRENTS) {
        return JP_E2E_OK;
    }
    result = parts_belong_together(link) ? complete(link) : JP_E2E_SEQUENCE;
    link->parts = 0;
    return result;
}

static void go_on(struct jp_sample_link *link)
{
    link->read.encoder_left += (uint32_t)link->counts_a_tick_left;
    link->read.encoder_right += (uint32_t)link->counts_a_tick_right;
}

enum jp_status jp_sample_link_read(struct jp_sample_link *link, struct jp_sensors *sensors)
{
    if (link->fresh) {
        link->fresh = false;
        link->missed = 0;
        link->read = link->sample;
        *sensors = link->read;
        return JP_OK;
    }
    if (!link->started) {
        return JP_ERR_HARDWARE;
    }
    if (link->lost < UINT16_MAX) {
        link->lost++;
    }
    if (link->missed >= JP_SAMPLE_HOLD_TICKS) {
        return JP_ERR_HARDWARE;
    }
    link->missed++;
    go_on(link);
    *sensors = link->read;
    return JP_OK;
}
