/** SLCAN at both ends: what a decoder makes of any bytes can be written again, and says the same then. */
#include "hal/can/slcan.h"
#include "tests/fuzz/fuzz_input.h"

/** The items of a line, read by a decoder that never saw another. */
static enum jp_slcan_item read_line(struct jp_slcan_decoder *decoder, const char *line, unsigned length)
{
    enum jp_slcan_item item = JP_SLCAN_NONE;

    for (unsigned i = 0; i < length; i++) {
        fuzz_require(item == JP_SLCAN_NONE, "a line that is two");
        item = jp_slcan_decode(decoder, (uint8_t)line[i]);
    }
    return item;
}

static void check_frame(const struct jp_can_frame *frame)
{
    struct jp_slcan_decoder again = {.length = 0};
    char line[JP_SLCAN_LINE_MAX];
    char second[JP_SLCAN_LINE_MAX];
    const unsigned length = jp_slcan_encode(line, frame);

    fuzz_require(frame->length <= JP_CAN_LENGTH_MAX, "a frame too long");
    fuzz_require(length > 0U && length <= JP_SLCAN_LINE_MAX, "a decoded frame that cannot be encoded");
    fuzz_require(read_line(&again, line, length) == JP_SLCAN_FRAME, "a line of a frame that is none");
    fuzz_require(again.frame.id == frame->id && again.frame.length == frame->length &&
                     memcmp(again.frame.data, frame->data, (frame->id & JP_CAN_REMOTE) != 0U ? 0 : frame->length) == 0,
                 "another frame");
    fuzz_require(jp_slcan_encode(second, &again.frame) == length && memcmp(line, second, length) == 0, "another line");
}

static void check_answer(const struct jp_slcan_adapter *adapter, const char *answer, bool frame, bool was_open)
{
    fuzz_require(answer != NULL && strlen(answer) <= JP_SLCAN_ANSWER_MAX, "an answer too long");
    fuzz_require(!frame || (adapter->open && was_open), "a frame through a closed channel");
}

/** A frame of the input, such as an interface may hold. */
static void encode_any(struct fuzz_input *input)
{
    struct jp_can_frame frame;
    struct jp_slcan_decoder decoder = {.length = 0};
    char line[JP_SLCAN_LINE_MAX];

    fuzz_fill(input, &frame, sizeof frame);

    const unsigned length = jp_slcan_encode(line, &frame);

    fuzz_require(length <= JP_SLCAN_LINE_MAX, "a line too long");
    fuzz_require(length == 0U || read_line(&decoder, line, length) == JP_SLCAN_FRAME, "a frame that is not read back");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_slcan_decoder decoder = {.length = 0};
    struct jp_slcan_adapter adapter = {.open = false};

    encode_any(&input);
    while (fuzz_more(&input)) {
        const uint8_t byte = fuzz_u8(&input);
        const bool was_open = adapter.open;
        const char *answer = NULL;
        const bool frame = jp_slcan_adapter_take(&adapter, byte, &answer);

        check_answer(&adapter, answer, frame, was_open);
        if (jp_slcan_decode(&decoder, byte) == JP_SLCAN_FRAME) {
            check_frame(&decoder.frame);
        }
        fuzz_require(decoder.length <= JP_SLCAN_LINE_MAX, "the length of a line");
        fuzz_require(decoder.overlong <= decoder.malformed, "more lines too long than wrong");
    }
    return 0;
}
