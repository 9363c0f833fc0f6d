/**
 * End-to-end protection of messages: AUTOSAR E2E profile 2.
 *
 * Byte 0 is a CRC-8H2F of all bytes after it and of the message's data id, which stands in every place of the profile's
 * data id list; the low nibble of byte 1 counts the messages. Up to three flipped bits in a message of 8 bytes are
 * always found, other corruption in 255 of 256 cases; loss, repetition and reordering show in the counter.
 */
#ifndef JOULEPATH_E2E_H
#define JOULEPATH_E2E_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** After more lost messages than this the next one could as well be an old one: then two consecutive ones are needed,
 * as at the start. */
#define JP_E2E_GAP_MAX 6U

/** Shortest message, bytes. */
#define JP_E2E_LENGTH_MIN 2U

enum jp_e2e_result {
    JP_E2E_OK,       /**< use it; it follows the one before, or at most JP_E2E_GAP_MAX were lost between */
    JP_E2E_FIRST,    /**< do not use it: right in itself, but nothing came before to compare it with */
    JP_E2E_REPEATED, /**< do not use it: the same counter as the one before */
    JP_E2E_SEQUENCE, /**< do not use it: late, out of order, or too many were lost */
    JP_E2E_CRC       /**< do not use it: corrupt, or another message */
};

/** What a receiver keeps for each message; zero-initialised at the start. A late message changes nothing for those that
 *  come in time. */
struct jp_e2e_receiver {
    uint8_t counter;   /**< of the last message that was used */
    bool synchronised; /**< there was one */
    bool doubted;      /**< since then a message came out of sequence */
    uint8_t doubtful;  /**< its counter */
    uint8_t gap;       /**< messages lost before the last one that was used; 0 after a doubtful one */
};

/** The CRC-8H2F of further bytes, before its final inversion; `crc` is JP_E2E_CRC_START at first. Two table look-ups a
 *  byte; an ISR may call it. */
uint8_t jp_e2e_crc(uint8_t crc, const uint8_t *bytes, size_t length);

#define JP_E2E_CRC_START 0xFFU

/** Increments *counter and writes it and the CRC into the message, which has at least JP_E2E_LENGTH_MIN bytes. Work:
 * the CRC of the message; an ISR may call it. */
void jp_e2e_protect(uint8_t *counter, uint8_t data_id, uint8_t *message, size_t length);

/** As jp_e2e_protect(), with a CRC that continues over `rest`: for a message that does not fit one frame. */
void jp_e2e_protect_group(uint8_t *counter, uint8_t data_id, uint8_t *message, size_t length, const uint8_t *rest,
                          size_t rest_length);

/** Checks a received message. Fewer than JP_E2E_LENGTH_MIN bytes: JP_E2E_CRC. Work: the CRC of the message; an ISR may
 *  call it. */
enum jp_e2e_result jp_e2e_check(struct jp_e2e_receiver *receiver, uint8_t data_id, const uint8_t *message,
                                size_t length);

/** As jp_e2e_check(), for messages of jp_e2e_protect_group(). */
enum jp_e2e_result jp_e2e_check_group(struct jp_e2e_receiver *receiver, uint8_t data_id, const uint8_t *message,
                                      size_t length, const uint8_t *rest, size_t rest_length);

#ifdef __cplusplus
}
#endif

#endif
