/*
 * The SocketCAN link on virtual interfaces: what others send arrives, bus-off passes, an interface goes down, vanishes
 * and comes back, a full queue is busy.
 *
 * For with_vcan.sh --interfaces 2: vcan0 stays as it is, vcan1 is switched off and removed. Nothing is skipped.
 */
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/linux/can_open.h"
#include "hal/linux/periodic.h"
#include "unity.h"

#define MS       1000
#define LATER_US (INT64_C(600000) * MS) /* for what takes a moment: something hangs */

static char error[256];
static struct jp_can_link bus;
static struct jp_can_link other;

void setUp(void)
{
    bus = (struct jp_can_link){.close = NULL};
    other = (struct jp_can_link){.close = NULL};
}

static void close_link(struct jp_can_link *opened)
{
    if (opened->close != NULL) {
        opened->close(opened->port.context);
    }
    opened->close = NULL;
}

void tearDown(void)
{
    close_link(&bus);
    close_link(&other);
}

static void open_link(struct jp_can_link *opened, const char *name)
{
    TEST_ASSERT_TRUE_MESSAGE(jp_can_link_open(opened, name, error, sizeof error), error);
}

static enum jp_status send_to(struct jp_can_link *to, uint32_t id)
{
    const struct jp_can_frame frame = {.id = id, .length = 2, .data = {0xBE, 0xEF}};

    return to->port.send(to->port.context, &frame);
}

static enum jp_can_state state_of(struct jp_can_link *of)
{
    return of->port.state(of->port.context);
}

static bool wait_on(struct jp_can_link *on, int64_t timeout_us)
{
    return on->wait(on->port.context, timeout_us);
}

static void await_state(struct jp_can_link *of, enum jp_can_state expected)
{
    const int64_t end = jp_monotonic_us() + LATER_US;

    while (state_of(of) != expected && jp_monotonic_us() < end) {
        (void)wait_on(of, MS);
    }
    TEST_ASSERT_EQUAL_INT(expected, state_of(of));
}

static void check_received(struct jp_can_link *by, uint32_t id, uint8_t length)
{
    struct jp_can_frame frame;

    TEST_ASSERT_TRUE(wait_on(by, LATER_US));
    TEST_ASSERT_TRUE(by->receive(by->port.context, &frame));
    TEST_ASSERT_EQUAL_HEX32(id, frame.id);
    TEST_ASSERT_EQUAL_UINT(length, frame.length);
}

static void run(const char *command)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, system(command), command);
}

/* A plain socket beside the links: it can also send what they cannot. */
static int open_socket(const char *name)
{
    const int descriptor = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    const struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(name)};

    TEST_ASSERT_TRUE(descriptor >= 0);
    TEST_ASSERT_TRUE(bind(descriptor, (const struct sockaddr *)&address, sizeof address) == 0);
    return descriptor;
}

static void inject(const char *name, uint32_t id)
{
    const struct can_frame frame = {.can_id = id, .can_dlc = 8};
    const int descriptor = open_socket(name);

    TEST_ASSERT_TRUE(write(descriptor, &frame, sizeof frame) == (ssize_t)sizeof frame);
    (void)close(descriptor);
}

/* ---- Frames ---- */

static void test_frames_of_each_kind_cross(void)
{
    static const struct jp_can_frame frames[] = {
        {.id = 0, .length = 0},
        {.id = 0x7FF, .length = 8, .data = {0, 1, 2, 3, 4, 5, 0x7F, 0xFF}},
        {.id = JP_CAN_EXTENDED | 0x1FFFFFFF, .length = 8, .data = {8, 7, 6, 5, 4, 3, 2, 1}},
        {.id = JP_CAN_REMOTE | 0x123, .length = 4},
        {.id = JP_CAN_REMOTE | JP_CAN_EXTENDED, .length = 0},
    };
    struct jp_can_frame received;

    open_link(&bus, "can:vcan0");
    open_link(&other, "can:vcan0");
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, bus.port.send(bus.port.context, &frames[i]));
        TEST_ASSERT_TRUE(wait_on(&other, LATER_US));
        TEST_ASSERT_TRUE(other.receive(other.port.context, &received));
        TEST_ASSERT_EQUAL_HEX32(frames[i].id, received.id);
        TEST_ASSERT_EQUAL_UINT(frames[i].length, received.length);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(frames[i].data, received.data, JP_CAN_LENGTH_MAX);
    }
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&bus));
}

static void test_own_frames_and_those_of_other_buses_do_not_arrive(void)
{
    open_link(&bus, "can:vcan0");
    open_link(&other, "can:vcan1");
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&bus, 1));
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&other, 2));
    TEST_ASSERT_FALSE(wait_on(&bus, 100 * MS));
    TEST_ASSERT_FALSE(wait_on(&other, 0));
}

static void test_frames_that_do_not_exist_are_refused(void)
{
    const struct jp_can_frame too_long = {.id = 1, .length = 9};

    open_link(&bus, "can:vcan0");
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send_to(&bus, 0x800));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send_to(&bus, CAN_ERR_FLAG | CAN_ERR_BUSOFF));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send_to(&bus, JP_CAN_EXTENDED | 0x20000000));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, bus.port.send(bus.port.context, &too_long));
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&bus));
}

/* ---- Bus-off ---- */

static void test_bus_off_lasts_until_the_controller_has_restarted(void)
{
    open_link(&bus, "can:vcan0");
    inject("vcan0", CAN_ERR_FLAG | CAN_ERR_BUSOFF);
    TEST_ASSERT_FALSE(wait_on(&bus, MS));
    TEST_ASSERT_EQUAL_INT(JP_CAN_BUS_OFF, state_of(&bus));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&bus, 1));
    inject("vcan0", CAN_ERR_FLAG | CAN_ERR_RESTARTED);
    TEST_ASSERT_FALSE(wait_on(&bus, MS));
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&bus));
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&bus, 1));
}

static void test_bus_off_passes_without_news_too(void)
{
    int64_t start;

    open_link(&bus, "can:vcan0");
    start = jp_monotonic_us();
    inject("vcan0", CAN_ERR_FLAG | CAN_ERR_BUSOFF);
    await_state(&bus, JP_CAN_BUS_OFF);
    await_state(&bus, JP_CAN_ON);
    TEST_ASSERT_TRUE(jp_monotonic_us() - start >= 100 * MS);
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&bus, 1));
}

static void test_error_frames_never_reach_the_application(void)
{
    open_link(&bus, "can:vcan0");
    for (int i = 0; i < 100; i++) {
        inject("vcan0", CAN_ERR_FLAG | CAN_ERR_RESTARTED);
        inject("vcan0", CAN_ERR_FLAG | CAN_ERR_CRTL | CAN_ERR_BUSERROR);
    }
    inject("vcan0", 0x123);
    check_received(&bus, 0x123, 8);
    TEST_ASSERT_FALSE(wait_on(&bus, 0));
}

/* ---- Interfaces that go and come back ---- */

static void check_lost_and_found(const char *lose, const char *find)
{
    open_link(&bus, "can:vcan1");
    for (int i = 0; i < 2; i++) {
        run(lose);
        TEST_ASSERT_FALSE(wait_on(&bus, 50 * MS));
        TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&bus));
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&bus, 1));
        TEST_ASSERT_FALSE(wait_on(&bus, 300 * MS));
        TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&bus));
        run(find);
        await_state(&bus, JP_CAN_ON);
        TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&bus, 1));
        inject("vcan1", 0x321);
        check_received(&bus, 0x321, 8);
    }
}

static void test_an_interface_goes_down_and_up(void)
{
    check_lost_and_found("ip link set vcan1 down", "ip link set vcan1 up");
}

static void test_an_interface_vanishes_and_is_made_again(void)
{
    check_lost_and_found("ip link del vcan1", "ip link add dev vcan1 type vcan && ip link set vcan1 up");
}

static void test_sending_alone_notices_a_lost_interface(void)
{
    const int64_t end = jp_monotonic_us() + LATER_US;

    open_link(&bus, "can:vcan1");
    run("ip link set vcan1 down");
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&bus, 1));
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&bus));
    run("ip link set vcan1 up");
    while (send_to(&bus, 1) != JP_OK && jp_monotonic_us() < end) {
        (void)usleep(10 * MS);
    }
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&bus));
}

/* A queue that holds less than a frame refuses each. */
static void test_a_full_queue_is_busy(void)
{
    open_link(&bus, "can:vcan1");
    run("tc qdisc add dev vcan1 root bfifo limit 1");
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, send_to(&bus, 1));
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&bus));
    run("tc qdisc del dev vcan1 root");
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&bus, 1));
}

/* ---- A flood ---- */

static void test_what_nobody_reads_is_dropped_by_the_kernel_and_the_link_goes_on(void)
{
    struct jp_can_frame frame;
    unsigned received = 0;

    open_link(&bus, "can:vcan0");
    open_link(&other, "can:vcan0");
    for (uint32_t i = 0; i < 5000; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&other, i % 0x800));
    }
    while (bus.receive(bus.port.context, &frame)) {
        received++;
    }
    TEST_ASSERT_TRUE(received > 10 && received < 5000);
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&bus));
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&other, 5));
    check_received(&bus, 5, 2);
}

/* ---- Names that cannot be opened ---- */

static void check_refused(const char *name, const char *culprit)
{
    struct jp_can_link refused;

    TEST_ASSERT_FALSE_MESSAGE(jp_can_link_open(&refused, name, error, sizeof error), name);
    TEST_ASSERT_TRUE_MESSAGE(strstr(error, culprit) != NULL, error);
    TEST_ASSERT_TRUE_MESSAGE(strchr(error, '\n') == NULL, error);
}

static void test_interfaces_that_are_missing_down_or_of_another_kind(void)
{
    check_refused("can:nowhere0", "`ip link add dev nowhere0 type vcan; ip link set nowhere0 up`");
    check_refused("can:lo", "can:lo: there is no such CAN interface");
    run("ip link set vcan1 down");
    check_refused("can:vcan1", "can:vcan1: the interface is down; switch it on with `ip link set vcan1 up`");
    run("ip link set vcan1 up");
    open_link(&bus, "can:vcan1");
}

static void test_links_give_everything_back(void)
{
    const int before = dup(0);
    int after;

    (void)close(before);
    for (int i = 0; i < 20; i++) {
        open_link(&bus, "can:vcan0");
        close_link(&bus);
        (void)jp_can_link_open(&bus, "can:nowhere0", error, sizeof error);
    }
    after = dup(0);
    (void)close(after);
    TEST_ASSERT_EQUAL_INT(before, after);
}
