/** What the patrol robot's elastic band is set to. Apart from patrol_config.h because benches on microcontrollers use
 * it, too. */
#ifndef JOULEPATH_SIM_PATROL_BAND_H
#define JOULEPATH_SIM_PATROL_BAND_H

#include <joulepath/teb.h>

/** Of a robot with this footprint, m, wheelbase, m, and acceleration of its drives, m/s². */
static inline struct jp_teb_config patrol_band_config(const struct jp_footprint *footprint, float wheelbase,
                                                      float acceleration)
{
    return (struct jp_teb_config){
        .speed_max = 1.0f,
        .reverse_max = 0.3f,
        .turn_rate_max = 1.2f,
        .acceleration = 0.8f * acceleration,
        .turn_acceleration = 2.0f,
        .radius_min = wheelbase,
        .footprint = *footprint,
        .clearance = 0.1f,
        .interval = 0.25f,
        .hysteresis = 0.1f,
        .rounds = 3,
        .steps = 4,
        .weights =
            {
                .nonholonomic = 1000.0f,
                .speed = 20.0f,
                .turn_rate = 20.0f,
                .turn_radius = 50.0f,
                .acceleration = 5.0f,
                .turn_acceleration = 2.0f,
                .obstacle = 500.0f,
                .path = 2.0f,
                .time = 1.0f,
                .no_reversing = 1000.0f,
                .wheel_odometry = 1000.0f,
                .laser_odometry = 10000.0f,
            },
    };
}

#endif
