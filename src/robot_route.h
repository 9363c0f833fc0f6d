/** Where the next segment of a route begins: for all that plan one. Private to the core. */
#ifndef JOULEPATH_ROBOT_ROUTE_H
#define JOULEPATH_ROBOT_ROUTE_H

#include <joulepath/robot.h>

/** Where and how the robot will end its current segment: measured position, heading of the route. */
void jp_robot_predict_end(const struct jp_robot *robot, const struct jp_telemetry *telemetry, struct jp_point *position,
                          jp_angle *heading);

/**
 * While the shaped reference turns by `turn` rad, the robot drives on toward the old heading: by 2τ, the tracker's lag,
 * at the old speed. As if it had turned at once from the point returned instead of `start`. The bandwidth is above 0.
 */
struct jp_point jp_turning_point(jp_q16 yaw_bandwidth, jp_q24 speed, const struct jp_point *start, jp_angle heading,
                                 jp_q24 turn);

#endif
