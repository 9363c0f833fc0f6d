/* The check of configurations: each width, each end of a range, arrays, the first wrong field, null pointers. */
#include "src/base/config_check.h"
#include "unity.h"

struct inner {
    uint16_t half;
    uint8_t byte;
};

struct config {
    int32_t number;
    int32_t numbers[3];
    uint32_t count;
    struct inner inner;
};

#define FIELD(member, low, high) JP_CONFIG_FIELD("config.", struct config, member, low, high)

static const struct jp_config_field fields[] = {
    FIELD(number, -5, 7),          FIELD(numbers, 10, 20),    FIELD(count, 0, INT32_MAX),
    FIELD(inner.half, 256, 65534), FIELD(inner.byte, 3, 254),
};

static const struct config good = {.number = 0, .numbers = {10, 15, 20}, .count = 1, .inner = {.half = 300, .byte = 4}};
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
    const enum jp_status status = jp_config_check(&config, fields, JP_CONFIG_COUNT(fields), &field);

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
    WITH(number, -6, "config.number");
    WITH(number, -5, NULL);
    WITH(number, 7, NULL);
    WITH(number, 8, "config.number");
    WITH(number, INT32_MIN, "config.number");
    WITH(number, INT32_MAX, "config.number");
}

static void test_numbers_without_sign(void)
{
    WITH(count, 0, NULL);
    WITH(count, INT32_MAX, NULL);
    WITH(count, (uint32_t)INT32_MAX + 1U, "config.count");
    WITH(count, UINT32_MAX, "config.count");
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

static void test_each_number_of_an_array(void)
{
    for (int i = 0; i < 3; i++) {
        WITH(numbers[i], 9, "config.numbers");
        WITH(numbers[i], 21, "config.numbers");
        WITH(numbers[i], 20, NULL);
    }
}

static void test_the_first_wrong_field_is_named(void)
{
    config.inner.byte = 0;
    config.number = 100;
    expect("config.number");
    config.inner.byte = 0;
    config.count = UINT32_MAX;
    expect("config.count");
}

static void test_null_pointers(void)
{
    const char *field = "untouched";

    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_config_check(NULL, fields, JP_CONFIG_COUNT(fields), &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_config_check(&config, fields, JP_CONFIG_COUNT(fields), NULL));
    TEST_ASSERT_EQUAL_STRING("untouched", field);
}

static void test_a_refusal_names_its_field(void)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_config_refuse("config.number", &field));
    TEST_ASSERT_EQUAL_STRING("config.number", field);
}
