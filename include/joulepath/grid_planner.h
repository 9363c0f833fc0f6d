/**
 * Shortest ways over an occupancy grid in one fixed block of memory: 8-neighbour A*, with or without jump points, and
 * any-angle ways by edge nodes with interpolated cost-to-go and line-of-sight shortcuts.
 *
 * The robot is a disc: a cell is free when the map is free nearer than `clearance` to its centre, so that off the
 * centres a way keeps up to 0.71 cells less. Ways start and end at centres of cells. Every cell counts the same.
 *
 *   steps   to the eight neighbours; a diagonal step needs both cells beside it free.
 *   lines   may run along borders and touch corners of blocked cells, but neither enter the open interior of a blocked
 *           cell, nor run between two blocked cells, nor touch a point where two blocked cells meet corner to corner,
 * even in the inner corner of a wall. All off the map is blocked.
 *
 *   octile      8-neighbour A* with octile distances; the baseline.
 *   jump points the same optimum (Harabor and Grastien, AAAI 2011, without corner cutting): nodes of a straight run
 *               with no forced neighbour are not opened.
 *   any angle   the octile optimum by jump points, shortcut by line of sight; around it, within `tube` cells, the
 *               cost-to-go of every point of the edge between two neighbouring nodes is interpolated (Ferguson and
 *               Stentz, Field D*, 2006), its minimum for unit cost in closed form: g = g1 + √(1 − d²), d = g1 − g2
 *               within 0…1/√2, at y = d/√(1 − d²) along the edge. The way over those edge nodes, shortcut again, is
 *               taken where it is shorter: so the answer is never longer than the octile optimum.
 *
 * Memory: 8 B a cell for the nodes, 0.25 B for two bit planes, 8 B for each entry of the queue, which has room for an
 * eighth of the cells or more, and 32 B for each row and column for the turning points: 9.3 B a cell in all.
 *
 * Integers only: the same bits on every core. The map must outlive the planner and must not change during a search.
 * Nothing here is for ISRs.
 */
#ifndef JOULEPATH_GRID_PLANNER_H
#define JOULEPATH_GRID_PLANNER_H

#include <joulepath/point.h>
#include <joulepath/terrain.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Largest clearance, cells. */
#define JP_GRID_CLEARANCE_MAX 24

/** Largest tube, cells. */
#define JP_GRID_TUBE_MAX 32

/** Longest way, cells. */
#define JP_GRID_LENGTH_MAX 32767

/** Sides of a cell, m, and of the map, m. */
#define JP_GRID_RESOLUTION_MIN JP_Q16(0.001)
#define JP_GRID_SIDE_MAX       JP_Q16(4095)

enum jp_grid_method { JP_GRID_OCTILE, JP_GRID_JUMP_POINTS, JP_GRID_ANY_ANGLE };

struct jp_grid_planner_config {
    enum jp_grid_method method;
    jp_q16 clearance; /**< kept from a cell's centre, m; 0…JP_GRID_CLEARANCE_MAX cells; 0: a point */
    uint8_t tube;     /**< cells to each side of the shortcut way that edge nodes may use; 1…JP_GRID_TUBE_MAX */
};

struct jp_grid_cell {
    int16_t x;
    int16_t y;
};

enum jp_grid_answer {
    JP_GRID_SEARCHING,
    JP_GRID_FOUND,
    JP_GRID_UNREACHABLE,   /**< proved */
    JP_GRID_OUT_OF_MEMORY, /**< the queue or the turning points are full, or the way exceeds JP_GRID_LENGTH_MAX */
    JP_GRID_STALE,         /**< the map changed during the search: start again */
    JP_GRID_NO_TASK
};

struct jp_grid_counts {
    uint32_t expansions;  /**< nodes taken from the queue by A* */
    uint32_t edge_nodes;  /**< nodes whose cost-to-go was interpolated */
    uint32_t queue_most;  /**< most entries that the queue held at once */
    jp_q16 octile_length; /**< of the 8-neighbour optimum, cells */
    uint32_t bytes;       /**< of the block that are used */
};

/* Private, until jp_grid_planner_size(). */

/** A turning way in a part of the block. */
struct jp_grid_way {
    struct jp_point *points;
    uint32_t count;
};

/** What a search works at, in this order. */
enum jp_grid_phase {
    JP_GRID_FILL_PLANES,
    JP_GRID_CLEAR,         /**< the nodes, for A* */
    JP_GRID_SEARCH,        /**< A* */
    JP_GRID_TRACE,         /**< the octile way; any angle goes on: */
    JP_GRID_TIGHTEN,       /**< the way by shortcuts */
    JP_GRID_CLEAR_AGAIN,   /**< the nodes, for the edges */
    JP_GRID_MARK,          /**< the tube */
    JP_GRID_SPREAD,        /**< cost-to-go over the tube */
    JP_GRID_DESCEND,       /**< the way over the edges */
    JP_GRID_TIGHTEN_OTHER, /**< the same, by shortcuts */
};

struct jp_grid_planner_internal {
    struct jp_grid_planner_config config;
    const struct jp_terrain *terrain;
    uint32_t version;  /**< of the map that the planes show */
    bool has_planes;   /**< they are whole */
    uint8_t disc_rows; /**< spans of the disc */
    struct jp_span disc[2 * JP_GRID_CLEARANCE_MAX + 1];

    uint32_t *rows;    /**< bits of blocked cells with a border of one cell; a bit is an x */
    uint32_t *columns; /**< the same with x and y exchanged */
    uint16_t row_words;
    uint16_t column_words;
    struct jp_grid_node {
        uint32_t g;     /**< cost from the start, or to go to the goal; cells, Q16 */
        uint32_t place; /**< entry in the queue, direction from the parent, and whether the tube holds it */
    } * nodes;
    struct jp_grid_entry {
        uint32_t key;
        uint32_t cell;
    } * queue;
    uint32_t queue_count;
    uint32_t queue_max;
    uint32_t points_max;    /**< of a way */
    uint32_t length_max;    /**< cells, Q16 */
    struct jp_grid_way way; /**< the answer, or the best until now */
    struct jp_grid_way other;

    enum jp_grid_phase phase;
    enum jp_grid_answer answer;
    bool is_too_long; /**< a way beyond length_max was left out */
    bool has_changed; /**< this pass has moved a turning point */
    uint8_t passes;
    uint32_t cursor;      /**< what comes next in this phase */
    uint32_t cursor_part; /**< the same within it */
    struct jp_grid_cell start;
    struct jp_grid_cell goal;
    struct jp_point place; /**< of the descent: Q16 cells from the centre of cell (0, 0) */
    uint32_t place_cost;   /**< cost-to-go there */
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
 * the map exceeds JP_GRID_SIDE_MAX. JP_ERR_MEMORY: `size` is below jp_grid_planner_size(). JP_ERR_ALIGNMENT: `block` is
 * not aligned to 8 bytes. JP_ERR_ARGUMENT: a pointer is null. Constant time.
 */
enum jp_status jp_grid_planner_init(struct jp_grid_planner *planner, const struct jp_grid_planner_config *config,
                                    const struct jp_terrain *terrain, void *block, size_t size, const char **field);

/** Begins a search, and forgets the last way. JP_ERR_OUTSIDE, JP_ERR_BLOCKED: start or goal is off the map, or the
 * robot does not fit there; JP_ERR_ARGUMENT: a null pointer. The old task stays then. Constant time. */
enum jp_status jp_grid_planner_start(struct jp_grid_planner *planner, const struct jp_grid_cell *start,
                                     const struct jp_grid_cell *goal);

/** Searches on for at most `expansions` expansions or as much of other work. An expansion with jump points reads up to
 *  a bit of every row and column for each cell of four diagonals; long ones count as several. */
enum jp_grid_answer jp_grid_planner_work(struct jp_grid_planner *planner, unsigned expansions);

/** Turning points of the way found, start and goal included; null and 0 without one. They stay until the next task. */
const struct jp_point *jp_grid_planner_path(const struct jp_grid_planner *planner, size_t *count);

const struct jp_grid_counts *jp_grid_planner_statistics(const struct jp_grid_planner *planner);

/** Side of a cell of the map, m. */
jp_q16 jp_grid_planner_resolution(const struct jp_grid_planner *planner);

/** True when the line between two points is on the map and free. Work: cells on the line; and for each, the spans of
 * the disc, when the map has changed since the last search began. */
bool jp_grid_planner_line_is_free(const struct jp_grid_planner *planner, const struct jp_point *from,
                                  const struct jp_point *to);

#ifdef __cplusplus
}
#endif

#endif
