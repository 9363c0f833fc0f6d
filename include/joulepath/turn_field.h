/**
 * Turn field: for every coarse cell of the map and every heading, a lower bound of what turning costs on the way there
 * from one root pose.
 * Internal: here only because struct jp_planner holds it.
 *
 * The value of a coarse cell and heading is the cheapest chain of primitives from the root, of which only the bases
 * count (lattice.h): moves are free, and within a coarse cell the robot may pass from any cell to any other. What a
 * route costs is the sum of its moves, which energy_field.h bounds, and of its bases; so the sum of both fields is an
 * admissible and consistent heuristic. Bases are rounded down to the unit of the values, a sixteenth of the cheapest
 * turn or less. The field is exact up to a horizon, a quarter beyond the target's value; farther off the horizon is the
 * bound.
 *
 * It grows in slices. When the map lets the robot pass where it could not, the values that are too high are lowered,
 * and only those; when more of the map is blocked the old values are still bounds and stay. Memory: the caller's block,
 * two bytes and a bit a coarse cell and heading. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_TURN_FIELD_H
#define JOULEPATH_TURN_FIELD_H

#include <joulepath/energy_field.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Cells of the map on a side of a coarse cell. */
#define JP_TURN_SCALE_MIN 2U
#define JP_TURN_SCALE_MAX 16U

/** Private: where a primitive leads along an axis from within a coarse cell: so many coarse cells off, and from some
 *  cell within on, one farther. */
struct jp_turn_leap {
    int8_t offset;
    uint8_t farther_from;
};

/** Private: the coarse cell and heading whose primitives are looked at, and how far. */
struct jp_turn_scan {
    int32_t x; /**< coarse */
    int32_t y;
    uint32_t value;
    uint16_t primitive;
    struct jp_turn_leap across;
    struct jp_turn_leap along;
    uint8_t heading;
    uint8_t corner; /**< of the four coarse cells that the primitive may lead to */
    uint8_t column; /**< of the cell within those of the coarse one that lead there */
    uint8_t row;
    bool is_active;
};

/** The members are private. */
struct jp_turn_field {
    const struct jp_lattice *lattice;
    const struct jp_terrain *terrain;
    enum jp_cost_kind kind;
    uint8_t scale;
    uint8_t shift;            /**< the unit of the values is 2^shift cost units */
    struct jp_wavefront wave; /**< a row for each heading of each row of coarse cells */
    struct jp_turn_scan scan;
    uint32_t debt; /**< looks that have been taken and not counted yet */
    uint16_t root_x;
    uint16_t root_y;
    uint8_t root_heading;
    struct jp_cell_box lowered; /**< cells whose values have fallen since jp_turn_field_take_lowered() */
};

/** Bytes for a map of this configuration, a multiple of 8. */
size_t jp_turn_field_size(const struct jp_terrain_config *config, unsigned scale);

/** Binds a field to its map and to jp_turn_field_size() bytes aligned to 8. `scale`: JP_TURN_SCALE_MIN…MAX. */
void jp_turn_field_init(struct jp_turn_field *field, const struct jp_lattice *lattice, enum jp_cost_kind kind,
                        const struct jp_terrain *terrain, unsigned scale, void *block);

/** Takes other costs of the same lattice; jp_turn_field_start() must follow. Constant time. */
void jp_turn_field_set_lattice(struct jp_turn_field *field, const struct jp_lattice *lattice);

/** Starts anew from a pose of the map. The field will reach a quarter beyond what the target pose costs. Work: the
 *  costs of turning. */
void jp_turn_field_start(struct jp_turn_field *field, const struct jp_turns *turns, int32_t root_x, int32_t root_y,
                         unsigned root_heading, int32_t target_x, int32_t target_y, unsigned target_heading);

/** Continues to grow, by *looks looks at a value, which counts down; what a primitive sweeps counts for 16 of them.
 * What the last one takes beyond is counted by the next call. True when done. */
bool jp_turn_field_grow(struct jp_turn_field *field, unsigned *looks);

/** Notes that cell (x, y) of the map is no longer blocked: the next growth lowers the values that are too high.
 *  Work: the cells that primitives of any heading sweep. */
void jp_turn_field_cell_changed(struct jp_turn_field *field, int32_t x, int32_t y);

/** The cells whose values may have fallen since the last such call. Constant time. */
struct jp_cell_box jp_turn_field_take_lowered(struct jp_turn_field *field);

/** Lower bound of the cost of turning between the root and a pose of the map; JP_COST_MAX when no path leads there.
 *  Valid when jp_turn_field_grow() has returned true. Constant time. */
jp_cost jp_turn_field_bound(const struct jp_turn_field *field, int32_t x, int32_t y, unsigned heading);

#ifdef __cplusplus
}
#endif

#endif
