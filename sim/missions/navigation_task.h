/** A drive of a navigator in a simulated world: what it is asked, what comes of it, what can be looked at meanwhile. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_TASK_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_TASK_H

#include <joulepath/home.h>

#include "sim/base/clearance.h"
#include "sim/files/map_file.h"
#include "sim/missions/navigation_pack.h"

/** A cell that the sensor has seen to be otherwise than the map says. */
struct navigation_sight {
    int x;
    int y;
    double seconds;
};

/** Most legs of a course. */
#define NAVIGATION_LEGS 96

/** Ends of a course's legs, m from the south-west corner of the map. */
struct navigation_course {
    struct jp_point ends[NAVIGATION_LEGS];
    uint16_t count;
};

/** Something to look at, 20 times a second and at the end. */
struct navigation_frame {
    double seconds;
    struct clearance_pose pose; /**< true */
    double joules;              /**< spent since it was told where to go */
    enum jp_navigator_state state;
    enum jp_navigator_reason reason;
    unsigned replans;
    double left_m;
    double left_s;
    double probability;                         /**< that it comes home; NaN: nobody asks, or it is not known */
    const struct navigation_course *new_course; /**< begun since the frame before; NULL: none */
};

/** What is in the battery of a robot that comes back to where it began: J of the energy that the vehicle's model
 * counts. */
struct navigation_battery {
    double joules;                   /**< truly */
    double believed;                 /**< by the battery's own estimate, */
    double deviation;                /**< which states this deviation */
    struct navigation_pack *pack;    /**< NULL: the above; else cells with a charge, which navigation_run() starts */
    double confidence;               /**< with which the robot shall come home; below it it turns back; 0: never */
    struct jp_home_learned *learned; /**< what it has learned of drives, kept; NULL: a new robot's */
    /** Of each cell, row by row from the south, before the robot leaves: how probably it goes there and comes home, %;
     * −1: no way leads there. NULL: nobody asks. */
    int8_t *reach;
    /** When all is known that can be before it leaves: what the way to the goal and home takes by the return map, J;
     * NULL: nobody asks. May change what is in the battery. */
    void (*leave)(void *context, struct navigation_battery *battery, double joules, double deviation);
    void *context;
};

struct navigation_task {
    const struct jp_lattice *lattice;
    struct jp_terrain *map;           /**< that the robot has; it learns what it sees */
    const struct jp_terrain *world;   /**< as it is, with what is too steep for the robot */
    const struct jp_terrain *solid;   /**< what can be touched of it */
    const struct map_ground *grounds; /**< what the classes of the world are like; NULL: as the robot file says */
    struct jp_lattice_pose start;
    struct jp_goal goal;
    double view_m;   /**< how far the sensor sees, where nothing is in between */
    size_t memory;   /**< of the planner, bytes */
    double patience; /**< simulated seconds after which the drive is given up */
    uint64_t seed;
    struct navigation_battery *battery; /**< NULL: it stays at the goal, and its battery lasts */
    /** Either may be NULL. */
    void (*watch)(void *context, const struct navigation_frame *frame);
    void (*see)(void *context, const struct navigation_sight *sight);
    void *context;
};

struct navigation_result {
    enum jp_navigator_state state; /**< at the end */
    enum jp_navigator_reason reason;
    enum jp_status status;
    unsigned replans;
    unsigned seen;   /**< cells that the map did not show */
    bool is_late;    /**< it was given up */
    bool is_touched; /**< the body was on a cell that is blocked */
    struct clearance_pose touched_at;
    double clearance_m;  /**< least distance between its rectangle and what is blocked, up to 0.25 m */
    double aside_m;      /**< most that it was beside its leg, beyond what the corners cut */
    double goal_error_m; /**< from the goal cell's centre */
    double deviation_m;  /**< of its position then, as its odometry tells; 0: it does not */
    double drift_m;      /**< most that it took itself to be elsewhere than it was */
    double length_m;     /**< driven */
    double seconds;
    double joules;          /**< of the energy that the vehicle's model counts */
    double planned_joules;  /**< of the first route, by the prices of the lattice; 0: there was none in time */
    double forecast_joules; /**< of the first course */
    double deviation_joules;
    enum jp_home_state home;                /**< at the end, of a robot with a battery */
    enum jp_status home_status;             /**< why it has failed */
    double given_joules;                    /**< by the battery at its terminals */
    bool is_stranded;                       /**< the battery was empty, or the bus too low, before it was home */
    struct navigation_charge charge_before; /**< of cells, as it was told where to go */
    struct navigation_charge charge;        /**< the same at the end */
    double least_bus_v;                     /**< of cells, the mean of 0.1 s */
    bool has_turned_back;
    double least_probability; /**< of coming home, on the way out */
    double trip_joules;       /**< out and home by the return map, before it left; 0: nobody asked, or no way */
    double trip_deviation_joules;
    double joules_at_leave;      /**< spent when it left */
    double joules_at_turn;       /**< spent when it left the goal or turned back, */
    double way_joules;           /**< and what the way home should take from there, */
    double way_deviation_joules; /**< give or take */
};

/** Of a state and a reason, for people. */
const char *navigation_state_name(enum jp_navigator_state state);
const char *navigation_reason_name(enum jp_navigator_reason reason);

#endif
