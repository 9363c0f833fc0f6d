#include "hal/stm32f4/analog.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"

#define READING_MAX (BOARD_ADC_COUNTS - 1)

/* Fields of the registers. */
#define ADCPRE_4          1U /* 21 MHz */
#define SAMPLE_15_CYCLES  1U /* of an amplifier's output */
#define SAMPLE_84_CYCLES  4U /* of the divider, 9 kΩ */
#define THREE_CONVERSIONS 2U
#define JEXTSEL_TIM3_CC4  5U
#define JEXTEN_RISING     1U

#define POWER_UP_US      10U /* 3 µs at most */
#define CONVERSION_POLLS 1000U

_Static_assert(BOARD_LEFT_CURRENT_CHANNEL == 10U && BOARD_RIGHT_CURRENT_CHANNEL == 11U &&
                   BOARD_BUS_VOLTAGE_CHANNEL == 12U,
               "the sampling times below are for these channels");

/* Bits of SR are cleared by writing 0; 1 leaves them. */
static void clear_end_of_sample(void)
{
    ADC1.SR = ~ADC_SR_JEOC;
}

/** The three conversions end up in JDR1 to JDR3. */
static void configure(void)
{
    jp_pin_analog(BOARD_LEFT_CURRENT);
    jp_pin_analog(BOARD_RIGHT_CURRENT);
    jp_pin_analog(BOARD_BUS_VOLTAGE);
    RCC.APB2ENR |= RCC_APB2ENR_ADC1EN;
    ADC.CCR = ADC_CCR_ADCPRE(ADCPRE_4);
    ADC1.CR1 = ADC_CR1_SCAN;
    ADC1.SMPR1 =
        ADC_SMPR1_SMP10(SAMPLE_15_CYCLES) | ADC_SMPR1_SMP11(SAMPLE_15_CYCLES) | ADC_SMPR1_SMP12(SAMPLE_84_CYCLES);
    ADC1.JSQR = ADC_JSQR_JL(THREE_CONVERSIONS) | ADC_JSQR_JSQ2(BOARD_LEFT_CURRENT_CHANNEL) |
                ADC_JSQR_JSQ3(BOARD_RIGHT_CURRENT_CHANNEL) | ADC_JSQR_JSQ4(BOARD_BUS_VOLTAGE_CHANNEL);
    ADC1.CR2 = ADC_CR2_ADON;
    jp_wait_us(POWER_UP_US);
}

static bool converts(void)
{
    clear_end_of_sample();
    ADC1.CR2 = ADC_CR2_ADON | ADC_CR2_JSWSTART;
    return jp_wait_for(&ADC1.SR, ADC_SR_JEOC, ADC_SR_JEOC, CONVERSION_POLLS);
}

static uint16_t mean(uint32_t sum)
{
    return (uint16_t)((sum + JP_ANALOG_ZERO_SAMPLES / 2U) / JP_ANALOG_ZERO_SAMPLES);
}

static bool is_zero_plausible(uint16_t zero)
{
    return zero >= BOARD_CURRENT_ZERO - BOARD_CURRENT_ZERO_TOLERANCE &&
           zero <= BOARD_CURRENT_ZERO + BOARD_CURRENT_ZERO_TOLERANCE;
}

static bool measure_zeros(struct jp_analog *analog)
{
    uint32_t left = 0;
    uint32_t right = 0;

    for (unsigned i = 0; i < JP_ANALOG_ZERO_SAMPLES; i++) {
        if (!converts()) {
            return false;
        }
        left += ADC1.JDR1;
        right += ADC1.JDR2;
    }
    analog->zero_left = mean(left);
    analog->zero_right = mean(right);
    return is_zero_plausible(analog->zero_left) && is_zero_plausible(analog->zero_right);
}

enum jp_status jp_analog_start(struct jp_analog *analog)
{
    configure();
    if (!measure_zeros(analog)) {
        *analog = (struct jp_analog){.zero_left = BOARD_CURRENT_ZERO, .zero_right = BOARD_CURRENT_ZERO};
        return JP_ERR_HARDWARE;
    }
    return JP_OK;
}

void jp_analog_run(void)
{
    clear_end_of_sample();
    ADC1.CR1 = ADC_CR1_SCAN | ADC_CR1_JEOCIE;
    ADC1.CR2 = ADC_CR2_ADON | ADC_CR2_JEXTSEL(JEXTSEL_TIM3_CC4) | ADC_CR2_JEXTEN(JEXTEN_RISING);
}

bool jp_analog_on_sample(void)
{
    if ((ADC1.SR & ADC_SR_JEOC) == 0U) {
        return false;
    }
    clear_end_of_sample();
    return true;
}

/** Q24 a count to Q16, rounded down. */
static jp_q16 scale(int32_t counts, jp_q24 per_count)
{
    return (counts * per_count) >> 8;
}

_Static_assert(BOARD_AMPERES_PER_COUNT > 0 && BOARD_AMPERES_PER_COUNT < INT32_MAX / BOARD_ADC_COUNTS, "scale()");
_Static_assert(BOARD_VOLTS_PER_COUNT > 0 && BOARD_VOLTS_PER_COUNT < INT32_MAX / BOARD_ADC_COUNTS, "scale()");

static inline jp_q16 current_of(uint32_t reading, uint16_t zero, int sign)
{
    if (reading - 1U >= READING_MAX - 1U) {
        return (reading == 0U) == (sign > 0) ? -JP_ANALOG_SATURATED : JP_ANALOG_SATURATED;
    }
    return scale((int32_t)reading - zero, sign * BOARD_AMPERES_PER_COUNT);
}

void jp_analog_read(const struct jp_analog *analog, struct jp_sensors *sensors)
{
    const uint32_t bus = ADC1.JDR3;

    sensors->current_left = current_of(ADC1.JDR1, analog->zero_left, BOARD_CURRENT_SIGN_LEFT);
    sensors->current_right = current_of(ADC1.JDR2, analog->zero_right, BOARD_CURRENT_SIGN_RIGHT);
    sensors->bus_voltage = bus == READING_MAX ? JP_ANALOG_SATURATED : scale((int32_t)bus, BOARD_VOLTS_PER_COUNT);
}
