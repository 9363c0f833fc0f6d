/**
 * A random mission: released tilted, driven through a random route, pushed now and then. For the
 * count of falls and of saturated ticks in normal driving, which is all that is more than TRIAL_RECOVERY seconds after
 * the release and after the end of each push.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_TRIAL_H
#define JOULEPATH_TESTS_SUPPORT_TRIAL_H

#include "sim/balancer/rig.h"

#define TRIAL_TARGETS_MAX 6
#define TRIAL_TILT_DEG    10.0
#define TRIAL_PUSH_NS     1.0
#define TRIAL_RECOVERY    2.0

enum trial_strategy {
    TRIAL_SEGMENTS, /**< segment_route_work() */
    TRIAL_CRUISE    /**< jp_trajectory_by_rule() from the tilt, to a stand */
};

enum trial_end {
    TRIAL_DONE,      /**< drove the route and stood for TRIAL_RECOVERY seconds */
    TRIAL_FELL,      /**< beyond the tilt limit, or a fault */
    TRIAL_UNPLANNED, /**< a target could not be planned */
    TRIAL_LATE       /**< still driving after ten minutes */
};

struct trial {
    uint64_t seed;
    enum trial_strategy strategy;
    size_t target_count;
    struct jp_point targets[TRIAL_TARGETS_MAX]; /**< 3…6, each 2…12 m from the one before, in any direction */
    double tilt_deg;                            /**< ±TRIAL_TILT_DEG, how the robot is released */
    enum trial_end end;
    struct jp_telemetry last;
    uint64_t ticks;                  /**< since the release */
    uint64_t normal_ticks;           /**< of them in normal driving */
    uint64_t saturated_ticks;        /**< all */
    uint64_t normal_saturated_ticks; /**< in normal driving */
    double first_saturated_s;        /**< in normal driving, since the release; −1: never */
    uint32_t pushes;                 /**< 20…100 ms long, TRIAL_PUSH_NS forward or backward */
    double peak_voltage;             /**< in normal driving, V */
    double peak_pitch_deg;           /**< in normal driving */
    double peak_pitch_pushed_deg;    /**< after release and pushes */
    double end_error;                /**< distance to the last target at the end, m */
};

/** Draws the trial of this seed and drives it. Prints one line on stderr and returns false when the robot's
 *  configuration is refused. */
bool trial_run(struct trial *trial, enum trial_strategy strategy, const struct robot_entry *entry,
               const struct robot_file *file, uint64_t seed);

#endif
