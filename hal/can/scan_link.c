#include "hal/can/scan_link.h"

#include <joulepath/count.h>

#include "hal/can/jp_can.h"
#include "hal/can/messages.h"
#include "hal/storage/crc32.h"

void jp_scan_link_start(struct jp_scan_link *link, uint16_t beams)
{
    *link = (struct jp_scan_link){.beams = beams};
}

static void lose(struct jp_scan_link *link)
{
    if (link->is_open) {
        link->is_open = false;
        link->lost = jp_one_more16(link->lost);
    }
}

static unsigned frames_of(uint16_t beams)
{
    return JP_SCAN_FRAMES(beams) - 2U;
}

enum jp_e2e_result jp_scan_link_accept_begin(struct jp_scan_link *link, const struct jp_can_frame *frame,
                                             bool *has_begun)
{
    const enum jp_e2e_result result =
        jp_e2e_check(&link->begin_receiver, JP_DATA_ID_SCAN_BEGIN, frame->data, frame->length);
    struct jp_can_scan_begin_t signals;

    *has_begun = false;
    /* The whole scan has its own check, so it need not follow the one before. */
    if (result == JP_E2E_CRC) {
        return result;
    }
    lose(link);
    (void)jp_can_scan_begin_unpack(&signals, frame->data, frame->length);
    *has_begun = signals.beams == link->beams;
    link->is_open = *has_begun;
    link->next = 0;
    link->crc = 0;
    return JP_E2E_OK;
}

void jp_scan_link_accept_ranges(struct jp_scan_link *link, const struct jp_can_frame *frame)
{
    struct jp_can_scan_ranges_t signals;

    (void)jp_can_scan_ranges_unpack(&signals, frame->data, frame->length);
    if (!link->is_open || signals.index != link->next || link->next >= frames_of(link->beams)) {
        lose(link);
        return;
    }
    const uint16_t ranges[JP_SCAN_RANGES] = {signals.range0, signals.range1, signals.range2, signals.range3};
    const unsigned first = link->next * JP_SCAN_RANGES;

    for (unsigned i = 0; i < JP_SCAN_RANGES && first + i < link->beams; i++) {
        link->ranges[link->filling][first + i] = ranges[i];
    }
    link->crc = jp_crc32(link->crc, &frame->data[1], JP_CAN_LENGTH_MAX - 1U);
    link->next++;
}

enum jp_e2e_result jp_scan_link_accept_end(struct jp_scan_link *link, const struct jp_can_frame *frame, bool *is_whole)
{
    const enum jp_e2e_result result =
        jp_e2e_check(&link->end_receiver, JP_DATA_ID_SCAN_END, frame->data, frame->length);
    struct jp_can_scan_end_t signals;

    *is_whole = false;
    if (result == JP_E2E_CRC) {
        return result;
    }
    (void)jp_can_scan_end_unpack(&signals, frame->data, frame->length);
    if (!link->is_open || link->next != frames_of(link->beams) || signals.ranges_crc != link->crc ||
        __atomic_load_n(&link->waiting, __ATOMIC_ACQUIRE) != 0U) {
        lose(link);
        return JP_E2E_OK;
    }
    *is_whole = true;
    link->is_open = false;
    __atomic_store_n(&link->waiting, (uint8_t)(1U + link->filling), __ATOMIC_RELEASE);
    link->filling = (uint8_t)(1U - link->filling);
    return JP_E2E_OK;
}

bool jp_scan_link_take(struct jp_scan_link *link, uint16_t *ranges)
{
    const uint8_t waiting = __atomic_load_n(&link->waiting, __ATOMIC_ACQUIRE);

    if (waiting == 0U) {
        return false;
    }
    for (uint16_t i = 0; i < link->beams; i++) {
        ranges[i] = link->ranges[waiting - 1U][i];
    }
    __atomic_store_n(&link->waiting, 0, __ATOMIC_RELEASE);
    return true;
}

/* The scanner's side. */

static void pack_ranges(struct jp_scan_counters *counters, const uint16_t *ranges, uint16_t beams, unsigned index,
                        struct jp_can_frame *frame)
{
    uint16_t raw[JP_SCAN_RANGES];

    for (unsigned i = 0; i < JP_SCAN_RANGES; i++) {
        const unsigned beam = index * JP_SCAN_RANGES + i;

        raw[i] = beam < beams ? ranges[beam] : (uint16_t)JP_SCAN_RANGE_NOTHING;
    }
    const struct jp_can_scan_ranges_t signals = {
        .index = (uint8_t)index, .range0 = raw[0], .range1 = raw[1], .range2 = raw[2], .range3 = raw[3]};

    *frame = (struct jp_can_frame){.id = JP_CAN_SCAN_RANGES_FRAME_ID, .length = JP_CAN_SCAN_RANGES_LENGTH};
    (void)jp_can_scan_ranges_pack(frame->data, &signals, sizeof frame->data);
    counters->crc = jp_crc32(counters->crc, &frame->data[1], JP_CAN_LENGTH_MAX - 1U);
}

void jp_scan_pack(struct jp_scan_counters *counters, const uint16_t *ranges, uint16_t beams, unsigned index,
                  struct jp_can_frame *frame)
{
    const struct jp_can_scan_begin_t head = {.beams = beams};

    if (index == 0U) {
        counters->crc = 0;
        *frame = (struct jp_can_frame){.id = JP_CAN_SCAN_BEGIN_FRAME_ID, .length = JP_CAN_SCAN_BEGIN_LENGTH};
        (void)jp_can_scan_begin_pack(frame->data, &head, sizeof frame->data);
        jp_e2e_protect(&counters->begin, JP_DATA_ID_SCAN_BEGIN, frame->data, frame->length);
    } else if (index <= frames_of(beams)) {
        pack_ranges(counters, ranges, beams, index - 1U, frame);
    } else {
        const struct jp_can_scan_end_t tail = {.ranges_crc = counters->crc};

        *frame = (struct jp_can_frame){.id = JP_CAN_SCAN_END_FRAME_ID, .length = JP_CAN_SCAN_END_LENGTH};
        (void)jp_can_scan_end_pack(frame->data, &tail, sizeof frame->data);
        jp_e2e_protect(&counters->end, JP_DATA_ID_SCAN_END, frame->data, frame->length);
    }
}
