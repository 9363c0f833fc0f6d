/**
 * Assertions and runner with the names and the output of ThrowTheSwitch Unity, in one header that needs no
 * floating point, no heap and no stdio on a target. The real unity.h can take its place: `make test UNITY=<dir>`.
 * So it includes nothing that the real one does not, lest a test come to need it.
 *
 * Include it from one source file of each test program. UNITY_OUTPUT_CHAR(c) and UNITY_OUTPUT_FLUSH() say where the
 * text goes; UNITY_INCLUDE_CONFIG_H reads them from unity_config.h.
 */
#ifndef UNITY_H
#define UNITY_H

#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>

#ifdef UNITY_INCLUDE_CONFIG_H
#include "tests/target/unity_config.h"
#endif

#ifndef UNITY_OUTPUT_CHAR
#include <stdio.h>
#define UNITY_OUTPUT_CHAR(c) (void)putchar(c)
#define UNITY_OUTPUT_FLUSH() (void)fflush(stdout)
#endif

#ifndef UNITY_OUTPUT_FLUSH
#define UNITY_OUTPUT_FLUSH() ((void)0)
#endif

void setUp(void);
void tearDown(void);

enum unity_style { UNITY_STYLE_INT, UNITY_STYLE_UINT, UNITY_STYLE_HEX };

enum unity_relation {
    UNITY_EQUAL,
    UNITY_NOT_EQUAL,
    UNITY_GREATER,
    UNITY_GREATER_OR_EQUAL,
    UNITY_LESS,
    UNITY_LESS_OR_EQUAL
};

/** How a number is compared and printed. */
struct unity_type {
    enum unity_style style;
    size_t bytes;
};

struct unity_state {
    const char *file;
    const char *test;
    unsigned line;
    unsigned tests;
    unsigned failures;
    unsigned ignored;
    _Bool test_failed;
    _Bool test_ignored;
    jmp_buf abort;
};

static struct unity_state unity;

static inline void UnityPrint(const char *text)
{
    while (*text != '\0') {
        UNITY_OUTPUT_CHAR(*text);
        text++;
    }
}

static inline void UnityPrintNumberUnsigned(uint64_t value)
{
    char digits[21];
    size_t i = sizeof digits - 1;

    digits[i] = '\0';
    do {
        digits[--i] = (char)('0' + (char)(value % 10));
        value /= 10;
    } while (value != 0);
    UnityPrint(&digits[i]);
}

static inline void UnityPrintNumber(int64_t value)
{
    if (value < 0) {
        UNITY_OUTPUT_CHAR('-');
    }
    UnityPrintNumberUnsigned(value < 0 ? 0 - (uint64_t)value : (uint64_t)value);
}

static inline void UnityPrintNumberHex(uint64_t value, size_t bytes)
{
    UnityPrint("0x");
    for (size_t nibble = 2 * bytes; nibble-- > 0;) {
        UNITY_OUTPUT_CHAR("0123456789ABCDEF"[(value >> (4 * nibble)) & 15]);
    }
}

static inline void unity_print_value(struct unity_type type, int64_t value)
{
    if (type.style == UNITY_STYLE_HEX) {
        UnityPrintNumberHex((uint64_t)value, type.bytes);
    } else if (type.style == UNITY_STYLE_UINT) {
        UnityPrintNumberUnsigned((uint64_t)value);
    } else {
        UnityPrintNumber(value);
    }
}

static inline void unity_print_string(const char *text)
{
    if (text == NULL) {
        UnityPrint("NULL");
        return;
    }
    UNITY_OUTPUT_CHAR('\'');
    UnityPrint(text);
    UNITY_OUTPUT_CHAR('\'');
}

static inline void unity_print_head(unsigned line, const char *result)
{
    UnityPrint(unity.file);
    UNITY_OUTPUT_CHAR(':');
    UnityPrintNumberUnsigned(line);
    UNITY_OUTPUT_CHAR(':');
    UnityPrint(unity.test);
    UNITY_OUTPUT_CHAR(':');
    UnityPrint(result);
}

static inline void unity_print_end(void)
{
    UNITY_OUTPUT_CHAR('\n');
    UNITY_OUTPUT_FLUSH();
}

/** Starts the line of a failure; the caller prints the reason, then calls unity_fail_end(). */
static inline void unity_fail_begin(unsigned line)
{
    unity.test_failed = 1;
    unity_print_head(line, "FAIL:");
}

static inline _Noreturn void unity_fail_end(const char *message)
{
    if (message != NULL) {
        UnityPrint(". ");
        UnityPrint(message);
    }
    unity_print_end();
    longjmp(unity.abort, 1);
}

static inline _Noreturn void unity_fail(unsigned line, const char *message)
{
    unity_fail_begin(line);
    if (message != NULL) {
        UNITY_OUTPUT_CHAR(' ');
        UnityPrint(message);
    }
    unity_fail_end(NULL);
}

static inline _Noreturn void unity_ignore(unsigned line, const char *message)
{
    unity.test_ignored = 1;
    unity_print_head(line, "IGNORE");
    if (message != NULL) {
        UnityPrint(": ");
        UnityPrint(message);
    }
    unity_print_end();
    longjmp(unity.abort, 1);
}

static inline _Noreturn void unity_pass(void)
{
    longjmp(unity.abort, 1);
}

static inline void unity_message(unsigned line, const char *message)
{
    unity_print_head(line, "INFO: ");
    UnityPrint(message);
    unity_print_end();
}

static inline void unity_check(_Bool holds, const char *reason, unsigned line, const char *message)
{
    if (!holds) {
        unity_fail_begin(line);
        UnityPrint(reason);
        unity_fail_end(message);
    }
}

static inline _Bool unity_is_less(struct unity_type type, int64_t a, int64_t b)
{
    return type.style == UNITY_STYLE_INT ? a < b : (uint64_t)a < (uint64_t)b;
}

static inline _Bool unity_holds(enum unity_relation relation, struct unity_type type, int64_t threshold, int64_t actual)
{
    switch (relation) {
    case UNITY_EQUAL:
        return actual == threshold;
    case UNITY_NOT_EQUAL:
        return actual != threshold;
    case UNITY_GREATER:
        return unity_is_less(type, threshold, actual);
    case UNITY_GREATER_OR_EQUAL:
        return !unity_is_less(type, actual, threshold);
    case UNITY_LESS:
        return unity_is_less(type, actual, threshold);
    case UNITY_LESS_OR_EQUAL:
        return !unity_is_less(type, threshold, actual);
    }
    return 0;
}

static inline void unity_print_difference(struct unity_type type, int64_t expected, int64_t actual)
{
    UnityPrint(" Expected ");
    unity_print_value(type, expected);
    UnityPrint(" Was ");
    unity_print_value(type, actual);
}

static inline void unity_compare(enum unity_relation relation, struct unity_type type, int64_t threshold,
                                 int64_t actual, unsigned line, const char *message)
{
    static const char *const words[] = {
        [UNITY_NOT_EQUAL] = " to be not equal to ",
        [UNITY_GREATER] = " to be greater than ",
        [UNITY_GREATER_OR_EQUAL] = " to be greater than or equal to ",
        [UNITY_LESS] = " to be less than ",
        [UNITY_LESS_OR_EQUAL] = " to be less than or equal to ",
    };

    if (unity_holds(relation, type, threshold, actual)) {
        return;
    }
    unity_fail_begin(line);
    if (relation == UNITY_EQUAL) {
        unity_print_difference(type, threshold, actual);
    } else {
        UnityPrint(" Expected ");
        unity_print_value(type, actual);
        UnityPrint(words[relation]);
        unity_print_value(type, threshold);
    }
    unity_fail_end(message);
}

static inline _Bool unity_is_within(struct unity_type type, uint64_t delta, int64_t expected, int64_t actual)
{
    uint64_t distance = unity_is_less(type, actual, expected) ? (uint64_t)expected - (uint64_t)actual
                                                              : (uint64_t)actual - (uint64_t)expected;
    return distance <= delta;
}

static inline void unity_print_not_within(struct unity_type type, uint64_t delta)
{
    UnityPrint(" Values Not Within Delta ");
    unity_print_value(
        (struct unity_type){type.style == UNITY_STYLE_HEX ? UNITY_STYLE_HEX : UNITY_STYLE_UINT, type.bytes},
        (int64_t)delta);
}

static inline void unity_within(struct unity_type type, uint64_t delta, int64_t expected, int64_t actual, unsigned line,
                                const char *message)
{
    if (!unity_is_within(type, delta, expected, actual)) {
        unity_fail_begin(line);
        unity_print_not_within(type, delta);
        unity_print_difference(type, expected, actual);
        unity_fail_end(message);
    }
}

static inline int64_t unity_element(struct unity_type type, const void *array, size_t index)
{
    const char *element = (const char *)array + index * type.bytes;
    _Bool negative = type.style == UNITY_STYLE_INT;
    uint8_t u8;
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;

    switch (type.bytes) {
    case 1:
        __builtin_memcpy(&u8, element, 1);
        return negative ? (int8_t)u8 : u8;
    case 2:
        __builtin_memcpy(&u16, element, 2);
        return negative ? (int16_t)u16 : u16;
    case 4:
        __builtin_memcpy(&u32, element, 4);
        return negative ? (int64_t)(int32_t)u32 : (int64_t)u32;
    default:
        __builtin_memcpy(&u64, element, 8);
        return (int64_t)u64;
    }
}

/** `stride` 0 compares each element with the one `expected`. */
static inline void unity_array(struct unity_type type, uint64_t delta, const void *expected, size_t stride,
                               const void *actual, size_t count, unsigned line, const char *message)
{
    unity_check(count > 0, " You Asked Me To Compare Nothing, Which Was Pointless.", line, message);
    unity_check(expected != NULL, " Expected Pointer Was NULL", line, message);
    unity_check(actual != NULL, " Actual Pointer Was NULL", line, message);
    for (size_t i = 0; i < count; i++) {
        int64_t e = unity_element(type, expected, i * stride);
        int64_t a = unity_element(type, actual, i);

        if (!unity_is_within(type, delta, e, a)) {
            unity_fail_begin(line);
            if (delta != 0) {
                unity_print_not_within(type, delta);
            }
            UnityPrint(" Element ");
            UnityPrintNumberUnsigned(i);
            unity_print_difference(type, e, a);
            unity_fail_end(message);
        }
    }
}

static inline void unity_each(struct unity_type type, int64_t expected, const void *actual, size_t count, unsigned line,
                              const char *message)
{
    const uint8_t u8 = (uint8_t)expected;
    const uint16_t u16 = (uint16_t)expected;
    const uint32_t u32 = (uint32_t)expected;
    const void *value = type.bytes == 1   ? (const void *)&u8
                        : type.bytes == 2 ? (const void *)&u16
                        : type.bytes == 4 ? (const void *)&u32
                                          : (const void *)&expected;

    unity_array(type, 0, value, 0, actual, count, line, message);
}

static inline void unity_memory(const void *expected, const void *actual, size_t bytes, unsigned line,
                                const char *message)
{
    const struct unity_type type = {UNITY_STYLE_HEX, 1};

    unity_check(bytes > 0, " You Asked Me To Compare Nothing, Which Was Pointless.", line, message);
    unity_check(expected != NULL, " Expected Pointer Was NULL", line, message);
    unity_check(actual != NULL, " Actual Pointer Was NULL", line, message);
    for (size_t i = 0; i < bytes; i++) {
        int64_t e = unity_element(type, expected, i);
        int64_t a = unity_element(type, actual, i);

        if (e != a) {
            unity_fail_begin(line);
            UnityPrint(" Memory Mismatch. Byte ");
            UnityPrintNumberUnsigned(i);
            unity_print_difference(type, e, a);
            unity_fail_end(message);
        }
    }
}

static inline void unity_check_strings(_Bool equal, const char *expected, const char *actual, unsigned line,
                                       const char *message)
{
    if (!equal) {
        unity_fail_begin(line);
        UnityPrint(" Expected ");
        unity_print_string(expected);
        UnityPrint(" Was ");
        unity_print_string(actual);
        unity_fail_end(message);
    }
}

/** Of both no more than `length` characters count. */
static inline _Bool unity_strings_are_equal(const char *expected, const char *actual, size_t length)
{
    size_t i = 0;

    if (expected == NULL || actual == NULL) {
        return expected == actual;
    }
    while (i < length && expected[i] == actual[i] && expected[i] != '\0') {
        i++;
    }
    return i == length || expected[i] == actual[i];
}

static inline void unity_string(const char *expected, const char *actual, unsigned line, const char *message)
{
    unity_check_strings(unity_strings_are_equal(expected, actual, SIZE_MAX), expected, actual, line, message);
}

static inline void unity_string_start(const char *expected, const char *actual, size_t length, unsigned line,
                                      const char *message)
{
    unity_check_strings(unity_strings_are_equal(expected, actual, length), expected, actual, line, message);
}

static inline void unity_run(void (*test)(void), const char *name, unsigned line)
{
    unity.test = name;
    unity.line = line;
    unity.test_failed = 0;
    unity.test_ignored = 0;
    unity.tests++;
    if (setjmp(unity.abort) == 0) {
        setUp();
        test();
    }
    if (setjmp(unity.abort) == 0) {
        tearDown();
    }
    if (unity.test_failed) {
        unity.failures++;
    } else if (unity.test_ignored) {
        unity.ignored++;
    } else {
        unity_print_head(unity.line, "PASS");
        unity_print_end();
    }
}

static inline int unity_begin(const char *file)
{
    unity = (struct unity_state){.file = file};
    return 0;
}

static inline int unity_end(void)
{
    UnityPrint("\n-----------------------\n");
    UnityPrintNumberUnsigned(unity.tests);
    UnityPrint(" Tests ");
    UnityPrintNumberUnsigned(unity.failures);
    UnityPrint(" Failures ");
    UnityPrintNumberUnsigned(unity.ignored);
    UnityPrint(" Ignored \n");
    UnityPrint(unity.failures == 0 ? "OK" : "FAIL");
    unity_print_end();
    return (int)unity.failures;
}

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

#define TEST_ASSERT_EQUAL_PTR(expected, actual)                                                                        \
    unity_compare(UNITY_EQUAL, UNITY_TYPE_POINTER, (int64_t)(uintptr_t)(expected), (int64_t)(uintptr_t)(actual),       \
                  __LINE__, NULL)
#define TEST_ASSERT_EQUAL_PTR_MESSAGE(expected, actual, message)                                                       \
    unity_compare(UNITY_EQUAL, UNITY_TYPE_POINTER, (int64_t)(uintptr_t)(expected), (int64_t)(uintptr_t)(actual),       \
                  __LINE__, message)
/* Of the bits in mask: as expected, all 1, all 0. */
#define TEST_ASSERT_BITS(mask, expected, actual) TEST_ASSERT_EQUAL_HEX32((mask) & (expected), (mask) & (actual))
#define TEST_ASSERT_BITS_HIGH(mask, actual)      TEST_ASSERT_BITS(mask, UINT32_MAX, actual)
#define TEST_ASSERT_BITS_LOW(mask, actual)       TEST_ASSERT_BITS(mask, 0U, actual)

#define TEST_ASSERT_EQUAL_STRING(expected, actual)                  unity_string(expected, actual, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, actual, message) unity_string(expected, actual, __LINE__, message)
#define TEST_ASSERT_EQUAL_STRING_LEN(expected, actual, length)                                                         \
    unity_string_start(expected, actual, length, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(expected, actual, length, message)                                        \
    unity_string_start(expected, actual, length, __LINE__, message)
#define TEST_ASSERT_EQUAL_MEMORY(expected, actual, bytes) unity_memory(expected, actual, bytes, __LINE__, NULL)
#define TEST_ASSERT_EQUAL_MEMORY_MESSAGE(expected, actual, bytes, message)                                             \
    unity_memory(expected, actual, bytes, __LINE__, message)

#define UNITY_TYPE_POINTER ((struct unity_type){UNITY_STYLE_HEX, sizeof(void *)})

/* The type each value is converted to before UNITY_WIDEN(): a plain int keeps all its bits, as in Unity. */
typedef int64_t unity_INT;
typedef int8_t unity_INT8;
typedef int16_t unity_INT16;
typedef int32_t unity_INT32;
typedef int64_t unity_INT64;
typedef uint64_t unity_UINT;
typedef uint8_t unity_UINT8;
typedef uint16_t unity_UINT16;
typedef uint32_t unity_UINT32;
typedef uint64_t unity_UINT64;
typedef uint64_t unity_HEX;
typedef uint8_t unity_HEX8;
typedef uint16_t unity_HEX16;
typedef uint32_t unity_HEX32;
typedef uint64_t unity_HEX64;

#define UNITY_TYPE_INT    ((struct unity_type){UNITY_STYLE_INT, sizeof(int)})
#define UNITY_TYPE_INT8   ((struct unity_type){UNITY_STYLE_INT, sizeof(int8_t)})
#define UNITY_TYPE_INT16  ((struct unity_type){UNITY_STYLE_INT, sizeof(int16_t)})
#define UNITY_TYPE_INT32  ((struct unity_type){UNITY_STYLE_INT, sizeof(int32_t)})
#define UNITY_TYPE_INT64  ((struct unity_type){UNITY_STYLE_INT, sizeof(int64_t)})
#define UNITY_TYPE_UINT   ((struct unity_type){UNITY_STYLE_UINT, sizeof(unsigned)})
#define UNITY_TYPE_UINT8  ((struct unity_type){UNITY_STYLE_UINT, sizeof(uint8_t)})
#define UNITY_TYPE_UINT16 ((struct unity_type){UNITY_STYLE_UINT, sizeof(uint16_t)})
#define UNITY_TYPE_UINT32 ((struct unity_type){UNITY_STYLE_UINT, sizeof(uint32_t)})
#define UNITY_TYPE_UINT64 ((struct unity_type){UNITY_STYLE_UINT, sizeof(uint64_t)})
#define UNITY_TYPE_HEX    ((struct unity_type){UNITY_STYLE_HEX, sizeof(uint32_t)})
#define UNITY_TYPE_HEX8   ((struct unity_type){UNITY_STYLE_HEX, sizeof(uint8_t)})
#define UNITY_TYPE_HEX16  ((struct unity_type){UNITY_STYLE_HEX, sizeof(uint16_t)})
#define UNITY_TYPE_HEX32  ((struct unity_type){UNITY_STYLE_HEX, sizeof(uint32_t)})
#define UNITY_TYPE_HEX64  ((struct unity_type){UNITY_STYLE_HEX, sizeof(uint64_t)})

#define UNITY_WIDEN(T, x) ((int64_t)(unity_##T)(x))
#define UNITY_COMPARE(R, T, e, a, m)                                                                                   \
    unity_compare(UNITY_##R, UNITY_TYPE_##T, UNITY_WIDEN(T, e), UNITY_WIDEN(T, a), __LINE__, m)
#define UNITY_WITHIN(T, d, e, a, m)                                                                                    \
    unity_within(UNITY_TYPE_##T, (uint64_t)(d), UNITY_WIDEN(T, e), UNITY_WIDEN(T, a), __LINE__, m)
#define UNITY_ARRAY(T, d, e, a, n, m) unity_array(UNITY_TYPE_##T, (uint64_t)(d), e, 1, a, n, __LINE__, m)
#define UNITY_EACH(T, e, a, n, m)     unity_each(UNITY_TYPE_##T, UNITY_WIDEN(T, e), a, n, __LINE__, m)

/* d delta, e expected, l limit, a actual, n count, m message. */
// clang-format off

#define TEST_ASSERT_EQUAL_INT(e, a) UNITY_COMPARE(EQUAL, INT, e, a, NULL)
#define TEST_ASSERT_EQUAL_INT_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, INT, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_INT(e, a) UNITY_COMPARE(NOT_EQUAL, INT, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_INT_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, INT, e, a, m)
#define TEST_ASSERT_GREATER_THAN_INT(l, a) UNITY_COMPARE(GREATER, INT, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_INT_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, INT, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, INT, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, INT, l, a, m)
#define TEST_ASSERT_LESS_THAN_INT(l, a) UNITY_COMPARE(LESS, INT, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_INT_MESSAGE(l, a, m) UNITY_COMPARE(LESS, INT, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_INT(l, a) UNITY_COMPARE(LESS_OR_EQUAL, INT, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_INT_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, INT, l, a, m)
#define TEST_ASSERT_INT_WITHIN(d, e, a) UNITY_WITHIN(INT, d, e, a, NULL)
#define TEST_ASSERT_INT_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(INT, d, e, a, m)
#define TEST_ASSERT_EQUAL_INT_ARRAY(e, a, n) UNITY_ARRAY(INT, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_INT_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(INT, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_INT(e, a, n) UNITY_EACH(INT, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_INT_MESSAGE(e, a, n, m) UNITY_EACH(INT, e, a, n, m)
#define TEST_ASSERT_INT_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(INT, d, e, a, n, NULL)
#define TEST_ASSERT_INT_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(INT, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_INT8(e, a) UNITY_COMPARE(EQUAL, INT8, e, a, NULL)
#define TEST_ASSERT_EQUAL_INT8_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, INT8, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_INT8(e, a) UNITY_COMPARE(NOT_EQUAL, INT8, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_INT8_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, INT8, e, a, m)
#define TEST_ASSERT_GREATER_THAN_INT8(l, a) UNITY_COMPARE(GREATER, INT8, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_INT8_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, INT8, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT8(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, INT8, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT8_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, INT8, l, a, m)
#define TEST_ASSERT_LESS_THAN_INT8(l, a) UNITY_COMPARE(LESS, INT8, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_INT8_MESSAGE(l, a, m) UNITY_COMPARE(LESS, INT8, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_INT8(l, a) UNITY_COMPARE(LESS_OR_EQUAL, INT8, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_INT8_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, INT8, l, a, m)
#define TEST_ASSERT_INT8_WITHIN(d, e, a) UNITY_WITHIN(INT8, d, e, a, NULL)
#define TEST_ASSERT_INT8_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(INT8, d, e, a, m)
#define TEST_ASSERT_EQUAL_INT8_ARRAY(e, a, n) UNITY_ARRAY(INT8, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_INT8_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(INT8, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_INT8(e, a, n) UNITY_EACH(INT8, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_INT8_MESSAGE(e, a, n, m) UNITY_EACH(INT8, e, a, n, m)
#define TEST_ASSERT_INT8_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(INT8, d, e, a, n, NULL)
#define TEST_ASSERT_INT8_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(INT8, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_INT16(e, a) UNITY_COMPARE(EQUAL, INT16, e, a, NULL)
#define TEST_ASSERT_EQUAL_INT16_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, INT16, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_INT16(e, a) UNITY_COMPARE(NOT_EQUAL, INT16, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_INT16_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, INT16, e, a, m)
#define TEST_ASSERT_GREATER_THAN_INT16(l, a) UNITY_COMPARE(GREATER, INT16, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_INT16_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, INT16, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT16(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, INT16, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT16_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, INT16, l, a, m)
#define TEST_ASSERT_LESS_THAN_INT16(l, a) UNITY_COMPARE(LESS, INT16, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_INT16_MESSAGE(l, a, m) UNITY_COMPARE(LESS, INT16, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_INT16(l, a) UNITY_COMPARE(LESS_OR_EQUAL, INT16, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_INT16_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, INT16, l, a, m)
#define TEST_ASSERT_INT16_WITHIN(d, e, a) UNITY_WITHIN(INT16, d, e, a, NULL)
#define TEST_ASSERT_INT16_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(INT16, d, e, a, m)
#define TEST_ASSERT_EQUAL_INT16_ARRAY(e, a, n) UNITY_ARRAY(INT16, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_INT16_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(INT16, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_INT16(e, a, n) UNITY_EACH(INT16, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_INT16_MESSAGE(e, a, n, m) UNITY_EACH(INT16, e, a, n, m)
#define TEST_ASSERT_INT16_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(INT16, d, e, a, n, NULL)
#define TEST_ASSERT_INT16_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(INT16, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_INT32(e, a) UNITY_COMPARE(EQUAL, INT32, e, a, NULL)
#define TEST_ASSERT_EQUAL_INT32_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, INT32, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_INT32(e, a) UNITY_COMPARE(NOT_EQUAL, INT32, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_INT32_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, INT32, e, a, m)
#define TEST_ASSERT_GREATER_THAN_INT32(l, a) UNITY_COMPARE(GREATER, INT32, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_INT32_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, INT32, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT32(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, INT32, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT32_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, INT32, l, a, m)
#define TEST_ASSERT_LESS_THAN_INT32(l, a) UNITY_COMPARE(LESS, INT32, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_INT32_MESSAGE(l, a, m) UNITY_COMPARE(LESS, INT32, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_INT32(l, a) UNITY_COMPARE(LESS_OR_EQUAL, INT32, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_INT32_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, INT32, l, a, m)
#define TEST_ASSERT_INT32_WITHIN(d, e, a) UNITY_WITHIN(INT32, d, e, a, NULL)
#define TEST_ASSERT_INT32_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(INT32, d, e, a, m)
#define TEST_ASSERT_EQUAL_INT32_ARRAY(e, a, n) UNITY_ARRAY(INT32, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_INT32_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(INT32, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_INT32(e, a, n) UNITY_EACH(INT32, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_INT32_MESSAGE(e, a, n, m) UNITY_EACH(INT32, e, a, n, m)
#define TEST_ASSERT_INT32_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(INT32, d, e, a, n, NULL)
#define TEST_ASSERT_INT32_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(INT32, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_INT64(e, a) UNITY_COMPARE(EQUAL, INT64, e, a, NULL)
#define TEST_ASSERT_EQUAL_INT64_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, INT64, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_INT64(e, a) UNITY_COMPARE(NOT_EQUAL, INT64, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_INT64_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, INT64, e, a, m)
#define TEST_ASSERT_GREATER_THAN_INT64(l, a) UNITY_COMPARE(GREATER, INT64, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_INT64_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, INT64, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT64(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, INT64, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_INT64_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, INT64, l, a, m)
#define TEST_ASSERT_LESS_THAN_INT64(l, a) UNITY_COMPARE(LESS, INT64, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_INT64_MESSAGE(l, a, m) UNITY_COMPARE(LESS, INT64, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_INT64(l, a) UNITY_COMPARE(LESS_OR_EQUAL, INT64, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_INT64_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, INT64, l, a, m)
#define TEST_ASSERT_INT64_WITHIN(d, e, a) UNITY_WITHIN(INT64, d, e, a, NULL)
#define TEST_ASSERT_INT64_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(INT64, d, e, a, m)
#define TEST_ASSERT_EQUAL_INT64_ARRAY(e, a, n) UNITY_ARRAY(INT64, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_INT64_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(INT64, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_INT64(e, a, n) UNITY_EACH(INT64, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_INT64_MESSAGE(e, a, n, m) UNITY_EACH(INT64, e, a, n, m)
#define TEST_ASSERT_INT64_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(INT64, d, e, a, n, NULL)
#define TEST_ASSERT_INT64_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(INT64, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_UINT(e, a) UNITY_COMPARE(EQUAL, UINT, e, a, NULL)
#define TEST_ASSERT_EQUAL_UINT_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, UINT, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_UINT(e, a) UNITY_COMPARE(NOT_EQUAL, UINT, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_UINT_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, UINT, e, a, m)
#define TEST_ASSERT_GREATER_THAN_UINT(l, a) UNITY_COMPARE(GREATER, UINT, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, UINT, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, UINT, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, UINT, l, a, m)
#define TEST_ASSERT_LESS_THAN_UINT(l, a) UNITY_COMPARE(LESS, UINT, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_UINT_MESSAGE(l, a, m) UNITY_COMPARE(LESS, UINT, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT(l, a) UNITY_COMPARE(LESS_OR_EQUAL, UINT, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, UINT, l, a, m)
#define TEST_ASSERT_UINT_WITHIN(d, e, a) UNITY_WITHIN(UINT, d, e, a, NULL)
#define TEST_ASSERT_UINT_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(UINT, d, e, a, m)
#define TEST_ASSERT_EQUAL_UINT_ARRAY(e, a, n) UNITY_ARRAY(UINT, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_UINT_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(UINT, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_UINT(e, a, n) UNITY_EACH(UINT, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_UINT_MESSAGE(e, a, n, m) UNITY_EACH(UINT, e, a, n, m)
#define TEST_ASSERT_UINT_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(UINT, d, e, a, n, NULL)
#define TEST_ASSERT_UINT_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(UINT, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_UINT8(e, a) UNITY_COMPARE(EQUAL, UINT8, e, a, NULL)
#define TEST_ASSERT_EQUAL_UINT8_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, UINT8, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_UINT8(e, a) UNITY_COMPARE(NOT_EQUAL, UINT8, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_UINT8_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, UINT8, e, a, m)
#define TEST_ASSERT_GREATER_THAN_UINT8(l, a) UNITY_COMPARE(GREATER, UINT8, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_UINT8_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, UINT8, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT8(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, UINT8, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT8_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, UINT8, l, a, m)
#define TEST_ASSERT_LESS_THAN_UINT8(l, a) UNITY_COMPARE(LESS, UINT8, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_UINT8_MESSAGE(l, a, m) UNITY_COMPARE(LESS, UINT8, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT8(l, a) UNITY_COMPARE(LESS_OR_EQUAL, UINT8, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT8_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, UINT8, l, a, m)
#define TEST_ASSERT_UINT8_WITHIN(d, e, a) UNITY_WITHIN(UINT8, d, e, a, NULL)
#define TEST_ASSERT_UINT8_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(UINT8, d, e, a, m)
#define TEST_ASSERT_EQUAL_UINT8_ARRAY(e, a, n) UNITY_ARRAY(UINT8, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_UINT8_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(UINT8, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_UINT8(e, a, n) UNITY_EACH(UINT8, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_UINT8_MESSAGE(e, a, n, m) UNITY_EACH(UINT8, e, a, n, m)
#define TEST_ASSERT_UINT8_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(UINT8, d, e, a, n, NULL)
#define TEST_ASSERT_UINT8_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(UINT8, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_UINT16(e, a) UNITY_COMPARE(EQUAL, UINT16, e, a, NULL)
#define TEST_ASSERT_EQUAL_UINT16_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, UINT16, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_UINT16(e, a) UNITY_COMPARE(NOT_EQUAL, UINT16, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_UINT16_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, UINT16, e, a, m)
#define TEST_ASSERT_GREATER_THAN_UINT16(l, a) UNITY_COMPARE(GREATER, UINT16, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_UINT16_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, UINT16, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT16(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, UINT16, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT16_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, UINT16, l, a, m)
#define TEST_ASSERT_LESS_THAN_UINT16(l, a) UNITY_COMPARE(LESS, UINT16, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_UINT16_MESSAGE(l, a, m) UNITY_COMPARE(LESS, UINT16, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT16(l, a) UNITY_COMPARE(LESS_OR_EQUAL, UINT16, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT16_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, UINT16, l, a, m)
#define TEST_ASSERT_UINT16_WITHIN(d, e, a) UNITY_WITHIN(UINT16, d, e, a, NULL)
#define TEST_ASSERT_UINT16_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(UINT16, d, e, a, m)
#define TEST_ASSERT_EQUAL_UINT16_ARRAY(e, a, n) UNITY_ARRAY(UINT16, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_UINT16_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(UINT16, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_UINT16(e, a, n) UNITY_EACH(UINT16, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_UINT16_MESSAGE(e, a, n, m) UNITY_EACH(UINT16, e, a, n, m)
#define TEST_ASSERT_UINT16_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(UINT16, d, e, a, n, NULL)
#define TEST_ASSERT_UINT16_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(UINT16, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_UINT32(e, a) UNITY_COMPARE(EQUAL, UINT32, e, a, NULL)
#define TEST_ASSERT_EQUAL_UINT32_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, UINT32, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_UINT32(e, a) UNITY_COMPARE(NOT_EQUAL, UINT32, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_UINT32_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, UINT32, e, a, m)
#define TEST_ASSERT_GREATER_THAN_UINT32(l, a) UNITY_COMPARE(GREATER, UINT32, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_UINT32_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, UINT32, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT32(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, UINT32, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT32_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, UINT32, l, a, m)
#define TEST_ASSERT_LESS_THAN_UINT32(l, a) UNITY_COMPARE(LESS, UINT32, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_UINT32_MESSAGE(l, a, m) UNITY_COMPARE(LESS, UINT32, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT32(l, a) UNITY_COMPARE(LESS_OR_EQUAL, UINT32, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT32_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, UINT32, l, a, m)
#define TEST_ASSERT_UINT32_WITHIN(d, e, a) UNITY_WITHIN(UINT32, d, e, a, NULL)
#define TEST_ASSERT_UINT32_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(UINT32, d, e, a, m)
#define TEST_ASSERT_EQUAL_UINT32_ARRAY(e, a, n) UNITY_ARRAY(UINT32, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_UINT32_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(UINT32, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_UINT32(e, a, n) UNITY_EACH(UINT32, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_UINT32_MESSAGE(e, a, n, m) UNITY_EACH(UINT32, e, a, n, m)
#define TEST_ASSERT_UINT32_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(UINT32, d, e, a, n, NULL)
#define TEST_ASSERT_UINT32_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(UINT32, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_UINT64(e, a) UNITY_COMPARE(EQUAL, UINT64, e, a, NULL)
#define TEST_ASSERT_EQUAL_UINT64_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, UINT64, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_UINT64(e, a) UNITY_COMPARE(NOT_EQUAL, UINT64, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_UINT64_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, UINT64, e, a, m)
#define TEST_ASSERT_GREATER_THAN_UINT64(l, a) UNITY_COMPARE(GREATER, UINT64, l, a, NULL)
#define TEST_ASSERT_GREATER_THAN_UINT64_MESSAGE(l, a, m) UNITY_COMPARE(GREATER, UINT64, l, a, m)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT64(l, a) UNITY_COMPARE(GREATER_OR_EQUAL, UINT64, l, a, NULL)
#define TEST_ASSERT_GREATER_OR_EQUAL_UINT64_MESSAGE(l, a, m) UNITY_COMPARE(GREATER_OR_EQUAL, UINT64, l, a, m)
#define TEST_ASSERT_LESS_THAN_UINT64(l, a) UNITY_COMPARE(LESS, UINT64, l, a, NULL)
#define TEST_ASSERT_LESS_THAN_UINT64_MESSAGE(l, a, m) UNITY_COMPARE(LESS, UINT64, l, a, m)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT64(l, a) UNITY_COMPARE(LESS_OR_EQUAL, UINT64, l, a, NULL)
#define TEST_ASSERT_LESS_OR_EQUAL_UINT64_MESSAGE(l, a, m) UNITY_COMPARE(LESS_OR_EQUAL, UINT64, l, a, m)
#define TEST_ASSERT_UINT64_WITHIN(d, e, a) UNITY_WITHIN(UINT64, d, e, a, NULL)
#define TEST_ASSERT_UINT64_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(UINT64, d, e, a, m)
#define TEST_ASSERT_EQUAL_UINT64_ARRAY(e, a, n) UNITY_ARRAY(UINT64, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_UINT64_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(UINT64, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_UINT64(e, a, n) UNITY_EACH(UINT64, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_UINT64_MESSAGE(e, a, n, m) UNITY_EACH(UINT64, e, a, n, m)
#define TEST_ASSERT_UINT64_ARRAY_WITHIN(d, e, a, n) UNITY_ARRAY(UINT64, d, e, a, n, NULL)
#define TEST_ASSERT_UINT64_ARRAY_WITHIN_MESSAGE(d, e, a, n, m) UNITY_ARRAY(UINT64, d, e, a, n, m)

#define TEST_ASSERT_EQUAL_HEX(e, a) UNITY_COMPARE(EQUAL, HEX, e, a, NULL)
#define TEST_ASSERT_EQUAL_HEX_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, HEX, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_HEX(e, a) UNITY_COMPARE(NOT_EQUAL, HEX, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_HEX_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, HEX, e, a, m)
#define TEST_ASSERT_HEX_WITHIN(d, e, a) UNITY_WITHIN(HEX, d, e, a, NULL)
#define TEST_ASSERT_HEX_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(HEX, d, e, a, m)
#define TEST_ASSERT_EQUAL_HEX_ARRAY(e, a, n) UNITY_ARRAY(HEX, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_HEX_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(HEX, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_HEX(e, a, n) UNITY_EACH(HEX, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_HEX_MESSAGE(e, a, n, m) UNITY_EACH(HEX, e, a, n, m)

#define TEST_ASSERT_EQUAL_HEX8(e, a) UNITY_COMPARE(EQUAL, HEX8, e, a, NULL)
#define TEST_ASSERT_EQUAL_HEX8_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, HEX8, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_HEX8(e, a) UNITY_COMPARE(NOT_EQUAL, HEX8, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_HEX8_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, HEX8, e, a, m)
#define TEST_ASSERT_HEX8_WITHIN(d, e, a) UNITY_WITHIN(HEX8, d, e, a, NULL)
#define TEST_ASSERT_HEX8_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(HEX8, d, e, a, m)
#define TEST_ASSERT_EQUAL_HEX8_ARRAY(e, a, n) UNITY_ARRAY(HEX8, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(HEX8, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_HEX8(e, a, n) UNITY_EACH(HEX8, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_HEX8_MESSAGE(e, a, n, m) UNITY_EACH(HEX8, e, a, n, m)

#define TEST_ASSERT_EQUAL_HEX16(e, a) UNITY_COMPARE(EQUAL, HEX16, e, a, NULL)
#define TEST_ASSERT_EQUAL_HEX16_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, HEX16, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_HEX16(e, a) UNITY_COMPARE(NOT_EQUAL, HEX16, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_HEX16_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, HEX16, e, a, m)
#define TEST_ASSERT_HEX16_WITHIN(d, e, a) UNITY_WITHIN(HEX16, d, e, a, NULL)
#define TEST_ASSERT_HEX16_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(HEX16, d, e, a, m)
#define TEST_ASSERT_EQUAL_HEX16_ARRAY(e, a, n) UNITY_ARRAY(HEX16, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_HEX16_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(HEX16, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_HEX16(e, a, n) UNITY_EACH(HEX16, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_HEX16_MESSAGE(e, a, n, m) UNITY_EACH(HEX16, e, a, n, m)

#define TEST_ASSERT_EQUAL_HEX32(e, a) UNITY_COMPARE(EQUAL, HEX32, e, a, NULL)
#define TEST_ASSERT_EQUAL_HEX32_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, HEX32, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_HEX32(e, a) UNITY_COMPARE(NOT_EQUAL, HEX32, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_HEX32_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, HEX32, e, a, m)
#define TEST_ASSERT_HEX32_WITHIN(d, e, a) UNITY_WITHIN(HEX32, d, e, a, NULL)
#define TEST_ASSERT_HEX32_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(HEX32, d, e, a, m)
#define TEST_ASSERT_EQUAL_HEX32_ARRAY(e, a, n) UNITY_ARRAY(HEX32, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_HEX32_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(HEX32, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_HEX32(e, a, n) UNITY_EACH(HEX32, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_HEX32_MESSAGE(e, a, n, m) UNITY_EACH(HEX32, e, a, n, m)

#define TEST_ASSERT_EQUAL_HEX64(e, a) UNITY_COMPARE(EQUAL, HEX64, e, a, NULL)
#define TEST_ASSERT_EQUAL_HEX64_MESSAGE(e, a, m) UNITY_COMPARE(EQUAL, HEX64, e, a, m)
#define TEST_ASSERT_NOT_EQUAL_HEX64(e, a) UNITY_COMPARE(NOT_EQUAL, HEX64, e, a, NULL)
#define TEST_ASSERT_NOT_EQUAL_HEX64_MESSAGE(e, a, m) UNITY_COMPARE(NOT_EQUAL, HEX64, e, a, m)
#define TEST_ASSERT_HEX64_WITHIN(d, e, a) UNITY_WITHIN(HEX64, d, e, a, NULL)
#define TEST_ASSERT_HEX64_WITHIN_MESSAGE(d, e, a, m) UNITY_WITHIN(HEX64, d, e, a, m)
#define TEST_ASSERT_EQUAL_HEX64_ARRAY(e, a, n) UNITY_ARRAY(HEX64, 0, e, a, n, NULL)
#define TEST_ASSERT_EQUAL_HEX64_ARRAY_MESSAGE(e, a, n, m) UNITY_ARRAY(HEX64, 0, e, a, n, m)
#define TEST_ASSERT_EACH_EQUAL_HEX64(e, a, n) UNITY_EACH(HEX64, e, a, n, NULL)
#define TEST_ASSERT_EACH_EQUAL_HEX64_MESSAGE(e, a, n, m) UNITY_EACH(HEX64, e, a, n, m)
// clang-format on

#define TEST_ASSERT_EQUAL(expected, actual)                  TEST_ASSERT_EQUAL_INT(expected, actual)
#define TEST_ASSERT_EQUAL_MESSAGE(expected, actual, message) TEST_ASSERT_EQUAL_INT_MESSAGE(expected, actual, message)
#define TEST_ASSERT_GREATER_THAN(threshold, actual)          TEST_ASSERT_GREATER_THAN_INT(threshold, actual)
#define TEST_ASSERT_GREATER_THAN_MESSAGE(threshold, actual, message)                                                   \
    TEST_ASSERT_GREATER_THAN_INT_MESSAGE(threshold, actual, message)
#define TEST_ASSERT_GREATER_OR_EQUAL(threshold, actual) TEST_ASSERT_GREATER_OR_EQUAL_INT(threshold, actual)
#define TEST_ASSERT_GREATER_OR_EQUAL_MESSAGE(threshold, actual, message)                                               \
    TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(threshold, actual, message)
#define TEST_ASSERT_LESS_THAN(threshold, actual) TEST_ASSERT_LESS_THAN_INT(threshold, actual)
#define TEST_ASSERT_LESS_THAN_MESSAGE(threshold, actual, message)                                                      \
    TEST_ASSERT_LESS_THAN_INT_MESSAGE(threshold, actual, message)
#define TEST_ASSERT_LESS_OR_EQUAL(threshold, actual) TEST_ASSERT_LESS_OR_EQUAL_INT(threshold, actual)
#define TEST_ASSERT_LESS_OR_EQUAL_MESSAGE(threshold, actual, message)                                                  \
    TEST_ASSERT_LESS_OR_EQUAL_INT_MESSAGE(threshold, actual, message)

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
