/** What a patrol robot's battery holds, and a charger that it stands at: its contacts close when the robot stands
 * before it, and while they are closed the charger tells what the battery holds, in BatteryCharge. */
#ifndef JOULEPATH_SIM_BUS_PATROL_BATTERY_H
#define JOULEPATH_SIM_BUS_PATROL_BATTERY_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can/can.h"
#include "sim/four_wheel/four_wheel_plant.h"

struct patrol_battery {
    double held_j; /**< below 0 it is empty */
    double full_j;
    double charger_w;
    struct planar_pose charger; /**< as the robot stands at it, from the map's south-west corner */
    bool is_at_charger;
    uint8_t counter; /**< of BatteryCharge */
};

/** Full, and at the charger. */
void patrol_battery_init(struct patrol_battery *battery, double full_j, double charger_w,
                         const struct planar_pose *charger);

/** A tick of so many seconds in which the robot took so many joules. */
void patrol_battery_step(struct patrol_battery *battery, const struct four_wheel_state *state, double taken_j,
                         double seconds);

/** What the charger tells, if it is due in this tick. */
void patrol_battery_tell(struct patrol_battery *battery, uint64_t tick, const struct jp_can_port *port);

#endif
