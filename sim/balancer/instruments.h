/**
 * From the plant's state to what the HAL reads: encoders, gyro, accelerometer, current and bus voltage sensing, with
 * their noise, bias, steps and full scales from the robot file.
 *
 * Axes of the body: x forward, z up (sensors.h). With pitch ψ forward positive the body's axes are
 * x = (cosψ, −sinψ), z = (sinψ, cosψ) in (forward, up). An accelerometer measures the specific force a + g·up, so
 * at rest x reads −sinψ and z reads cosψ, in g. At height s above the wheel axis, which accelerates with R θ̈:
 *
 *   x = [R θ̈ cosψ + s (ψ̈ − φ̇² sinψ cosψ)]/g − sinψ
 *   z = [R θ̈ sinψ − s (ψ̇² + φ̇² sin²ψ)]/g + cosψ
 *
 * The gyro turns with the body: ψ̇ about y, φ̇ cosψ about z.
 */
#ifndef JOULEPATH_SIM_BALANCER_INSTRUMENTS_H
#define JOULEPATH_SIM_BALANCER_INSTRUMENTS_H

#include <joulepath/sensors.h>

#include "sim/balancer/plant.h"
#include "sim/balancer/robot_file.h"
#include "sim/base/random.h"

struct instruments {
    const struct robot_file *robot;
    uint32_t encoder_start_left;  /**< counts at the start */
    uint32_t encoder_start_right; /**< counts at the start */
};

/** Measures once; each noisy channel draws from `random`. `input` is what acted during the last step. */
void instruments_read(const struct instruments *instruments, const struct plant *plant, const struct plant_input *input,
                      double bus_voltage, struct random *random, struct jp_sensors *sensors);

#endif
