/**
 * The control tick of a robot with four steered and driven wheels, whose drives follow angles and speeds by themselves.
 *
 *          enable            twist            at rest
 *   idle ─────────▶ standing ─────▶ driving ─────────▶ standing
 *    ▲                 │               │
 *    └─── disable ─────┴──── fault ◀───┴── a sensor or a drive fails
 *
 * The background gives a twist (patrol.h); the tick leads the wheels to it (four_wheel.h), keeps odometry, meters what
 * leaves the battery and hands on the pieces of the way for the learner. A twist that is not renewed in time becomes 0.
 * In a fault the set-points of the wheels go to a stand with their angles kept; then the drives are switched off.
 *
 * Odometry: with the twist (x, y, w) of the encoders, in a tick of T seconds
 *
 *   heading += w T,   position += R(heading − w T/2) (x, y) T
 *
 * Integers only, the same bits on every core.
 */
#ifndef JOULEPATH_FOUR_WHEEL_ROBOT_H
#define JOULEPATH_FOUR_WHEEL_ROBOT_H

#include <joulepath/bus_meter.h>
#include <joulepath/four_wheel_trip.h>
#include <joulepath/monitor.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One tick's measurements. */
struct jp_four_wheel_sensors {
    uint32_t count[JP_WHEELS]; /**< of the wheels' encoders, wrapping; rises when a wheel at angle 0 drives forward */
    int32_t angle[JP_WHEELS];  /**< of steering, counterclockwise from straight ahead, 2⁻³² turn */
    jp_q16 bus_voltage;        /**< V, mean of the tick */
    jp_q16 bus_current;        /**< A, mean of the tick; out of the battery is positive */
};

/** What the drives shall do. */
struct jp_four_wheel_actuation {
    struct jp_wheels wheels;
    uint8_t enabled; /**< 0: drives off: steering keeps its angle, the wheels are braked */
};

/** What is plausible. */
struct jp_four_wheel_limits {
    uint32_t count_jump;    /**< counts a tick beyond it are implausible; 1…65 535 */
    jp_q16 current;         /**< |A| beyond it is out of range; above 0, times voltage_max at most 32 767 W */
    jp_q16 voltage_min;     /**< V; above 0 */
    jp_q16 voltage_max;     /**< V; above voltage_min, at most 1 000 */
    jp_q24 speed_lag;       /**< of a wheel behind what it was told, m/s; above 0 */
    int32_t angle_lag;      /**< likewise, and how far beyond its limit an angle may be read, 2⁻³² turn; above 0 */
    uint16_t lag_ticks;     /**< in a row beyond a lag until a drive has failed; at least 1 */
    uint16_t confirm_ticks; /**< implausible frames in a row until they are a fault; 1…100 */
};

struct jp_four_wheel_robot_config {
    struct jp_four_wheel_config wheels;
    uint32_t tick_rate;   /**< 1/s; 100…10 000 */
    int32_t count_speed;  /**< of a wheel of which a tick counts one, 2⁻³² m/s; above 0 */
    uint16_t piece_ticks; /**< of four_wheel_trip.h */
    uint16_t twist_ticks; /**< for which a twist is driven that is not renewed; 1…10 000 */
    struct jp_four_wheel_limits limits;
};

enum jp_four_wheel_robot_state {
    JP_FOUR_WHEEL_ROBOT_IDLE,
    JP_FOUR_WHEEL_ROBOT_STANDING,
    JP_FOUR_WHEEL_ROBOT_DRIVING,
    JP_FOUR_WHEEL_ROBOT_FAULT
};

/** Where the robot is by its wheels. */
struct jp_four_wheel_odometry {
    int64_t x; /**< m, Q32.32 */
    int64_t y;
    jp_phase heading;      /**< to the left is positive */
    struct jp_twist twist; /**< as the encoders say */
};

/** Whole and consistent, by jp_four_wheel_robot_telemetry(). */
struct jp_four_wheel_telemetry {
    enum jp_four_wheel_robot_state state;
    uint16_t faults; /**< enum jp_fault bits: ENCODER_JUMP, ENCODER_LEFT and _RIGHT (an angle that cannot be),
                          CURRENT_RANGE, BUS_VOLTAGE, HARDWARE, STALLED_LEFT and _RIGHT (a drive that does not follow);
                          kept until disable */
    uint32_t tick;   /**< since init, wrapping */
    struct jp_four_wheel_odometry odometry;
    struct jp_twist reference; /**< that is driven */
    struct jp_wheels wheels;   /**< as they were told */
    jp_energy energy;          /**< out of the battery since init */
    uint32_t standstills;      /**< ticks in which wheels were steered at a stand, saturating */
    uint32_t dropped_frames;   /**< ticks without a plausible frame, saturating */
};

/** What a reset of the controller must not lose. */
struct jp_four_wheel_snapshot {
    struct jp_four_wheel_odometry odometry;
    struct jp_wheels wheels; /**< as they were told */
    jp_energy energy;
    uint32_t tick_rate; /**< whose it is */
    int32_t count_speed;
    uint32_t ran; /**< 1: the drives did */
};

/** A piece of the way, and what the meter showed at its end. */
struct jp_four_wheel_stretch {
    struct jp_four_wheel_piece piece;
    jp_energy energy;
};

/** Stretches that wait for the background. */
#define JP_FOUR_WHEEL_STRETCHES 16U

/** Private. */
struct jp_four_wheel_robot_internal {
    const struct jp_four_wheel_robot_config *config;
    uint8_t enable_requested;
    uint8_t disable_requested;
    uint8_t orders;            /* twists handed over, wrapping; the last is in the place that its lowest bit says */
    struct jp_twist twists[2]; /* of the background */

    uint32_t sequence; /* odd during a tick */
    struct jp_four_wheel_telemetry shown;
    uint8_t orders_taken;
    uint16_t twist_age; /* ticks */
    int32_t turn_per_rate;
    struct jp_four_wheel_sensors good; /* last plausible frame */
    bool has_frame;
    bool is_fresh;             /* of this tick */
    bool was_controlled;       /* in the tick before */
    uint16_t missed;           /* frames since the good one */
    uint16_t lags[JP_WHEELS];  /* ticks */
    struct jp_wheels measured; /* by the last two good frames */
    struct jp_bus_meter meter;
    struct jp_four_wheel_trip trip;
    struct jp_four_wheel_stretch stretches[JP_FOUR_WHEEL_STRETCHES];
    uint8_t stretches_head; /* written by the tick */
    uint8_t stretches_tail; /* by the background */
    uint32_t stretches_lost;
};

/** The caller's memory. */
struct jp_four_wheel_robot {
    struct jp_four_wheel_robot_internal internal;
};

/** Prepares a robot in state idle. config is kept by pointer. JP_ERR_ARGUMENT: a pointer is null. JP_ERR_CONFIG: *field
 *  names the first field out of range. Not for ISRs. */
enum jp_status jp_four_wheel_robot_init(struct jp_four_wheel_robot *robot,
                                        const struct jp_four_wheel_robot_config *config, const char **field);

/** The part of a tick that the drives wait for. `read` is what the HAL returned: after an error the last good frame
 *  serves until the fault is confirmed. jp_four_wheel_robot_account() must follow before anything else looks at the
 *  robot. Work: jp_four_wheel_tick(). For the control ISR. */
void jp_four_wheel_robot_control(struct jp_four_wheel_robot *self, enum jp_status read,
                                 const struct jp_four_wheel_sensors *sensors,
                                 struct jp_four_wheel_actuation *actuation);

/** The rest of the tick: odometry, energy and pieces. Work: twice jp_four_wheel_forward(). For the control ISR. */
void jp_four_wheel_robot_account(struct jp_four_wheel_robot *self);

/** What jp_four_wheel_robot_resume() needs; after any tick and in its context. Constant time. */
void jp_four_wheel_robot_snapshot(const struct jp_four_wheel_robot *self, struct jp_four_wheel_snapshot *snapshot);

/** Between init and the first tick, after a reset in motion: odometry, meter and set-points go on, and the robot brakes
 *  to a stand, enabled. False, and nothing changed: the drives did not run, or it is not this robot's. */
bool jp_four_wheel_robot_resume(struct jp_four_wheel_robot *self, const struct jp_four_wheel_snapshot *snapshot);

/** Idle to standing, at the next tick. JP_ERR_STATE: not idle, or no plausible frame came yet. JP_ERR_ARGUMENT: null.
 */
enum jp_status jp_four_wheel_robot_enable(struct jp_four_wheel_robot *robot);

/** To idle, at the next tick; clears faults. */
void jp_four_wheel_robot_disable(struct jp_four_wheel_robot *robot);

/** Drives this twist from the next tick on. JP_ERR_STATE: neither standing nor driving. JP_ERR_ARGUMENT: null, or out
 *  of the range of jp_four_wheel_inverse(). From one context. Constant time. */
enum jp_status jp_four_wheel_robot_drive(struct jp_four_wheel_robot *robot, const struct jp_twist *twist);

/** A consistent copy. False, and *telemetry is not to be used: a tick is under way or came between. */
bool jp_four_wheel_robot_telemetry(const struct jp_four_wheel_robot *robot, struct jp_four_wheel_telemetry *telemetry);

/** What the robot does; from any context. */
enum jp_four_wheel_robot_state jp_four_wheel_robot_state_now(const struct jp_four_wheel_robot *robot);

/** The oldest stretch that was not taken yet; false: there is none. For the background. */
bool jp_four_wheel_robot_take_stretch(struct jp_four_wheel_robot *robot, struct jp_four_wheel_stretch *stretch);

/** Stretches since init that the background did not take in time, saturating. */
uint32_t jp_four_wheel_robot_stretches_lost(const struct jp_four_wheel_robot *robot);

/** The last plausible frame; null: none came. In the context of the tick. */
const struct jp_four_wheel_sensors *jp_four_wheel_robot_good_frame(const struct jp_four_wheel_robot *robot);

/** In the context of the tick. */
static inline const struct jp_four_wheel_telemetry *jp_four_wheel_robot_shown(const struct jp_four_wheel_robot *robot)
{
    return &robot->internal.shown;
}

/** What it was prepared with. */
static inline const struct jp_four_wheel_robot_config *
jp_four_wheel_robot_configuration(const struct jp_four_wheel_robot *robot)
{
    return robot->internal.config;
}

#ifdef __cplusplus
}
#endif

#endif
