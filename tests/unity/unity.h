/**
 * Assertions and runner with the names and the output of ThrowTheSwitch Unity, which need no floating point, no heap
 * and no stdio on a target. The real unity.h can take the place of this one: `make test UNITY=<dir>`. So it includes no
 * system header that the real one does not, lest a test come to need it.
 *
 * Include it alone, from one source file of each test program. UNITY_OUTPUT_CHAR(c) and UNITY_OUTPUT_FLUSH() say where
 * the text goes; UNITY_INCLUDE_CONFIG_H reads them from unity_config.h.
 */
#ifndef UNITY_H
#define UNITY_H

#include "unity_checks.h"
#include "unity_integers.h"

#define UNITY_BEGIN()      unity_begin(__FILE__)
#define UNITY_END()        unity_end()
#define RUN_TEST(function) unity_run(function, #function, __LINE__)
#define TEST_PROTECT()     (setjmp(unity.abort) == 0)
#define TEST_ABORT()       longjmp(unity.abort, 1)

#define TEST_FAIL()                  unity_fail(__LINE__, NULL)
#define TEST_FAIL_MESSAGE(message)   unity_fail(__LINE__, message)
#define TEST_IGNORE()                unity_ignore(__LINE__, NULL)
#define TEST_IGNORE_MESSAGE(message) unity_ignore(__LINE__, message)
#define TEST_PASS()                  unity_pass()
#define TEST_MESSAGE(message)        unity_message(__LINE__, message)

#define TEST_ASSERT(condition) unity_check((condition), " Expression Evaluated To FALSE", __LINE__, NULL)
#define TEST_ASSERT_MESSAGE(condition, message)                                                                        \
    unity_check((condition), " Expression Evaluated To FALSE", __LINE__, message)
#define TEST_ASSERT_TRUE(condition) unity_check((condition), " Expected TRUE Was FALSE", __LINE__, NULL)
#define TEST_ASSERT_TRUE_MESSAGE(condition, message)                                                                   \
    unity_check((condition), " Expected TRUE Was FALSE", __LINE__, message)
#define TEST_ASSERT_FALSE(condition) unity_check(!(condition), " Expected FALSE Was TRUE", __LINE__, NULL)
#define TEST_ASSERT_FALSE_MESSAGE(condition, message)                                                                  \
    unity_check(!(condition), " Expected FALSE Was TRUE", __LINE__, message)
#define TEST_ASSERT_UNLESS(condition) unity_check(!(condition), " Expression Evaluated To TRUE", __LINE__, NULL)
#define TEST_ASSERT_UNLESS_MESSAGE(condition, message)                                                                 \
    unity_check(!(condition), " Expression Evaluated To TRUE", __LINE__, message)
#define TEST_ASSERT_NULL(pointer)                  unity_check((pointer) == NULL, " Expected NULL", __LINE__, NULL)
#define TEST_ASSERT_NULL_MESSAGE(pointer, message) unity_check((pointer) == NULL, " Expected NULL", __LINE__, message)
#define TEST_ASSERT_NOT_NULL(pointer)              unity_check((pointer) != NULL, " Expected Non-NULL", __LINE__, NULL)
#define TEST_ASSERT_NOT_NULL_MESSAGE(pointer, message)                                                                 \
    unity_check((pointer) != NULL, " Expected Non-NULL", __LINE__, message)
#define TEST_ASSERT_NOT_EQUAL(expected, actual)                                                                        \
    unity_check((expected) != (actual), " Expected Not-Equal", __LINE__, NULL)
#define TEST_ASSERT_NOT_EQUAL_MESSAGE(expected, actual, message)                                                       \
    unity_check((expected) != (actual), " Expected Not-Equal", __LINE__, message)

#define TEST_ASSERT_EQUAL_STRING(expected, actual)                  unity_string(expected, actual, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, actual, message) unity_string(expected, actual, __LINE__, message)
#define TEST_ASSERT_EQUAL_STRING_LEN(expected, actual, length)                                                         \
    unity_string_start(expected, actual, length, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(expected, actual, length, message)                                        \
    unity_string_start(expected, actual, length, __LINE__, message)
#define TEST_ASSERT_EQUAL_MEMORY(expected, actual, bytes) unity_memory(expected, actual, bytes, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_MEMORY_MESSAGE(expected, actual, bytes, message)                                             \
    unity_memory(expected, actual, bytes, __LINE__, message)

#ifdef UNITY_INCLUDE_DOUBLE
#include <math.h>
#include <stdio.h>

static inline void unity_print_double(double value)
{
    char text[32];

    (void)snprintf(text, sizeof text, "%.9g", value);
    UnityPrint(text);
}

/** Unlike `fabs(difference) <= delta` this holds for equal infinities and for two NaNs, as in Unity. */
static inline _Bool unity_double_is_within(double delta, double expected, double actual)
{
    if (isnan(expected) || isnan(actual)) {
        return isnan(expected) && isnan(actual);
    }
    if (isinf(expected) || isinf(actual)) {
        return isinf(expected) && isinf(actual) && signbit(expected) == signbit(actual);
    }
    return fabs(expected - actual) <= fabs(delta);
}

static inline void unity_double_within(double delta, double expected, double actual, unsigned line, const char *message)
{
    if (!unity_double_is_within(delta, expected, actual)) {
        unity_fail_begin(line);
        UnityPrint(" Expected ");
        unity_print_double(expected);
        UnityPrint(" Was ");
        unity_print_double(actual);
        unity_fail_end(message);
    }
}

static inline void unity_double_compare(_Bool holds, const char *words, double threshold, double actual, unsigned line,
                                        const char *message)
{
    if (!holds) {
        unity_fail_begin(line);
        UnityPrint(" Expected ");
        unity_print_double(actual);
        UnityPrint(words);
        unity_print_double(threshold);
        unity_fail_end(message);
    }
}

#define UNITY_DOUBLE_PRECISION 1e-12

#define TEST_ASSERT_DOUBLE_WITHIN(delta, expected, actual) unity_double_within(delta, expected, actual, __LINE__, NULL)
#define TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(delta, expected, actual, message)                                            \
    unity_double_within(delta, expected, actual, __LINE__, message)
#define TEST_ASSERT_EQUAL_DOUBLE(expected, actual)                                                                     \
    unity_double_within((expected)*UNITY_DOUBLE_PRECISION, expected, actual, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(expected, actual, message)                                                    \
    unity_double_within((expected)*UNITY_DOUBLE_PRECISION, expected, actual, __LINE__, message)
#define TEST_ASSERT_GREATER_THAN_DOUBLE(threshold, actual)                                                             \
    unity_double_compare((actual) > (threshold), " to be greater than ", threshold, actual, __LINE__, NULL)
#define TEST_ASSERT_GREATER_THAN_DOUBLE_MESSAGE(threshold, actual, message)                                            \
    unity_double_compare((actual) > (threshold), " to be greater than ", threshold, actual, __LINE__, message)
#define TEST_ASSERT_GREATER_OR_EQUAL_DOUBLE(threshold, actual)                                                         \
    unity_double_compare((actual) >= (threshold), " to be greater than or equal to ", threshold, actual, __LINE__, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_DOUBLE_MESSAGE(threshold, actual, message)                                        \
    unity_double_compare((actual) >= (threshold), " to be greater than or equal to ", threshold, actual, __LINE__,     \
                         message)
#define TEST_ASSERT_LESS_THAN_DOUBLE(threshold, actual)                                                                \
    unity_double_compare((actual) < (threshold), " to be less than ", threshold, actual, __LINE__, NULL)
#define TEST_ASSERT_LESS_THAN_DOUBLE_MESSAGE(threshold, actual, message)                                               \
    unity_double_compare((actual) < (threshold), " to be less than ", threshold, actual, __LINE__, message)
#define TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(threshold, actual)                                                            \
    unity_double_compare((actual) <= (threshold), " to be less than or equal to ", threshold, actual, __LINE__, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_DOUBLE_MESSAGE(threshold, actual, message)                                           \
    unity_double_compare((actual) <= (threshold), " to be less than or equal to ", threshold, actual, __LINE__, message)
#define TEST_ASSERT_DOUBLE_IS_NAN(actual) unity_check(isnan(actual), " Expected NaN", __LINE__, NULL)
#define TEST_ASSERT_DOUBLE_IS_NAN_MESSAGE(actual, message)                                                             \
    unity_check(isnan(actual), " Expected NaN", __LINE__, message)
#define TEST_ASSERT_DOUBLE_IS_INF(actual)                                                                              \
    unity_check(isinf(actual) && (actual) > 0, " Expected Infinity", __LINE__, NULL)
#define TEST_ASSERT_DOUBLE_IS_INF_MESSAGE(actual, message)                                                             \
    unity_check(isinf(actual) && (actual) > 0, " Expected Infinity", __LINE__, message)
#define TEST_ASSERT_DOUBLE_IS_DETERMINATE(actual) unity_check(isfinite(actual), " Expected Determinate", __LINE__, NULL)
#define TEST_ASSERT_DOUBLE_IS_DETERMINATE_MESSAGE(actual, message)                                                     \
    unity_check(isfinite(actual), " Expected Determinate", __LINE__, message)
#endif

#endif
