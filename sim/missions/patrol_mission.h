/**
 * A drive of the patrol robot: path by any-angle A*, smoothed; timed elastic band or pure pursuit; wheels, laser,
 * moving obstacles.
 */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_MISSION_H
#define JOULEPATH_SIM_MISSIONS_PATROL_MISSION_H

#include <joulepath/patrol_mission.h>

#include "sim/four_wheel/laser.h"
#include "sim/four_wheel/patrol_config.h"
#include "sim/missions/patrol_energy.h"
#include "sim/scenes/patrol_scene.h"

extern const char *const patrol_method_names[PATROL_METHODS];

enum patrol_outcome {
    PATROL_ARRIVED,  /**< truly at the goal: position and heading within patrol_tolerance */
    PATROL_MISSED,   /**< the robot thinks so, but it is not */
    PATROL_COLLIDED, /**< the true shapes touched; with a person, where it is the robot's doing (contact.h) */
    PATROL_GAVE_UP,  /**< gave up; the reason says why */
    PATROL_LATE,     /**< still on its way at the limit */
    PATROL_NO_PATH,
    PATROL_OUTCOMES
};

extern const char *const patrol_outcome_names[PATROL_OUTCOMES];
extern const char *const patrol_reason_names[JP_PATROL_INFEASIBLE + 1];
extern const char *const patrol_state_names[JP_PATROL_STOPPED + 1];

/** What goes wrong, on request. */
struct patrol_faults {
    double beam_dropout;      /**< share of the beams that drop out */
    double scan_dropout_from; /**< no scans at all from…until, s */
    double scan_dropout_until;
    double jump_at;    /**< the laser's pose is off by jump_m from then on, s; below 0: never */
    double jump_until; /**< 0: for ever */
    double jump_m;
    double wheels_jump_m; /**< at jump_at the pose of the wheels jumps by so much */
    double carried_at;    /**< somebody carries the robot to `carried_to`, s; 0: nobody does */
    struct jp_plane_pose carried_to;
    bool slip; /**< slippery ground that falls off to one side: wheel odometry errs by some per cent of the distance */
};

struct patrol_view;

struct patrol_task {
    const struct four_wheel_file *robot;
    const struct patrol_scene *scene;
    enum patrol_method method;
    bool turns_by_fixed_angle; /**< the improved band turns by the paper's rule, not by cost */
    bool plans_by_length;      /**< the improved method, as the others, not by joules; so does a robot whose
                                    energy is not identified */
    uint64_t seed;             /**< of the noise */
    struct patrol_faults faults;
    /** Places that the robot goes round between after the scene's goal, beginning with the first; at each its pose is
     * set to the true one, as a mark would. None: it stops at the goal. */
    const struct jp_plane_pose *round;
    size_t round_count;    /**< at most PATROL_ROUND_MAX */
    size_t legs_learned;   /**< of which it learns; later ones are only forecast. 0: of all */
    size_t legs_max;       /**< that are driven, the way to the goal among them; with a round */
    bool survives_touches; /**< otherwise the first one ends the drive */
    /** Called every cycle, may be null. */
    void (*observe)(void *context, const struct patrol_view *view);
    /** Called at the end of every leg, with what it took; may be null. */
    void (*keep_leg)(void *context, const struct patrol_leg *leg);
    void *context;
};

/** A cycle, as reports need it. */
struct patrol_view {
    double time;
    struct jp_plane_pose true_pose;
    struct jp_plane_speed true_speed;
    struct jp_plane_pose believed; /**< in the map's frame */
    enum jp_patrol_state state;
    enum jp_patrol_reason reason;
    const struct jp_wheels *wheels; /**< as the encoders say */
    const struct jp_patrol *patrol; /**< its band may be shown; null for pure pursuit */
    const struct patrol_world *world;
    const struct jp_point *grid_path; /**< turning points of the grid planner's path */
    size_t grid_path_count;
    const struct jp_point *path; /**< smoothed */
    size_t path_count;
    unsigned replans; /**< so far: both paths are new when it has grown */
    double clearance; /**< of the true shape, m */
    double energy_j;
    const struct patrol_leg *leg;  /**< that is driven: planned, forecast and deviation are known */
    const struct laser_scan *scan; /**< the last */
};

struct patrol_result {
    enum patrol_outcome outcome;
    enum jp_patrol_reason reason;
    double time;   /**< s */
    double length; /**< driven, m */
    double energy_j;
    double reversed;             /**< driven backwards, m: more than slip and noise explain counts as reversing */
    unsigned direction_changes;  /**< between forward and backward, and of the turn rate's sign beyond noise */
    double clearance_min;        /**< of the true shapes from things, m */
    double person_clearance_min; /**< from people, while the robot's own motion brought it nearer, m */
    struct patrol_contacts contacts;
    double position_error; /**< from the goal, m */
    double heading_error;  /**< rad */
    double odometry_error; /**< of the pose that the robot believes, at the end, m */
    double path_length;
    double path_price; /**< by which it was planned, J; 0: by length */
    unsigned replans;
    struct jp_grid_counts planner;
    struct jp_patrol_counts counts;
    struct patrol_leg leg; /**< the last one that came to its end */
};

/** Drives to the end. Deterministic for a task. False after one line on stderr: no memory. */
bool patrol_mission_run(const struct patrol_task *task, struct patrol_result *result);

/* The same by cycles, for who looks on and interferes. */

struct patrol_mission;

/** Ready for the first cycle; *task and *result stay in use. NULL after one line on stderr: no memory. */
struct patrol_mission *patrol_mission_begin(const struct patrol_task *task, struct patrol_result *result);

/** A cycle of 1/PATROL_CYCLE_HZ s. False: the drive is over, and *result says how. */
bool patrol_mission_step(struct patrol_mission *mission);

/** What it moves among. Whose obstacles are changed between cycles must keep their number. */
struct patrol_world *patrol_mission_world(struct patrol_mission *mission);

/** May be NULL. */
void patrol_mission_free(struct patrol_mission *mission);

#endif
