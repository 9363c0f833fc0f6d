/** The planner beside a plain A*, igraph's Dijkstra and OMPL's planners of the shortest path. */
#ifndef JOULEPATH_TESTS_BENCH_PLAN_PEERS_H
#define JOULEPATH_TESTS_BENCH_PLAN_PEERS_H

#include <jansson.h>

struct scene;

void plan_peers(const struct scene *scenes, json_t *figures);

#endif
