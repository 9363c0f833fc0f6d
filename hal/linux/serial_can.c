#include "hal/linux/serial_can.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/can/slcan.h"
#include "hal/linux/can_wait.h"
#include "hal/linux/error_text.h"
#include "hal/linux/periodic.h"
#include "hal/linux/pseudo_terminal.h"
#include "hal/linux/serial_line.h"

/** Without a byte from the adapter for so long it is asked to open the channel again: it may have been reset, µs. */
#define SILENCE_US 500000

/** An adapter that was asked so often without an answer is taken for gone. */
#define UNANSWERED_MAX 5U

/** Longest path of a serial line, with the ending zero. */
#define PATH_SIZE 256U

struct serial_can;

/** What the host's end and the adapter's end do differently. */
struct end {
    /** Does what is due. False: the line is not there. */
    bool (*tend)(struct serial_can *can);

    /** Takes a byte; true: slcan.decoder.frame has come. */
    bool (*take)(struct serial_can *can, uint8_t byte);

    /** The far end has gone. */
    void (*lose)(struct serial_can *can);

    bool (*is_on)(const struct serial_can *can);
};

struct serial_can {
    const struct end *end;
    struct jp_serial_line line;
    struct jp_slcan_adapter slcan; /**< the host uses its decoder alone */
    bool has_frame;
    struct jp_can_frame frame;

    /* Of the host. */
    char path[PATH_SIZE];
    unsigned unanswered; /**< times that the adapter was asked since it was last heard; UNANSWERED_MAX at the start */
    bool refused;        /**< the adapter has refused a line since it was last asked */
    int64_t heard_us;    /**< the adapter's last line */
    int64_t asked_us;    /**< for the channel or, when the line was gone, for the line */

    /* Of the adapter. */
    struct jp_pseudo_terminal terminal;
};

/* The host's end. */

static void ask(struct serial_can *can, const char *commands)
{
    (void)jp_serial_line_put(&can->line, commands, strlen(commands));
    can->asked_us = jp_monotonic_us();
    can->unanswered++;
    can->refused = false;
}

/** Opens the line and the adapter's channel. False: errno. */
static bool call_adapter(struct serial_can *can)
{
    const bool opened = jp_serial_line_open(&can->line, can->path);

    can->unanswered = UNANSWERED_MAX;
    if (opened) {
        ask(can, "C\rS8\rO\r");
        jp_serial_line_flush(&can->line);
    }
    return opened;
}

/** Does not close the channel first (C), so that no frame is lost if it is open. */
static void keep_channel_open(struct serial_can *can)
{
    const int64_t now = jp_monotonic_us();
    const bool in_doubt = can->refused || can->unanswered > 0U || now - can->heard_us > SILENCE_US;

    if (in_doubt && now - can->asked_us > JP_CAN_RETRY_US) {
        ask(can, "S8\rO\r");
    }
}

static bool tend_host(struct serial_can *can)
{
    if (can->line.descriptor >= 0) {
        keep_channel_open(can);
        return true;
    }
    if (jp_monotonic_us() - can->asked_us <= JP_CAN_RETRY_US) {
        return false;
    }
    can->asked_us = jp_monotonic_us();
    return call_adapter(can);
}

/** Some adapters refuse to open what is open: soon after they were asked, a refusal means nothing. */
static void note_heard(struct serial_can *can, enum jp_slcan_item item)
{
    can->heard_us = jp_monotonic_us();
    can->unanswered = 0;
    if (item == JP_SLCAN_REFUSED && can->heard_us - can->asked_us > JP_CAN_RETRY_US) {
        can->refused = true;
    }
}

static bool take_from_adapter(struct serial_can *can, uint8_t byte)
{
    const enum jp_slcan_item item = jp_slcan_decode(&can->slcan.decoder, byte);

    if (item != JP_SLCAN_NONE && item != JP_SLCAN_MALFORMED) {
        note_heard(can, item);
    }
    return item == JP_SLCAN_FRAME;
}

static void lose_line(struct serial_can *can)
{
    jp_serial_line_close(&can->line);
    can->asked_us = jp_monotonic_us();
}

static bool is_heard(const struct serial_can *can)
{
    return can->line.descriptor >= 0 && can->unanswered < UNANSWERED_MAX;
}

static const struct end host = {tend_host, take_from_adapter, lose_line, is_heard};

/* The adapter's end. */

static bool tend_adapter(struct serial_can *can)
{
    return can->line.descriptor >= 0;
}

/** A host that does not read gets no answers. */
static bool take_from_host(struct serial_can *can, uint8_t byte)
{
    const char *answer;
    const bool is_frame = jp_slcan_adapter_take(&can->slcan, byte, &answer);

    (void)jp_serial_line_put(&can->line, answer, strlen(answer));
    return is_frame;
}

/** The terminal stays for the next host, which shall not get what was meant for this one. */
static void lose_host(struct serial_can *can)
{
    can->slcan.open = false;
    can->slcan.decoder.length = 0;
    jp_serial_line_drop(&can->line);
}

static bool is_channel_open(const struct serial_can *can)
{
    return can->slcan.open;
}

static const struct end adapter = {tend_adapter, take_from_host, lose_host, is_channel_open};

/* The functions of the link. */

static enum jp_can_state state(void *context)
{
    const struct serial_can *can = context;

    return can->end->is_on(can) ? JP_CAN_ON : JP_CAN_DOWN;
}

static void flush(struct serial_can *can)
{
    jp_serial_line_flush(&can->line);
    if (can->line.gone) {
        can->end->lose(can);
    }
}

static enum jp_status send_frame(void *context, const struct jp_can_frame *frame)
{
    struct serial_can *can = context;
    char text[JP_SLCAN_LINE_MAX];
    const unsigned length = jp_slcan_encode(text, frame);

    if (length == 0U) {
        return JP_ERR_ARGUMENT;
    }
    if (!can->end->tend(can) || !can->end->is_on(can)) {
        return JP_ERR_HARDWARE;
    }
    if (!jp_serial_line_put(&can->line, text, length)) {
        return JP_ERR_BUSY;
    }
    flush(can);
    return can->line.gone ? JP_ERR_HARDWARE : JP_OK;
}

/** Decodes bytes that were read, up to the next frame. */
static void decode(struct serial_can *can)
{
    uint8_t byte;

    while (!can->has_frame && jp_serial_line_take(&can->line, &byte)) {
        can->has_frame = can->end->take(can, byte);
        if (can->has_frame) {
            can->frame = can->slcan.decoder.frame;
        }
    }
}

static bool fetch(void *context)
{
    struct serial_can *can = context;

    if (can->has_frame) {
        return true;
    }
    if (!can->end->tend(can)) {
        return false;
    }
    decode(can);
    if (!can->has_frame && jp_serial_line_fill(&can->line)) {
        decode(can);
    }
    flush(can);
    return can->has_frame;
}

static bool receive(void *context, struct jp_can_frame *frame)
{
    struct serial_can *can = context;
    const bool received = fetch(can);

    if (received) {
        *frame = can->frame;
        can->has_frame = false;
    }
    return received;
}

/** A terminal that has hung up would always be ready. */
static struct pollfd descriptor_of(void *context)
{
    const struct serial_can *can = context;
    const short events = can->line.out_length > 0 ? POLLIN | POLLOUT : POLLIN;

    return (struct pollfd){.fd = can->line.gone ? -1 : can->line.descriptor, .events = events};
}

static bool wait_for_frame(void *context, int64_t timeout_us)
{
    const struct jp_can_source source = {.context = context, .fetch = fetch, .descriptor = descriptor_of};

    return jp_can_wait(&source, timeout_us);
}

static struct serial_can *allocate(const struct end *end, const char *name, char *error, unsigned size)
{
    struct serial_can *can = calloc(1, sizeof *can);

    if (can == NULL) {
        (void)jp_error_text(error, size, "%s: out of memory", name);
        return NULL;
    }
    can->end = end;
    return can;
}

static void fill_in(struct jp_can_link *link, struct serial_can *can, void (*close_link)(void *context))
{
    *link = (struct jp_can_link){
        .port = {.context = can, .send = send_frame, .state = state},
        .receive = receive,
        .wait = wait_for_frame,
        .close = close_link,
    };
}

/* Opening and closing. */

static void close_host(void *context)
{
    struct serial_can *can = context;

    if (can->line.descriptor >= 0) {
        ask(can, "C\r");
        jp_serial_line_flush(&can->line);
        jp_serial_line_close(&can->line);
    }
    free(can);
}

static bool explain(const char *path, int reason, char *error, unsigned size)
{
    if (reason == ENOTTY) {
        return jp_error_text(error, size, "slcan:%s: not a serial line; give another one", path);
    }
    return jp_error_text(error, size,
                         "slcan:%s: cannot open this serial line: %s; plug in the adapter or give another "
                         "one",
                         path, strerror(reason));
}

bool jp_serial_can_open(struct jp_can_link *link, const char *path, char *error, unsigned size)
{
    struct serial_can *can;

    if (path[0] == '\0' || strlen(path) >= PATH_SIZE) {
        return jp_error_text(error, size,
                             "slcan:%.40s: the path has 1 to %u characters; give one, such as "
                             "slcan:/dev/ttyACM0",
                             path, PATH_SIZE - 1U);
    }
    can = allocate(&host, path, error, size);
    if (can == NULL) {
        return false;
    }
    memcpy(can->path, path, strlen(path) + 1);
    if (!call_adapter(can)) {
        const int reason = errno;

        free(can);
        return explain(path, reason, error, size);
    }
    fill_in(link, can, close_host);
    return true;
}

static void close_adapter(void *context)
{
    struct serial_can *can = context;

    jp_pseudo_terminal_unlink(&can->terminal);
    jp_serial_line_close(&can->line);
    free(can);
}

bool jp_serial_can_open_pty(struct jp_can_link *link, const char *path, char *error, unsigned size)
{
    struct serial_can *can = allocate(&adapter, path, error, size);

    if (can == NULL) {
        return false;
    }
    if (!jp_pseudo_terminal_open(&can->terminal, path, error, size)) {
        free(can);
        return false;
    }
    jp_serial_line_start(&can->line, can->terminal.descriptor);
    fill_in(link, can, close_adapter);
    return true;
}
