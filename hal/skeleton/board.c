/** Each function here is yours to fill in. As they stand, the robot does not switch on. */
#include "hal/skeleton/board.h"

enum jp_status board_start(void)
{
    board_bridges_off();
    return JP_ERR_HARDWARE;
}

enum jp_status board_start_ticks(uint32_t rate)
{
    (void)rate;
    return JP_ERR_HARDWARE;
}

enum jp_status board_read(void *context, struct jp_sensors *sensors)
{
    (void)context;
    *sensors = (struct jp_sensors){0};
    return JP_ERR_HARDWARE;
}

enum jp_status board_write(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    (void)actuation;
    board_bridges_off();
    return JP_ERR_HARDWARE;
}

void board_bridges_off(void)
{
}

bool board_is_switched_on(void)
{
    return false;
}

void board_wait(void)
{
}

void board_feed_watchdog(void)
{
}
