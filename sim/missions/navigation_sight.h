/** What a navigator's drive takes of the simulated world: where the robot truly is, what it sees, how near it comes to
 * what is blocked. */
#ifndef JOULEPATH_SIM_MISSIONS_NAVIGATION_SIGHT_H
#define JOULEPATH_SIM_MISSIONS_NAVIGATION_SIGHT_H

#include "sim/balancer/plant.h"
#include "sim/balancer/robot_constants.h"
#include "sim/missions/navigation_task.h"

/** Clearances are told up to it, m. */
#define NAVIGATION_CLEARANCE_MAX 0.25

/** Of a task, m from the south-west corner of the map. */
struct clearance_pose navigation_start(const struct navigation_task *task);

/** The same in the library's numbers. */
struct jp_place navigation_place(const struct clearance_pose *pose);

/** Of a robot that was switched on at the start. */
struct clearance_pose navigation_pose(const struct clearance_pose *start, const struct plant *plant);

struct clearance_robot navigation_body(const struct robot_file *robot);

/** From the goal cell's centre, m. */
double navigation_goal_error(const struct navigation_task *task, const struct clearance_pose *pose);

/** Tells each cell that is in view and otherwise than the map says, on the map where a robot takes it to be that sees
 * it from where it truly is, and takes itself to be at `believed`. `tell` takes it over into the map, or returns false
 * and is told again later. Counts those it took. */
void navigation_look(const struct navigation_task *task, const struct clearance_pose *from,
                     const struct jp_place *believed, struct navigation_result *result,
                     bool (*tell)(void *context, int x, int y, enum jp_cell cell), void *context);

/** Whether the body touches something, and the least clearance so far. */
void navigation_measure(const struct navigation_task *task, const struct clearance_robot *body,
                        const struct clearance_pose *pose, struct navigation_result *result);

#endif
