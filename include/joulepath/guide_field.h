/**
 * Guide field: an estimate of the cost, turning included, of driving between a root pose and every part of the map.
 * Internal: here only because struct jp_planner holds it.
 *
 * Each coarse cell of `scale` × `scale` cells of the map keeps the cost of one cheap chain of unit steps, scaled up, to
 * or from the root, and the direction of the chain's step at the cell; turning from step to step is charged. So the
 * guide accounts for turns, which a bound over cells alone cannot (energy_field.h). But it is an inadmissible
 * heuristic: it can be above or below the true cost. It steers a search and proves nothing. It is not repaired when the
 * map changes.
 *
 * Memory: the caller's block, two and a half bytes and one bit a coarse cell. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_GUIDE_FIELD_H
#define JOULEPATH_GUIDE_FIELD_H

#include <joulepath/lattice.h>
#include <joulepath/wavefront.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_GUIDE_SCALE_MAX 8

/** Direction of driving. */
enum jp_guide_direction {
    JP_GUIDE_FROM_ROOT, /**< estimates are of the cost from the root to a pose */
    JP_GUIDE_TO_ROOT    /**< from a pose to the root */
};

/** A cell of the map and the set of headings at it, a bit for each. */
struct jp_guide_root {
    uint16_t x;
    uint16_t y;
    uint16_t headings; /**< not 0 */
};

/** Private: the coarse cell whose neighbours are relaxed, and how many are yet to be. */
struct jp_guide_cell {
    int32_t x;
    int32_t y;
    uint32_t value;
    int32_t elevation;
    uint8_t directions_left;
};

/** The members are private. */
struct jp_guide_field {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    const struct jp_turns *turns;
    enum jp_cost_kind kind;
    uint8_t scale;
    uint8_t shift; /**< values are in 2^shift cost units, rounded down */
    enum jp_guide_direction direction;
    struct jp_guide_root root;
    struct jp_wavefront wave;
    struct jp_guide_cell cell;
    uint32_t debt;      /**< units of work that have been done and not counted yet */
    uint8_t *steps;     /**< direction of the step at each coarse cell, two a byte */
    uint32_t *open;     /**< on which cells the robot may be, a bit each; null: that is found for each step */
    uint16_t open_rows; /**< of it that have been found */
};

/** Bytes for a map of this configuration, a multiple of 8. `scale`: 1…JP_GUIDE_SCALE_MAX. */
size_t jp_guide_field_size(const struct jp_terrain_config *config, unsigned scale);

/** Binds a guide to its map, to the lattice's turns for the kind of cost, and to jp_guide_field_size() bytes aligned
 * to 8. */
void jp_guide_field_init(struct jp_guide_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                         const struct jp_terrain *terrain, const struct jp_turns *turns, unsigned scale, void *block);

/** Takes other costs of the same lattice; jp_guide_field_start() must follow. Constant time. */
void jp_guide_field_set_lattice(struct jp_guide_field *field, const struct jp_lattice *lattice);

/** Starts anew from a root, to grow a quarter beyond the target cell's estimate. Constant time. */
void jp_guide_field_start(struct jp_guide_field *field, enum jp_guide_direction direction,
                          const struct jp_guide_root *root, uint16_t target_x, uint16_t target_y);

/** Bytes that let a guide grow several times as fast while it has them. Constant time. */
size_t jp_guide_field_loan(const struct jp_terrain_config *config);

/** Lends them to it, aligned to 4, after jp_guide_field_start(), until it has grown. What changes on the map meanwhile
 * it does not see. Constant time. */
void jp_guide_field_lend(struct jp_guide_field *field, void *block);

/** Continues to grow, by *units units of work, which count down. A step from a coarse cell to a neighbour takes at most
 *  some 4 scale³; what the last one takes beyond is counted by the next call. True when done. */
bool jp_guide_field_grow(struct jp_guide_field *field, unsigned *units);

/** True when the guide has found a path to the coarse cell around (x, y). Constant time. */
bool jp_guide_field_reaches(const struct jp_guide_field *field, int32_t x, int32_t y);

/** Estimate for a pose; where the guide does not reach, that of its farthest cells without their turning. Valid when
 *  jp_guide_field_grow() has returned true. Constant time. */
jp_cost jp_guide_field_estimate(const struct jp_guide_field *field, int32_t x, int32_t y, unsigned heading);

#ifdef __cplusplus
}
#endif

#endif
