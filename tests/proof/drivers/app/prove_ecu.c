// eva: -eva-precision 0 -eva-auto-loop-unroll 64
/** A robot of any kind, with anything retained, sensors on the bus or the board's own, with or without a navigator that
 * goes round and a report of the last reset, in lockstep or not: any frames, ticks and slices of work in any order, for
 * ever. Navigators that do not go round, and cells, have drivers of their own. */
#include "hal/app/lockstep.h"
#include "tests/proof/any_board.h"
#include "tests/proof/any_finder.h"
#include "tests/proof/any_kind.h"
#include "tests/proof/any_port.h"

static struct jp_lockstep lockstep;
static struct jp_navigation navigation;
static struct jp_monitor_config monitor;
static struct jp_retained retained;
static struct jp_reset_report report;
static uint64_t block[64];

static enum jp_status boot(void *context, struct jp_ecu *ecu, const struct jp_can_port *port, const char **field)
{
    const struct jp_ecu_robot robot = {.kind = any_bool() ? &any_kind : &any_kind_of_its_own,
                                       .tick_rate = any_unsigned(9900U) + 100U,
                                       .monitor = &monitor};

    (void)context;
    *field = NULL;
    while (jp_ecu_init(ecu, &robot, port, any_bool() ? &retained : NULL) != JP_OK) {
        /* Nothing is null. */
    }
    if (any_bool()) {
        struct jp_hal board = any_board;

        board.context = ecu; /* not null, as the application's own context: the analyser takes either */
        jp_ecu_use_board(ecu, &board);
    }
    if (any_bool()) {
        jp_ecu_report_reset(ecu, &report);
    }
    if (any_bool()) {
        jp_ecu_navigate(ecu, &navigation);
    }
    return JP_OK;
}

static void take_frame(void)
{
    struct jp_can_frame frame;

    ANY(frame);
    frame.length = (uint8_t)any_unsigned(JP_CAN_LENGTH_MAX);
    (void)jp_lockstep_accept(&lockstep, &frame);
    (void)jp_ecu_accept(&lockstep.ecu, &frame);
}

static void look(const struct jp_ecu *ecu)
{
    struct jp_ecu_lessons lessons;

    (void)jp_ecu_learned_state(ecu);
    jp_ecu_read_lessons(ecu, &lessons);
    (void)jp_ecu_state_now(ecu);
    (void)jp_ecu_runs(ecu);
    (void)jp_ecu_lost_samples(ecu);
    (void)jp_ecu_first_count_left(ecu);
    (void)jp_ecu_first_count_right(ecu);
}

int main(void)
{
    const struct jp_lockstep_config config = {
        .boot = boot, .tick = jp_ecu_tick, .bus = any_port, .retained = &retained};
    const struct jp_map_room room = {.block = block, .size = sizeof block, .resolution = any_between(1, INT32_MAX)};
    const char *field;

    while (jp_navigation_init_with(&navigation, &any_finder, &room) != JP_OK) {
        /* Nothing is null. */
    }
    ANY(monitor);
    ANY(report);
    ANY(retained);
    if (jp_monitor_check(&monitor, &field) != JP_OK) {
        return 0;
    }
    while (jp_lockstep_start(&lockstep, &config, &field) != JP_OK) {
        /* Nothing is null. */
    }
    ANY_TIMES
    {
        take_frame();
        if (any_bool()) {
            jp_ecu_tick(&lockstep.ecu);
        }
        if (any_bool()) {
            jp_ecu_work(&lockstep.ecu);
        }
        look(&lockstep.ecu);
    }
    ARRIVED();
    return 0;
}
