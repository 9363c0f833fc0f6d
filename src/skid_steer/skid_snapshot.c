/* What a reset in motion leaves of a robot. */
#include <joulepath/skid_robot.h>

#include "src/base/config_check.h"
#include "src/base/integer.h"
#include "src/skid_steer/skid_tilt.h"

#define ONE ((int32_t)1 << 30) /* Q30, as the odometry's filters have it */

void jp_skid_robot_snapshot(const struct jp_skid_robot *robot, struct jp_skid_snapshot *snapshot)
{
    const struct jp_skid_robot_internal *internal = &robot->internal;
    const struct jp_skid_odometry *odometry = &internal->odometry;
    const bool ran = internal->state == JP_SKID_ROBOT_STANDING || internal->state == JP_SKID_ROBOT_DRIVING;

    *snapshot = (struct jp_skid_snapshot){
        .x = odometry->x,
        .y = odometry->y,
        .heading = odometry->heading,
        .tick_rate = internal->config->odometry.tick_rate,
        .way_per_count = internal->config->odometry.way_per_count,
        .encoder_left = internal->monitor.good.encoder_left,
        .encoder_right = internal->monitor.good.encoder_right,
        .gyro_bias = odometry->bias_rate,
        .steering_ratio = odometry->steering_ratio,
        .bias = odometry->internal.gyro.bias,
        .pitch_bias = odometry->internal.tilt.pitch_bias,
        .ratio = odometry->internal.gyro.ratio,
        .scale = odometry->internal.gyro.scale,
        .bias_bias = odometry->internal.gyro.bias_bias,
        .bias_ratio = odometry->internal.gyro.bias_ratio,
        .ratio_ratio = odometry->internal.gyro.ratio_ratio,
        .ran = ran ? 1U : 0U,
    };
}

/** Nobody is told which one is wrong. */
#define FIELD(member, low, high) JP_CONFIG_FIELD_NAMED(NULL, struct jp_skid_snapshot, member, low, high)

static bool is_sound(const struct jp_skid_snapshot *snapshot)
{
    static const struct jp_config_field fields[] = {
        FIELD(gyro_bias, -JP_Q24_ONE, JP_Q24_ONE),
        FIELD(steering_ratio, JP_Q24(0.01), JP_Q24(8)),
        FIELD(bias, -INT32_MAX, INT32_MAX),
        FIELD(pitch_bias, -JP_SKID_PITCH_BIAS_MAX, JP_SKID_PITCH_BIAS_MAX),
        FIELD(ratio, ONE / 16, INT32_MAX),
        FIELD(scale, ONE / 2, ONE / 2 * 3),
        FIELD(bias_bias, 1, ONE),
        FIELD(bias_ratio, -ONE, ONE),
        FIELD(ratio_ratio, 1, ONE),
    };
    const char *field;

    return jp_config_check(snapshot, fields, JP_CONFIG_COUNT(fields), &field) == JP_OK;
}

static bool is_near(int64_t place)
{
    return place >= -(INT64_MAX / 2) && place <= INT64_MAX / 2;
}

static bool can_go_on(const struct jp_skid_odometry_config *config, const struct jp_skid_snapshot *snapshot)
{
    return snapshot->ran <= 1U && snapshot->tick_rate == config->tick_rate &&
           snapshot->way_per_count == config->way_per_count && is_near(snapshot->x) && is_near(snapshot->y) &&
           is_sound(snapshot);
}

bool jp_skid_robot_resume(struct jp_skid_robot *robot, const struct jp_skid_snapshot *snapshot)
{
    struct jp_skid_odometry *odometry = &robot->internal.odometry;

    if (!can_go_on(&robot->internal.config->odometry, snapshot)) {
        return false;
    }
    odometry->x = snapshot->x;
    odometry->y = snapshot->y;
    odometry->heading = snapshot->heading;
    odometry->steering_ratio = snapshot->steering_ratio;
    odometry->bias_rate = snapshot->gyro_bias;
    odometry->internal.gyro.bias = snapshot->bias;
    odometry->internal.tilt.pitch_bias = snapshot->pitch_bias;
    odometry->internal.gyro.ratio = snapshot->ratio;
    odometry->internal.gyro.scale = snapshot->scale;
    odometry->internal.gyro.bias_bias = snapshot->bias_bias;
    odometry->internal.gyro.bias_ratio = snapshot->bias_ratio;
    odometry->internal.gyro.ratio_ratio = snapshot->ratio_ratio;
    return true;
}
