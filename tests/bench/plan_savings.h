/** What energy is saved at what length. */
#ifndef JOULEPATH_TESTS_BENCH_PLAN_SAVINGS_H
#define JOULEPATH_TESTS_BENCH_PLAN_SAVINGS_H

#include <jansson.h>

#include "tests/bench/plan_runs.h"

/** Measures it on all scenes; `curve_rows` gets one for each price of length. */
void plan_savings(const struct scene *scenes, json_t *figures, json_t *curve_rows);

#endif
