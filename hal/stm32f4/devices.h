/**
 * All devices of the board, as the application uses them.
 *
 *   jp_devices_start()      once: what is there?
 *   jp_devices_on_sample()  ADC's interrupt: begins the transfer of the inertial sample
 *   jp_devices_on_imu()     DMA2_Stream0's interrupt, which is the control interrupt: the tick comes after it
 *
 * The interrupts are the caller's: he enables them in the NVIC after the start.
 */
#ifndef JOULEPATH_HAL_STM32F4_DEVICES_H
#define JOULEPATH_HAL_STM32F4_DEVICES_H

#include "hal/hal.h"
#include "hal/stm32f4/analog.h"
#include "hal/stm32f4/bridges.h"
#include "hal/stm32f4/can_controller.h"
#include "hal/stm32f4/clock.h"
#include "hal/stm32f4/encoders.h"
#include "hal/stm32f4/imu.h"

struct jp_devices {
    enum jp_clock clock;
    bool on_bus; /**< the strap is set, or is not there: sensors and bridges are on the bus, and none here is used */
    bool has_can;
    enum jp_status analog_status; /**< of jp_analog_start(); JP_OK when on_bus */
    enum jp_status imu_status;    /**< of jp_imu_start(); JP_OK when on_bus */
    struct jp_bridges bridges;
    struct jp_analog analog;
    struct jp_encoders encoders;
    struct jp_imu imu;
    struct jp_can_controller can;
};

/**
 * Starts clock, time and CAN, whose frames go to `receive`, and, unless the strap says that they are on the bus,
 * bridges (off), encoders, ADC and inertial sensor. Samples come from now on, but not on_bus. What failed is in
 * *devices, which must stay, in memory that DMA reaches. At most 0.5 s. Not for ISRs.
 */
void jp_devices_start(struct jp_devices *devices, uint32_t tick_rate, jp_can_receiver receive, void *context);

/** True: the inertial sensor is absent, no transfer will end, and the tick is due now. Constant time. */
bool jp_devices_on_sample(struct jp_devices *devices);

void jp_devices_on_imu(struct jp_devices *devices);

/** Sensors and bridges of the board: read() costs at most 116, write() 66 instructions on Cortex-M4 at -O2. read() is
 *  JP_ERR_HARDWARE without a sample of the inertial sensor, and always when the currents' zeros could not be measured.
 */
struct jp_hal jp_devices_hal(struct jp_devices *devices);

#endif
