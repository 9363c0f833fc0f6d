/** Sums of what learners of every kind expect. Private to the core. */
#ifndef JOULEPATH_LEARN_FORECAST_SUM_H
#define JOULEPATH_LEARN_FORECAST_SUM_H

#include "src/learn/learned_state.h"

void jp_forecast_sum_add(struct jp_forecast_sum *sum, const struct jp_expectation *expected);

/** Failures as jp_forecast_total(). */
enum jp_status jp_forecast_sum_total(const struct jp_learned_state *state, const struct jp_forecast_sum *sum,
                                     struct jp_forecast *forecast);

#endif
