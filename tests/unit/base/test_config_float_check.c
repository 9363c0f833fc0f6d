/* The check of configurations in single precision: each width, each end of a range, what is no number, the first wrong
 * field, null pointers. */
#include "src/base/config_float_check.h"

#include <math.h>

#include "unity.h"

struct inner {
    uint16_t half;
    uint8_t byte;
};

struct config {
    float number;
    struct inner inner;
};

#define FIELD(member, low, high) JP_CONFIG_FIELD("config.", struct config, member, low, high)

static const struct jp_config_float_field fields[] = {
    FIELD(number, -0.5f, 7.0f),
    FIELD(inner.half, 256.0f, 65534.0f),
    FIELD(inner.byte, 3.0f, 254.0f),
};

static const struct config good = {.number = 0.0f, .inner = {.half = 300, .byte = 4}};
static struct config config;

void setUp(void)
{
    config = good;
}

void tearDown(void)
{
}

static void expect(const char *expected)
{
    const char *field = "untouched";
    const enum jp_status status = jp_config_float_check(&config, fields, JP_CONFIG_COUNT(fields), &field);

    TEST_ASSERT_EQUAL_INT(expected == NULL ? JP_OK : JP_ERR_CONFIG, status);
    if (expected == NULL) {
        TEST_ASSERT_NULL(field);
    } else {
        TEST_ASSERT_EQUAL_STRING(expected, field);
    }
    config = good;
}

#define WITH(member, value, expected)                                                                                  \
    do {                                                                                                               \
        config.member = (value);                                                                                       \
        expect(expected);                                                                                              \
    } while (0)

static void test_numbers_at_the_ends_of_their_range(void)
{
    expect(NULL);
    WITH(number, -0x1.000002p-1f, "config.number");
    WITH(number, -0.5f, NULL);
    WITH(number, 7.0f, NULL);
    WITH(number, 0x1.c00002p2f, "config.number");
}

static void test_what_is_no_number_is_refused(void)
{
    WITH(number, NAN, "config.number");
    WITH(number, -NAN, "config.number");
    WITH(number, INFINITY, "config.number");
    WITH(number, -INFINITY, "config.number");
}

static void test_short_numbers(void)
{
    WITH(inner.half, 255, "config.inner.half");
    WITH(inner.half, 256, NULL);
    WITH(inner.half, 65534, NULL);
    WITH(inner.half, 65535, "config.inner.half");
    WITH(inner.byte, 2, "config.inner.byte");
    WITH(inner.byte, 3, NULL);
    WITH(inner.byte, 254, NULL);
    WITH(inner.byte, 255, "config.inner.byte");
}

static void test_the_first_wrong_field_is_named(void)
{
    config.inner.byte = 0;
    config.number = 100.0f;
    expect("config.number");
    config.inner.byte = 0;
    config.inner.half = 0;
    expect("config.inner.half");
}

static void test_null_pointers(void)
{
    const char *field = "untouched";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_config_float_check(NULL, fields, JP_CONFIG_COUNT(fields), &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_config_float_check(&config, fields, JP_CONFIG_COUNT(fields), NULL));
    TEST_ASSERT_EQUAL_STRING("untouched", field);
}
