/** What a replan costs when something has changed. */
#ifndef JOULEPATH_TESTS_BENCH_PLAN_REPLANS_H
#define JOULEPATH_TESTS_BENCH_PLAN_REPLANS_H

#include <jansson.h>

#include "tests/bench/plan_runs.h"

/** Measures it on all scenes; their ground is changed then. */
void plan_replans(struct scene *scenes, json_t *figures);

#endif
