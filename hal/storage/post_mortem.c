#include "hal/storage/post_mortem.h"

#include <stddef.h>

#include "hal/storage/memory_check.h"

/** Memory that was never written does not add up to this. */
#define CHECK_START 0x4A50504DU

#define CRASHES_SATURATED 255U

static uint32_t check_of(const struct jp_post_mortem *record)
{
    return jp_memory_check(CHECK_START, record, offsetof(struct jp_post_mortem, check));
}

/** Other memory may add up to it, too, but seldom holds what a record does. */
static bool is_whole(const struct jp_post_mortem *record)
{
    return record->check == check_of(record) && record->crashes <= CRASHES_SATURATED &&
           (uint32_t)record->crash.cause <= (uint32_t)JP_RESET_STACK;
}

static void count_crash(struct jp_post_mortem *record)
{
    if (record->crashes < CRASHES_SATURATED) {
        record->crashes++;
    }
}

void jp_post_mortem_write(struct jp_post_mortem *record, const struct jp_crash *crash)
{
    if (!is_whole(record)) {
        record->crashes = 0;
    }
    record->crash = *crash;
    record->pending = 1;
    count_crash(record);
    record->check = check_of(record);
}

/** A reset that the fault handler asked for has its cause in the record. */
static enum jp_reset_cause true_cause(const struct jp_post_mortem *record, enum jp_reset_cause cause)
{
    return cause == JP_RESET_SOFTWARE && record->pending != 0U ? record->crash.cause : cause;
}

void jp_post_mortem_open(struct jp_post_mortem *record, enum jp_reset_cause cause, struct jp_reset_report *report)
{
    if (cause == JP_RESET_POWER_ON || !is_whole(record)) {
        *record = (struct jp_post_mortem){.crashes = 0};
    }
    if (cause == JP_RESET_WATCHDOG || cause == JP_RESET_BROWN_OUT) {
        count_crash(record);
    }
    *report = (struct jp_reset_report){
        .cause = true_cause(record, cause),
        .crashes = record->crashes,
        .crash = record->crash,
        .may_go_on = record->crashes < JP_CRASHES_MAX,
    };
    record->pending = 0;
    record->check = check_of(record);
}

void jp_post_mortem_forgive(struct jp_post_mortem *record)
{
    record->crashes = 0;
    record->check = check_of(record);
}
