/**
 * The firmware of a robot with four steered wheels on a Cortex-M7: processor in the loop, for which wheels, scanner and
 * time are simulated at the other end of the serial line.
 *
 *   UART interrupt     bytes
 *   PendSV             every tick of 10 ms: sample in, set-points out, telemetry       jp_ecu_tick()
 *   main loop          frames; after each tick: scans, localiser, planner, band        jp_ecu_work()
 */
#include <joulepath/tables.h>

#include "hal/app/lockstep.h"
#include "hal/app/patrol_memory.h"
#include "hal/mps2/mps2_an500.h"
#include "hal/mps2/uart.h"

#ifndef FIRMWARE_PATROL_NAME
#error "FIRMWARE_PATROL_NAME is set by the Makefile"
#endif

#define ROBOT_JOIN(prefix, name)   prefix##name
#define ROBOT_SYMBOL(prefix, name) ROBOT_JOIN(prefix, name)

#define SERIAL_BAUD 1000000U

/** The more urgent the smaller. */
#define PRIORITY_SERIAL  0x40U
#define PRIORITY_CONTROL 0x80U

static struct jp_lockstep node;
static struct jp_ecu_patrol patrol;
static struct jp_navigation navigation;
static struct jp_patrol_map map;
static struct jp_patrol_block block;
__attribute__((section(".noinit"))) static struct jp_retained retained;

static const struct jp_patrol_pilot_config tables = {
    .patrol = &ROBOT_SYMBOL(jp_patrol_config_, FIRMWARE_PATROL_NAME),
    .localiser = &ROBOT_SYMBOL(jp_localiser_config_, FIRMWARE_PATROL_NAME),
    .scanner = &ROBOT_SYMBOL(jp_patrol_scanner_, FIRMWARE_PATROL_NAME),
    .energy = &ROBOT_SYMBOL(jp_four_wheel_energy_, FIRMWARE_PATROL_NAME),
    .learning = &ROBOT_SYMBOL(jp_four_wheel_learning_, FIRMWARE_PATROL_NAME),
    .points_max = JP_PATROL_POINTS_MAX,
    .turns_max = JP_PATROL_TURNS_MAX,
};

static enum jp_status boot(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    const struct jp_ecu_patrol_config config = {.robot = &ROBOT_SYMBOL(jp_four_wheel_robot_, FIRMWARE_PATROL_NAME),
                                                .pilot = &tables,
                                                .block = block.words,
                                                .size = sizeof block.words,
                                                .stored = JP_STORED_NOTHING};
    const struct jp_map_room room = jp_patrol_map_room(&map);
    struct jp_ecu_robot robot;
    enum jp_status status = jp_ecu_patrol_init(&patrol, &config, &robot, field);

    (void)context;
    if (status == JP_OK) {
        status = jp_ecu_init(ecu, &robot, port, &retained);
    }
    if (status == JP_OK) {
        const struct jp_wayfinder finder = jp_ecu_patrol_wayfinder(&patrol);

        status = jp_navigation_init_with(&navigation, &finder, &room);
        jp_ecu_navigate(ecu, &navigation);
    }
    return status;
}

void PendSV_Handler(void);

void PendSV_Handler(void)
{
    jp_ecu_tick(&node.ecu);
}

/** Returns after the tick, which interrupts the caller. */
static void tick_in_interrupt(struct jp_ecu *ecu)
{
    (void)ecu;
    MPS2_SCB.ICSR = MPS2_ICSR_PENDSVSET;
    __asm__ volatile("dsb\nisb" ::: "memory");
}

static void sleep(void)
{
    const bool is_quiet = jp_uart_flush();

    __asm__ volatile("cpsid i" ::: "memory");
    if (is_quiet && !jp_uart_has_input()) {
        __asm__ volatile("wfi" ::: "memory");
    }
    __asm__ volatile("cpsie i" ::: "memory");
}

int main(void)
{
    const struct jp_lockstep_config config = {
        .boot = boot, .tick = tick_in_interrupt, .bus = jp_uart_port(), .retained = &retained};
    struct jp_can_frame frame;
    const char *field;

    MPS2_SCB.SHPR[SHPR_PENDSV] = PRIORITY_CONTROL;
    NVIC_IPR[UART0_RX_IRQn] = PRIORITY_SERIAL;
    jp_uart_start(SERIAL_BAUD);
    /* A robot whose configuration is refused does nothing: the drives have got no set-points. */
    while (jp_lockstep_start(&node, &config, &field) != JP_OK) {
    }
    for (;;) {
        while (jp_uart_receive(&frame)) {
            (void)jp_lockstep_accept(&node, &frame);
        }
        sleep();
    }
}
