/** What unity.h stands on: the state of a test program, its text, what each assertion compares, and the runner. */
#ifndef UNITY_CHECKS_H
#define UNITY_CHECKS_H

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

#endif
