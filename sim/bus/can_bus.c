#include "sim/bus/can_bus.h"

#include <assert.h>

void can_bus_init(struct can_bus *bus)
{
    bus->end_count = 0;
}

struct can_bus_end *can_bus_attach(struct can_bus *bus)
{
    assert(bus->end_count < CAN_BUS_ENDS);

    struct can_bus_end *end = &bus->ends[bus->end_count++];

    end->bus = bus;
    end->head = 0;
    end->count = 0;
    end->others = NULL;
    end->context = NULL;
    return end;
}

static void deliver(struct can_bus_end *end, const struct jp_can_frame *frame)
{
    if (end->count == CAN_BUS_QUEUE) {
        return;
    }
    end->queue[(end->head + end->count) % CAN_BUS_QUEUE] = *frame;
    end->count++;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct can_bus_end *from = context;
    struct can_bus *bus = from->bus;

    for (size_t i = 0; i < bus->end_count; i++) {
        if (&bus->ends[i] != from) {
            deliver(&bus->ends[i], frame);
        }
    }
    return JP_OK;
}

static enum jp_can_state state(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static bool receive(void *context, struct jp_can_frame *frame)
{
    struct can_bus_end *end = context;

    if (end->count == 0) {
        return false;
    }
    *frame = end->queue[end->head];
    end->head = (end->head + 1) % CAN_BUS_QUEUE;
    end->count--;
    return true;
}

static bool wait(void *context, int64_t timeout_us)
{
    struct can_bus_end *end = context;

    (void)timeout_us;
    if (end->count == 0 && end->others != NULL) {
        end->others(end->context);
    }
    return end->count > 0;
}

static void close_end(void *context)
{
    (void)context;
}

struct jp_can_link can_bus_link(struct can_bus_end *end)
{
    return (struct jp_can_link){
        .port = {.context = end, .send = send, .state = state}, .receive = receive, .wait = wait, .close = close_end};
}
