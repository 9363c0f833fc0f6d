/** The map that came over LCM, with what sensors see of it, and goals on it: packets from anybody, judged whole before
 *  anything is done with them. */
#ifndef JOULEPATH_SIM_LCM_LCM_MAP_H
#define JOULEPATH_SIM_LCM_LCM_MAP_H

#include "hal/can/map_link.h"
#include "sim/lcm/lcm_task.h"

/** Cells of a jp_cells_t. */
#define LCM_CELLS_MAX 4096

/** Zero-initialised there is none. The members but `id`, 0 without a map, `terrain` and `origin` are private. */
struct lcm_map {
    uint8_t id;
    struct jp_terrain terrain;
    struct jp_place origin; /**< where the robot was switched on */
    void *block;
    uint32_t crc;    /* of the packet behind its time */
    uint8_t *untold; /* a byte a cell: 1 where the robot is still to be told of it */
    size_t untold_count;
};

/** Reads a jp_map_t. *is_new: it is another map than the one before, which it has replaced. Unless the result is
 *  LCM_TASK_OK nothing has changed. */
enum lcm_task_result lcm_map_read(struct lcm_map *map, const void *packet, size_t size, bool *is_new);

/** Reads a jp_cells_t into the map. Unless the result is LCM_TASK_OK nothing has changed. */
enum lcm_task_result lcm_map_read_cells(struct lcm_map *map, const void *packet, size_t size);

/** Reads a jp_map_goal_t. *goal, whose id is not set, is valid only with LCM_TASK_OK. */
enum lcm_task_result lcm_map_read_goal(const struct lcm_map *map, const void *packet, size_t size,
                                       struct jp_map_goal *goal);

/** Writes the map as it is known to be, as jp_map_encode(): the robot is to be told of nothing else then. */
size_t lcm_map_encode(struct lcm_map *map, uint8_t *bytes, size_t size);

typedef bool lcm_map_tell(void *context, uint16_t x, uint16_t y, enum jp_cell cell);

/** Hands over the cells of which the robot is still to be told, until `tell` takes no more. */
void lcm_map_tell_cells(struct lcm_map *map, lcm_map_tell *tell, void *context);

/** Gives its memory back: there is no map then. */
void lcm_map_free(struct lcm_map *map);

#endif
