/* The robot on its own board, from the registers to the registers: what is broken ends with the bridges off or with a
 * balanced stand. */
#include <joulepath/tables.h>

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/devices.h"
#include "tests/support/ecu_start.h"

#include <string.h>

#include "tests/support/commands.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

#define BUS_24_V 2708 /* counts */
#define ZERO     ((int32_t)BOARD_CURRENT_ZERO)

static struct jp_robot_config config;
static struct jp_devices devices;
static struct jp_hal hal;
static struct jp_ecu ecu;
static struct jp_ecu_balancer balancer;
static struct jp_retained retained;
static uint8_t command_counter;
static uint8_t jitter;

/* What the world does to the sensors. */
static struct world {
    uint16_t wheel_left; /* timers of the encoders */
    uint16_t wheel_right;
    int16_t wheel_step; /* counts a tick */
    int32_t current_left_extra;
    int32_t bus;
    bool held; /* currents are those of a wheel that is held: else none flows */
    bool imu_absent;
    bool imu_frozen;
    bool current_saturated;
} world;

static void ignore_frame(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
}

static int32_t counts_of(jp_q16 voltage)
{
    const int64_t current = jp_q16_divide(voltage, config.monitor.motor_resistance);

    return world.held ? (int32_t)(current * 256 / BOARD_AMPERES_PER_COUNT) : 0;
}

static uint32_t reading(int32_t counts)
{
    return (uint32_t)(counts < 0 ? 0 : counts > 4095 ? 4095 : counts);
}

static void convert(void)
{
    const struct jp_voltages *voltages = &jp_robot_last_tick(&balancer.robot)->voltages;

    ADC1.JDR1 = reading(ZERO + BOARD_CURRENT_SIGN_LEFT * counts_of(voltages->left) + world.current_left_extra);
    ADC1.JDR2 = reading(ZERO + BOARD_CURRENT_SIGN_RIGHT * counts_of(voltages->right));
    if (world.current_saturated) {
        ADC1.JDR2 = 4095;
    }
    ADC1.JDR3 = (uint32_t)world.bus;
    ADC1.SR = ADC_SR_JEOC;
}

/* Upright, at rest, with the noise of a living sensor. */
static void transfer(void)
{
    uint8_t sample[JP_IMU_SAMPLE_BYTES] = {0};

    jitter = (uint8_t)(jitter + (world.imu_frozen ? 0U : 1U));
    sample[2 * BOARD_IMU_Z_AXIS] = 0x20;
    for (unsigned i = 1; i < sizeof sample; i += 2) {
        sample[i] = jitter & 3U;
    }
    memcpy(&devices.imu.received[1], sample, sizeof sample);
    DMA2.LISR = DMA_LISR_TCIF0;
    jp_devices_on_imu(&devices);
    DMA2.LISR = 0;
}

/* As main.c's interrupts and loop. */
static void tick(void)
{
    convert();
    if (!jp_devices_on_sample(&devices) && !world.imu_absent) {
        transfer();
    }
    world.wheel_left = (uint16_t)(world.wheel_left + world.wheel_step * BOARD_ENCODER_SIGN_LEFT);
    world.wheel_right = (uint16_t)(world.wheel_right + world.wheel_step * BOARD_ENCODER_SIGN_RIGHT);
    TIM4.CNT = world.wheel_left;
    TIM2.CNT = world.wheel_right;
    jp_ecu_tick(&ecu);
    jp_ecu_work(&ecu);
}

static void run(unsigned ticks)
{
    for (unsigned i = 0; i < ticks; i++) {
        tick();
    }
}

static void start(void)
{
    const struct jp_can_port port = jp_can_controller_port(&devices.can);
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK,
                          ecu_start(&ecu, &balancer, &config, &jp_energy_model_courier24, &port, &retained, &field));
    hal = jp_devices_hal(&devices);
    jp_ecu_use_board(&ecu, &hal);
}

void setUp(void)
{
    config = jp_robot_courier24;
    world = (struct world){.bus = BUS_24_V, .held = true};
    command_counter = 0;
    memset(&retained, 0, sizeof retained);
    stm32_fake_reset();
    jp_devices_start(&devices, 1000, ignore_frame, NULL);
    start();
}

void tearDown(void)
{
}

static void command(uint8_t mode)
{
    const struct jp_can_frame frame = operator_command(++command_counter & 15U, mode, 0);

    (void)jp_ecu_accept(&ecu, &frame);
    run(100);
}

static bool bridges_are_on(void)
{
    return (TIM1.BDTR & TIM_BDTR_MOE) != 0U && (TIM8.BDTR & TIM_BDTR_MOE) != 0U;
}

static bool bridges_are_off(void)
{
    return ((TIM1.BDTR | TIM8.BDTR) & TIM_BDTR_MOE) == 0U;
}

static void stand_up(void)
{
    run(3);
    command(JP_MODE_STAND);
    command(JP_MODE_STAND);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_on());
}

/* Within so many ticks the fault is named and the bridges are off. */
static void expect_off(uint16_t fault, unsigned ticks)
{
    run(ticks);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_FAULT, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_BITS_HIGH(fault, jp_robot_last_tick(&balancer.robot)->faults);
    TEST_ASSERT_TRUE(bridges_are_off());
}

static void test_it_stands_and_is_switched_off(void)
{
    TEST_ASSERT_TRUE(bridges_are_off());
    stand_up();
    for (int i = 0; i < 3; i++) {
        command(JP_MODE_OFF);
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_off());
}

static void test_a_brown_out_of_the_motor_supply_switches_off(void)
{
    stand_up();
    world.bus = 100;
    expect_off(JP_FAULT_BUS_VOLTAGE, config.monitor.confirm_ticks);
}

/* Pushed out of place by hand: the controller pulls, the wheels turn, the currents are those of wheels that do not. */
static void test_a_stuck_encoder_that_contradicts_the_current_switches_off(void)
{
    stand_up();
    world.held = false;
    balancer.robot.internal.reference.wheel.angle += (jp_phase)JP_Q24(0.2) << 32;
    balancer.robot.internal.reference.wheel.target = balancer.robot.internal.reference.wheel.angle;
    expect_off(JP_FAULT_ENCODER_LEFT | JP_FAULT_ENCODER_RIGHT, 200);
}

static void test_a_stuck_encoder_at_a_stand_is_no_matter(void)
{
    stand_up();
    for (int i = 0; i < 20; i++) {
        command(JP_MODE_STAND);
    }
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_on());
}

static void test_an_imu_that_falls_silent_switches_off(void)
{
    stand_up();
    world.imu_absent = true;
    expect_off(JP_FAULT_HARDWARE, config.monitor.confirm_ticks);
}

static void test_an_imu_that_freezes_switches_off(void)
{
    stand_up();
    world.imu_frozen = true;
    expect_off(JP_FAULT_IMU_FROZEN, config.monitor.freeze_ticks + 1U);
}

static void test_without_an_imu_it_never_stands_up(void)
{
    stm32_fake_reset();
    fake.imu_absent = true;
    jp_devices_start(&devices, 1000, ignore_frame, NULL);
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, devices.imu_status);
    run(10);
    for (int i = 0; i < 5; i++) {
        command(JP_MODE_STAND);
    }
    TEST_ASSERT_NOT_EQUAL(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_off());
}

static void test_without_the_zeros_of_the_currents_it_never_stands_up(void)
{
    stm32_fake_reset();
    fake.readings[0] = 4095;
    jp_devices_start(&devices, 1000, ignore_frame, NULL);
    start();
    run(10);
    for (int i = 0; i < 5; i++) {
        command(JP_MODE_STAND);
    }
    TEST_ASSERT_NOT_EQUAL(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_off());
}

static void test_a_saturated_converter_switches_off(void)
{
    stand_up();
    world.current_saturated = true;
    expect_off(JP_FAULT_CURRENT_RANGE, config.monitor.confirm_ticks);
}

static void test_a_break_of_the_bridges_switches_off(void)
{
    stand_up();
    TIM1.BDTR &= ~TIM_BDTR_MOE;
    expect_off(JP_FAULT_HARDWARE, config.monitor.confirm_ticks + 2U);
}

static void test_bus_off_ends_in_a_balanced_stand(void)
{
    stand_up();
    CAN1.ESR = CAN_ESR_BOFF;
    jp_can_controller_on_error(&devices.can);
    run(2000);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_EQUAL_INT(JP_OPERATOR_LOST, ecu.internal.operator_link.state);
    TEST_ASSERT_EQUAL_UINT8(1, ecu.bus_offs);
    TEST_ASSERT_TRUE(bridges_are_on());
}

/* A watchdog reset: registers as after a reset, the record as it was. */
static void test_a_reset_ends_in_a_balanced_stand(void)
{
    stand_up();
    stm32_fake_reset();
    TEST_ASSERT_TRUE(bridges_are_off());
    jp_devices_start(&devices, 1000, ignore_frame, NULL);
    devices.encoders.count_left = balancer.robot.internal.estimator.encoder_left;
    devices.encoders.count_right = balancer.robot.internal.estimator.encoder_right;
    start();
    run(1);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_on());
    TEST_ASSERT_EQUAL_UINT32(1, ecu.resets);
}
