/**
 * One skid-steered or differential-drive robot: sensors in, voltages out.
 *
 *   jp_skid_robot_tick()  at the control rate, from the control interrupt: short and bounded; in two parts, so that the
 *                         bridges need not wait for the second
 *
 *          enable                    drive
 *   idle ──────────▶ standing ◀──────────────▶ driving
 *    ▲ disable          │      stop, time over     │
 *    └───────────── fault ◀────────────────────────┘     a confirmed fault, from idle too
 *
 * Standing holds the place that the wheels have, on a slope too. Driving follows one command until its time is over or
 * another one replaces it; then the robot brakes and stands. So it moves only as long as commands come: a stream of
 * velocities is a command each, with the longest gap that is allowed as its duration. A path is one command: the robot
 * follows it by its odometry to the end.
 *
 * Idle brakes as a command does, by voltage alone, and then shorts the motors: on a slope the robot creeps at
 * R F r²/(2 K²) at most, with F what pulls it down and K in V·s/rad (3 cm/s for zhang2018 on 15°). So does a fault that
 * takes wheels, bridges or bus away. A fault that leaves them (IMU, slope, stalled motor, wheel in the air, spinning
 * wheels) brakes under control and then holds the place; a stalled motor stops both sides at once. Bridges that do not
 * answer are off, and the robot rolls. After init and after a fault the bridges are off for JP_SKID_WAKE_TICKS, until
 * the wheels' speed is known from which the robot brakes: a reset may come in motion.
 *
 * jp_skid_robot_disable() leads to idle from every state and is the only way out of fault.
 */
#ifndef JOULEPATH_SKID_ROBOT_H
#define JOULEPATH_SKID_ROBOT_H

#include <stddef.h>

#include <joulepath/energy.h>
#include <joulepath/meter.h>
#include <joulepath/path_drive.h>
#include <joulepath/point.h>
#include <joulepath/skid_monitor.h>
#include <joulepath/skid_odometry.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Ticks from the first frame until the wheels' speed is known. */
#define JP_SKID_WAKE_TICKS 8

/** What the robot may do. */
struct jp_skid_limits {
    jp_q24 speed;             /**< of each tread, m/s; above 0, at most 8 */
    jp_q24 acceleration;      /**< m/s²; 0.01…64 */
    jp_q24 turn_acceleration; /**< rad/s²; 0.01…64 */
};

/** Everything that is fixed for one robot; made by tools/design/skid_robot.py. */
struct jp_skid_robot_config {
    const char *name;
    struct jp_skid_odometry_config odometry;
    struct jp_skid_control_config control;
    struct jp_monitor_config monitor; /**< half_track is 1: the wheels' rates are those of the sides; residual_ticks are
                                           every second tick */
    struct jp_skid_monitor_config wheels; /**< a call is every second tick */
    struct jp_meter_config meter;
    jp_q16 burnt; /**< share of what a motor generates that its bridge burns; 0…1 */
    struct jp_skid_limits limits;
    struct jp_path_drive_config path;
    jp_q24 heading_gain; /**< turn rate from the heading that a command has missed, 1/s; 0…16 */
};

enum jp_skid_robot_state { JP_SKID_ROBOT_IDLE, JP_SKID_ROBOT_STANDING, JP_SKID_ROBOT_DRIVING, JP_SKID_ROBOT_FAULT };

/** A motion, how the robot gets there, and how long it keeps it. */
struct jp_skid_command {
    struct jp_motion motion;
    jp_q24 acceleration;      /**< m/s²; 0: limits.acceleration */
    jp_q24 turn_acceleration; /**< rad/s²; 0: limits.turn_acceleration */
    jp_q16 duration;          /**< s; above 0, at most 16 384; then it brakes */
};

/** What the robot shows the world; made whole and consistent by jp_skid_robot_telemetry(). */
struct jp_skid_telemetry {
    enum jp_skid_robot_state state;
    uint16_t faults;            /**< enum jp_fault bits; kept until disable */
    uint32_t tick;              /**< ticks since init, wrapping */
    int64_t x;                  /**< by odometry, m, Q32.32 */
    int64_t y;                  /**< m, Q32.32 */
    jp_phase heading;           /**< left turn positive */
    struct jp_motion motion;    /**< measured */
    struct jp_motion reference; /**< what the controller follows */
    struct jp_motion command;   /**< where the reference goes */
    uint32_t command_ticks_left;
    uint16_t commands;   /**< that were taken up since init, paths too; wrapping */
    uint16_t path_piece; /**< of the path that is followed, or was last; the count of its pieces when all are driven */
    struct jp_voltages voltages;
    jp_q24 rise;              /**< sine of the slope ahead */
    jp_q24 steering_ratio;    /**< as learned */
    jp_energy energy;         /**< out of the battery since init, meter.h */
    uint32_t saturated_ticks; /**< ticks with a limited voltage, saturating */
    uint32_t dropped_frames;  /**< ticks without a plausible frame, wrapping; from 0 again after a disable */
};

/** What a reset of the controller must not lose. */
struct jp_skid_snapshot {
    int64_t x; /**< by odometry, m, Q32.32 */
    int64_t y;
    jp_phase heading;
    uint32_t tick_rate; /**< whose it is */
    int32_t way_per_count;
    uint32_t encoder_left; /**< of the last plausible frame */
    uint32_t encoder_right;
    jp_turns_per_s gyro_bias;
    jp_q24 steering_ratio;
    int32_t bias; /**< as the odometry's filters have it, and so the rest */
    int32_t pitch_bias;
    int32_t ratio;
    int32_t scale;
    int32_t bias_bias;
    int32_t bias_ratio;
    int32_t ratio_ratio;
    uint32_t ran; /**< 1: the motors did */
};

/** What the next tick does of a set-point; private. */
enum jp_skid_follow_part { JP_SKID_FOLLOW_ADVANCE, JP_SKID_FOLLOW_LOOK_AHEAD, JP_SKID_FOLLOW_TRACK };

/** Private: the path that is followed. */
struct jp_skid_follow {
    const struct jp_lattice_path *path; /**< or null */
    struct jp_path_drive drive;
    struct jp_path_set_point at;
    struct jp_motion motion; /**< that leads to it */
    jp_q24 acceleration;     /**< of that, with the way back to the path */
    enum jp_skid_follow_part next;
};

/** Private: a command as the tick takes it. */
struct jp_skid_next {
    const struct jp_lattice_path *path; /**< instead of the motion; or null */
    struct jp_motion motion;
    jp_q24 speed_step; /**< change in a tick, m/s */
    jp_q24 turn_step;  /**< rad/s */
    uint32_t ticks;
};

/** Private. */
struct jp_skid_robot_internal {
    const struct jp_skid_robot_config *config;
    uint8_t next_full;
    uint8_t enable_requested;
    uint8_t stop_requested;
    uint8_t disable_requested;
    uint8_t wake_ticks; /**< left */
    bool started;       /**< a plausible frame was seen */
    bool holds;         /**< in a fault: the wheels are still controlled */
    bool controlled;    /**< the wheels are */
    bool reviewed;      /**< they were in the tick before, too */

    enum jp_skid_robot_state state;
    uint16_t faults;
    uint16_t found;    /**< enum jp_fault bits that the last tick found after its duties */
    uint32_t sequence; /**< odd during a tick */
    uint32_t tick;

    struct jp_skid_next command; /**< that is driven; its ticks are those left */
    uint16_t commands;           /**< taken up */
    struct jp_skid_follow follow;
    struct jp_motion reference;
    jp_q24 acceleration;  /**< of the reference */
    jp_q24 heading_error; /**< that the command has missed, rad */
    struct jp_skid_next braking;

    struct jp_voltages voltages;
    struct jp_voltages applied; /**< since the last tick */
    jp_q16 bus_voltage;         /**< while the wheels were controlled, V */
    uint32_t saturated_ticks;

    struct jp_monitor monitor;
    struct jp_skid_monitor wheels;
    struct jp_skid_control control;
    struct jp_meter meter;
    struct jp_skid_odometry odometry;
    uint32_t counted[JP_SKID_SIDES];     /**< by the odometry */
    uint32_t not_counted[JP_SKID_SIDES]; /**< by the encoders before the first frame, and in faults */

    struct jp_skid_next next; /**< handed to the tick by `next_full` */
};

/** The caller's memory; the functions below give access to it. */
struct jp_skid_robot {
    struct jp_skid_robot_internal internal;
};

/**
 * Prepares a robot in state idle. config is kept by pointer.
 * JP_ERR_ARGUMENT: a pointer is null. JP_ERR_CONFIG: *field names the first field out of range; it is control.tick_rate
 * where the parts do not have the same rate. Not for ISRs.
 */
enum jp_status jp_skid_robot_init(struct jp_skid_robot *robot, const struct jp_skid_robot_config *config,
                                  const char **field);

/**
 * The part of a control tick that the bridges wait for: sensors to duties. `read` is what the HAL returned for the
 * frame: after an error the last good frame serves until the fault is confirmed; JP_HELD tells nothing of the sensors.
 * jp_skid_robot_account() must follow before anything else looks at the robot. Constant time; for the control ISR;
 * instructions: tests/bench/FIGURES.md.
 */
void jp_skid_robot_control(struct jp_skid_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                           struct jp_actuation *actuation);

/** The rest of the tick, which can wait until the duties are applied: odometry, energy, motor and ground checks (their
 *  faults act in the next tick). Constant time; for the control ISR. */
void jp_skid_robot_account(struct jp_skid_robot *robot);

/** A whole tick: jp_skid_robot_control(), then jp_skid_robot_account(). Constant time; for the control ISR. */
void jp_skid_robot_tick(struct jp_skid_robot *robot, enum jp_status read, const struct jp_sensors *sensors,
                        struct jp_actuation *actuation);

/** Writes what jp_skid_robot_resume() needs; after any tick and in its context. Constant time. */
void jp_skid_robot_snapshot(const struct jp_skid_robot *robot, struct jp_skid_snapshot *snapshot);

/**
 * Between jp_skid_robot_init() and the first tick, after a reset: position, heading and what was learned go on from the
 * snapshot, but for what the robot moved in between. The robot is idle: after a reset in motion it finds out how fast
 * it is and brakes; enabled, it stands then. False, and nothing changed: a number cannot be this robot's.
 */
bool jp_skid_robot_resume(struct jp_skid_robot *robot, const struct jp_skid_snapshot *snapshot);

/** Between jp_skid_robot_init() and the first tick, before jp_skid_robot_resume(): the scale of its gyro as it was
 *  learned earlier; jp_skid_odometry_scale() tells it. Within the ranges of the struct. Not for ISRs. */
void jp_skid_robot_know_gyro_scale(struct jp_skid_robot *robot, const struct jp_gyro_scale *scale);

/** Idle to standing, at the next tick. JP_ERR_STATE: not idle, not awake yet, no good frame came since a disable, or
 *  the ground is too steep. JP_ERR_ARGUMENT: null. */
enum jp_status jp_skid_robot_enable(struct jp_skid_robot *robot);

/** To idle, at the next tick; clears faults and what waits. Enabling again needs a plausible frame after that. Position
 *  and heading go on from where a fault was found: what the robot moved since then is missing. */
void jp_skid_robot_disable(struct jp_skid_robot *robot);

/**
 * Drives a command from the next tick on; it replaces the one before it.
 * JP_ERR_STATE: neither standing nor driving. JP_ERR_ARGUMENT: null, or a field out of range: |v| and |w| <= 8,
 * accelerations 0 to those of the limits. JP_ERR_INFEASIBLE: with the steering ratio as it is learned now, a tread
 * would be faster than limits.speed. Not within a tick, but between ticks from the control ISR, too: a command without
 * accelerations in each tick is followed as it is, as far as the limits permit. Two 32-bit divisions.
 */
enum jp_status jp_skid_robot_drive(struct jp_skid_robot *robot, const struct jp_skid_command *command);

/**
 * Follows a path (lattice_path.h) whose speeds are planned, from where the robot stands: there it begins, as odometry
 * counts. Path and pieces must stay until the robot stands again. JP_ERR_STATE: it does not stand. JP_ERR_ARGUMENT:
 * null, or without pieces. Constant time.
 */
enum jp_status jp_skid_robot_follow(struct jp_skid_robot *robot, const struct jp_lattice_path *path);

/** Brakes with the accelerations of the limits, stands, and forgets what waits, at the next tick. */
void jp_skid_robot_stop(struct jp_skid_robot *robot);

/** The way of jp_skid_robot_stop() from `speed`, m, and that of a fault once it is confirmed: v²/(2a) + v · 4 ticks,
 * with an eighth of the former for what braking by voltage alone may miss. Not for a side in the air, whose robot
 * swings about the other one. |speed| <= 8. Two 64-bit divisions; any context. */
jp_q24 jp_skid_robot_stopping_distance(const struct jp_skid_robot_config *config, jp_q24 speed);

/* What may be known of a robot from any context. */

/**
 * A consistent copy of the telemetry. False, and *telemetry is not to be used: a tick is under way, which only a caller
 * sees within it, between jp_skid_robot_control() and jp_skid_robot_account(), or from another core.
 */
bool jp_skid_robot_telemetry(const struct jp_skid_robot *robot, struct jp_skid_telemetry *telemetry);

/** What the robot does. */
enum jp_skid_robot_state jp_skid_robot_state_now(const struct jp_skid_robot *robot);

/** Whether it was told something that no tick has taken up yet. */
bool jp_skid_robot_has_next(const struct jp_skid_robot *robot);

/** What it was prepared with. */
static inline const struct jp_skid_robot_config *jp_skid_robot_configuration(const struct jp_skid_robot *robot)
{
    return robot->internal.config;
}

/* In the context of the tick and between ticks. Constant time. */

/** Where the robot is, by odometry. */
static inline const struct jp_skid_odometry *jp_skid_robot_odometry(const struct jp_skid_robot *robot)
{
    return &robot->internal.odometry;
}

/** Pitch of the body by the ground that it stands on, turn; forward is positive, so uphill negative. One atan2. */
jp_q24 jp_skid_robot_pitch(const struct jp_skid_robot *robot);

/** The last plausible frame; NULL: none came since init or a disable. */
static inline const struct jp_sensors *jp_skid_robot_good_frame(const struct jp_skid_robot *robot)
{
    return robot->internal.monitor.started ? &robot->internal.monitor.good : NULL;
}

/** What was spent since init. */
static inline const struct jp_meter *jp_skid_robot_meter(const struct jp_skid_robot *robot)
{
    return &robot->internal.meter;
}

#ifdef __cplusplus
}
#endif

#endif
