/**
 * The firmware of one robot on Arm's MPS2 board with a Cortex-M7. Sensors and bridges are on the bus, as the operator
 * is: SLCAN on the serial line.
 *
 *   UART interrupt     bytes
 *   timer interrupt    twice a tick: a tick is due
 *   PendSV             the tick: sample in, duties or set-points out, telemetry        jp_ecu_tick()
 *   main loop          frames; after each tick: commands, routes, maps, planning      jp_ecu_work()
 *
 * The image for the emulator is the same, but its time is the simulator's: processor in the loop.
 */
#include "hal/app/lockstep.h"
#include "hal/cortex_m/cortex_m.h"
#include "hal/cortex_m/fault.h"
#include "hal/firmware/firmware_robot.h"
#include "hal/mps2/mps2_an500.h"
#include "hal/mps2/supervision.h"
#include "hal/mps2/timer.h"
#include "hal/mps2/uart.h"
#include "hal/storage/parameters.h"

#define SERIAL_BAUD 1000000U

/** The smaller the more urgent; neither of control and timer interrupts the other. */
#define PRIORITY_SERIAL  1U
#define PRIORITY_CONTROL 2U

/** The timer's periods in a tick, and how many after the last sample the tick goes on without one. */
#define TIMER_SHARE 2U
#define SAMPLE_LATE 3U

/** Its address is set by the linker: 1 where time is the simulator's. */
extern uint8_t firmware_lockstep[];

static struct jp_lockstep node;
static struct jp_reset_report reset_report;
static struct jp_parameters parameters; /**< none is stored: there is no flash */
#ifdef FIRMWARE_NAVIGATES
static struct jp_navigation navigation;
static struct jp_navigation_block planner_block;
static struct jp_navigation_ground ground;
#endif
__attribute__((section(".noinit"))) static struct jp_retained retained;

/** Control ticks since the start; written by the control interrupt. */
static volatile uint32_t ticks;

/** Periods of the timer since the last sample. */
static volatile uint32_t sample_age;

static bool is_in_lockstep(void)
{
    return (uintptr_t)firmware_lockstep == 1U;
}

/** They are on the bus, and switch themselves off. */
void jp_bridges_off(void)
{
}

/* Interrupts. */

void PendSV_Handler(void);
void TIMER0_Handler(void);

void PendSV_Handler(void)
{
    jp_ecu_tick(&node.ecu);
    jp_fault_tick = node.ecu.tick;
    ticks++;
}

static void pend_tick(void)
{
    SCB.ICSR = ICSR_PENDSVSET;
}

void TIMER0_Handler(void)
{
    jp_timer_clear();
    sample_age++;
    if (sample_age == SAMPLE_LATE) {
        sample_age = SAMPLE_LATE - TIMER_SHARE;
        pend_tick();
    }
}

/** Returns after the tick, which interrupts the caller. */
static void tick_in_interrupt(struct jp_ecu *ecu)
{
    (void)ecu;
    pend_tick();
    jp_finish_writes();
}

/* Start. */

static enum jp_status boot(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    struct jp_firmware_start start = {
        .port = port, .retained = &retained, .parameters = &parameters, .stored = JP_STORED_NOTHING};

    (void)context;
#ifdef FIRMWARE_NAVIGATES
    const struct jp_navigation_config config =
        jp_navigation_config_of(&FIRMWARE_LATTICE, &FIRMWARE_NAVIGATION, &ground, &planner_block);

    start.navigation = &navigation;
    start.navigation_config = &config;
#endif
    return jp_firmware_boot(ecu, &start, field);
}

static enum jp_status start_application(void)
{
    const struct jp_lockstep_config config = {
        .boot = boot, .tick = tick_in_interrupt, .bus = jp_uart_port(), .retained = &retained};
    const char *field;

    if (!reset_report.may_go_on) {
        retained = (struct jp_retained){0};
    }
    return jp_lockstep_start(&node, &config, &field);
}

/* The main loop. */

static void sleep(void)
{
    const bool is_quiet = jp_uart_flush();

    jp_interrupts_off();
    if (is_quiet && !jp_uart_has_input()) {
        jp_wait_for_interrupt();
    }
    jp_interrupts_on();
}

static _Noreturn void run_lockstep(void)
{
    struct jp_can_frame frame;

    for (;;) {
        while (jp_uart_receive(&frame)) {
            (void)jp_lockstep_accept(&node, &frame);
        }
        sleep();
    }
}

/** A frame that completes a sample is followed by the tick. */
static void take_frames(void)
{
    struct jp_can_frame frame;

    while (jp_uart_receive(&frame)) {
        jp_interrupts_off();
        if (jp_ecu_accept(&node.ecu, &frame)) {
            sample_age = 0;
            pend_tick();
        }
        jp_interrupts_on();
    }
}

/** The watchdog is fed only when the tick came and the work was done. */
static _Noreturn void run(void)
{
    const uint32_t rate = jp_ecu_tick_rate(&node.ecu);
    uint32_t worked = ticks;
    bool forgiven = false;

    for (;;) {
        take_frames();
        if (worked != ticks) {
            worked = ticks;
            jp_ecu_work(&node.ecu);
            jp_watchdog_feed();
            if (worked >= JP_HEALTHY_MS / 1000U * rate && !forgiven) {
                jp_post_mortem_forgive(&jp_post_mortem);
                forgiven = true;
            }
        }
        sleep();
    }
}

/** A robot whose configuration is refused does nothing: no bridge gets a command. */
static _Noreturn void stay_off(void)
{
    for (;;) {
        jp_wait_for_interrupt();
    }
}

int main(void)
{
    jp_post_mortem_open(&jp_post_mortem, jp_reset_cause(&jp_post_mortem), &reset_report);
    SCB.SHPR[SHPR_PENDSV] = NVIC_PRIORITY(PRIORITY_CONTROL);
    jp_nvic_enable(UART0_RX_IRQn, PRIORITY_SERIAL);
    jp_uart_start(SERIAL_BAUD);
    if (start_application() != JP_OK) {
        stay_off();
    }
    if (is_in_lockstep()) {
        run_lockstep();
    }
    jp_ecu_report_reset(&node.ecu, &reset_report);
    jp_watchdog_start();
    jp_timer_start(TIMER_SHARE * jp_ecu_tick_rate(&node.ecu));
    jp_nvic_enable(TIMER0_IRQn, PRIORITY_CONTROL);
    run();
}
