/** A link that loses frames of one kind on their way to the ECU, for tests of the bus. */
#ifndef JOULEPATH_TESTS_SUPPORT_FRAME_THIEF_H
#define JOULEPATH_TESTS_SUPPORT_FRAME_THIEF_H

#include <stdbool.h>

#include "hal/linux/can_link.h"

/* Of frames of this id the next ones that arrive at the ECU are lost. */
static struct {
    struct jp_can_link inner;
    uint32_t id;
    unsigned count;
    unsigned every; /* of them one is lost; 0: all */
    unsigned seen;
} thief;

static inline enum jp_status thief_send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    if (frame->id == thief.id && thief.count > 0) {
        thief.seen++;
        if (thief.every == 0 || thief.seen % thief.every == 0) {
            thief.count--;
            return JP_OK;
        }
    }
    return thief.inner.port.send(thief.inner.port.context, frame);
}

static inline bool thief_receive(void *context, struct jp_can_frame *frame)
{
    (void)context;
    return thief.inner.receive(thief.inner.port.context, frame);
}

static inline bool thief_wait(void *context, int64_t timeout_us)
{
    (void)context;
    return thief.inner.wait(thief.inner.port.context, timeout_us);
}

static inline enum jp_can_state thief_state(void *context)
{
    (void)context;
    return thief.inner.port.state(thief.inner.port.context);
}

/** Frames on the link pass the thief from now on, who takes none yet. */
static inline void thief_enter(struct jp_can_link *link)
{
    thief.inner = *link;
    thief.count = 0;
    link->port.send = thief_send;
    link->port.state = thief_state;
    link->receive = thief_receive;
    link->wait = thief_wait;
}

/** So many frames of this id, of each `every` one; 0: all. */
static inline void thief_steal(uint32_t id, unsigned count, unsigned every)
{
    thief.id = id;
    thief.count = count;
    thief.every = every;
    thief.seen = 0;
}

#endif
