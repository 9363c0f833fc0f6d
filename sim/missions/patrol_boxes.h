/** What the map of a patrol does not show: boxes in the way that the robot would take by the map. */
#ifndef JOULEPATH_SIM_MISSIONS_PATROL_BOXES_H
#define JOULEPATH_SIM_MISSIONS_PATROL_BOXES_H

#include "sim/four_wheel/four_wheel_file.h"
#include "sim/scenes/patrol_task.h"

/** Puts `boxes` of 0.2 to 0.6 m a side on the ground, along the path over the map and beside it, none within a metre of
 *  start and goal. False after one line on stderr: no way leads to the goal, or no memory. */
bool patrol_boxes_hide(struct patrol_scene *scene, const struct four_wheel_file *robot, unsigned boxes, uint64_t seed);

#endif
