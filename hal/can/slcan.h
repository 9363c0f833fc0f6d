/**
 * SLCAN: CAN frames as lines of text on a serial line, as adapters speak it since LAWICEL's CAN232. Timestamps are off,
 * the bit rate is 1 Mbit/s. A host opens the adapter's channel; then frames go both ways:
 *
 *   host     C\r S8\r O\r    t10031122AA\r                  tIIILDD… 11-bit id, T 29-bit id, r and R remote frames
 *   adapter  \r  \r   \r     z\r            t0202BEEF\r     BEL refuses a line
 *
 * A line ends with CR; whatever stood before a CR, the next line is read afresh.
 */
#ifndef JOULEPATH_HAL_CAN_SLCAN_H
#define JOULEPATH_HAL_CAN_SLCAN_H

#include <stdbool.h>

#include "hal/can/can.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Longest line with its CR, bytes: a 29-bit id and 8 bytes of data. */
#define JP_SLCAN_LINE_MAX 27U

/** Longest answer of an adapter, bytes. */
#define JP_SLCAN_ANSWER_MAX 6U

/** What a byte completed. */
enum jp_slcan_item {
    JP_SLCAN_NONE,          /**< nothing yet */
    JP_SLCAN_FRAME,         /**< a frame, in the decoder */
    JP_SLCAN_BIT_RATE,      /**< S8: 1 Mbit/s */
    JP_SLCAN_OPEN,          /**< O: open the channel */
    JP_SLCAN_CLOSE,         /**< C: close it */
    JP_SLCAN_VERSION,       /**< V: tell the version */
    JP_SLCAN_SERIAL_NUMBER, /**< N: tell the serial number */
    JP_SLCAN_DONE,          /**< an adapter's answer: an empty line, z or Z */
    JP_SLCAN_REFUSED,       /**< an adapter's answer: BEL, which ends a line too */
    JP_SLCAN_MALFORMED      /**< a line that is none of these */
};

/** Zero-initialised at the start. */
struct jp_slcan_decoder {
    char line[JP_SLCAN_LINE_MAX]; /**< so far */
    uint8_t length;               /**< of it; JP_SLCAN_LINE_MAX: it became too long and is dropped */
    struct jp_can_frame frame;    /**< the last one */
    uint16_t malformed;           /**< lines that are neither frame nor command nor answer, saturating */
    uint16_t overlong;            /**< those among them that are longer than any line, saturating */
};

/** The adapter's end; zero-initialised at the start. */
struct jp_slcan_adapter {
    struct jp_slcan_decoder decoder;
    bool open; /**< the host has opened the channel: frames may go to it */
};

/** Writes the line of a frame and returns its length, bytes. 0: the frame is longer than 8 bytes or its id does not fit
 *  its kind. At most JP_SLCAN_LINE_MAX steps; for ISRs. */
unsigned jp_slcan_encode(char line[JP_SLCAN_LINE_MAX], const struct jp_can_frame *frame);

/** Takes a byte. At most JP_SLCAN_LINE_MAX steps; for the receive interrupt. */
enum jp_slcan_item jp_slcan_decode(struct jp_slcan_decoder *decoder, uint8_t byte);

/**
 * Takes a byte from the host. True: decoder.frame has come, to be put on the bus. *answer goes to the host: a text of
 * at most JP_SLCAN_ANSWER_MAX bytes, "" for none. While the channel is closed frames are refused. At most
 * JP_SLCAN_LINE_MAX steps; for the receive interrupt.
 */
bool jp_slcan_adapter_take(struct jp_slcan_adapter *adapter, uint8_t byte, const char **answer);

#ifdef __cplusplus
}
#endif

#endif
