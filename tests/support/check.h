/** Assertions about numbers in double, which say what was measured. */
#ifndef JOULEPATH_TESTS_SUPPORT_CHECK_H
#define JOULEPATH_TESTS_SUPPORT_CHECK_H

#include <math.h>
#include <stdio.h>

#include "unity.h"

static inline void check_near(double expected, double actual, double bound, const char *what)
{
    char message[160];

    (void)snprintf(message, sizeof message, "%s: expected %.9g ± %.2g, is %.9g", what, expected, bound, actual);
    TEST_ASSERT_TRUE_MESSAGE(fabs(actual - expected) <= bound, message);
}

static inline void check_below(double value, double bound, const char *what)
{
    char message[160];

    (void)snprintf(message, sizeof message, "%s: %.4g, allowed %.4g", what, value, bound);
    TEST_ASSERT_TRUE_MESSAGE(value <= bound, message);
}

#endif
