/**
 * From the state of the plant to what the HAL reads: encoders, gyro, accelerometer, current and bus voltage sensing,
 * with their noise, bias, scale error, steps and full scales from the robot file.
 *
 * Axes of the body: x forward, y left, z up. The inertial sensor is at the centre of mass; what its shakes add to z is
 * left out.
 */
#ifndef JOULEPATH_SIM_SKID_STEER_SKID_INSTRUMENTS_H
#define JOULEPATH_SIM_SKID_STEER_SKID_INSTRUMENTS_H

#include <joulepath/fixed.h>
#include <stdint.h>

#include "sim/base/random.h"
#include "sim/skid_steer/skid_plant.h"

/** Measurements of one tick; formats as in joulepath/sensors.h. */
struct skid_samples {
    uint32_t encoder_left;    /**< counts, wrapping; rises when the left wheels drive forward */
    uint32_t encoder_right;   /**< counts, wrapping */
    jp_turns_per_s roll_rate; /**< gyro about x, turn/s */
    jp_turns_per_s pitch_rate;
    jp_turns_per_s yaw_rate;
    jp_q24 accel_x; /**< specific force, g */
    jp_q24 accel_y;
    jp_q24 accel_z;      /**< +1 at rest on level ground */
    jp_q16 current_left; /**< A; positive drives forward */
    jp_q16 current_right;
    jp_q16 bus_voltage; /**< V */
};

/** Measures once; each noisy channel draws from `random`. `start`: counts of the encoders at angle 0. */
void skid_instruments_read(const struct skid_plant *plant, const uint32_t start[SKID_SIDES], struct random *random,
                           struct skid_samples *samples);

#endif
