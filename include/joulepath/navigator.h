/**
 * Drives a robot of any kind to a goal on a map: plans, makes a course of the route, drives it, watches the way ahead
 * while the map changes, brakes before what it cannot pass, and plans anew.
 *
 *   jp_navigator_work()  from the background loop, between the ticks of the robot: a slice of work a call
 *
 *            go            route            course          faces the first leg       last leg
 *   idle ─────▶ planning ───────▶ joining ────────▶ turning ───────────────▶ driving ─────────▶ arrived
 *                 ▲  │                                 ▲                       │  │
 *                 │  └─▶ unreachable, failed           └─── next run ──────────┘  │
 *                 └─────────────── stands ──────── braking ◀── blocked, astray ───┘
 *
 * A course is straight lines with corners between them (course.h). The robot takes a corner in motion where the map has
 * room for what it leaves the lines by, which its vehicle tells; else it stands there and turns on the spot. It plans
 * anew while it brakes. Where the planner's block is too small for a route to the goal, and where a robot on its way
 * would wait longer than `patience` for one, it drives a way of few steps instead (lattice_way.h). The course up to the
 * goal is surveyed before the robot moves, so that what it takes is known: jp_navigator_progress().
 *
 * What the robot sees is on the map where its odometry puts it, and a drift of a decimetre may push a wall onto the
 * goal. Where the goal's cell is blocked on its way, the robot goes to the nearest one from which its disc still covers
 * it. And where no route leads to the goal, or the robot is hemmed in, what it saw before may be where its odometry was
 * then: with memory for that it takes the map as it was, looks round for as long as it would wait for a
 * route, and plans anew; three times on the way to a goal, each time after it has moved.
 *
 * Points are m from the south-west corner of the map. Where the robot's odometry began on the map is told at the start.
 * Integers only: the same bits on every core. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_NAVIGATOR_H
#define JOULEPATH_NAVIGATOR_H

#include <joulepath/course.h>
#include <joulepath/lattice_way.h>
#include <joulepath/reach.h>
#include <joulepath/vehicle.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Legs of a run from stand to stand; a longer one is interrupted. */
#define JP_NAVIGATOR_RUN_MAX 16U

struct jp_navigator_config {
    struct jp_planner *planner;       /**< prepared, on the map */
    const struct jp_vehicle *vehicle; /**< all of whose functions are there */
    jp_q16 radius;                    /**< of the disc in which the robot turns, m; as course.h */
    jp_q16 margin;                    /**< which the robot leaves its trajectory by at most, m; as course.h */
    struct jp_course_leg *legs;       /**< the caller's memory */
    uint16_t legs_max;                /**< at least 1 */
    uint16_t slice;                   /**< expansions of one call; at least 1 */
    uint32_t patience; /**< expansions that a robot on its way waits for a route; four times as many it waits, before it
                            begins, for a better one than the first */
    void *way_block;   /**< jp_navigator_way_size() bytes, in which a way is found, or it is proved that there is none,
                            where the planner finds no route; null: then that is a failure */
    size_t way_size;   /**< of it */
    uint8_t *seen;     /**< jp_navigator_seen_size() bytes, by which what was seen can be forgotten; null: it is not */
    size_t seen_size;  /**< of it */
};

enum jp_navigator_state {
    JP_NAVIGATOR_IDLE,        /**< no goal */
    JP_NAVIGATOR_PLANNING,    /**< searches a route; the robot stands */
    JP_NAVIGATOR_PROVING,     /**< no route was found; looks whether there is any way; the robot stands */
    JP_NAVIGATOR_JOINING,     /**< makes a course of it; the robot stands */
    JP_NAVIGATOR_TURNING,     /**< on the spot, towards the next leg or, at the goal, to its heading */
    JP_NAVIGATOR_DRIVING,     /**< along the course */
    JP_NAVIGATOR_BRAKING,     /**< to a stand, for which it plans anew meanwhile */
    JP_NAVIGATOR_ARRIVED,     /**< stands at the goal or, where that was blocked on the way, over it */
    JP_NAVIGATOR_UNREACHABLE, /**< proved: no route leads to the goal on this map, with what is seen of it */
    JP_NAVIGATOR_FAILED       /**< see the reason */
};

/** Why the state is what it is. */
enum jp_navigator_reason {
    JP_NAVIGATOR_NO_REASON,
    JP_NAVIGATOR_TOLD,      /**< jp_navigator_stop() */
    JP_NAVIGATOR_BLOCKED,   /**< the map changed on the way ahead */
    JP_NAVIGATOR_ASTRAY,    /**< the robot left its course by more than the margin, or was stopped on it */
    JP_NAVIGATOR_HEMMED_IN, /**< no place near the robot has room for it */
    JP_NAVIGATOR_MEMORY,    /**< the planner's block is too small for this map and goal, and no way of unit steps leads
                                 there */
    JP_NAVIGATOR_NO_ROOM,   /**< the course does not fit: JP_COURSE_NO_ROOM */
    JP_NAVIGATOR_TOO_LONG,  /**< more legs than there is memory for */
    JP_NAVIGATOR_VEHICLE,   /**< the robot refused or gave up; `status` says how */
    JP_NAVIGATOR_OFF        /**< its motors are off */
};

/** A place and a heading, from the x axis. */
struct jp_place {
    struct jp_point point;
    jp_angle heading;
};

/** What is left to do. */
struct jp_progress {
    jp_q16 length;             /**< m */
    jp_q16 duration;           /**< s, turns included */
    struct jp_forecast energy; /**< J in the unit of the vehicle's model, with its deviation, as drives have taken it */
};

/** Private: what is looked for. */
enum jp_navigator_search {
    JP_NAVIGATOR_ROUTE,        /**< the planner's */
    JP_NAVIGATOR_FIELD,        /**< nothing: the way along the field is known */
    JP_NAVIGATOR_WAY,          /**< there was no route in time: a way of unit steps */
    JP_NAVIGATOR_ROUTE_OR_WAY, /**< there is a way: a route, until the planner has done what it can */
    JP_NAVIGATOR_PROOF,        /**< there is no such way: that there is none at all */
    JP_NAVIGATOR_ROUTE_ONLY,   /**< there may be one: a route, until the planner has done what it can */
    JP_NAVIGATOR_LOOK_ROUND    /**< nothing yet: what was seen before is forgotten */
};

/** Private: what is done while joining. */
struct jp_navigator_survey {
    uint16_t first; /**< leg of the run */
    uint16_t count; /**< its legs */
    uint16_t done;
    bool has_begun;
};

/** What drives take beyond the forecasts of their first courses, by their stands: turns that are made again, waits,
 * planning, ways round what the map did not show. J in the unit of the vehicle's model. */
struct jp_stand_energy {
    jp_q16 mean;      /**< of a stand */
    jp_q16 deviation; /**< of a single one by itself; 0 or more */
    uint16_t stands;  /**< that it is known by, up to 64; 0: nothing is known yet */
    uint16_t drives;  /**< likewise, up to 15 */
};

/** Private: from its begin to the goal. */
struct jp_navigator_drive {
    jp_q16 forecast; /**< of its first course */
    jp_q16 spent;    /**< before that */
    uint16_t stands; /**< of that; 0: there was none yet */
};

/** Private. */
struct jp_navigator_internal {
    struct jp_course course;
    struct jp_place origin;  /**< of odometry, on the map */
    struct jp_ground ground; /**< as odometry counts */
    struct jp_point stand;   /**< from which was planned last, m */
    struct jp_goal asked;    /**< for */
    struct jp_goal goal;     /**< that it goes to */
    struct jp_navigator_survey survey;
    struct jp_way_cell start;          /**< from which was planned last */
    const struct jp_pose_field *field; /**< along which the goal is gone to, or null */
    struct jp_lattice_way way;
    struct jp_reach reach;
    struct jp_point targets[JP_NAVIGATOR_RUN_MAX]; /**< of the run, as odometry counts */
    uint16_t leg;                                  /**< that is driven or comes next */
    uint16_t run_end;                              /**< leg after the run that is driven */
    uint32_t spent;                                /**< expansions since the search began */
    uint32_t map_seen;                             /**< version of the map when the way ahead was looked at */
    enum jp_navigator_search search;
    uint8_t forgets; /**< on the way to this goal */
    bool has_moved;  /**< since it last knew no more than its map */
    bool has_route;  /**< to the goal, of the planner, from where the robot is */
    jp_q16 duration; /**< of the course, s */
    struct jp_forecast energy;
    struct jp_navigator_drive drive;
    uint8_t turns; /**< on the spot, of this state */
    bool was_told; /**< the vehicle was told to do what the state says */
};

/** The members but `internal` may be read. */
struct jp_navigator {
    struct jp_navigator_config config;
    enum jp_navigator_state state;
    enum jp_navigator_reason reason;
    enum jp_status status; /**< of the vehicle, where it is the reason */
    uint16_t replans;      /**< of this goal, saturating */
    uint8_t forgets;       /**< how often it has forgotten what it saw, wrapping: who sees for it tells all again */
    /** Learned from each drive that arrives; the caller may write what was stored between jp_navigator_init() and the
     * first goal. */
    struct jp_stand_energy stand;
    struct jp_navigator_internal internal;
};

/** Bytes of `way_block` for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_navigator_way_size(const struct jp_terrain_config *config);

/** Bytes of `seen` for a map whose configuration is in range. Constant time. */
size_t jp_navigator_seen_size(const struct jp_terrain_config *map);

/** Prepares a navigator for a robot whose odometry began at `origin`. JP_ERR_CONFIG: *field names the first member that
 *  is null or out of range. JP_ERR_ARGUMENT: a pointer is null. Constant time but for `seen`, all of which is cleared.
 */
enum jp_status jp_navigator_init(struct jp_navigator *navigator, const struct jp_navigator_config *config,
                                 const struct jp_place *origin, const char **field);

/** Goes to the centre of a goal cell, and there turns to the nearest of its headings, if it does not allow all. A robot
 *  that drives brakes first. JP_ERR_STATE: the motors are off. Failures of the goal as
 *  jp_planner_set_goal(). */
enum jp_status jp_navigator_go(struct jp_navigator *navigator, const struct jp_goal *goal);

/** The same to the root of a field that leads to the goal cell (pose_field.h): where the field is finished and reached
 * the robot's pose it need not plan, and leaves once it has stood still for its patience. Where lines along the field
 * have no room it plans as ever. The field must stay until the goal is reached or another is given. Failures as
 * jp_navigator_go(). */
enum jp_status jp_navigator_go_along(struct jp_navigator *navigator, const struct jp_goal *goal,
                                     const struct jp_pose_field *field);

/** Brakes to a stand and forgets the goal. */
void jp_navigator_stop(struct jp_navigator *navigator);

/** Says what is on a cell of the map; the next slice looks whether the way ahead is still clear. As
 *  jp_planner_set_cell(). */
enum jp_status jp_navigator_set_cell(struct jp_navigator *navigator, int32_t x, int32_t y, enum jp_cell cell);

/** A slice of background work: of the vehicle, and one slice of the planner or of what looks for a way, some lines of
 *  the course, or one leg of the survey; while driving, after a change of the map, a look at the legs ahead. Constant
 *  work otherwise, but where it forgets what it saw: then all of `seen`, and jp_planner_set_cell() of each cell of it.
 */
enum jp_navigator_state jp_navigator_work(struct jp_navigator *navigator);

/** Where the robot is on the map, by its odometry. */
struct jp_place jp_navigator_place(const struct jp_navigator *navigator);

/** The legs that are left of the course, from the one that is driven; *count of them. Constant time. */
const struct jp_course_leg *jp_navigator_legs(const struct jp_navigator *navigator, uint16_t *count);

/** What the course takes from where the robot is. JP_ERR_NO_PLAN: there is none yet. Work: the legs, twice,
 *  and two square roots. */
enum jp_status jp_navigator_progress(const struct jp_navigator *navigator, struct jp_progress *progress);

#ifdef __cplusplus
}
#endif

#endif
