/**
 * The far side of the bus as seen from the ECU: the plant and, if there is a task, an operator, tick by tick.
 *
 * In lockstep the simulator owns time: a tick ends when the ECU has answered it. In real time a tick ends with its
 * millisecond, and commands that came too late for it are counted.
 */
#ifndef JOULEPATH_SIM_BUS_BUS_DRIVE_H
#define JOULEPATH_SIM_BUS_BUS_DRIVE_H

#include "hal/app/navigation_operator.h"
#include "hal/app/operator.h"
#include "hal/linux/can_link.h"
#include "sim/bus/ecu_view.h"
#include "sim/bus/plant_node.h"

/** What a drive's patience is at first, s. */
#define BUS_DRIVE_PATIENCE 10

/** What happens to the ECU and the plant in a tick. */
struct bus_drive_conditions {
    bool ecu_reset;       /**< the ECU has no power */
    bool ecu_bus_off;     /**< its CAN controller is off the bus */
    bool plant_paused;    /**< the plant stands still and sends nothing, while the ECU goes on */
    bool operator_silent; /**< the operator neither sends nor hears */
};

struct bus_drive {
    struct jp_can_link link;
    struct plant_node plant;
    struct jp_operator commander;
    struct jp_navigation_operator *navigation; /**< commands in its place; NULL: nobody does */
    struct ecu_view view;
    struct bus_drive_conditions conditions;
    unsigned patience; /**< s of the wall's clock after which an ECU that does not answer in lockstep counts as gone */
    uint32_t tick;     /**< since the start, pauses included */
    uint64_t ticks_driven; /**< with bridges on */
    uint64_t late;         /**< of those: ticks whose command did not come in time */
};

/** At rest, held upright. The link must stay open. A drive must not be moved after it. */
void bus_drive_init(struct bus_drive *drive, const struct robot_file *robot, uint64_t seed,
                    const struct jp_can_link *link);

/** The same with a robot that its sides steer, at rest at a pose. What `ground` points to stays in use. */
void bus_drive_init_skid(struct bus_drive *drive, const struct skid_steer_model *model,
                         const struct skid_ground *ground, const struct planar_pose *pose, uint64_t seed,
                         const struct jp_can_link *link);

/** The same with a robot with four steered wheels, whose body stays in use. */
void bus_drive_init_patrol(struct bus_drive *drive, struct patrol_body *body, const struct jp_can_link *link);

/** One tick in lockstep; false when the ECU did not answer for so long as the drive has patience. */
bool bus_drive_lockstep(struct bus_drive *drive);

/** One tick in real time, called at its end: what has arrived acts on the plant, which then measures for the next. */
void bus_drive_real_time(struct bus_drive *drive);

#endif
