/**
 * Map of the ground: occupied, free and unknown cells, their elevation, of which class of ground they are, and what
 * driving on them costs.
 *
 * Cell (x, y) covers [x, x + 1) × [y, y + 1) cells of `resolution`; x points east, y north. All memory is one block of
 * the caller: two bits a cell, two bytes with elevation, one with costs, two bits with classes (300 × 300 cells: 24 000
 * B, 180 000 B, 90 000 B, 22 500 B). Nothing here is for ISRs unless they alone use the map.
 */
#ifndef JOULEPATH_TERRAIN_H
#define JOULEPATH_TERRAIN_H

#include <joulepath/fixed.h>
#include <joulepath/ground.h>
#include <joulepath/point.h>
#include <joulepath/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Largest width and height, cells. */
#define JP_TERRAIN_SIDE_MAX 4096

/** Elevation in units of 2⁻¹⁰ m: ±31.999 m. */
typedef int16_t jp_elevation;
#define JP_ELEVATION_ONE 1024

#define JP_CELL_COST_SHIFT_MAX 8

enum jp_cell { JP_CELL_FREE, JP_CELL_OCCUPIED, JP_CELL_UNKNOWN };

struct jp_terrain_config {
    uint16_t width;       /**< cells; 1…JP_TERRAIN_SIDE_MAX */
    uint16_t height;      /**< cells; 1…JP_TERRAIN_SIDE_MAX */
    jp_q16 resolution;    /**< side of a cell, m; above 0 */
    bool has_elevation;   /**< without it the ground is level */
    bool unknown_is_free; /**< whether the robot may drive over unknown cells */
    bool has_costs;       /**< without them every cell costs alike */
    uint8_t cost_shift;   /**< a cell's factor is 1 + cost/2^cost_shift; 0…JP_CELL_COST_SHIFT_MAX */
    bool has_classes;     /**< without them all ground is of class 0 */
};

/** The members are private; read them with the calls below. */
struct jp_terrain {
    struct jp_terrain_config config;
    uint32_t version; /**< counts the changes */
    uint16_t stride;  /**< words a row of the bit planes */
    uint32_t *blocked;
    uint32_t *unknown;
    jp_elevation *elevation; /**< null: level */
    uint8_t *costs;          /**< null: 0 everywhere */
    uint8_t *classes;        /**< two bits a cell; null: 0 everywhere */
};

/** A row of neighbouring cells relative to a cell: (first, y)…(last, y). */
struct jp_span {
    int8_t y;
    int8_t first;
    int8_t last; /**< at least `first` */
};

/** Bytes that a map needs; 0 when the configuration is out of range. Constant time. */
size_t jp_terrain_size(const struct jp_terrain_config *config);

/**
 * An empty map: every cell unknown, at elevation 0, of cost 0 and class 0. `block` stays with the map.
 * JP_ERR_CONFIG: *field names the first field out of range. JP_ERR_MEMORY: `size` is below jp_terrain_size().
 * JP_ERR_ALIGNMENT: `block` is not aligned to 8 bytes. JP_ERR_ARGUMENT: a pointer is null. Work: all cells.
 */
enum jp_status jp_terrain_init(struct jp_terrain *terrain, const struct jp_terrain_config *config, void *block,
                               size_t size, const char **field);

/** True when the cell is on the map. Constant time. */
bool jp_terrain_contains(const struct jp_terrain *terrain, int32_t x, int32_t y);

/** Sets the state of a cell. JP_ERR_OUTSIDE: it is not on the map. JP_ERR_ARGUMENT: no such state. Constant time. */
enum jp_status jp_terrain_set_cell(struct jp_terrain *terrain, int32_t x, int32_t y, enum jp_cell cell);

/** Sets the elevation of a cell. JP_ERR_OUTSIDE: it is not on the map. JP_ERR_STATE: the map has no elevation.
 *  Constant time. */
enum jp_status jp_terrain_set_elevation(struct jp_terrain *terrain, int32_t x, int32_t y, jp_elevation elevation);

/** Sets the cost of a cell, by which lattice.h charges what drives over it. JP_ERR_OUTSIDE: it is not on the map.
 *  JP_ERR_STATE: the map has no costs. Constant time. */
enum jp_status jp_terrain_set_cost(struct jp_terrain *terrain, int32_t x, int32_t y, uint8_t cost);

/** Sets the class of a cell's ground, by whose prices lattice.h charges what drives over it. JP_ERR_ARGUMENT: not below
 *  JP_GROUND_CLASSES. JP_ERR_OUTSIDE: it is not on the map. JP_ERR_STATE: the map has no classes. Constant time. */
enum jp_status jp_terrain_set_class(struct jp_terrain *terrain, int32_t x, int32_t y, uint8_t ground);

/** State of a cell; outside the map everything is occupied. Constant time. */
enum jp_cell jp_terrain_cell(const struct jp_terrain *terrain, int32_t x, int32_t y);

/** Elevation of a cell; 0 outside the map. Constant time. */
jp_elevation jp_terrain_elevation(const struct jp_terrain *terrain, int32_t x, int32_t y);

/** Elevation of a point, m from the south-west corner of the map: bilinear between the middles of the cells, level
 * beyond the outermost; m. Constant time. */
jp_q16 jp_terrain_height(const struct jp_terrain *terrain, const struct jp_point *point);

/** Blocks every free cell whose ground rises by more than `steepest`, rise over run, in any direction: ground on which
 * the robot tips over or slides. How many it blocked; 0 on a map without elevation. Work: all cells, two divisions
 * each.
 */
uint32_t jp_terrain_block_steep(struct jp_terrain *terrain, jp_q24 steepest);

/** Cost of a cell; 0 outside the map. Constant time. */
uint8_t jp_terrain_cost(const struct jp_terrain *terrain, int32_t x, int32_t y);

/** Class of a cell's ground; 0 outside the map. Constant time. */
uint8_t jp_terrain_class(const struct jp_terrain *terrain, int32_t x, int32_t y);

/** True when the robot may be on every cell of the spans, placed with their origin on (x, y), which are within
 *  ±2³⁰. Cells outside the map are blocked. Work: one or two words of the map a span. */
bool jp_terrain_is_clear(const struct jp_terrain *terrain, const struct jp_span *spans, size_t count, int32_t x,
                         int32_t y);

#ifdef __cplusplus
}
#endif

#endif
