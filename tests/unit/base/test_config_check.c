/* The check of configurations: each width, each end of a range, arrays, the first wrong field, null pointers. */
#include "src/base/config_check.h"
#include "tests/support/config_check.h"
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

#define ENTRY(member, low, high) JP_CONFIG_FIELD("config.", struct config, member, low, high)

static const struct jp_config_field fields[] = {
    ENTRY(number, -5, 7),          ENTRY(numbers, 10, 20),    ENTRY(count, 0, INT32_MAX),
    ENTRY(inner.half, 256, 65534), ENTRY(inner.byte, 3, 254),
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

static enum jp_status check(const struct config *checked, const char **field)
{
    return jp_config_check(checked, fields, JP_CONFIG_COUNT(fields), field);
}

DEFINE_EXPECT_CONFIG_OF(check, good)

static void test_numbers_at_the_ends_of_their_range(void)
{
    expect_config(NULL);
    RANGE("config.", number, -5, 7);
    FIELD(number, INT32_MIN, "config.number");
    FIELD(number, INT32_MAX, "config.number");
}

static void test_numbers_without_sign(void)
{
    FIELD(count, 0, NULL);
    FIELD(count, INT32_MAX, NULL);
    FIELD(count, (uint32_t)INT32_MAX + 1U, "config.count");
    FIELD(count, UINT32_MAX, "config.count");
}

static void test_short_numbers(void)
{
    RANGE("config.", inner.half, 256, 65534);
    RANGE("config.", inner.byte, 3, 254);
}

static void test_each_number_of_an_array(void)
{
    for (int i = 0; i < 3; i++) {
        FIELD(numbers[i], 9, "config.numbers");
        FIELD(numbers[i], 21, "config.numbers");
        FIELD(numbers[i], 20, NULL);
    }
}

static void test_the_first_wrong_field_is_named(void)
{
    config.inner.byte = 0;
    config.number = 100;
    expect_config("config.number");
    config.inner.byte = 0;
    config.count = UINT32_MAX;
    expect_config("config.count");
}

static void test_a_refusal_names_its_field(void)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_config_refuse("config.number", &field));
    TEST_ASSERT_EQUAL_STRING("config.number", field);
}
