/**
 * The record that outlives a reset, in memory that start-up does not clear (a .noinit section; a file on a host).
 *
 * Two slots are written in turn, so that a reset in the middle of a write leaves the other one.
 */
#ifndef JOULEPATH_HAL_APP_RETAINED_H
#define JOULEPATH_HAL_APP_RETAINED_H

#include <joulepath/four_wheel_robot.h>
#include <joulepath/robot.h>
#include <joulepath/skid_robot.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Whose snapshot it is. */
enum jp_retained_kind { JP_RETAINED_BALANCER = 1, JP_RETAINED_SKID, JP_RETAINED_FOUR_WHEEL };

union jp_retained_snapshot {
    struct jp_snapshot balancer;
    struct jp_skid_snapshot skid;
    struct jp_four_wheel_snapshot four_wheel;
};

struct jp_retained_slot {
    union jp_retained_snapshot snapshot;
    uint32_t kind;     /**< enum jp_retained_kind */
    uint32_t sequence; /**< one more in each write, wrapping */
    uint32_t resets;
    uint32_t check; /**< sum of all words before it; see retained.c */
};

struct jp_retained {
    struct jp_retained_slot slots[2];
};

/** The newest whole record, or NULL after power-on. */
const struct jp_retained_slot *jp_retained_newest(const struct jp_retained *retained);

/** Replaces the older slot. For the control ISR. */
void jp_retained_write(struct jp_retained *retained, enum jp_retained_kind kind,
                       const union jp_retained_snapshot *snapshot, uint32_t resets);

#ifdef __cplusplus
}
#endif

#endif
