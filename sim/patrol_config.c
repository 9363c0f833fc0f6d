#include "patrol_config.h"

#include <math.h>

#define CLEARANCE 0.10 /* wanted, m */

static struct jp_teb_config band_config(const struct four_wheel_file *robot)
{
    return (struct jp_teb_config){
        .speed_max = 1.0f,
        .reverse_max = 0.3f,
        .turn_rate_max = 1.2f,
        .acceleration = (float)(0.6 * robot->drive.acceleration_m_s2),
        .turn_acceleration = 2.0f,
        .radius_min = (float)robot->body.wheelbase_m,
        .footprint = {(float)(robot->body.length_m / 2), (float)(robot->body.length_m / 2),
                      (float)(robot->body.width_m / 2)},
        .clearance = (float)CLEARANCE,
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
                .time = 0.2f,
                .slowness = 2.0f,
                .no_reversing = 1000.0f,
                .wheel_odometry = 1000.0f,
                .laser_odometry = 10000.0f,
            },
    };
}

struct jp_patrol_config patrol_config(const struct four_wheel_file *robot, enum patrol_method method)
{
    struct jp_patrol_config config = {
        .wheels = four_wheel_config(robot),
        .teb = band_config(robot),
        .scan = {.range_max = 5.0f, .gap = 0.35f, .tolerance = 0.04f, .beams_min = 3},
        .turns_in_place = true,
        .turn_first = (float)(30 * M_PI / 180),
        .turn_rate = 1.0f,
        .turn_acceleration = 1.5f,
        .turn_clearance = 0.0f,
        .step_speed = 0.2f,
        .horizon = 3.5f,
        .position_tolerance = 0.08f,
        .heading_tolerance = (float)(5 * M_PI / 180),
        .period = 1.0f / PATROL_CYCLE_HZ,
        .latency = 0.1f,
        .jump = 0.3f,
        .waits_max = 10 * PATROL_CYCLE_HZ,
        .dropouts_max = 3,
    };

    if (method == PATROL_PLAIN) {
        config.turns_in_place = false;
        config.teb.weights.no_reversing = 0.0f;
        config.teb.weights.wheel_odometry = 0.0f;
        config.teb.weights.laser_odometry = 0.0f;
    }
    return config;
}

struct jp_pure_pursuit_config patrol_pursuit_config(const struct four_wheel_file *robot)
{
    return (struct jp_pure_pursuit_config){
        .speed = JP_Q24(1.0),
        .lookahead_time = JP_Q24(0.5),
        .lookahead_min = JP_Q24(0.3),
        .lookahead_max = JP_Q24(2.0),
        .curvature_max = (jp_q24)lround(1 / robot->body.wheelbase_m * JP_Q24_ONE),
        .lateral_acceleration = JP_Q24(0.8),
        .acceleration = JP_Q24(0.8),
        .tolerance = JP_Q24(0.05),
    };
}
