/**
 * One robot: sensors in, voltages out. What it drives is handed over piece by piece; pilot.h plans and drives routes.
 *
 *   jp_robot_tick()  at the control rate, from the control interrupt: short and bounded; in two parts, so that the
 *                    bridges need not wait for the second
 *
 *            enable                     drive
 *   idle ───────────▶ balancing ◀──────────────▶ driving        fallen: |ψ| beyond the tilt limit
 *    ▲  │                 │       all done, stop     │           fault:  a confirmed sensor or HAL fault
 *    │  └────────────┐    ▼                          ▼
 *    └───────────── fallen, fault ◀──────────────────┘           motors are off in idle, fallen and fault
 *      disable
 *
 * jp_robot_disable() leads to idle from every state and is the only way out of fallen and fault.
 */
#ifndef JOULEPATH_ROBOT_H
#define JOULEPATH_ROBOT_H

#include <stdbool.h>
#include <stddef.h>

#include <joulepath/current_check.h>
#include <joulepath/estimator.h>
#include <joulepath/lqr.h>
#include <joulepath/meter.h>
#include <joulepath/monitor.h>
#include <joulepath/odometry.h>
#include <joulepath/reference.h>
#include <joulepath/segment.h>
#include <joulepath/trajectory.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Everything that is fixed for one kind of robot; made by tools/design/gain_design.py. */
struct jp_robot_config {
    const char *name;
    struct jp_estimator_config estimator;
    struct jp_reference_config reference;
    struct jp_lqr_config lqr;
    struct jp_monitor_config monitor;
    struct jp_meter_config meter;
    struct jp_segment_limits limits;
    struct jp_trajectory_config trajectory;
    jp_q24 metres_per_turn; /**< 2πR, m; 0.0625…4 */
};

enum jp_robot_state { JP_ROBOT_IDLE, JP_ROBOT_BALANCING, JP_ROBOT_DRIVING, JP_ROBOT_FALLEN, JP_ROBOT_FAULT };

/** What the robot shows the world; made whole and consistent by jp_robot_telemetry(). */
struct jp_telemetry {
    enum jp_robot_state state;
    uint16_t faults;               /**< enum jp_fault bits; kept until disable */
    uint32_t tick;                 /**< ticks since init, wrapping */
    struct jp_motion_state motion; /**< measured */
    jp_phase reference_wheel;      /**< what the controller follows */
    jp_phase reference_yaw;
    jp_turns_per_s reference_wheel_rate; /**< turn/s */
    jp_turns_per_s reference_yaw_rate;   /**< turn/s */
    jp_phase target_wheel;               /**< where the wheels shall be, before shaping */
    jp_phase target_yaw;                 /**< heading of the route, before shaping */
    struct jp_point position;            /**< by odometry */
    struct jp_voltages voltages;
    jp_energy energy_model; /**< since init, meter.h */
    jp_energy energy_battery;
    uint32_t saturated_ticks; /**< ticks with a limited voltage, saturating */
    uint16_t segment;         /**< segments begun since the robot last stood, saturating */
    uint32_t segment_ticks_left;
    struct jp_motion command;       /**< of the segment being driven; 0 while balancing */
    jp_energy segment_energy_model; /**< of the last segment that ended */
    jp_energy segment_energy_battery;
    uint16_t segments_ended; /**< since the robot last stood, saturating */
    int64_t gyro_bias;       /**< learned, 2⁻⁵⁶ turn/s */
    uint32_t dropped_frames; /**< ticks without a plausible frame, wrapping; from 0 again after a disable */
};

/** The part of the telemetry that the tick writes, with the same fields: jp_robot_last_tick(). */
struct jp_tick_telemetry {
    enum jp_robot_state state;
    uint16_t faults;
    uint16_t segment;
    uint16_t segments_ended;
    uint32_t tick;
    struct jp_motion_state motion;
    struct jp_voltages voltages;
    uint32_t saturated_ticks;
    uint32_t segment_ticks_left;
    struct jp_motion command;
    jp_energy segment_energy_model;
    jp_energy segment_energy_battery;
};

/** What a reset of the controller must not lose. */
struct jp_snapshot {
    struct jp_estimator estimator;
    struct jp_odometry odometry;
    bool balancing; /**< the motors ran */
};

/** A segment as the tick takes it. */
struct jp_next_segment {
    const struct jp_trajectory *trajectory; /**< instead of the segment; or null */
    struct jp_motion motion;
    struct jp_reference_step step;
    uint32_t ticks;
};

/** Private: how far the robot is from the path of its trajectory, in wheel turns. Zero: on the path. */
struct jp_path_error {
    jp_phase across;       /**< to the left of it */
    jp_phase along;        /**< ahead, beyond what the wheels are ahead of the reference */
    jp_phase turned;       /**< by which the reference's heading left the trajectory, turn */
    jp_phase lead;         /**< of it: the path's bend to where the robot is, turn; the rest leads back to the path */
    jp_turns_per_s cruise; /**< of the leg's middle, turn/s */
};

/** Private. What most functions use stands first, where the instructions that reach it are short. */
struct jp_robot_internal {
    const struct jp_robot_config *config;
    uint8_t next_full;
    uint8_t enable_requested;
    uint8_t stop_requested;
    uint8_t disable_requested;
    bool started;  /**< a plausible frame was seen */
    bool resuming; /**< the first plausible frame continues from a snapshot */

    /* From jp_robot_control() to jp_robot_account(). */
    bool review_due; /**< a sample ended an interval */
    bool segment_ended;
    bool segment_began;

    bool motors_ran;       /**< since the last tick */
    uint16_t motor_faults; /**< enum jp_fault bits that the last tick found */
    uint32_t sequence;     /**< odd during a tick */
    struct jp_tick_telemetry telemetry;

    const struct jp_trajectory *trajectory; /**< that is driven; or null */
    struct jp_trajectory_drive trajectory_drive;
    struct jp_path_error path_error;
    struct jp_set_point set_point; /**< of the next ticks */
    bool has_set_point;
    bool set_point_is_new; /**< it serves for one more tick */

    struct jp_reference reference;
    struct jp_monitor monitor;
    struct jp_estimator estimator;
    struct jp_lqr lqr;
    struct jp_meter meter;
    struct jp_odometry odometry;

    struct jp_next_segment next; /**< handed to the tick by `next_full` */
    int64_t known_gyro_bias;

    struct jp_voltages applied;  /**< since the last tick */
    struct jp_voltages reviewed; /**< in the interval that the last frame ended */
    jp_energy segment_start_model;
    jp_energy segment_start_battery;
};

/** The caller's memory; the functions below give access to it. */
struct jp_robot {
    struct jp_robot_internal internal;
};

/**
 * Prepares a robot in state idle. config is kept by pointer.
 * JP_ERR_ARGUMENT: a pointer is null. JP_ERR_CONFIG: *field names the first field out of range; it is
 * estimator.tick_rate where the parts do not have the same rate. Not for ISRs.
 */
enum jp_status jp_robot_init(struct jp_robot *robot, const struct jp_robot_config *config, const char **field);

/**
 * The part of a control tick that the bridges wait for: sensors to duties. `read` is what the HAL returned for the
 * frame: after an error the last good frame serves until the fault is confirmed; JP_HELD tells nothing of the sensors.
 * jp_robot_account() must follow before anything else looks at the robot. Constant time; for the control ISR;
 * instructions: tests/bench/FIGURES.md.
 */
void jp_robot_control(struct jp_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                      struct jp_actuation *actuation);

/** The rest of the tick, which can wait until the duties are applied: odometry, energy, motor checks (their faults
 * switch off in the next tick). Constant time; for the control ISR. */
void jp_robot_account(struct jp_robot *robot);

/** A whole tick: jp_robot_control(), then jp_robot_account(). Constant time; for the control ISR. */
void jp_robot_tick(struct jp_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                   struct jp_actuation *actuation);

/** Writes what jp_robot_resume() needs; after any tick and in its context. Constant time. */
void jp_robot_snapshot(const struct jp_robot *robot, struct jp_snapshot *snapshot);

/**
 * Between jp_robot_init() and the first tick, after a reset in motion: the first plausible frame continues from the
 * snapshot instead of assuming rest. If the motors ran the robot balances at once and brakes to a
 * stand, unless it is disabled or its sensors fail before. Pitch is that of the snapshot, so the reset must be short:
 * tens of milliseconds.
 */
void jp_robot_resume(struct jp_robot *robot, const struct jp_snapshot *snapshot);

/** Between jp_robot_init() and the first tick: the estimator begins with a bias that it learned earlier, 2⁻⁵⁶ turn/s;
 *  ±0.05 turn/s. */
void jp_robot_know_gyro_bias(struct jp_robot *robot, int64_t bias);

/** Idle to balancing, at the next tick. JP_ERR_STATE: not idle, no frame yet, or tilted beyond the limit.
 *  JP_ERR_ARGUMENT: null. */
enum jp_status jp_robot_enable(struct jp_robot *robot);

/** To idle with motors off, at the next tick; clears faults and what waits. Enabling again needs a plausible frame
 * after that. After a fault all motion is measured anew: position and heading begin at the origin. */
void jp_robot_disable(struct jp_robot *robot);

/**
 * Drives one segment: at once when balancing, after the current one when driving.
 * JP_ERR_STATE: neither balancing nor driving. JP_ERR_BUSY: one already waits. JP_ERR_ARGUMENT: null, or a field
 * out of range: |v| <= limits.speed, |w| <= 8 rad/s, |σ| <= 2π, 0 < T <= 16 384 s. No sequence of accepted segments
 * makes the balancer switch off; between forward and back it rests (reference.h).
 */
enum jp_status jp_robot_drive(struct jp_robot *robot, const struct jp_segment_command *segment);

/**
 * Drives a trajectory, whose memory must stay until the robot stands: at once when balancing, after what it drives
 * when driving. It must begin where and as the robot then is; after another trajectory, where and as that one ends.
 * More legs may be planned meanwhile, each before the one before it ends; without one, the robot stands. Each leg
 * counts as a segment. JP_ERR_STATE: neither balancing nor driving. JP_ERR_BUSY: a segment or a trajectory waits.
 * JP_ERR_ARGUMENT: null, without legs, or a leg is faster than limits.speed.
 */
enum jp_status jp_robot_drive_trajectory(struct jp_robot *robot, const struct jp_trajectory *trajectory);

/** Brakes to a balanced stand and forgets what waits, at the next tick. */
void jp_robot_stop(struct jp_robot *robot);

/* What may be known of a robot from any context. */

/**
 * A consistent copy of the telemetry. False, and *telemetry is not to be used: a tick is under way, which only a
 * caller sees within it, between jp_robot_control() and jp_robot_account(), or from another core.
 */
bool jp_robot_telemetry(const struct jp_robot *robot, struct jp_telemetry *telemetry);

/** A consistent sample for jp_current_check_update(), as jp_robot_telemetry(). False, and *sample is not to be used: a
 *  tick is under way, the motors are off, or the last tick had no plausible frame. */
bool jp_robot_motors(const struct jp_robot *robot, struct jp_motor_sample *sample);

/** What the robot does. */
enum jp_robot_state jp_robot_state_now(const struct jp_robot *robot);

/** What it was prepared with. */
static inline const struct jp_robot_config *jp_robot_configuration(const struct jp_robot *robot)
{
    return robot->internal.config;
}

/* In the context of the functions that drive. */

/** A segment or a trajectory waits for the tick. When it is asked before the state, one that does not wait any more
 *  shows in the state. */
bool jp_robot_has_next(const struct jp_robot *robot);

/** Where and how the robot will end what it drives, or, when it balances, will stand: measured position, heading of the
 *  reference. *telemetry is that of now. Two sines; not for ISRs. */
void jp_robot_predict_end(const struct jp_robot *robot, const struct jp_telemetry *telemetry, struct jp_point *position,
                          jp_angle *heading);

/*
 * In the context of the tick and between ticks, where no tick changes what they show meanwhile; all others take
 * jp_robot_telemetry(), which copies until no tick came between. Constant time.
 */

/** What the last tick found and did. */
static inline const struct jp_tick_telemetry *jp_robot_last_tick(const struct jp_robot *robot)
{
    return &robot->internal.telemetry;
}

/** What the controller follows. */
static inline const struct jp_reference *jp_robot_reference(const struct jp_robot *robot)
{
    return &robot->internal.reference;
}

/** What was spent since init. */
static inline const struct jp_meter *jp_robot_meter(const struct jp_robot *robot)
{
    return &robot->internal.meter;
}

/** Where the robot is, by odometry. */
static inline struct jp_point jp_robot_position(const struct jp_robot *robot)
{
    return jp_odometry_position(&robot->internal.odometry);
}

/** The last plausible frame; NULL: none came since init or a disable. */
static inline const struct jp_sensors *jp_robot_good_frame(const struct jp_robot *robot)
{
    return robot->internal.monitor.started ? &robot->internal.monitor.good : NULL;
}

#ifdef __cplusplus
}
#endif

#endif
