/**
 * A laser scanner at the far end of a CAN bus: ScanBegin, ScanRanges, ScanEnd.
 *
 * A scan counts only whole and with the right CRC-32. Two are held: one that comes, and one that waits for the
 * background. A scan that comes while another still waits is dropped.
 */
#ifndef JOULEPATH_HAL_CAN_SCAN_LINK_H
#define JOULEPATH_HAL_CAN_SCAN_LINK_H

#include <joulepath/e2e.h>
#include <stdbool.h>
#include <stddef.h>

#include "hal/can/can.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Of a scan. */
#define JP_SCAN_LINK_BEAMS 720U

/** Ranges of a ScanRanges. */
#define JP_SCAN_RANGES 4U

/** Raw values of the signals: 2⁻⁹ m, nothing seen, dropped out. */
#define JP_SCAN_RANGE_ONE     512U
#define JP_SCAN_RANGE_NOTHING 0U
#define JP_SCAN_RANGE_DROPPED 16383U

/** The members but `lost` are private. */
struct jp_scan_link {
    struct jp_e2e_receiver begin_receiver;
    struct jp_e2e_receiver end_receiver;
    uint16_t beams; /* of the robot's scanner */
    uint16_t ranges[2][JP_SCAN_LINK_BEAMS];
    uint8_t filling; /* of the two */
    uint8_t waiting; /* 1 + that which waits for the background; 0: none */
    bool is_open;    /* a scan is under way */
    uint16_t next;   /* index of the ScanRanges that comes next */
    uint32_t crc;
    uint16_t lost; /**< scans that were not whole, or came too soon, saturating */
};

/** Takes scans of so many beams, 2…JP_SCAN_LINK_BEAMS. */
void jp_scan_link_start(struct jp_scan_link *link, uint16_t beams);

/* In the receive interrupt, of frames of the right length. Constant time. */

/** *has_begun: a scan begins. */
enum jp_e2e_result jp_scan_link_accept_begin(struct jp_scan_link *link, const struct jp_can_frame *frame,
                                             bool *has_begun);
void jp_scan_link_accept_ranges(struct jp_scan_link *link, const struct jp_can_frame *frame);
/** *is_whole: a scan waits for the background. */
enum jp_e2e_result jp_scan_link_accept_end(struct jp_scan_link *link, const struct jp_can_frame *frame, bool *is_whole);

/** A scan waits. */
static inline bool jp_scan_link_waits(const struct jp_scan_link *link)
{
    return __atomic_load_n(&link->waiting, __ATOMIC_ACQUIRE) != 0U;
}

/** A scan that waits, raw, of the robot's beams; false: there is none. For the background. */
bool jp_scan_link_take(struct jp_scan_link *link, uint16_t *ranges);

/* The scanner's side. */

/** Frames of a scan of so many beams. */
#define JP_SCAN_FRAMES(beams) (2U + ((beams) + JP_SCAN_RANGES - 1U) / JP_SCAN_RANGES)

/** Frame `index` of JP_SCAN_FRAMES() of a scan of raw ranges; they are made in their order. */
struct jp_scan_counters {
    uint8_t begin;
    uint8_t end;
    uint32_t crc;
};
void jp_scan_pack(struct jp_scan_counters *counters, const uint16_t *ranges, uint16_t beams, unsigned index,
                  struct jp_can_frame *frame);

#ifdef __cplusplus
}
#endif

#endif
