/** Of values that a bench measured. */
#ifndef JOULEPATH_TESTS_BENCH_STATISTICS_H
#define JOULEPATH_TESTS_BENCH_STATISTICS_H

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static inline int statistics_compare(const void *a, const void *b)
{
    const double difference = *(const double *)a - *(const double *)b;

    return (difference > 0) - (difference < 0);
}

/** 0 of none. The values get sorted. */
static inline double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, statistics_compare);
    return count == 0 ? 0 : (values[(count - 1) / 2] + values[count / 2]) / 2;
}

static inline double mean(const double *values, size_t count)
{
    double sum = 0;

    for (size_t i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum / (double)count;
}

static inline double least(const double *values, size_t count)
{
    double least_value = values[0];

    for (size_t i = 1; i < count; i++) {
        least_value = fmin(least_value, values[i]);
    }
    return least_value;
}

static inline double greatest(const double *values, size_t count)
{
    double greatest_value = values[0];

    for (size_t i = 1; i < count; i++) {
        greatest_value = fmax(greatest_value, values[i]);
    }
    return greatest_value;
}

#endif
