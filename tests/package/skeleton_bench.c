/**
 * Runs hal/skeleton/main.c on a host: its calls of the board are wrapped by the linker, so that functions can be filled
 * in one after the other and the bridges be watched. Argument: one letter for each that is filled in.
 *   s start, t ticks, r read, w write, o operator's switch on, d the ticks die half-way
 * Prints for how many ticks the bridges were commanded on and whether at the end, at which rate the ticks came and how
 * often the watchdog was fed, and ends after some seconds of ticks.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/skeleton/board.h"

#define TICKS 3000U

enum jp_status __wrap_board_start(void);
enum jp_status __wrap_board_start_ticks(uint32_t rate);
enum jp_status __wrap_board_read(void *context, struct jp_sensors *sensors);
enum jp_status __wrap_board_write(void *context, const struct jp_actuation *actuation);
bool __wrap_board_is_switched_on(void);
void __wrap_board_wait(void);
void __wrap_board_feed_watchdog(void);
enum jp_status __real_board_start(void);
enum jp_status __real_board_start_ticks(uint32_t rate);
enum jp_status __real_board_read(void *context, struct jp_sensors *sensors);
enum jp_status __real_board_write(void *context, const struct jp_actuation *actuation);
bool __real_board_is_switched_on(void);
int __real_main(void);
int __wrap_main(int argc, char **argv);

static const char *filled_in;
static uint32_t waits;
static uint32_t meals;
static uint32_t tick_rate;
static uint32_t ticks_on;
static bool on;

static bool is_filled_in(char function)
{
    return strchr(filled_in, function) != NULL;
}

enum jp_status __wrap_board_start(void)
{
    const enum jp_status unfilled = __real_board_start();

    return is_filled_in('s') ? JP_OK : unfilled;
}

enum jp_status __wrap_board_start_ticks(uint32_t rate)
{
    if (!is_filled_in('t')) {
        return __real_board_start_ticks(rate);
    }
    tick_rate = rate;
    return JP_OK;
}

/** Upright and at rest, with noise in the last bit. */
enum jp_status __wrap_board_read(void *context, struct jp_sensors *sensors)
{
    const jp_q24 noise = (jp_q24)(waits & 1U);

    if (!is_filled_in('r')) {
        return __real_board_read(context, sensors);
    }
    *sensors = (struct jp_sensors){.pitch_rate = noise,
                                   .yaw_rate = noise,
                                   .accel_x = noise,
                                   .accel_z = JP_Q24_ONE + noise,
                                   .bus_voltage = JP_Q16(24)};
    return JP_OK;
}

enum jp_status __wrap_board_write(void *context, const struct jp_actuation *actuation)
{
    on = actuation->enabled != 0U;
    ticks_on += actuation->enabled;
    return is_filled_in('w') ? JP_OK : __real_board_write(context, actuation);
}

bool __wrap_board_is_switched_on(void)
{
    return is_filled_in('o') || __real_board_is_switched_on();
}

void __wrap_board_feed_watchdog(void)
{
    meals++;
}

void __wrap_board_wait(void)
{
    if (++waits > TICKS) {
        printf("{\"ticks_on\": %u, \"end\": \"%s\", \"rate_hz\": %u, \"fed\": %u}\n", (unsigned)ticks_on,
               on ? "on" : "off", (unsigned)tick_rate, (unsigned)meals);
        exit(EXIT_SUCCESS);
    }
    if (tick_rate != 0U && !(is_filled_in('d') && waits > TICKS / 2U)) {
        control_tick();
    }
}

int __wrap_main(int argc, char **argv)
{
    filled_in = argc > 1 ? argv[1] : "";
    return __real_main();
}
