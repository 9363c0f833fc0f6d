/** One tick's measurements and commands: what the HAL delivers and takes. */
#ifndef JOULEPATH_SENSORS_H
#define JOULEPATH_SENSORS_H

#include <stdbool.h>

#include <joulepath/fixed.h>

/**
 * Axes of the body: x forward, y left, z up; right-handed, so a pitch forward and a yaw to the left are positive.
 */
struct jp_sensors {
    uint32_t encoder_left;     /**< counts, wrapping; rises when the left wheel drives forward */
    uint32_t encoder_right;    /**< counts, wrapping */
    jp_turns_per_s pitch_rate; /**< gyro about y, turn/s */
    jp_turns_per_s yaw_rate;   /**< gyro about z, turn/s */
    jp_q24 accel_x;            /**< specific force along x, g */
    jp_q24 accel_z;            /**< specific force along z, g; +1 at rest and upright */
    jp_q16 current_left;       /**< motor current, A; positive drives forward */
    jp_q16 current_right;      /**< motor current, A */
    jp_q16 bus_voltage;        /**< V */
};

/** What the controller asks of the motors. */
struct jp_voltages {
    jp_q16 left;    /**< V */
    jp_q16 right;   /**< V */
    bool saturated; /**< a limit changed the command */
};

/** Duty of each bridge: −1…1 of the bus voltage, positive drives forward. −1 is INT32_MIN, which cannot be negated in
 *  32 bits: take 64 for what is made of it. */
struct jp_actuation {
    jp_q31 duty_left;
    jp_q31 duty_right;
    uint8_t enabled; /**< 0: both bridges off (coasting), the duties are 0 */
};

#endif
