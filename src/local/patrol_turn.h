/** Turns in place, and the steps to where there is room for them. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_TURN_H
#define JOULEPATH_LOCAL_PATROL_TURN_H

#include <joulepath/patrol.h>

/** After a turn to its way the robot drives on, and may be off by so much, rad. */
#define JP_PATROL_ROUGHLY 0.07f

/** Of a robot that moves: while it brakes it keeps its curve, and its centre slows down less than the outermost wheel,
 *  m/s². */
float jp_patrol_braking(const struct jp_patrol_config *config, float speed, float turn_rate);

/** Fastest from which the robot stops within a distance at a deceleration, m and m/s² or rad and rad/s²: what is asked
 *  of the wheels acts after the latency, and the next of it a period later. */
float jp_patrol_stopping_speed(const struct jp_patrol_config *config, float deceleration, float distance);

bool jp_patrol_is_standing(const struct jp_plane_speed *speed);

/** Counts a cycle in which the path is free. True when it has been free for long enough to go on. */
bool jp_patrol_trust_path(struct jp_patrol *patrol);

/** That a step along a known way keeps, m; one to where there is room for a turn keeps less where less was found. */
float jp_patrol_step_clearance(const struct jp_patrol_config *config);

/** The step to the goal, if it is near and not behind. */
bool jp_patrol_find_step_to_goal(struct jp_patrol *patrol);

/** The same with no more clearance than a turn keeps, where there is not more. */
bool jp_patrol_find_last_step(struct jp_patrol *patrol);

/** Begins the turn to the goal's heading, if it and the step to the goal after it are free. */
bool jp_patrol_turn_before_step(struct jp_patrol *patrol);

/** Begins the step that was found. */
void jp_patrol_begin_step(struct jp_patrol *patrol);

/** Begins a turn in place, or a step to where there is room for it; waits where there is none. */
void jp_patrol_turn_to(struct jp_patrol *patrol, float heading);

/** Brakes; from a stand begins a turn in place to a heading, or a step to where there is room for it, that keep what
 * the robot keeps beside things. False: neither is free, or two did not bring it on. */
bool jp_patrol_make_room(struct jp_patrol *patrol, float heading, bool is_standing);

/** A cycle of the state TURNING. */
void jp_patrol_turn(struct jp_patrol *patrol, const struct jp_plane_speed *speed);

/** A cycle of the state STEPPING. */
void jp_patrol_step(struct jp_patrol *patrol, const struct jp_plane_speed *speed);

#endif
