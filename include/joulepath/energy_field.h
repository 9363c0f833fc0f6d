/**
 * Energy field: for every cell a lower bound of the cost of driving there from one root cell, turning left aside.
 * Internal: here only because struct jp_planner holds it.
 *
 * The value of a cell is the cheapest chain of unit steps from the root over cells where the robot may be, each step
 * charged its least cost (lattice.h). No route can be cheaper, so the field is an admissible and consistent heuristic.
 * It is exact up to a horizon, a quarter beyond the target's value; farther off the horizon is the bound.
 *
 * It grows in slices. When the map lets the robot drive cheaper, the values that are too high are lowered, and only
 * those; when the map becomes dearer the old values are still bounds and stay. Memory: the caller's block, one bit a
 * cell and three bytes; or two, of a unit for which each step is rounded down. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_ENERGY_FIELD_H
#define JOULEPATH_ENERGY_FIELD_H

#include <joulepath/lattice.h>
#include <joulepath/wavefront.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A rectangle of cells, both corners within; empty when last_x < first_x. */
struct jp_cell_box {
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
    uint8_t shift; /**< the unit of the values is 2^shift cost units */
    struct jp_wavefront wave;
    uint16_t root_x;
    uint16_t root_y;
    struct jp_cell_box lowered; /**< cells whose values have fallen since jp_energy_field_take_lowered() */
};

/** Bytes for a map of this configuration, a multiple of 8. */
size_t jp_energy_field_size(const struct jp_terrain_config *config, enum jp_wave_format format);

/** Binds a field to its map and to jp_energy_field_size() bytes aligned to 8. Values of two bytes have the smallest
 * unit for which they reach up to `range`; those of three have all costs. */
void jp_energy_field_init(struct jp_energy_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                          const struct jp_terrain *terrain, enum jp_wave_format format, jp_cost range, void *block);

/** Takes other costs of the same lattice; jp_energy_field_start() must follow. Constant time. */
void jp_energy_field_set_lattice(struct jp_energy_field *field, const struct jp_lattice *lattice);

/** Starts anew from a root cell of the map. Constant time. */
void jp_energy_field_start(struct jp_energy_field *field, int32_t root_x, int32_t root_y, int32_t target_x,
                           int32_t target_y);

/** Continues to grow, over at most *cells cells, which counts down. True when done. Work: 16 unit steps a cell. */
bool jp_energy_field_grow(struct jp_energy_field *field, unsigned *cells);

/** Notes that cell (x, y) of the map has changed: the next growth lowers the values that are too high.
 *  Work: the cells of the lattice's core and the 16 steps round each. */
void jp_energy_field_cell_changed(struct jp_energy_field *field, int32_t x, int32_t y);

/** The cells whose values may have fallen since the last such call. Constant time. */
struct jp_cell_box jp_energy_field_take_lowered(struct jp_energy_field *field);

/** Lower bound of the cost from the root to a cell of the map; JP_COST_MAX when no path leads there. Valid when
 *  jp_energy_field_grow() has returned true. Constant time. */
jp_cost jp_energy_field_bound(const struct jp_energy_field *field, int32_t x, int32_t y);

#ifdef __cplusplus
}
#endif

#endif
