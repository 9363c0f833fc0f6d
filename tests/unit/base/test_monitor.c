/* The monitor: configuration, each limit on both sides, replacement, confirmation, freezing, motor residuals. */
#include <joulepath/monitor.h>
#include <joulepath/robot.h>
#include <joulepath/tables.h>

#include "tests/support/config_check.h"
#include "unity.h"

static struct jp_monitor_config config;
static struct jp_monitor monitor;
static struct jp_sensors good;
static struct jp_sensors sensors;

void setUp(void)
{
    config = jp_robot_courier24.monitor;
    config.freeze_ticks = 0;
    good = (struct jp_sensors){.encoder_left = 0xFFFFFFF0U,
                               .encoder_right = 5,
                               .pitch_rate = 11,
                               .yaw_rate = 12,
                               .accel_x = 13,
                               .accel_z = JP_Q24_ONE,
                               .current_left = 14,
                               .current_right = 15,
                               .bus_voltage = JP_Q16(24)};
    jp_monitor_start(&monitor, &config);
}

void tearDown(void)
{
}

static uint16_t check(enum jp_status read)
{
    return jp_monitor_sensors(&monitor, &config, read, &sensors);
}

/** A plausible frame that differs from the last one in all channels of the IMU. */
static void see_good(void)
{
    good.pitch_rate ^= 1;
    good.yaw_rate ^= 1;
    good.accel_x ^= 1;
    good.accel_z ^= 1;
    sensors = good;
    TEST_ASSERT_EQUAL_UINT16(0, check(JP_OK));
    TEST_ASSERT_EQUAL_MEMORY(&good, &monitor.good, sizeof good);
    TEST_ASSERT_EQUAL_HEX16(0, monitor.suspected);
}

DEFINE_EXPECT_CONFIG(monitor)

static void test_checks_every_field_at_its_limits(void)
{
    config = jp_robot_courier24.monitor;
    expect_config(NULL);
    RANGE("monitor.", tilt_limit, JP_Q24(0.01), JP_Q24(0.25));
    AT_LEAST("monitor.", gyro_limit, 1);
    AT_LEAST("monitor.", gyro_jump, 1);
    FIELD(accel_limit, JP_Q24_ONE, "monitor.accel_limit");
    FIELD(accel_limit, JP_Q24_ONE + 1, NULL);
    AT_LEAST("monitor.", encoder_jump, 1);
    FIELD(encoder_jump, INT32_MAX, NULL);
    FIELD(encoder_jump, (uint32_t)INT32_MAX + 1U, "monitor.encoder_jump");
    AT_LEAST("monitor.", current_limit, 1);
    AT_LEAST("monitor.", voltage_min, 1);
    FIELD(voltage_max, config.voltage_min, "monitor.voltage_max");
    FIELD(voltage_max, config.voltage_min + 1, NULL);
    AT_MOST("monitor.", voltage_max, JP_Q16(1000));
    AT_LEAST("monitor.", motor_resistance, JP_Q16(0.01));
    config.current_limit = JP_Q16(3);
    FIELD(motor_resistance, JP_Q16(10922), NULL); /* 3 A of it are a voltage in range */
    config.current_limit = JP_Q16(3);
    FIELD(motor_resistance, JP_Q16(10923), "monitor.current_limit");
    AT_LEAST("monitor.", back_emf, 1);
    FIELD(back_emf, JP_Q16(256) - 1, NULL);
    FIELD(back_emf, JP_Q16(256), "monitor.back_emf");
    RANGE("monitor.", half_track, 1, JP_Q16(64));
    AT_LEAST("monitor.", wheel_rate_limit, 1);
    AT_LEAST("monitor.", current_residual, 1);
    AT_LEAST("monitor.", confirm_ticks, 1);
    FIELD(freeze_ticks, 0, NULL);
    FIELD(freeze_ticks, UINT16_MAX, NULL);
    AT_LEAST("monitor.", residual_ticks, 1);
}

/** The frame in `sensors` is not taken and, with the third, its fault confirmed; a good one clears it. */
static void expect_fault(uint16_t fault)
{
    const struct jp_sensors bad = sensors;

    for (int tick = 1; tick <= 5; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : fault, check(JP_OK));
        TEST_ASSERT_EQUAL_HEX16(fault, monitor.suspected);
        TEST_ASSERT_EQUAL_MEMORY(&good, &monitor.good, sizeof good);
    }
    see_good();
    sensors = bad;
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK)); /* the count began anew */
    see_good();
}

static void expect_plausible(void)
{
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    TEST_ASSERT_EQUAL_MEMORY(&sensors, &monitor.good, sizeof sensors);
    see_good();
}

#define BEYOND(member, value, fault)                                                                                   \
    do {                                                                                                               \
        sensors = good;                                                                                                \
        sensors.member = (value);                                                                                      \
        expect_fault(fault);                                                                                           \
    } while (0)

#define WITHIN(member, value)                                                                                          \
    do {                                                                                                               \
        sensors = good;                                                                                                \
        sensors.member = (value);                                                                                      \
        expect_plausible();                                                                                            \
    } while (0)

static void test_ranges(void)
{
    config.gyro_jump = INT32_MAX;
    see_good();
    WITHIN(pitch_rate, config.gyro_limit);
    WITHIN(pitch_rate, -config.gyro_limit);
    WITHIN(yaw_rate, config.gyro_limit);
    WITHIN(current_left, config.current_limit);
    WITHIN(current_right, -config.current_limit);
    WITHIN(bus_voltage, config.voltage_min);
    WITHIN(bus_voltage, config.voltage_max);
    BEYOND(pitch_rate, config.gyro_limit + 1, JP_FAULT_IMU_RANGE);
    BEYOND(pitch_rate, -config.gyro_limit - 1, JP_FAULT_IMU_RANGE);
    BEYOND(yaw_rate, config.gyro_limit + 1, JP_FAULT_IMU_RANGE);
    BEYOND(yaw_rate, INT32_MIN, JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP);
    BEYOND(current_left, config.current_limit + 1, JP_FAULT_CURRENT_RANGE);
    BEYOND(current_right, -config.current_limit - 1, JP_FAULT_CURRENT_RANGE);
    BEYOND(bus_voltage, config.voltage_min - 1, JP_FAULT_BUS_VOLTAGE);
    BEYOND(bus_voltage, config.voltage_max + 1, JP_FAULT_BUS_VOLTAGE);
    WITHIN(accel_x, config.accel_limit);
    WITHIN(accel_z, -config.accel_limit);
}

/** What is taken as good. */
static void expect_taken(void)
{
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    TEST_ASSERT_EQUAL_MEMORY(&sensors, &monitor.good, sizeof sensors);
}

/** Rates that jump beyond the limit in one tick, and back in the next. */
static void jump_to_and_fro(int tick)
{
    sensors.pitch_rate = good.pitch_rate + (tick % 2 != 0 ? config.gyro_jump + 2 : 0);
    sensors.yaw_rate = good.yaw_rate - (tick % 2 != 0 ? config.gyro_jump + 2 : 0);
}

/** An impact begins; its first frame is suspected like any other that jumps. */
static void feel_impact(jp_q24 accel_x)
{
    sensors = good;
    sensors.accel_x = accel_x;
    jump_to_and_fro(1);
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    TEST_ASSERT_EQUAL_MEMORY(&good, &monitor.good, sizeof good);
}

static void test_an_impact_explains_jumps_for_a_while(void)
{
    see_good();
    feel_impact(good.accel_x + JP_Q24_ONE + 1);
    for (int tick = 1; tick < config.residual_ticks - 1; tick++) {
        jump_to_and_fro(tick);
        expect_taken();
    }
    for (int tick = 1; tick <= config.confirm_ticks; tick++) {
        sensors.pitch_rate = monitor.good.pitch_rate + config.gyro_jump + 2;
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_IMU_JUMP, check(JP_OK));
    }
}

static void test_an_impact_explains_forces_out_of_range_for_a_while(void)
{
    see_good();
    feel_impact(good.accel_x - JP_Q24_ONE - 1);
    sensors.accel_z = INT32_MIN;
    for (int tick = 2; tick < config.residual_ticks; tick++) {
        sensors.encoder_left++;
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
        TEST_ASSERT_EQUAL_UINT32(sensors.encoder_left, monitor.good.encoder_left);
        TEST_ASSERT_EQUAL_INT32(-config.accel_limit, monitor.good.accel_z);
    }
    for (int tick = 1; tick <= config.confirm_ticks; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_IMU_RANGE, check(JP_OK));
    }
}

static void test_a_force_that_leaves_its_range_is_an_impact_however_little_it_changed(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        jp_monitor_start(&monitor, &config);
        good.accel_x = sign * (config.accel_limit - 10);
        see_good();
        feel_impact(sign * (config.accel_limit + 10));
        sensors.accel_x = sign * (config.accel_limit + 20);
        jump_to_and_fro(2);
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
        TEST_ASSERT_EQUAL_HEX16(0, monitor.suspected);
        TEST_ASSERT_EQUAL_INT32(sign * config.accel_limit, monitor.good.accel_x);
    }
}

static void test_a_rate_that_leaves_its_range_is_no_impact(void)
{
    config.gyro_jump = 1000;
    good.pitch_rate = config.gyro_limit - 10;
    see_good();
    sensors.pitch_rate = config.gyro_limit + 1;
    for (int tick = 1; tick <= config.confirm_ticks; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_IMU_RANGE, check(JP_OK));
    }
    sensors.pitch_rate = config.gyro_limit - 1100;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_JUMP, check(JP_OK));
}

static void test_an_impact_explains_no_rate_out_of_range(void)
{
    config.gyro_jump = INT32_MAX;
    see_good();
    sensors.accel_x = good.accel_x + JP_Q24_ONE + 1;
    sensors.yaw_rate = -config.gyro_limit - 1;
    for (int tick = 1; tick <= config.confirm_ticks; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_IMU_RANGE, check(JP_OK));
    }
}

static void test_an_accelerometer_that_stays_out_of_range_is_a_fault(void)
{
    see_good();
    sensors.accel_z = config.accel_limit + 1;
    for (int tick = 1; tick < config.residual_ticks + config.confirm_ticks - 1; tick++) {
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    }
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_RANGE, check(JP_OK));
    sensors.accel_z = -config.accel_limit - 1;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_RANGE, check(JP_OK));
}

static void test_what_the_weight_can_do_is_no_impact(void)
{
    see_good();
    sensors.accel_x = good.accel_x + JP_Q24_ONE;
    sensors.accel_z = good.accel_z - JP_Q24_ONE;
    for (int tick = 1; tick <= config.confirm_ticks; tick++) {
        sensors.pitch_rate = good.pitch_rate + config.gyro_jump + 2;
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_IMU_JUMP, check(JP_OK));
    }
}

static void test_an_impact_explains_nothing_but_the_imu(void)
{
    see_good();
    feel_impact(good.accel_x + JP_Q24_ONE + 1);
    sensors.encoder_left += config.encoder_jump + 1U;
    sensors.current_left = config.current_limit + 1;
    for (int tick = 2; tick <= config.confirm_ticks; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_ENCODER_JUMP | JP_FAULT_CURRENT_RANGE,
                                check(JP_OK));
    }
}

/** The last frame does not jump. */
static void use_up_what_impacts_explain(void)
{
    for (int tick = 3; tick <= config.residual_ticks; tick++) {
        jump_to_and_fro(tick);
        expect_taken();
    }
}

static void test_impacts_explain_again_after_calm(void)
{
    see_good();
    feel_impact(good.accel_x + JP_Q24_ONE + 3);
    use_up_what_impacts_explain();
    see_good(); /* which is an impact back */
    for (int tick = 0; tick < config.residual_ticks; tick++) {
        see_good();
    }
    feel_impact(good.accel_x + JP_Q24_ONE + 3);
    use_up_what_impacts_explain();
}

static void test_impacts_explain_nothing_more_before_calm(void)
{
    see_good();
    feel_impact(good.accel_x + JP_Q24_ONE + 3);
    use_up_what_impacts_explain();
    see_good(); /* which is an impact back */
    for (int tick = 1; tick < config.residual_ticks; tick++) {
        see_good();
    }
    feel_impact(good.accel_x + JP_Q24_ONE + 3);
    (void)check(JP_OK);
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_JUMP, monitor.suspected);
}

/** As of a wheel that lands again and again: only what needs to be explained counts. */
static void test_a_series_of_impacts_explains_what_each_does(void)
{
    see_good();
    feel_impact(good.accel_x + JP_Q24_ONE + 1);
    for (int landing = 1; landing <= config.residual_ticks - 2; landing++) {
        const int sign = landing % 2 != 0 ? 1 : -1;

        sensors.accel_x = monitor.good.accel_x + sign * (JP_Q24_ONE + 1);
        sensors.yaw_rate = monitor.good.yaw_rate + sign * (config.gyro_jump + 2);
        expect_taken();
        for (int tick = 1; tick < config.residual_ticks; tick++) {
            expect_taken();
        }
    }
    sensors.accel_x = monitor.good.accel_x;
    sensors.yaw_rate = monitor.good.yaw_rate - config.gyro_jump - 2;
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_JUMP, monitor.suspected);
}

static void test_jumps(void)
{
    see_good();
    WITHIN(pitch_rate, good.pitch_rate + config.gyro_jump - 1);
    WITHIN(yaw_rate, good.yaw_rate - config.gyro_jump + 1);
    WITHIN(encoder_left, good.encoder_left + config.encoder_jump); /* across the wrap */
    WITHIN(encoder_right, good.encoder_right - config.encoder_jump);
    BEYOND(pitch_rate, good.pitch_rate + config.gyro_jump + 2, JP_FAULT_IMU_JUMP);
    BEYOND(yaw_rate, good.yaw_rate - config.gyro_jump - 2, JP_FAULT_IMU_JUMP);
    BEYOND(encoder_left, good.encoder_left + config.encoder_jump + 1U, JP_FAULT_ENCODER_JUMP);
    BEYOND(encoder_right, good.encoder_right - config.encoder_jump - 1U, JP_FAULT_ENCODER_JUMP);
    BEYOND(encoder_left, good.encoder_left + 0x80000000U, JP_FAULT_ENCODER_JUMP);
}

static void test_first_frame_cannot_jump(void)
{
    sensors = good;
    sensors.pitch_rate = config.gyro_limit;
    sensors.encoder_left = 0x80000000U;
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    TEST_ASSERT_TRUE(monitor.started);
}

static void test_bad_first_frames_do_not_start(void)
{
    for (int tick = 1; tick <= 4; tick++) {
        sensors = good;
        sensors.bus_voltage = 0;
        TEST_ASSERT_EQUAL_HEX16(tick < 3 ? 0 : JP_FAULT_BUS_VOLTAGE, check(JP_OK));
        TEST_ASSERT_FALSE(monitor.started);
    }
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, check(JP_ERR_HARDWARE));
    TEST_ASSERT_FALSE(monitor.started);
    see_good();
    TEST_ASSERT_TRUE(monitor.started);
}

static void test_failed_read_repeats_the_last_good_frame(void)
{
    see_good();
    for (int tick = 1; tick <= 4; tick++) {
        sensors = (struct jp_sensors){.pitch_rate = INT32_MAX};
        TEST_ASSERT_EQUAL_HEX16(tick < 3 ? 0 : JP_FAULT_HARDWARE, check(JP_ERR_HARDWARE));
        TEST_ASSERT_EQUAL_MEMORY(&good, &monitor.good, sizeof good);
    }
    see_good();
}

static void test_several_faults_at_once(void)
{
    config.confirm_ticks = 1;
    see_good();
    sensors.pitch_rate = INT32_MAX;
    sensors.current_left = INT32_MIN;
    sensors.bus_voltage = 0;
    sensors.encoder_left += 0x40000000U;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP | JP_FAULT_CURRENT_RANGE | JP_FAULT_BUS_VOLTAGE |
                                JP_FAULT_ENCODER_JUMP,
                            check(JP_OK));
}

static void test_start_forgets(void)
{
    see_good();
    sensors.encoder_left += 0x40000000U;
    (void)check(JP_OK);
    jp_monitor_start(&monitor, &config);
    good.encoder_left += 0x40000000U;
    see_good();
}

#define FREEZE(member)                                                                                                 \
    do {                                                                                                               \
        jp_monitor_start(&monitor, &config);                                                                           \
        see_good();                                                                                                    \
        for (int tick = 1; tick <= 4; tick++) {                                                                        \
            struct jp_sensors last = good;                                                                             \
            good.pitch_rate ^= 1;                                                                                      \
            good.yaw_rate ^= 1;                                                                                        \
            good.accel_x ^= 1;                                                                                         \
            good.accel_z ^= 1;                                                                                         \
            good.member = last.member;                                                                                 \
            sensors = good;                                                                                            \
            TEST_ASSERT_EQUAL_HEX16(tick < 3 ? 0 : JP_FAULT_IMU_FROZEN, check(JP_OK));                                 \
        }                                                                                                              \
        see_good();                                                                                                    \
    } while (0)

static void test_a_current_must_not_exceed_the_arithmetic(void)
{
    config.motor_resistance = JP_Q16(64);
    FIELD(current_limit, JP_Q16(511), NULL);
    config.motor_resistance = JP_Q16(64);
    FIELD(current_limit, JP_Q16(512), "monitor.current_limit");
    config.motor_resistance = JP_Q16(1);
    FIELD(current_limit, JP_Q16(32767), NULL);
    config.motor_resistance = JP_Q16(1);
    FIELD(current_limit, JP_Q16(32767) + 1, "monitor.current_limit");
}

static void test_each_channel_of_the_imu_can_freeze(void)
{
    config.freeze_ticks = 3;
    FREEZE(pitch_rate);
    FREEZE(yaw_rate);
    FREEZE(accel_x);
    FREEZE(accel_z);
}

/** On a bus that fails now and then; what is held is what the monitor took last. */
static void hold(unsigned ticks)
{
    sensors = monitor.good;
    for (unsigned tick = 0; tick < ticks; tick++) {
        sensors.encoder_left += 3U;
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_HELD));
        TEST_ASSERT_EQUAL_MEMORY(&sensors, &monitor.good, sizeof sensors); /* its counts go on */
    }
    good.encoder_left = sensors.encoder_left;
}

static void test_what_is_held_does_not_freeze(void)
{
    config.freeze_ticks = 3;
    see_good();
    hold(1000);
    for (int tick = 1; tick < 3; tick++) {
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
        hold(10);
    }
    see_good();
}

static void test_an_imu_freezes_in_as_many_readings_whatever_is_held_between_them(void)
{
    config.freeze_ticks = 3;
    see_good();
    for (int tick = 1; tick <= 5; tick++) {
        hold(7);
        TEST_ASSERT_EQUAL_HEX16(tick < 3 ? 0 : JP_FAULT_IMU_FROZEN, check(JP_OK));
    }
}

/** Nothing that was measured says that the sensor is well again. */
static void test_what_is_held_acquits_no_sensor(void)
{
    see_good();
    for (int tick = 1; tick <= 5; tick++) {
        sensors = good;
        sensors.pitch_rate = config.gyro_limit + 1;
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_IMU_RANGE | JP_FAULT_IMU_JUMP, check(JP_OK));
        sensors = good;
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_HELD));
    }
    see_good();
    sensors.pitch_rate = config.gyro_limit + 1;
    TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK)); /* a good reading did */
}

/** As from a pace of the wheels that was wrong already. */
static void test_what_is_held_must_be_plausible_too(void)
{
    see_good();
    sensors.encoder_left = good.encoder_left + config.encoder_jump + 1U;
    for (int tick = 1; tick <= 5; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_ENCODER_JUMP, check(JP_HELD));
        TEST_ASSERT_EQUAL_MEMORY(&good, &monitor.good, sizeof good);
    }
}

static void test_freezing_can_be_off(void)
{
    see_good();
    for (int i = 0; i < 1000; i++) {
        TEST_ASSERT_EQUAL_HEX16(0, check(JP_OK));
    }
}

static uint16_t motors(jp_q16 left_volts, jp_q16 right_volts, jp_q24 wheel_rate, jp_q24 yaw_rate)
{
    const struct jp_voltages voltages = {left_volts, right_volts, false};

    monitor.good = sensors;

    return jp_monitor_motors(&monitor, &config, &voltages, wheel_rate, yaw_rate);
}

static void test_currents_that_fit_never_contradict(void)
{
    /* 10 V at 2 turn/s: (10 − 2 · 2.6507)/4 A; the right wheel turns faster by 2 · 1.6667 · 0.3. */
    sensors.current_left = JP_Q16((10 - 1.5 * 2.650719) / 4);
    sensors.current_right = JP_Q16((10 - 2.5 * 2.650719) / 4);
    config.current_residual = JP_Q16(0.001);
    jp_monitor_start(&monitor, &config);
    for (int i = 0; i < 200; i++) {
        TEST_ASSERT_EQUAL_HEX16(0, motors(JP_Q16(10), JP_Q16(10), JP_Q24(2), JP_Q24(0.3)));
    }
}

static void test_stopped_encoder_contradicts_its_current(void)
{
    config.wheel_rate_limit = JP_Q24(10);
    /* At 5 turn/s 14 V give 0.19 A; from a stopped encoder 3.5 A would be expected. */
    sensors.current_left = JP_Q16(0.19);
    sensors.current_right = JP_Q16(0.19);
    for (int tick = 1; tick <= 60; tick++) {
        /* The left encoder stands: half the mean rate, and a turn to the left. */
        TEST_ASSERT_EQUAL_HEX16(tick < config.residual_ticks ? 0 : JP_FAULT_ENCODER_LEFT,
                                motors(JP_Q16(14), JP_Q16(14), JP_Q24(2.5), JP_Q24(2.5 / 1.666667)));
    }
    TEST_ASSERT_EQUAL_HEX16(0, motors(JP_Q16(14), JP_Q16(14), JP_Q24(5), 0));
    for (int tick = 1; tick <= 60; tick++) {
        TEST_ASSERT_EQUAL_HEX16(tick < config.residual_ticks ? 0 : JP_FAULT_ENCODER_RIGHT,
                                motors(JP_Q16(14), JP_Q16(14), JP_Q24(2.5), JP_Q24(-2.5 / 1.666667)));
    }
}

static void test_residual_at_its_limit(void)
{
    config.residual_ticks = 1;
    sensors.current_left = config.current_residual;
    sensors.current_right = -config.current_residual;
    TEST_ASSERT_EQUAL_HEX16(0, motors(0, 0, 0, 0));
    sensors.current_left++;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, motors(0, 0, 0, 0));
    sensors.current_left--;
    sensors.current_right--;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_RIGHT, motors(0, 0, 0, 0));
}

/* Six tenths of the last place are rounded up: together with a voltage at the limit they are beyond it. */
static void test_voltages_are_rounded_to_the_nearest(void)
{
    config.residual_ticks = 1;
    config.motor_resistance = JP_Q16(0.6);
    config.back_emf = JP_Q16(1);
    config.current_residual = JP_Q16(100);
    jp_monitor_start(&monitor, &config);
    const jp_q16 limit = monitor.residual_limit;

    sensors.current_left = 1;
    sensors.current_right = 0;
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT, motors(-limit, -limit, 0, 0));
    sensors.current_left = 0;
    TEST_ASSERT_EQUAL_HEX16(0, motors(-limit, -limit, JP_Q24(0.4 / 65536), 0));
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_ENCODER_LEFT | JP_FAULT_ENCODER_RIGHT,
                            motors(-limit, -limit, JP_Q24(0.6 / 65536), 0));
}

static void test_runaway_on_both_sides_of_its_limit(void)
{
    config.current_residual = JP_Q16(1000);
    jp_monitor_start(&monitor, &config);
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int tick = 1; tick <= 10; tick++) {
            TEST_ASSERT_EQUAL_HEX16(0, motors(0, 0, sign * config.wheel_rate_limit, 0));
        }
        for (int tick = 1; tick <= 10; tick++) {
            TEST_ASSERT_EQUAL_HEX16(tick < config.confirm_ticks ? 0 : JP_FAULT_OVERSPEED,
                                    motors(0, 0, sign * (config.wheel_rate_limit + 1), 0));
        }
    }
}
