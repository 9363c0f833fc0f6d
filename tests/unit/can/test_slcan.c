/* SLCAN: every kind of frame as text and back, every command and answer, lines that are wrong in every place. */
#include "hal/can/slcan.h"

#include <string.h>

#include "unity.h"

#define EXTENDED JP_CAN_EXTENDED
#define REMOTE   JP_CAN_REMOTE

static struct jp_slcan_decoder decoder;
static struct jp_slcan_adapter adapter;
static char text[JP_SLCAN_LINE_MAX + 1];

void setUp(void)
{
    decoder = (struct jp_slcan_decoder){.length = 0};
    adapter = (struct jp_slcan_adapter){.open = false};
}

void tearDown(void)
{
}

static struct jp_can_frame frame_of(uint32_t id, uint8_t length, const char *data)
{
    struct jp_can_frame frame = {.id = id, .length = length};

    memcpy(frame.data, data, strlen(data));
    return frame;
}

static const char *encoded(struct jp_can_frame frame)
{
    const unsigned length = jp_slcan_encode(text, &frame);

    text[length] = '\0';
    return text;
}

/* Decodes all bytes; all but the last complete nothing. */
static enum jp_slcan_item decoded(const char *line)
{
    const size_t length = strlen(line);

    for (size_t i = 0; i + 1 < length; i++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(JP_SLCAN_NONE, jp_slcan_decode(&decoder, (uint8_t)line[i]), line);
    }
    return jp_slcan_decode(&decoder, (uint8_t)line[length - 1]);
}

static void check_decodes_to(const char *line, struct jp_can_frame expected)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_SLCAN_FRAME, decoded(line), line);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(expected.id, decoder.frame.id, line);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(expected.length, decoder.frame.length, line);
    TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(expected.data, decoder.frame.data, JP_CAN_LENGTH_MAX, line);
}

static void check_both_ways(const char *line, struct jp_can_frame frame)
{
    TEST_ASSERT_EQUAL_STRING(line, encoded(frame));
    check_decodes_to(line, frame);
}

static void check_malformed(const char *line)
{
    const uint16_t before = decoder.malformed;

    TEST_ASSERT_EQUAL_INT_MESSAGE(JP_SLCAN_MALFORMED, decoded(line), line);
    TEST_ASSERT_EQUAL_UINT_MESSAGE(before + 1U, decoder.malformed, line);
}

/* ---- Frames ---- */

static void test_frames_of_each_kind(void)
{
    check_both_ways("t1002BEEF\r", frame_of(0x100, 2, "\xBE\xEF"));
    check_both_ways("T0000010021A2B\r", frame_of(EXTENDED | 0x100, 2, "\x1A\x2B"));
    check_both_ways("r1002\r", frame_of(REMOTE | 0x100, 2, ""));
    check_both_ways("R000001008\r", frame_of(EXTENDED | REMOTE | 0x100, 8, ""));
}

static void test_frames_at_the_ends_of_the_ranges(void)
{
    check_both_ways("t0000\r", frame_of(0, 0, ""));
    check_both_ways("t7FF81122334455667788\r", frame_of(0x7FF, 8, "\x11\x22\x33\x44\x55\x66\x77\x88"));
    check_both_ways("T000000000\r", frame_of(EXTENDED, 0, ""));
    check_both_ways("T1FFFFFFF8FFFFFFFFFFFFFFFF\r",
                    frame_of(EXTENDED | 0x1FFFFFFF, 8, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF"));
    check_both_ways("r7FF0\r", frame_of(REMOTE | 0x7FF, 0, ""));
    check_both_ways("R1FFFFFFF8\r", frame_of(EXTENDED | REMOTE | 0x1FFFFFFF, 8, ""));
}

static void test_the_longest_line_has_the_stated_length(void)
{
    const struct jp_can_frame frame = frame_of(EXTENDED | 0x1FFFFFFF, 8, "");

    TEST_ASSERT_EQUAL_UINT(JP_SLCAN_LINE_MAX, jp_slcan_encode(text, &frame));
}

static void test_data_beyond_the_length_is_not_sent(void)
{
    TEST_ASSERT_EQUAL_STRING("t1231AA\r", encoded(frame_of(0x123, 1, "\xAA\xBB\xCC")));
}

static void test_small_letters_are_hexadecimal_too(void)
{
    check_decodes_to("t7fa2beef\r", frame_of(0x7FA, 2, "\xBE\xEF"));
    check_decodes_to("T00abcdef0\r", frame_of(EXTENDED | 0xABCDEF, 0, ""));
}

static void test_frames_that_do_not_exist_are_not_encoded(void)
{
    TEST_ASSERT_EQUAL_STRING("", encoded(frame_of(0x800, 0, "")));
    TEST_ASSERT_EQUAL_STRING("", encoded(frame_of(REMOTE | 0x800, 0, "")));
    TEST_ASSERT_EQUAL_STRING("", encoded(frame_of(0x20000000, 0, "")));
    TEST_ASSERT_EQUAL_STRING("", encoded(frame_of(EXTENDED | 0x20000000, 0, "")));
    TEST_ASSERT_EQUAL_STRING("", encoded(frame_of(0x100, 9, "")));
    TEST_ASSERT_EQUAL_STRING("", encoded(frame_of(REMOTE | 0x100, 255, "")));
}

static void test_a_short_frame_leaves_no_data_of_the_one_before(void)
{
    check_decodes_to("t10081122334455667788\r", frame_of(0x100, 8, "\x11\x22\x33\x44\x55\x66\x77\x88"));
    check_decodes_to("t1001AA\r", frame_of(0x100, 1, "\xAA"));
    check_decodes_to("r1008\r", frame_of(REMOTE | 0x100, 8, ""));
}

/* ---- Commands and answers ---- */

static void test_commands_and_answers(void)
{
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_CLOSE, decoded("C\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_BIT_RATE, decoded("S8\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_OPEN, decoded("O\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_VERSION, decoded("V\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_SERIAL_NUMBER, decoded("N\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_DONE, decoded("\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_DONE, decoded("z\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_DONE, decoded("Z\r"));
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_REFUSED, decoded("\a"));
    TEST_ASSERT_EQUAL_UINT(0, decoder.malformed);
}

/* ---- Lines that are wrong ---- */

static void test_frames_that_are_too_short_or_too_long(void)
{
    static const char line[] = "T1234567F81122334455667788\r";
    char part[sizeof line];

    for (size_t length = 1; length < sizeof line - 2; length++) {
        memcpy(part, line, length);
        part[length] = '\r';
        part[length + 1] = '\0';
        check_malformed(part);
    }
    check_malformed("t1002BEE\r");
    check_malformed("t1002BEEF0\r");
    check_malformed("t1002BEEF00\r");
    check_malformed("t10\r");
    check_malformed("r10020\r");
    check_malformed("r1002BEEF\r");
    check_malformed("R12345678\r");
    TEST_ASSERT_EQUAL_UINT(0, decoder.overlong);
}

static void test_a_timestamp_is_no_data(void)
{
    check_malformed("t1002BEEF1A2B\r");
}

static void test_ids_and_lengths_out_of_range(void)
{
    check_malformed("t8000\r");
    check_malformed("tFFF0\r");
    check_malformed("r8000\r");
    check_malformed("T200000000\r");
    check_malformed("TFFFFFFFF0\r");
    check_malformed("R200000000\r");
    check_malformed("t1009112233445566778899\r");
    check_malformed("t100A11223344556677889900\r");
    check_malformed("r1009\r");
    check_malformed("R00000100F\r");
}

/* A wrong byte in each place of a line, of each value that is no digit. */
static void test_each_byte_must_be_a_digit(void)
{
    static const char line[] = "T1234567F2BEEF\r";
    char wrong[sizeof line];

    for (size_t place = 1; place < sizeof line - 2; place++) {
        for (unsigned value = 1; value < 256; value++) {
            const char c = (char)value;

            if (strchr("0123456789ABCDEFabcdef\r\a", c) == NULL) {
                memcpy(wrong, line, sizeof line);
                wrong[place] = c;
                check_malformed(wrong);
            }
        }
    }
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_FRAME, decoded(line));
}

static void test_a_zero_byte_is_wrong_as_well(void)
{
    static const char line[] = "t10\0"
                               "0\r";

    for (size_t i = 0; i < sizeof line - 2; i++) {
        TEST_ASSERT_EQUAL_INT(JP_SLCAN_NONE, jp_slcan_decode(&decoder, (uint8_t)line[i]));
    }
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_MALFORMED, jp_slcan_decode(&decoder, '\r'));
}

static void test_unknown_commands(void)
{
    static const char *const lines[] = {"S\r",  "S0\r",    "S6\r", "S9\r",    "S88\r",    "s031C\r", "L\r",
                                        "OO\r", "O \r",    "C1\r", "V1013\r", "NJP01\r",  "F\r",     "Z1\r",
                                        "zz\r", "x1000\r", "\n\r", "\nO\r",   " t1000\r", "?\r",     "d1000\r"};

    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        check_malformed(lines[i]);
    }
}

static void test_a_wrong_line_leaves_the_frame_before_it(void)
{
    const struct jp_can_frame frame = frame_of(0x100, 2, "\xBE\xEF");

    check_decodes_to("t1002BEEF\r", frame);
    check_malformed("t2004112233XX\r");
    TEST_ASSERT_EQUAL_HEX32(frame.id, decoder.frame.id);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(frame.data, decoder.frame.data, JP_CAN_LENGTH_MAX);
}

static void take_times(char c, unsigned times)
{
    for (unsigned i = 0; i < times; i++) {
        TEST_ASSERT_EQUAL_INT(JP_SLCAN_NONE, jp_slcan_decode(&decoder, (uint8_t)c));
    }
}

static void test_lines_that_never_end_are_dropped(void)
{
    take_times('t', JP_SLCAN_LINE_MAX - 1U);
    check_malformed("\r");
    TEST_ASSERT_EQUAL_UINT(0, decoder.overlong);
    take_times('t', JP_SLCAN_LINE_MAX);
    check_malformed("\r");
    TEST_ASSERT_EQUAL_UINT(1, decoder.overlong);
    take_times('0', 100000);
    check_malformed("\r");
    TEST_ASSERT_EQUAL_UINT(2, decoder.overlong);
    check_decodes_to("t1002BEEF\r", frame_of(0x100, 2, "\xBE\xEF"));
    TEST_ASSERT_EQUAL_UINT(3, decoder.malformed);
}

static void test_an_overlong_line_with_a_frame_at_its_end_is_dropped_whole(void)
{
    take_times('A', 300);
    check_malformed("t1002BEEF\r");
    check_decodes_to("t1002BEEF\r", frame_of(0x100, 2, "\xBE\xEF"));
}

static void test_a_refusal_ends_a_line(void)
{
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_REFUSED, decoded("t1002B\a"));
    TEST_ASSERT_EQUAL_UINT(1, decoder.malformed);
    check_decodes_to("t1002BEEF\r", frame_of(0x100, 2, "\xBE\xEF"));
    take_times('A', 30);
    TEST_ASSERT_EQUAL_INT(JP_SLCAN_REFUSED, jp_slcan_decode(&decoder, '\a'));
    TEST_ASSERT_EQUAL_UINT(1, decoder.overlong);
    TEST_ASSERT_EQUAL_UINT(2, decoder.malformed);
}

static void test_the_counters_stop_at_their_maximum(void)
{
    for (uint32_t i = 0; i < 65534; i++) {
        (void)decoded("?\r");
    }
    TEST_ASSERT_EQUAL_UINT(65534, decoder.malformed);
    decoder.overlong = UINT16_MAX;
    for (unsigned i = 0; i < 3; i++) {
        take_times('A', 30);
        (void)decoded("\r");
    }
    TEST_ASSERT_EQUAL_UINT(UINT16_MAX, decoder.malformed);
    TEST_ASSERT_EQUAL_UINT(UINT16_MAX, decoder.overlong);
}

/* ---- The adapter ---- */

/* Feeds a text; returns the answers, and the number of frames for the bus. */
static const char *answers(const char *line, unsigned *frames)
{
    static char all[64];
    const char *answer;

    all[0] = '\0';
    *frames = 0;
    for (; *line != '\0'; line++) {
        *frames += jp_slcan_adapter_take(&adapter, (uint8_t)*line, &answer) ? 1U : 0U;
        TEST_ASSERT_TRUE(strlen(answer) <= JP_SLCAN_ANSWER_MAX);
        memcpy(all + strlen(all), answer, strlen(answer) + 1);
    }
    return all;
}

static void test_an_adapter_opens_and_closes(void)
{
    unsigned frames;

    TEST_ASSERT_EQUAL_STRING("\r\r\r", answers("C\rS8\rO\r", &frames));
    TEST_ASSERT_TRUE(adapter.open);
    TEST_ASSERT_EQUAL_STRING("\r\r", answers("S8\rO\r", &frames));
    TEST_ASSERT_TRUE(adapter.open);
    TEST_ASSERT_EQUAL_STRING("\r", answers("C\r", &frames));
    TEST_ASSERT_FALSE(adapter.open);
}

static void test_an_adapter_takes_frames_only_while_open(void)
{
    unsigned frames;

    TEST_ASSERT_EQUAL_STRING("\a", answers("t1002BEEF\r", &frames));
    TEST_ASSERT_EQUAL_UINT(0, frames);
    TEST_ASSERT_EQUAL_STRING("\rz\rZ\rz\rZ\r", answers("O\rt1002BEEF\rT000001000\rr1000\rR000001000\r", &frames));
    TEST_ASSERT_EQUAL_UINT(4, frames);
    TEST_ASSERT_EQUAL_HEX32(EXTENDED | REMOTE | 0x100, adapter.decoder.frame.id);
    TEST_ASSERT_EQUAL_STRING("\r\a", answers("C\rt1002BEEF\r", &frames));
    TEST_ASSERT_EQUAL_UINT(0, frames);
}

static void test_an_adapter_tells_who_it_is(void)
{
    unsigned frames;
    const char *answer = answers("V\r", &frames);

    TEST_ASSERT_EQUAL_UINT(6, strlen(answer));
    TEST_ASSERT_TRUE(answer[0] == 'V' && answer[5] == '\r');
    for (unsigned i = 1; i < 5; i++) {
        TEST_ASSERT_TRUE(answer[i] >= '0' && answer[i] <= '9');
    }
    TEST_ASSERT_EQUAL_STRING("NJP01\r", answers("N\r", &frames));
}

static void test_an_adapter_refuses_what_is_wrong_and_is_silent_on_answers(void)
{
    unsigned frames;

    TEST_ASSERT_EQUAL_STRING("\a\a\a", answers("S6\rs031C\rwhat\r", &frames));
    TEST_ASSERT_EQUAL_STRING("", answers("\r\r\rz\rZ\r\a", &frames));
    TEST_ASSERT_EQUAL_UINT(0, frames);
    TEST_ASSERT_FALSE(adapter.open);
    TEST_ASSERT_EQUAL_UINT(3, adapter.decoder.malformed);
}
