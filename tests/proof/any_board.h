/** A board (hal.h) that reads anything and whose bridges answer or do not. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_BOARD_H
#define JOULEPATH_TESTS_PROOF_ANY_BOARD_H

#include "hal/hal.h"
#include "tests/proof/any.h"

static enum jp_status any_reading(void)
{
    return any_bool() ? JP_OK : any_bool() ? JP_HELD : JP_ERR_HARDWARE;
}

static enum jp_status board_reads(void *context, struct jp_sensors *sensors)
{
    (void)context;
    ANY(*sensors);
    return any_reading();
}

static enum jp_status board_writes(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    (void)actuation;
    return any_bool() ? JP_OK : JP_ERR_HARDWARE;
}

static const struct jp_hal any_board = {.read = board_reads, .write = board_writes};

#endif
