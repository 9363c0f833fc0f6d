/**
 * State lattice: the motions that a planner joins to a route, as constant tables made by tools/design/lattice.py.
 *
 * A state is a cell and one of JP_HEADINGS headings. A primitive leads from the centre of a cell to the centre of
 * another (or turns in place), from heading to heading. Its cost is a sum of integers,
 *
 *   cost = base + Σ over its moves of move(direction, rise)
 *
 * where the moves are unit steps that follow the primitive from cell to cell: `rise` is the difference of elevation
 * between the two cells of a step, move() is the cost of driving it straight, and `base`, never negative, is all that
 * turning costs on top. So the moves alone give a lower bound of the cost between two cells, the bases alone one of the
 * cost between two headings, and the sum of both is a lower bound too: energy_field.h uses it.
 *
 * On a map with classes of ground (terrain.h) the physical cost has besides, for what class k takes more,
 *
 *   Σ straight · move(direction, 0) + turning · base
 *
 * over its moves, with the mean `straight` of the ground under the wheels of both sides at both ends of a move, and the
 * largest mean `turning` under both sides at the cells of the primitive: a ground that resists more takes so much more
 * on slopes, too. These shares are at least 0; each product is rounded down, and a move or a base with what it takes
 * more is at most 65 535. So the lower bounds hold.
 *
 * On a map with costs of cells each move is multiplied by the larger factor of its two cells and `base` by the largest
 * of all cells of the primitive, rounded down. Factors are at least 1, so the lower bounds hold on every map.
 *
 * One table of swept cells decides collisions, and with it which changes of the map matter to which primitive; the
 * cells of the moves are among them.
 *
 * All functions are pure and bounded; an ISR may call them. Cells may be off the map, by up to 2³⁰.
 */
#ifndef JOULEPATH_LATTICE_H
#define JOULEPATH_LATTICE_H

#include <joulepath/terrain.h>

#ifdef __cplusplus
extern "C" {
#endif

#define JP_HEADINGS 16

/** Most primitives that start at one heading. */
#define JP_PRIMITIVES_PER_HEADING_MAX 255

/** Unit steps: along an axis, in a knight's move, along a diagonal. Direction d leads along jp_move_offsets[d]. */
#define JP_MOVE_DIRECTIONS 16
enum jp_move_kind { JP_MOVE_AXIS, JP_MOVE_KNIGHT, JP_MOVE_DIAGONAL, JP_MOVE_KINDS };

/**
 * What a route is charged for.
 * Physical: the energy out of the battery, potential energy m g Δz, descent gives back a stated share of its work, and
 * never less than what the electronics draw; unit 1/16 J. Paper: eq. 14 as printed, at least one unit; unit 1/16 J.
 * Distance: length, and in place the way of the robot's sides, half its width times the angle; unit 1 mm.
 */
enum jp_cost_kind { JP_COST_PHYSICAL, JP_COST_PAPER, JP_COST_DISTANCE, JP_COST_KINDS };

/** A cost in the unit of its kind. JP_COST_MAX stands for "no path" and for every sum that would exceed it. */
typedef uint32_t jp_cost;
#define JP_COST_MAX       ((jp_cost)0xFFFFFF)
#define JP_COST_PER_JOULE 16

/** constant + linear·rise + quadratic·rise², in 2⁻¹⁶ cost units; rise in units of jp_elevation. */
struct jp_polynomial {
    int32_t constant;
    int32_t linear;
    int32_t quadratic;
};

/** Cost of one unit step by its rise. */
struct jp_slope_cost {
    struct jp_polynomial climb;   /**< for rise >= bend */
    struct jp_polynomial descend; /**< for rise < bend */
    int16_t bend;                 /**< units of jp_elevation */
    int16_t rise_max;             /**< steeper steps, up or down, are impassable; 1…4096, and no part of
                                       constant + (linear + quadratic·rise)·rise may exceed 32 bits up to it */
    uint16_t floor;               /**< least cost, at least 1 */
};

struct jp_primitive {
    int8_t dx; /**< cells from start to end */
    int8_t dy;
    uint8_t start; /**< heading, 0…JP_HEADINGS − 1 */
    uint8_t end;
    uint16_t base[JP_COST_KINDS]; /**< cost units */
    uint16_t length;              /**< mm */
    uint16_t duration;            /**< ms */
    uint16_t first_move;          /**< index into `moves` */
    uint16_t first_span;          /**< index into `spans` */
    uint8_t move_count;
    uint8_t span_count;
};

/** Spans of one set of cells. */
struct jp_cells {
    uint16_t first_span;
    uint16_t span_count;
};

/** From one cell to another. */
struct jp_cell_offset {
    int8_t dx;
    int8_t dy;
};

/** What a class of ground takes more than the prices of the lattice: shares in 1/JP_GROUND_ONE, at most
 * JP_GROUND_SHARE_MAX. */
struct jp_ground_price {
    uint16_t straight; /**< of driving on level ground */
    uint16_t turning;  /**< of what turning costs on top */
};
#define JP_GROUND_ONE       256U
#define JP_GROUND_SHARE_MAX (16U * JP_GROUND_ONE)

struct jp_lattice {
    const char *name;
    jp_q16 resolution;                      /**< m, equal to that of the map */
    jp_angle heading[JP_HEADINGS];          /**< ascending from 0 */
    const struct jp_primitive *primitives;  /**< ordered by start heading */
    const uint16_t *by_end;                 /**< indices of the primitives, ordered by end heading */
    const uint8_t *moves;                   /**< directions of the unit steps, 0…JP_MOVE_DIRECTIONS − 1 */
    const struct jp_span *spans;            /**< swept cells relative to a start cell */
    uint16_t first_from[JP_HEADINGS + 1];   /**< range of the primitives that start at a heading */
    uint16_t first_to[JP_HEADINGS + 1];     /**< range of `by_end` of those that end at a heading */
    struct jp_cells footprint[JP_HEADINGS]; /**< cells under the robot that stands at a heading */
    struct jp_cells reach[JP_HEADINGS];     /**< cells that any primitive from a heading sweeps */
    struct jp_cells core;                   /**< cells that every primitive sweeps round every cell of its moves */
    struct jp_slope_cost move_costs[JP_COST_KINDS][JP_MOVE_KINDS];
    struct jp_ground_price ground[JP_GROUND_CLASSES]; /**< by class; 0 in tables */
    struct jp_cell_offset sides[JP_MOVE_DIRECTIONS]; /**< from the robot's cell to that of its left wheels; those of the
                                                          right ones are opposite. Of the core. 0 in tables */
    jp_q16 half_track;                               /**< of the wheels, m; 0 in tables */
    uint32_t version; /**< of the parameters that the costs follow (tariff.h); 0: those of the tables */
};

/** A set of headings, a bit for each: all of them. */
#define JP_ANY_HEADING ((uint16_t)0xFFFF)

/** A state. */
struct jp_lattice_pose {
    int16_t x; /**< cell */
    int16_t y;
    uint8_t heading; /**< 0…JP_HEADINGS − 1, of the lattice */
};

/** Least cost of turning from one heading to another over any primitives: the least sum of their bases. */
struct jp_turns {
    uint16_t cost[JP_HEADINGS][JP_HEADINGS]; /**< [from][to]; UINT16_MAX: no primitives lead there */
};

/** Of each direction: (1, 0), (2, 1), (1, 1), (1, 2), (0, 1), … round the circle. */
extern const struct jp_cell_offset jp_move_offsets[JP_MOVE_DIRECTIONS];

/** Kind of the unit step in a direction, 0…JP_MOVE_DIRECTIONS − 1. */
static inline enum jp_move_kind jp_move_kind_of(unsigned direction)
{
    if (direction % 2U != 0U) {
        return JP_MOVE_KNIGHT;
    }
    return direction % 4U != 0U ? JP_MOVE_DIAGONAL : JP_MOVE_AXIS;
}

/** a + b, at most JP_COST_MAX, for a and b up to JP_COST_MAX. */
static inline jp_cost jp_cost_add(jp_cost a, jp_cost b)
{
    return a + b > JP_COST_MAX ? JP_COST_MAX : a + b;
}

/**
 * Checks tables: indices, orders, costs above 0 of every primitive on every map, that the reach of each heading holds
 * all cells that its primitives sweep, and that these sweep the cells where they begin and end.
 * JP_ERR_CONFIG: *field names the first member that is wrong. JP_ERR_ARGUMENT: a pointer is null.
 * Work: all tables.
 */
enum jp_status jp_lattice_check(const struct jp_lattice *lattice, const char **field);

/** True when rise_max and floor are in their ranges and jp_move_cost() stays within 32 bits at every rise. Work: all
 *  rises. */
bool jp_slope_cost_is_valid(const struct jp_slope_cost *cost);

/** Least costs of turning for a kind of cost. Work: the primitives, and JP_HEADINGS³ additions. */
void jp_lattice_turns(const struct jp_lattice *lattice, enum jp_cost_kind kind, struct jp_turns *turns);

/** Cost of a unit step; JP_COST_MAX when it is too steep. Two multiplications. */
jp_cost jp_move_cost(const struct jp_slope_cost *cost, int32_t rise);

/** What the moves of any path cost at least. */
struct jp_straight {
    int64_t per_cell; /**< of the straight line, 2⁻¹⁶ cost units; below 0: downhill a move may cost nothing */
    int32_t per_rise; /**< a unit of jp_elevation, 2⁻¹⁶ cost units */
};

/** Of a lattice and a kind of cost. Work: all rises of a step. */
void jp_lattice_straight(const struct jp_lattice *lattice, enum jp_cost_kind kind, struct jp_straight *straight);

/** Lower bound of the cost of the moves of any path that ends (dx, dy) cells off and `rise` higher, obstacles left
 * aside: the least cost a length over the straight line, plus the cost of the rise. Work: a square root. */
jp_cost jp_straight_bound(const struct jp_straight *straight, int32_t dx, int32_t dy, int32_t rise);

/** True when all cells that a primitive sweeps from cell (x, y) are on the map and free. Work: its spans. */
bool jp_lattice_is_clear(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                         const struct jp_primitive *primitive, int32_t x, int32_t y);

/** Cost of a primitive from cell (x, y) without regard to obstacles; JP_COST_MAX when a step is too steep. Cells
 * off the map are level. Work: its moves. */
jp_cost jp_lattice_energy(const struct jp_lattice *lattice, enum jp_cost_kind kind, const struct jp_terrain *terrain,
                          const struct jp_primitive *primitive, int32_t x, int32_t y);

/** Cost of a primitive from cell (x, y); JP_COST_MAX when a cell that it sweeps is blocked or off the map, or a step is
 *  too steep. Work: its spans and moves. */
jp_cost jp_lattice_cost(const struct jp_lattice *lattice, enum jp_cost_kind kind, const struct jp_terrain *terrain,
                        const struct jp_primitive *primitive, int32_t x, int32_t y);

/** True when the robot can stand on cell (x, y) at a heading. Work: the spans of its footprint. */
bool jp_lattice_can_stand(const struct jp_lattice *lattice, const struct jp_terrain *terrain, int32_t x, int32_t y,
                          unsigned heading);

/** True when every primitive sweeps the cell (dx, dy) off every cell of its moves. Work: the spans of `core`. */
bool jp_lattice_core_holds(const struct jp_lattice *lattice, int32_t dx, int32_t dy);

/** False: the robot cannot be on cell (x, y) at any heading. True: it may be at some. Work: the spans of `core`. */
bool jp_lattice_is_open(const struct jp_lattice *lattice, const struct jp_terrain *terrain, int32_t x, int32_t y);

#ifdef __cplusplus
}
#endif

#endif
