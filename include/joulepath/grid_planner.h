/**
 * Paths over an occupancy grid, shortest or of the least price in joules, in one fixed block of memory: 8-neighbour A*,
 * with or without jump points, and any-angle paths from interpolated cost-to-go (Field D*) and line-of-sight shortcuts.
 *
 * The robot is a disc: a cell is free when no blocked cell is nearer than `clearance` to its centre. Between the
 * centres of cells a path therefore keeps up to 0.71 cells less. Paths start and end at centres of cells.
 *
 * A path costs its length, or with prices (grid_prices.h) what its metres do: ∫ metre + near(ring) + slope(grade) ds.
 * The ring is that of the cell, by its distance from blocked cells along eight directions, up to 4 % more than straight
 * on; the grade is that of the part of the path within the cell, by the map's heights at both ends of it.
 *
 *   steps   to the eight neighbours; a diagonal step needs both cells beside it free.
 *   lines   may run along the border of a blocked cell and touch its corners. They may not enter its interior, run
 *           between two blocked cells, or touch a point where two blocked cells meet corner to corner, even in the
 *           inner corner of a wall. Everything outside the map is blocked.
 *
 *   octile      8-neighbour A* with the octile distance, at the price of a level metre, as heuristic; the baseline.
 *   jump points the same optimum by jump point search (Harabor and Grastien, AAAI 2011, without corner cutting): it
 *               does not expand the nodes of a straight run that have no forced neighbour. Not with prices: a run would
 *               have to cost the same everywhere.
 *   any angle   the path of the jump points, with prices that of the octile search, shortcut by line of sight. Then the
 * cost-to-go is computed for all nodes within `tube` cells of this path and interpolated along the edge between two
 * neighbouring nodes (Ferguson and Stentz, Field D*, 2006). For unit cost the minimum over an edge has a closed form:
 *               g = g1 + √(1 − d²), d = g1 − g2 within 0…1/√2, at y = d/√(1 − d²) along the edge; with c in place of 1
 *               where a cell's width costs c. The path of steepest descent, shortcut too, is the answer where it costs
 *               less. A shortcut is taken where it does not cost more: the answer never exceeds the octile optimum.
 *
 * Memory: 8 B a cell for the nodes, 0.25 B for two bit planes, 8 B for each entry of the queue, which has room for an
 * eighth of the cells or more, and 32 B for each row and column for the turning points: 9.3 B a cell in all. Prices
 * take none besides: a node has three bits for its ring.
 *
 * Work of a search, with or without prices: each cell is cleared twice, and expanded and put into the tube at most
 * once; a line is looked along for each cell of the traced path and at most 16 times for each turning point in each of
 * 12 passes. With prices each cell is visited twice more when the map has changed.
 *
 * Integers only: the same bits on every core. The map must outlive the planner; a change of it during a search ends the
 * search with JP_GRID_STALE. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_GRID_PLANNER_H
#define JOULEPATH_GRID_PLANNER_H

#include <joulepath/grid_prices.h>
#include <joulepath/meter.h>
#include <joulepath/point.h>
#include <joulepath/terrain.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Largest clearance, cells. */
#define JP_GRID_CLEARANCE_MAX 24

/** Largest tube, cells. */
#define JP_GRID_TUBE_MAX 32

/** Longest path, cells; and the dearest one, in what a cell of level ground costs where nothing is near. */
#define JP_GRID_LENGTH_MAX 32767
#define JP_GRID_PRICE_MAX  524272

/** Largest width and height of the map, cells. */
#define JP_GRID_CELLS_MAX 1024U

/** Least side of a cell and largest side of the map, m. */
#define JP_GRID_RESOLUTION_MIN JP_Q16(0.001)
#define JP_GRID_SIDE_MAX       JP_Q16(4095)

enum jp_grid_method { JP_GRID_OCTILE, JP_GRID_JUMP_POINTS, JP_GRID_ANY_ANGLE };

struct jp_grid_planner_config {
    enum jp_grid_method method;
    jp_q16 clearance; /**< kept from a cell's centre, m; 0…JP_GRID_CLEARANCE_MAX cells; 0: a point */
    uint8_t tube;     /**< half-width around the shortcut path in which any angle improves it, cells;
                           1…JP_GRID_TUBE_MAX */
    const struct jp_grid_prices *prices; /**< null: a path costs its length. Read by init alone. A ring is at least a
                                              64th of a cell wide */
};

struct jp_grid_cell {
    int16_t x;
    int16_t y;
};

enum jp_grid_answer {
    JP_GRID_SEARCHING,
    JP_GRID_FOUND,
    JP_GRID_UNREACHABLE,   /**< there is no path: proved */
    JP_GRID_OUT_OF_MEMORY, /**< the queue or the turning points are full, or the path exceeds JP_GRID_LENGTH_MAX or
                                JP_GRID_PRICE_MAX */
    JP_GRID_STALE,         /**< the map changed during the search: start again */
    JP_GRID_NO_TASK        /**< jp_grid_planner_start() has not been called */
};

struct jp_grid_counts {
    uint32_t expansions;  /**< nodes taken from the queue by A* */
    uint32_t edge_nodes;  /**< nodes whose cost-to-go was interpolated */
    uint32_t queue_most;  /**< most entries that the queue held at once */
    jp_q16 octile_length; /**< of the 8-neighbour optimum, cells; with prices what it costs, in level cells,
                               saturating */
    uint32_t bytes;       /**< of the block that are used */
};

/* Private, until jp_grid_planner_size(). */

/** A path: its turning points, in a part of the block. */
struct jp_grid_path {
    struct jp_point *points;
    uint32_t count;
};

/** What a search works at, in this order. */
enum jp_grid_phase {
    JP_GRID_FILL_PLANES,
    JP_GRID_MEASURE,           /**< distances from blocked cells, from the south-west; with prices */
    JP_GRID_MEASURE_BACK,      /**< and from the north-east: the rings */
    JP_GRID_CLEAR,             /**< the nodes, for A* */
    JP_GRID_SEARCH,            /**< A* */
    JP_GRID_TRACE,             /**< follows the parents from the goal; octile and jump points end here */
    JP_GRID_TIGHTEN,           /**< shortens the traced path by line of sight */
    JP_GRID_CLEAR_AGAIN,       /**< the nodes, for the cost-to-go */
    JP_GRID_MARK,              /**< the cells of the tube */
    JP_GRID_PROPAGATE,         /**< cost-to-go from the goal over the tube */
    JP_GRID_DESCEND,           /**< follows the cost-to-go from the start down to the goal */
    JP_GRID_TIGHTEN_CANDIDATE, /**< shortens the path of the descent likewise */
};

struct jp_grid_planner_internal {
    struct jp_grid_planner_config config;
    const struct jp_terrain *terrain;
    uint32_t version;  /**< of the map that the planes show */
    bool has_planes;   /**< they are whole */
    bool has_rings;    /**< and with prices the rings of all cells */
    uint8_t disc_rows; /**< spans of the disc */
    struct jp_span disc[2 * JP_GRID_CLEARANCE_MAX + 1];

    uint32_t *rows;    /**< bits of blocked cells with a border of one cell; a bit is an x */
    uint32_t *columns; /**< the same with x and y exchanged */
    uint16_t row_words;
    uint16_t column_words;
    struct jp_grid_node {
        uint32_t g;     /**< cost from the start, or to go to the goal: `straight` a level cell */
        uint32_t place; /**< entry in the queue, direction from the parent, whether the tube holds it, and its ring */
    } * nodes;
    struct jp_grid_entry {
        uint32_t key;
        uint32_t cell;
    } * queue;
    uint32_t queue_count;
    uint32_t queue_max;
    uint32_t points_max; /**< turning points that a path may have */
    uint32_t length_max; /**< as costs */

    bool is_priced;
    uint32_t straight; /**< cost of a step over level cells, and of a diagonal one */
    uint32_t diagonal;
    jp_q16 metre; /**< as in the prices; 0: a path costs its length */
    jp_q16 rise;
    jp_q16 ring_cells;                 /**< width of a ring, cells */
    int64_t grade_per_unit;            /**< of neighbouring cells whose elevations differ by a unit, Q24 */
    uint16_t near[1U + JP_GRID_RINGS]; /**< price of a metre in a ring, in that of a level one far from things, Q8 */
    uint16_t slope[JP_GRID_GRADES];    /**< price of a grade besides, likewise */

    struct jp_grid_path path;      /**< the answer, or the best until now */
    struct jp_grid_path candidate; /**< of the descent */

    enum jp_grid_phase phase;
    enum jp_grid_answer answer;
    bool is_too_long; /**< a path beyond length_max was left out */
    bool has_changed; /**< this pass has moved a turning point */
    uint8_t passes;
    uint32_t cursor;      /**< what comes next in this phase */
    uint32_t cursor_part; /**< part of it that comes next */
    struct jp_grid_cell start;
    struct jp_grid_cell goal;
    struct jp_point place; /**< where the descent is: cells from the centre of cell (0, 0), Q16 */
    uint32_t place_cost;   /**< cost-to-go there; of the trace: cost from the start to the cursor */
    struct jp_grid_counts counts;
};

struct jp_grid_planner {
    struct jp_grid_planner_internal internal;
};

/** Bytes of the smallest block for a map; 0 when the map or the configuration is out of range. A larger block gives the
 *  queue more room, up to one entry a cell, when it cannot overflow. Constant time. */
size_t jp_grid_planner_size(const struct jp_grid_planner_config *config, const struct jp_terrain_config *terrain);

/**
 * Prepares a planner in `size` bytes of the caller.
 * JP_ERR_CONFIG: *field names the first field out of range; "resolution": below JP_GRID_RESOLUTION_MIN, or a side of
 * the map exceeds JP_GRID_SIDE_MAX; "method": jump points with prices; "prices": one is out of its range.
 * JP_ERR_MEMORY: `size` is below jp_grid_planner_size(). JP_ERR_ALIGNMENT: `block` is not aligned to 8 bytes.
 * JP_ERR_ARGUMENT: a pointer is null. Constant time.
 */
enum jp_status jp_grid_planner_init(struct jp_grid_planner *planner, const struct jp_grid_planner_config *config,
                                    const struct jp_terrain *terrain, void *block, size_t size, const char **field);

/** Begins a search, and forgets the last path. JP_ERR_OUTSIDE: start or goal is outside the map. JP_ERR_BLOCKED: the
 *  robot does not fit there. JP_ERR_ARGUMENT: a pointer is null. After a failure the old task stays. Work: the spans of
 *  the disc, twice. */
enum jp_status jp_grid_planner_start(struct jp_grid_planner *planner, const struct jp_grid_cell *start,
                                     const struct jp_grid_cell *goal);

/** Continues the search for at most `expansions` expansions or as much of other work, and returns what is known. An
 *  expansion with jump points reads up to a bit of every row and column for each cell of four diagonals; one whose
 *  diagonals are long counts as several. `planner` must have been initialised. */
enum jp_grid_answer jp_grid_planner_work(struct jp_grid_planner *planner, unsigned expansions);

/** Turning points of the path found, start and goal included, m on the map; null and *count 0 unless the last answer is
 *  JP_GRID_FOUND. They stay until the next jp_grid_planner_start(). Constant time. */
const struct jp_point *jp_grid_planner_path(const struct jp_grid_planner *planner, size_t *count);

/** What the path found costs by the prices, J, its rise from start to goal included; saturating. 0 without prices or a
 *  path. Work: the cells on the path, a division for each line and axis, with elevation one for each cell. */
jp_energy jp_grid_planner_price(const struct jp_grid_planner *planner);

/** What the last search did. Never null. Constant time. */
const struct jp_grid_counts *jp_grid_planner_statistics(const struct jp_grid_planner *planner);

/** Side of a cell of the map, m. Constant time. */
jp_q16 jp_grid_planner_resolution(const struct jp_grid_planner *planner);

/** True when the straight line between two points is on the map and free for the robot. Work: the cells on the line;
 * for each of them also the spans of the disc when the map has changed since the last search began. */
bool jp_grid_planner_line_is_free(const struct jp_grid_planner *planner, const struct jp_point *from,
                                  const struct jp_point *to);

#ifdef __cplusplus
}
#endif

#endif
