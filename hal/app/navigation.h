/**
 * The navigator of a controller on CAN: takes a map, changes of its cells and goals on it in frames, drives to a goal
 * while the operator says so, and tells what it does.
 *
 *   jp_navigation_accept()  each frame of a map, of cells, of a goal, of a round
 *   jp_navigation_drive()   while the operator commands Navigate
 *   jp_navigation_stop()    when he does not
 *   jp_navigation_work()    a slice of work
 *
 * All of it runs in the background. A map is taken while the navigator is not under way, and goals once it is whole. A
 * goal is driven to once; so is a round, whose ids are those of goals: the one that came last counts. Memory is the
 * caller's: hal/app/navigation_memory.h has some.
 */
#ifndef JOULEPATH_HAL_APP_NAVIGATION_H
#define JOULEPATH_HAL_APP_NAVIGATION_H

#include <joulepath/home.h>
#include <joulepath/navigator.h>
#include <joulepath/navigator_body.h>

#include "hal/app/ecu_battery.h"
#include "hal/can/map_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Expansions of a slice: mostly less than a tick of 1 ms of a Cortex-M4 at 168 MHz. */
#define JP_NAVIGATION_SLICE 20U

/** Expansions that the robot on its way waits for a route. */
#define JP_NAVIGATION_PATIENCE 3000U

/** The planner's schedule. */
#define JP_NAVIGATION_EPSILON                                                                                          \
    {                                                                                                                  \
        JP_EPSILON(1.35), JP_EPSILON(1.2), JP_EPSILON(1.1), JP_EPSILON_ONE                                             \
    }

/** Of what the navigator does it tells so often, and of so many legs of its course. */
#define JP_NAVIGATION_REPORT_MS   100U
#define JP_NAVIGATION_REPORT_LEGS 4U

/** Frames of a report: MapStatus, NavigationStatus, NavigationProgress, in turns HomeStatus and HomeBattery, CourseLeg,
 *  and of who goes round RoundStatus and RoundBattery. */
#define JP_NAVIGATION_ROUND_FRAMES 2U
#define JP_NAVIGATION_FRAMES       (4U + JP_NAVIGATION_REPORT_LEGS + JP_NAVIGATION_ROUND_FRAMES)

/** Poses of the way home of a slice. */
#define JP_NAVIGATION_HOME_SLICE 100U

/** The way home, to where the robot was switched on. */
struct jp_navigation_home {
    struct jp_home *home; /**< the caller's memory, as the next three; what drives have taught stays as maps change */
    void *block;          /**< jp_home_size() bytes of the largest map whose way home shall be known, aligned to 8 */
    size_t size;
    struct jp_course_leg *legs;
    uint16_t legs_max;              /**< at least 1 */
    struct jp_ecu_battery *battery; /**< of the ECU */
    jp_q31 confidence;              /**< from which on what is left is told to suffice; ½…0.9999 */
    bool turns_back;                /**< by itself, below that */
};

struct jp_navigation_config {
    const struct jp_lattice *lattice;     /**< of the disc in which the robot turns */
    const struct jp_navigator_body *body; /**< that disc */
    void *map; /**< jp_terrain_size() bytes of the largest map; these three are aligned to 8 */
    size_t map_size;
    void *planner; /**< the planner's block */
    size_t planner_size;
    void *way; /**< jp_navigator_way_size() bytes of the largest map */
    size_t way_size;
    uint8_t *seen; /**< jp_navigator_seen_size() bytes of the largest map */
    size_t seen_size;
    struct jp_course_leg *legs;
    uint16_t legs_max; /**< at least 1 */
    /** NULL: there is no memory for it. All its pointers are there. It must stay. */
    const struct jp_navigation_home *home;
};

/** Values of Answer in NavigationStatus. */
enum jp_goal_answer {
    JP_GOAL_NONE,
    JP_GOAL_TAKEN, /**< waits to be driven to */
    JP_GOAL_NO_MAP,
    JP_GOAL_OTHER_MAP,
    JP_GOAL_OUTSIDE,
    JP_GOAL_BLOCKED, /**< the robot cannot stand there */
    JP_GOAL_DRIVEN,  /**< was given to the navigator, whose state says what becomes of it */
    JP_GOAL_HOME     /**< the robot comes home instead, or found no way home and did not leave */
};

/** Values of HomeState in HomeStatus. */
enum jp_home_told {
    JP_HOME_TOLD_NONE, /**< there is no map, or no home */
    JP_HOME_TOLD_NO_ROOM,
    JP_HOME_TOLD_CLOSED,
    JP_HOME_TOLD_SEEKING,
    JP_HOME_TOLD_NO_WAY,
    JP_HOME_TOLD_UNPOWERED,
    JP_HOME_TOLD_SUFFICES,
    JP_HOME_TOLD_TOO_LITTLE,
    JP_HOME_TOLD_TURNING_BACK
};

/** What is told of the way to a goal. */
struct jp_way_report {
    enum jp_navigator_state state;
    enum jp_navigator_reason reason;
    enum jp_status status; /**< of the robot, where it is the reason */
    uint16_t replans;
    uint8_t forgets;                  /**< how often the map is as it was uploaded again, wrapping */
    struct jp_progress progress;      /**< what is left; all 0 without a way */
    const struct jp_course_leg *legs; /**< that are left, from the one that is driven */
    uint16_t leg_count;               /**< 0: there is no course */
};

/** What a wayfinder that goes round between places of the map does, such as ecu_patrol_round.h; `self` is the finder's.
 */
struct jp_wayfinder_rounds {
    /** Takes a RoundOffer, RoundData or BatteryCharge of the right length; `map`: id of that which is there, 0: none.
     */
    enum jp_e2e_result (*accept)(void *self, const struct jp_can_frame *frame, uint8_t map);
    /** Id of the round that waits to be driven; 0: none does. */
    uint8_t (*ready)(const void *self);
    /** That which waits is forgotten: a goal has come. */
    void (*drop)(void *self);
    /** JP_ERR_STATE: not yet; other failures: it cannot be driven. */
    enum jp_status (*begin)(void *self);
    void (*tell)(const void *self, struct jp_can_frame frames[JP_NAVIGATION_ROUND_FRAMES]);
};

/** What finds the way on a map and has it driven: the navigator on a lattice (navigator.h), or what a kind of robot has
 *  of its own, such as ecu_patrol.h. `self` is handed to each function. */
struct jp_wayfinder {
    void *self;
    /** For a map that has just become whole, and where on it the robot was switched on; both stay. */
    enum jp_status (*prepare)(void *self, struct jp_terrain *map, const struct jp_place *origin);
    /** The map goes. */
    void (*forget)(void *self);

    /* These with a map. */

    bool (*is_under_way)(const void *self);
    /** What another sensor sees on a cell. */
    void (*see)(void *self, int32_t x, int32_t y, enum jp_cell cell);
    /** Whether the robot can stand at a goal that is on the map. */
    bool (*can_stand)(const void *self, const struct jp_map_goal *goal);
    /** JP_ERR_STATE: not yet; other failures: it cannot be driven to. */
    enum jp_status (*go)(void *self, const struct jp_map_goal *goal);
    void (*stop)(void *self);
    /** A slice; true: there is a new course. */
    bool (*work)(void *self);
    void (*tell)(const void *self, struct jp_way_report *report);

    /** NULL: it does not go round between places. */
    const struct jp_wayfinder_rounds *rounds;
};

/** The members but `maps` and `navigator` are private, and those may only be read. */
struct jp_navigation {
    struct jp_wayfinder finder;
    struct jp_navigation_config config;
    struct jp_map_link maps;
    struct jp_navigator navigator; /**< holds once there is a map, where it finds the way */
    struct jp_planner planner;
    struct jp_vehicle vehicle;
    int32_t unit_exponent;
    bool is_prepared;           /* for the map */
    enum jp_status home_status; /* of the home of the map */
    struct jp_map_goal goal;    /* or the round of this id */
    bool is_round;
    enum jp_goal_answer answer;
    uint8_t course;     /* number of the last one */
    uint8_t leg_told;   /* legs after the one that was told last */
    uint32_t told_tick; /* of the last report */
    bool told_home;     /* HomeStatus was in it, not HomeBattery */
    struct jp_can_frame frames[JP_NAVIGATION_FRAMES];
    uint8_t frames_left; /* to be sent by the tick; the background writes them while it is 0 */
};

/** Prepares a navigator without a map for a vehicle, whose energies are in 2^unit_exponent J (energy.h). What the
 *  pointers show must stay, but for *vehicle. JP_ERR_CONFIG: *field names the first member of the configuration that is
 *  null or out of range. JP_ERR_ARGUMENT: a pointer is null. */
enum jp_status jp_navigation_init(struct jp_navigation *navigation, const struct jp_navigation_config *config,
                                  const struct jp_vehicle *vehicle, int32_t unit_exponent, const char **field);

/** The same with another wayfinder, whose energies are in J; of maps in this room. JP_ERR_ARGUMENT: a pointer is null.
 */
enum jp_status jp_navigation_init_with(struct jp_navigation *navigation, const struct jp_wayfinder *finder,
                                       const struct jp_map_room *room);

/** Whether it takes frames of rounds. */
bool jp_navigation_goes_round(const struct jp_navigation *navigation);

/** Takes a MapOffer, MapData, CellChanges or MapGoal of the right length; of who goes round also a RoundOffer,
 * RoundData or BatteryCharge. Work: cells that change, each as jp_navigator_set_cell(). */
enum jp_e2e_result jp_navigation_accept(struct jp_navigation *navigation, const struct jp_can_frame *frame);

/** Drives to the goal of this id, or the round, if it waits to be driven; true when it now does. */
bool jp_navigation_drive(struct jp_navigation *navigation, uint8_t goal);

/** It plans or drives. */
bool jp_navigation_is_under_way(const struct jp_navigation *navigation);

/** Brakes to a stand, if it is under way, and forgets the goal. */
void jp_navigation_stop(struct jp_navigation *navigation);

/** A slice: of the map, and of navigator and pilot. False: there is no map, and the pilot's work is left to the caller.
 *  `tick` counts at `tick_rate`, Hz. */
bool jp_navigation_work(struct jp_navigation *navigation, uint32_t tick, uint32_t tick_rate);

/** The next frame of its report, for the control interrupt; false: none is due. Constant time. */
bool jp_navigation_take_frame(struct jp_navigation *navigation, struct jp_can_frame *frame);

#ifdef __cplusplus
}
#endif

#endif
