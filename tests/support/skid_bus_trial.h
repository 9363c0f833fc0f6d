/**
 * A short random mission of a robot that its sides steer, over a bus on which things go wrong and on ground and sensors
 * that fail, one at a time or several together, as a seed draws them.
 *
 * What the controller promises: whatever comes, it moves only where the operator sends it. Once it is told to stand,
 * hears nothing any more or finds a fault, it stands within the way that skid_robot.h states. A drive ends at its
 * target or with a fault that has a name.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_SKID_BUS_TRIAL_H
#define JOULEPATH_TESTS_SUPPORT_SKID_BUS_TRIAL_H

#include "sim/base/world_fault.h"
#include "sim/bus/bus_drive.h"
#include "sim/skid_steer/skid_robots.h"
#include "tests/support/bus_faults.h"

/** An outage of at most so long is ridden out, ms. */
#define SKID_BUS_OUTAGE_MAX 40U

#define SKID_BUS_FAULTS_MAX  4
#define SKID_BUS_TARGETS_MAX 3

struct skid_bus_fault {
    enum bus_fault_kind kind;
    uint64_t from;  /**< tick */
    uint64_t until; /**< tick, exclusive */
    double share;
    int side;
    struct world_fault sensor;
};

enum skid_bus_end {
    SKID_BUS_DONE,
    SKID_BUS_NAMED,   /**< it stands with a fault that is named, and something had failed */
    SKID_BUS_ALARM,   /**< so, but nothing had failed that should name a fault */
    SKID_BUS_UNNAMED, /**< a fault without a name, or neither done nor a fault in two minutes */
    SKID_BUS_MOVED,   /**< it moved without a command, or farther than stated */
    SKID_BUS_ASTRAY,  /**< the end is not where it was sent */
    SKID_BUS_TIPPED,
    SKID_BUS_NO_ECU,
    SKID_BUS_ENDS
};

struct skid_bus_trial {
    uint64_t seed;
    const struct skid_robot_entry *robot;
    const struct skid_steer_model *model;
    struct jp_point targets[SKID_BUS_TARGETS_MAX];
    size_t target_count;
    struct skid_bus_fault faults[SKID_BUS_FAULTS_MAX];
    size_t fault_count;

    enum skid_bus_end end;
    bool thrown; /**< a side that jammed tipped it over, or an encoder or inertial sensor misled it: no controller could
                      know better */
    double stop; /**< longest way to a stand, of the stated one */
    uint16_t robot_faults; /**< enum jp_fault bits that the ECU had found at the end */
    uint32_t ticks;
    double end_error; /**< m */
    uint64_t fingerprint;
};

const char *skid_bus_end_name(enum skid_bus_end end);

/** Draws the trial of this seed, for a robot. */
void skid_bus_trial_draw(struct skid_bus_trial *trial, uint64_t seed, const struct skid_robot_entry *robot,
                         const struct skid_steer_model *model);

/** Drives it in this process. Prints one line on stderr and returns false when the robot is refused. */
bool skid_bus_trial_run(struct skid_bus_trial *trial);

#endif
