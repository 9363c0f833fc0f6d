/* The firmware's start and loop on fake registers: what it decides to be, whom it obeys, and when it feeds the
 * watchdog. */
#undef FIRMWARE_ROBOT_NAME
#undef FIRMWARE_LATTICE_NAME
#undef FIRMWARE_LEARNS
#undef FIRMWARE_NAVIGATES
#define FIRMWARE_ROBOT_NAME   courier24
#define FIRMWARE_LATTICE_NAME courier24
#define FIRMWARE_LEARNS
#define FIRMWARE_NAVIGATES
#define main firmware_main
#include <joulepath/tables.h>

#include "hal/firmware/firmware_balancer.c"
#include "hal/stm32f4/main.c"
#undef main

#include <setjmp.h>
#include <string.h>

#include "hal/stm32f4/board.h"
#include "tests/support/commands.h"
#include "tests/support/stm32_fake.h"

#include "unity.h"

#define FED 0xAAAAU

/* What start-up and fault handler have. */
struct jp_post_mortem jp_post_mortem;
volatile uint32_t jp_fault_tick;
volatile struct cortex_scb SCB;
volatile struct cortex_systick SYSTICK;
volatile struct cortex_mpu MPU;
volatile uint32_t firmware_store[2][JP_FLASH_SECTOR_SIZE / 4U];

/* The core: sleeping is when the world does something. */

static jmp_buf out;
static void (*world)(void);
static unsigned sleeps;
static unsigned sleeps_left;
static bool was_reset;
static uint8_t jitter;
static uint8_t command_counter;

void jp_interrupts_off(void)
{
}

void jp_interrupts_on(void)
{
}

void jp_finish_writes(void)
{
    if ((NVIC.ISPR[CONTROL_IRQ / 32] & (1U << (CONTROL_IRQ % 32))) != 0U) {
        NVIC.ISPR[CONTROL_IRQ / 32] = 0;
        DMA2_Stream0_IRQHandler();
    }
}

void jp_wait_for_interrupt(void)
{
    if (sleeps_left == 0U) {
        longjmp(out, 1);
    }
    sleeps_left--;
    sleeps++;
    world();
    jp_finish_writes();
}

void jp_nvic_enable(unsigned irq, unsigned level)
{
    NVIC.IPR[irq] = NVIC_PRIORITY(level);
    NVIC.ISER[irq / 32U] |= 1U << (irq % 32U);
}

void jp_nvic_pend(unsigned irq)
{
    NVIC.ISPR[irq / 32U] |= 1U << (irq % 32U);
}

_Noreturn void jp_system_reset(void)
{
    was_reset = true;
    longjmp(out, 1);
}

/* The world. */

static void nothing(void)
{
}

/* A sample of a robot that stands upright and is held. */
static void sample(void)
{
    ADC1.JDR1 = BOARD_CURRENT_ZERO;
    ADC1.JDR2 = BOARD_CURRENT_ZERO;
    ADC1.JDR3 = 2708;
    ADC1.SR = ADC_SR_JEOC;
    ADC_IRQHandler();
    memset((void *)(uintptr_t)devices.imu.received, 0, sizeof devices.imu.received);
    devices.imu.received[1 + 2 * BOARD_IMU_Z_AXIS] = 0x20;
    jitter++;
    for (unsigned i = 2; i < sizeof devices.imu.received; i += 2) {
        devices.imu.received[i] = jitter & 3U;
    }
    DMA2.LISR = DMA_LISR_TCIF0;
    jp_nvic_pend(CONTROL_IRQ);
}

static void command(uint8_t mode)
{
    const struct jp_can_frame frame = operator_command(++command_counter & 15U, mode, 0);

    take_frame(NULL, &frame);
}

static void sample_and_command_stand(void)
{
    if (sleeps % 100U == 50U) {
        command(JP_MODE_STAND);
    }
    sample();
}

/* main() until it has slept so often, or has reset. */
static void run_firmware(void (*what)(void), unsigned count)
{
    world = what;
    sleeps = 0;
    sleeps_left = count;
    was_reset = false;
    ticks = 0;
    sample_age = 0;
    node = (struct jp_lockstep){.running = false};
    if (setjmp(out) == 0) {
        (void)firmware_main();
    }
}

static void power_on(void)
{
    stm32_fake_reset();
    RCC.CSR = RCC_CSR_PORRSTF | RCC_CSR_BORRSTF | RCC_CSR_PADRSTF;
}

/* The inertial sensor keeps its settings. */
static void reset_by(uint32_t flags)
{
    uint8_t settings[FAKE_IMU_REGISTERS];

    memcpy(settings, fake.imu_registers, sizeof settings);
    stm32_fake_reset();
    memcpy(fake.imu_registers, settings, sizeof settings);
    RCC.CSR = flags | RCC_CSR_PADRSTF;
}

void setUp(void)
{
    memset((void *)(uintptr_t)firmware_store, 0xFF, sizeof firmware_store);
    memset(&retained, 0, sizeof retained);
    memset(&jp_post_mortem, 0x5A, sizeof jp_post_mortem);
    command_counter = 0;
    power_on();
}

void tearDown(void)
{
}

static bool bridges_are_on(void)
{
    return (TIM1.BDTR & TIM8.BDTR & TIM_BDTR_MOE) != 0U;
}

static void test_it_starts_with_its_own_body_and_can(void)
{
    run_firmware(nothing, 3);
    TEST_ASSERT_FALSE(devices.on_bus);
    TEST_ASSERT_TRUE(node.ecu.internal.has_board);
    TEST_ASSERT_EQUAL_PTR(&devices.can, jp_can_controller_port(&devices.can).context);
    TEST_ASSERT_EQUAL_INT(JP_RESET_POWER_ON, reset_report.cause);
    TEST_ASSERT_EQUAL_PTR(&reset_report, node.ecu.internal.reset_report);
    TEST_ASSERT_FALSE(bridges_are_on());
}

static void test_every_interrupt_has_its_priority(void)
{
    static const struct {
        unsigned irq;
        uint8_t level;
    } expected[] = {{PVD_IRQn, 1},      {USART1_IRQn, 1},   {ADC_IRQn, 2},         {CAN1_TX_IRQn, 2},
                    {CAN1_RX0_IRQn, 2}, {CAN1_SCE_IRQn, 2}, {DMA2_Stream0_IRQn, 2}};

    run_firmware(nothing, 1);
    for (unsigned i = 0; i < sizeof expected / sizeof expected[0]; i++) {
        TEST_ASSERT_EQUAL_HEX8(expected[i].level << 4, NVIC.IPR[expected[i].irq]);
        TEST_ASSERT_BITS_HIGH(1U << (expected[i].irq % 32U), NVIC.ISER[expected[i].irq / 32U]);
    }
    TEST_ASSERT_EQUAL_HEX8(2 << 4, SCB.SHPR[11]);
}

static void test_each_sample_is_a_tick_with_work_behind_it(void)
{
    run_firmware(sample, 50);
    TEST_ASSERT_EQUAL_UINT32(50, ticks);
    TEST_ASSERT_EQUAL_UINT32(50, node.ecu.tick);
    TEST_ASSERT_EQUAL_UINT32(50, jp_fault_tick);
    TEST_ASSERT_EQUAL_UINT32(50, node.ecu.internal.worked_tick);
}

static void test_the_watchdog_is_fed_after_a_tick_only(void)
{
    run_firmware(sample, 5);
    TEST_ASSERT_EQUAL_HEX32(FED, IWDG.KR);
    IWDG.KR = 0;
    world = nothing;
    sleeps_left = 100;
    if (setjmp(out) == 0) {
        run();
    }
    TEST_ASSERT_EQUAL_HEX32(0, IWDG.KR);
}

static void test_it_stands_up_when_told(void)
{
    run_firmware(sample_and_command_stand, 400);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_on());
}

static void test_a_watchdog_reset_goes_on_to_a_balanced_stand(void)
{
    run_firmware(sample_and_command_stand, 400);
    reset_by(RCC_CSR_WDGRSTF);
    run_firmware(sample, 2);
    TEST_ASSERT_EQUAL_INT(JP_RESET_WATCHDOG, reset_report.cause);
    TEST_ASSERT_EQUAL_UINT32(1, reset_report.crashes);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_on());
}

static void test_the_third_crash_in_a_row_stays_off(void)
{
    run_firmware(sample_and_command_stand, 400);
    for (unsigned crash = 1; crash <= JP_CRASHES_MAX; crash++) {
        reset_by(RCC_CSR_WDGRSTF);
        run_firmware(sample, 2);
        TEST_ASSERT_EQUAL_UINT32(crash, reset_report.crashes);
        TEST_ASSERT_EQUAL(crash < JP_CRASHES_MAX, bridges_are_on());
    }
    reset_by(RCC_CSR_SFTRSTF);
    run_firmware(sample_and_command_stand, 400);
    TEST_ASSERT_TRUE(bridges_are_on());
}

static void test_ten_seconds_of_health_forgive(void)
{
    reset_by(RCC_CSR_WDGRSTF);
    run_firmware(sample, 9999);
    TEST_ASSERT_EQUAL_UINT32(1, jp_post_mortem.crashes);
    reset_by(RCC_CSR_SFTRSTF);
    run_firmware(sample, 10001);
    TEST_ASSERT_EQUAL_UINT32(0, jp_post_mortem.crashes);
}

static void test_a_start_without_the_crystal_does_not_go_on(void)
{
    run_firmware(sample_and_command_stand, 400);
    reset_by(RCC_CSR_SFTRSTF);
    fake.crystal = FAKE_NEVER;
    run_firmware(sample, 2);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_FALSE(bridges_are_on());
}

/* 0.01 turn/s in 2⁻⁵⁶ turn/s, learned while standing. */
#define LEARNED_BIAS ((int64_t)JP_Q24(0.01) * ((int64_t)1 << 32))

static void go_on(void (*what)(void), unsigned count)
{
    world = what;
    sleeps_left = count;
    if (setjmp(out) == 0) {
        run();
    }
}

static void sample_and_command_off(void)
{
    if (sleeps % 100U == 50U) {
        command(JP_MODE_OFF);
    }
    sample();
}

/* The inertial sensor falls silent: the converter's interrupts alone. */
static void convert_and_command_off(void)
{
    ADC1.SR = ADC_SR_JEOC;
    ADC_IRQHandler();
    if (jp_robot_state_now(&balancer.robot) == JP_ROBOT_FAULT && sleeps % 100U == 50U) {
        command(JP_MODE_OFF);
    }
}

/* Flash that does not need to be unlocked: its controller has a test of its own. */
static enum jp_status program_memory(void *context, unsigned sector, uint32_t offset, uint32_t word)
{
    (void)context;
    firmware_store[sector][offset / 4U] &= word;
    return JP_OK;
}

static enum jp_status erase_memory(void *context, unsigned sector)
{
    (void)context;
    memset((void *)(uintptr_t)firmware_store[sector], 0xFF, sizeof firmware_store[sector]);
    return JP_OK;
}

static void learn(void)
{
    run_firmware(sample_and_command_stand, 400);
    flash.program = program_memory;
    flash.erase = erase_memory;
    balancer.robot.internal.estimator.gyro_bias = LEARNED_BIAS;
}

static int64_t stored_bias(void)
{
    struct jp_parameters found;
    const char *field;

    (void)jp_store_open(&store, &flash);
    return jp_parameters_load(&found, jp_firmware_identity(), &store, &field) == JP_OK ? found.gyro_bias : 0;
}

static void test_what_was_learned_is_kept_when_it_is_switched_off(void)
{
    learn();
    go_on(sample_and_command_off, 400);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_IDLE, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(stored_bias() > LEARNED_BIAS * 9 / 10 && stored_bias() < LEARNED_BIAS * 11 / 10);
}

static struct jp_learned_state stored_energy(void)
{
    struct jp_parameters found;
    const uint8_t *record = NULL;
    uint16_t length = 0;

    (void)jp_store_open(&store, &flash);
    (void)jp_store_read(&store, &record, &length);
    (void)jp_parameters_start(&found, jp_firmware_identity(), record, length);
    return found.energy;
}

static void test_what_was_learned_of_energy_is_there_after_a_restart(void)
{
    struct jp_learned_state kept;

    learn();
    TEST_ASSERT_EQUAL_INT(JP_STORED_NOTHING, balancer.stored);
    balancer.pilot.learner.state.x[1] = JP_Q24(0.75);
    balancer.pilot.learner.state.version = 12;
    kept = balancer.pilot.learner.state;
    go_on(sample, 50);
    TEST_ASSERT_EQUAL_UINT32(0, stored_energy().version); /* the motors run */
    go_on(sample_and_command_off, 400);
    TEST_ASSERT_EQUAL_UINT32(12, stored_energy().version);
    power_on();
    run_firmware(sample, 3);
    TEST_ASSERT_EQUAL_INT(JP_STORED_TAKEN, balancer.stored);
    TEST_ASSERT_EQUAL_MEMORY(&kept, jp_ecu_learned_state(&node.ecu), sizeof kept);
}

static void test_what_another_robot_learned_is_refused_and_the_built_in_model_serves(void)
{
    extern const struct jp_robot_config jp_robot_gao2018;
    struct jp_parameters others;
    const char *field;

    run_firmware(nothing, 1);
    flash.program = program_memory;
    flash.erase = erase_memory;
    jp_parameters_default(&others);
    others.energy.identity = FIRMWARE_LEARNING.identity;
    others.energy.x[0] = JP_Q24(1);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_parameters_save(&others, jp_robot_identity(&jp_robot_gao2018), &store, &field));
    run_firmware(sample, 3);
    TEST_ASSERT_EQUAL_INT(JP_STORED_OTHER_ROBOT, balancer.stored);
    TEST_ASSERT_EQUAL_MEMORY(&FIRMWARE_ENERGY_MODEL, jp_ecu_balancer_model(&balancer), sizeof(struct jp_energy_model));
}

static void test_nothing_is_kept_after_a_fault(void)
{
    learn();
    balancer.pilot.learner.state.version = 12;
    go_on(convert_and_command_off, 600);
    TEST_ASSERT_EQUAL_INT64(0, stored_bias());
    TEST_ASSERT_EQUAL_UINT32(0, stored_energy().version);
    TEST_ASSERT_FALSE(bridges_are_on());
    TEST_ASSERT_NOT_EQUAL(0, sleeps);
}

static void test_a_failing_supply_switches_off_and_resets(void)
{
    run_firmware(sample_and_command_stand, 400);
    TEST_ASSERT_TRUE(bridges_are_on());
    if (setjmp(out) == 0) {
        PVD_IRQHandler();
    }
    TEST_ASSERT_FALSE(bridges_are_on());
    TEST_ASSERT_TRUE(was_reset);
}

static void test_a_failing_crystal_switches_off_and_resets(void)
{
    run_firmware(sample_and_command_stand, 400);
    if (setjmp(out) == 0) {
        NMI_Handler();
    }
    TEST_ASSERT_FALSE(bridges_are_on());
    TEST_ASSERT_TRUE(was_reset);
}

static void test_strapped_it_ticks_with_samples_of_the_bus_and_without_them(void)
{
    GPIOE.IDR = 0;
    run_firmware(SysTick_Handler, 3);
    TEST_ASSERT_TRUE(devices.on_bus);
    TEST_ASSERT_FALSE(node.ecu.internal.has_board);
    TEST_ASSERT_EQUAL_UINT32(1, ticks);
    power_on();
    GPIOE.IDR = 0;
    run_firmware(SysTick_Handler, 7);
    TEST_ASSERT_EQUAL_UINT32(3, ticks);
}

static void test_a_sample_of_the_bus_is_a_tick(void)
{
    const struct jp_sensors sensors = {.accel_z = JP_Q24_ONE, .bus_voltage = JP_Q16(24)};
    struct jp_can_frame frames[JP_SAMPLE_PARTS];
    uint8_t counter = 0;

    GPIOE.IDR = 0;
    run_firmware(nothing, 1);
    for (int sample_number = 0; sample_number < 3; sample_number++) {
        jp_message_from_sensors(frames, &counter, &sensors);
        for (int part = 0; part < JP_SAMPLE_PARTS; part++) {
            take_frame(NULL, &frames[part]);
        }
        jp_finish_writes();
    }
    TEST_ASSERT_EQUAL_UINT32(2, ticks);
}

static void say(const char *text)
{
    for (const char *c = text; *c != '\0'; c++) {
        USART1.SR = USART_SR_RXNE;
        USART1.DR = (uint8_t)*c;
        USART1_IRQHandler();
    }
    USART1.SR = USART_SR_TXE;
}

static void simulate(void)
{
    /* SimTime: tick 5, power. */
    say(sleeps == 1U ? "S8\rO\r" : sleeps == 2U ? "t7F080500000001000000\r" : "");
}

static void test_strapped_and_without_can_it_is_in_lockstep(void)
{
    GPIOE.IDR = 0;
    fake.can_join = FAKE_NEVER;
    run_firmware(simulate, 20);
    TEST_ASSERT_TRUE(serial.slcan.open);
    TEST_ASSERT_EQUAL_UINT32(1, ticks);
    TEST_ASSERT_EQUAL_UINT32(5, node.last_tick);
    TEST_ASSERT_EQUAL_HEX32(FED, IWDG.KR);
    TEST_ASSERT_NULL(node.ecu.internal.reset_report);
}

/* In ticks of the crystal's clock; the fastest oscillator of the watchdog runs at 1.5 times its nominal rate. */
static void test_the_slow_timer_notices_late_samples_but_in_lockstep_only_feeds_the_watchdog(void)
{
    const uint32_t tick = jp_clock_core_hz(JP_CLOCK_CRYSTAL) / jp_firmware_tick_rate();

    run_firmware(nothing, 1);
    TEST_ASSERT_EQUAL_UINT32(tick / 2U, SYSTICK.RVR + 1U);
    GPIOE.IDR = 0;
    run_firmware(nothing, 1);
    TEST_ASSERT_EQUAL_UINT32(tick / 2U, SYSTICK.RVR + 1U);
    fake.can_join = FAKE_NEVER;
    run_firmware(simulate, 1);
    TEST_ASSERT_EQUAL_UINT32(5U * tick, SYSTICK.RVR + 1U);
    TEST_ASSERT_TRUE(3U * (SYSTICK.RVR + 1U) < 2U * JP_WATCHDOG_TICKS * tick);
}

static void order_by_line(void)
{
    const struct jp_can_frame frame = operator_command(++command_counter & 15U, JP_MODE_STAND, 0);
    char line[JP_SLCAN_LINE_MAX + 1U];

    if (sleeps == 1U) {
        say("S8\rO\r");
    }
    if (sleeps % 100U == 50U) {
        line[jp_slcan_encode(line, &frame)] = '\0';
        say(line);
    } else {
        command_counter--;
    }
    sample();
}

static void test_without_can_the_operator_is_on_the_line(void)
{
    fake.can_join = FAKE_NEVER;
    run_firmware(order_by_line, 400);
    TEST_ASSERT_EQUAL_INT(JP_ROBOT_BALANCING, jp_robot_state_now(&balancer.robot));
    TEST_ASSERT_TRUE(bridges_are_on());
}
