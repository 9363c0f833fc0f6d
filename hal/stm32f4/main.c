/**
 * The firmware of one robot on the STM32F405.
 *
 *   control interrupt  every 1 ms: sample in, duties out, telemetry            jp_ecu_tick()
 *   main loop          after each tick: commands, routes, maps, planning       jp_ecu_work()
 *
 * The operator is on CAN or, where the controller for it has no bus, on the serial line as SLCAN. With the strap set
 * sensors and bridges are simulated there too: on CAN in real time, on the serial line in lockstep.
 */
#include "hal/app/lockstep.h"
#include "hal/cortex_m/cortex_m.h"
#include "hal/cortex_m/fault.h"
#include "hal/firmware/firmware_robot.h"
#include "hal/stm32f4/devices.h"
#include "hal/stm32f4/flash.h"
#include "hal/stm32f4/interrupts.h"
#include "hal/stm32f4/serial.h"
#include "hal/stm32f4/supervision.h"
#include "hal/stm32f4/timer.h"
#include "hal/storage/parameters.h"

#define SERIAL_BAUD 1000000U

/** The slow timer wakes the main loop and notices that no sample comes: so often in a tick. */
#define SLOW_TIMER_SHARE 2U

/** In lockstep no sample is late: it only wakes the main loop to feed the watchdog, after so many ticks. */
#define LOCKSTEP_WAKE (JP_WATCHDOG_TICKS / 2U)

/** Without a sample for so long the tick goes on without it, in half periods of the tick. */
#define SAMPLE_LATE 3U

/** A start that took longer is too long to go on in motion. */
#define SHORT_START_US 40000U

static struct jp_devices devices;
static struct jp_serial serial;
static struct jp_lockstep node;
static struct jp_reset_report reset_report;
static struct jp_flash flash;
static struct jp_store store;
static struct jp_parameters parameters; /**< as stored */
static enum jp_stored stored;           /**< what the start found of them */
#ifdef FIRMWARE_NAVIGATES
static struct jp_navigation navigation;
static struct jp_navigation_block planner_block;
__attribute__((section(".ccm"))) static struct jp_navigation_ground ground;
#endif
__attribute__((section(".noinit"))) static struct jp_retained retained;

/** Control ticks since the start; written by the control interrupt. */
static volatile uint32_t ticks;

/** Half periods since the last sample on CAN, where samples come from there. */
static volatile uint32_t sample_age;

static bool has_simulated_body(void)
{
    return devices.on_bus;
}

/** Body and time are simulated at the other end of the serial line. */
static bool is_in_lockstep(void)
{
    return has_simulated_body() && !devices.has_can;
}

/* Interrupts. Control, CAN and the slow timer have one priority. */

void DMA2_Stream0_IRQHandler(void)
{
    if (!has_simulated_body()) {
        jp_devices_on_imu(&devices);
    }
    jp_ecu_tick(&node.ecu);
    jp_fault_tick = node.ecu.tick;
    ticks++;
}

void ADC_IRQHandler(void)
{
    if (jp_devices_on_sample(&devices)) {
        jp_nvic_pend(CONTROL_IRQ);
    }
}

void CAN1_RX0_IRQHandler(void)
{
    jp_can_controller_on_receive(&devices.can);
}

void CAN1_TX_IRQHandler(void)
{
    jp_can_controller_on_transmit(&devices.can);
}

void CAN1_SCE_IRQHandler(void)
{
    jp_can_controller_on_error(&devices.can);
}

void USART1_IRQHandler(void)
{
    jp_serial_on_receive(&serial);
}

void SysTick_Handler(void)
{
    if (has_simulated_body() && devices.has_can && ++sample_age == SAMPLE_LATE) {
        sample_age = 1;
        jp_nvic_pend(CONTROL_IRQ);
    }
}

/** The crystal has failed: nothing has the frequency that it was started for. The start takes another clock. */
void NMI_Handler(void)
{
    jp_bridges_off();
    (void)jp_clock_on_failure();
    jp_system_reset();
}

/** The supply fails: bridges off while there is voltage to do it, and a reset when it has come back. */
void PVD_IRQHandler(void)
{
    jp_bridges_off();
    while (jp_supply_is_low()) {
    }
    jp_system_reset();
}

/** In the CAN receive interrupt. */
static void take_frame(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    if (jp_ecu_accept(&node.ecu, frame) && has_simulated_body()) {
        sample_age = 0;
        jp_nvic_pend(CONTROL_IRQ);
    }
}

/** Returns after the tick, which interrupts the caller. */
static void tick_in_interrupt(struct jp_ecu *ecu)
{
    (void)ecu;
    jp_nvic_pend(CONTROL_IRQ);
    jp_finish_writes();
}

/* Start. */

static void start_slow_timer(uint32_t core_hz)
{
    const uint32_t rate = jp_firmware_tick_rate();

    SYSTICK.RVR = (is_in_lockstep() ? core_hz / rate * LOCKSTEP_WAKE : core_hz / (SLOW_TIMER_SHARE * rate)) - 1U;
    SYSTICK.CVR = 0;
    SYSTICK.CSR = SYSTICK_CLKSOURCE | SYSTICK_TICKINT | SYSTICK_ENABLE;
}

/** What the timers counted during the reset is lost; they go on from the counts of the record. */
static void resume_encoders(void)
{
    devices.encoders.count_left = jp_ecu_first_count_left(&node.ecu);
    devices.encoders.count_right = jp_ecu_first_count_right(&node.ecu);
}

static void load_parameters(void)
{
    const uint8_t *record = NULL;
    uint16_t length = 0;

    flash = jp_flash_interface();
    (void)jp_store_open(&store, &flash);
    (void)jp_store_read(&store, &record, &length);
    stored = jp_parameters_start(&parameters, jp_firmware_identity(), record, length);
}

/** The time runs from when the clock has started; waiting for a crystal that does not come takes too long, too. */
static bool was_short_start(void)
{
    return devices.clock == JP_CLOCK_CRYSTAL && jp_timer_us() < SHORT_START_US;
}

static bool may_go_on(void)
{
    return reset_report.may_go_on && (has_simulated_body() || was_short_start());
}

static enum jp_status boot(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    struct jp_firmware_start start = {.port = port, .retained = &retained, .parameters = &parameters, .stored = stored};

    (void)context;
#ifdef FIRMWARE_NAVIGATES
    const struct jp_navigation_config config =
        jp_navigation_config_of(&FIRMWARE_LATTICE, &FIRMWARE_NAVIGATION, &ground, &planner_block);

    start.navigation = &navigation;
    start.navigation_config = &config;
#endif
    return jp_firmware_boot(ecu, &start, field);
}

static bool start_application(void)
{
    const char *field;
    struct jp_lockstep_config config = {
        .boot = boot, .tick = tick_in_interrupt, .bus = jp_can_controller_port(&devices.can), .retained = &retained};

    if (!devices.has_can) {
        jp_serial_port(&serial, &config.bus);
    }
    if (!may_go_on()) {
        retained = (struct jp_retained){0};
    }
    if (jp_lockstep_start(&node, &config, &field) != JP_OK) {
        return false;
    }
    if (!has_simulated_body()) {
        const struct jp_hal hal = jp_devices_hal(&devices);

        resume_encoders();
        jp_ecu_use_board(&node.ecu, &hal);
        jp_firmware_know_gyro_bias(parameters.gyro_bias);
    }
    return true;
}

static void start_interrupts(void)
{
    SCB.SHPR[SHPR_SYSTICK] = NVIC_PRIORITY(PRIORITY_CONTROL);
    jp_nvic_enable(PVD_IRQn, PRIORITY_SUPPLY);
    jp_nvic_enable(USART1_IRQn, PRIORITY_SERIAL);
    jp_nvic_enable(ADC_IRQn, PRIORITY_CONTROL);
    jp_nvic_enable(CONTROL_IRQ, PRIORITY_CONTROL);
    jp_nvic_enable(CAN1_RX0_IRQn, PRIORITY_CONTROL);
    jp_nvic_enable(CAN1_TX_IRQn, PRIORITY_CONTROL);
    jp_nvic_enable(CAN1_SCE_IRQn, PRIORITY_CONTROL);
}

/* The main loop. */

static void sleep(void)
{
    const bool is_quiet = jp_serial_flush(&serial);

    jp_interrupts_off();
    if (is_quiet && !jp_serial_has_input(&serial)) {
        jp_wait_for_interrupt();
    }
    jp_interrupts_on();
}

static _Noreturn void run_lockstep(void)
{
    struct jp_can_frame frame;

    for (;;) {
        while (jp_serial_receive(&serial, &frame)) {
            (void)jp_lockstep_accept(&node, &frame);
        }
        jp_watchdog_feed();
        sleep();
    }
}

static void take_serial_frames(void)
{
    struct jp_can_frame frame;

    while (!devices.has_can && jp_serial_receive(&serial, &frame)) {
        jp_interrupts_off();
        (void)jp_ecu_accept(&node.ecu, &frame);
        jp_interrupts_on();
    }
}

/** What was learned. A write may stop the core for half a second: motors off. */
static void keep_parameters(void)
{
    const struct jp_learned_state *energy = jp_ecu_learned_state(&node.ecu);
    struct jp_parameters learned = parameters;
    const char *field;

    if (energy != NULL) {
        learned.energy = *energy;
    }
    learned.gyro_bias = jp_firmware_gyro_bias();
    learned.gyro_scale = jp_firmware_gyro_scale();
    learned.current_zero_left = devices.analog.zero_left;
    learned.current_zero_right = devices.analog.zero_right;
    if (!jp_parameters_differ(&learned, &parameters)) {
        return;
    }
    jp_watchdog_relax();
    if (jp_parameters_save(&learned, jp_firmware_identity(), &store, &field) == JP_OK) {
        parameters = learned;
    }
    jp_watchdog_tighten(jp_firmware_tick_rate());
}

/** Once each time that the running motors were switched off: after a fault nothing that was learned is trusted. */
static void watch_for_rest(void)
{
    static bool ran;

    if (has_simulated_body()) {
        return;
    }
    if (jp_ecu_state_now(&node.ecu) == JP_ECU_IDLE && ran) {
        keep_parameters();
    }
    ran = jp_ecu_runs(&node.ecu);
}

/** The watchdog is fed only when the tick came and the work was done. */
static _Noreturn void run(void)
{
    uint32_t worked = ticks;
    bool forgiven = false;
    const uint32_t healthy_ticks = JP_HEALTHY_MS / 1000U * jp_firmware_tick_rate();

    for (;;) {
        take_serial_frames();
        if (worked != ticks) {
            worked = ticks;
            jp_ecu_work(&node.ecu);
            watch_for_rest();
            jp_watchdog_feed();
            if (worked >= healthy_ticks && !forgiven) {
                jp_post_mortem_forgive(&jp_post_mortem);
                forgiven = true;
            }
        }
        sleep();
    }
}

/** A robot whose configuration is refused does nothing. */
static _Noreturn void stay_off(void)
{
    for (;;) {
        jp_bridges_off();
        jp_watchdog_feed();
    }
}

int main(void)
{
    jp_post_mortem_open(&jp_post_mortem, jp_reset_cause(), &reset_report);
    jp_devices_start(&devices, jp_firmware_tick_rate(), take_frame, NULL);
    jp_serial_start(&serial, jp_clock_frequencies(devices.clock).apb2, SERIAL_BAUD);
    load_parameters();
    jp_supply_watch();
    jp_watchdog_start(jp_firmware_tick_rate());
    if (!start_application()) {
        stay_off();
    }
    start_slow_timer(jp_clock_core_hz(devices.clock));
    start_interrupts();
    if (is_in_lockstep()) {
        run_lockstep();
    }
    jp_ecu_report_reset(&node.ecu, &reset_report);
    run();
}
