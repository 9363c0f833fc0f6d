/** The assertions of tests/unity/unity.h: each holds when it should, and its failure prints what it should. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static void write_character(char c);
static void write_out(void);

/* The text of a failure that is meant must not reach the log. */
#define UNITY_OUTPUT_CHAR(c) write_character((char)(c))
#define UNITY_OUTPUT_FLUSH() write_out()
#include "unity.h"

#ifdef UNITY_INCLUDE_CONFIG_H
#define PUT(c)  target_putchar(c)
#define FLUSH() target_flush()
#else
#include <stdio.h>
#define PUT(c)  (void)putchar(c)
#define FLUSH() (void)fflush(stdout)
#endif

static char captured[160];
static size_t captured_length;
static bool capturing;
static int order[4];
static size_t order_length;

static void write_character(char c)
{
    if (!capturing) {
        PUT(c);
    } else if (captured_length < sizeof captured - 1) {
        captured[captured_length++] = c;
    }
}

static void write_out(void)
{
    FLUSH();
}

static void note(int step)
{
    if (capturing && order_length < 4) {
        order[order_length++] = step;
    }
}

void setUp(void)
{
    note(1);
}

void tearDown(void)
{
    note(3);
}

/** Runs `test` as a program would and gives its state; what it printed is in `captured`. */
static struct unity_state run(void (*test)(void))
{
    struct unity_state outer;
    struct unity_state inner;

    memcpy(&outer, &unity, sizeof outer);
    memset(captured, 0, sizeof captured);
    captured_length = 0;
    order_length = 0;
    capturing = true;
    unity_begin("file.c");
    unity_run(test, "inner", 7);
    capturing = false;
    memcpy(&inner, &unity, sizeof inner);
    memcpy(&unity, &outer, sizeof unity);
    return inner;
}

/** The captured failure after `file.c:LINE:inner:FAIL:`. */
static const char *reason(void)
{
    const char *mark = strstr(captured, ":inner:FAIL:");

    return mark == NULL ? captured : mark + strlen(":inner:FAIL:");
}

#define EXPECT_FAILURE(text, test)                                                                                     \
    do {                                                                                                               \
        TEST_ASSERT_EQUAL_UINT(1, run(test).failures);                                                                 \
        TEST_ASSERT_EQUAL_STRING(text "\n", reason());                                                                 \
    } while (0)

/** One function whose only statement is an assertion. */
#define CASE(name, assertion)                                                                                          \
    static void name(void)                                                                                             \
    {                                                                                                                  \
        assertion;                                                                                                     \
    }

static const int32_t numbers[] = {1, -2, 3};
static const int32_t others[] = {1, -2, 4};
static const uint8_t bytes[] = {9, 9, 9};

CASE(fail_condition, TEST_ASSERT(false))
CASE(fail_true, TEST_ASSERT_TRUE(0))
CASE(fail_false, TEST_ASSERT_FALSE_MESSAGE(1, "why"))
CASE(fail_null, TEST_ASSERT_NULL(numbers))
CASE(fail_not_null, TEST_ASSERT_NOT_NULL(NULL))
CASE(fail_int32, TEST_ASSERT_EQUAL_INT32(INT32_MIN, INT32_MAX))
CASE(fail_int64, TEST_ASSERT_EQUAL_INT64(INT64_MIN, INT64_MAX))
CASE(fail_uint64, TEST_ASSERT_EQUAL_UINT64_MESSAGE(UINT64_MAX, 0, "why"))
CASE(fail_hex8, TEST_ASSERT_EQUAL_HEX8(0xAB, 0xC))
CASE(fail_hex32, TEST_ASSERT_EQUAL_HEX32(-1, 0))
CASE(fail_bits, TEST_ASSERT_BITS(0xF0, 0x2A, 0x3A))
CASE(fail_bits_high, TEST_ASSERT_BITS_HIGH(6, 3))
CASE(fail_bits_low, TEST_ASSERT_BITS_LOW(6, 3))
CASE(fail_wide_int, TEST_ASSERT_EQUAL_INT(0, INT64_C(1) << 32))
CASE(fail_not_equal, TEST_ASSERT_NOT_EQUAL_INT32(5, 5))
CASE(fail_greater, TEST_ASSERT_GREATER_THAN_INT32(5, 5))
CASE(fail_greater_or_equal, TEST_ASSERT_GREATER_OR_EQUAL_INT64(-5, -6))
CASE(fail_less, TEST_ASSERT_LESS_THAN_INT32(5, 5))
CASE(fail_less_or_equal, TEST_ASSERT_LESS_OR_EQUAL_UINT32(5, UINT32_MAX))
CASE(fail_within, TEST_ASSERT_INT32_WITHIN(2, 10, 13))
CASE(fail_within_far, TEST_ASSERT_INT64_WITHIN(1, INT64_MIN, INT64_MAX))
CASE(fail_within_unsigned, TEST_ASSERT_UINT32_WITHIN(1, 0, UINT32_MAX))
CASE(fail_array, TEST_ASSERT_EQUAL_INT32_ARRAY(numbers, others, 3))
CASE(fail_array_within, TEST_ASSERT_INT32_ARRAY_WITHIN(0, numbers, others, 3))
CASE(fail_array_empty, TEST_ASSERT_EQUAL_INT32_ARRAY(numbers, others, 0))
CASE(fail_each, TEST_ASSERT_EACH_EQUAL_INT32(1, numbers, 3))
CASE(fail_memory, TEST_ASSERT_EQUAL_MEMORY(numbers, bytes, 3))
CASE(fail_string, TEST_ASSERT_EQUAL_STRING("a", "b"))
CASE(fail_string_null, TEST_ASSERT_EQUAL_STRING(NULL, "b"))
CASE(fail_message, TEST_FAIL_MESSAGE("why"))

static void test_failures_of_conditions(void)
{
    EXPECT_FAILURE(" Expression Evaluated To FALSE", fail_condition);
    EXPECT_FAILURE(" Expected TRUE Was FALSE", fail_true);
    EXPECT_FAILURE(" Expected FALSE Was TRUE. why", fail_false);
    EXPECT_FAILURE(" Expected NULL", fail_null);
    EXPECT_FAILURE(" Expected Non-NULL", fail_not_null);
    EXPECT_FAILURE(" why", fail_message);
}

static void test_failures_of_numbers(void)
{
    EXPECT_FAILURE(" Expected -2147483648 Was 2147483647", fail_int32);
    EXPECT_FAILURE(" Expected -9223372036854775808 Was 9223372036854775807", fail_int64);
    EXPECT_FAILURE(" Expected 18446744073709551615 Was 0. why", fail_uint64);
    EXPECT_FAILURE(" Expected 0xAB Was 0x0C", fail_hex8);
    EXPECT_FAILURE(" Expected 0xFFFFFFFF Was 0x00000000", fail_hex32);
    EXPECT_FAILURE(" Expected 0x00000020 Was 0x00000030", fail_bits);
    EXPECT_FAILURE(" Expected 0x00000006 Was 0x00000002", fail_bits_high);
    EXPECT_FAILURE(" Expected 0x00000000 Was 0x00000002", fail_bits_low);
    TEST_ASSERT_BITS(0x0F, 0x2A, 0x3A);
    TEST_ASSERT_BITS_HIGH(6, 7);
    TEST_ASSERT_BITS_LOW(6, 9);
    EXPECT_FAILURE(" Expected 0 Was 4294967296", fail_wide_int);
    EXPECT_FAILURE(" Expected 5 to be not equal to 5", fail_not_equal);
    EXPECT_FAILURE(" Expected 5 to be greater than 5", fail_greater);
    EXPECT_FAILURE(" Expected -6 to be greater than or equal to -5", fail_greater_or_equal);
    EXPECT_FAILURE(" Expected 5 to be less than 5", fail_less);
    EXPECT_FAILURE(" Expected 4294967295 to be less than or equal to 5", fail_less_or_equal);
}

static void test_failures_of_distances(void)
{
    EXPECT_FAILURE(" Values Not Within Delta 2 Expected 10 Was 13", fail_within);
    EXPECT_FAILURE(" Values Not Within Delta 1 Expected -9223372036854775808 Was 9223372036854775807", fail_within_far);
    EXPECT_FAILURE(" Values Not Within Delta 1 Expected 0 Was 4294967295", fail_within_unsigned);
}

static void test_failures_of_blocks(void)
{
    EXPECT_FAILURE(" Element 2 Expected 3 Was 4", fail_array);
    EXPECT_FAILURE(" Element 2 Expected 3 Was 4", fail_array_within);
    EXPECT_FAILURE(" You Asked Me To Compare Nothing, Which Was Pointless.", fail_array_empty);
    EXPECT_FAILURE(" Element 1 Expected 1 Was -2", fail_each);
    EXPECT_FAILURE(" Memory Mismatch. Byte 0 Expected 0x01 Was 0x09", fail_memory);
    EXPECT_FAILURE(" Expected 'a' Was 'b'", fail_string);
    EXPECT_FAILURE(" Expected NULL Was 'b'", fail_string_null);
}

static void hold_everything(void)
{
    TEST_ASSERT(1);
    TEST_ASSERT_FALSE(0);
    TEST_ASSERT_NULL(NULL);
    TEST_ASSERT_NOT_NULL(numbers);
    TEST_ASSERT_EQUAL(3, 3);
    TEST_ASSERT_NOT_EQUAL(3, 4);
    TEST_ASSERT_EQUAL_INT8(-1, 255);
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, -1);
    TEST_ASSERT_EQUAL_PTR(numbers, &numbers[0]);
    TEST_ASSERT_GREATER_THAN_UINT32(INT32_MAX, UINT32_MAX);
    TEST_ASSERT_GREATER_THAN_INT32(-1, 0);
    TEST_ASSERT_LESS_OR_EQUAL_INT64(INT64_MIN, INT64_MIN);
    TEST_ASSERT_INT32_WITHIN(3, -5, -2);
    TEST_ASSERT_INT32_WITHIN(UINT32_MAX, INT32_MIN, INT32_MAX);
    TEST_ASSERT_EQUAL_INT32_ARRAY(numbers, others, 2);
    TEST_ASSERT_INT32_ARRAY_WITHIN(1, numbers, others, 3);
    TEST_ASSERT_EACH_EQUAL_UINT8(9, bytes, 3);
    TEST_ASSERT_EQUAL_MEMORY(numbers, others, 8);
    TEST_ASSERT_EQUAL_STRING(NULL, NULL);
    TEST_ASSERT_EQUAL_STRING_LEN("abc", "abd", 2);
}

static void test_holds(void)
{
    TEST_ASSERT_EQUAL_UINT(0, run(hold_everything).failures);
    TEST_ASSERT_EQUAL_STRING("file.c:7:inner:PASS\n", captured);
}

static void fail_then_go_on(void)
{
    note(2);
    TEST_FAIL();
    note(4);
}

static void test_failure_ends_the_test_and_tears_down(void)
{
    static const int expected[] = {1, 2, 3};

    (void)run(fail_then_go_on);
    TEST_ASSERT_EQUAL_UINT32(3, order_length);
    TEST_ASSERT_EQUAL_INT_ARRAY(expected, order, 3);
}

static void ignore_self(void)
{
    TEST_IGNORE_MESSAGE("why");
}

static void pass_early(void)
{
    TEST_PASS();
}

static void test_ignore_and_pass_end_the_test(void)
{
    struct unity_state state = run(ignore_self);

    TEST_ASSERT_EQUAL_UINT(1, state.ignored);
    TEST_ASSERT_EQUAL_UINT(0, state.failures);
    TEST_ASSERT_NOT_NULL(strstr(captured, ":inner:IGNORE: why\n"));
    state = run(pass_early);
    TEST_ASSERT_EQUAL_UINT(0, state.ignored + state.failures);
}
