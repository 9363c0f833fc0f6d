/**
 * Wheel encoders: TIM4 left, TIM2 right, every edge of both channels counted, edges filtered. The timers count 16 bits;
 * what they moved since the last read is added to counts of 32 bits, exactly while it is less than 32 768 either way.
 */
#ifndef JOULEPATH_HAL_STM32F4_ENCODERS_H
#define JOULEPATH_HAL_STM32F4_ENCODERS_H

#include <joulepath/sensors.h>

struct jp_encoders {
    uint16_t left; /**< timers, at the last read */
    uint16_t right;
    uint32_t count_left; /**< wrapping */
    uint32_t count_right;
};

/** Starts both timers from 0. Not for ISRs. */
void jp_encoders_start(struct jp_encoders *encoders);

/** encoder_left and encoder_right of *sensors, now. Once a tick. Constant time. */
void jp_encoders_read(struct jp_encoders *encoders, struct jp_sensors *sensors);

#endif
