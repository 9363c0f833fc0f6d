/** A drive of the navigator over a bus: the controller is a node of its own, which gets map, goal and what the sensor
 *  sees in frames, and tells in frames what it does. Where the robot is, is the plant's truth. */
#ifndef JOULEPATH_SIM_MISSIONS_BUS_NAVIGATION_H
#define JOULEPATH_SIM_MISSIONS_BUS_NAVIGATION_H

#include "sim/bus/bus_drive.h"
#include "sim/missions/navigation_task.h"

struct bus_navigation {
    struct bus_drive drive;
    struct jp_navigation_operator commander;
    struct navigation_result result;
    uint64_t fingerprint; /**< of the plant's states of all ticks and of the energy: equal for equal drives */
    double upload_s;      /**< of the map */
    size_t stream_bytes;  /**< of it */
};

/** Cells that feed it. */
struct bus_navigation_cells {
    struct cell_constants cell;
    struct cell_wiring wiring;
    struct cell_condition condition;
};

/** The body of one of these kinds; the other is NULL. */
struct bus_navigation_robot {
    const struct robot_file *balancer;
    const struct skid_steer_model *skid;
    const struct bus_navigation_cells *cells; /**< NULL: the constant supply of its file */
};

/** Drives a task in lockstep; its map is that of the robot, and its memory what the robot has. `link` stays open,
 * `patience` is of bus_drive.h, s. False after one line on stderr: the robot was not let drive to the end. */
bool bus_navigation_run(struct bus_navigation *navigation, const struct navigation_task *task,
                        const struct bus_navigation_robot *robot, const struct jp_can_link *link, unsigned patience);

#endif
