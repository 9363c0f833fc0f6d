#include "hal/can/map_code.h"

/** Bytes that begin a row: smaller ones are rows as the one before. */
#define ROW_OF_CELLS 128U
#define ROW_OF_RUNS  129U

#define ROWS_MAX ROW_OF_CELLS /**< that a byte repeats */
#define RUN_MAX  64U          /**< cells */

#define CELLS_A_BYTE 4U
#define CELL_BITS    2U
#define CELL_MASK    3U

#define UNKNOWN_IS_FREE 1U

/* The decoder. */

void jp_map_decoder_start(struct jp_map_decoder *decoder, const struct jp_map_room *room)
{
    *decoder = (struct jp_map_decoder){.room = *room, .state = JP_MAP_DECODING};
}

bool jp_map_decoder_is_ready(const struct jp_map_decoder *decoder)
{
    return decoder->copies == 0U;
}

static uint32_t word_at(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] | ((uint32_t)bytes[1] << 8) | ((uint32_t)bytes[2] << 16) | ((uint32_t)bytes[3] << 24);
}

static enum jp_map_state begin_map(struct jp_map_decoder *decoder)
{
    const uint8_t *head = decoder->head;
    const uint32_t sides = word_at(head);
    const struct jp_terrain_config config = {.width = (uint16_t)sides,
                                             .height = (uint16_t)(sides >> 16),
                                             .resolution = (jp_q16)word_at(&head[4]),
                                             .unknown_is_free = head[20] == UNKNOWN_IS_FREE};
    const char *field;

    decoder->origin = (struct jp_place){.point = {(jp_q16)word_at(&head[8]), (jp_q16)word_at(&head[12])},
                                        .heading = word_at(&head[16])};
    if (head[20] > UNKNOWN_IS_FREE || jp_terrain_size(&config) == 0U) {
        return JP_MAP_MALFORMED;
    }
    if (config.resolution != decoder->room.resolution) {
        return JP_MAP_OTHER_CELLS;
    }
    return jp_terrain_init(&decoder->terrain, &config, decoder->room.block, decoder->room.size, &field) == JP_OK
               ? JP_MAP_DECODING
               : JP_MAP_TOO_LARGE;
}

static enum jp_map_state take_head(struct jp_map_decoder *decoder, uint8_t byte)
{
    decoder->head[decoder->head_count] = byte;
    decoder->head_count++;
    return decoder->head_count == JP_MAP_HEAD ? begin_map(decoder) : JP_MAP_DECODING;
}

static void end_row(struct jp_map_decoder *decoder)
{
    decoder->mode = 0;
    decoder->x = 0;
    decoder->y++;
    if (decoder->y == decoder->terrain.config.height) {
        decoder->state = JP_MAP_WHOLE;
    }
}

/** The rows of an empty map are all alike: what is before the first is as it is. */
static void copy_row(struct jp_map_decoder *decoder)
{
    const uint16_t width = decoder->terrain.config.width;

    if (decoder->y > 0U) {
        for (uint16_t x = 0; x < width; x++) {
            const enum jp_cell cell = jp_terrain_cell(&decoder->terrain, x, decoder->y - 1);
            (void)jp_terrain_set_cell(&decoder->terrain, x, decoder->y, cell);
        }
    }
    end_row(decoder);
}

void jp_map_decoder_work(struct jp_map_decoder *decoder)
{
    if (decoder->copies > 0U) {
        decoder->copies--;
        copy_row(decoder);
    }
}

static enum jp_map_state begin_row(struct jp_map_decoder *decoder, uint8_t byte)
{
    if (byte < ROWS_MAX) {
        const unsigned left = (unsigned)decoder->terrain.config.height - decoder->y;

        if (byte + 1U > left) {
            return JP_MAP_MALFORMED;
        }
        decoder->copies = (uint8_t)(byte + 1U);
        return JP_MAP_DECODING;
    }
    decoder->mode = byte;
    return byte > ROW_OF_RUNS ? JP_MAP_MALFORMED : JP_MAP_DECODING;
}

/** False: it is not on the map, or no state of a cell. */
static bool put_cell(struct jp_map_decoder *decoder, unsigned cell)
{
    const enum jp_status status = jp_terrain_set_cell(&decoder->terrain, decoder->x, decoder->y, (enum jp_cell)cell);

    decoder->x++;
    return status == JP_OK;
}

static enum jp_map_state take_cells(struct jp_map_decoder *decoder, uint8_t byte)
{
    const uint16_t width = decoder->terrain.config.width;

    for (unsigned i = 0; i < CELLS_A_BYTE && decoder->x < width; i++) {
        if (!put_cell(decoder, ((unsigned)byte >> (CELL_BITS * i)) & CELL_MASK)) {
            return JP_MAP_MALFORMED;
        }
    }
    return JP_MAP_DECODING;
}

static enum jp_map_state take_run(struct jp_map_decoder *decoder, uint8_t byte)
{
    for (unsigned i = 0; i <= byte % RUN_MAX; i++) {
        if (!put_cell(decoder, byte / RUN_MAX)) {
            return JP_MAP_MALFORMED;
        }
    }
    return JP_MAP_DECODING;
}

static enum jp_map_state take_row(struct jp_map_decoder *decoder, uint8_t byte)
{
    return decoder->mode == ROW_OF_CELLS ? take_cells(decoder, byte) : take_run(decoder, byte);
}

enum jp_map_state jp_map_decoder_take(struct jp_map_decoder *decoder, uint8_t byte)
{
    if (decoder->state == JP_MAP_WHOLE) {
        decoder->state = JP_MAP_MALFORMED;
    } else if (decoder->state != JP_MAP_DECODING) {
        /* What comes after an error says nothing. */
    } else if (decoder->head_count < JP_MAP_HEAD) {
        decoder->state = take_head(decoder, byte);
    } else if (decoder->mode == 0U) {
        decoder->state = begin_row(decoder, byte);
    } else {
        decoder->state = take_row(decoder, byte);
        if (decoder->state == JP_MAP_DECODING && decoder->x == decoder->terrain.config.width) {
            end_row(decoder);
        }
    }
    return decoder->state;
}

/* The encoder. */

/** What is written, and where. */
struct writer {
    uint8_t *bytes;
    size_t size;
    size_t length; /**< that is needed, also beyond the size */
};

static void put(struct writer *writer, unsigned byte)
{
    if (writer->length < writer->size) {
        writer->bytes[writer->length] = (uint8_t)byte;
    }
    writer->length++;
}

static void put_word(struct writer *writer, uint32_t word)
{
    for (unsigned i = 0; i < sizeof word; i++) {
        put(writer, (word >> (8U * i)) & 0xFFU);
    }
}

static void put_head(struct writer *writer, const struct jp_terrain_config *config, const struct jp_place *origin)
{
    put_word(writer, (uint32_t)config->width | ((uint32_t)config->height << 16));
    put_word(writer, (uint32_t)config->resolution);
    put_word(writer, (uint32_t)origin->point.x);
    put_word(writer, (uint32_t)origin->point.y);
    put_word(writer, origin->heading);
    put(writer, config->unknown_is_free ? UNKNOWN_IS_FREE : 0U);
}

/** Before the first row all is unknown. */
static enum jp_cell cell_before(const struct jp_terrain *terrain, uint16_t x, uint16_t y)
{
    return y == 0U ? JP_CELL_UNKNOWN : jp_terrain_cell(terrain, x, y - 1);
}

static bool is_as_before(const struct jp_terrain *terrain, uint16_t y)
{
    for (uint16_t x = 0; x < terrain->config.width; x++) {
        if (jp_terrain_cell(terrain, x, y) != cell_before(terrain, x, y)) {
            return false;
        }
    }
    return true;
}

/** Of equal cells from one on. */
static unsigned run_length(const struct jp_terrain *terrain, uint16_t x, uint16_t y)
{
    const enum jp_cell cell = jp_terrain_cell(terrain, x, y);
    unsigned length = 1;

    while (length < RUN_MAX && x + length < terrain->config.width &&
           jp_terrain_cell(terrain, (int32_t)(x + length), y) == cell) {
        length++;
    }
    return length;
}

static void put_runs(struct writer *writer, const struct jp_terrain *terrain, uint16_t y)
{
    uint16_t x = 0;

    put(writer, ROW_OF_RUNS);
    while (x < terrain->config.width) {
        const unsigned length = run_length(terrain, x, y);

        put(writer, (unsigned)jp_terrain_cell(terrain, x, y) * RUN_MAX + length - 1U);
        x = (uint16_t)(x + length);
    }
}

static void put_cells(struct writer *writer, const struct jp_terrain *terrain, uint16_t y)
{
    put(writer, ROW_OF_CELLS);
    for (uint16_t x = 0; x < terrain->config.width; x = (uint16_t)(x + CELLS_A_BYTE)) {
        unsigned byte = 0;

        for (unsigned i = 0; i < CELLS_A_BYTE && x + i < terrain->config.width; i++) {
            byte |= (unsigned)jp_terrain_cell(terrain, (int32_t)(x + i), y) << (CELL_BITS * i);
        }
        put(writer, byte);
    }
}

static size_t bytes_of_cells(uint16_t width)
{
    return ((size_t)width + CELLS_A_BYTE - 1U) / CELLS_A_BYTE;
}

/** As runs or as cells, whichever is shorter. */
static void put_row(struct writer *writer, const struct jp_terrain *terrain, uint16_t y)
{
    const size_t begin = writer->length;

    put_runs(writer, terrain, y);
    if (writer->length - begin > 1U + bytes_of_cells(terrain->config.width)) {
        writer->length = begin;
        put_cells(writer, terrain, y);
    }
}

static uint16_t rows_as_before(const struct jp_terrain *terrain, uint16_t y)
{
    uint16_t rows = 0;

    while (rows < ROWS_MAX && y + rows < terrain->config.height && is_as_before(terrain, (uint16_t)(y + rows))) {
        rows++;
    }
    return rows;
}

size_t jp_map_code_size(const struct jp_terrain_config *config)
{
    return jp_terrain_size(config) == 0U ? 0U : JP_MAP_HEAD + config->height * (1U + bytes_of_cells(config->width));
}

size_t jp_map_encode(const struct jp_terrain *terrain, const struct jp_place *origin, uint8_t *bytes, size_t size)
{
    struct writer writer = {.bytes = bytes, .size = size};
    uint16_t y = 0;

    put_head(&writer, &terrain->config, origin);
    while (y < terrain->config.height) {
        const uint16_t rows = rows_as_before(terrain, y);

        if (rows > 0U) {
            put(&writer, rows - 1U);
            y = (uint16_t)(y + rows);
        } else {
            put_row(&writer, terrain, y);
            y++;
        }
    }
    return writer.length <= size ? writer.length : 0U;
}
