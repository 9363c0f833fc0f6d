#include "hal/can/slcan.h"

#include <joulepath/count.h>
#include <joulepath/version.h>

#define CR  '\r'
#define BEL '\a'

#define FLAGS           (JP_CAN_EXTENDED | JP_CAN_REMOTE)
#define STANDARD_ID_MAX 0x7FFU
#define EXTENDED_ID_MAX 0x1FFFFFFFU

#define STANDARD_ID_DIGITS 3U
#define EXTENDED_ID_DIGITS 8U

/* V, two digits of the hardware, two of the software. */
#define TEXT_OF(number) #number
#define TEXT(number)    TEXT_OF(number)
#define VERSION_ANSWER  "V10" TEXT(JP_VERSION_MAJOR) TEXT(JP_VERSION_MINOR) "\r"
#define SERIAL_ANSWER   "NJP01\r"
_Static_assert(sizeof VERSION_ANSWER - 1 == JP_SLCAN_ANSWER_MAX, "one digit each for major and minor");
_Static_assert(sizeof SERIAL_ANSWER - 1 == JP_SLCAN_ANSWER_MAX, "four characters");

static bool is_extended(uint32_t id)
{
    return (id & JP_CAN_EXTENDED) != 0U;
}

static bool is_remote(uint32_t id)
{
    return (id & JP_CAN_REMOTE) != 0U;
}

static unsigned id_digits(uint32_t id)
{
    return is_extended(id) ? EXTENDED_ID_DIGITS : STANDARD_ID_DIGITS;
}

static bool id_fits(uint32_t id)
{
    return (id & ~FLAGS) <= (is_extended(id) ? EXTENDED_ID_MAX : STANDARD_ID_MAX);
}

/* Frame to line. */

static char kind_letter(uint32_t id)
{
    if (is_remote(id)) {
        return is_extended(id) ? 'R' : 'r';
    }
    return is_extended(id) ? 'T' : 't';
}

static char *write_hex(char *end, uint32_t value, unsigned digits)
{
    for (unsigned left = digits; left > 0U; left--) {
        *end = "0123456789ABCDEF"[(value >> (4U * (left - 1U))) & 0xFU];
        end++;
    }
    return end;
}

unsigned jp_slcan_encode(char line[JP_SLCAN_LINE_MAX], const struct jp_can_frame *frame)
{
    char *end = line;

    if (frame->length > JP_CAN_LENGTH_MAX || !id_fits(frame->id)) {
        return 0;
    }
    *end = kind_letter(frame->id);
    end = write_hex(end + 1, frame->id & ~FLAGS, id_digits(frame->id));
    end = write_hex(end, frame->length, 1);
    for (unsigned i = 0; i < frame->length && !is_remote(frame->id); i++) {
        end = write_hex(end, frame->data[i], 2);
    }
    *end = CR;
    return (unsigned)(end - line) + 1U;
}

/* Line to frame. */

/** Reads `digits` hexadecimal digits of either case; false: there is something else. */
static bool read_hex(const char *text, unsigned digits, uint32_t *value)
{
    *value = 0;
    for (unsigned i = 0; i < digits; i++) {
        const char c = text[i];
        uint32_t digit;

        if (c >= '0' && c <= '9') {
            digit = (uint32_t)(c - '0');
        } else if (c >= 'A' && c <= 'F') {
            digit = (uint32_t)(c - 'A') + 10U;
        } else if (c >= 'a' && c <= 'f') {
            digit = (uint32_t)(c - 'a') + 10U;
        } else {
            return false;
        }
        *value = (*value << 4) | digit;
    }
    return true;
}

static bool read_data(struct jp_can_frame *frame, const char *text)
{
    uint32_t byte;

    for (unsigned i = 0; i < frame->length; i++) {
        if (!read_hex(&text[2U * i], 2, &byte)) {
            return false;
        }
        frame->data[i] = (uint8_t)byte;
    }
    return true;
}

/** The line has one of the four letters of a frame; `flags` say which. */
static bool read_frame(struct jp_slcan_decoder *decoder, uint32_t flags)
{
    struct jp_can_frame frame = {.id = 0};
    const unsigned head = 1U + id_digits(flags) + 1U; /* letter, id, length */
    uint32_t id;
    uint32_t length;
    unsigned data_digits;

    if (decoder->length < head || !read_hex(&decoder->line[1], id_digits(flags), &id) ||
        !read_hex(&decoder->line[head - 1U], 1, &length)) {
        return false;
    }
    frame.id = id | flags;
    frame.length = (uint8_t)length;
    data_digits = is_remote(flags) ? 0U : 2U * length;
    if (id > (is_extended(flags) ? EXTENDED_ID_MAX : STANDARD_ID_MAX) || length > JP_CAN_LENGTH_MAX ||
        decoder->length != head + data_digits) {
        return false;
    }
    if (!is_remote(flags) && !read_data(&frame, &decoder->line[head])) {
        return false;
    }
    decoder->frame = frame;
    return true;
}

static enum jp_slcan_item frame_of(struct jp_slcan_decoder *decoder, uint32_t flags)
{
    return read_frame(decoder, flags) ? JP_SLCAN_FRAME : JP_SLCAN_MALFORMED;
}

static enum jp_slcan_item command_of(char letter)
{
    switch (letter) {
    case 'O':
        return JP_SLCAN_OPEN;
    case 'C':
        return JP_SLCAN_CLOSE;
    case 'V':
        return JP_SLCAN_VERSION;
    case 'N':
        return JP_SLCAN_SERIAL_NUMBER;
    case 'z':
    case 'Z':
        return JP_SLCAN_DONE;
    default:
        return JP_SLCAN_MALFORMED;
    }
}

static enum jp_slcan_item item_of(struct jp_slcan_decoder *decoder)
{
    if (decoder->length == 0U) {
        return JP_SLCAN_DONE;
    }
    if (decoder->length == 1U) {
        return command_of(decoder->line[0]);
    }
    switch (decoder->line[0]) {
    case 't':
        return frame_of(decoder, 0);
    case 'T':
        return frame_of(decoder, JP_CAN_EXTENDED);
    case 'r':
        return frame_of(decoder, JP_CAN_REMOTE);
    case 'R':
        return frame_of(decoder, FLAGS);
    case 'S':
        return decoder->length == 2U && decoder->line[1] == '8' ? JP_SLCAN_BIT_RATE : JP_SLCAN_MALFORMED;
    default:
        return JP_SLCAN_MALFORMED;
    }
}

/* Bytes to lines. */

/** A line that is full without its CR is too long. */
static bool is_overlong(const struct jp_slcan_decoder *decoder)
{
    return decoder->length == JP_SLCAN_LINE_MAX;
}

static void count_malformed(struct jp_slcan_decoder *decoder)
{
    decoder->malformed = jp_one_more16(decoder->malformed);
    if (is_overlong(decoder)) {
        decoder->overlong = jp_one_more16(decoder->overlong);
    }
}

static enum jp_slcan_item end_line(struct jp_slcan_decoder *decoder)
{
    const enum jp_slcan_item item = is_overlong(decoder) ? JP_SLCAN_MALFORMED : item_of(decoder);

    if (item == JP_SLCAN_MALFORMED) {
        count_malformed(decoder);
    }
    decoder->length = 0;
    return item;
}

static enum jp_slcan_item take_refusal(struct jp_slcan_decoder *decoder)
{
    if (decoder->length > 0U) {
        count_malformed(decoder);
    }
    decoder->length = 0;
    return JP_SLCAN_REFUSED;
}

enum jp_slcan_item jp_slcan_decode(struct jp_slcan_decoder *decoder, uint8_t byte)
{
    if (byte == CR) {
        return end_line(decoder);
    }
    if (byte == BEL) {
        return take_refusal(decoder);
    }
    if (!is_overlong(decoder)) {
        decoder->line[decoder->length] = (char)byte;
        decoder->length++;
    }
    return JP_SLCAN_NONE;
}

/* The adapter. */

static const char *done(const struct jp_slcan_adapter *adapter)
{
    return is_extended(adapter->decoder.frame.id) ? "Z\r" : "z\r";
}

bool jp_slcan_adapter_take(struct jp_slcan_adapter *adapter, uint8_t byte, const char **answer)
{
    *answer = "";
    switch (jp_slcan_decode(&adapter->decoder, byte)) {
    case JP_SLCAN_FRAME:
        *answer = adapter->open ? done(adapter) : "\a";
        return adapter->open;
    case JP_SLCAN_OPEN:
        adapter->open = true;
        *answer = "\r";
        break;
    case JP_SLCAN_CLOSE:
        adapter->open = false;
        *answer = "\r";
        break;
    case JP_SLCAN_BIT_RATE:
        *answer = "\r";
        break;
    case JP_SLCAN_VERSION:
        *answer = VERSION_ANSWER;
        break;
    case JP_SLCAN_SERIAL_NUMBER:
        *answer = SERIAL_ANSWER;
        break;
    case JP_SLCAN_MALFORMED:
        *answer = "\a";
        break;
    case JP_SLCAN_NONE:
    case JP_SLCAN_DONE:
    case JP_SLCAN_REFUSED:
    default:
        break;
    }
    return false;
}
