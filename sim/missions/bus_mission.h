/**
 * A scenario's mission over a bus: the controller is a node of its own, and all that is known of it came in frames.
 * The result has the form of mission.h, so that it is reported like any other; where the robot was is the plant's
 * truth.
 */
#ifndef JOULEPATH_SIM_MISSIONS_BUS_MISSION_H
#define JOULEPATH_SIM_MISSIONS_BUS_MISSION_H

#include "sim/bus/bus_drive.h"
#include "sim/missions/mission.h"

enum bus_mission_pace {
    BUS_MISSION_LOCKSTEP, /**< as fast as the ECU answers */
    BUS_MISSION_PACED,    /**< in lockstep, but no faster than the clock: for people and clients that look on */
    BUS_MISSION_REAL_TIME /**< each tick takes its time, answered or not */
};

struct bus_mission_timing {
    enum bus_mission_pace pace;
    unsigned patience; /**< of bus_drive.h, s */
};

struct bus_mission {
    struct mission mission;
    struct bus_drive drive;
    uint64_t fingerprint;     /**< of the plant's states of all ticks and of the energies: equal for equal runs */
    double worst_lateness_us; /**< real time: of the plant's own timer */
    uint64_t missed_periods;  /**< real time: ticks that the plant's own timer missed */
};

/** By which the ECU drives. */
enum mission_strategy bus_mission_strategy(const struct scenario *scenario);

/**
 * Drives the scenario's route and fills in *result. `link` stays open. `view` may be NULL. Prints one line on stderr
 * and returns false when the route was not driven to its end.
 */
bool bus_mission_run(struct bus_mission *result, const struct scenario *scenario, const struct jp_can_link *link,
                     struct bus_mission_timing timing, const struct mission_view *view);

/** The body alone: runs for `seconds` (0: for ever, until `stop` says so) for an operator elsewhere on the bus.
 * False after one line on stderr: in lockstep the ECU did not answer. */
bool bus_mission_host(struct bus_mission *result, const struct scenario *scenario, const struct jp_can_link *link,
                      struct bus_mission_timing timing, double seconds, bool (*stop)(void));

#endif
