#include "sim/missions/segment_route.h"

/** The next segment is planned this long before the current one ends: s⁻¹, so a tenth of a second. */
#define PLAN_LEAD_RATE 10U

static enum jp_status optimise(struct segment_route *route, const struct jp_motion *before,
                               const struct jp_point *start, jp_angle heading)
{
    return jp_segment_optimise(route->model, &jp_robot_configuration(route->robot)->limits, before, start, heading,
                               &route->targets[route->planned], &route->segment);
}

/** Once for the turn, once from where that leads. */
static enum jp_status plan_next(struct segment_route *route, const struct jp_telemetry *telemetry)
{
    const jp_q16 yaw_bandwidth = jp_robot_configuration(route->robot)->reference.yaw_bandwidth;
    const struct jp_motion *before = &telemetry->command;
    struct jp_point start;
    jp_angle heading;

    jp_robot_predict_end(route->robot, telemetry, &start, &heading);

    enum jp_status status = optimise(route, before, &start, heading);

    if (status == JP_OK && before->speed != 0 && yaw_bandwidth != 0) {
        start = jp_segment_turning_point(yaw_bandwidth, before->speed, &start, heading, route->segment.command.turn);
        status = optimise(route, before, &start, heading);
    }
    if (status == JP_OK) {
        status = jp_robot_drive(route->robot, &route->segment.command);
    }
    if (status == JP_OK) {
        route->planned++;
    }
    return status;
}

static bool is_due(const struct segment_route *route, const struct jp_telemetry *telemetry)
{
    const bool motors_run = telemetry->state == JP_ROBOT_BALANCING || telemetry->state == JP_ROBOT_DRIVING;

    return motors_run && !jp_robot_has_next(route->robot) &&
           telemetry->segment_ticks_left <= jp_robot_configuration(route->robot)->estimator.tick_rate / PLAN_LEAD_RATE;
}

enum jp_status segment_route_work(struct segment_route *route)
{
    struct jp_telemetry telemetry;

    return route->planned < route->count && jp_robot_telemetry(route->robot, &telemetry) && is_due(route, &telemetry)
               ? plan_next(route, &telemetry)
               : JP_OK;
}
