/** Dijkstra of igraph over all states of a lattice. */
#ifndef JOULEPATH_TESTS_BENCH_IGRAPH_PEER_H
#define JOULEPATH_TESTS_BENCH_IGRAPH_PEER_H

#include <joulepath/planner.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Physical cost of the best route to the first of the goal's headings, cost units; infinite when there is none. The
 *  graph is made first, of all edges of the map. */
double igraph_cost(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                   const struct jp_lattice_pose *start, const struct jp_goal *goal);

#ifdef __cplusplus
}
#endif

#endif
