/**
 * From a planned route to a course: straight lines that a disc can be moved along, and where it turns between them.
 *
 * The lattice planner's route leads over cells, and so does a lattice's way. Its steps, primitives or unit steps, are
 * joined to straight lines as long as the map allows: from each waypoint the line goes to the farthest of the next ends
 * of steps to which a disc of `radius` and `margin` can be moved. On a map with elevation a line is not too steep for
 * the lattice, and one of a route leads to where it saves most against the route, by the prices of the lattice: of
 * length, of what the ground rises by, and of the route's turns. The disc is the one in which the robot turns, so that
 * it may turn at every waypoint. Where the route begins too near to obstacles for the margin, the first line does
 * without it, and where they overlap the disc, which they do by as much as the robot does not know where they are, it
 * comes no nearer to them.
 *
 * A robot that does not stop at a waypoint leaves the lines on either side, by a length that its trajectory tells
 * (jp_trajectory_leg_extent()): jp_course_is_clear() says whether there is room for that.
 *
 * Integers only: the same bits on every core. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_COURSE_H
#define JOULEPATH_COURSE_H

#include <joulepath/lattice_way.h>
#include <joulepath/planner.h>
#include <joulepath/point.h>
#include <joulepath/pose_field.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Lines are at most so many cells long. */
#define JP_COURSE_REACH 120

/** A line to a waypoint. */
struct jp_course_leg {
    struct jp_point end; /**< m from the south-west corner of the map */
    jp_q16 margin;       /**< that is kept, m: config.margin; on the first line it may be jp_course_room() */
    jp_q16 aside;        /**< the caller's: how far the robot leaves the line beside that, m; 0 or more */
    jp_q16 beyond;       /**< the caller's: how far it goes beyond the end, m */
    uint8_t slower;      /**< the caller's, of the run that ends there */
    bool is_stop;        /**< the robot stands at the end, and turns there */
};

struct jp_course_config {
    const struct jp_terrain *terrain;
    jp_q16 radius;              /**< of the disc, m; a quarter of a cell to 32 cells. With the margin it must be less
                                     than what the lattice sweeps by as much as its arcs are from their chords */
    jp_q16 margin;              /**< round it, m; 0 to 16 cells */
    struct jp_course_leg *legs; /**< the caller's memory */
    uint16_t legs_max;          /**< at least 1 */
};

enum jp_course_answer {
    JP_COURSE_NO_ROUTE, /**< nothing was started */
    JP_COURSE_JOINING,
    JP_COURSE_FOUND,   /**< without legs, when the route does not leave its cell */
    JP_COURSE_NO_ROOM, /**< a step cannot be replaced by a line: the lattice leaves less room than the disc needs
                        */
    JP_COURSE_TOO_LONG /**< it takes more legs than there is memory for; `legs` hold its begin */
};

/** Private: an end of a step. */
struct jp_course_place {
    struct jp_lattice_pose pose; /**< on a way its heading means nothing */
    unsigned step;               /**< of the plan that begins there */
    int64_t cost;                /**< of the plan to it, on a map with elevation */
};

/** Private. */
struct jp_course_internal {
    const struct jp_planner *planner;  /**< whose plan it leads along, or null: */
    const struct jp_lattice_way *way;  /**< along the way, or null: */
    const struct jp_pose_field *field; /**< along the field to its root */
    const struct jp_lattice *lattice;  /**< of either */
    struct jp_point start;
    struct jp_point from;         /**< begin of the line that is looked for */
    struct jp_course_place first; /**< place that is left there */
    struct jp_course_place candidate;
    struct jp_course_place best;
    int64_t saving; /**< by the best line, against the route */
    jp_q16 margin;  /**< of this line */
    uint8_t misses; /**< since the best */
    bool has_best;
};

/** The members but `internal` may be read. */
struct jp_course {
    struct jp_course_config config;
    enum jp_course_answer answer;
    uint16_t count; /**< legs */
    struct jp_course_internal internal;
};

/** Prepares a course without legs. JP_ERR_CONFIG: *field names the first member that is null or out of range.
 *  JP_ERR_ARGUMENT: a pointer is null. Constant time. */
enum jp_status jp_course_init(struct jp_course *course, const struct jp_course_config *config, const char **field);

/** Begins a course from where the robot is along the plan that a planner has, which must not change until the course is
 *  found. JP_ERR_ARGUMENT: a pointer is null. JP_ERR_NO_PLAN: the planner has no route, not even a partial one.
 * Constant time. */
enum jp_status jp_course_start(struct jp_course *course, const struct jp_planner *planner,
                               const struct jp_point *start);

/** The same along a way that was found from a cell, which must not change until the course is found.
 *  JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_course_start_on_way(struct jp_course *course, const struct jp_lattice_way *way,
                                      const struct jp_way_cell *from, const struct jp_point *start);

/** The same from a pose to the root of a finished field, which must not change until the course is found. Where the map
 *  has changed so that the way ends before the root, there is no room.
 *  JP_ERR_ARGUMENT: a pointer is null. JP_ERR_NO_PLAN: the field did not reach the pose. */
enum jp_status jp_course_start_on_field(struct jp_course *course, const struct jp_pose_field *field,
                                        const struct jp_lattice_pose *from, const struct jp_point *start);

/** Looks at one more line. Work: jp_course_is_clear(); on a map with elevation also the line, cell by cell. */
enum jp_course_answer jp_course_work(struct jp_course *course);

/** Where leg `index` begins. */
struct jp_point jp_course_begin(const struct jp_course *course, unsigned index);

/** Leg `index` begins elsewhere; so the one before it ends there. */
void jp_course_begin_at(struct jp_course *course, unsigned index, const struct jp_point *begin);

/** The margin that a robot has where it stands: 0 or, where its disc overlaps what is blocked, less, down to minus a
 * cell, m. Work: eight looks as jp_course_is_clear(), of a line without length. */
jp_q16 jp_course_room(const struct jp_course *course, const struct jp_point *from);

/** True when the disc, with the leg's margin and what the robot leaves it aside, can be moved from `from` to the end of
 *  leg `index` and beyond. Work: the cells round the line, 64 at a time, and a distance for each blocked one among
 * them. */
bool jp_course_is_clear(const struct jp_course *course, unsigned index, const struct jp_point *from);

#ifdef __cplusplus
}
#endif

#endif
