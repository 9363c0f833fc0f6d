/**
 * A map, changes of its cells, and goals on it that arrive in frames: MapOffer, then MapData; CellChanges; MapGoal.
 *
 * A map counts only whole, with the right CRC-32 over its stream. What is lost of it is asked for again: MapData is
 * taken in its order, and `frames` says which one comes next. The same offer again goes on where the stream has come
 * to, so that its sender may begin anew. The stream is decoded into the map's memory as it comes: the map before is
 * gone with the first frame of the next.
 */
#ifndef JOULEPATH_HAL_CAN_MAP_LINK_H
#define JOULEPATH_HAL_CAN_MAP_LINK_H

#include "hal/can/map_code.h"
#include "hal/can/messages.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of a MapData. */
#define JP_MAP_DATA 5U

/** Bytes that wait to be decoded, a multiple of JP_MAP_DATA. */
#define JP_MAP_WAITING 80U

/** Cells of a CellChanges. */
#define JP_CELL_CHANGES 12U

/** Values of State in MapStatus. */
enum jp_map_link_state { JP_MAP_LINK_NONE, JP_MAP_LINK_RECEIVING, JP_MAP_LINK_READY, JP_MAP_LINK_REJECTED };

/** Values of Reason in MapStatus. */
enum jp_map_reason {
    JP_MAP_REASON_NONE,
    JP_MAP_REASON_FORMAT,
    JP_MAP_REASON_CRC,
    JP_MAP_REASON_TOO_LARGE,
    JP_MAP_REASON_CELL_SIZE,
    JP_MAP_REASON_UNDER_WAY
};

struct jp_map_link {
    struct jp_map_room room;
    struct jp_e2e_receiver offer_receiver;
    struct jp_e2e_receiver data_receiver;
    struct jp_e2e_receiver cells_receiver;
    struct jp_e2e_receiver goal_receiver;
    struct jp_map_decoder decoder; /**< its terrain is the map */
    enum jp_map_link_state state;
    enum jp_map_reason reason;
    uint8_t id;       /**< of the map; 0: none was offered */
    uint16_t length;  /**< of its stream, bytes */
    uint32_t crc;     /**< that the stream must have */
    uint32_t sum;     /**< that it has so far */
    uint16_t frames;  /**< taken: number of the MapData that comes next */
    uint16_t decoded; /**< bytes */
    uint8_t waiting[JP_MAP_WAITING];
    uint8_t cell_counter; /**< of the last CellChanges before which none is missing */
};

/** What CellChanges tells. */
struct jp_cell_changes {
    uint8_t map;
    uint16_t x; /**< of the first cell */
    uint16_t y;
    uint32_t cells; /**< two bits each, first cell lowest: enum jp_cell, or JP_CELL_UNCHANGED */
};
#define JP_CELL_UNCHANGED 3U

/** What MapGoal tells. */
struct jp_map_goal {
    uint8_t map;
    uint8_t id;
    uint16_t x; /**< cell */
    uint16_t y;
    bool has_heading;
    jp_angle heading;
};

/** No map. The room stays with the link. */
void jp_map_link_start(struct jp_map_link *link, const struct jp_map_room *room);

/* These take frames of the right length. Constant time. */

/** JP_E2E_OK although the offer is refused: then the reason says so. `may_replace`: whether another map may be
 *  replaced now. */
enum jp_e2e_result jp_map_link_accept_offer(struct jp_map_link *link, const struct jp_can_frame *frame,
                                            bool may_replace);
enum jp_e2e_result jp_map_link_accept_data(struct jp_map_link *link, const struct jp_can_frame *frame);

/** *changes is written unless the result is JP_E2E_CRC: changes hold in any order of those that come late. */
enum jp_e2e_result jp_map_link_accept_cells(struct jp_map_link *link, const struct jp_can_frame *frame,
                                            struct jp_cell_changes *changes);

/** *goal is written only with JP_E2E_OK. */
enum jp_e2e_result jp_map_link_accept_goal(struct jp_map_link *link, const struct jp_can_frame *frame,
                                           struct jp_map_goal *goal);

/** Decodes what waits. Work: a row of the map, or JP_MAP_DATA runs. */
void jp_map_link_work(struct jp_map_link *link);

/** The map and its origin are not what the rest of the application can take: it is rejected. */
void jp_map_link_reject(struct jp_map_link *link, enum jp_map_reason reason);

#ifdef __cplusplus
}
#endif

#endif
