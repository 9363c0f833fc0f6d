#include "sim/bus/can_log.h"

#include <inttypes.h>

#define ID_MASK 0x1FFFFFFFU

static void write_frame(const struct can_log *log, const struct jp_can_frame *frame)
{
    const uint64_t time_us = (uint64_t)*log->tick * 1000000U / log->rate_hz;
    const bool extended = (frame->id & JP_CAN_EXTENDED) != 0U;
    const bool remote = (frame->id & JP_CAN_REMOTE) != 0U;

    (void)fprintf(log->stream, "(%010" PRIu64 ".%06" PRIu64 ") %s %0*" PRIX32 "#%s", time_us / 1000000U,
                  time_us % 1000000U, log->interface, extended ? 8 : 3, frame->id & ID_MASK, remote ? "R" : "");
    for (unsigned i = 0; i < frame->length && !remote; i++) {
        (void)fprintf(log->stream, "%02X", frame->data[i]);
    }
    (void)fputc('\n', log->stream);
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct can_log *log = context;
    const enum jp_status status = log->inner.port.send(log->inner.port.context, frame);

    if (status == JP_OK) {
        write_frame(log, frame);
    }
    return status;
}

static enum jp_can_state state(void *context)
{
    struct can_log *log = context;

    return log->inner.port.state(log->inner.port.context);
}

static bool receive(void *context, struct jp_can_frame *frame)
{
    struct can_log *log = context;

    if (!log->inner.receive(log->inner.port.context, frame)) {
        return false;
    }
    write_frame(log, frame);
    return true;
}

static bool wait(void *context, int64_t timeout_us)
{
    struct can_log *log = context;

    return log->inner.wait(log->inner.port.context, timeout_us);
}

static void close_link(void *context)
{
    struct can_log *log = context;

    log->inner.close(log->inner.port.context);
}

struct jp_can_link can_log_link(struct can_log *log)
{
    return (struct jp_can_link){
        .port = {.context = log, .send = send, .state = state}, .receive = receive, .wait = wait, .close = close_link};
}
