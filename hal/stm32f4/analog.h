/**
 * Motor currents and bus voltage: three injected conversions of ADC1, which TIM3 triggers in the middle of a PWM
 * period.
 */
#ifndef JOULEPATH_HAL_STM32F4_ANALOG_H
#define JOULEPATH_HAL_STM32F4_ANALOG_H

#include <stdbool.h>

#include <joulepath/sensors.h>
#include <joulepath/status.h>

/** Conversions whose mean is the zero of a current. A power of two. */
#define JP_ANALOG_ZERO_SAMPLES 64U

/** What a current or voltage at the end of the converter's range is reported as: beyond every limit of the monitor,
 * which makes a fault of it. −JP_ANALOG_SATURATED at the lower end of a current. */
#define JP_ANALOG_SATURATED INT32_MAX

struct jp_analog {
    uint16_t zero_left; /**< reading without current, counts */
    uint16_t zero_right;
};

/**
 * Starts the converter and measures the zeros of both currents: bridges off, wheels at rest. JP_ERR_HARDWARE: no
 * conversion ended in time, or a zero is not within BOARD_CURRENT_ZERO_TOLERANCE of BOARD_CURRENT_ZERO: a sensor is
 * missing or a current flows; the zeros are then BOARD_CURRENT_ZERO. At most 3 ms. Not for ISRs.
 */
enum jp_status jp_analog_start(struct jp_analog *analog);

/** From now on TIM3 triggers, and each sample ends with the ADC's interrupt. */
void jp_analog_run(void);

/** Of the ADC's interrupt. True: a sample is complete. Constant time. */
bool jp_analog_on_sample(void);

/** The last sample: current_left, current_right and bus_voltage of *sensors, within 0.13 mA and 0.13 mV of what the
 *  counts stand for. A reading of 0 or 4095 is reported as JP_ANALOG_SATURATED, but 0 of the bus voltage as 0 V.
 * Constant time. */
void jp_analog_read(const struct jp_analog *analog, struct jp_sensors *sensors);

#endif
