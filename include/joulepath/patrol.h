/**
 * Drives a robot with four steered wheels along a path: turns in place first, then follows a timed elastic band
 * (teb.h), turns to the goal's heading, and stops when obstacles, sensors or wheels require it.
 *
 *   HELD ─path─▶ TURNING ◀─▶ DRIVING ─▶ TURNING ─▶ ARRIVED
 *                   │  ▲        │ ▲
 *                   ▼  │        ▼ │
 *                  WAITING (stopped: the obstacle may leave) ─▶ STOPPED (gave up; the reason says why)
 *
 * Where there is no room to turn, the robot is first STEPPING: with its wheels across, straight to a place with room;
 * or, by cost, along its path with the heading that it has, such as backwards out of an aisle, until there is room.
 *
 * With four steered wheels it can also turn while it drives: GLIDING it follows the path at once and turns on the way,
 * to the path's direction or to the goal's heading; its wheels then lead it askew. Whether it turns first, glides, or
 * steps to a near goal, sideways or backwards, is chosen by what each takes (struct jp_patrol_price), where the sweep
 * is free; or, by the strategy of the paper that this behaviour follows, it always turns in place first beyond a fixed
 * angle. It drives no faster than it can stop on its curve.
 *
 * It yields to people: to who walks, or has walked and may walk on or back. Their places are foreseen, and it goes on
 * no faster than it can without coming near them (struct jp_patrol_people). Towards anything it drives no faster than
 * it can stop 0.1 m before it. Where its band leads nearer than that it turns in place, or steps to where it can, or,
 * where neither is free, creeps; what it passes at the same distance does not slow it.
 *
 * One call of jp_patrol_cycle() a cycle, 5…20 a second, outside interrupts; its twist goes to jp_four_wheel_tick() in
 * the control tick. In HELD, WAITING, ARRIVED and STOPPED the twist is 0: the wheels stop and keep their angles. A path
 * is driven once: WAITING ends by itself, STOPPED only by a new path.
 *
 * Single-precision floating point: part of libjoulepath_float.
 */
#ifndef JOULEPATH_PATROL_H
#define JOULEPATH_PATROL_H

#include <joulepath/four_wheel.h>
#include <joulepath/localiser.h>
#include <joulepath/movers.h>
#include <joulepath/teb.h>

#ifdef __cplusplus
extern "C" {
#endif

enum jp_patrol_state {
    JP_PATROL_HELD,
    JP_PATROL_TURNING,
    JP_PATROL_DRIVING,
    JP_PATROL_STEPPING,
    JP_PATROL_GLIDING,
    JP_PATROL_WAITING,
    JP_PATROL_ARRIVED,
    JP_PATROL_STOPPED
};

/** Why the robot waits or has stopped. */
enum jp_patrol_reason {
    JP_PATROL_NONE,
    JP_PATROL_IN_COLLISION, /**< an obstacle overlaps the footprint */
    JP_PATROL_BLOCKED,      /**< no band keeps off the obstacles, or there is no room to turn in place: plan anew */
    JP_PATROL_NO_SCAN,      /**< too many scans in a row dropped out */
    JP_PATROL_LOST,         /**< the laser's pose jumped, or was missing, too long */
    JP_PATROL_OFF_PATH,     /**< the robot is farther from its path than the horizon */
    JP_PATROL_STALLED,      /**< the wheels do not bring the robot on */
    JP_PATROL_INFEASIBLE    /**< the wheels cannot do what was asked */
};

/** How the robot turns to its path. */
enum {
    JP_PATROL_FIXED_ANGLE, /**< in place, beyond turn_first */
    JP_PATROL_BY_COST      /**< the cheapest way that is free, beyond turn_first too */
};

/** What ways to turn differ by. */
struct jp_patrol_price {
    float second;   /**< power of the electronics, and what a second less is worth, W; above 0 */
    float worth;    /**< the latter alone, W; 0…1 024 */
    float turning;  /**< of turning in place, J/rad; 0 or more */
    float steering; /**< of steering all wheels at a stand, without the time that it takes, J/rad; 0 or more */
};

/** How people who walk, or have walked and may walk on, are reckoned with. */
struct jp_patrol_people {
    float clearance;    /**< that the robot keeps from where they may be, m; 0 or more */
    float braking;      /**< at which the robot brakes for them, m/s²; above 0 */
    float acceleration; /**< at which they start and stop, m/s²; above 0 */
    float rest;         /**< for which the robot has stood when somebody can reach it, s; 0 or more */
    float stays;        /**< who has stood for so long stays, s; 0 or more */
};

struct jp_patrol_config {
    struct jp_four_wheel_config wheels; /**< of the control tick */
    struct jp_teb_config teb;           /**< weights 0 for odometry and no_reversing: the plain TEB */
    struct jp_scan_config scan;
    struct jp_movers_config movers;
    struct jp_patrol_people people;
    bool turns_in_place; /**< false: the plain TEB, which turns as it drives */
    uint8_t strategy;    /**< JP_PATROL_FIXED_ANGLE or JP_PATROL_BY_COST, where it turns in place */
    struct jp_patrol_price price;
    float glide_clearance;    /**< of the footprint from obstacles while it glides, m; 0 or more */
    float turn_first;         /**< heading error beyond which the robot turns in place before it drives, rad: 30° */
    float turn_rate;          /**< in place, rad/s */
    float turn_acceleration;  /**< in place, rad/s² */
    float steering_rate;      /**< of a wheel at a stand, rad/s */
    float turn_clearance;     /**< of the footprint from obstacles in a turn in place or a step, m; 0 or more */
    float step_speed;         /**< with the wheels across, m/s */
    float horizon;            /**< length of the path that is planned at a time, m */
    float position_tolerance; /**< of the goal, m */
    float heading_tolerance;  /**< of the goal and of turns, rad */
    float period;             /**< of a cycle, s */
    float latency;            /**< from the pose of a cycle to wheels that do what was decided, s; 0…1 */
    float jump;               /**< largest step of the laser's pose away from the prediction, m; the heading: rad */
    uint16_t waits_max;       /**< cycles to wait before giving up; 1…10 000 */
    uint16_t dropouts_max;    /**< scans that may be missing, and poses that may jump, in a row; at most 10 000 */
    float blind_max;          /**< distance driven by wheel odometry alone, without a pose of the laser, m */
};

/** What is known in a cycle. */
struct jp_patrol_input {
    struct jp_plane_pose wheels; /**< integrated from the wheels since the path was given, in any frame */
    struct jp_plane_speed speed; /**< as the wheels say */
    struct jp_plane_pose laser;  /**< in the map's frame */
    bool has_laser;              /**< false: the match failed or dropped out */
    float deviation;             /**< standard deviation of the position on the map, m; 0 or more */
    bool is_lost;                /**< its place on the map is not known: the robot stands until it is */
    bool is_new_place;           /**< the laser's pose is to be taken as it is, however far from the last one */
    struct jp_scan scan;         /**< ranges may be null: dropped out */
    struct jp_plane_pose sensor; /**< of the scanner on the robot */
};

struct jp_patrol_goal {
    struct jp_plane_pose pose;
    bool is_heading_free;
};

struct jp_patrol_counts {
    uint32_t cycles;
    uint32_t turns;      /**< in place, begun */
    uint32_t glides;     /**< begun */
    uint32_t steps;      /**< to where there is room to turn, begun */
    uint32_t waits;      /**< begun */
    uint32_t yields;     /**< to people, begun: slowing down or standing for them */
    uint32_t infeasible; /**< cycles in which no band or turn could be driven */
    uint32_t laser_missing;
    uint32_t laser_rejected; /**< jumps */
    uint32_t scans_missing;
    uint32_t shapes_dropped; /**< obstacles that did not fit */
};

/** Places where people have walked lately that are remembered: those of a dozen who walk to and fro. */
#define JP_PATROL_TRODDEN_MAX 256U

/** Private. */
struct jp_patrol_trodden {
    struct jp_plane_point place;
    float radius; /**< of who walked there, m; 0: nobody */
    float age;    /**< s */
};

/** Private. */
struct jp_patrol_internal {
    const struct jp_point *path;
    uint16_t path_count;
    uint16_t path_next; /**< point that the robot has not passed */
    struct jp_patrol_goal goal;
    struct jp_plane_pose wheels; /**< of the last cycle */
    bool has_wheels;
    bool is_measured;           /**< the laser's pose of this cycle is to be trusted */
    struct jp_plane_pose laser; /**< that pose */
    float deviation;            /**< of the position on the map, m */
    struct jp_plane_speed command;
    float sideways; /**< of the command: a step to the left, m/s */
    float turn_target;
    float turn_remaining; /**< rad; beyond half a turn when it goes round the longer side */
    struct jp_plane_point step_target;
    bool turns_after_step;   /**< to turn_target, for which the step made room */
    float step_clearance;    /**< with which the way there was found, m */
    float glide_heading;     /**< at which a glide ends */
    float glide_least;       /**< clearance that it keeps, m */
    bool is_setting_off;     /**< the glide began at a stand, at step_target */
    bool is_gliding_to_goal; /**< it ends at the goal */
    bool is_arriving;        /**< at the goal: only the standstill and the turn are left */
    uint16_t waited;
    uint16_t free_cycles; /**< in a row with a free path while waiting */
    bool is_making_room;  /**< it brakes to */
    uint16_t room_next;   /**< path_next when it last did */
    uint8_t rooms;        /**< made since it last left such a place behind */
    uint8_t tries;        /**< to drive on after waiting, since the robot last made progress */
    uint16_t jumps;       /**< of the laser's pose, in a row */
    float blind;          /**< distance since its last good one, m */
    uint16_t scan_gap;
    bool is_yielding;      /**< to people */
    float sideways_before; /**< of the last cycle's command, m/s */
    uint16_t unmoved;      /**< cycles since the robot last made progress */
    uint16_t still;        /**< in a row in which robot and band stood */
    float yielded;         /**< that it has stood for people, less what it drove since, s */
    struct jp_patrol_trodden trodden[JP_PATROL_TRODDEN_MAX];
};

/** The members but `internal` may be read. */
struct jp_patrol {
    struct jp_patrol_config config;
    struct jp_teb teb;             /**< its band may be shown */
    struct jp_obstacles obstacles; /**< of the last scan */
    struct jp_movers movers;       /**< among them */
    enum jp_patrol_state state;    /**< of the last cycle */
    enum jp_patrol_reason reason;  /**< of the last cycle; JP_PATROL_NONE but where it waits or has stopped */
    struct jp_plane_pose pose;     /**< of the last cycle, in the map's frame */
    struct jp_patrol_counts counts;
    struct jp_teb_result band; /**< of the last cycle that drove */
    struct jp_patrol_internal internal;
};

/** Checks the configuration and starts in HELD. JP_ERR_CONFIG: *field names the first field out of range.
 * JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_patrol_init(struct jp_patrol *patrol, const struct jp_patrol_config *config, const char **field);

/** Sets the robot's pose in the map's frame: before the first path, and when a better pose than that of odometry is
 *  known. The band is forgotten. JP_ERR_ARGUMENT: a null pointer or a pose out of range. Constant time. */
enum jp_status jp_patrol_set_pose(struct jp_patrol *patrol, const struct jp_plane_pose *pose);

/** Drives along a path of at least two points to the goal; the points must outlive the drive. JP_ERR_ARGUMENT: a null
 *  pointer, too few points, a goal out of range, or an end farther than the position tolerance from the goal; the old
 *  path stays then. Constant time. */
enum jp_status jp_patrol_follow(struct jp_patrol *patrol, const struct jp_point *path, uint16_t count,
                                const struct jp_patrol_goal *goal);

/** Where the robot is by a localiser: takes the wheels, the scan and its sensor of `input` and sets the other members
 * of it but the speed. Failures and work are those of jp_localiser_update(); then the robot is lost. */
enum jp_status jp_patrol_locate(struct jp_localiser *localiser, struct jp_patrol_input *input);

/** Stops soon, on the path: a point of it shortly ahead becomes the goal, with any heading, and the state ARRIVED
 * there. While the robot does not drive, as jp_patrol_hold(). Work: points of the path within the stopping distance. */
void jp_patrol_pause(struct jp_patrol *patrol);

/** Stops as fast as the wheels can, with their angles kept, and forgets the path: HELD. Constant time. */
void jp_patrol_hold(struct jp_patrol *patrol);

/** One cycle. *twist is 0 unless the state is TURNING, DRIVING, STEPPING or GLIDING. JP_ERR_ARGUMENT: a null pointer or
 * a value that is not finite: the twist is 0 and the state STOPPED. */
enum jp_status jp_patrol_cycle(struct jp_patrol *patrol, const struct jp_patrol_input *input, struct jp_twist *twist);

#ifdef __cplusplus
}
#endif

#endif
