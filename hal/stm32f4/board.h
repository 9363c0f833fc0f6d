/**
 * The board, as wired: everything that another board with an STM32F405 would have otherwise.
 *
 * STM32F405VG (LQFP100), 24 V battery, two brushed motors. Each motor is between two half bridges of N-channel MOSFETs
 * with bootstrapped gate drivers (class of the DRV8305 or FD6288); their inputs have pull-downs, so that the bridges
 * are off until the timers drive them. Each motor's current is sensed in line by a bidirectional amplifier (class of
 * the INA240) whose zero is at half of the reference.
 *
 * TIM1 drives the left motor, TIM8 the right one; TIM4 and TIM2 count their encoders; TIM3 divides the frequency of the
 * PWM for the samples; TIM5 counts microseconds.
 */
#ifndef JOULEPATH_HAL_STM32F4_BOARD_H
#define JOULEPATH_HAL_STM32F4_BOARD_H

#include <joulepath/fixed.h>

#include "hal/stm32f4/pins.h"

/** Pins: port, number, alternate function. BREAK is the gate drivers' fault output, active low; H and L are the inputs
 *  for the high and the low side. */
#define BOARD_LEFT_1H         ((struct jp_pin){&GPIOE, 9, 1})
#define BOARD_LEFT_1L         ((struct jp_pin){&GPIOE, 8, 1})
#define BOARD_LEFT_2H         ((struct jp_pin){&GPIOE, 11, 1})
#define BOARD_LEFT_2L         ((struct jp_pin){&GPIOE, 10, 1})
#define BOARD_LEFT_BREAK      ((struct jp_pin){&GPIOE, 15, 1})
#define BOARD_RIGHT_1H        ((struct jp_pin){&GPIOC, 6, 3})
#define BOARD_RIGHT_1L        ((struct jp_pin){&GPIOA, 7, 3})
#define BOARD_RIGHT_2H        ((struct jp_pin){&GPIOC, 7, 3})
#define BOARD_RIGHT_2L        ((struct jp_pin){&GPIOB, 0, 3})
#define BOARD_RIGHT_BREAK     ((struct jp_pin){&GPIOA, 6, 3})
#define BOARD_LEFT_ENCODER_A  ((struct jp_pin){&GPIOD, 12, 2})
#define BOARD_LEFT_ENCODER_B  ((struct jp_pin){&GPIOD, 13, 2})
#define BOARD_RIGHT_ENCODER_A ((struct jp_pin){&GPIOA, 0, 1})
#define BOARD_RIGHT_ENCODER_B ((struct jp_pin){&GPIOA, 1, 1})
#define BOARD_LEFT_CURRENT    ((struct jp_pin){&GPIOC, 0, 0})
#define BOARD_RIGHT_CURRENT   ((struct jp_pin){&GPIOC, 1, 0})
#define BOARD_BUS_VOLTAGE     ((struct jp_pin){&GPIOC, 2, 0})
#define BOARD_IMU_CLOCK       ((struct jp_pin){&GPIOB, 3, 5})
#define BOARD_IMU_DATA_OUT    ((struct jp_pin){&GPIOB, 4, 5})
#define BOARD_IMU_DATA_IN     ((struct jp_pin){&GPIOB, 5, 5})
#define BOARD_IMU_SELECT      ((struct jp_pin){&GPIOA, 15, 0})
#define BOARD_CAN_RX          ((struct jp_pin){&GPIOD, 0, 9})
#define BOARD_CAN_TX          ((struct jp_pin){&GPIOD, 1, 9})
#define BOARD_SERIAL_TX       ((struct jp_pin){&GPIOA, 9, 7})
#define BOARD_SERIAL_RX       ((struct jp_pin){&GPIOA, 10, 7})

/** Open: sensors and bridges are the board's. To ground: they are on the bus. */
#define BOARD_STRAP ((struct jp_pin){&GPIOE, 2, 0})

/** Channels of the ADC at those pins. */
#define BOARD_LEFT_CURRENT_CHANNEL  10U
#define BOARD_RIGHT_CURRENT_CHANNEL 11U
#define BOARD_BUS_VOLTAGE_CHANNEL   12U

/** Crystal; a multiple of 2 MHz. */
#define BOARD_CRYSTAL_HZ 8000000U

/** Of the bridges. */
#define BOARD_PWM_HZ 20000U

/** Both switches of a half bridge off: longer than the MOSFETs take to switch off. */
#define BOARD_DEAD_TIME_NS 300U

/** The low side is on for at least so long in each period, for the bootstrap capacitor. */
#define BOARD_LOW_SIDE_NS 500U

/** 1: a duty above 0 drives the motor's wheel forward as it is wired; -1: backward. */
#define BOARD_MOTOR_SIGN_LEFT  1
#define BOARD_MOTOR_SIGN_RIGHT (-1)

/** 1: the timer counts up when the wheel drives forward; -1: down. Motors face each other. */
#define BOARD_ENCODER_SIGN_LEFT  1
#define BOARD_ENCODER_SIGN_RIGHT (-1)

/** What a current that drives the wheel forward does to its reading: 1 raises it, -1 lowers it. */
#define BOARD_CURRENT_SIGN_LEFT  1
#define BOARD_CURRENT_SIGN_RIGHT (-1)

/** ADC: reference, counts of 12 bits, and what one is worth, in Q24, where `mv` stand for `units`. */
#define BOARD_REFERENCE_MV 3300
#define BOARD_ADC_COUNTS   4096
#define BOARD_PER_COUNT(units, mv)                                                                                     \
    ((jp_q24)((INT64_C(2) * JP_Q24_ONE * BOARD_REFERENCE_MV * (units) / ((mv)*BOARD_ADC_COUNTS) + 1) / 2))

/** Shunts of 10 mΩ, amplified 20 times: ±8.25 A, 4 mA a count. */
#define BOARD_AMPERES_PER_COUNT BOARD_PER_COUNT(1, 200)

/** Reading without a current, and how far amplifier and reference may be off it (5 % of half the range). */
#define BOARD_CURRENT_ZERO           2048U
#define BOARD_CURRENT_ZERO_TOLERANCE 102U

/** Divider of the bus voltage, 100 kΩ over 10 kΩ: 36.3 V, 8.9 mV a count. */
#define BOARD_VOLTS_PER_COUNT BOARD_PER_COUNT(11, 1000)

/**
 * The inertial sensor as mounted: which of its axes (0 x, 1 y, 2 z) and which sign is the body's x (forward), y (left)
 * and z (up).
 */
#define BOARD_IMU_X_AXIS 0
#define BOARD_IMU_X_SIGN 1
#define BOARD_IMU_Y_AXIS 1
#define BOARD_IMU_Y_SIGN 1
#define BOARD_IMU_Z_AXIS 2
#define BOARD_IMU_Z_SIGN 1

/** 1 Mbit/s from 42 MHz: 14 quanta a bit, 1 + 10 before the sample point (78.6 %) and 3 after it. */
#define BOARD_CAN_PRESCALER  3U
#define BOARD_CAN_SEGMENT_1  10U
#define BOARD_CAN_SEGMENT_2  3U
#define BOARD_CAN_JUMP_WIDTH 3U

#endif
