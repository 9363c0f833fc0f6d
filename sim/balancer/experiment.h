/**
 * The paper's identification experiment (its section 3.1): two random segments of equal length, one after the other;
 * the second one's energy is split at the settling time.
 */
#ifndef JOULEPATH_SIM_BALANCER_EXPERIMENT_H
#define JOULEPATH_SIM_BALANCER_EXPERIMENT_H

#include "sim/balancer/rig.h"

/** Settled: from here on the mean voltages of successive windows differ by less than a threshold. */
#define EXPERIMENT_WINDOW_TICKS 200

/** One step of the reference and how long it is held. */
struct experiment_segment {
    double speed;     /**< v, m/s */
    double turn_rate; /**< w, rad/s */
    double turn;      /**< σ, rad */
};

struct experiment {
    struct experiment_segment first;
    struct experiment_segment second;
    double voltage_left;     /**< at the end of the first segment, V */
    double voltage_right;    /**< V */
    double settling;         /**< of the second segment, s */
    enum jp_robot_state end; /**< JP_ROBOT_DRIVING: both segments were driven; else what ended them */
    uint16_t faults;         /**< enum jp_fault bits at the end */
};

/** What the robot's own meters measured of the motors, J: joulepath/meter.h, without the electronics. */
struct experiment_energy {
    double motor;   /**< (ul² + ur²)/Rm */
    double battery; /**< ul il + ur ir */
};

/** Draws both segments within the robot's limits. */
void experiment_draw(struct experiment *experiment, const struct robot_file *file, struct random *random);

/**
 * Drives both segments for `seconds` each. energy[k], k = 0…n, is that of the second segment up to multiples of
 * EXPERIMENT_WINDOW_TICKS ticks. `threshold` in V.
 */
void experiment_run(struct experiment *experiment, struct rig *rig, double seconds, double threshold,
                    struct experiment_energy *energy);

/** The command that the robot takes. */
struct jp_segment_command experiment_command(const struct experiment_segment *segment, double seconds);

#endif
