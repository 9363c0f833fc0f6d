/**
 * The paper's greedy plan: a robot drives through targets segment by segment, each planned for least energy shortly
 * before the one before it ends, from where and as that one will end.
 */
#ifndef JOULEPATH_SIM_MISSIONS_SEGMENT_ROUTE_H
#define JOULEPATH_SIM_MISSIONS_SEGMENT_ROUTE_H

#include <joulepath/robot.h>
#include <joulepath/segment.h>

/** Targets and model must stay until the robot stands. All zero: nothing to drive. */
struct segment_route {
    struct jp_robot *robot;
    const struct jp_energy_model *model;
    const struct jp_point *targets;
    uint16_t count;
    uint16_t planned;          /**< segments handed over */
    struct jp_segment segment; /**< the last of them */
};

/** Between ticks: plans the next segment when it is due. Returns the failure of planning, else JP_OK. */
enum jp_status segment_route_work(struct segment_route *route);

#endif
