/** Planners of OMPL on the plane, for a robot that turns on the spot and drives straight. */
#ifndef JOULEPATH_TESTS_BENCH_OMPL_PEER_H
#define JOULEPATH_TESTS_BENCH_OMPL_PEER_H

#include <joulepath/planner.h>

#ifdef __cplusplus
extern "C" {
#endif

enum ompl_planner { OMPL_RRT_STAR, OMPL_BIT_STAR, OMPL_PLANNERS };

/** Length of the route that a planner has found after `seconds`, m; infinite when it has none. The robot must fit at
 *  the heading of the lattice that is nearest to its way; its turns are free, and so are steps of any height. */
double ompl_length(enum ompl_planner planner, const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                   const struct jp_lattice_pose *start, const struct jp_goal *goal, double seconds);

#ifdef __cplusplus
}
#endif

#endif
