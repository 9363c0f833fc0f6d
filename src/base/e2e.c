#include <joulepath/e2e.h>

#define COUNTER_MASK 0x0FU

static uint8_t shift_nibble(uint8_t crc, unsigned nibble)
{
    /* CRC of each nibble, polynomial 0x2F. */
    static const uint8_t nibble_crc[16] = {0x00, 0x2F, 0x5E, 0x71, 0xBC, 0x93, 0xE2, 0xCD,
                                           0x57, 0x78, 0x09, 0x26, 0xEB, 0xC4, 0xB5, 0x9A};

    return (uint8_t)(((unsigned)crc << 4) ^ nibble_crc[((unsigned)crc >> 4) ^ nibble]);
}

uint8_t jp_e2e_crc(uint8_t crc, const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        crc = shift_nibble(crc, (unsigned)bytes[i] >> 4);
        crc = shift_nibble(crc, bytes[i] & 0x0FU);
    }
    return crc;
}

static uint8_t message_crc(uint8_t data_id, const uint8_t *message, size_t length, const uint8_t *rest,
                           size_t rest_length)
{
    uint8_t crc = jp_e2e_crc(JP_E2E_CRC_START, &message[1], length - 1U);

    crc = jp_e2e_crc(crc, rest, rest_length);
    return (uint8_t)~jp_e2e_crc(crc, &data_id, 1);
}

void jp_e2e_protect_group(uint8_t *counter, uint8_t data_id, uint8_t *message, size_t length, const uint8_t *rest,
                          size_t rest_length)
{
    *counter = (uint8_t)((*counter + 1U) & COUNTER_MASK);
    message[1] = (uint8_t)((message[1] & ~COUNTER_MASK) | *counter);
    message[0] = message_crc(data_id, message, length, rest, rest_length);
}

void jp_e2e_protect(uint8_t *counter, uint8_t data_id, uint8_t *message, size_t length)
{
    jp_e2e_protect_group(counter, data_id, message, length, NULL, 0);
}

static unsigned steps(uint8_t from, uint8_t to)
{
    return ((unsigned)to - from) & COUNTER_MASK;
}

static enum jp_e2e_result use(struct jp_e2e_receiver *receiver, uint8_t counter, unsigned step)
{
    receiver->counter = counter;
    receiver->synchronised = true;
    receiver->doubted = false;
    receiver->gap = (uint8_t)(step - 1U);
    return JP_E2E_OK;
}

/** Out of place: an old message, or the first after a long gap. The next one tells. */
static enum jp_e2e_result doubt(struct jp_e2e_receiver *receiver, uint8_t counter)
{
    const bool first = !receiver->synchronised && !receiver->doubted;

    if (receiver->doubted && receiver->doubtful == counter) {
        return JP_E2E_REPEATED;
    }
    if (receiver->doubted && steps(receiver->doubtful, counter) == 1U) {
        return use(receiver, counter, 1);
    }
    receiver->doubted = true;
    receiver->doubtful = counter;
    return first ? JP_E2E_FIRST : JP_E2E_SEQUENCE;
}

static enum jp_e2e_result follow(struct jp_e2e_receiver *receiver, uint8_t counter)
{
    const unsigned step = steps(receiver->counter, counter);

    if (receiver->synchronised && step == 0U) {
        return JP_E2E_REPEATED;
    }
    if (receiver->synchronised && step <= JP_E2E_GAP_MAX + 1U) {
        return use(receiver, counter, step);
    }
    return doubt(receiver, counter);
}

enum jp_e2e_result jp_e2e_check_group(struct jp_e2e_receiver *receiver, uint8_t data_id, const uint8_t *message,
                                      size_t length, const uint8_t *rest, size_t rest_length)
{
    if (length < JP_E2E_LENGTH_MIN || message[0] != message_crc(data_id, message, length, rest, rest_length)) {
        return JP_E2E_CRC;
    }
    return follow(receiver, message[1] & COUNTER_MASK);
}

enum jp_e2e_result jp_e2e_check(struct jp_e2e_receiver *receiver, uint8_t data_id, const uint8_t *message,
                                size_t length)
{
    return jp_e2e_check_group(receiver, data_id, message, length, NULL, 0);
}
