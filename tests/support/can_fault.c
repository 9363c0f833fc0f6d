#include "tests/support/can_fault.h"

#include <string.h>

#include "hal/can/jp_can.h"

/** What becomes of a frame. */
struct fate {
    unsigned copies;
    uint64_t ticks_late;
    bool after_next;
};

void can_fault_link_init(struct can_fault_link *link, const struct jp_can_link *inner, uint64_t seed)
{
    *link = (struct can_fault_link){.inner = *inner};
    random_init(&link->random, seed);
}

bool can_fault_link_add(struct can_fault_link *link, const struct can_fault *fault)
{
    if (link->fault_count == CAN_FAULTS_MAX) {
        return false;
    }
    link->faults[link->fault_count++] = *fault;
    return true;
}

static bool acts(struct can_fault_link *link, const struct can_fault *fault, enum can_fault_direction direction)
{
    return ((unsigned)fault->direction & (unsigned)direction) != 0U && link->tick >= fault->from &&
           link->tick < fault->until && random_uniform(&link->random, 0, 1) < fault->share;
}

static uint32_t draw_strength(struct can_fault_link *link, const struct can_fault *fault)
{
    return 1U + (uint32_t)random_uniform(&link->random, 0, fault->strength);
}

static void flip(struct can_fault_link *link, const struct can_fault *fault, struct jp_can_frame *frame)
{
    const uint32_t bits = draw_strength(link, fault);

    for (uint32_t i = 0; i < bits && frame->length > 0; i++) {
        const uint32_t bit = (uint32_t)random_uniform(&link->random, 0, 8.0 * frame->length);

        frame->data[bit / 8U] = (uint8_t)(frame->data[bit / 8U] ^ (1U << (bit % 8U)));
    }
}

static void suffer(struct can_fault_link *link, const struct can_fault *fault, struct jp_can_frame *frame,
                   struct fate *fate)
{
    link->hits[fault->kind]++;
    switch (fault->kind) {
    case CAN_FAULT_LOSS:
        fate->copies = 0;
        break;
    case CAN_FAULT_REPEAT:
        fate->copies *= 2;
        break;
    case CAN_FAULT_DELAY:
        fate->ticks_late = draw_strength(link, fault);
        break;
    case CAN_FAULT_FLIP:
        flip(link, fault, frame);
        break;
    case CAN_FAULT_SWAP:
        fate->after_next = true;
        break;
    case CAN_FAULT_KINDS:
    default:
        break;
    }
}

static struct fate draw_fate(struct can_fault_link *link, enum can_fault_direction direction,
                             struct jp_can_frame *frame)
{
    struct fate fate = {.copies = 1};

    for (size_t i = 0; i < link->fault_count; i++) {
        if (acts(link, &link->faults[i], direction)) {
            suffer(link, &link->faults[i], frame, &fate);
        }
    }
    return fate;
}

static void append(struct can_fault_line *line, const struct can_fault_waiting *waiting)
{
    if (line->count < CAN_FAULT_WAITING) {
        line->waiting[line->count++] = *waiting;
    }
}

/** The frame that waited for the next one comes right after it. */
static void release_swapped(struct can_fault_line *line)
{
    if (line->count < 2 || !line->waiting[line->count - 2].until_next) {
        return;
    }

    const struct can_fault_waiting waiting = line->waiting[line->count - 2];

    line->waiting[line->count - 2] = line->waiting[line->count - 1];
    line->waiting[line->count - 1] = waiting;
    line->waiting[line->count - 1].until_next = false;
}

/** Puts a frame into the line of its direction, as its fate wants. */
static void enter(struct can_fault_link *link, enum can_fault_direction direction, const struct jp_can_frame *frame)
{
    struct can_fault_line *line = direction == CAN_FAULT_OUT ? &link->out : &link->in;
    struct can_fault_waiting waiting = {.frame = *frame};
    const struct fate fate = draw_fate(link, direction, &waiting.frame);

    waiting.due = link->tick + fate.ticks_late;
    for (unsigned i = 0; i < fate.copies; i++) {
        waiting.until_next = fate.after_next && i == 0;
        append(line, &waiting);
        release_swapped(line);
    }
}

/** Takes the first frame whose time has come; false: none. */
static bool leave(struct can_fault_line *line, uint64_t tick, struct jp_can_frame *frame)
{
    for (size_t i = 0; i < line->count; i++) {
        struct can_fault_waiting *waiting = &line->waiting[i];

        if (!waiting->until_next && waiting->due <= tick) {
            *frame = waiting->frame;
            line->count--;
            memmove(waiting, waiting + 1, (line->count - i) * sizeof *waiting);
            return true;
        }
    }
    return false;
}

static bool is_spared(const struct jp_can_frame *frame)
{
    return frame->id == JP_CAN_SIM_TIME_FRAME_ID || frame->id == JP_CAN_SIM_DONE_FRAME_ID;
}

static void send_due(struct can_fault_link *link)
{
    struct jp_can_port *port = &link->inner.port;
    struct jp_can_frame frame;

    while (leave(&link->out, link->tick, &frame)) {
        (void)port->send(port->context, &frame);
    }
}

void can_fault_link_set_tick(struct can_fault_link *link, uint64_t tick)
{
    link->tick = tick;
    send_due(link);
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct can_fault_link *link = context;

    if (is_spared(frame)) {
        return link->inner.port.send(link->inner.port.context, frame);
    }
    enter(link, CAN_FAULT_OUT, frame);
    send_due(link);
    return JP_OK;
}

static enum jp_can_state state(void *context)
{
    struct can_fault_link *link = context;

    return link->inner.port.state(link->inner.port.context);
}

static bool receive(void *context, struct jp_can_frame *frame)
{
    struct can_fault_link *link = context;

    while (!leave(&link->in, link->tick, frame)) {
        if (!link->inner.receive(link->inner.port.context, frame)) {
            return false;
        }
        if (is_spared(frame)) {
            return true;
        }
        enter(link, CAN_FAULT_IN, frame);
    }
    return true;
}

static bool wait(void *context, int64_t timeout_us)
{
    struct can_fault_link *link = context;

    return link->inner.wait(link->inner.port.context, timeout_us);
}

static void close_link(void *context)
{
    struct can_fault_link *link = context;

    link->inner.close(link->inner.port.context);
}

struct jp_can_link can_fault_link(struct can_fault_link *link)
{
    return (struct jp_can_link){
        .port = {.context = link, .send = send, .state = state}, .receive = receive, .wait = wait, .close = close_link};
}
