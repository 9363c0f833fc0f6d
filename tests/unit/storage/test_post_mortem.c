/** The record of a crash, and when the robot may go on after one. */
#include "hal/storage/post_mortem.h"

#include <stddef.h>
#include <string.h>

#include "hal/storage/memory_check.h"
#include "unity.h"

static struct jp_post_mortem record;
static struct jp_reset_report report;

static const struct jp_crash crash = {
    .cause = JP_RESET_FAULT,
    .exception = 6,
    .pc = 0x0800C123U,
    .lr = 0x0800D457U,
    .psr = 0x61000000U,
    .status = 0x00010000U,
    .address = 0x20001234U,
    .tick = 4711,
};

void setUp(void)
{
    memset(&record, 0xA5, sizeof record);
    jp_post_mortem_open(&record, JP_RESET_POWER_ON, &report);
}

void tearDown(void)
{
}

static void test_power_on_finds_no_crash_whatever_the_memory_holds(void)
{
    const struct jp_crash none = {.pc = 0};

    TEST_ASSERT_EQUAL_INT(JP_RESET_POWER_ON, report.cause);
    TEST_ASSERT_EQUAL_UINT32(0, report.crashes);
    TEST_ASSERT_EQUAL_MEMORY(&none, &report.crash, sizeof none);
    TEST_ASSERT_TRUE(report.may_go_on);
}

static void test_memory_that_was_never_written_is_no_record(void)
{
    memset(&record, 0xFF, sizeof record);
    jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    TEST_ASSERT_EQUAL_INT(JP_RESET_SOFTWARE, report.cause);
    TEST_ASSERT_EQUAL_UINT32(0, report.crashes);
    memset(&record, 0, sizeof record);
    jp_post_mortem_open(&record, JP_RESET_WATCHDOG, &report);
    TEST_ASSERT_EQUAL_UINT32(1, report.crashes);
    TEST_ASSERT_EQUAL_HEX32(0, report.crash.pc);
}

static void test_every_flipped_bit_spoils_the_record(void)
{
    struct jp_post_mortem whole;

    jp_post_mortem_write(&record, &crash);
    whole = record;
    for (size_t bit = 0; bit < 8U * sizeof record; bit++) {
        record = whole;
        ((uint8_t *)&record)[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
        TEST_ASSERT_EQUAL_INT(JP_RESET_SOFTWARE, report.cause);
        TEST_ASSERT_EQUAL_UINT32(0, report.crashes);
    }
}

static void test_a_crash_is_reported_as_it_was(void)
{
    jp_post_mortem_write(&record, &crash);
    jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    TEST_ASSERT_EQUAL_INT(JP_RESET_FAULT, report.cause);
    TEST_ASSERT_EQUAL_UINT32(1, report.crashes);
    TEST_ASSERT_EQUAL_MEMORY(&crash, &report.crash, sizeof crash);
    TEST_ASSERT_TRUE(report.may_go_on);
}

static void test_a_later_reset_keeps_the_crash_but_not_its_cause(void)
{
    jp_post_mortem_write(&record, &crash);
    jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    TEST_ASSERT_EQUAL_INT(JP_RESET_SOFTWARE, report.cause);
    TEST_ASSERT_EQUAL_UINT32(1, report.crashes);
    TEST_ASSERT_EQUAL_HEX32(crash.pc, report.crash.pc);
    jp_post_mortem_open(&record, JP_RESET_PIN, &report);
    TEST_ASSERT_EQUAL_INT(JP_RESET_PIN, report.cause);
}

/** The watchdog may bite while a crash is being written. */
static void test_the_watchdog_outranks_a_pending_crash(void)
{
    jp_post_mortem_write(&record, &crash);
    jp_post_mortem_open(&record, JP_RESET_WATCHDOG, &report);
    TEST_ASSERT_EQUAL_INT(JP_RESET_WATCHDOG, report.cause);
    TEST_ASSERT_EQUAL_UINT32(2, report.crashes);
}

static void test_watchdog_and_brown_out_are_crashes_too(void)
{
    jp_post_mortem_open(&record, JP_RESET_WATCHDOG, &report);
    TEST_ASSERT_EQUAL_UINT32(1, report.crashes);
    jp_post_mortem_open(&record, JP_RESET_BROWN_OUT, &report);
    TEST_ASSERT_EQUAL_UINT32(2, report.crashes);
    jp_post_mortem_open(&record, JP_RESET_PIN, &report);
    TEST_ASSERT_EQUAL_UINT32(2, report.crashes);
    jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    TEST_ASSERT_EQUAL_UINT32(2, report.crashes);
}

static void test_the_third_crash_in_a_row_ends_going_on(void)
{
    for (uint32_t i = 1; i <= JP_CRASHES_MAX; i++) {
        jp_post_mortem_write(&record, &crash);
        jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
        TEST_ASSERT_EQUAL_UINT32(i, report.crashes);
        TEST_ASSERT_EQUAL(i < JP_CRASHES_MAX, report.may_go_on);
    }
}

static void test_health_forgives(void)
{
    for (uint32_t i = 0; i < JP_CRASHES_MAX; i++) {
        jp_post_mortem_open(&record, JP_RESET_WATCHDOG, &report);
    }
    jp_post_mortem_forgive(&record);
    jp_post_mortem_open(&record, JP_RESET_WATCHDOG, &report);
    TEST_ASSERT_EQUAL_UINT32(1, report.crashes);
    TEST_ASSERT_TRUE(report.may_go_on);
}

/* Memory that adds up by chance. */
static void test_numbers_that_no_record_holds_are_none(void)
{
    jp_post_mortem_write(&record, &crash);
    record.crashes = 256;
    record.check = jp_memory_check(0x4A50504DU, &record, offsetof(struct jp_post_mortem, check));
    jp_post_mortem_open(&record, JP_RESET_PIN, &report);
    TEST_ASSERT_EQUAL_UINT32(0, report.crashes);

    struct jp_crash other = crash;

    other.cause = (enum jp_reset_cause)(JP_RESET_STACK + 1);
    jp_post_mortem_write(&record, &other);
    jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    TEST_ASSERT_EQUAL_INT(JP_RESET_SOFTWARE, report.cause);
    TEST_ASSERT_EQUAL_UINT32(0, report.crashes);
}

static void test_crashes_saturate(void)
{
    for (int i = 0; i < 300; i++) {
        jp_post_mortem_write(&record, &crash);
        jp_post_mortem_open(&record, JP_RESET_SOFTWARE, &report);
    }
    TEST_ASSERT_EQUAL_UINT32(255, report.crashes);
    TEST_ASSERT_FALSE(report.may_go_on);
}
