#include "sim/bus/can_relay.h"

#include "hal/linux/periodic.h"

/** With several links each is looked at this often while waiting, µs. */
#define POLL_US 50

bool can_relay_add(struct can_relay *relay, const struct jp_can_link *link)
{
    if (relay->count == CAN_RELAY_LINKS) {
        return false;
    }
    relay->links[relay->count++] = *link;
    return true;
}

/** To all but `from`; JP_OK when one of them took it. */
static enum jp_status send_to_others(struct can_relay *relay, size_t from, const struct jp_can_frame *frame)
{
    enum jp_status status = JP_ERR_HARDWARE;

    for (size_t i = 0; i < relay->count; i++) {
        if (i != from && relay->links[i].port.send(relay->links[i].port.context, frame) == JP_OK) {
            status = JP_OK;
        }
    }
    return status;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    return send_to_others(context, CAN_RELAY_LINKS, frame);
}

static enum jp_can_state state(void *context)
{
    const struct can_relay *relay = context;
    enum jp_can_state best = JP_CAN_DOWN;

    for (size_t i = 0; i < relay->count; i++) {
        const enum jp_can_state one = relay->links[i].port.state(relay->links[i].port.context);

        best = one < best ? one : best;
    }
    return best;
}

static bool receive(void *context, struct jp_can_frame *frame)
{
    struct can_relay *relay = context;

    for (size_t i = 0; i < relay->count; i++) {
        if (relay->links[i].receive(relay->links[i].port.context, frame)) {
            (void)send_to_others(relay, i, frame);
            return true;
        }
    }
    return false;
}

static bool wait(void *context, int64_t timeout_us)
{
    struct can_relay *relay = context;

    if (relay->count == 1) {
        return relay->links[0].wait(relay->links[0].port.context, timeout_us);
    }

    const int64_t start = jp_monotonic_us();

    do {
        for (size_t i = 0; i < relay->count; i++) {
            if (relay->links[i].wait(relay->links[i].port.context, i == 0 ? POLL_US : 0)) {
                return true;
            }
        }
    } while (timeout_us < 0 || jp_monotonic_us() - start < timeout_us);
    return false;
}

static void close_all(void *context)
{
    struct can_relay *relay = context;

    for (size_t i = 0; i < relay->count; i++) {
        relay->links[i].close(relay->links[i].port.context);
    }
    relay->count = 0;
}

struct jp_can_link can_relay_link(struct can_relay *relay)
{
    return (struct jp_can_link){
        .port = {.context = relay, .send = send, .state = state}, .receive = receive, .wait = wait, .close = close_all};
}
