/**
 * Brings a robot with four steered wheels to a goal on a map: plans a path, has it driven by the patrol (patrol.h),
 * checks whether the goal can be reached as planned, and plans anew where the path is blocked.
 *
 *   IDLE ─start─▶ PLANNING ◀─▶ UNDER_WAY ─▶ ARRIVED
 *                     │            │
 *                     └────────────┴──────▶ GIVEN_UP
 *
 * Paths are the any-angle planner's (grid_planner.h), smoothed (path_spline.h): those of the least price, in which a
 * metre costs what it takes the robot to drive, with time and clearance at the prices of the band (teb.h), and which
 * keep 0.10 m where there is such a path, else 0.05 m or 0.02 m; or by length, the shortest with the widest clearance
 * that has one, from 0.15 m on. As far as there is room, twice the standard deviation of the robot's position comes on
 * top of it. What the scanner sees is marked on a copy of the map. Where there is no room to turn at the goal, the
 * robot turns at a place before it and drives straight in; when scans show this only during the drive, it stops and
 * plans again. A patrol that waits or has stopped because its path is blocked gets another path after a while, up to
 * six times about the same place; marks that leave none are forgotten, three times at most. A robot that was lost and
 * has found itself gets one from there, over the map as it was given: marks were made elsewhere. One that has stood for
 * people for a while gets one around where they have walked lately, if that is longer by no more than it has waited.
 *
 * One call of jp_patrol_mission_cycle() in place of jp_patrol_cycle(), and in the time between them some of
 * jp_patrol_mission_work(), which plans, and marks on the map what scans show. Not for ISRs. Single-precision floating
 * point: part of libjoulepath_float.
 */
#ifndef JOULEPATH_PATROL_MISSION_H
#define JOULEPATH_PATROL_MISSION_H

#include <joulepath/grid_planner.h>
#include <joulepath/patrol.h>

#ifdef __cplusplus
extern "C" {
#endif

enum jp_patrol_mission_state {
    JP_MISSION_IDLE,
    JP_MISSION_PLANNING, /**< a path is looked for; what is driven meanwhile is the patrol's state */
    JP_MISSION_UNDER_WAY,
    JP_MISSION_ARRIVED,
    JP_MISSION_GIVEN_UP /**< no path, or the patrol has stopped: its reason says why, JP_PATROL_NONE for no path */
};

struct jp_patrol_mission_config {
    struct jp_patrol_config
        patrol; /**< its footprint with 0.15 m around it at most 60 cells from the centre to a corner */
    const struct jp_terrain *map; /**< what is known before; must outlive the mission and not change */
    const struct jp_four_wheel_energy_model *energy; /**< by which paths are priced; null: they are planned by length.
                                                          Read for each path: it may be learned meanwhile */
    bool turns_before_goal;                          /**< where it cannot turn at the goal; only with turns_in_place */
    uint16_t points_max;                             /**< of a path, which has one every 0.1 m; 2 or more */
    uint16_t turns_max; /**< turning points of the grid planner's path, its ends included; 2 or more */
};

/** Destination of the present path. Private. */
enum jp_patrol_leg {
    JP_LEG_GOAL,
    JP_LEG_APPROACH, /* to where the robot turns into the goal */
    JP_LEG_LAST,     /* from there straight into it */
    JP_LEG_PAUSE     /* to a halt, to plan anew */
};

/** What the marks of a scan are made for. Private. */
enum jp_patrol_marks {
    JP_MARKS_NONE,
    JP_MARKS_WATCH, /* to see whether the robot can turn at the goal */
    JP_MARKS_PLAN,
    JP_MARKS_DETOUR
};

/** Private. */
struct jp_patrol_mission_internal {
    struct jp_plane_pose goal;
    struct jp_terrain marked;
    struct jp_grid_planner grid;
    void *grid_block;
    size_t grid_size;
    struct jp_point *paths[2]; /**< the one that is driven, and the one that is made */
    void *scratch;
    enum jp_patrol_leg leg;
    bool is_searching; /**< the grid planner is at work */
    uint8_t trial;     /**< of the clearances to try */
    bool is_beside;    /**< the search began in a cell beside the robot */
    uint8_t beside;    /**< such cells from which no path leads */
    struct jp_plane_pose target;
    uint16_t waited;            /**< cycles without a free path */
    uint8_t tries;              /**< to get on from about the same place */
    uint8_t forgets;            /**< of what scans have marked */
    bool is_closed;             /**< the last search found no path */
    struct jp_plane_pose tried; /**< where the first of the tries was */
    bool is_detour;             /**< a path around where people walk is looked for */
    float detour_clearance;     /**< of it from there, m */
    float detour_due;           /**< after so much standing for people, s */
    bool is_watch_due;
    uint16_t rows_stale;        /**< of the marked map, from the south: what is marked on them is to be forgotten */
    enum jp_patrol_marks marks; /**< being made */
    struct jp_scan scan;        /**< of them; no ranges: there is nothing to mark */
    struct jp_plane_pose scanner;
    uint16_t beam; /**< the next */
};

/** The members but `internal` may be read. */
struct jp_patrol_mission {
    struct jp_patrol_mission_config config;
    struct jp_patrol patrol;
    enum jp_patrol_mission_state state; /**< of the last call */
    unsigned replans;                   /**< paths since the start that were given because the one before was blocked */
    const struct jp_point *path;        /**< the last that was found, smoothed; where it leads is the patrol's matter */
    uint16_t path_count;                /**< its points; 0 before the first */
    float price; /**< of it before it was smoothed, J; 0: it was planned by length, or leads straight on */
    struct jp_grid_counts counts; /**< of the search that found it */
    struct jp_patrol_mission_internal internal;
};

/** Bytes of the block: the grid planner's, the map's copy, 16 for each of points_max and 140 for each of turns_max. 0:
 *  the map is out of the planner's range. Constant time. */
size_t jp_patrol_mission_size(const struct jp_patrol_mission_config *config);

/** Checks the configuration and prepares in `size` bytes of the caller; the patrol then wants a pose. JP_ERR_CONFIG:
 *  *field names the first field out of range, without "patrol."; "energy": no robot has such prices. JP_ERR_MEMORY,
 * JP_ERR_ALIGNMENT: the block. JP_ERR_ARGUMENT: a null pointer. Work: the cells of the map. */
enum jp_status jp_patrol_mission_init(struct jp_patrol_mission *mission, const struct jp_patrol_mission_config *config,
                                      void *block, size_t size, const char **field);

/** Begins anew, from where the patrol is to a goal. Marks of scans stay. JP_ERR_ARGUMENT: a null pointer or a pose out
 * of range; then nothing changes. */
enum jp_status jp_patrol_mission_start(struct jp_patrol_mission *mission, const struct jp_plane_pose *goal);

/** Forgets what scans have marked: who stood there may have gone. JP_ERR_ARGUMENT: a null pointer. JP_ERR_STATE: the
 *  state is PLANNING. Work: the cells of the map. */
enum jp_status jp_patrol_mission_forget_marks(struct jp_patrol_mission *mission);

/** Stops as fast as the wheels can and forgets the goal: IDLE. Constant time. */
void jp_patrol_mission_stop(struct jp_patrol_mission *mission);

/** Continues planning, and marking what the last scan shows, whose ranges must stay until the next cycle: for at most
 * so many expansions (grid_planner.h), of which the cells along a beam count as four, and 64 cells whose marks are
 * forgotten as one; or for one smoothing of a path (path_spline.h) or one search for a place to turn, which reads 36
 * times the cells under the robot for each of up to 21 places. */
enum jp_patrol_mission_state jp_patrol_mission_work(struct jp_patrol_mission *mission, unsigned expansions);

/** One cycle of the patrol; what replanning it requires is left to jp_patrol_mission_work(). Failures and work are
 *  those of jp_patrol_cycle(). */
enum jp_status jp_patrol_mission_cycle(struct jp_patrol_mission *mission, const struct jp_patrol_input *input,
                                       struct jp_twist *twist);

/** Turning points of the last path that the grid planner found, before it was smoothed; null and 0 without one. They
 *  stay until the state is PLANNING again. Constant time. */
const struct jp_point *jp_patrol_mission_grid_path(const struct jp_patrol_mission *mission, size_t *count);

#ifdef __cplusplus
}
#endif

#endif
