/**
 * The parts of the tick of a robot that its sides steer one by one, with any configuration that their checks accept,
 * any counts, set-points and motion, for a thousand ticks: voltages are within the limit, ratios and deviations within
 * their ranges, and the monitor finds only what it looks for.
 */
#include <joulepath/monitor.h>
#include <joulepath/skid_robot.h>
#include <joulepath/tables.h>

#include "tests/fuzz/fuzz_config.h"
#include "tests/fuzz/fuzz_sensors.h"

#define TICKS 1000U

static struct jp_skid_robot_config config;
static struct jp_skid_control control;
static struct jp_skid_monitor monitor;
static struct jp_skid_odometry odometry;

static bool start(struct fuzz_input *input, const struct jp_sensors *sensors)
{
    const char *field = NULL;

    FUZZ_CHANGE(input, config.control);
    FUZZ_CHANGE(input, config.wheels);
    FUZZ_CHANGE(input, config.odometry);
    if (!fuzz_accepted(jp_skid_control_check(&config.control, &field), field) ||
        !fuzz_accepted(jp_skid_monitor_check(&config.wheels, &field), field) ||
        !fuzz_accepted(jp_skid_odometry_check(&config.odometry, &field), field)) {
        return false;
    }
    jp_skid_control_start(&control, &config.control, fuzz_hostile(input));
    jp_skid_monitor_start(&monitor, fuzz_hostile(input));
    jp_skid_odometry_start(&odometry, &config.odometry, sensors);
    return true;
}

/** Within the header's ranges; accelerations are any. */
static void change_set_point(struct fuzz_input *input, struct jp_skid_set_point *set_point)
{
    *set_point = (struct jp_skid_set_point){
        .speed = fuzz_range(input, -JP_Q24(8), JP_Q24(8)),
        .turn_rate = fuzz_range(input, -JP_Q24(8), JP_Q24(8)),
        .acceleration = fuzz_hostile(input),
        .turn_acceleration = fuzz_hostile(input),
        .rise = fuzz_range(input, -JP_Q24_ONE, JP_Q24_ONE),
    };
}

static void drive(struct fuzz_input *input, const struct jp_sensors *sensors, const struct jp_skid_set_point *set_point)
{
    const jp_q16 limit = fuzz_more(input) ? fuzz_range(input, 0, JP_Q16(1000)) : JP_Q16(24);
    struct jp_voltages voltages;

    jp_skid_control_measure(&control, &config.control, sensors->encoder_left, sensors->encoder_right);
    jp_skid_control_steer(&control, &config.control, odometry.steering_ratio);
    if (fuzz_below(input, 64) == 63U) {
        jp_skid_control_forget(&control);
        jp_skid_control_count_from(&control, sensors->encoder_left, sensors->encoder_right);
    }
    if (fuzz_below(input, 16) == 15U) {
        jp_skid_control_blindly(&control, &config.control, set_point, limit, &voltages);
    } else {
        jp_skid_control_update(&control, &config.control, set_point, limit, &voltages);
    }
    fuzz_require(fuzz_within(voltages.left, limit) && fuzz_within(voltages.right, limit), "voltages beyond the limit");
    fuzz_require(control.unsteering > 0, "an inverse of the steering ratio that is not above 0");
}

static void watch(const struct jp_sensors *sensors, const struct jp_skid_set_point *set_point)
{
    const struct jp_skid_motion motion = {
        .control = &control,
        .current = {sensors->current_left, sensors->current_right},
        .turn_rate = sensors->yaw_rate,
        .steering = odometry.steering_ratio,
        .straight = set_point->turn_rate == 0,
    };
    const uint16_t slope = jp_skid_monitor_ground(&monitor, &config.wheels, sensors, set_point->acceleration);
    const uint16_t wheels = jp_skid_monitor_wheels(&monitor, &config.wheels, &motion);

    fuzz_require(slope == 0U || slope == JP_FAULT_SLOPE, "another fault than the slope's");
    fuzz_require((wheels & ~(unsigned)(JP_FAULT_STALLED_LEFT | JP_FAULT_STALLED_RIGHT | JP_FAULT_WHEEL_IN_AIR |
                                       JP_FAULT_WHEELS_SPIN)) == 0U,
                 "another fault than the wheels'");
    (void)jp_skid_monitor_is_steep(&monitor, &config.wheels);
}

static void reckon(const struct jp_sensors *sensors)
{
    struct jp_skid_estimate estimate;
    struct jp_gyro_scale scale;
    struct jp_path_slide slide;
    struct jp_point position;
    jp_angle heading;

    jp_skid_odometry_update(&odometry, &config.odometry, sensors);
    jp_skid_odometry_now(&odometry, &config.odometry, &position, &heading);
    jp_skid_odometry_slide(&odometry, &config.odometry, &slide);
    jp_skid_odometry_estimate(&odometry, &config.odometry, &estimate);
    jp_skid_odometry_scale(&odometry, &config.odometry, &scale);
    fuzz_require(fuzz_within(scale.error, JP_GYRO_SCALE_MAX) && scale.deviation >= 0 &&
                     scale.deviation <= JP_GYRO_SCALE_DEVIATION_MAX,
                 "a scale that cannot be stored");
    fuzz_require(odometry.steering_ratio > 0, "a steering ratio that is not above 0");
    fuzz_require(estimate.gyro_bias_deviation >= 0 && estimate.steering_ratio_deviation >= 0 &&
                     estimate.slip_deviation >= 0 && estimate.heading_deviation >= 0,
                 "a negative deviation");
    fuzz_require(estimate.xx >= 0 && estimate.yy >= 0, "a negative variance");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_skid_set_point set_point = {0};
    struct fuzz_sensors sensors;

    config = fuzz_bool(&input) ? jp_skid_robot_zhang2018 : jp_skid_robot_burger;
    fuzz_sensors_begin(&sensors);
    if (!start(&input, &sensors.frame)) {
        return 0;
    }
    if (fuzz_bool(&input)) {
        const struct jp_gyro_scale scale = {fuzz_range(&input, -JP_GYRO_SCALE_MAX, JP_GYRO_SCALE_MAX),
                                            fuzz_range(&input, 0, JP_GYRO_SCALE_DEVIATION_MAX)};

        jp_skid_odometry_know_scale(&odometry, &config.odometry, &scale);
    }
    for (unsigned tick = 0; tick < TICKS; tick++) {
        if (tick % 4U == 0U && fuzz_bool(&input)) {
            fuzz_sensors_change(&sensors, &input);
            change_set_point(&input, &set_point);
        }
        fuzz_sensors_move(&sensors);
        drive(&input, &sensors.frame, &set_point);
        watch(&sensors.frame, &set_point);
        reckon(&sensors.frame);
    }
    return 0;
}
