/* Samples from frames: parts put together, every way of losing one, readings held and counts extrapolated. */
#include <string.h>

#include "hal/can/sample_link.h"

#include "unity.h"

/* What is plausible in a tick; half of it is taken to catch up. */
static const struct jp_monitor_config limits = {.encoder_jump = 400, .gyro_jump = 2000};

/* At 1 kHz. */
#define HOLD_TICKS JP_SAMPLE_HOLD_MS

static struct jp_sample_link link;
static struct jp_can_frame frames[JP_SAMPLE_PARTS];
static struct jp_sensors sensors;
static struct jp_sensors got;
static struct jp_sensors good; /* what the monitor took last */
static uint8_t counter;

void setUp(void)
{
    jp_sample_link_start(&link, &limits, 1000);
    sensors = (struct jp_sensors){.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    good = sensors;
    counter = 0;
}

void tearDown(void)
{
}

/* The next sample: counts go on by this, all else is told apart by the current. */
static void measure(uint32_t left, uint32_t right)
{
    sensors.encoder_left += left;
    sensors.encoder_right += right;
    sensors.current_left += 256;
    jp_message_from_sensors(frames, &counter, &sensors);
}

static enum jp_e2e_result give(enum jp_sample_part part)
{
    return jp_sample_link_accept(&link, part, &frames[part]);
}

static enum jp_e2e_result give_all(void)
{
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(JP_SAMPLE_WHEELS));
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(JP_SAMPLE_BALANCE));
    return give(JP_SAMPLE_CURRENTS);
}

/* Every reading counts as plausible. */
static enum jp_status take(void)
{
    const enum jp_status status = jp_sample_link_read(&link, &good, &got);

    if (status == JP_OK || status == JP_HELD) {
        good = got;
    }
    return status;
}

static void expect_read(enum jp_status status, uint32_t left, uint32_t right)
{
    got = (struct jp_sensors){.encoder_left = 1};
    TEST_ASSERT_EQUAL_INT(status, take());
    TEST_ASSERT_EQUAL_UINT32(left, got.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(right, got.encoder_right);
}

static void expect_nothing(void)
{
    expect_read(JP_ERR_HARDWARE, 1, 0); /* nothing was written */
}

/* Two samples, the second one read: counts 0. */
static void begin(void)
{
    measure(0, 0);
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, give_all());
    measure(0, 0);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    expect_read(JP_OK, 0, 0);
}

static void sample(uint32_t left, uint32_t right)
{
    measure(left, right);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    expect_read(JP_OK, sensors.encoder_left, sensors.encoder_right);
}

/* Putting together */

static void test_nothing_is_read_before_the_second_sample(void)
{
    expect_nothing();
    measure(5, 6);
    TEST_ASSERT_EQUAL_INT(JP_E2E_FIRST, give_all());
    TEST_ASSERT_FALSE(link.fresh);
    expect_nothing();
    measure(5, 6);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    TEST_ASSERT_TRUE(link.fresh);
    expect_read(JP_OK, 10, 12);
    TEST_ASSERT_FALSE(link.fresh);
    TEST_ASSERT_EQUAL_UINT16(0, link.lost);
}

static void test_a_sample_is_whole_only_with_its_last_frame(void)
{
    begin();
    measure(1, 1);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(JP_SAMPLE_WHEELS));
    TEST_ASSERT_FALSE(link.fresh);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(JP_SAMPLE_BALANCE));
    TEST_ASSERT_FALSE(link.fresh);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give(JP_SAMPLE_CURRENTS));
    TEST_ASSERT_TRUE(link.fresh);
    TEST_ASSERT_EQUAL_INT(JP_OK, take());
    TEST_ASSERT_EQUAL_MEMORY(&sensors, &got, sizeof got);
}

static void test_without_any_one_frame_there_is_no_sample(void)
{
    for (int lost = 0; lost < JP_SAMPLE_PARTS; lost++) {
        setUp();
        begin();
        measure(1, 1);
        for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
            const bool last = part == JP_SAMPLE_CURRENTS;

            if (part != lost) {
                TEST_ASSERT_EQUAL_INT(last ? JP_E2E_SEQUENCE : JP_E2E_OK, give((enum jp_sample_part)part));
            }
        }
        TEST_ASSERT_FALSE(link.fresh);
        sample(1, 1);
    }
}

static void test_frames_of_two_samples_do_not_join(void)
{
    for (int old = 0; old < JP_SAMPLE_CURRENTS; old++) {
        struct jp_can_frame kept;

        setUp();
        begin();
        measure(1, 1);
        kept = frames[old];
        measure(1, 1);
        frames[old] = kept;
        TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, give_all());
        TEST_ASSERT_FALSE(link.fresh);
        sample(1, 1);
    }
}

static void test_frames_with_the_counter_of_sixteen_samples_ago_do_not_join(void)
{
    struct jp_can_frame old;

    begin();
    measure(7, 7);
    old = frames[JP_SAMPLE_WHEELS];
    for (int i = 0; i < 15; i++) {
        measure(7, 7);
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    }
    measure(7, 7);
    frames[JP_SAMPLE_WHEELS] = old;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, give_all());
}

static void test_repeated_and_corrupt_samples_are_not_used(void)
{
    begin();
    sample(3, 3);
    TEST_ASSERT_EQUAL_INT(JP_E2E_REPEATED, give_all());
    TEST_ASSERT_FALSE(link.fresh);
    measure(3, 3);
    frames[JP_SAMPLE_BALANCE].data[6] ^= 1U;
    TEST_ASSERT_EQUAL_INT(JP_E2E_CRC, give_all());
    TEST_ASSERT_FALSE(link.fresh);
    sample(3, 3);
}

static void test_a_last_frame_alone_is_no_sample_again(void)
{
    begin();
    measure(3, 3);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    TEST_ASSERT_EQUAL_INT(JP_E2E_SEQUENCE, give(JP_SAMPLE_CURRENTS));
    expect_read(JP_OK, 3, 3);
}

static void test_a_late_sample_is_not_used(void)
{
    struct jp_can_frame late[JP_SAMPLE_PARTS];

    begin();
    measure(2, 2);
    memcpy(late, frames, sizeof late);
    sample(2, 2);
    for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
        const bool last = part == JP_SAMPLE_CURRENTS;

        TEST_ASSERT_EQUAL_INT(last ? JP_E2E_SEQUENCE : JP_E2E_OK,
                              jp_sample_link_accept(&link, (enum jp_sample_part)part, &late[part]));
    }
    TEST_ASSERT_FALSE(link.fresh);
    sample(2, 2);
}

static void test_the_newest_of_two_samples_in_a_tick_is_read(void)
{
    begin();
    measure(2, 2);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    measure(2, 2);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    expect_read(JP_OK, 4, 4);
    TEST_ASSERT_FALSE(link.fresh);
}

/* Holding */

static void test_readings_are_held_for_just_so_many_ticks(void)
{
    struct jp_sensors last;

    begin();
    sample(0, 0);
    last = got;
    for (unsigned i = 0; i < HOLD_TICKS; i++) {
        TEST_ASSERT_EQUAL_INT(JP_HELD, take());
        TEST_ASSERT_EQUAL_MEMORY(&last, &got, sizeof got);
        TEST_ASSERT_EQUAL_UINT16(i + 1U, link.lost);
    }
    expect_nothing();
    expect_nothing();
    TEST_ASSERT_EQUAL_UINT16(HOLD_TICKS + 2U, link.lost);
    sample(0, 0);
    TEST_ASSERT_EQUAL_INT(JP_HELD, take()); /* holds anew */
}

static void test_what_is_held_is_the_last_plausible_reading(void)
{
    begin();
    sample(0, 0);
    good.pitch_rate = 77;
    good.bus_voltage = JP_Q16(23);
    TEST_ASSERT_EQUAL_INT(JP_HELD, take());
    TEST_ASSERT_EQUAL_INT32(77, got.pitch_rate);
    TEST_ASSERT_EQUAL_INT32(JP_Q16(23), got.bus_voltage);
}

/* Until the median of the paces is this one. */
static void roll(uint32_t left, uint32_t right)
{
    for (unsigned i = 0; i < JP_SAMPLE_PACES; i++) {
        sample(left, right);
    }
}

static void test_held_counts_go_on_as_before(void)
{
    uint32_t left;
    uint32_t right;

    begin();
    roll(40, 0U - 30U);
    left = got.encoder_left;
    right = got.encoder_right;
    for (uint32_t i = 1; i <= HOLD_TICKS; i++) {
        expect_read(JP_HELD, left + 40U * i, right - 30U * i);
    }
    expect_nothing();
}

static void test_the_pace_is_the_median_of_the_last_five(void)
{
    static const uint32_t steps[5] = {90, 10, 50, 1000, 30};
    uint32_t left;

    begin();
    for (unsigned i = 0; i < 5; i++) {
        sample(steps[i], 0);
    }
    left = got.encoder_left;
    expect_read(JP_HELD, left + 50U, 0);
}

/* Half the range away: on the way back it would be taken for a turn of the bits. */
static void test_one_corrupt_count_changes_neither_pace_nor_base(void)
{
    begin();
    roll(40, 40);
    sensors.encoder_left ^= 1U << 21;
    measure(40, 40);
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    TEST_ASSERT_EQUAL_INT(JP_OK, take());
    sensors.encoder_left ^= 1U << 21;
    sample(40, 40);
    expect_read(JP_HELD, sensors.encoder_left + 40U, sensors.encoder_right + 40U);
}

static void test_the_pace_is_that_of_each_tick_between_two_samples(void)
{
    uint32_t left;

    begin();
    for (unsigned i = 0; i < 3; i++) { /* the median of five */
        TEST_ASSERT_EQUAL_INT(JP_HELD, take());
        TEST_ASSERT_EQUAL_INT(JP_HELD, take());
        measure(90, 0); /* in three ticks */
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
        TEST_ASSERT_EQUAL_INT(JP_OK, take());
    }
    left = got.encoder_left;
    TEST_ASSERT_EQUAL_INT(JP_HELD, take());
    TEST_ASSERT_EQUAL_UINT32(left + 30U, got.encoder_left);
}

static void test_counts_wrap_while_they_are_held(void)
{
    jp_sample_link_resume(&link, UINT32_MAX - 100U, 50);
    sensors.encoder_left = UINT32_MAX - 100U;
    sensors.encoder_right = 50;
    measure(0, 0);
    (void)give_all();
    roll(30, 0U - 15U);
    TEST_ASSERT_EQUAL_UINT32(49, got.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX - 24U, got.encoder_right);
    expect_read(JP_HELD, 79, UINT32_MAX - 39U);
}

/* Catching up */

static void hold(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        TEST_ASSERT_EQUAL_INT(JP_HELD, take());
    }
}

static void test_after_a_gap_nothing_jumps_farther_than_half_of_what_is_plausible(void)
{
    begin();
    hold(HOLD_TICKS);
    sensors.pitch_rate = 10500;
    sensors.yaw_rate = -9 * 4096;
    measure(1100, 0U - 900U);
    for (unsigned i = 0; i < HOLD_TICKS; i++) {
        const struct jp_sensors before = got;

        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
        TEST_ASSERT_EQUAL_INT(JP_OK, take());
        TEST_ASSERT_INT32_WITHIN(200, 0, (int32_t)(got.encoder_left - before.encoder_left));
        TEST_ASSERT_INT32_WITHIN(200, 0, (int32_t)(got.encoder_right - before.encoder_right));
        TEST_ASSERT_INT32_WITHIN(1000, before.pitch_rate, got.pitch_rate);
        TEST_ASSERT_INT32_WITHIN(1000, before.yaw_rate, got.yaw_rate);
        measure(0, 0);
    }
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    TEST_ASSERT_EQUAL_INT(JP_OK, take());
    TEST_ASSERT_EQUAL_MEMORY(&sensors, &got, sizeof got);
}

static void test_it_catches_up_for_as_many_ticks_as_were_bridged(void)
{
    begin();
    hold(3);
    measure(10000, 0);
    for (uint32_t i = 1; i <= 3; i++) {
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
        expect_read(JP_OK, 200U * i, 0);
        measure(0, 0);
    }
    TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
    expect_read(JP_OK, 10000, 0); /* a jump is a jump: the monitor says so */
}

static void test_what_is_no_rate_and_no_count_is_read_at_once(void)
{
    begin();
    hold(5);
    sensors.accel_x = JP_Q24(0.5);
    sensors.bus_voltage = JP_Q16(19);
    sample(0, 0);
    TEST_ASSERT_EQUAL_MEMORY(&sensors, &got, sizeof got);
}

static void test_without_a_gap_a_jump_is_read_at_once(void)
{
    begin();
    sample(10000, 0U - 10000U);
}

/* Counts beyond the bits of a sample */

static void test_counts_go_on_far_beyond_the_bits_of_a_sample(void)
{
    begin();
    for (int i = 0; i < 40000; i++) {
        sample(1U << 17, 0U - (1U << 17));
    }
}

/* Farther than half the range of the bits. */
static void test_counts_of_fast_wheels_go_on_after_a_gap(void)
{
    const uint32_t fast = 150000;

    begin();
    roll(fast, 0U - fast);
    hold(HOLD_TICKS);
    sensors.encoder_left += fast * HOLD_TICKS;
    sensors.encoder_right -= fast * HOLD_TICKS;
    for (unsigned i = 0; i < HOLD_TICKS; i++) {
        measure(fast, 0U - fast);
        TEST_ASSERT_EQUAL_INT(JP_E2E_OK, give_all());
        TEST_ASSERT_EQUAL_INT(JP_OK, take());
    }
    sample(fast, 0U - fast);
}

static void test_counts_resume_where_they_were(void)
{
    for (uint32_t i = 0; i < 1000; i++) {
        const uint32_t left = i * 4294961U;
        const uint32_t right = 0U - left;

        setUp();
        jp_sample_link_resume(&link, left, right);
        sensors.encoder_left = left + 1000U;
        sensors.encoder_right = right - 1000U;
        measure(0, 0);
        (void)give_all();
        sample(0, 0);
    }
}

static void test_lost_ticks_saturate(void)
{
    begin();
    link.lost = UINT16_MAX - 1U;
    expect_read(JP_HELD, 0, 0);
    expect_read(JP_HELD, 0, 0);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, link.lost);
}
