/** Random readings in the STM32F405's registers, for the benches of its drivers. */
#ifndef JOULEPATH_TESTS_BENCH_RANDOM_REGISTERS_H
#define JOULEPATH_TESTS_BENCH_RANDOM_REGISTERS_H

#include "hal/stm32f4/devices.h"
#include "hal/stm32f4/stm32f405.h"
#include "tests/target/random.h"

/** An end of the converter's range every fourth time. */
static inline uint32_t random_reading(uint32_t *state)
{
    const uint32_t bits = target_random(state);

    return (bits & 3U) == 0U ? (bits >> 2 & 1U) * 4095U : bits >> 20;
}

static inline void randomise_registers(struct jp_devices *devices, uint32_t *state)
{
    ADC1.JDR1 = random_reading(state);
    ADC1.JDR2 = random_reading(state);
    ADC1.JDR3 = random_reading(state);
    TIM4.CNT = target_random(state) & 0xFFFFU;
    TIM2.CNT = target_random(state) & 0xFFFFU;
    for (unsigned i = 0; i < sizeof devices->imu.received; i++) {
        devices->imu.received[i] = (target_random(state) & 0x300U) == 0U ? 0 : (uint8_t)target_random(state);
    }
}

#endif
