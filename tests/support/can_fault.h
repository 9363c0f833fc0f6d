/**
 * A CAN link on which things go wrong: around any other link, for the tests and campaigns. Each fault acts in its span
 * of ticks on frames of its direction; the draws come from a seed, so a run repeats itself. SimTime and SimDone are
 * spared.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_CAN_FAULT_H
#define JOULEPATH_TESTS_SUPPORT_CAN_FAULT_H

#include <stddef.h>

#include "hal/linux/can_link.h"
#include "sim/base/random.h"

#define CAN_FAULTS_MAX    8
#define CAN_FAULT_WAITING 256

enum can_fault_kind {
    CAN_FAULT_LOSS,   /**< the frame does not arrive */
    CAN_FAULT_REPEAT, /**< it arrives twice */
    CAN_FAULT_DELAY,  /**< it arrives 1…strength ticks late, and so out of order */
    CAN_FAULT_FLIP,   /**< 1…strength bits of its data are flipped */
    CAN_FAULT_SWAP,   /**< it arrives after the frame that was sent next */
    CAN_FAULT_KINDS
};

enum can_fault_direction { CAN_FAULT_OUT = 1, CAN_FAULT_IN = 2, CAN_FAULT_BOTH = 3 };

struct can_fault {
    enum can_fault_kind kind;
    enum can_fault_direction direction; /**< as this end of the link sees it */
    double share;                       /**< of the frames, 0…1 */
    uint32_t strength;
    uint64_t from;  /**< tick */
    uint64_t until; /**< tick, exclusive */
};

/** A frame that waits for its tick, or for the next frame of its direction. */
struct can_fault_waiting {
    struct jp_can_frame frame;
    uint64_t due;
    bool until_next;
};

struct can_fault_line {
    struct can_fault_waiting waiting[CAN_FAULT_WAITING];
    size_t count;
};

struct can_fault_link {
    struct jp_can_link inner;
    struct random random;
    struct can_fault faults[CAN_FAULTS_MAX];
    size_t fault_count;
    uint64_t tick;
    struct can_fault_line out;
    struct can_fault_line in;
    uint64_t hits[CAN_FAULT_KINDS];
};

/** No faults yet. */
void can_fault_link_init(struct can_fault_link *link, const struct jp_can_link *inner, uint64_t seed);

/** False when there are CAN_FAULTS_MAX already. */
bool can_fault_link_add(struct can_fault_link *link, const struct can_fault *fault);

/** Time goes on: sends the frames that were held back until now. */
void can_fault_link_set_tick(struct can_fault_link *link, uint64_t tick);

struct jp_can_link can_fault_link(struct can_fault_link *link);

#endif
