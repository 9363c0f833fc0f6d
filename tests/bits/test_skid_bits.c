/* The same odometry, reference, voltages and energy of a skid-steered robot on every core: a hash over seconds of
 * motion on a slope, by commands and along a path. */
#include <joulepath/line_path.h>
#include <joulepath/skid_path_energy.h>
#include <joulepath/skid_robot.h>
#include <joulepath/tables.h>

#include "tests/support/bits_hash.h"
#include "unity.h"

enum { COMMANDS = 6, COMMAND_TICKS = 300, PATH_TICKS = 2000, TARGETS = 2, PIECES = 8 };

static const struct jp_point targets[TARGETS] = {{JP_Q16(0.3), JP_Q16(0.4)}, {JP_Q16(-0.2), JP_Q16(0.6)}};

static const struct jp_skid_robot_config *config;
static struct jp_skid_robot robot;
static struct jp_sensors sensors;
static struct jp_path_piece pieces[PIECES];
static struct jp_lattice_path path;
static jp_phase angles[JP_SKID_SIDES];
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

static void mix_motion(struct jp_motion motion)
{
    mix((uint32_t)motion.speed);
    mix((uint32_t)motion.turn_rate);
}

static void mix_telemetry(void)
{
    struct jp_skid_telemetry telemetry;

    TEST_ASSERT_TRUE(jp_skid_robot_telemetry(&robot, &telemetry));
    mix((uint32_t)telemetry.state | (uint32_t)telemetry.faults << 16);
    mix64((uint64_t)telemetry.x);
    mix64((uint64_t)telemetry.y);
    mix64(telemetry.heading);
    mix_motion(telemetry.motion);
    mix_motion(telemetry.reference);
    mix_motion(telemetry.command);
    mix(telemetry.command_ticks_left);
    mix((uint32_t)telemetry.commands | (uint32_t)telemetry.path_piece << 16);
    mix((uint32_t)telemetry.voltages.left);
    mix((uint32_t)telemetry.voltages.right);
    mix((uint32_t)telemetry.rise);
    mix((uint32_t)telemetry.steering_ratio);
    mix64((uint64_t)telemetry.energy);
    mix(telemetry.saturated_ticks);
    mix(telemetry.dropped_frames);
}

static void mix_odometry(void)
{
    struct jp_skid_estimate known;
    struct jp_path_slide slide;
    struct jp_point position;
    jp_angle heading;

    jp_skid_odometry_estimate(jp_skid_robot_odometry(&robot), &config->odometry, &known);
    mix((uint32_t)known.gyro_bias);
    mix((uint32_t)known.gyro_bias_deviation);
    mix((uint32_t)known.steering_ratio);
    mix((uint32_t)known.steering_ratio_deviation);
    mix((uint32_t)known.slip);
    mix((uint32_t)known.slip_deviation);
    mix((uint32_t)known.grade_ahead);
    mix((uint32_t)known.grade_left);
    mix((uint32_t)known.heading_deviation);
    mix64((uint64_t)known.xx);
    mix64((uint64_t)known.xy);
    mix64((uint64_t)known.yy);
    jp_skid_odometry_slide(jp_skid_robot_odometry(&robot), &config->odometry, &slide);
    mix((uint32_t)slide.by_turn);
    jp_skid_odometry_now(jp_skid_robot_odometry(&robot), &config->odometry, &position, &heading);
    mix((uint32_t)position.x);
    mix((uint32_t)position.y);
    mix(heading);
}

static uint32_t counts_of(int side)
{
    angles[side] +=
        jp_phase_step(robot.internal.control.sides[side].reference, jp_phase_per_rate(config->control.tick_rate));
    return (uint32_t)((int64_t)angles[side] / (int64_t)config->control.wheel_per_count + noise(1));
}

/* (u − K ω)/R. */
static jp_q16 current_of(int side, jp_q16 voltage)
{
    const jp_q16 back_emf = jp_multiply_shift(config->control.back_emf, robot.internal.control.sides[side].rate, 24);

    return jp_q16_divide(voltage - back_emf, config->control.resistance) + noise(JP_Q16(0.01));
}

/* Wheels that follow the reference, on ground that rises a little to one side. */
static void sense(void)
{
    const jp_turns_per_s ahead =
        robot.internal.control.sides[JP_SKID_RIGHT].reference - robot.internal.control.sides[JP_SKID_LEFT].reference;
    const jp_angle heading = jp_phase_angle(robot.internal.odometry.heading);

    sensors.encoder_left = counts_of(JP_SKID_LEFT);
    sensors.encoder_right = counts_of(JP_SKID_RIGHT);
    sensors.yaw_rate = jp_q24_multiply(jp_q24_multiply(ahead, config->wheels.turn_per_wheel), config->odometry.ratio) +
                       noise(JP_Q24(0.001));
    sensors.pitch_rate = noise(JP_Q24(0.001));
    sensors.accel_x = -jp_multiply_shift(JP_Q24(0.05), jp_cos(heading), 31) + noise(JP_Q24(0.02));
    sensors.accel_z = JP_Q24_ONE + noise(JP_Q24(0.02));
    sensors.current_left = current_of(JP_SKID_LEFT, robot.internal.voltages.left);
    sensors.current_right = current_of(JP_SKID_RIGHT, robot.internal.voltages.right);
    sensors.bus_voltage = (config->monitor.voltage_min + config->monitor.voltage_max) / 2 + noise(JP_Q16(0.2));
}

static void tick(uint32_t number)
{
    struct jp_actuation actuation;

    sense();
    jp_skid_robot_tick(&robot, number % 97U == 96U ? JP_ERR_BUSY : JP_OK, &sensors, &actuation);
    mix((uint32_t)actuation.duty_left);
    mix((uint32_t)actuation.duty_right);
    mix(actuation.enabled);
    mix_telemetry();
    mix_odometry();
}

static uint32_t run(uint32_t number, uint32_t ticks)
{
    for (uint32_t i = 0; i < ticks; i++) {
        tick(number + i);
    }
    return number + ticks;
}

/* A reset in motion. */
static void resume(void)
{
    struct jp_skid_snapshot snapshot;
    const char *field = "";

    jp_skid_robot_snapshot(&robot, &snapshot);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_init(&robot, config, &field));
    TEST_ASSERT_TRUE(jp_skid_robot_resume(&robot, &snapshot));
}

static uint32_t stand_up(uint32_t number)
{
    number = run(number, COMMAND_TICKS);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_enable(&robot));
    return run(number, COMMAND_TICKS);
}

static uint32_t drive_commands(uint32_t number)
{
    for (int i = 0; i < COMMANDS; i++) {
        const struct jp_skid_command command = {.motion = {noise(config->limits.speed / 2), noise(JP_Q24(0.3))},
                                                .duration = JP_Q16(0.5)};

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_drive(&robot, &command));
        number = run(number, COMMAND_TICKS);
        if (i == COMMANDS / 2) {
            resume();
            number = stand_up(number);
        }
    }
    return number;
}

static void follow_path(uint32_t number, const struct jp_path_limits *limits, const struct jp_skid_energy_model *model)
{
    const struct jp_line_route route = {.targets = targets, .count = TARGETS};
    const struct jp_motion_price price = jp_skid_motion_price(model, 0);
    struct jp_path_cost cost;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_line_path(&path, pieces, PIECES, &route));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_path_plan_speeds(&path, limits, &price, &cost));
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_follow(&robot, &path));
    (void)run(number, PATH_TICKS);
}

static void drive(const struct jp_skid_robot_config *driven, const struct jp_path_limits *limits,
                  const struct jp_skid_energy_model *model)
{
    const char *field = "";
    uint32_t number;

    config = driven;
    state = 1;
    angles[JP_SKID_LEFT] = 0;
    angles[JP_SKID_RIGHT] = 0;
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_skid_robot_init(&robot, config, &field));
    number = drive_commands(stand_up(0));
    jp_skid_robot_stop(&robot);
    number = run(number, 2 * COMMAND_TICKS);
    TEST_ASSERT_EQUAL_INT(JP_SKID_ROBOT_STANDING, jp_skid_robot_state_now(&robot));
    follow_path(number, limits, model);
    TEST_ASSERT_EQUAL_HEX16(0, robot.internal.faults);
}

static void test_zhang2018(void)
{
    drive(&jp_skid_robot_zhang2018, &jp_path_limits_zhang2018, &jp_skid_energy_zhang2018);
    TEST_ASSERT_EQUAL_HEX32(0xD8BCCBB9, hash);
}

static void test_burger(void)
{
    drive(&jp_skid_robot_burger, &jp_path_limits_burger, &jp_skid_energy_burger);
    TEST_ASSERT_EQUAL_HEX32(0xE8ED8A66, hash);
}
