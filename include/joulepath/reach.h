/**
 * Whether any way leads from one cell to another: a flood over the cells on which the robot can be at some heading.
 *
 * What it does not reach no route of the lattice reaches, whatever its headings: a proof, in two bits a cell, where the
 * planner's block is too small for one. What it reaches a route need not. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_REACH_H
#define JOULEPATH_REACH_H

#include <joulepath/lattice.h>

#ifdef __cplusplus
extern "C" {
#endif

enum jp_reach_answer {
    JP_REACH_WORKING,
    JP_REACH_CONNECTED, /**< the flood has come to the target */
    JP_REACH_NONE       /**< it has ended elsewhere: no route leads there on this map */
};

/** The members are private. */
struct jp_reach {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    uint32_t *reached; /**< a bit a cell, */
    uint32_t *done;    /**< and one for those whose neighbours are */
    uint32_t words;    /**< of each */
    uint32_t cursor;   /**< word that is looked at next */
    uint32_t target;   /**< cell */
    bool has_news;     /**< since the cursor was at 0 */
    enum jp_reach_answer answer;
};

/** Bytes for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_reach_size(const struct jp_terrain_config *config);

/** Begins at cell (x, y) in `size` bytes of the caller; lattice and map must stay, and the map not change.
 *  JP_ERR_ARGUMENT: a null pointer; JP_ERR_MEMORY: `size` is below jp_reach_size(); JP_ERR_ALIGNMENT: `block` is not
 *  aligned to 8 bytes; JP_ERR_OUTSIDE: a cell is off the map. Work: the block is cleared. */
enum jp_status jp_reach_start(struct jp_reach *reach, const struct jp_lattice *lattice,
                              const struct jp_terrain *terrain, int32_t x, int32_t y, int32_t target_x,
                              int32_t target_y, void *block, size_t size);

/** Continues over at most so many cells, or looks at 32 times as many that are not reached. Work: JP_MOVE_DIRECTIONS
 *  calls of jp_lattice_is_open() a cell. */
enum jp_reach_answer jp_reach_work(struct jp_reach *reach, unsigned cells);

#ifdef __cplusplus
}
#endif

#endif
