/* The same estimate, reference, voltages, energy and findings of a balancer on every core: a hash over seconds of
 * motion. */
#include <joulepath/current_check.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>
#include <joulepath/trajectory_energy.h>
#include <joulepath/trajectory_rule.h>

#include "tests/support/bits_hash.h"
#include "unity.h"

enum { SEGMENTS = 6, SEGMENT_TICKS = 400, SAMPLE_TICKS = 10, LEGS = 2, TRAJECTORY_TICKS = 6000 };

static const struct jp_current_check_config sensors_checked = {
    .offset = JP_Q16(0.1), .gain = JP_Q16(0.05), .resistance = JP_Q16(0.2), .excitation = JP_Q16(0.05), .memory = 128};

static const struct jp_point targets[LEGS] = {{JP_Q16(0.4), JP_Q16(0.1)}, {JP_Q16(0.5), JP_Q16(0.6)}};

static struct jp_trajectory_leg legs[LEGS];
static struct jp_trajectory trajectory;
static const struct jp_robot_config *config;
static struct jp_robot robot;
static struct jp_current_check check;
static struct jp_sensors sensors;
static uint32_t state;

/* From −range to range. */
static int32_t noise(int32_t range)
{
    state = state * 1664525U + 1013904223U;
    return (int32_t)((int64_t)(state >> 1) * (2 * range + 1) >> 31) - range;
}

static void mix64(uint64_t value)
{
    mix((uint32_t)value);
    mix((uint32_t)(value >> 32));
}

static void mix_motion(const struct jp_telemetry *telemetry)
{
    mix((uint32_t)telemetry->state | (uint32_t)telemetry->faults << 16);
    mix64(telemetry->motion.wheel);
    mix64(telemetry->motion.yaw);
    mix((uint32_t)telemetry->motion.pitch);
    mix((uint32_t)telemetry->motion.wheel_rate);
    mix((uint32_t)telemetry->motion.yaw_rate);
    mix((uint32_t)telemetry->motion.pitch_rate);
    mix64(telemetry->reference_wheel);
    mix64(telemetry->reference_yaw);
    mix((uint32_t)telemetry->reference_wheel_rate);
    mix((uint32_t)telemetry->reference_yaw_rate);
    mix64(telemetry->target_wheel);
    mix64(telemetry->target_yaw);
}

static void mix_telemetry(void)
{
    struct jp_telemetry telemetry;

    TEST_ASSERT_TRUE(jp_robot_telemetry(&robot, &telemetry));
    mix_motion(&telemetry);
    mix((uint32_t)telemetry.position.x);
    mix((uint32_t)telemetry.position.y);
    mix((uint32_t)telemetry.voltages.left);
    mix((uint32_t)telemetry.voltages.right);
    mix64((uint64_t)telemetry.energy_model);
    mix64((uint64_t)telemetry.energy_battery);
    mix64((uint64_t)telemetry.segment_energy_model);
    mix64((uint64_t)telemetry.segment_energy_battery);
    mix64((uint64_t)telemetry.gyro_bias);
    mix(telemetry.segment_ticks_left);
    mix(telemetry.saturated_ticks);
    mix(telemetry.dropped_frames);
}

static void mix_estimate(const struct jp_current_motor *motor)
{
    mix((uint32_t)motor->estimate.offset);
    mix((uint32_t)motor->estimate.offset_deviation);
    mix((uint32_t)motor->estimate.gain);
    mix((uint32_t)motor->estimate.gain_deviation);
    mix((uint32_t)motor->parted);
    mix64((uint64_t)motor->noise);
}

/* (u − K ω)/R, with an offset, a gain and noise. */
static jp_q16 current_of(jp_q16 voltage, jp_turns_per_s rate)
{
    const jp_q16 back_emf = jp_multiply_shift(config->monitor.back_emf, rate, 24);
    const jp_q16 current = jp_q16_divide(voltage - back_emf, config->monitor.motor_resistance);

    return current + current / 16 + JP_Q16(0.05) + noise(JP_Q16(0.02));
}

/* Wheels that follow the reference, a body that sways a little, and sensors that see both with noise. */
static void sense(uint32_t tick)
{
    const struct jp_reference *reference = jp_robot_reference(&robot);
    const struct jp_motion_state *motion = &jp_robot_last_tick(&robot)->motion;
    const struct jp_voltages *voltages = &jp_robot_last_tick(&robot)->voltages;
    const int64_t sum = (int64_t)reference->wheel.angle / (int64_t)config->estimator.wheel_per_count;
    const int64_t difference = (int64_t)reference->yaw.angle / (int64_t)config->estimator.yaw_per_count;
    const jp_q31 sway = jp_sin((jp_angle)(tick * 12345678U));
    const jp_turns_per_s turning = jp_q16_multiply(motion->yaw_rate, config->monitor.half_track);

    sensors.encoder_left = (uint32_t)((sum - difference) / 2 + noise(2));
    sensors.encoder_right = (uint32_t)((sum + difference) / 2 + noise(2));
    sensors.pitch_rate = jp_multiply_shift(JP_Q24(0.01), sway, 31) + noise(JP_Q24(0.001));
    sensors.yaw_rate = reference->yaw.rate + noise(JP_Q24(0.001));
    sensors.accel_x = noise(JP_Q24(0.05));
    sensors.accel_z = JP_Q24_ONE + noise(JP_Q24(0.05));
    sensors.current_left = current_of(voltages->left, motion->wheel_rate - turning);
    sensors.current_right = current_of(voltages->right, motion->wheel_rate + turning);
    sensors.bus_voltage = (config->monitor.voltage_min + config->monitor.voltage_max) / 2 + noise(JP_Q16(0.5));
}

static void tick(uint32_t number)
{
    struct jp_actuation actuation;
    struct jp_motor_sample sample;

    sense(number);
    jp_robot_tick(&robot, number % 97U == 96U ? JP_ERR_BUSY : JP_OK, &sensors, &actuation);
    mix((uint32_t)actuation.duty_left);
    mix((uint32_t)actuation.duty_right);
    mix(actuation.enabled);
    mix_telemetry();
    if (number % SAMPLE_TICKS == 0U && jp_robot_motors(&robot, &sample)) {
        mix(jp_current_check_update(&check, &sample));
        mix_estimate(&check.left);
        mix_estimate(&check.right);
    }
}

static void mix_end(void)
{
    struct jp_telemetry telemetry;
    struct jp_point position;
    jp_angle heading;

    TEST_ASSERT_TRUE(jp_robot_telemetry(&robot, &telemetry));
    jp_robot_predict_end(&robot, &telemetry, &position, &heading);
    mix((uint32_t)position.x);
    mix((uint32_t)position.y);
    mix(heading);
}

/* A reset in motion. */
static void resume(void)
{
    struct jp_snapshot snapshot;
    const char *field = "";

    jp_robot_snapshot(&robot, &snapshot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, config, &field));
    jp_robot_resume(&robot, &snapshot);
}

/* From its stand: the route is its own, from where it stands. */
static void follow(const struct jp_energy_model *model, uint32_t number)
{
    const struct jp_trajectory_task task = {.config = &config->trajectory,
                                            .cruise = jp_cruise_speed(model),
                                            .targets = targets,
                                            .count = LEGS,
                                            .to_stand = true};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_trajectory_by_rule(&task, legs, &trajectory));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive_trajectory(&robot, &trajectory));
    for (int i = 0; i < TRAJECTORY_TICKS; i++, number++) {
        tick(number);
    }
}

static void drive(const struct jp_robot_config *driven, const struct jp_energy_model *model)
{
    const char *field = "";
    uint32_t number = 0;

    config = driven;
    state = 1;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_init(&robot, config, &field));
    jp_robot_know_gyro_bias(&robot, (int64_t)1 << 40);
    jp_current_check_start(&check, &sensors_checked, &config->monitor);
    for (; number < SEGMENT_TICKS; number++) {
        tick(number);
    }
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_enable(&robot));
    for (int i = 0; i < SEGMENTS; i++) {
        const struct jp_segment_command segment = {
            .motion = {noise(config->limits.speed / 4), noise(config->limits.turn_rate / 4)}, .duration = JP_Q16(0.35)};

        for (int j = 0; j < SEGMENT_TICKS; j++, number++) {
            tick(number);
            if (j == SEGMENT_TICKS / 8) {
                TEST_ASSERT_EQUAL_INT(JP_OK, jp_robot_drive(&robot, &segment));
            }
            if (j == SEGMENT_TICKS / 2) {
                mix_end();
            }
        }
        if (i == SEGMENTS - 2) {
            resume();
        }
    }
    follow(model, number);
    TEST_ASSERT_EQUAL_HEX16(0, jp_robot_last_tick(&robot)->faults);
    TEST_ASSERT_TRUE(jp_robot_state_now(&robot) == JP_ROBOT_BALANCING ||
                     jp_robot_state_now(&robot) == JP_ROBOT_DRIVING);
}

/* ---- Sensors of current that go wrong ---- */

enum { PHASES = 8, PHASE_SAMPLES = 1500 };

/* Of both sensors: offset and gain, and how much the second power of the current bends them. */
static const struct {
    jp_q16 offset[2];
    jp_q16 gain[2];
    jp_q16 bend;
} sensors_are[PHASES] = {
    {{0, 0}, {JP_Q16(1), JP_Q16(1)}, 0},
    {{JP_Q16(0.3), 0}, {JP_Q16(1), JP_Q16(1)}, 0},
    {{0, 0}, {JP_Q16(1), JP_Q16(1)}, 0},
    {{0, 0}, {JP_Q16(1.3), JP_Q16(1)}, 0},
    {{0, 0}, {JP_Q16(0.75), JP_Q16(0.75)}, 0},
    {{JP_Q16(-0.2), JP_Q16(0.12)}, {JP_Q16(0.9), JP_Q16(1.07)}, 0},
    {{0, JP_Q16(0.11)}, {JP_Q16(1), JP_Q16(1)}, JP_Q16(0.2)},
    {{0, 0}, {JP_Q16(1), JP_Q16(1.06)}, 0},
};

static jp_q16 sensed(int phase, int side, jp_q16 current)
{
    const jp_q16 bent = jp_q16_multiply(jp_q16_multiply(current, current), sensors_are[phase].bend);

    return jp_q16_multiply(current, sensors_are[phase].gain[side]) + sensors_are[phase].offset[side] + bent +
           noise(JP_Q16(0.03));
}

static void mix_check(void)
{
    mix((uint32_t)check.blame + 16U * check.blame_samples);
    mix_estimate(&check.left);
    mix_estimate(&check.right);
    mix((uint32_t)check.left.bent + 2U * (uint32_t)check.right.bent + 4U * (uint32_t)check.left.changed);
    mix((uint32_t)check.left.offset.samples + 65536U * check.left.gain.samples);
}

static void test_sensors_of_current(void)
{
    config = &jp_robot_courier24;
    state = 1;
    jp_current_check_start(&check, &sensors_checked, &config->monitor);
    for (int i = 0; i < PHASES * PHASE_SAMPLES; i++) {
        const jp_q16 volts = i / 300 % 3 == 2 ? 0 : noise(JP_Q16(6)); /* pauses, too */
        const jp_q16 current = jp_q16_divide(volts, config->monitor.motor_resistance);
        const int phase = i / PHASE_SAMPLES;
        const struct jp_motor_sample sample = {.voltages = {volts, volts, false},
                                               .current_left = sensed(phase, 0, current),
                                               .current_right = sensed(phase, 1, current)};

        mix(jp_current_check_update(&check, &sample));
        mix_check();
    }
    TEST_ASSERT_EQUAL_HEX32(0x5A37402F, hash);
}

static void test_gao2018(void)
{
    drive(&jp_robot_gao2018, &jp_energy_model_gao2018);
    TEST_ASSERT_EQUAL_HEX32(0xB3A766B8, hash);
}

static void test_courier24(void)
{
    drive(&jp_robot_courier24, &jp_energy_model_courier24);
    TEST_ASSERT_EQUAL_HEX32(0x651713BA, hash);
}
