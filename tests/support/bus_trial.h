/**
 * A short random mission over a bus on which things go wrong, one at a time or several together, as a seed draws them.
 *
 * What the controller promises: outages of at most BUS_TRIAL_OUTAGE_MAX ticks, BUS_TRIAL_OUTAGE_GAP apart, and up to
 * BUS_FAULT_SHARE_MAX of the frames lost, late, swapped, repeated or corrupt do not make the robot fall. Without
 * commands it stands BUS_TRIAL_STOP_MAX seconds later. Whatever comes over the bus, it drives only where the operator
 * sends it, and once the bus is well again it finishes the route.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_BUS_TRIAL_H
#define JOULEPATH_TESTS_SUPPORT_BUS_TRIAL_H

#include "sim/balancer/robots.h"
#include "sim/bus/bus_drive.h"
#include "tests/support/bus_faults.h"

#define BUS_TRIAL_OUTAGE_MAX 40U
#define BUS_TRIAL_OUTAGE_GAP 500U
#define BUS_TRIAL_STOP_MAX   6.0

#define BUS_TRIAL_FAULTS_MAX  4
#define BUS_TRIAL_TARGETS_MAX 3

struct bus_trial_fault {
    enum bus_fault_kind kind;
    uint64_t from;  /**< tick */
    uint64_t until; /**< tick, exclusive */
    double share;
    enum world_channel channel; /**< that freezes */
};

enum bus_trial_end {
    BUS_TRIAL_DONE,
    BUS_TRIAL_FELL,
    BUS_TRIAL_MOVED,  /**< it drove without a command */
    BUS_TRIAL_ASTRAY, /**< the end is not where it was sent */
    BUS_TRIAL_LATE,   /**< the route was not done in two minutes */
    BUS_TRIAL_NO_ECU, /**< the ECU does not answer */
    BUS_TRIAL_ENDS
};

struct bus_trial {
    uint64_t seed;
    struct jp_point targets[BUS_TRIAL_TARGETS_MAX];
    size_t target_count;
    struct bus_trial_fault faults[BUS_TRIAL_FAULTS_MAX];
    size_t fault_count;

    enum bus_trial_end end;
    bool excused; /**< by a frozen sensor: the ECU names it, or the mission ends so without any other fault as well */
    uint32_t ticks;
    uint32_t attempts;   /**< to drive the route */
    double stop_seconds; /**< longest from a last command until it stood; 0: was never needed */
    double stop_metres;  /**< and how far it went in that time */
    double end_error;    /**< m */
    double peak_pitch_deg;
    uint16_t robot_faults; /**< enum jp_fault bits that the ECU reported last */
    uint64_t fingerprint;
};

const char *bus_trial_end_name(enum bus_trial_end end);

/** Draws the trial of this seed. */
void bus_trial_draw(struct bus_trial *trial, uint64_t seed);

/** Drives it in this process. Prints one line on stderr and returns false when the robot is refused. */
bool bus_trial_run(struct bus_trial *trial, const struct robot_entry *entry, const struct robot_file *file);

/** Drives it against an ECU elsewhere on the link, in lockstep. Equal seeds give equal fingerprints. */
void bus_trial_run_on(struct bus_trial *trial, const struct robot_file *file, const struct jp_can_link *link);

#endif
