/** Poses of the lattice, and which of them are the goal's. */
#ifndef JOULEPATH_SEARCH_PLANNER_POSE_H
#define JOULEPATH_SEARCH_PLANNER_POSE_H

#include <joulepath/planner.h>

static inline bool jp_pose_is_same(const struct jp_lattice_pose *a, const struct jp_lattice_pose *b)
{
    return a->x == b->x && a->y == b->y && a->heading == b->heading;
}

/** True at the goal's cell and one of its headings. */
static inline bool jp_pose_is_goal(const struct jp_goal *goal, const struct jp_lattice_pose *pose)
{
    return pose->x == goal->x && pose->y == goal->y && ((goal->headings >> pose->heading) & 1U) != 0U;
}

#endif
