/** The baselines: Dijkstra and A* over all states of a lattice, in double precision, with a binary heap and a list of
 *  swept cells a primitive. */
#ifndef JOULEPATH_TESTS_BENCH_PLAIN_SEARCH_H
#define JOULEPATH_TESTS_BENCH_PLAIN_SEARCH_H

#include <joulepath/planner.h>

/** Physical cost of the best route, cost units; infinite when there is none. */
double plain_dijkstra(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                      const struct jp_lattice_pose *start, const struct jp_goal *goal);

/** The same, led by what the moves from each cell to the goal cost at least, which a Dijkstra over the cells finds
 *  first. */
double plain_astar(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                   const struct jp_lattice_pose *start, const struct jp_goal *goal);

#endif
