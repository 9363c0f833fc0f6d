/* Wheels and supply of a robot with four steered wheels in frames: what arrives is what was sent, and only whole. */
#include "hal/can/wheel_link.h"

#include "hal/can/jp_can.h"
#include "unity.h"

#define FRAMES (JP_WHEELS + 1)

static struct jp_can_frame frames[FRAMES];
static struct jp_wheel_targets targets;
static struct jp_wheel_link link;
static struct jp_four_wheel_actuation told;
static struct jp_four_wheel_sensors seen;
static uint8_t counter;
static bool is_whole;

void setUp(void)
{
    targets = (struct jp_wheel_targets){.enabled = 0};
    link = (struct jp_wheel_link){.lost = 0};
    told = (struct jp_four_wheel_actuation){.enabled = 7};
    counter = 3;
}

void tearDown(void)
{
}

static const struct jp_four_wheel_actuation usual = {
    .wheels = {.angle = {256, -512, INT32_MAX - 127, INT32_MIN}, .speed = {16, -160, JP_Q24(1.5), -JP_Q24(16)}},
    .enabled = 1};

static enum jp_e2e_result send_targets(const struct jp_four_wheel_actuation *actuation, unsigned missing)
{
    enum jp_e2e_result result = JP_E2E_OK;

    jp_wheel_targets_pack(frames, &counter, actuation);
    for (unsigned i = 0; i < JP_WHEELS; i++) {
        TEST_ASSERT_EQUAL_UINT32(JP_CAN_WHEEL_TARGET_FRAME_ID, frames[i].id);
        TEST_ASSERT_EQUAL_UINT8(8, frames[i].length);
        if (i != missing) {
            result = jp_wheel_targets_accept(&targets, &frames[i], &told, &is_whole);
        }
    }
    return result;
}

static void test_targets_arrive_as_they_were_sent(void)
{
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, send_targets(&usual, FRAMES));
    TEST_ASSERT_EQUAL_UINT8(4, counter);
    TEST_ASSERT_EQUAL_UINT8(7, told.enabled);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_targets(&usual, FRAMES));
    TEST_ASSERT_TRUE(is_whole);
    TEST_ASSERT_EQUAL_UINT8(1, told.enabled);
    for (unsigned i = 0; i < JP_WHEELS; i++) {
        TEST_ASSERT_INT32_WITHIN(128, usual.wheels.angle[i], told.wheels.angle[i]);
        TEST_ASSERT_EQUAL_INT32(usual.wheels.speed[i], told.wheels.speed[i]);
    }
}

static void test_drives_are_off_unless_all_are_on(void)
{
    struct jp_four_wheel_actuation off = usual;

    off.enabled = 0;
    (void)send_targets(&usual, FRAMES);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_targets(&off, FRAMES));
    TEST_ASSERT_EQUAL_UINT8(0, told.enabled);
}

static void test_targets_of_which_one_is_missing_do_not_count(void)
{
    (void)send_targets(&usual, FRAMES);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_targets(&usual, 1));
    TEST_ASSERT_FALSE(is_whole);
    TEST_ASSERT_EQUAL_UINT8(7, told.enabled);
    /* Nor do those of two commands together. */
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_targets(&usual, 2));
    TEST_ASSERT_FALSE(is_whole);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_targets(&usual, FRAMES));
    TEST_ASSERT_TRUE(is_whole);
}

static void test_corrupt_and_repeated_targets_are_refused(void)
{
    (void)send_targets(&usual, FRAMES);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_targets(&usual, FRAMES));
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, jp_wheel_targets_accept(&targets, &frames[3], &told, &is_whole));
    for (unsigned bit = 0; bit < 64; bit++) {
        jp_wheel_targets_pack(frames, &counter, &usual);
        frames[0].data[bit / 8] ^= (uint8_t)(1U << (bit % 8));
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_wheel_targets_accept(&targets, &frames[0], &told, &is_whole));
        TEST_ASSERT_FALSE(is_whole);
    }
}

static const struct jp_four_wheel_sensors sample = {.count = {0, 1, 0xFFFFFFFF, 0x01000005},
                                                    .angle = {1 << 18, -(1 << 18), 256, -256},
                                                    .bus_voltage = JP_Q16(24),
                                                    .bus_current = -JP_Q16(12.5)};

static enum jp_e2e_result send_sample(const struct jp_four_wheel_sensors *sensors, unsigned missing)
{
    enum jp_e2e_result result = JP_E2E_OK;

    jp_wheel_sample_pack(frames, &counter, sensors);
    for (unsigned i = 0; i < FRAMES; i++) {
        if (i != missing) {
            result = jp_wheel_link_accept(&link, &frames[i]);
        }
    }
    return result;
}

static void test_a_sample_arrives_as_it_was_sent(void)
{
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, send_sample(&sample, FRAMES));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_UINT16(0, link.lost);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_sample(&sample, FRAMES));
    TEST_ASSERT_TRUE(link.has_started);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_UINT32(0xFFFFFFFF, seen.count[2]);
    TEST_ASSERT_EQUAL_UINT32(5, seen.count[3]); /* the low bits, nearest to what came before */
    for (unsigned i = 0; i < JP_WHEELS; i++) {
        TEST_ASSERT_EQUAL_INT32(sample.angle[i], seen.angle[i]);
    }
    TEST_ASSERT_EQUAL_INT32(sample.bus_voltage, seen.bus_voltage);
    TEST_ASSERT_EQUAL_INT32(sample.bus_current, seen.bus_current);
}

static void test_counts_go_on_over_the_wrap_of_their_bits(void)
{
    struct jp_four_wheel_sensors moved = sample;

    (void)send_sample(&moved, FRAMES);
    for (uint32_t i = 0; i < 50; i++) {
        moved.count[0] -= 1000000U;
        moved.count[1] += 3000000U;
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_sample(&moved, FRAMES));
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_wheel_link_read(&link, &seen));
        TEST_ASSERT_EQUAL_UINT32(moved.count[0], seen.count[0]);
        TEST_ASSERT_EQUAL_UINT32(moved.count[1], seen.count[1]);
    }
}

static void test_a_sample_that_is_not_whole_does_not_count(void)
{
    (void)send_sample(&sample, FRAMES);
    (void)send_sample(&sample, FRAMES);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, send_sample(&sample, 2));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_UINT16(1, link.lost);
    (void)send_sample(&sample, JP_WHEELS);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, send_sample(&sample, FRAMES));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_UINT16(2, link.lost);
}

static void test_corrupt_samples_are_refused(void)
{
    (void)send_sample(&sample, FRAMES);
    (void)send_sample(&sample, FRAMES);
    for (unsigned part = 0; part < FRAMES; part++) {
        jp_wheel_sample_pack(frames, &counter, &sample);
        frames[part].data[5] ^= 0x10U;
        TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, jp_wheel_link_accept(&link, &frames[part]));
    }
}

static void test_values_beyond_the_signals_saturate(void)
{
    const struct jp_four_wheel_sensors far = {
        .angle = {INT32_MAX, INT32_MIN, 0, 0}, .bus_voltage = JP_Q16(1000), .bus_current = JP_Q16(30000)};
    const struct jp_four_wheel_sensors low = {.bus_voltage = -1};

    (void)send_sample(&far, FRAMES);
    (void)send_sample(&far, FRAMES);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX - 255, seen.angle[0]);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, seen.angle[1]);
    TEST_ASSERT_EQUAL_INT32(65535 * 512, seen.bus_voltage);
    TEST_ASSERT_EQUAL_INT32(((1 << 23) - 1) * 64, seen.bus_current);
    (void)send_sample(&low, FRAMES);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_wheel_link_read(&link, &seen));
    TEST_ASSERT_EQUAL_INT32(0, seen.bus_voltage);
}
