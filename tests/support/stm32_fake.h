/**
 * The STM32F405 without the chip: registers are plain memory, and what the drivers poll answers as the hardware would,
 * after as many polls as a test says, or never. What is not polled does nothing by itself.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_STM32_FAKE_H
#define JOULEPATH_TESTS_SUPPORT_STM32_FAKE_H

#include <stdbool.h>

#include "hal/stm32f4/stm32f405.h"

#define FAKE_NEVER UINT32_MAX

#define FAKE_IMU_REGISTERS 128
#define FAKE_WRITES        64

/* All of the bits are set, or none. */
#define CHECK_SET(bits, value)   TEST_ASSERT_EQUAL_HEX32((bits), (value) & (bits))
#define CHECK_CLEAR(bits, value) TEST_ASSERT_EQUAL_HEX32(0, (value) & (bits))

struct stm32_fake {
    /* Polls until each is ready; FAKE_NEVER. */
    uint32_t crystal;
    uint32_t pll_on_crystal;
    uint32_t pll_on_internal;
    uint32_t flash;
    uint32_t clock_switch;
    uint32_t can_init; /* into initialisation */
    uint32_t can_join; /* onto the bus */
    uint32_t conversion;
    uint32_t spi_byte;
    bool spi_stays_full; /* never TXE */
    bool spi_stays_busy; /* always BSY */

    /* The converter: each conversion's readings, left, right, bus, plus noise[n % 4]. */
    uint32_t readings[3];
    int32_t noise[4];
    unsigned conversions;

    /* The inertial sensor. */
    bool imu_absent;         /* the line stays high */
    unsigned imu_mute_reads; /* WHO_AM_I reads 0 so often */
    int imu_stuck_register;  /* keeps its value when written; -1: none */
    uint8_t imu_registers[FAKE_IMU_REGISTERS];
    unsigned identity_reads;
    uint8_t imu_writes[FAKE_WRITES][2]; /* address, value */
    unsigned imu_write_count;

    /* What was seen. */
    uint64_t polls;
    uint32_t longest_wait; /* polls of the longest wait that failed */
    unsigned failed_waits;
    uint64_t waited_us;
    bool fast_on_slow_flash; /* the PLL was the clock without 5 wait states */
};

extern struct stm32_fake fake;

/** Registers as after a reset; everything is ready at the third poll, the inertial sensor is there. */
void stm32_fake_reset(void);

#endif
