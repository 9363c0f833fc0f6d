/** Both ends of a pseudo-terminal as CAN links in one process, for tests. Time passes only in waits: a machine that is
 *  busy elsewhere makes nothing late. */
#ifndef JOULEPATH_TESTS_SUPPORT_CAN_LINKS_H
#define JOULEPATH_TESTS_SUPPORT_CAN_LINKS_H

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/linux/can_open.h"
#include "unity.h"

#define MS       1000
#define SECOND   (1000 * MS)
#define LATER_US (INT64_C(600) * SECOND) /* for what takes a moment: something hangs */

static char folder[] = "/tmp/can_links.XXXXXX";
static char path[64];
static char pty_name[80];
static char slcan_name[80];
static char error[256];
static struct jp_can_link adapter;
static struct jp_can_link host;
static int64_t now_us;
static unsigned waits; /**< for a descriptor */

void setUp(void)
{
    adapter = (struct jp_can_link){.close = NULL};
    host = (struct jp_can_link){.close = NULL};
    waits = 0;
}

static void close_link(struct jp_can_link *link)
{
    if (link->close != NULL) {
        link->close(link->port.context);
    }
    link->close = NULL;
}

void tearDown(void)
{
    close_link(&host);
    close_link(&adapter);
    (void)unlink(path);
}

/* Time, in place of the C library's. */

int clock_gettime(clockid_t clock, struct timespec *time)
{
    TEST_ASSERT_EQUAL_INT(CLOCK_MONOTONIC, clock);
    *time = (struct timespec){.tv_sec = (time_t)(now_us / SECOND), .tv_nsec = (long)(now_us % SECOND * 1000)};
    return 0;
}

/* The kernel takes a moment to hand over what was written to a terminal, so the wait is real, too. */
int ppoll(struct pollfd *descriptors, nfds_t count, const struct timespec *timeout, const sigset_t *mask)
{
    const int64_t us = (int64_t)timeout->tv_sec * SECOND + timeout->tv_nsec / 1000;
    int ready;

    TEST_ASSERT_NULL(mask);
    waits++;
    ready = poll(descriptors, count, (int)((us + MS - 1) / MS));
    now_us += ready == 0 ? us : 0;
    return ready;
}

/* Short names for the functions of a link. */

static void open_link(struct jp_can_link *link, const char *name)
{
    TEST_ASSERT_TRUE_MESSAGE(jp_can_link_open(link, name, error, sizeof error), error);
}

static bool wait_on(struct jp_can_link *link, int64_t timeout_us)
{
    return link->wait(link->port.context, timeout_us);
}

static bool receive_from(struct jp_can_link *link, struct jp_can_frame *frame)
{
    return link->receive(link->port.context, frame);
}

static enum jp_can_state state_of(struct jp_can_link *link)
{
    return link->port.state(link->port.context);
}

/* Lets both ends work until `link` is in that state. */
static void await_state(struct jp_can_link *link, enum jp_can_state expected)
{
    const int64_t end = now_us + LATER_US;

    while (state_of(link) != expected && now_us < end) {
        (void)wait_on(link, MS);
        if (host.close != NULL) {
            (void)wait_on(&host, MS);
        }
        if (adapter.close != NULL) {
            (void)wait_on(&adapter, MS);
        }
    }
    TEST_ASSERT_EQUAL_INT(expected, state_of(link));
}

static void open_both(void)
{
    open_link(&adapter, pty_name);
    open_link(&host, slcan_name);
    await_state(&host, JP_CAN_ON);
    await_state(&adapter, JP_CAN_ON);
}

static void check_crosses(struct jp_can_link *from, struct jp_can_link *to, const struct jp_can_frame *frame)
{
    struct jp_can_frame received;

    TEST_ASSERT_EQUAL_INT(JP_OK, from->port.send(from->port.context, frame));
    TEST_ASSERT_TRUE(wait_on(to, LATER_US));
    TEST_ASSERT_TRUE(receive_from(to, &received));
    TEST_ASSERT_EQUAL_HEX32(frame->id, received.id);
    TEST_ASSERT_EQUAL_UINT(frame->length, received.length);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(frame->data, received.data, JP_CAN_LENGTH_MAX);
    TEST_ASSERT_FALSE(receive_from(to, &received));
}

static void check_both_talk(void)
{
    const struct jp_can_frame frame = {.id = 0x123, .length = 3, .data = {'\r', '\n', '\a'}};

    check_crosses(&host, &adapter, &frame);
    check_crosses(&adapter, &host, &frame);
}

/** Where the ends meet; false after a line on standard error. */
static bool make_folder(void)
{
    if (mkdtemp(folder) == NULL) {
        perror(folder);
        return false;
    }
    (void)snprintf(path, sizeof path, "%s/ecu", folder);
    (void)snprintf(pty_name, sizeof pty_name, "pty:%s", path);
    (void)snprintf(slcan_name, sizeof slcan_name, "slcan:%s", path);
    return true;
}

#endif
