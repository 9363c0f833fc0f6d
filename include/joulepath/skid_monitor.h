/**
 * What a skid-steered or differential-drive robot can see of its ground and its wheels, beside what monitor.h checks.
 *
 *   slope     the specific force along x without the reference's acceleration, low-passed, is the sine of the slope
 *             ahead; that along z is the cosine of the whole tilt. JP_FAULT_SLOPE: the sine is beyond that of
 *             monitor.tilt_limit, or the cosine below `upright`. The cosine tells a tilt to the side late: with an
 *             accelerometer that is off by 0.02 g, 15° and 30° look alike.
 *   stalled   the current is at `stall_current` and the wheel does not turn: JP_FAULT_STALLED_LEFT, _RIGHT
 *   in air    in straight motion: of the current that the ground should take, a side takes less than a quarter and the
 *             other more than a half: JP_FAULT_WHEEL_IN_AIR. It is not judged where the ground should take less than
 *             `carried`: on level ground gears may take more than the ground does
 *   spinning  gyro and wheels contradict each other by `spin_rate` and three quarters of what the wheels say:
 *             JP_FAULT_WHEELS_SPIN
 */
#ifndef JOULEPATH_SKID_MONITOR_H
#define JOULEPATH_SKID_MONITOR_H

#include <joulepath/monitor.h>
#include <joulepath/skid_control.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_skid_monitor_config {
    jp_q24 upright;            /**< specific force along z below it is too steep, g; 0…1 */
    jp_q31 smoothing;          /**< share that a call takes into slope, tilt and currents; above 0 */
    jp_q16 stall_current;      /**< A; above 0 */
    jp_turns_per_s stall_rate; /**< a wheel that rolls less in a tick does not turn, turn/s; above 0 */
    jp_q16 friction;           /**< dry friction of a side, A; 0…2 047 */
    jp_q16 carried;            /**< the least that is judged of what the ground takes, A; above 0 */
    jp_q24 turn_per_wheel;     /**< r/B, turns of the body for one that the right wheel is ahead; above 0, at most 8 */
    jp_turns_per_s spin_rate;  /**< turn/s; above 0 */
    uint16_t slope_calls;      /**< calls until it is a fault; at least 1 */
    uint16_t stall_calls;      /**< at least 1 */
    uint16_t contradicted_calls; /**< until a side is in the air, or the wheels spin; at least 1 */
};

struct jp_skid_monitor {
    bool started;                  /**< a frame was seen */
    jp_q24 rise;                   /**< sine of the slope ahead, uphill positive, low-passed */
    jp_q24 upright;                /**< specific force along z, g, low-passed */
    jp_q24 steepest;               /**< sine of the greatest slope */
    jp_q16 load[JP_SKID_SIDES];    /**< what a side should take, A, low-passed */
    jp_q16 current[JP_SKID_SIDES]; /**< what it takes, A, low-passed */
    uint16_t slope_calls;
    uint16_t stalled_calls[JP_SKID_SIDES];
    uint16_t air_calls;
    uint16_t spin_calls;
};

/** What the wheels and the body do. */
struct jp_skid_motion {
    const struct jp_skid_control *control; /**< after its update */
    jp_q16 current[JP_SKID_SIDES];         /**< A */
    jp_turns_per_s turn_rate;              /**< of the body by the gyro, turn/s */
    jp_q24 steering;                       /**< χ, skid_control.h */
    bool straight;                         /**< it shall not turn */
};

/** Checks every field. JP_ERR_CONFIG: *field names the first one out of range. JP_ERR_ARGUMENT: a pointer is null. Not
 *  for ISRs. */
enum jp_status jp_skid_monitor_check(const struct jp_skid_monitor_config *config, const char **field);

/** Starts without a fault; `tilt_limit` is that of monitor.h. The configuration must have passed its check. One sine.
 */
void jp_skid_monitor_start(struct jp_skid_monitor *monitor, jp_q24 tilt_limit);

/** Takes a frame; `acceleration` is the reference's, m/s². JP_FAULT_SLOPE or 0. Constant time; for the control ISR. */
uint16_t jp_skid_monitor_ground(struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                                const struct jp_sensors *sensors, jp_q24 acceleration);

/** The ground is steeper than the robot may drive, or no frame was seen. Constant time; any context. */
bool jp_skid_monitor_is_steep(const struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config);

/** While the motors run: the confirmed faults of the wheels, 0 for none. Constant time; for the control ISR. */
uint16_t jp_skid_monitor_wheels(struct jp_skid_monitor *monitor, const struct jp_skid_monitor_config *config,
                                const struct jp_skid_motion *motion);

#ifdef __cplusplus
}
#endif

#endif
