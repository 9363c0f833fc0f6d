/* What the firmware keeps: its bytes, whose it is, and each field that cannot be. */
#include <joulepath/tables.h>

#include "hal/storage/parameters.h"

#include <stddef.h>
#include <string.h>

#define NOR_WORDS 128U

#include "tests/support/nor_flash.h"

#include "unity.h"

static struct jp_robot_config config;
static struct jp_parameters parameters;
static struct jp_parameters found;
static uint8_t record[JP_PARAMETERS_LENGTH + 1U];
static const char *field;

void setUp(void)
{
    config = jp_robot_courier24;
    jp_parameters_default(&parameters);
    parameters.energy.identity = 7;
    parameters.energy.x[2] = -JP_Q24(1.25);
    parameters.energy.s[3][1] = -12345678;
    parameters.energy.version = 1000;
    parameters.gyro_bias = -123456789012345;
    parameters.current_zero_left = 2047;
    parameters.current_zero_right = 0xFEDC;
    parameters.gyro_scale = (struct jp_gyro_scale){-10737418, 3000000};
    memset(&found, 0xA5, sizeof found);
    field = NULL;
}

void tearDown(void)
{
}

static void encode(void)
{
    jp_parameters_encode(&parameters, jp_robot_identity(&config), record);
}

static enum jp_status decode(uint16_t length)
{
    return jp_parameters_decode(&found, jp_robot_identity(&config), record, length, &field);
}

static void expect_found(void)
{
    TEST_ASSERT_EQUAL_INT(0, memcmp(&parameters.energy, &found.energy, sizeof found.energy));
    TEST_ASSERT_EQUAL_INT64(parameters.gyro_bias, found.gyro_bias);
    TEST_ASSERT_EQUAL_UINT16(parameters.current_zero_left, found.current_zero_left);
    TEST_ASSERT_EQUAL_UINT16(parameters.current_zero_right, found.current_zero_right);
    TEST_ASSERT_EQUAL_INT32(parameters.gyro_scale.error, found.gyro_scale.error);
    TEST_ASSERT_EQUAL_INT32(parameters.gyro_scale.deviation, found.gyro_scale.deviation);
}

/* Refused with this name, and nothing is touched. */
static void expect_refused(uint16_t length, const char *expected)
{
    struct jp_parameters before;

    memset(&before, 0xA5, sizeof before);
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, decode(length));
    TEST_ASSERT_EQUAL_STRING(expected, field);
    TEST_ASSERT_EQUAL_INT(0, memcmp(&before, &found, sizeof found));
}

/* The record */

static void test_parameters_come_back(void)
{
    encode();
    TEST_ASSERT_EQUAL_INT(JP_OK, decode(JP_PARAMETERS_LENGTH));
    expect_found();
}

static void test_defaults_are_nothing_learned(void)
{
    struct jp_learned_state nothing;

    jp_learned_state_start(&nothing, 0);
    jp_parameters_default(&parameters);
    TEST_ASSERT_EQUAL_INT(0, memcmp(&nothing, &parameters.energy, sizeof nothing));
    TEST_ASSERT_EQUAL_INT64(0, parameters.gyro_bias);
    TEST_ASSERT_EQUAL_INT32(0, parameters.gyro_scale.error);
    TEST_ASSERT_EQUAL_INT32(0, parameters.gyro_scale.deviation);
    TEST_ASSERT_EQUAL_UINT16(0, parameters.current_zero_left);
    TEST_ASSERT_EQUAL_UINT16(0, parameters.current_zero_right);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_parameters_check(&parameters, &field));
}

/* Each byte at its place: another version of the firmware must find it there. */
static void test_the_record_is_little_endian_and_without_gaps(void)
{
    for (uint32_t i = 0; i < 23U; i++) {
        const uint32_t word = 0x04030201U + 0x04040404U * (i + 2U);

        memcpy((uint8_t *)&parameters.energy + sizeof word * i, &word, sizeof word);
    }
    parameters.gyro_bias = 0x6C6B6A6968676665;
    parameters.current_zero_left = 0x6E6D;
    parameters.current_zero_right = 0x706F;
    parameters.gyro_scale = (struct jp_gyro_scale){0x74737271, 0x78777675};
    jp_parameters_encode(&parameters, 0x08070605U, record);
    TEST_ASSERT_EQUAL_HEX32(JP_PARAMETERS_VERSION, record[0] | (uint32_t)record[1] << 8 | (uint32_t)record[2] << 16 |
                                                       (uint32_t)record[3] << 24);
    for (uint8_t i = 4; i < JP_PARAMETERS_LENGTH; i++) {
        TEST_ASSERT_EQUAL_UINT8(i + 1U, record[i]);
    }
    TEST_ASSERT_EQUAL_UINT32(120, JP_PARAMETERS_LENGTH);
}

/* The order of members is part of the format. */
static void test_the_numbers_of_the_state_are_in_their_order(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, offsetof(struct jp_learned_state, x));
    TEST_ASSERT_EQUAL_UINT32(16, offsetof(struct jp_learned_state, s));
    TEST_ASSERT_EQUAL_UINT32(80, offsetof(struct jp_learned_state, noise_scale));
    TEST_ASSERT_EQUAL_UINT32(84, offsetof(struct jp_learned_state, version));
    TEST_ASSERT_EQUAL_UINT32(88, offsetof(struct jp_learned_state, identity));
}

static void test_another_version_is_refused(void)
{
    encode();
    for (unsigned bit = 0; bit < 32U; bit++) {
        record[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        expect_refused(JP_PARAMETERS_LENGTH, "version");
        expect_refused(JP_PARAMETERS_LENGTH + 1U, "version");
        record[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
    }
}

/* That held the energy model, which is built in again. */
static void test_a_record_of_the_first_version_is_refused(void)
{
    encode();
    record[0] = 1;
    expect_refused(100, "version");
}

static void test_another_length_is_refused(void)
{
    encode();
    for (uint16_t length = 0; length <= JP_PARAMETERS_LENGTH + 1U; length++) {
        if (length != JP_PARAMETERS_LENGTH) {
            expect_refused(length, "length");
        }
    }
}

/* The start */

static void expect_start(enum jp_stored stored, uint16_t length)
{
    struct jp_parameters expected = parameters;

    if (stored != JP_STORED_TAKEN) {
        jp_parameters_default(&expected);
    }
    memset(&found, 0xA5, sizeof found);
    TEST_ASSERT_EQUAL_INT(stored, jp_parameters_start(&found, jp_robot_identity(&config), record, length));
    TEST_ASSERT_EQUAL_MEMORY(&expected.energy, &found.energy, sizeof expected.energy);
    TEST_ASSERT_EQUAL_INT64(expected.gyro_bias, found.gyro_bias);
    TEST_ASSERT_EQUAL_UINT16(expected.current_zero_left, found.current_zero_left);
    TEST_ASSERT_EQUAL_UINT16(expected.current_zero_right, found.current_zero_right);
}

static void test_a_start_tells_what_it_found(void)
{
    encode();
    expect_start(JP_STORED_TAKEN, JP_PARAMETERS_LENGTH);
    expect_start(JP_STORED_NOTHING, 0);
    expect_start(JP_STORED_DAMAGED, 7);
    expect_start(JP_STORED_DAMAGED, JP_PARAMETERS_LENGTH - 1U);
    expect_start(JP_STORED_DAMAGED, JP_PARAMETERS_LENGTH + 1U);
    record[8 + 4 * 20] ^= 0xFFU; /* a field out of range */
    record[8 + 4 * 20 + 3] ^= 0xFFU;
    expect_start(JP_STORED_DAMAGED, JP_PARAMETERS_LENGTH);
    encode();
    record[0]++;
    expect_start(JP_STORED_OTHER_VERSION, JP_PARAMETERS_LENGTH);
    encode();
    config = jp_robot_gao2018;
    expect_start(JP_STORED_OTHER_ROBOT, JP_PARAMETERS_LENGTH);
}

/* The robot */

static void test_another_robot_is_refused(void)
{
    encode();
    config = jp_robot_gao2018;
    expect_refused(JP_PARAMETERS_LENGTH, "robot");
}

/* On every core the same: zlib.crc32(bytes(186)). */
static void test_the_identity_is_the_crc_of_name_and_numbers(void)
{
    struct jp_robot_config none;

    memset(&none, 0, sizeof none);
    none.name = "";
    TEST_ASSERT_EQUAL_HEX32(0x152517DCU, jp_robot_identity(&none));
    none.name = "x";
    TEST_ASSERT_TRUE(jp_robot_identity(&none) != 0x152517DCU);
    none.name = NULL;
    TEST_ASSERT_EQUAL_HEX32(0x152517DCU, jp_robot_identity(&none));
}

/* Bytes that are no field: padding and the name's pointer. */
#define NUMBERS_SIZE                                                                                                   \
    (36U + sizeof(struct jp_reference_config) + sizeof(struct jp_lqr_config) + 58U + sizeof(struct jp_meter_config) +  \
     sizeof(struct jp_segment_limits) + sizeof(jp_q24))

static void test_every_number_of_the_configuration_counts(void)
{
    const uint32_t identity = jp_robot_identity(&config);
    const char *const name = config.name;
    size_t counting = 0;

    for (size_t i = 0; i < sizeof config; i++) {
        ((uint8_t *)&config)[i] ^= 0x10U;

        const bool is_name = config.name != name;

        config.name = name;
        counting += !is_name && jp_robot_identity(&config) != identity ? 1U : 0U;
        if (!is_name) {
            ((uint8_t *)&config)[i] ^= 0x10U;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(NUMBERS_SIZE, counting);
    TEST_ASSERT_EQUAL_HEX32(identity, jp_robot_identity(&config));
}

static void test_the_name_counts(void)
{
    const uint32_t identity = jp_robot_identity(&config);
    static const char copy[] = "courier24";

    config.name = copy;
    TEST_ASSERT_EQUAL_HEX32(identity, jp_robot_identity(&config));
    config.name = copy + 1;
    TEST_ASSERT_TRUE(identity != jp_robot_identity(&config));
}

/* Fields */

/* This value of one field is refused by its name, in a record and when it is to be saved. */
#define REFUSED(member, value, expected)                                                                               \
    do {                                                                                                               \
        setUp();                                                                                                       \
        parameters.member = (value);                                                                                   \
        encode();                                                                                                      \
        expect_refused(JP_PARAMETERS_LENGTH, (expected));                                                              \
        TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_parameters_check(&parameters, &field));                                \
        TEST_ASSERT_EQUAL_STRING((expected), field);                                                                   \
    } while (0)

#define TAKEN(member, value)                                                                                           \
    do {                                                                                                               \
        setUp();                                                                                                       \
        parameters.member = (value);                                                                                   \
        encode();                                                                                                      \
        TEST_ASSERT_EQUAL_INT(JP_OK, decode(JP_PARAMETERS_LENGTH));                                                    \
        expect_found();                                                                                                \
    } while (0)

static void test_numbers_out_of_range_are_refused_by_name(void)
{
    REFUSED(energy.x[0], INT32_MAX, "state.x");
    REFUSED(energy.x[3], INT32_MIN, "state.x");
    REFUSED(energy.s[0][0], 0, "state.s");
    REFUSED(energy.s[3][3], INT32_MAX, "state.s");
    REFUSED(energy.noise_scale, 0, "state.noise_scale");
    REFUSED(energy.noise_scale, INT32_MAX, "state.noise_scale");
    REFUSED(gyro_bias, JP_PARAMETERS_GYRO_BIAS_MAX + 1, "gyro_bias");
    REFUSED(gyro_bias, -JP_PARAMETERS_GYRO_BIAS_MAX - 1, "gyro_bias");
    REFUSED(gyro_bias, INT64_MIN, "gyro_bias");
    REFUSED(gyro_scale.error, JP_GYRO_SCALE_MAX + 1, "gyro_scale.error");
    REFUSED(gyro_scale.error, -JP_GYRO_SCALE_MAX - 1, "gyro_scale.error");
    REFUSED(gyro_scale.deviation, -1, "gyro_scale.deviation");
    REFUSED(gyro_scale.deviation, JP_GYRO_SCALE_DEVIATION_MAX + 1, "gyro_scale.deviation");
}

static void test_the_edges_of_the_ranges_are_taken(void)
{
    TAKEN(gyro_bias, JP_PARAMETERS_GYRO_BIAS_MAX);
    TAKEN(gyro_bias, -JP_PARAMETERS_GYRO_BIAS_MAX);
    TAKEN(gyro_scale.error, JP_GYRO_SCALE_MAX);
    TAKEN(gyro_scale.error, -JP_GYRO_SCALE_MAX);
    TAKEN(gyro_scale.deviation, 0);
    TAKEN(gyro_scale.deviation, JP_GYRO_SCALE_DEVIATION_MAX);
    TAKEN(energy.x[3], JP_LEARNED_MAX);
    TAKEN(energy.x[3], -JP_LEARNED_MAX);
    TAKEN(energy.noise_scale, JP_Q16(8));
    TAKEN(energy.version, UINT32_MAX);
    TAKEN(energy.identity, UINT32_MAX);
    TAKEN(current_zero_left, UINT16_MAX);
    TAKEN(current_zero_right, 0);
}

static void test_null_is_an_argument(void)
{
    encode();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_parameters_decode(NULL, jp_robot_identity(&config), record, 1, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_parameters_decode(&found, jp_robot_identity(&config), NULL, 1, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_parameters_decode(&found, jp_robot_identity(&config), record, 1, NULL));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_parameters_check(NULL, &field));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, jp_parameters_check(&parameters, NULL));
}

/* In a store */

static struct nor_flash nor;
static struct jp_store store;

static void expect_differ(bool differ)
{
    TEST_ASSERT_EQUAL(differ, jp_parameters_differ(&parameters, &found));
    TEST_ASSERT_EQUAL(differ, jp_parameters_differ(&found, &parameters));
}

static void test_only_what_is_worth_a_write_differs(void)
{
    const int64_t step = (int64_t)(0.0001 * 16777216 + 0.5) * 4294967296;

    found = parameters;
    expect_differ(false);
    found.gyro_bias = parameters.gyro_bias + step;
    expect_differ(false);
    found.gyro_bias++;
    expect_differ(true);
    found = parameters;
    found.current_zero_left = (uint16_t)(found.current_zero_left + 4U);
    expect_differ(false);
    found.current_zero_left++;
    expect_differ(true);
    found = parameters;
    found.current_zero_right = (uint16_t)(found.current_zero_right - 5U);
    expect_differ(true);
    found = parameters;
    found.energy.version++;
    expect_differ(true);
    found = parameters;
    found.gyro_scale.error += JP_Q24(0.0005) * 64;
    found.gyro_scale.deviation -= JP_Q24(0.0005) * 64;
    expect_differ(false);
    found.gyro_scale.error++;
    expect_differ(true);
    found = parameters;
    found.gyro_scale.deviation -= JP_Q24(0.0005) * 64 + 1;
    expect_differ(true);
}

static void test_they_live_in_a_store(void)
{
    struct jp_flash flash;

    nor_start(&nor, 1);
    flash = nor_interface(&nor);
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_store_open(&store, &flash));
    TEST_ASSERT_EQUAL_INT(JP_ERR_EMPTY, jp_parameters_load(&found, jp_robot_identity(&config), &store, &field));
    for (int64_t bias = 1; bias < 10; bias++) {
        parameters.gyro_bias = bias;
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_parameters_save(&parameters, jp_robot_identity(&config), &store, &field));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_open(&store, &flash));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_parameters_load(&found, jp_robot_identity(&config), &store, &field));
        expect_found();
    }

    const unsigned long steps = nor.steps;

    parameters.gyro_bias = INT64_MAX;
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_parameters_save(&parameters, jp_robot_identity(&config), &store, &field));
    TEST_ASSERT_EQUAL_STRING("gyro_bias", field);
    TEST_ASSERT_EQUAL_UINT32(steps, nor.steps);
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG,
                          jp_parameters_load(&found, jp_robot_identity(&jp_robot_gao2018), &store, &field));
    TEST_ASSERT_EQUAL_STRING("robot", field);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_store_write(&store, (const uint8_t *)"other", 5));
    TEST_ASSERT_EQUAL_INT(JP_ERR_CONFIG, jp_parameters_load(&found, jp_robot_identity(&config), &store, &field));
    TEST_ASSERT_EQUAL_STRING("length", field);
}
