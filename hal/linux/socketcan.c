#include "hal/linux/socketcan.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/linux/can_wait.h"
#include "hal/linux/error_text.h"
#include "hal/linux/periodic.h"

_Static_assert(JP_CAN_EXTENDED == CAN_EFF_FLAG && JP_CAN_REMOTE == CAN_RTR_FLAG, "the flags of an id are SocketCAN's");
_Static_assert(JP_CAN_LENGTH_MAX == CAN_MAX_DLEN, "classic frames");

#define FLAGS (JP_CAN_EXTENDED | JP_CAN_REMOTE)

/** For controllers whose driver does not tell that they have restarted, µs. */
#define BUS_OFF_US 100000

/** Error frames that one call takes. */
#define ERROR_FRAMES_MAX 16

struct socketcan {
    char name[IFNAMSIZ];
    int descriptor;           /**< negative: down */
    int64_t retry_us;         /**< when to try to get the interface back */
    int64_t bus_off_until_us; /**< 0: not bus-off */
    bool has_frame;
    struct can_frame frame;
};

/* Connection. */

/** Fails with ENODEV if the interface is missing, ENETDOWN if it is down. */
static bool is_up(int descriptor, const char *name)
{
    struct ifreq request = {.ifr_ifindex = 0};

    memcpy(request.ifr_name, name, strlen(name) + 1);
    if (ioctl(descriptor, SIOCGIFFLAGS, &request) != 0) {
        return false;
    }
    errno = ENETDOWN;
    return ((unsigned)request.ifr_flags & IFF_UP) != 0U;
}

static bool ask_for_error_frames(int descriptor)
{
    const can_err_mask_t mask = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;

    return setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &mask, sizeof mask) == 0;
}

/** Fails with ENODEV if the interface is missing or is none of CAN. */
static bool bind_to(int descriptor, const char *name)
{
    const struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(name)};

    if (address.can_ifindex == 0) {
        errno = ENODEV;
        return false;
    }
    return bind(descriptor, (const struct sockaddr *)&address, sizeof address) == 0;
}

/** Returns a descriptor, or -1 with the reason in errno. */
static int connect_to(const char *name)
{
    const int descriptor = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    int reason;

    if (descriptor < 0 || (is_up(descriptor, name) && ask_for_error_frames(descriptor) && bind_to(descriptor, name))) {
        return descriptor;
    }
    reason = errno;
    (void)close(descriptor);
    errno = reason;
    return -1;
}

static bool explain(const char *name, int reason, char *error, unsigned size)
{
    switch (reason) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        return jp_error_text(
            error, size,
            "can:%s: this kernel has no CAN; load the modules can, can-raw and vcan, or run this under "
            "tools/operate/with_vcan.sh, which brings a kernel that has it",
            name);
    case ENODEV:
        return jp_error_text(error, size,
                             "can:%s: there is no such CAN interface; make a virtual one with `ip link add dev %s type "
                             "vcan; ip link set %s up`, or give another name",
                             name, name, name);
    case ENETDOWN:
        return jp_error_text(error, size, "can:%s: the interface is down; switch it on with `ip link set %s up`", name,
                             name);
    default:
        return jp_error_text(error, size, "can:%s: cannot use this interface: %s; give another one", name,
                             strerror(reason));
    }
}

static void lose(struct socketcan *bus)
{
    (void)close(bus->descriptor);
    bus->descriptor = -1;
    bus->bus_off_until_us = 0;
    bus->retry_us = jp_monotonic_us() + JP_CAN_RETRY_US;
}

/** Tries to get a lost interface back when it is time. False: it is lost. */
static bool stay_connected(struct socketcan *bus)
{
    if (bus->descriptor < 0 && jp_monotonic_us() >= bus->retry_us) {
        bus->descriptor = connect_to(bus->name);
        bus->retry_us = jp_monotonic_us() + JP_CAN_RETRY_US;
    }
    return bus->descriptor >= 0;
}

/* The functions of the link. */

static enum jp_can_state state(void *context)
{
    const struct socketcan *bus = context;

    if (bus->descriptor < 0) {
        return JP_CAN_DOWN;
    }
    return bus->bus_off_until_us > jp_monotonic_us() ? JP_CAN_BUS_OFF : JP_CAN_ON;
}

static bool can_be_sent(const struct jp_can_frame *frame)
{
    const uint32_t greatest = (frame->id & JP_CAN_EXTENDED) != 0U ? CAN_EFF_MASK : CAN_SFF_MASK;

    return frame->length <= JP_CAN_LENGTH_MAX && (frame->id & ~FLAGS) <= greatest;
}

static enum jp_status send_frame(void *context, const struct jp_can_frame *frame)
{
    struct socketcan *bus = context;
    struct can_frame raw = {.can_id = frame->id, .can_dlc = frame->length};

    if (!can_be_sent(frame)) {
        return JP_ERR_ARGUMENT;
    }
    if (!stay_connected(bus) || state(bus) != JP_CAN_ON) {
        return JP_ERR_HARDWARE;
    }
    memcpy(raw.data, frame->data, frame->length);
    if (write(bus->descriptor, &raw, sizeof raw) == (ssize_t)sizeof raw) {
        return JP_OK;
    }
    if (errno == ENOBUFS || errno == EAGAIN || errno == EINTR) {
        return JP_ERR_BUSY;
    }
    lose(bus);
    return JP_ERR_HARDWARE;
}

static void note_error(struct socketcan *bus, uint32_t errors)
{
    if ((errors & CAN_ERR_BUSOFF) != 0U) {
        bus->bus_off_until_us = jp_monotonic_us() + BUS_OFF_US;
    }
    if ((errors & CAN_ERR_RESTARTED) != 0U) {
        bus->bus_off_until_us = 0;
    }
}

/** False: nothing is waiting, or the interface is gone. */
static bool read_frame(struct socketcan *bus)
{
    const ssize_t length = read(bus->descriptor, &bus->frame, sizeof bus->frame);

    if (length < 0 && errno != EAGAIN && errno != EINTR) {
        lose(bus);
    }
    return length == (ssize_t)sizeof bus->frame;
}

static bool fetch(void *context)
{
    struct socketcan *bus = context;

    for (unsigned i = 0; i < ERROR_FRAMES_MAX && !bus->has_frame; i++) {
        if (!stay_connected(bus) || !read_frame(bus)) {
            return false;
        }
        if ((bus->frame.can_id & CAN_ERR_FLAG) != 0U) {
            note_error(bus, bus->frame.can_id & CAN_ERR_MASK);
        } else {
            bus->has_frame = true;
        }
    }
    return bus->has_frame;
}

static bool receive(void *context, struct jp_can_frame *frame)
{
    struct socketcan *bus = context;

    if (!fetch(bus)) {
        return false;
    }
    bus->has_frame = false;
    *frame = (struct jp_can_frame){.id = bus->frame.can_id, .length = bus->frame.can_dlc};
    memcpy(frame->data, bus->frame.data, frame->length);
    return true;
}

static struct pollfd descriptor_of(void *context)
{
    const struct socketcan *bus = context;

    return (struct pollfd){.fd = bus->descriptor, .events = POLLIN};
}

static bool wait_for_frame(void *context, int64_t timeout_us)
{
    const struct jp_can_source source = {.context = context, .fetch = fetch, .descriptor = descriptor_of};

    return jp_can_wait(&source, timeout_us);
}

static void close_link(void *context)
{
    struct socketcan *bus = context;

    if (bus->descriptor >= 0) {
        (void)close(bus->descriptor);
    }
    free(bus);
}

bool jp_socketcan_open(struct jp_can_link *link, const char *name, char *error, unsigned size)
{
    struct socketcan *bus;
    int descriptor;

    if (name[0] == '\0' || strlen(name) >= IFNAMSIZ) {
        return jp_error_text(error, size,
                             "can:%.40s: the name of an interface has 1 to %d characters; give one, such as "
                             "can:vcan0",
                             name, IFNAMSIZ - 1);
    }
    descriptor = connect_to(name);
    if (descriptor < 0) {
        return explain(name, errno, error, size);
    }
    bus = calloc(1, sizeof *bus);
    if (bus == NULL) {
        (void)close(descriptor);
        return jp_error_text(error, size, "can:%s: out of memory", name);
    }
    memcpy(bus->name, name, strlen(name) + 1);
    bus->descriptor = descriptor;
    *link = (struct jp_can_link){
        .port = {.context = bus, .send = send_frame, .state = state},
        .receive = receive,
        .wait = wait_for_frame,
        .close = close_link,
    };
    return true;
}
