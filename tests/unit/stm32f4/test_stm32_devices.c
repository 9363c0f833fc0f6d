/* The board as a whole: strap, each device that may be absent, a tick through the registers, and what the monitor of a
 * robot makes of sensors that fail. */
#include "hal/stm32f4/devices.h"

#include <joulepath/monitor.h>
#include <joulepath/tables.h>

#include <string.h>

#include "hal/stm32f4/board.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

static struct jp_devices devices;
static struct jp_hal hal;
static struct jp_sensors sensors;
static unsigned frames;

static void receive(void *context, const struct jp_can_frame *frame)
{
    (void)frame;
    TEST_ASSERT_EQUAL_PTR(&frames, context);
    frames++;
}

static void start(void)
{
    jp_devices_start(&devices, 1000, receive, &frames);
    hal = jp_devices_hal(&devices);
}

void setUp(void)
{
    stm32_fake_reset();
    frames = 0;
    sensors = (struct jp_sensors){0};
}

void tearDown(void)
{
}

/* ---- One tick of the hardware ---- */

static uint8_t sample[JP_IMU_SAMPLE_BYTES];
static uint8_t jitter;

/* Upright, at rest, with the noise that a living sensor has. */
static void sense_upright(void)
{
    jitter++;
    memset(sample, 0, sizeof sample);
    sample[2 * BOARD_IMU_Z_AXIS] = 0x20;
    for (unsigned i = 1; i < sizeof sample; i += 2) {
        sample[i] = jitter;
    }
}

static void end_transfer(void)
{
    memcpy(&devices.imu.received[1], sample, sizeof sample);
    DMA2.LISR = DMA_LISR_TCIF0;
    jp_devices_on_imu(&devices);
    DMA2.LISR = 0;
}

/* Conversions end, the transfer runs, the tick reads. */
static enum jp_status tick(uint32_t left, uint32_t right, uint32_t bus)
{
    ADC1.JDR1 = left;
    ADC1.JDR2 = right;
    ADC1.JDR3 = bus;
    ADC1.SR = ADC_SR_JEOC;
    sense_upright();
    if (!jp_devices_on_sample(&devices)) {
        end_transfer();
    }
    return hal.read(hal.context, &sensors);
}

/* ---- Start ---- */

static void test_everything_is_there(void)
{
    start();
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_CRYSTAL, devices.clock);
    TEST_ASSERT_FALSE(devices.on_bus);
    TEST_ASSERT_TRUE(devices.has_can);
    TEST_ASSERT_EQUAL_INT(JP_OK, devices.analog_status);
    TEST_ASSERT_EQUAL_INT(JP_OK, devices.imu_status);
    CHECK_SET(ADC_CR1_JEOCIE, ADC1.CR1);
    CHECK_CLEAR(TIM_BDTR_MOE, TIM1.BDTR | TIM8.BDTR);
    TEST_ASSERT_TRUE(fake.waited_us < 500000U);
}

static void test_timers_fit_the_clock(void)
{
    start();
    TEST_ASSERT_EQUAL_UINT32(84 - 1, TIM5.PSC);
    TEST_ASSERT_EQUAL_UINT32(4200, TIM1.ARR);

    stm32_fake_reset();
    fake.crystal = FAKE_NEVER;
    fake.pll_on_internal = FAKE_NEVER;
    start();
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL, devices.clock);
    TEST_ASSERT_EQUAL_UINT32(16 - 1, TIM5.PSC);
    TEST_ASSERT_EQUAL_UINT32(400, TIM1.ARR);
}

/* The internal oscillator is off by up to 1 %: it would disturb the bus. */
static void test_can_needs_the_crystal(void)
{
    fake.crystal = FAKE_NEVER;
    start();
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL_PLL, devices.clock);
    TEST_ASSERT_FALSE(devices.has_can);
    CHECK_CLEAR(RCC_APB1ENR_CAN1EN, RCC.APB1ENR);
}

static void test_without_a_bus_the_rest_works(void)
{
    struct jp_can_port port;

    fake.can_join = FAKE_NEVER;
    start();
    port = jp_can_controller_port(&devices.can);
    TEST_ASSERT_FALSE(devices.has_can);
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, port.state(port.context));
    TEST_ASSERT_EQUAL_INT(JP_OK, tick(2048, 2048, 2708));
}

/* With the strap to ground nothing of the board but clock, time and CAN is touched. */
static void test_strapped_to_the_bus(void)
{
    GPIOE.IDR = 0;
    start();
    TEST_ASSERT_TRUE(devices.on_bus);
    TEST_ASSERT_TRUE(devices.has_can);
    TEST_ASSERT_EQUAL_INT(JP_OK, devices.analog_status);
    TEST_ASSERT_EQUAL_INT(JP_OK, devices.imu_status);
    TEST_ASSERT_EQUAL_HEX32(0, TIM1.BDTR | TIM1.CCER | TIM8.BDTR | TIM8.CCER);
    TEST_ASSERT_EQUAL_HEX32(0, ADC1.CR1 | ADC1.CR2 | SPI1.CR1 | TIM3.CR1);
    TEST_ASSERT_TRUE(fake.waited_us < 1000U);
}

/* As in an emulator that knows none of these: all registers read 0. */
static void test_a_chip_without_these_peripherals(void)
{
    GPIOE.IDR = 0;
    fake.crystal = FAKE_NEVER;
    fake.pll_on_internal = FAKE_NEVER;
    fake.can_init = FAKE_NEVER;
    start();
    TEST_ASSERT_EQUAL_INT(JP_CLOCK_INTERNAL, devices.clock);
    TEST_ASSERT_TRUE(devices.on_bus);
    TEST_ASSERT_FALSE(devices.has_can);
}

static void test_frames_reach_the_receiver(void)
{
    start();
    CAN1.RF0R = CAN_RF0R_FMP0(1);
    jp_can_controller_on_receive(&devices.can);
    TEST_ASSERT_EQUAL_UINT(1, frames);
}

/* ---- Ticks ---- */

static void test_a_tick_reads_all_sensors(void)
{
    start();
    TIM4.CNT = (uint32_t)(uint16_t)(12 * BOARD_ENCODER_SIGN_LEFT);
    TIM2.CNT = (uint32_t)(uint16_t)(34 * BOARD_ENCODER_SIGN_RIGHT);
    TEST_ASSERT_EQUAL_INT(JP_OK,
                          tick(2048 + 100 * BOARD_CURRENT_SIGN_LEFT, 2048 - 50 * BOARD_CURRENT_SIGN_RIGHT, 2708));
    TEST_ASSERT_EQUAL_UINT32(12, sensors.encoder_left);
    TEST_ASSERT_EQUAL_UINT32(34, sensors.encoder_right);
    TEST_ASSERT_EQUAL_INT32(26400, sensors.current_left);
    TEST_ASSERT_EQUAL_INT32(-13200, sensors.current_right);
    TEST_ASSERT_INT32_WITHIN(JP_Q16(0.001), JP_Q16(23.9995), sensors.bus_voltage);
    TEST_ASSERT_INT32_WITHIN(JP_Q24(0.1), JP_Q24_ONE, sensors.accel_z);
}

static void test_the_tick_follows_the_transfer(void)
{
    start();
    ADC1.SR = ADC_SR_JEOC;
    TEST_ASSERT_FALSE(jp_devices_on_sample(&devices));
    TEST_ASSERT_EQUAL_INT(JP_IMU_BUSY, devices.imu.state);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, hal.read(hal.context, &sensors));
}

static void test_without_a_sample_no_transfer_begins(void)
{
    start();
    ADC1.SR = 0;
    TEST_ASSERT_FALSE(jp_devices_on_sample(&devices));
    TEST_ASSERT_EQUAL_INT(JP_IMU_READY, devices.imu.state);
}

/* The tick comes all the same, and reports it. */
static void test_without_an_inertial_sensor(void)
{
    fake.imu_absent = true;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, devices.imu_status);
    ADC1.SR = ADC_SR_JEOC;
    TEST_ASSERT_TRUE(jp_devices_on_sample(&devices));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, hal.read(hal.context, &sensors));
}

static void test_an_inertial_sensor_that_stops(void)
{
    start();
    TEST_ASSERT_EQUAL_INT(JP_OK, tick(2048, 2048, 2708));
    ADC1.SR = ADC_SR_JEOC;
    TEST_ASSERT_FALSE(jp_devices_on_sample(&devices));
    for (int i = 0; i < 5; i++) {
        ADC1.SR = ADC_SR_JEOC;
        TEST_ASSERT_TRUE(jp_devices_on_sample(&devices));
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, hal.read(hal.context, &sensors));
    }
}

static void test_without_zeros_of_the_currents_no_tick_is_good(void)
{
    fake.readings[1] = 4095;
    start();
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, devices.analog_status);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, tick(2048, 2048, 2708));
}

static void test_duties_reach_the_bridges(void)
{
    const struct jp_actuation on = {.duty_left = JP_Q31_MAX / 2, .duty_right = JP_Q31_MAX / 2, .enabled = 1};
    const struct jp_actuation off = {.enabled = 0};

    start();
    TEST_ASSERT_EQUAL_INT(JP_OK, hal.write(hal.context, &on));
    CHECK_SET(TIM_BDTR_MOE, TIM1.BDTR & TIM8.BDTR);
    TEST_ASSERT_EQUAL_INT32(2100 * BOARD_MOTOR_SIGN_LEFT, (int32_t)TIM1.CCR1 - (int32_t)TIM1.CCR2);
    TEST_ASSERT_EQUAL_INT32(2100 * BOARD_MOTOR_SIGN_RIGHT, (int32_t)TIM8.CCR1 - (int32_t)TIM8.CCR2);
    TEST_ASSERT_EQUAL_INT(JP_OK, hal.write(hal.context, &off));
    CHECK_CLEAR(TIM_BDTR_MOE, TIM1.BDTR | TIM8.BDTR);
}

/* ---- What a robot's monitor says ---- */

static uint16_t faults_of(uint32_t left, uint32_t right, uint32_t bus, unsigned ticks)
{
    const struct jp_monitor_config *config = &jp_robot_courier24.monitor;
    struct jp_monitor monitor;
    uint16_t faults = 0;

    jp_monitor_start(&monitor, &jp_robot_courier24.monitor);
    for (unsigned i = 0; i < 10U; i++) {
        const enum jp_status read = tick(2048, 2048, 2708);

        TEST_ASSERT_EQUAL_UINT16(0, jp_monitor_sensors(&monitor, config, read, &sensors));
    }
    for (unsigned i = 0; i < ticks; i++) {
        const enum jp_status read = tick(left, right, bus);

        faults = jp_monitor_sensors(&monitor, config, read, &sensors);
    }
    return faults;
}

static void check_confirmed(uint16_t fault, uint32_t left, uint32_t right, uint32_t bus)
{
    const uint16_t ticks = jp_robot_courier24.monitor.confirm_ticks;

    TEST_ASSERT_EQUAL_HEX16(0, faults_of(left, right, bus, ticks - 1U));
    TEST_ASSERT_EQUAL_HEX16(fault, faults_of(left, right, bus, ticks));
}

/* Also with zeros at the ends of what is tolerated, where 4095 alone would pass for a current. */
static void test_saturated_readings_become_faults(void)
{
    for (int32_t off = -102; off <= 102; off += 102) {
        stm32_fake_reset();
        fake.readings[0] = (uint32_t)(2048 + off);
        fake.readings[1] = (uint32_t)(2048 + off);
        start();
        TEST_ASSERT_EQUAL_INT(JP_OK, devices.analog_status);
        check_confirmed(JP_FAULT_CURRENT_RANGE, 4095, 2048, 2708);
        check_confirmed(JP_FAULT_CURRENT_RANGE, 0, 2048, 2708);
        check_confirmed(JP_FAULT_CURRENT_RANGE, 2048, 4095, 2708);
        check_confirmed(JP_FAULT_CURRENT_RANGE, 2048, 0, 2708);
        check_confirmed(JP_FAULT_BUS_VOLTAGE, 2048, 2048, 4095);
        check_confirmed(JP_FAULT_BUS_VOLTAGE, 2048, 2048, 0);
    }
}

static void test_an_absent_sensor_becomes_a_fault(void)
{
    struct jp_monitor monitor;
    uint16_t faults = 0;

    fake.imu_absent = true;
    start();
    jp_monitor_start(&monitor, &jp_robot_courier24.monitor);
    for (unsigned i = 0; i < jp_robot_courier24.monitor.confirm_ticks; i++) {
        faults = jp_monitor_sensors(&monitor, &jp_robot_courier24.monitor, tick(2048, 2048, 2708), &sensors);
    }
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_HARDWARE, faults);
}

/* The sensor repeats its last sample: transfers end as ever. */
static void test_a_frozen_sensor_becomes_a_fault(void)
{
    const struct jp_monitor_config *config = &jp_robot_courier24.monitor;
    struct jp_monitor monitor;
    uint16_t faults = 0;
    unsigned ticks = 0;

    start();
    jp_monitor_start(&monitor, &jp_robot_courier24.monitor);
    (void)jp_monitor_sensors(&monitor, config, tick(2048, 2048, 2708), &sensors);
    while (faults == 0U && ticks < 1000U) {
        jitter--;
        faults = jp_monitor_sensors(&monitor, config, tick(2048, 2048, 2708), &sensors);
        ticks++;
    }
    TEST_ASSERT_EQUAL_HEX16(JP_FAULT_IMU_FROZEN, faults);
    TEST_ASSERT_EQUAL_UINT(config->freeze_ticks, ticks);
}
