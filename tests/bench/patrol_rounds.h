/**
 * Robots that differ from their tables on rounds between places of a hall among people, and home to the charger while
 * the energy in the battery lasts.
 *
 * Cases: the warehouse of a seed; four places drawn evenly where a robot that turns has 0.1 m to spare on map and
 * ground; stays of 5…30 s; a robot drawn by four_wheel_random_variation(); a battery of 12 kJ, of which 200 J shall be
 * left. Three people who walk between two such places at least 3 m apart, on a straight line with half a metre free on
 * both its sides, at 0.6…1.5 m/s, and stay 5…60 s at each end.
 */
#ifndef JOULEPATH_TESTS_BENCH_PATROL_ROUNDS_H
#define JOULEPATH_TESTS_BENCH_PATROL_ROUNDS_H

#include <jansson.h>

#include "sim/four_wheel/four_wheel_file.h"

/** How far from where it was to be a robot says that it has arrived, worst of some visits. */
struct patrol_rounds_error {
    double position; /**< m */
    double heading;  /**< ° */
};

struct patrol_rounds_outcome {
    unsigned visits;
    unsigned charges;
    unsigned skipped;
    unsigned below_reserve; /**< homecomings with less than the reserve */
    unsigned stranded;      /**< 1: the battery ran out before it was home */
    unsigned failed;        /**< 1: it gave up */
    unsigned collisions;    /**< with people by contact.h, and with things */
    unsigned walked_into;
    double energy; /**< J */
    double length; /**< m */
    double hours;  /**< until it ended */
    struct patrol_rounds_error worst;
    struct patrol_rounds_error worst_of_last_hour;
};

/** False without memory. */
bool patrol_rounds_run(const struct four_wheel_file *robot, uint64_t seed, double hours,
                       struct patrol_rounds_outcome *outcome);

/** Of several, one after the other. */
struct patrol_rounds_outcome patrol_rounds_sum(const struct patrol_rounds_outcome *outcomes, int count);

json_t *patrol_rounds_row(const struct patrol_rounds_outcome *outcome, uint64_t seed);

#endif
