/**
 * A balancer on a board of your own. The interrupt controls, the loop plans and feeds the watchdog; after a fall or a
 * fault the operator switches off and on again.
 */
#include <joulepath/pilot.h>
#include <joulepath/tables.h>

#include <stddef.h>

#include "hal/skeleton/board.h"

static const struct jp_hal hal = {NULL, board_read, board_write};
static struct jp_robot robot;
static struct jp_pilot pilot; /**< jp_pilot_follow() gives it a route */
static enum jp_status written = JP_OK;
static bool ticked; /**< since the loop looked last */

void control_tick(void)
{
    jp_hal_tick(&hal, &robot, &written);
    __atomic_store_n(&ticked, true, __ATOMIC_RELEASE);
}

/** The watchdog is not fed here, so its reset tries again. */
static _Noreturn void stay_off(void)
{
    board_bridges_off();
    for (;;) {
        board_wait();
    }
}

static void obey_operator(void)
{
    if (board_is_switched_on()) {
        (void)jp_robot_enable(&robot); /* refused unless idle, upright and with good sensors: asked again next time */
    } else {
        jp_robot_disable(&robot);
    }
}

int main(void)
{
    static const struct jp_pilot_config driving = {.model = &jp_energy_model_courier24,
                                                   .learning = &jp_learning_courier24};
    const char *field = "";

    if (board_start() != JP_OK || jp_robot_init(&robot, &jp_robot_courier24, &field) != JP_OK ||
        jp_pilot_init(&pilot, &driving, &robot, &field) != JP_OK ||
        board_start_ticks(jp_robot_courier24.estimator.tick_rate) != JP_OK) {
        stay_off();
    }
    for (;;) {
        board_wait();
        if (__atomic_load_n(&ticked, __ATOMIC_ACQUIRE)) {
            __atomic_store_n(&ticked, false, __ATOMIC_RELAXED);
            obey_operator();
            (void)jp_pilot_work(&pilot);
            board_feed_watchdog();
        }
    }
}
