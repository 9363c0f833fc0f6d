/**
 * A way from one cell to another for a robot that turns where it stands: unit steps of a lattice, as few as there are,
 * found breadth-first from the goal in three bits a cell. It is no route of least energy, but one that the size of the
 * map bounds in memory and time: for where the planner's block is too small, or its search takes too long for a robot
 * that stands and waits.
 *
 * A step is clear, and not too steep, as the lattice's straight primitive along it, both ways. So a way is a route of
 * the lattice, if its robot turns in place with no more room than it stands in. Where no way leads the lattice's curves
 * may: reach.h proves that nothing does. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_LATTICE_WAY_H
#define JOULEPATH_LATTICE_WAY_H

#include <joulepath/lattice.h>

#ifdef __cplusplus
extern "C" {
#endif

enum jp_way_answer {
    JP_WAY_WORKING,
    JP_WAY_FOUND, /**< from the start, and from every cell that is no farther from the goal */
    JP_WAY_NONE   /**< the search has ended elsewhere */
};

/** A cell of a way. */
struct jp_way_cell {
    int16_t x;
    int16_t y;
};

/** Private: a range of words. */
struct jp_way_words {
    uint32_t first;
    uint32_t last;
};

/** The members are private. */
struct jp_lattice_way {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    uint32_t *front; /**< a bit a cell whose neighbours are to be looked at */
    uint32_t *marks; /**< two bits a cell: 0 where no way is known, else 1 + its steps to the goal modulo 3 */
    struct jp_way_words present; /**< of the front: cells of one distance, */
    struct jp_way_words next;    /**< and cells that are a step farther */
    struct jp_way_cell start;
    struct jp_way_cell goal;
    const struct jp_primitive *step[JP_MOVE_DIRECTIONS]; /**< null: the lattice has none */
    uint16_t alike; /**< a bit a direction: its step sweeps the same cells as the step back */
    uint8_t mark;   /**< of the present front */
    enum jp_way_answer answer;
};

/** Bytes for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_lattice_way_size(const struct jp_terrain_config *config);

/** Begins to look for a way in `size` bytes of the caller; lattice and map must stay, and the map not change.
 *  JP_ERR_ARGUMENT: a null pointer; JP_ERR_MEMORY: `size` is below jp_lattice_way_size(); JP_ERR_ALIGNMENT: `block` is
 *  not aligned to 8 bytes; JP_ERR_OUTSIDE: a cell is off the map. Work: the block is cleared. */
enum jp_status jp_lattice_way_start(struct jp_lattice_way *way, const struct jp_lattice *lattice,
                                    const struct jp_terrain *terrain, const struct jp_way_cell *start,
                                    const struct jp_way_cell *goal, void *block, size_t size);

/** Continues by so many looks, or up to 16 more: at a step there and back, as jp_lattice_cost(), at the neighbours of a
 *  cell, or at some words of the front. */
enum jp_way_answer jp_lattice_way_work(struct jp_lattice_way *way, unsigned looks);

/** Moves a cell one step nearer to the goal, on the way that was found. False: it is the goal, or no way is known from
 *  there. Work: as 16 looks. */
bool jp_lattice_way_next(const struct jp_lattice_way *way, struct jp_way_cell *cell);

#ifdef __cplusplus
}
#endif

#endif
