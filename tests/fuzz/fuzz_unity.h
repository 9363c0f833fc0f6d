/**
 * In place of Unity, so that a fuzz target drives the rigs of tests/support: an assertion that fails is a finding.
 */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_UNITY_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_UNITY_H

#if defined UNITY_H || defined UNITY_FRAMEWORK_H
#error "unity.h was included before"
#endif
#define UNITY_H
#define UNITY_FRAMEWORK_H

#include "tests/fuzz/fuzz_input.h"

#define TEST_ASSERT_TRUE(condition)                     fuzz_require((condition), #condition)
#define TEST_ASSERT_NULL(pointer)                       fuzz_require((pointer) == NULL, #pointer " is not null")
#define TEST_ASSERT_EQUAL_INT(expected, actual)         fuzz_require((expected) == (actual), #actual)
#define TEST_ASSERT_GREATER_THAN_UINT32(bound, actual)  fuzz_require((uint32_t)(actual) > (uint32_t)(bound), #actual)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT32(bound, actual) fuzz_require((uint32_t)(actual) <= (uint32_t)(bound), #actual)
#define TEST_ASSERT_INT32_WITHIN(bound, expected, actual)                                                              \
    fuzz_require(llabs((long long)(expected) - (long long)(actual)) <= (bound), #actual)

#endif
