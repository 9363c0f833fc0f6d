/**
 * A mission of a robot that differs from its file: it learns on the way, then says what a route there and back will
 * take and how sure that is, and drives it.
 */
#ifndef JOULEPATH_SIM_MISSIONS_TRIP_H
#define JOULEPATH_SIM_MISSIONS_TRIP_H

#include "sim/balancer/rig.h"
#include "sim/balancer/variation.h"

/** Targets on the way on which it learns, and of the route it is asked about: out, back beside them, and home. */
#define TRIP_LEARNING_TARGETS 24
#define TRIP_OUT_MIN          3
#define TRIP_OUT_MAX          8

enum trip_fault {
    TRIP_FAULT_NONE,
    TRIP_FAULT_PUSHES,          /**< a push every few seconds */
    TRIP_FAULT_DROPPED_SAMPLES, /**< single frames cannot be read */
    TRIP_FAULT_CURRENT_OFFSET   /**< of the left current sensor */
};
#define TRIP_FAULTS 4

/** What changes in the middle of the way on which it learns. */
enum trip_change { TRIP_CHANGE_NONE, TRIP_CHANGE_GROUND, TRIP_CHANGE_PAYLOAD };
#define TRIP_CHANGES 3

enum trip_outcome { TRIP_DONE, TRIP_FELL, TRIP_STOPPED };

struct trip {
    uint64_t seed;
    struct variation variation; /**< at its end */
    enum trip_fault fault;
    enum trip_change change;
    enum trip_outcome outcome;
    unsigned segments; /**< of the route asked about */
    double seconds;    /**< simulated, in all */
    double predicted;  /**< J */
    double deviation;  /**< standard deviation of it, J */
    double measured;   /**< by the robot's meter, J */
    double unlearned;  /**< what the built-in model predicts, J */
    double available;  /**< J, of the reserve question */
    bool answer;       /**< yes with 95 % confidence */
    double ground;     /**< ground friction as learned, relative to the robot file */
    double payload;    /**< as learned, kg */
    double charge;     /**< drawn from the battery in all, A·s */
    unsigned outliers; /**< legs that counted less than they were off */
    unsigned version;  /**< of what was learned: segments that it was learned from */
    struct jp_energy_model learned;
};

/** Runs the trip of a seed; with `disturbed` it has a fault or a change more often than not. False after one line on
 *  stderr. */
bool trip_run(struct trip *trip, const struct robot_entry *entry, const struct robot_file *file, uint64_t seed,
              bool disturbed);

#endif
