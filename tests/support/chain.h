/**
 * A chain of segments that a robot drives back to back: each is handed over while the one before it runs, so that none
 * begins settled. Energies are those of exactly the segment's ticks.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_CHAIN_H
#define JOULEPATH_TESTS_SUPPORT_CHAIN_H

#include "sim/balancer/experiment.h"

/** What segments are drawn from, uniform in each. */
struct chain_ranges {
    double backward_share;  /**< v: minus this share of the robot's limit */
    double speed_share;     /**< …to this share */
    double turn_rate_share; /**< w: ± */
    double turn_share;      /**< σ: ± */
    double shortest;        /**< s; rounded to ticks, at least 2 */
    double longest;         /**< s; at most 16 384 */
};

enum chain_end {
    CHAIN_DRIVEN, /**< to the segment's last tick */
    CHAIN_FELL,   /**< beyond the tilt limit */
    CHAIN_FAULT   /**< the robot switched off: `faults` */
};

/** The closed loop after a segment's last tick. Motion is the plant's; voltages, references and errors are those that
 *  the controller computed in that tick. */
struct chain_state {
    double x;                    /**< m */
    double y;                    /**< m */
    double yaw;                  /**< rad */
    double pitch;                /**< rad */
    double wheel_rate;           /**< rad/s */
    double pitch_rate;           /**< rad/s */
    double yaw_rate;             /**< rad/s */
    double voltage_left;         /**< V */
    double voltage_right;        /**< V */
    double wheel_error;          /**< reference − estimate, rad */
    double yaw_error;            /**< rad */
    double wheel_integral;       /**< of the error, rad·s */
    double yaw_integral;         /**< rad·s */
    double reference_wheel_rate; /**< rad/s */
    double reference_yaw_rate;   /**< rad/s */
    double wheel_lag;            /**< of the shaped reference behind the commanded one, rad */
    double yaw_lag;              /**< rad */
};

/** A segment: what was commanded, then what came of it. */
struct chain_record {
    struct experiment_segment command;
    uint32_t commanded_ticks;

    uint32_t ticks; /**< driven; fewer than commanded in a fall */
    enum chain_end end;
    uint16_t faults;          /**< enum jp_fault bits */
    double model;             /**< by the robot's meter (meter.h), with the file's Rm and electronics, J */
    double battery;           /**< by the robot's meter, with the electronics, J */
    double motor;             /**< of the plant: ∫ (ul² + ur²)/Rm, with its own Rm and without electronics, J */
    double electrical;        /**< of the plant: ∫ ul il + ur ir, without electronics, J */
    double charge;            /**< that left the battery, by plant and electronics, A·s */
    double bus_voltage;       /**< mean, V */
    uint32_t saturated_ticks; /**< with a limited voltage */
    struct chain_state state;
};

/** A change of the robot in mid-drive. */
struct chain_change {
    size_t at; /**< segment before whose first tick it happens */
    const struct robot_file *robot;
};

/** Draws the commands of a chain; what the records hold else is 0. */
void chain_draw(struct chain_record *records, size_t count, const struct robot_file *file,
                const struct chain_ranges *ranges, struct random *random);

/**
 * Releases a rig after rig_init() and drives a chain from standing. `change` may be NULL. A fall or a fault ends the
 * chain in the record of the segment where it happened. Returns how many records were driven, at least 1.
 */
size_t chain_run(struct rig *rig, struct chain_record *records, size_t count, const struct chain_change *change);

#endif
