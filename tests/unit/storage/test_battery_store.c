/* What is kept of a battery: its bytes, what does not fit, and the way through a store. */
#include <joulepath/tables.h>

#include "hal/storage/battery_store.h"

#include <stddef.h>
#include <string.h>

#define NOR_WORDS 128U

#include "tests/support/nor_flash.h"

#include "unity.h"

#define CAPACITY 10080
#define COULOMB  ((jp_charge)1 << 32)

static const struct jp_battery_config config = {
    .capacity = CAPACITY,
    .voltage_empty = JP_Q16(18),
    .voltage_nominal = JP_Q16(22),
    .voltage_full = JP_Q16(25.2),
    .voltage_min = JP_Q16(12),
    .voltage_max = JP_Q16(30),
    .voltage_jump = JP_Q16(6),
    .charge_efficiency = JP_Q16_ONE,
    .charge_deviation = (jp_q31)1 << 26,
    .update_rate = 1,
    .cells = &jp_battery_cells_courier24,
};

static struct jp_battery battery;
static struct jp_battery_state state;
static struct jp_battery_state found;
static uint8_t record[JP_BATTERY_STORE_LENGTH + 1U];
static const char *field;

/* A battery that has been used for some minutes. */
void setUp(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_start(&battery, &config, CAPACITY * COULOMB / 2, 0));
    for (int i = 1; i < 300; i++) {
        (void)jp_battery_update(&battery, &config, (jp_energy)(i % 3) * i << 34, JP_Q16(22) + i * 10);
    }
    jp_battery_save(&battery, &config, &state);
    memset(&found, 0xA5, sizeof found);
    field = "";
}

void tearDown(void)
{
}

static void expect_found(void)
{
    struct jp_battery other;

    TEST_ASSERT_NULL(field);
    TEST_ASSERT_EQUAL_HEX32(state.identity, found.identity);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&battery, &config, &state, 0, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_restore(&other, &config, &found, 0, &field));
    TEST_ASSERT_EQUAL_MEMORY(&battery.filter, &other.filter, sizeof other.filter);
    TEST_ASSERT_EQUAL_INT64(battery.charge, other.charge);
    TEST_ASSERT_EQUAL_INT64(battery.capacity, other.capacity);
}

static void test_what_lasts_comes_back(void)
{
    jp_battery_state_encode(&state, record);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_state_decode(&found, record, JP_BATTERY_STORE_LENGTH, &field));
    expect_found();
}

static void test_record_is_little_endian(void)
{
    state.identity = 0x12345678U;
    state.charge = 0x0102030405060708;
    jp_battery_state_encode(&state, record);
    TEST_ASSERT_EQUAL_HEX8(JP_BATTERY_STORE_VERSION, record[0]);
    TEST_ASSERT_EQUAL_HEX8(0x78, record[4]);
    TEST_ASSERT_EQUAL_HEX8(0x12, record[7]);
    TEST_ASSERT_EQUAL_HEX8(0x08, record[8]);
    TEST_ASSERT_EQUAL_HEX8(0x01, record[15]);
}

static void expect_refused(uint16_t length, const char *expected)
{
    struct jp_battery_state before = found;

    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_battery_state_decode(&found, record, length, &field));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    TEST_ASSERT_EQUAL_MEMORY(&before, &found, sizeof found);
}

static void test_records_that_do_not_fit(void)
{
    jp_battery_state_encode(&state, record);
    expect_refused(0, "length");
    expect_refused(3, "length");
    expect_refused(JP_BATTERY_STORE_LENGTH - 1U, "length");
    expect_refused(JP_BATTERY_STORE_LENGTH + 1U, "length");
    record[0]++;
    expect_refused(JP_BATTERY_STORE_LENGTH, "version");
    expect_refused(4, "version");
}

static void test_null_pointers(void)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_state_decode(NULL, record, 4, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_state_decode(&found, NULL, 4, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_battery_state_decode(&found, record, 4, NULL));
}

static void test_through_a_store(void)
{
    static struct nor_flash nor;
    struct jp_flash flash;
    struct jp_store store;

    nor_start(&nor, 1);
    flash = nor_interface(&nor);
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_battery_state_load(&found, &store, &field));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_state_save(&state, &store));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_battery_state_load(&found, &store, &field));
    expect_found();
}
