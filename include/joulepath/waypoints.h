/**
 * From a planned route to waypoints: the targets of a robot that drives energy-optimal segments (segment.h).
 *
 * The lattice planner's route leads over cells; the robot follows waypoints by arcs, each planned for least energy from
 * where the last one ends. Waypoints are places along the route; between two of them the straight chord, the arc that
 * the optimiser gives and the turn before it must be clear of obstacles. The choice with the least predicted energy is
 * taken, by dynamic programming over places and headings (JP_WAYPOINTS_SECTORS of them). A segment's energy is that of
 * level ground plus what the slopes on its arcs add. A segment nearer to obstacles than JP_WAYPOINTS_MARGIN_M counts
 * for more, up to 1.3 times its energy, since the driven path leaves the predicted one by some centimetres.
 *
 * Four attempts, the first with a choice is the answer: with the least margin among the places of the route, among
 * those and places a cell to the left and right of them, and both again without a least margin.
 *
 * Memory: one block of the caller, 1 536 B for each pose of the route. Integers only: the same bits on every core.
 * Nothing here is for ISRs.
 */
#ifndef JOULEPATH_WAYPOINTS_H
#define JOULEPATH_WAYPOINTS_H

#include <joulepath/planner.h>
#include <joulepath/segment.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Sectors of a turn into which the headings at a place are divided. */
#define JP_WAYPOINTS_SECTORS 16U

/** Margin from obstacles, m, above which a segment costs no more; and the steps into which it is divided. */
#define JP_WAYPOINTS_MARGIN_M     0.15
#define JP_WAYPOINTS_MARGIN_STEPS 3

/** Poses of a route. */
#define JP_WAYPOINTS_ROUTE_MAX 20000U

/** Largest side of the footprint, cells. */
#define JP_WAYPOINTS_FOOTPRINT_MAX 64

/** The members must outlive the search, and the map must not change during it. Model and limits must have passed their
 *  checks. */
struct jp_waypoints_config {
    const struct jp_terrain *terrain;
    const struct jp_lattice *lattice; /**< of the route: its headings and what its slopes cost */
    const struct jp_energy_model *model;
    const struct jp_segment_limits *limits;
    jp_q24 length;      /**< of the footprint, m; above 0, at most JP_WAYPOINTS_FOOTPRINT_MAX cells */
    jp_q24 width;       /**< likewise */
    uint16_t reach;     /**< places along the route that one segment may pass, and one; 1 or more */
    uint8_t margin_min; /**< steps that all segments but the first and the last keep, whose places are given;
                             0…JP_WAYPOINTS_MARGIN_STEPS */
};

enum jp_waypoints_answer {
    JP_WAYPOINTS_NO_ROUTE, /**< nothing to choose from yet */
    JP_WAYPOINTS_CHOOSING,
    JP_WAYPOINTS_FOUND,
    JP_WAYPOINTS_NONE /**< no choice is clear and within the limits */
};

/** A waypoint and the segment that leads to it. */
struct jp_waypoint {
    struct jp_point point;     /**< m from the start, along the axes of the map */
    jp_angle heading;          /**< predicted there, from the x axis of the map */
    uint16_t pose;             /**< of the route, where it is or beside which it is */
    int8_t side;               /**< cells to the left of that pose: −1, 0 or 1 */
    uint8_t margin;            /**< steps that the segment keeps */
    struct jp_segment segment; /**< of the first waypoint, the start: all 0 */
};

/** Label of the search: the best sequence of segments so far that ends at a place with a heading of a sector. Private.
 */
struct jp_waypoints_label {
    jp_phase heading;
    int64_t price;           /* J/655 360 in the model's unit, with what slopes add and margins lack */
    struct jp_motion motion; /* at its end */
    uint16_t before;         /* backpointer: place of the label before, */
    uint8_t before_sector;   /* and its sector */
    uint8_t margin;
};

/** Private. */
struct jp_waypoints_internal {
    struct jp_waypoints_label *labels; /**< JP_WAYPOINTS_SECTORS for each place */
    size_t labels_max;
    const struct jp_lattice_pose *route;
    uint16_t route_count;
    uint16_t places;
    uint16_t from; /**< the pair of places that is looked at next */
    uint16_t to;
};

/** The members but `internal` may be read. */
struct jp_waypoints {
    struct jp_waypoints_config config;
    enum jp_waypoints_answer answer;
    uint8_t attempts;   /**< that have ended, of four */
    bool is_wide;       /**< of this attempt: places beside the route count too */
    uint8_t margin_min; /**< of this attempt, steps */
    struct jp_waypoints_internal internal;
};

/** Bytes of the block for a route of this many poses; 0 when they are not 2…JP_WAYPOINTS_ROUTE_MAX. */
size_t jp_waypoints_size(size_t poses);

/** Prepares in `size` bytes of the caller. JP_ERR_CONFIG: *field names the first member that is null or out of range;
 *  "terrain.resolution": not the lattice's. JP_ERR_ALIGNMENT: `block` is not aligned to 8 bytes. JP_ERR_ARGUMENT: a
 *  pointer is null. Constant time. */
enum jp_status jp_waypoints_init(struct jp_waypoints *waypoints, const struct jp_waypoints_config *config, void *block,
                                 size_t size, const char **field);

/** Begins to choose along a route, cell by cell, which must outlive the search and the reading of its answer; the robot
 *  stands at its first pose. JP_ERR_ARGUMENT: a null pointer, not 2…JP_WAYPOINTS_ROUTE_MAX poses, or a heading that is
 *  none. JP_ERR_OUTSIDE: a pose is off the map. JP_ERR_MEMORY: the block is too small for it. Then nothing changes.
 *  Work: the poses and the block. */
enum jp_status jp_waypoints_start(struct jp_waypoints *waypoints, const struct jp_lattice_pose *route, size_t poses);

/** Continues for at most so many pairs of places. A pair takes at most JP_WAYPOINTS_SECTORS calls of
 *  jp_segment_optimise(), and for those that may be better a look at the cells under up to eight arcs. */
enum jp_waypoints_answer jp_waypoints_work(struct jp_waypoints *waypoints, unsigned pairs);

/** Number of waypoints of the answer, start and goal included; 0 without one. Work: the waypoints. */
size_t jp_waypoints_count(const struct jp_waypoints *waypoints);

/** Writes the waypoints. JP_ERR_NO_PLAN: there are none. JP_ERR_MEMORY: more than `max`. JP_ERR_ARGUMENT: a null
 *  pointer. Then nothing is written. Work: one jp_segment_optimise() a waypoint. */
enum jp_status jp_waypoints_read(const struct jp_waypoints *waypoints, struct jp_waypoint *list, size_t max);

#ifdef __cplusplus
}
#endif

#endif
