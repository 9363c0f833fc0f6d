/** What the tests of the elastic band and of the patrol share: a robot's settings of the band, and points of its path.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_BAND_RIG_H
#define JOULEPATH_TESTS_SUPPORT_BAND_RIG_H

#include <joulepath/teb.h>

/** A robot of 0.8 m × 0.6 m that drives 1 m/s. */
static inline struct jp_teb_config rig_band(void)
{
    return (struct jp_teb_config){
        .speed_max = 1.0f,
        .reverse_max = 0.3f,
        .turn_rate_max = 1.2f,
        .acceleration = 0.8f,
        .turn_acceleration = 2.0f,
        .radius_min = 0.5f,
        .footprint = {0.4f, 0.4f, 0.3f},
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
                .second = 0.5f,
                .metre = 0.12f,
                .drag = 0.07f,
                .no_reversing = 1000.0f,
                .wheel_odometry = 1000.0f,
                .laser_odometry = 10000.0f,
            },
    };
}

static inline struct jp_point rig_path_point(float x, float y)
{
    return (struct jp_point){(jp_q16)(x * (float)JP_Q16_ONE), (jp_q16)(y * (float)JP_Q16_ONE)};
}

#endif
