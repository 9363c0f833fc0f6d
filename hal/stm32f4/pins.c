#include "hal/stm32f4/pins.h"

#define PORT_CLOCKS                                                                                                    \
    (RCC_AHB1ENR_GPIOAEN | RCC_AHB1ENR_GPIOBEN | RCC_AHB1ENR_GPIOCEN | RCC_AHB1ENR_GPIODEN | RCC_AHB1ENR_GPIOEEN)

/* Fields of a pin: 2 bits each in MODER, OSPEEDR and PUPDR, 4 in AFRL and AFRH. */
#define MODE_INPUT     0U
#define MODE_OUTPUT    1U
#define MODE_ALTERNATE 2U
#define MODE_ANALOG    3U
#define SPEED_MEDIUM   1U /* 25 MHz */
#define PULL_NONE      0U
#define PULL_UP        1U

#define PINS_IN_AFRL 8U

static void set_field(volatile uint32_t *reg, unsigned index, unsigned bits, uint32_t value)
{
    const uint32_t mask = (1U << bits) - 1U;
    const unsigned shift = index * bits;

    *reg = (*reg & ~(mask << shift)) | (value << shift);
}

void jp_pins_start(void)
{
    RCC.AHB1ENR |= PORT_CLOCKS;
}

static void connect(struct jp_pin pin, uint32_t pull)
{
    if (pin.number < PINS_IN_AFRL) {
        set_field(&pin.port->AFRL, pin.number, 4, pin.function);
    } else {
        set_field(&pin.port->AFRH, pin.number - PINS_IN_AFRL, 4, pin.function);
    }
    set_field(&pin.port->OSPEEDR, pin.number, 2, SPEED_MEDIUM);
    set_field(&pin.port->PUPDR, pin.number, 2, pull);
    set_field(&pin.port->MODER, pin.number, 2, MODE_ALTERNATE);
}

void jp_pin_drive(struct jp_pin pin)
{
    connect(pin, PULL_NONE);
}

void jp_pin_listen(struct jp_pin pin)
{
    connect(pin, PULL_UP);
}

void jp_pin_analog(struct jp_pin pin)
{
    set_field(&pin.port->PUPDR, pin.number, 2, PULL_NONE);
    set_field(&pin.port->MODER, pin.number, 2, MODE_ANALOG);
}

void jp_pin_output(struct jp_pin pin)
{
    jp_pin_set(pin, true);
    set_field(&pin.port->OSPEEDR, pin.number, 2, SPEED_MEDIUM);
    set_field(&pin.port->MODER, pin.number, 2, MODE_OUTPUT);
}

void jp_pin_input(struct jp_pin pin)
{
    set_field(&pin.port->PUPDR, pin.number, 2, PULL_UP);
    set_field(&pin.port->MODER, pin.number, 2, MODE_INPUT);
}

/* The upper half of BSRR resets. */
void jp_pin_set(struct jp_pin pin, bool high)
{
    pin.port->BSRR = high ? 1U << pin.number : 1U << (pin.number + 16U);
}

bool jp_pin_is_high(struct jp_pin pin)
{
    return (pin.port->IDR & (1U << pin.number)) != 0U;
}
