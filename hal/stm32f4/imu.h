/**
 * The inertial sensor: MPU-6500 or MPU-9250 on SPI1, ±500 °/s and ±4 g, filtered to 184 Hz, a sample a millisecond.
 * The DMA controller (DMA2, stream 0 in and 3 out) transfers a sample while the program goes on.
 */
#ifndef JOULEPATH_HAL_STM32F4_IMU_H
#define JOULEPATH_HAL_STM32F4_IMU_H

#include <stdbool.h>

#include <joulepath/sensors.h>
#include <joulepath/status.h>

/** Acceleration x y z, temperature, rate x y z: 16 bits each, high byte first. */
#define JP_IMU_SAMPLE_BYTES 14U

enum jp_imu_state {
    JP_IMU_ABSENT, /**< it did not answer at the start, or a transfer did not end */
    JP_IMU_READY,
    JP_IMU_BUSY, /**< a transfer is under way */
    JP_IMU_FRESH /**< a sample has come and was not read yet */
};

/** In memory that DMA reaches: not in the core-coupled RAM. Must stay. */
struct jp_imu {
    volatile enum jp_imu_state state;
    uint8_t sent[1U + JP_IMU_SAMPLE_BYTES]; /**< the register's address, then zeros */
    uint8_t received[1U + JP_IMU_SAMPLE_BYTES];
};

/**
 * Finds the sensor and, unless it still is, resets and configures it: 2 ms or 0.3 s at most; needs jp_timer_start().
 * JP_ERR_HARDWARE: it does not say who it is in 10 attempts, or a register does not read back what was written; it is
 * then absent. Not for ISRs.
 */
enum jp_status jp_imu_start(struct jp_imu *imu);

/** Begins the transfer of a sample, which ends with the interrupt of DMA2's stream 0. JP_ERR_HARDWARE: the sensor is
 *  absent, or the transfer before this one has not ended, which makes it absent. Constant time; for ISRs. */
enum jp_status jp_imu_request(struct jp_imu *imu);

/** Of DMA2_Stream0's interrupt, which may have been pended by software. Constant time. */
void jp_imu_on_transfer(struct jp_imu *imu);

/** The sample since the last read: pitch_rate, yaw_rate, accel_x and accel_z of *sensors. JP_ERR_HARDWARE: none has
 * come, or nobody drove the line; *sensors is not written. Constant time; for the control ISR. */
enum jp_status jp_imu_read(struct jp_imu *imu, struct jp_sensors *sensors);

/** Bytes of the sensor to the body's axes: a step of a rate is 500/32768 °/s, rounded to 0.62 ulp of turn/s; one of an
 *  acceleration is 4/32768 g, exact. Pure. */
void jp_imu_decode(const uint8_t raw[JP_IMU_SAMPLE_BYTES], struct jp_sensors *sensors);

#endif
