/* Maps as streams: golden bytes, each way in which a row is told, every way of being no map, rooms that are too small.
 */
#include <string.h>

#include "hal/can/map_code.h"

#include "unity.h"

enum { WIDTH_MAX = 70, HEIGHT_MAX = 140, STREAM_MAX = 3000 };

#define CELL JP_Q16(0.1)

/* Three words a row in each of two planes. */
static uint64_t blocks[2][3 * HEIGHT_MAX];
static struct jp_terrain map;
static struct jp_map_decoder decoder;
static struct jp_place origin;
static uint8_t stream[STREAM_MAX];
static size_t length;

static const struct jp_map_room room = {blocks[1], sizeof blocks[1], CELL};

void setUp(void)
{
    origin = (struct jp_place){{JP_Q16(1), JP_Q16(-2)}, JP_ANGLE_DEGREES(90)};
    length = 0;
    memset(stream, 0, sizeof stream);
    jp_map_decoder_start(&decoder, &room);
}

void tearDown(void)
{
}

static void make(uint16_t width, uint16_t height, bool unknown_is_free)
{
    const struct jp_terrain_config config = {
        .width = width, .height = height, .resolution = CELL, .unknown_is_free = unknown_is_free};
    const char *field;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_init(&map, &config, blocks[0], sizeof blocks[0], &field));
}

static void put(int32_t x, int32_t y, enum jp_cell cell)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_terrain_set_cell(&map, x, y, cell));
}

static void encode(void)
{
    length = jp_map_encode(&map, &origin, stream, sizeof stream);
    TEST_ASSERT_GREATER_THAN_UINT(JP_MAP_HEAD, length);
    TEST_ASSERT_LESS_OR_EQUAL_UINT(jp_map_code_size(&map.config), length);
}

/** Makes the rows that it asks for; returns how many. */
static unsigned make_rows(void)
{
    unsigned rows = 0;

    while (!jp_map_decoder_is_ready(&decoder)) {
        jp_map_decoder_work(&decoder);
        rows++;
    }
    return rows;
}

static enum jp_map_state decode(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        (void)make_rows();
        (void)jp_map_decoder_take(&decoder, bytes[i]);
    }
    (void)make_rows();
    return decoder.state;
}

static void expect_map(void)
{
    TEST_ASSERT_EQUAL_INT(JP_MAP_WHOLE, decoder.state);
    TEST_ASSERT_EQUAL_UINT16(map.config.width, decoder.terrain.config.width);
    TEST_ASSERT_EQUAL_UINT16(map.config.height, decoder.terrain.config.height);
    TEST_ASSERT_EQUAL(map.config.unknown_is_free, decoder.terrain.config.unknown_is_free);
    TEST_ASSERT_EQUAL_INT32(origin.point.x, decoder.origin.point.x);
    TEST_ASSERT_EQUAL_INT32(origin.point.y, decoder.origin.point.y);
    TEST_ASSERT_EQUAL_UINT32(origin.heading, decoder.origin.heading);
    TEST_ASSERT_EQUAL_MEMORY(blocks[0], blocks[1], jp_terrain_size(&map.config));
}

static void expect_same(void)
{
    encode();
    (void)decode(stream, length);
    expect_map();
}

/* Of a map of 5 × 4 cells: rows as before, as cells, as runs, as before. */
static const uint8_t golden[] = {5,    0,    4,    0,                      /* sides */
                                 0x9A, 0x19, 0,    0,                      /* 0.1 m */
                                 0,    0,    1,    0,    0, 0, 0xFE, 0xFF, /* origin */
                                 0,    0,    0,    0x40, 1,                /* 90°, unknown is free */
                                 0,                                        /* a row of unknown cells */
                                 129,  0x00, 0x40, 0x02,                   /* free, occupied, three free */
                                 0,                                        /* the same */
                                 129,  0x84};                              /* five unknown */

static void make_golden(void)
{
    make(5, 4, true);
    for (int32_t y = 1; y < 3; y++) {
        for (int32_t x = 0; x < 5; x++) {
            put(x, y, x == 1 ? JP_CELL_OCCUPIED : JP_CELL_FREE);
        }
    }
}

static void test_golden_stream(void)
{
    uint8_t expected[sizeof golden];

    /* Two bytes of cells are shorter than three runs: the row is told by cells. */
    memcpy(expected, golden, sizeof golden);
    expected[22] = 128;
    expected[23] = 0x04;
    expected[24] = 0x00;
    memmove(&expected[25], &golden[26], 3);
    make_golden();
    encode();
    TEST_ASSERT_EQUAL_UINT(sizeof golden - 1, length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, stream, length);
    (void)decode(stream, length);
    expect_map();
}

static void test_golden_stream_of_runs(void)
{
    make_golden();
    (void)decode(golden, sizeof golden);
    expect_map();
}

static void test_one_cell(void)
{
    make(1, 1, false);
    encode();
    TEST_ASSERT_EQUAL_UINT(JP_MAP_HEAD + 1, length);
    (void)decode(stream, length);
    expect_map();
    put(0, 0, JP_CELL_FREE);
    jp_map_decoder_start(&decoder, &room);
    expect_same();
}

static void test_runs_longer_than_a_byte(void)
{
    make(WIDTH_MAX, 3, false);
    for (int32_t x = 0; x < WIDTH_MAX; x++) {
        put(x, 0, JP_CELL_OCCUPIED);
        put(x, 2, x < 64 ? JP_CELL_FREE : JP_CELL_UNKNOWN);
    }
    expect_same();
    TEST_ASSERT_LESS_THAN_UINT(JP_MAP_HEAD + 12, length);
}

static void test_cells_where_runs_are_longer(void)
{
    make(WIDTH_MAX, 2, false);
    for (int32_t x = 0; x < WIDTH_MAX; x++) {
        put(x, 1, (enum jp_cell)(x % 3));
    }
    expect_same();
    TEST_ASSERT_EQUAL_UINT(JP_MAP_HEAD + 1 + 1 + (WIDTH_MAX + 3) / 4, length);
}

static void test_more_equal_rows_than_a_byte_repeats(void)
{
    make(9, HEIGHT_MAX, false);
    for (int32_t y = 0; y < HEIGHT_MAX; y++) {
        put(4, y, JP_CELL_FREE);
    }
    expect_same();
    TEST_ASSERT_EQUAL_UINT(JP_MAP_HEAD + 4 + 2, length);
}

static void test_makes_a_row_a_call(void)
{
    make(3, 100, false);
    encode();
    TEST_ASSERT_EQUAL_UINT(JP_MAP_HEAD + 1, length);
    for (size_t i = 0; i < length; i++) {
        TEST_ASSERT_EQUAL_UINT(0, make_rows());
        (void)jp_map_decoder_take(&decoder, stream[i]);
    }
    TEST_ASSERT_EQUAL_UINT(100, make_rows());
    expect_map();
    jp_map_decoder_work(&decoder);
    expect_map();
}

static void test_says_how_long_a_stream_can_be(void)
{
    const struct jp_terrain_config none = {.width = 0, .height = 1, .resolution = CELL};

    TEST_ASSERT_EQUAL_UINT(0, jp_map_code_size(&none));
    make(5, 4, false);
    TEST_ASSERT_EQUAL_UINT(JP_MAP_HEAD + 4 * 3, jp_map_code_size(&map.config));
}

static void test_a_stream_that_does_not_fit_is_not_written(void)
{
    make_golden();
    encode();
    for (size_t size = 0; size < length; size++) {
        memset(stream, 0xAA, sizeof stream);
        TEST_ASSERT_EQUAL_UINT(0, jp_map_encode(&map, &origin, stream, size));
        TEST_ASSERT_EQUAL_HEX8(0xAA, stream[size]);
    }
    TEST_ASSERT_EQUAL_UINT(length, jp_map_encode(&map, &origin, stream, length));
}

static void test_is_not_whole_before_its_last_byte(void)
{
    make_golden();
    encode();
    TEST_ASSERT_EQUAL_INT(JP_MAP_DECODING, decode(stream, length - 1));
    TEST_ASSERT_EQUAL_INT(JP_MAP_WHOLE, decode(&stream[length - 1], 1));
}

static void test_nothing_may_follow_the_map(void)
{
    make_golden();
    encode();
    TEST_ASSERT_EQUAL_INT(JP_MAP_WHOLE, decode(stream, length));
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode(stream, 1));
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode(stream, 1));
}

/** The golden stream with one byte that is another. */
static enum jp_map_state decode_changed(size_t place, uint8_t byte)
{
    uint8_t changed[sizeof golden];

    memcpy(changed, golden, sizeof golden);
    changed[place] = byte;
    jp_map_decoder_start(&decoder, &room);
    return decode(changed, sizeof changed);
}

static void test_what_is_no_map(void)
{
    TEST_ASSERT_EQUAL_INT(JP_MAP_WHOLE, decode_changed(0, 5));
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(0, 0));     /* no columns */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(2, 0));     /* no rows */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(1, 0x20));  /* too wide for any map */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(7, 0x80));  /* cells of a negative side */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(20, 2));    /* neither free nor not */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(21, 4));    /* more rows than there are */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(22, 130));  /* no kind of row */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(22, 255));  /* no kind of row */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(25, 0x03)); /* a run beyond the row */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(23, 0xC0)); /* no state of a cell */
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode_changed(26, 2));    /* more rows than are left */
    TEST_ASSERT_EQUAL_INT(JP_MAP_OTHER_CELLS, decode_changed(4, 0x9B));
    TEST_ASSERT_EQUAL_INT(JP_MAP_TOO_LARGE, decode_changed(3, 0x0F));
}

static void test_a_cell_of_no_state_among_cells(void)
{
    static const uint8_t row[] = {128, 0xC0};

    (void)decode(golden, 21);
    TEST_ASSERT_EQUAL_INT(JP_MAP_MALFORMED, decode(row, sizeof row));
}

static void test_bits_beyond_the_row_are_of_no_account(void)
{
    static const uint8_t row[] = {128, 0x00, 0xFC};

    (void)decode(golden, 21);
    TEST_ASSERT_EQUAL_INT(JP_MAP_DECODING, decode(row, sizeof row));
    TEST_ASSERT_EQUAL_INT(JP_CELL_FREE, jp_terrain_cell(&decoder.terrain, 4, 0));
    TEST_ASSERT_EQUAL_INT(JP_CELL_UNKNOWN, jp_terrain_cell(&decoder.terrain, 0, 1));
}

static void test_a_room_of_just_the_size(void)
{
    make(WIDTH_MAX, 30, false);
    put(3, 3, JP_CELL_FREE);
    encode();
    for (int missing = 1; missing >= 0; missing--) {
        const struct jp_map_room small = {blocks[1], jp_terrain_size(&map.config) - (size_t)missing, CELL};

        jp_map_decoder_start(&decoder, &small);
        TEST_ASSERT_EQUAL_INT(missing == 0 ? JP_MAP_WHOLE : JP_MAP_TOO_LARGE, decode(stream, length));
    }
}
