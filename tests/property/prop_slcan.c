/*
 * SLCAN against an oracle of its own: random frames come back as they went; of random bytes, and of sound lines with
 * random bytes changed, exactly those lines become frames that sscanf() and a comparison of the text call frames.
 *
 * prop_slcan [--count N] [--seed S]
 * --count is the number of random frames, and of random lines of each kind.
 */
#include "hal/can/slcan.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/options.h"
#include "tests/support/random.h"
#include "unity.h"

#define LINE_ROOM 64

static struct options options = {.count = 200000, .seed = 1};
static struct jp_slcan_decoder decoder;

void setUp(void)
{
    begin_random(options.seed, 0);
    decoder = (struct jp_slcan_decoder){.length = 0};
}

void tearDown(void)
{
}

static struct jp_can_frame random_frame(void)
{
    const uint32_t flags = below(4) << 30;
    const uint32_t id = below((flags & JP_CAN_EXTENDED) != 0U ? 0x20000000U : 0x800U);
    struct jp_can_frame frame = {.id = id | flags, .length = (uint8_t)below(9)};

    for (unsigned i = 0; i < frame.length && (flags & JP_CAN_REMOTE) == 0U; i++) {
        frame.data[i] = (uint8_t)below(256);
    }
    return frame;
}

/* The line as printf() makes it. */
static size_t print_frame(char *line, const struct jp_can_frame *frame)
{
    const bool extended = (frame->id & JP_CAN_EXTENDED) != 0U;
    const bool remote = (frame->id & JP_CAN_REMOTE) != 0U;
    int length = sprintf(line, "%c%0*" PRIX32 "%u", "tTrR"[(extended ? 1 : 0) + (remote ? 2 : 0)], extended ? 8 : 3,
                         frame->id & 0x1FFFFFFFU, frame->length);

    for (unsigned i = 0; i < frame->length && !remote; i++) {
        length += sprintf(line + length, "%02X", frame->data[i]);
    }
    return (size_t)length;
}

static bool same(const struct jp_can_frame *a, const struct jp_can_frame *b)
{
    return a->id == b->id && a->length == b->length && memcmp(a->data, b->data, JP_CAN_LENGTH_MAX) == 0;
}

/* Whether a line of `length` bytes, without its CR, is a frame: what sscanf() reads from it prints as the line again.
 */
static bool is_frame(const char *bytes, size_t length, struct jp_can_frame *frame)
{
    char line[LINE_ROOM] = "";
    char again[LINE_ROOM];
    unsigned id;
    unsigned size;
    int read = 0;

    if (length == 0 || length >= JP_SLCAN_LINE_MAX || memchr(bytes, '\0', length) != NULL) {
        return false;
    }
    line[0] = bytes[0];
    for (size_t i = 1; i < length; i++) {
        line[i] = (char)toupper((unsigned char)bytes[i]);
    }
    *frame = (struct jp_can_frame){.id = 0};
    if (strchr("tr", line[0]) != NULL && sscanf(line + 1, "%3x%1u%n", &id, &size, &read) == 2) {
        frame->id = id;
    } else if (strchr("TR", line[0]) != NULL && sscanf(line + 1, "%8x%1u%n", &id, &size, &read) == 2) {
        frame->id = id | JP_CAN_EXTENDED;
    } else {
        return false;
    }
    if (size > 8 || id > ((frame->id & JP_CAN_EXTENDED) != 0U ? 0x1FFFFFFFU : 0x7FFU)) {
        return false;
    }
    frame->length = (uint8_t)size;
    frame->id |= strchr("rR", line[0]) != NULL ? JP_CAN_REMOTE : 0U;
    for (unsigned i = 0; i < size && (frame->id & JP_CAN_REMOTE) == 0U; i++) {
        unsigned byte = 0;

        if (strlen(line) < (size_t)read + 3U + 2U * i || sscanf(line + 1 + read + 2U * i, "%2x", &byte) != 1) {
            return false;
        }
        frame->data[i] = (uint8_t)byte;
    }
    return print_frame(again, frame) == length && memcmp(line, again, length) == 0;
}

/* ---- Frames there and back ---- */

static void test_frames_come_back_as_they_went(void)
{
    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_can_frame frame = random_frame();
        char line[JP_SLCAN_LINE_MAX];
        char expected[LINE_ROOM];
        const size_t expected_length = print_frame(expected, &frame);
        const unsigned length = jp_slcan_encode(line, &frame);

        TEST_ASSERT_EQUAL_UINT(expected_length + 1, length);
        TEST_ASSERT_TRUE(memcmp(line, expected, expected_length) == 0);
        for (unsigned k = 0; k + 1 < length; k++) {
            TEST_ASSERT_EQUAL_INT(JP_SLCAN_NONE, jp_slcan_decode(&decoder, (uint8_t)line[k]));
        }
        TEST_ASSERT_EQUAL_INT(JP_SLCAN_FRAME, jp_slcan_decode(&decoder, (uint8_t)line[length - 1]));
        TEST_ASSERT_TRUE(same(&frame, &decoder.frame));
    }
    TEST_ASSERT_EQUAL_UINT(0, decoder.malformed);
}

static void test_any_struct_is_encoded_as_a_frame_or_not_at_all(void)
{
    unsigned long refused = 0;

    for (unsigned long i = 0; i < options.count; i++) {
        struct jp_can_frame frame = {.id = below(UINT32_MAX), .length = (uint8_t)below(12)};
        char line[JP_SLCAN_LINE_MAX];
        struct jp_can_frame read;
        const unsigned length = jp_slcan_encode(line, &frame);

        TEST_ASSERT_TRUE(length <= JP_SLCAN_LINE_MAX);
        TEST_ASSERT_TRUE(length == 0 || is_frame(line, length - 1U, &read));
        TEST_ASSERT_TRUE(length == 0 || same(&frame, &read));
        refused += length == 0 ? 1U : 0U;
    }
    TEST_ASSERT_TRUE(refused > options.count / 4 && refused < options.count);
}

/* ---- Bytes ---- */

struct tally {
    unsigned long lines;
    unsigned long frames;
};

/* Feeds a line without CR and BEL, then CR: a frame if and only if the oracle says so. */
static void check_line(const char *bytes, size_t length, struct tally *tally)
{
    struct jp_can_frame expected;
    const bool expect_frame = is_frame(bytes, length, &expected);
    enum jp_slcan_item item;

    for (size_t i = 0; i < length; i++) {
        TEST_ASSERT_EQUAL_INT(JP_SLCAN_NONE, jp_slcan_decode(&decoder, (uint8_t)bytes[i]));
    }
    item = jp_slcan_decode(&decoder, '\r');
    TEST_ASSERT_TRUE(expect_frame == (item == JP_SLCAN_FRAME));
    TEST_ASSERT_TRUE(!expect_frame || same(&expected, &decoder.frame));
    tally->lines++;
    tally->frames += expect_frame ? 1U : 0U;
}

static char random_byte(void)
{
    char byte;

    do {
        byte = (char)below(256);
    } while (byte == '\r' || byte == '\a');
    return byte;
}

/* Bytes that look like a frame more often than chance would have it. */
static char likely_byte(void)
{
    static const char likely[] = "0123456789ABCDEFabcdef0011223388tTrROCSVNzZ \n\xFF";

    return below(50) == 0 ? random_byte() : likely[below(sizeof likely - 1)];
}

static void print_tally(const char *name, const struct tally *tally)
{
    printf("%s: %lu of %lu lines are frames\n", name, tally->frames, tally->lines);
}

static void test_garbage(void)
{
    struct tally tally = {0, 0};

    for (unsigned long i = 0; i < options.count; i++) {
        char line[LINE_ROOM];
        const size_t length = below(LINE_ROOM);

        for (size_t k = 0; k < length; k++) {
            line[k] = random_byte();
        }
        check_line(line, length, &tally);
    }
    print_tally("garbage", &tally);
}

static void test_text_that_looks_like_frames(void)
{
    struct tally tally = {0, 0};

    for (unsigned long i = 0; i < options.count; i++) {
        char line[LINE_ROOM];
        const size_t length = 1 + below(JP_SLCAN_LINE_MAX);

        line[0] = "tTrR"[below(4)];
        for (size_t k = 1; k < length; k++) {
            line[k] = likely_byte();
        }
        check_line(line, length, &tally);
    }
    print_tally("likely text", &tally);
    TEST_ASSERT_TRUE(tally.frames > 0);
}

/* A byte changed, removed or put in. */
static size_t damage(char *line, size_t length)
{
    const size_t place = below((uint32_t)length);

    switch (below(3)) {
    case 0:
        line[place] = likely_byte();
        return length;
    case 1:
        memmove(&line[place], &line[place + 1], length - place - 1);
        return length - 1;
    default:
        memmove(&line[place + 1], &line[place], length - place);
        line[place] = likely_byte();
        return length + 1;
    }
}

static void test_damaged_frames(void)
{
    struct tally tally = {0, 0};

    for (unsigned long i = 0; i < options.count; i++) {
        const struct jp_can_frame frame = random_frame();
        char line[LINE_ROOM];
        size_t length = print_frame(line, &frame);

        for (uint32_t left = 1 + below(3); left > 0; left--) {
            length = damage(line, length);
        }
        check_line(line, length, &tally);
    }
    print_tally("damaged frames", &tally);
    TEST_ASSERT_TRUE(tally.frames > options.count / 20 && tally.frames < options.count / 2);
}

/* Whatever came, with any CR and BEL in it: the next line is read afresh. */
static void test_the_next_line_is_read_whatever_came_before(void)
{
    for (unsigned long i = 0; i < options.count / 10; i++) {
        const struct jp_can_frame frame = random_frame();
        struct tally tally = {0, 0};
        char line[LINE_ROOM];

        for (uint32_t left = below(100); left > 0; left--) {
            (void)jp_slcan_decode(&decoder, (uint8_t)below(256));
        }
        (void)jp_slcan_decode(&decoder, '\r');
        check_line(line, print_frame(line, &frame), &tally);
        TEST_ASSERT_EQUAL_UINT(1, tally.frames);
    }
}

int main(int argc, char **argv)
{
    options = parse_options(argc, argv, options);
    return RUN_PROPERTY(options, NULL);
}
