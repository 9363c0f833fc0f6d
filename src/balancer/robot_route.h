/** Where the next segment of a route begins: for all that plan one. Private to the core. */
#ifndef JOULEPATH_BALANCER_ROBOT_ROUTE_H
#define JOULEPATH_BALANCER_ROBOT_ROUTE_H

#include <joulepath/robot.h>

/** Where and how the robot will end its current segment: measured position, heading of the route. */
void jp_robot_predict_end(const struct jp_robot *robot, const struct jp_telemetry *telemetry, struct jp_point *position,
                          jp_angle *heading);

#endif
