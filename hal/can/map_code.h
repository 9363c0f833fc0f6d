/**
 * A map as a stream of bytes, as MapData in joulepath.dbc tells it: rows that are as the one before, runs of cells, or
 * cells. The decoder writes the cells as they come, and holds nothing of the map beside it.
 */
#ifndef JOULEPATH_HAL_CAN_MAP_CODE_H
#define JOULEPATH_HAL_CAN_MAP_CODE_H

#include <joulepath/navigator.h>
#include <joulepath/terrain.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_MAP_HEAD 21U

/** Where a map goes. */
struct jp_map_room {
    void *block; /**< aligned to 8 bytes */
    size_t size;
    jp_q16 resolution; /**< that its cells must have, m */
};

enum jp_map_state {
    JP_MAP_DECODING,
    JP_MAP_WHOLE,     /**< every row is there; more bytes are a wrong format */
    JP_MAP_MALFORMED, /**< the stream is no map */
    JP_MAP_TOO_LARGE, /**< it does not fit the room */
    JP_MAP_OTHER_CELLS
};

/** The members but `terrain` and `origin`, which hold once it is whole, are private. */
struct jp_map_decoder {
    struct jp_map_room room;
    enum jp_map_state state;
    struct jp_terrain terrain;
    struct jp_place origin; /**< where the robot was switched on */
    uint8_t head[JP_MAP_HEAD];
    uint8_t head_count;
    uint8_t mode;   /* of the row that is decoded: the byte that began it, or 0 between rows */
    uint8_t copies; /* rows that are still to be made like the one before */
    uint16_t x;     /* cell that comes next */
    uint16_t y;
};

/** An empty stream. The block stays with the decoder. */
void jp_map_decoder_start(struct jp_map_decoder *decoder, const struct jp_map_room *room);

/** False: a row is to be made first. Constant time. */
bool jp_map_decoder_is_ready(const struct jp_map_decoder *decoder);

/** Makes a row that is as the one before, if there is one to be made. Work: its cells. */
void jp_map_decoder_work(struct jp_map_decoder *decoder);

/** Takes the next byte, when it is ready. Work: 64 cells; with the last byte of the head the map is cleared. */
enum jp_map_state jp_map_decoder_take(struct jp_map_decoder *decoder, uint8_t byte);

/** Bytes that are enough for any map; 0 when the configuration is out of range. Constant time. */
size_t jp_map_code_size(const struct jp_terrain_config *config);

/** Writes a map, without elevations and costs; returns the length of the stream, 0: `size` is too small for it. Work:
 *  the cells, twice. */
size_t jp_map_encode(const struct jp_terrain *terrain, const struct jp_place *origin, uint8_t *bytes, size_t size);

#ifdef __cplusplus
}
#endif

#endif
