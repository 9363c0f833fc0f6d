/**
 * Energy field: for every cell a lower bound of what driving between it and one root cell costs, from the ground alone.
 *
 * The value of a cell is the cheapest chain of unit steps between it and the root over cells where the robot may be,
 * each step charged what it costs at least (lattice.h). No route can be cheaper, so the field is an admissible and
 * consistent heuristic. It is exact up to `horizon`; beyond it the horizon itself is the bound.
 *
 * It grows outward in slices, in order of value to within one step. When the map lets the robot drive cheaper,
 * the values that are too high are lowered, and only those; when the map becomes dearer the old values are still
 * bounds and stay. Memory: the caller's block, two bytes and one bit a cell. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_ENERGY_FIELD_H
#define JOULEPATH_ENERGY_FIELD_H

#include <joulepath/lattice.h>

/** Which way the robot drives. */
enum jp_field_direction {
    JP_FIELD_FROM_ROOT, /**< value: cost from the root to the cell */
    JP_FIELD_TO_ROOT    /**< value: cost from the cell to the root */
};

/** A rectangle of cells, both corners within; empty when last_x < first_x. */
struct jp_field_box {
    int32_t first_x;
    int32_t last_x;
    int32_t first_y;
    int32_t last_y;
};

/** The members are private. */
struct jp_energy_field {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    enum jp_cost_kind kind;
    enum jp_field_direction direction;
    uint16_t *values; /**< in 2^shift cost units, rounded down */
    uint32_t *dirty;  /**< cells whose value their neighbours have not heard of */
    uint8_t shift;
    uint16_t horizon;   /**< values below it are exact */
    uint16_t threshold; /**< dirty cells up to it are at work */
    uint16_t step;      /**< growth of the threshold */
    uint16_t lowest;    /**< lowest dirty value above the threshold that this sweep has seen */
    bool changed;       /**< this sweep has changed a value */
    uint16_t row;       /**< next row of this sweep */
    uint16_t first_row; /**< rows that may hold dirty cells */
    uint16_t last_row;
    int32_t target_x; /**< the horizon is set when the value of this cell is exact */
    int32_t target_y;
    struct jp_field_box lowered; /**< cells whose values have fallen since jp_energy_field_take_lowered() */
};

/** Bytes for a map of this configuration, a multiple of 8. */
size_t jp_energy_field_size(const struct jp_terrain_config *config);

/** Binds a field to its map and to jp_energy_field_size() bytes aligned to 8. Constant time. */
void jp_energy_field_init(struct jp_energy_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                          const struct jp_terrain *terrain, void *block);

/** Starts anew from a root cell of the map, to grow a quarter beyond the value of the target cell. Work: all cells
 *  are cleared. */
void jp_energy_field_start(struct jp_energy_field *field, enum jp_field_direction direction, int32_t root_x,
                           int32_t root_y, int32_t target_x, int32_t target_y);

/** Goes on growing; *cells counts down the cells worked on and ends at 0 or when the field is done. True when done.
 *  Work: `cells` cells, 16 steps each, and at most one row of the map more than once. */
bool jp_energy_field_grow(struct jp_energy_field *field, unsigned *cells);

/** Tells that cell (x, y) of the map has changed. Values that are too high become right with the next growth.
 *  Work: the cells of the lattice's core and the 16 steps round each. */
void jp_energy_field_cell_changed(struct jp_energy_field *field, int32_t x, int32_t y);

/** The cells whose values may have fallen since the last such call. Constant time. */
struct jp_field_box jp_energy_field_take_lowered(struct jp_energy_field *field);

/** Lower bound for a cell of the map; JP_COST_MAX when there is no way at all. Valid when the growth is done.
 *  Constant time. */
jp_cost jp_energy_field_bound(const struct jp_energy_field *field, int32_t x, int32_t y);

#endif
