/**
 * Drives a robot with four steered wheels over a map: joins the control tick (four_wheel_robot.h), the laser scanner,
 * the localiser, the patrol with its planner (patrol_mission.h) and what legs take (patrol_ledger.h).
 *
 *   jp_patrol_pilot_take_map()  the map, and where on it odometry began
 *   jp_patrol_pilot_go()        a goal; or _follow(), one after the other
 *   jp_patrol_pilot_see()       each scan
 *   jp_patrol_pilot_work()      from the background loop, at least once in each tick
 *
 * A cycle of the patrol comes with each scan; without one, as soon as it is late. The twist of a cycle is handed to the
 * tick, which lets it lapse unless it is renewed (twist_ticks).
 *
 * Single-precision floating point: part of libjoulepath_float. One context; not for ISRs.
 */
#ifndef JOULEPATH_PATROL_PILOT_H
#define JOULEPATH_PATROL_PILOT_H

#include <joulepath/four_wheel_robot.h>
#include <joulepath/patrol_ledger.h>
#include <joulepath/patrol_mission.h>
#include <joulepath/patrol_scanner.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Work of the mission in a call of jp_patrol_pilot_work(), and of the localiser's search, expansions and nodes. */
#define JP_PATROL_PILOT_EXPANSIONS 200U
#define JP_PATROL_PILOT_NODES      700U

/** Goals of a route. */
#define JP_PATROL_PILOT_GOALS 32U

struct jp_patrol_pilot_config {
    const struct jp_patrol_config *patrol;
    const struct jp_localiser_config *localiser; /**< its map is not used */
    const struct jp_patrol_scanner *scanner;
    const struct jp_four_wheel_energy_model *energy;
    const struct jp_factor_learning *learning;
    uint16_t points_max; /**< as patrol_mission.h */
    uint16_t turns_max;
};

/** The members but `internal` may be read; mission and localiser hold once there is a map. */
struct jp_patrol_pilot {
    struct jp_patrol_mission mission;
    struct jp_localiser localiser;
    struct jp_patrol_ledger ledger;
    bool has_map;
    struct {
        struct jp_patrol_pilot_config config;
        struct jp_four_wheel_robot *robot;
        struct jp_plane_pose origin;            /* of odometry on the map */
        struct jp_four_wheel_odometry odometry; /* as last seen */
        const float *ranges;                    /* of a scan that was not used yet, or null */
        struct jp_plane_pose wheels;            /* where they were when it was taken */
        uint32_t cycle_tick;                    /* of the last cycle */
        uint32_t cycle_ticks;                   /* from one to the next without a scan */
        struct jp_plane_pose goals[JP_PATROL_PILOT_GOALS];
        uint16_t goal_count;
        uint16_t goal_next;
        bool is_search_due; /* for its place, else the mission's work */
        bool is_planned;    /* the leg was begun in the ledger */
        bool is_ended;      /* it arrived; the stretch that ends it is still to come */
        struct jp_plane_pose survey_start;
        struct jp_patrol_leg_forecast survey;
        enum jp_status survey_status;
    } internal;
};

/** Prepares a pilot without a map. JP_ERR_ARGUMENT: a pointer is null. JP_ERR_CONFIG: *field names the first field of
 *  patrol, energy, learning or scanner out of range. What the pointers show must stay. */
enum jp_status jp_patrol_pilot_init(struct jp_patrol_pilot *pilot, const struct jp_patrol_pilot_config *config,
                                    struct jp_four_wheel_robot *robot, const char **field);

/** Bytes of the block for a map: jp_patrol_mission_size() and jp_localiser_size(). 0: the map is out of range. */
size_t jp_patrol_pilot_size(const struct jp_patrol_pilot *pilot, const struct jp_terrain *map);

/** Takes a map, on which odometry began at `origin`, while it has no goal. Failures as jp_patrol_mission_init() and
 *  jp_localiser_init(); then there is none. JP_ERR_ARGUMENT: also an origin out of range. The map must outlive the
 * pilot and not change. Work: the cells of the map, each at most 30 times. */
enum jp_status jp_patrol_pilot_take_map(struct jp_patrol_pilot *pilot, const struct jp_terrain *map,
                                        const struct jp_plane_pose *origin, void *block, size_t size,
                                        const char **field);

/** There is no map any more; a robot that drives stops. */
void jp_patrol_pilot_forget_map(struct jp_patrol_pilot *pilot);

/** Goes to a pose on the map, in place of what was asked before. JP_ERR_NO_PLAN: there is no map. JP_ERR_STATE: the
 *  drives are off. JP_ERR_OUTSIDE: the goal is not on the map. JP_ERR_BLOCKED: by the map the robot cannot stand there.
 *  JP_ERR_ARGUMENT: a null pointer or a pose out of range. Then nothing changes. Work: the cells under the robot. */
enum jp_status jp_patrol_pilot_go(struct jp_patrol_pilot *pilot, const struct jp_plane_pose *goal);

/** Goes to points one after the other, as odometry counts them, and arrives at each along the line from the one before.
 *  Failures as jp_patrol_pilot_go(), for the first that has one; JP_ERR_ARGUMENT: not 1…JP_PATROL_PILOT_GOALS. */
enum jp_status jp_patrol_pilot_follow(struct jp_patrol_pilot *pilot, const struct jp_point *points, uint16_t count);

/** Looks for the way from a pose on the map to another one, of a robot that has no goal, to foretell what it takes: the
 *  robot stands meanwhile. Failures as jp_patrol_pilot_go(), but of the drives; JP_ERR_STATE: it has a goal. */
enum jp_status jp_patrol_pilot_survey(struct jp_patrol_pilot *pilot, const struct jp_plane_pose *from,
                                      const struct jp_plane_pose *to);

/** Of the last survey. JP_WORKING: call jp_patrol_pilot_work(). JP_ERR_NO_PLAN: no way was found, or nothing was asked.
 *  *forecast is written with JP_OK. */
enum jp_status jp_patrol_pilot_surveyed(const struct jp_patrol_pilot *pilot, struct jp_patrol_leg_forecast *forecast);

/** Whether the robot's footprint is free on the map at a pose. Work: the cells under it. */
bool jp_patrol_pilot_can_stand(const struct jp_patrol_pilot *pilot, const struct jp_plane_pose *pose);

/** Forgets what scans have marked on the map. JP_ERR_ARGUMENT: a null pointer. JP_ERR_NO_PLAN: there is no map.
 *  JP_ERR_STATE: it plans. Work: the cells of the map. */
enum jp_status jp_patrol_pilot_forget_marks(struct jp_patrol_pilot *pilot);

/** Stops as fast as the wheels can and forgets the goals. */
void jp_patrol_pilot_stop(struct jp_patrol_pilot *pilot);

/** A scan, of the scanner's beams as struct jp_scan has ranges, which stays until the next; and where the wheels were
 *  when it was taken. Constant time. */
void jp_patrol_pilot_see(struct jp_patrol_pilot *pilot, const float *ranges,
                         const struct jp_four_wheel_odometry *odometry);

/** A slice of work: a cycle if it is due; else in turns a part of jp_patrol_mission_work() and, for a robot whose place
 * is not known for sure, of the search for it. Work: a cycle is jp_localiser_update() and jp_patrol_mission_cycle(),
 * with at most 3 million instructions of its band; the worst slice on a Cortex-M7 over drives among people, round boxes
 * that the map does not show and lost took 2.6 million with a cycle and 2.0 million without. What is not bounded by
 * that grows with the path (its smoothing, and its forecast) and with the places at which there may be room to turn
 * (patrol_mission.h).
 */
void jp_patrol_pilot_work(struct jp_patrol_pilot *pilot);

/** It plans or drives. */
bool jp_patrol_pilot_is_under_way(const struct jp_patrol_pilot *pilot);

/** Goals that were reached since the last go or follow; and of how many. */
uint16_t jp_patrol_pilot_reached(const struct jp_patrol_pilot *pilot, uint16_t *of);

/** Where the robot is on the map. */
struct jp_plane_pose jp_patrol_pilot_pose(const struct jp_patrol_pilot *pilot);

/** Of the goal that it drives to: metres of the path that are left, and what they take by the forecast. JP_ERR_NO_PLAN:
 *  there is none. Work: points of the path. */
enum jp_status jp_patrol_pilot_progress(const struct jp_patrol_pilot *pilot, float *length,
                                        struct jp_patrol_leg_forecast *left);

#ifdef __cplusplus
}
#endif

#endif
