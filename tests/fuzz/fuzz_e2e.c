/**
 * The receiver of end-to-end protection, by what its header promises: messages that are altered are not used, nor those
 * that are repeated; what comes in order, with gaps that are short enough, is.
 */
#include <joulepath/e2e.h>

#include "tests/fuzz/fuzz_input.h"

#define LENGTH_MAX 8U
#define COUNTERS   16U

/** Byte for byte and bit for bit, from the standard's polynomial. */
static uint8_t crc8(const uint8_t *bytes, size_t length, uint8_t data_id)
{
    unsigned crc = 0xFF;

    for (size_t i = 1; i <= length; i++) {
        crc ^= i < length ? bytes[i] : data_id;
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 0x80U) != 0U ? ((crc << 1) ^ 0x2FU) & 0xFFU : crc << 1;
        }
    }
    return (uint8_t)(crc ^ 0xFFU);
}

struct link {
    struct jp_e2e_receiver receiver;
    uint8_t sent;
    uint8_t data_id;
    bool used_one;
    bool doubts;
    uint8_t used;     /**< counter of the last message that was used */
    uint8_t doubtful; /**< of one since then that was out of place */
};

/** What the counter of a message that is whole makes of it. */
static enum jp_e2e_result judge(struct link *link, uint8_t counter)
{
    const unsigned ahead = ((unsigned)counter - link->used) & (COUNTERS - 1U);
    const bool in_time = link->used_one && ahead <= JP_E2E_GAP_MAX + 1U;
    const bool follows = link->doubts && ((link->doubtful + 1U) & (COUNTERS - 1U)) == counter;

    if ((link->used_one && ahead == 0U) || (!in_time && link->doubts && link->doubtful == counter)) {
        return JP_E2E_REPEATED;
    }
    if (in_time || follows) {
        link->used = counter;
        link->used_one = true;
        link->doubts = false;
        return JP_E2E_OK;
    }

    const bool first = !link->used_one && !link->doubts;

    link->doubts = true;
    link->doubtful = counter;
    return first ? JP_E2E_FIRST : JP_E2E_SEQUENCE;
}

static void receive(struct link *link, const uint8_t *message, size_t length)
{
    const enum jp_e2e_result result = jp_e2e_check(&link->receiver, link->data_id, message, length);
    const bool whole = length >= JP_E2E_LENGTH_MIN && message[0] == crc8(message, length, link->data_id);

    fuzz_require(result == (whole ? judge(link, message[1] & (COUNTERS - 1U)) : JP_E2E_CRC), "what a message is");
    fuzz_require(!whole || result != JP_E2E_OK || link->receiver.gap <= JP_E2E_GAP_MAX, "a gap too long");
}

/** A message is sent, perhaps lost, perhaps altered. */
static void send(struct link *link, struct fuzz_input *input)
{
    const size_t length = JP_E2E_LENGTH_MIN + fuzz_below(input, LENGTH_MAX - JP_E2E_LENGTH_MIN + 1U);
    uint8_t message[LENGTH_MAX] = {0};

    fuzz_fill(input, message, length);
    link->sent = (uint8_t)(link->sent + fuzz_below(input, COUNTERS));
    jp_e2e_protect(&link->sent, link->data_id, message, length);
    fuzz_require(message[0] == crc8(message, length, link->data_id), "a sender's CRC");
    message[fuzz_below(input, (uint32_t)length)] ^= fuzz_u8(input);
    receive(link, message, length);
}

/** Any bytes. */
static void receive_any(struct link *link, struct fuzz_input *input)
{
    const size_t length = fuzz_below(input, LENGTH_MAX + 1U);
    uint8_t message[LENGTH_MAX] = {0};

    fuzz_fill(input, message, length);
    receive(link, message, length);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct link link = {.data_id = fuzz_u8(&input)};

    while (fuzz_more(&input)) {
        if (fuzz_below(&input, 4) == 0U) {
            receive_any(&link, &input);
        } else {
            send(&link, &input);
        }
    }
    return 0;
}
