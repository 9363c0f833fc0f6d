/**
 * The last crash, in memory that start-up does not clear (a .noinit section), and whether the robot may go on after it.
 *
 * The fault handler switches the bridges off, writes the record and resets. A start after a crash goes on as after any
 * reset in motion, but JP_CRASHES_MAX crashes with less than JP_HEALTHY_MS between them end that: the robot stays off
 * until it is commanded again.
 */
#ifndef JOULEPATH_HAL_STORAGE_POST_MORTEM_H
#define JOULEPATH_HAL_STORAGE_POST_MORTEM_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Crashes in a row after which the robot does not go on by itself. */
#define JP_CRASHES_MAX 3U

/** Without a crash for so long the next one is the first. */
#define JP_HEALTHY_MS 10000U

enum jp_reset_cause {
    JP_RESET_POWER_ON,
    JP_RESET_BROWN_OUT, /**< the supply was too low for the controller: counts as a crash, its load may come again */
    JP_RESET_PIN,
    JP_RESET_SOFTWARE, /**< asked for, not a crash */
    JP_RESET_WATCHDOG, /**< tick or background work failed to come: a crash */
    JP_RESET_FAULT,    /**< an exception of the core or an unexpected interrupt: a crash */
    JP_RESET_STACK     /**< a stack overflow: a crash */
};

/** What the fault handler knows. 0 where it does not apply. */
struct jp_crash {
    enum jp_reset_cause cause; /**< JP_RESET_FAULT or JP_RESET_STACK */
    uint32_t exception;        /**< number of the exception */
    uint32_t pc;               /**< instruction at fault */
    uint32_t lr;
    uint32_t psr;
    uint32_t status;  /**< the core's fault status (Cortex-M: CFSR) */
    uint32_t address; /**< of the access at fault */
    uint32_t tick;    /**< of the application */
};

/** The record; its memory is not cleared by start-up. */
struct jp_post_mortem {
    struct jp_crash crash;
    uint32_t pending; /**< the crash is of this reset */
    uint32_t crashes; /**< in a row */
    uint32_t check;   /**< sum of all words before it */
};

/** What a start knows of the reset before it. */
struct jp_reset_report {
    enum jp_reset_cause cause;
    uint32_t crashes;      /**< in a row, this reset included; saturates at 255 */
    struct jp_crash crash; /**< the last one since power-on, zero if there was none */
    bool may_go_on;        /**< the robot may take up what it did before the reset */
};

/** Writes the record. For the fault handler: needs little stack, and nothing but the record. */
void jp_post_mortem_write(struct jp_post_mortem *record, const struct jp_crash *crash);

/** At start: `cause` is what the reset controller says. A record that is not whole counts as none. */
void jp_post_mortem_open(struct jp_post_mortem *record, enum jp_reset_cause cause, struct jp_reset_report *report);

/** JP_HEALTHY_MS have passed without a crash. */
void jp_post_mortem_forgive(struct jp_post_mortem *record);

#ifdef __cplusplus
}
#endif

#endif
