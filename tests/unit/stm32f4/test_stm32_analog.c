/* Currents and bus voltage: zeros with noise and out of range, every reading of the converter, a converter that stands.
 */
#include "hal/stm32f4/analog.h"

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

static struct jp_analog analog;
static struct jp_sensors sensors;

void setUp(void)
{
    stm32_fake_reset();
    analog = (struct jp_analog){.zero_left = BOARD_CURRENT_ZERO, .zero_right = BOARD_CURRENT_ZERO};
}

void tearDown(void)
{
}

/* ---- Zeros ---- */

static enum jp_status start_with(uint32_t left, uint32_t right)
{
    stm32_fake_reset();
    fake.readings[0] = left;
    fake.readings[1] = right;
    return jp_analog_start(&analog);
}

static void check_zeros(uint16_t left, uint16_t right)
{
    TEST_ASSERT_EQUAL_UINT16(left, analog.zero_left);
    TEST_ASSERT_EQUAL_UINT16(right, analog.zero_right);
}

static void test_zeros_are_what_is_read_without_current(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, start_with(2040, 2061));
    check_zeros(2040, 2061);
    TEST_ASSERT_EQUAL_UINT(JP_ANALOG_ZERO_SAMPLES, fake.conversions);
}

static void test_zeros_are_means_rounded_to_the_nearest(void)
{
    static const struct {
        int32_t noise[4];
        int left;
        int right;
    } cases[] = {
        {{-9, 4, 9, -4}, 0, 0}, {{0, 0, 0, 1}, 0, 0},        {{0, 0, 1, 1}, 1, 0},
        {{0, 1, 1, 1}, 1, -1},  {{40, 40, 41, 40}, 40, -40},
    };

    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        stm32_fake_reset();
        for (unsigned j = 0; j < 4U; j++) {
            fake.noise[j] = cases[i].noise[j];
        }
        TEST_ASSERT_EQUAL_INT(JP_OK, jp_analog_start(&analog));
        check_zeros((uint16_t)(2048 + cases[i].left), (uint16_t)(2048 + cases[i].right));
    }
}

static void test_zeros_as_far_off_as_is_tolerated(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, start_with(2048 + 102, 2048 - 102));
    check_zeros(2048 + 102, 2048 - 102);
    TEST_ASSERT_EQUAL_INT(JP_OK, start_with(2048 - 102, 2048 + 102));
    check_zeros(2048 - 102, 2048 + 102);
}

static void check_refused(uint32_t left, uint32_t right)
{
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, start_with(left, right));
    check_zeros(BOARD_CURRENT_ZERO, BOARD_CURRENT_ZERO);
}

static void test_zeros_farther_off_are_refused(void)
{
    check_refused(2048 + 103, 2048);
    check_refused(2048 - 103, 2048);
    check_refused(2048, 2048 + 103);
    check_refused(2048, 2048 - 103);
}

static void test_saturated_sensors_have_no_zero(void)
{
    check_refused(0, 2048);
    check_refused(4095, 2048);
    check_refused(2048, 0);
    check_refused(2048, 4095);
    check_refused(0, 4095);
}

static void test_a_converter_that_never_ends(void)
{
    fake.conversion = FAKE_NEVER;
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, jp_analog_start(&analog));
    check_zeros(BOARD_CURRENT_ZERO, BOARD_CURRENT_ZERO);
    TEST_ASSERT_EQUAL_UINT(1, fake.failed_waits);
    TEST_ASSERT_TRUE(fake.polls <= 1000U);
}

/* 15 + 12, 15 + 12 and 84 + 12 cycles at 16 MHz/4 by 4 cycles a poll. */
static void test_a_slow_conversion_is_waited_for(void)
{
    fake.conversion = (27U + 27U + 96U) * 4U / 4U;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_analog_start(&analog));
}

/* ---- Conversions ---- */

static unsigned channel_in(unsigned position)
{
    return (ADC1.JSQR >> (5U * (position - 1U))) & 0x1FU;
}

/* With three conversions the sequence begins at the second position. */
static void test_the_sequence_is_left_right_bus(void)
{
    (void)jp_analog_start(&analog);
    TEST_ASSERT_EQUAL_HEX32(ADC_JSQR_JL(2), ADC1.JSQR & ADC_JSQR_JL(3));
    TEST_ASSERT_EQUAL_UINT(10, channel_in(2));
    TEST_ASSERT_EQUAL_UINT(11, channel_in(3));
    TEST_ASSERT_EQUAL_UINT(12, channel_in(4));
    CHECK_SET(ADC_CR1_SCAN, ADC1.CR1);
    TEST_ASSERT_EQUAL_HEX32(0, ADC1.JOFR1 | ADC1.JOFR2 | ADC1.JOFR3);
}

static void test_the_converters_clock_is_at_most_36_mhz(void)
{
    (void)jp_analog_start(&analog);
    TEST_ASSERT_TRUE(84000000U / (2U * (((ADC.CCR >> 16) & 3U) + 1U)) <= 36000000U);
}

static void test_nothing_interrupts_before_the_run(void)
{
    (void)jp_analog_start(&analog);
    CHECK_CLEAR(ADC_CR1_JEOCIE, ADC1.CR1);
    CHECK_CLEAR(ADC_CR2_JEXTEN(3), ADC1.CR2);
}

static void test_in_the_run_tim3_triggers(void)
{
    (void)jp_analog_start(&analog);
    jp_analog_run();
    CHECK_SET(ADC_CR1_JEOCIE | ADC_CR1_SCAN, ADC1.CR1);
    TEST_ASSERT_EQUAL_HEX32(ADC_CR2_ADON | ADC_CR2_JEXTSEL(5) | ADC_CR2_JEXTEN(1), ADC1.CR2);
    CHECK_CLEAR(ADC_SR_JEOC, ADC1.SR);
}

static void test_a_sample_is_reported_once(void)
{
    ADC1.SR = ADC_SR_JEOC | ADC_SR_JSTRT;
    TEST_ASSERT_TRUE(jp_analog_on_sample());
    CHECK_CLEAR(ADC_SR_JEOC, ADC1.SR);

    ADC1.SR = ADC_SR_JSTRT;
    TEST_ASSERT_FALSE(jp_analog_on_sample());
}

/* ---- Readings ---- */

static void read_counts(uint32_t left, uint32_t right, uint32_t bus)
{
    ADC1.JDR1 = left;
    ADC1.JDR2 = right;
    ADC1.JDR3 = bus;
    jp_analog_read(&analog, &sensors);
}

/* 3.3 V / 4096 / (10 mΩ · 20) is 264 of 2⁻¹⁶ A. */
static jp_q16 amperes(uint32_t reading, uint16_t zero)
{
    return 264 * ((int32_t)reading - zero);
}

static void check_every_current(uint16_t zero_left, uint16_t zero_right)
{
    analog = (struct jp_analog){.zero_left = zero_left, .zero_right = zero_right};
    for (uint32_t reading = 1; reading < 4095U; reading++) {
        const uint32_t mirrored = 4095U - reading;

        read_counts(reading, mirrored, 2708);
        TEST_ASSERT_EQUAL_INT32(BOARD_CURRENT_SIGN_LEFT * amperes(reading, zero_left), sensors.current_left);
        TEST_ASSERT_EQUAL_INT32(BOARD_CURRENT_SIGN_RIGHT * amperes(mirrored, zero_right), sensors.current_right);
    }
}

static void test_every_current(void)
{
    check_every_current(2048, 2048);
    check_every_current(2048 - 102, 2048 + 102);
    check_every_current(2048 + 102, 2048 - 102);
}

/* 11 · 3.3 V / 4096 is 580.8 of 2⁻¹⁶ V; 0.13 mV are 8.5 of them. */
static void test_every_bus_voltage(void)
{
    for (uint32_t reading = 0; reading < 4095U; reading++) {
        const int32_t tenths = 5808 * (int32_t)reading;

        read_counts(2048, 2048, reading);
        TEST_ASSERT_TRUE(10 * sensors.bus_voltage - tenths <= 85 && tenths - 10 * sensors.bus_voltage <= 85);
    }
    read_counts(2048, 2048, 0);
    TEST_ASSERT_EQUAL_INT32(0, sensors.bus_voltage);
}

/* Whatever the zero: a fault of the monitor, whose limits are far below. */
static void test_the_ends_of_the_range_are_beyond_every_limit(void)
{
    analog = (struct jp_analog){.zero_left = 2048 + 102, .zero_right = 2048 - 102};
    read_counts(4095, 4095, 4095);
    TEST_ASSERT_EQUAL_INT32(BOARD_CURRENT_SIGN_LEFT * INT32_MAX, sensors.current_left);
    TEST_ASSERT_EQUAL_INT32(BOARD_CURRENT_SIGN_RIGHT * INT32_MAX, sensors.current_right);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, sensors.bus_voltage);

    read_counts(0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(-BOARD_CURRENT_SIGN_LEFT * INT32_MAX, sensors.current_left);
    TEST_ASSERT_EQUAL_INT32(-BOARD_CURRENT_SIGN_RIGHT * INT32_MAX, sensors.current_right);
}

static void test_no_other_measurement_is_touched(void)
{
    sensors = (struct jp_sensors){
        .encoder_left = 1, .encoder_right = 2, .pitch_rate = 3, .yaw_rate = 4, .accel_x = 5, .accel_z = 6};
    read_counts(2048, 2048, 2708);
    TEST_ASSERT_EQUAL_UINT32(1, sensors.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(2, sensors.encoder_right);
    TEST_ASSERT_EQUAL_INT32(3, sensors.pitch_rate);
    TEST_ASSERT_EQUAL_INT32(4, sensors.yaw_rate);
    TEST_ASSERT_EQUAL_INT32(5, sensors.accel_x);
    TEST_ASSERT_EQUAL_INT32(6, sensors.accel_z);
}
