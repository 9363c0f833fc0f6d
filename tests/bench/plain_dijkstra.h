/** The baseline: Dijkstra over all states of a lattice, in double precision, with a binary heap and a list of swept
 *  cells a primitive. */
#ifndef JOULEPATH_TESTS_BENCH_PLAIN_DIJKSTRA_H
#define JOULEPATH_TESTS_BENCH_PLAIN_DIJKSTRA_H

#include <joulepath/planner.h>

/** Physical energy of the best route, J; infinite when there is none. */
double plain_dijkstra(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                      const struct jp_lattice_pose *start, const struct jp_goal *goal);

#endif
