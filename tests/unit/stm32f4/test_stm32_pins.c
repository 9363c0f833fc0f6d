/* Pins and time: each field of each pin, and none of its neighbours'. */
#include "hal/stm32f4/pins.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/timer.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

void setUp(void)
{
    stm32_fake_reset();
}

void tearDown(void)
{
}

static void fill(volatile struct stm32_gpio *port, uint32_t value)
{
    port->MODER = value;
    port->OSPEEDR = value;
    port->PUPDR = value;
    port->AFRL = value;
    port->AFRH = value;
}

static uint32_t field(uint32_t reg, unsigned index, unsigned bits)
{
    return (reg >> (index * bits)) & ((1U << bits) - 1U);
}

/* `reg` is what it was before, but for one field. */
static void check_field(uint32_t before, uint32_t reg, unsigned index, unsigned bits, uint32_t value)
{
    const uint32_t mask = ((1U << bits) - 1U) << (index * bits);

    TEST_ASSERT_EQUAL_UINT32(value, field(reg, index, bits));
    TEST_ASSERT_EQUAL_HEX32(before & ~mask, reg & ~mask);
}

static void check_connected(uint8_t number, uint8_t function, uint32_t before, uint32_t pull)
{
    check_field(before, GPIOB.MODER, number, 2, 2);
    check_field(before, GPIOB.PUPDR, number, 2, pull);
    check_field(before, GPIOB.OSPEEDR, number, 2, 1);
    if (number < 8U) {
        check_field(before, GPIOB.AFRL, number, 4, function);
        TEST_ASSERT_EQUAL_HEX32(before, GPIOB.AFRH);
    } else {
        check_field(before, GPIOB.AFRH, number - 8U, 4, function);
        TEST_ASSERT_EQUAL_HEX32(before, GPIOB.AFRL);
    }
}

static void check_connects(uint8_t number, uint8_t function, uint32_t before)
{
    const struct jp_pin pin = {&GPIOB, number, function};

    fill(&GPIOB, before);
    jp_pin_drive(pin);
    check_connected(number, function, before, 0);
    fill(&GPIOB, before);
    jp_pin_listen(pin);
    check_connected(number, function, before, 1);
}

static void test_every_pin_is_connected_to_every_function(void)
{
    for (uint8_t number = 0; number < 16U; number++) {
        for (uint8_t function = 0; function < 16U; function++) {
            check_connects(number, function, 0);
            check_connects(number, function, UINT32_MAX);
        }
    }
}

static void test_analog_pins(void)
{
    for (uint8_t number = 0; number < 16U; number++) {
        fill(&GPIOC, 0x55555555U);
        jp_pin_analog((struct jp_pin){&GPIOC, number, 0});
        check_field(0x55555555U, GPIOC.MODER, number, 2, 3);
        check_field(0x55555555U, GPIOC.PUPDR, number, 2, 0);
    }
}

static void test_inputs(void)
{
    for (uint8_t number = 0; number < 16U; number++) {
        fill(&GPIOD, UINT32_MAX);
        jp_pin_input((struct jp_pin){&GPIOD, number, 0});
        check_field(UINT32_MAX, GPIOD.MODER, number, 2, 0);
        check_field(UINT32_MAX, GPIOD.PUPDR, number, 2, 1);

        GPIOD.IDR = 1U << number;
        TEST_ASSERT_TRUE(jp_pin_is_high((struct jp_pin){&GPIOD, number, 0}));
        GPIOD.IDR = ~(1U << number);
        TEST_ASSERT_FALSE(jp_pin_is_high((struct jp_pin){&GPIOD, number, 0}));
    }
}

static void test_outputs(void)
{
    for (uint8_t number = 0; number < 16U; number++) {
        const struct jp_pin pin = {&GPIOA, number, 0};

        fill(&GPIOA, 0);
        jp_pin_output(pin);
        check_field(0, GPIOA.MODER, number, 2, 1);
        TEST_ASSERT_EQUAL_HEX32(1U << number, GPIOA.BSRR);
        jp_pin_set(pin, false);
        TEST_ASSERT_EQUAL_HEX32(0x10000U << number, GPIOA.BSRR);
        jp_pin_set(pin, true);
        TEST_ASSERT_EQUAL_HEX32(1U << number, GPIOA.BSRR);
    }
}

static void test_all_ports_of_the_board_have_a_clock(void)
{
    jp_pins_start();
    TEST_ASSERT_EQUAL_HEX32(0x1F, RCC.AHB1ENR);
}

static void test_no_pin_of_the_board_is_used_twice(void)
{
    const struct jp_pin pins[] = {
        BOARD_LEFT_1H,        BOARD_LEFT_1L,        BOARD_LEFT_2H,         BOARD_LEFT_2L,         BOARD_LEFT_BREAK,
        BOARD_RIGHT_1H,       BOARD_RIGHT_1L,       BOARD_RIGHT_2H,        BOARD_RIGHT_2L,        BOARD_RIGHT_BREAK,
        BOARD_LEFT_ENCODER_A, BOARD_LEFT_ENCODER_B, BOARD_RIGHT_ENCODER_A, BOARD_RIGHT_ENCODER_B, BOARD_LEFT_CURRENT,
        BOARD_RIGHT_CURRENT,  BOARD_BUS_VOLTAGE,    BOARD_IMU_CLOCK,       BOARD_IMU_DATA_OUT,    BOARD_IMU_DATA_IN,
        BOARD_IMU_SELECT,     BOARD_CAN_RX,         BOARD_CAN_TX,          BOARD_SERIAL_TX,       BOARD_SERIAL_RX,
        BOARD_STRAP,          {&GPIOA, 13, 0}, /* SWDIO and SWCLK: the debugger's */
        {&GPIOA, 14, 0},
    };
    const unsigned count = sizeof pins / sizeof pins[0];

    for (unsigned i = 0; i < count; i++) {
        for (unsigned j = i + 1U; j < count; j++) {
            TEST_ASSERT_FALSE(pins[i].port == pins[j].port && pins[i].number == pins[j].number);
        }
    }
}

static void check_counts_microseconds(uint32_t timer_hz)
{
    stm32_fake_reset();
    jp_timer_start(timer_hz);
    CHECK_SET(RCC_APB1ENR_TIM5EN, RCC.APB1ENR);
    TEST_ASSERT_EQUAL_UINT32(1000000, timer_hz / (TIM5.PSC + 1U));
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, TIM5.ARR);
    CHECK_SET(TIM_CR1_CEN, TIM5.CR1);
    CHECK_SET(TIM_EGR_UG, TIM5.EGR);
}

static void test_time_in_microseconds(void)
{
    check_counts_microseconds(84000000);
    check_counts_microseconds(16000000);
    TIM5.CNT = 0x12345678;
    TEST_ASSERT_EQUAL_HEX32(0x12345678, jp_timer_us());
}
