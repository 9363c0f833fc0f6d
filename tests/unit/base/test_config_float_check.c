/* The check of configurations in single precision: each width, each end of a range, what is no number, the first wrong
 * field, null pointers. */
#include "src/base/config_float_check.h"

#include <math.h>

#include "tests/support/config_check.h"
#include "unity.h"

struct inner {
    uint16_t half;
    uint8_t byte;
};

struct config {
    float number;
    struct inner inner;
};

#define ENTRY(member, low, high) JP_CONFIG_FIELD("config.", struct config, member, low, high)

static const struct jp_config_float_field fields[] = {
    ENTRY(number, -0.5f, 7.0f),
    ENTRY(inner.half, 256.0f, 65534.0f),
    ENTRY(inner.byte, 3.0f, 254.0f),
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

static enum jp_status check(const struct config *checked, const char **field)
{
    return jp_config_float_check(checked, fields, JP_CONFIG_COUNT(fields), field);
}

DEFINE_EXPECT_CONFIG_OF(check, good)

static void test_numbers_at_the_ends_of_their_range(void)
{
    expect_config(NULL);
    FIELD(number, -0x1.000002p-1f, "config.number");
    FIELD(number, -0.5f, NULL);
    FIELD(number, 7.0f, NULL);
    FIELD(number, 0x1.c00002p2f, "config.number");
}

static void test_what_is_no_number_is_refused(void)
{
    FIELD(number, NAN, "config.number");
    FIELD(number, -NAN, "config.number");
    FIELD(number, INFINITY, "config.number");
    FIELD(number, -INFINITY, "config.number");
}

static void test_short_numbers(void)
{
    RANGE("config.", inner.half, 256, 65534);
    RANGE("config.", inner.byte, 3, 254);
}

static void test_the_first_wrong_field_is_named(void)
{
    config.inner.byte = 0;
    config.number = 100.0f;
    expect_config("config.number");
    config.inner.byte = 0;
    config.inner.half = 0;
    expect_config("config.inner.half");
}
