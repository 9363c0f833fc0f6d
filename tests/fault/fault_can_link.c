/* CAN links on a host: two ends of a pseudo-terminal in one process, ends that go and come back, floods, garbage, and
 * adapters that are silent or reset. */
#include <fcntl.h>
#include <signal.h>
#include <sys/time.h>
#include <termios.h>

#include "tests/support/can_links.h"

static enum jp_status send_to(struct jp_can_link *link, uint32_t id)
{
    const struct jp_can_frame frame = {.id = id, .length = 8, .data = {1, 2, 3, 4, 5, 6, 7, (uint8_t)id}};

    return link->port.send(link->port.context, &frame);
}

/* ---- Sound exchanges ---- */

static void test_frames_of_each_kind_cross_both_ways(void)
{
    static const struct jp_can_frame frames[] = {
        {.id = 0, .length = 0},
        {.id = 0x7FF, .length = 8, .data = {0, '\r', '\n', '\a', 0x11, 0x13, 0x7F, 0xFF}},
        {.id = JP_CAN_EXTENDED | 0x1FFFFFFF, .length = 8, .data = {8, 7, 6, 5, 4, 3, 2, 1}},
        {.id = JP_CAN_REMOTE | 0x123, .length = 4},
        {.id = JP_CAN_REMOTE | JP_CAN_EXTENDED, .length = 0},
    };

    open_both();
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        check_crosses(&host, &adapter, &frames[i]);
        check_crosses(&adapter, &host, &frames[i]);
    }
}

static void test_frames_keep_their_order(void)
{
    struct jp_can_frame frame;

    open_both();
    for (uint32_t id = 0; id < 100; id++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&host, id));
    }
    for (uint32_t id = 0; id < 100; id++) {
        TEST_ASSERT_TRUE(wait_on(&adapter, LATER_US));
        TEST_ASSERT_TRUE(receive_from(&adapter, &frame));
        TEST_ASSERT_EQUAL_HEX32(id, frame.id);
    }
}

static void test_waiting_takes_no_frame(void)
{
    struct jp_can_frame frame;

    open_both();
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&host, 1));
    TEST_ASSERT_TRUE(wait_on(&adapter, LATER_US));
    TEST_ASSERT_TRUE(wait_on(&adapter, 0));
    TEST_ASSERT_TRUE(wait_on(&adapter, -1));
    TEST_ASSERT_TRUE(receive_from(&adapter, &frame));
    TEST_ASSERT_FALSE(wait_on(&adapter, 0));
}

static void test_a_wait_lasts_as_long_as_it_shall(void)
{
    int64_t start;

    open_both();
    while (wait_on(&host, 10 * MS)) {
    }
    start = now_us;
    TEST_ASSERT_FALSE(wait_on(&host, 25500));
    TEST_ASSERT_EQUAL_INT64(25500, now_us - start);
}

static volatile sig_atomic_t alarms;

static void count_alarm(int number)
{
    (void)number;
    alarms++;
}

static void test_a_signal_ends_an_endless_wait(void)
{
    const struct sigaction action = {.sa_handler = count_alarm};
    const struct itimerval soon = {.it_value = {.tv_usec = 50 * MS}, .it_interval = {.tv_usec = 50 * MS}};
    const struct itimerval never = {.it_value = {.tv_usec = 0}};

    open_link(&adapter, pty_name);
    alarms = 0;
    (void)sigaction(SIGALRM, &action, NULL);
    (void)setitimer(ITIMER_REAL, &soon, NULL);
    TEST_ASSERT_FALSE(wait_on(&adapter, -1));
    (void)setitimer(ITIMER_REAL, &never, NULL);
    TEST_ASSERT_TRUE(alarms > 0);
}

static void test_frames_that_do_not_exist_are_refused(void)
{
    const struct jp_can_frame too_long = {.id = 1, .length = 9};

    open_both();
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send_to(&host, 0x800));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, send_to(&adapter, JP_CAN_EXTENDED | 0x20000000));
    TEST_ASSERT_EQUAL_INT(JP_ERR_ARGUMENT, host.port.send(host.port.context, &too_long));
}

/* ---- Ends that go and come back ---- */

static void test_an_adapter_is_down_until_a_host_has_come(void)
{
    struct jp_can_frame frame;

    open_link(&adapter, pty_name);
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&adapter));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&adapter, 1));
    TEST_ASSERT_FALSE(receive_from(&adapter, &frame));
    open_link(&host, slcan_name);
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&host));
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&host, 1));
    await_state(&host, JP_CAN_ON);
    check_both_talk();
}

static void test_a_host_goes_and_another_comes(void)
{
    open_both();
    for (int i = 0; i < 5; i++) {
        TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&adapter, 0x55));
        close_link(&host);
        await_state(&adapter, JP_CAN_DOWN);
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&adapter, 1));
        open_link(&host, slcan_name);
        await_state(&host, JP_CAN_ON);
        await_state(&adapter, JP_CAN_ON);
        check_both_talk();
    }
}

/* A program that is killed says no C. */
static void test_a_host_that_dies_is_noticed(void)
{
    int far_end;

    open_link(&adapter, pty_name);
    far_end = open(path, O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(far_end >= 0);
    TEST_ASSERT_TRUE(write(far_end, "O\rt1001", 7) == 7);
    await_state(&adapter, JP_CAN_ON);
    TEST_ASSERT_EQUAL_INT(JP_OK, send_to(&adapter, 1));
    (void)close(far_end);
    await_state(&adapter, JP_CAN_DOWN);
    open_link(&host, slcan_name);
    await_state(&host, JP_CAN_ON);
    check_both_talk();
}

static void test_an_adapter_goes_and_another_comes_under_its_name(void)
{
    open_both();
    for (int i = 0; i < 3; i++) {
        close_link(&adapter);
        TEST_ASSERT_TRUE(access(path, F_OK) != 0);
        await_state(&host, JP_CAN_DOWN);
        TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&host, 1));
        open_link(&adapter, pty_name);
        await_state(&host, JP_CAN_ON);
        await_state(&adapter, JP_CAN_ON);
        check_both_talk();
    }
}

/* Polling a terminal that has hung up returns at once; the wait must not. */
static void test_waiting_for_a_host_costs_no_processor(void)
{
    int64_t start;

    open_both();
    close_link(&host);
    await_state(&adapter, JP_CAN_DOWN);
    start = now_us;
    waits = 0;
    TEST_ASSERT_FALSE(wait_on(&adapter, 300 * MS));
    TEST_ASSERT_EQUAL_INT64(300 * MS, now_us - start);
    TEST_ASSERT_EQUAL_UINT(30, waits);
}

/* ---- An adapter in the test's hands ---- */

static int near_end;

static void make_adapter(void)
{
    struct termios settings;

    near_end = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    TEST_ASSERT_TRUE(near_end >= 0 && grantpt(near_end) == 0 && unlockpt(near_end) == 0);
    TEST_ASSERT_TRUE(tcgetattr(near_end, &settings) == 0);
    cfmakeraw(&settings);
    TEST_ASSERT_TRUE(tcsetattr(near_end, TCSANOW, &settings) == 0);
    (void)snprintf(slcan_name, sizeof slcan_name, "slcan:%s", ptsname(near_end));
}

static void end_adapter(void)
{
    close_link(&host);
    (void)close(near_end);
    (void)snprintf(slcan_name, sizeof slcan_name, "slcan:%s", path);
}

/* Lets the host work until it has said the text; before that it may have said more, if the test was slow. */
static void expect_said(const char *text)
{
    const int64_t end = now_us + LATER_US;
    char said[1024] = "";
    size_t length = 0;

    while (strstr(said, text) == NULL && length < sizeof said - 1 && now_us < end) {
        const ssize_t got = read(near_end, &said[length], sizeof said - 1 - length);

        length += got > 0 ? (size_t)got : 0;
        said[length] = '\0';
        (void)wait_on(&host, MS);
    }
    TEST_ASSERT_TRUE_MESSAGE(strstr(said, text) != NULL, said);
}

static void say(const char *text)
{
    TEST_ASSERT_TRUE(write(near_end, text, strlen(text)) == (ssize_t)strlen(text));
    (void)wait_on(&host, 20 * MS);
}

static void test_a_silent_adapter_is_down_and_asked_again(void)
{
    make_adapter();
    open_link(&host, slcan_name);
    expect_said("C\rS8\rO\rS8\rO\rS8\rO\r");
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&host));
    say("\r\r\r");
    await_state(&host, JP_CAN_ON);
    end_adapter();
}

static void test_an_adapter_that_was_reset_is_asked_again(void)
{
    struct jp_can_frame frame;
    int64_t asked;

    make_adapter();
    open_link(&host, slcan_name);
    expect_said("C\rS8\rO\r");
    say("\r\r\r");
    /* On a bus without a frame it is asked from time to time; LAWICEL's refuses while it is open. */
    expect_said("S8\rO\r");
    say("\a\at1000\r");
    TEST_ASSERT_TRUE(wait_on(&host, LATER_US));
    TEST_ASSERT_TRUE(receive_from(&host, &frame));
    await_state(&host, JP_CAN_ON);
    /* After a reset it refuses frames. */
    (void)wait_on(&host, 150 * MS);
    TEST_ASSERT_EQUAL_INT(JP_OK, host.port.send(host.port.context, &frame));
    expect_said("t1000\r");
    say("\a");
    asked = now_us;
    expect_said("S8\rO\r");
    TEST_ASSERT_TRUE(now_us - asked < 400 * MS);
    end_adapter();
}

static void test_an_adapter_that_says_nothing_more_is_down(void)
{
    make_adapter();
    open_link(&host, slcan_name);
    expect_said("C\rS8\rO\r");
    say("\r\r\r");
    await_state(&host, JP_CAN_ON);
    await_state(&host, JP_CAN_DOWN);
    TEST_ASSERT_EQUAL_INT(JP_ERR_HARDWARE, send_to(&host, 1));
    say("z\r");
    await_state(&host, JP_CAN_ON);
    end_adapter();
}

static void test_garbage_is_no_answer(void)
{
    make_adapter();
    open_link(&host, slcan_name);
    say("V1013\rwhat\rt9990\r");
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&host));
    end_adapter();
}

/* ---- A host in the test's hands ---- */

static int open_far_end(void)
{
    const int far_end = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK);

    TEST_ASSERT_TRUE(far_end >= 0);
    return far_end;
}

/* Lets the adapter work until it has answered all of `text`. */
static void expect_answer(int far_end, const char *question, const char *text)
{
    const int64_t end = now_us + LATER_US;
    char answer[64] = "";
    size_t length = 0;

    TEST_ASSERT_TRUE(write(far_end, question, strlen(question)) == (ssize_t)strlen(question));
    while (length < strlen(text) && now_us < end) {
        ssize_t got;

        (void)wait_on(&adapter, MS);
        got = read(far_end, &answer[length], sizeof answer - 1 - length);
        length += got > 0 ? (size_t)got : 0;
        answer[length] = '\0';
    }
    TEST_ASSERT_EQUAL_STRING(text, answer);
}

static void test_an_adapter_answers_as_an_adapter_does(void)
{
    int far_end;
    struct jp_can_frame frame;

    open_link(&adapter, pty_name);
    far_end = open_far_end();
    expect_answer(far_end, "t1000\r", "\a");
    TEST_ASSERT_FALSE(receive_from(&adapter, &frame));
    expect_answer(far_end, "C\rS8\rO\r", "\r\r\r");
    expect_answer(far_end, "t1000\r", "z\r");
    TEST_ASSERT_TRUE(receive_from(&adapter, &frame));
    expect_answer(far_end, "T000000010\r", "Z\r");
    TEST_ASSERT_TRUE(receive_from(&adapter, &frame));
    expect_answer(far_end, "N\r", "NJP01\r");
    expect_answer(far_end, "S6\r", "\a");
    expect_answer(far_end, "t1009\r", "\a");
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(&adapter));
    expect_answer(far_end, "C\r", "\r");
    TEST_ASSERT_EQUAL_INT(JP_CAN_DOWN, state_of(&adapter));
    (void)close(far_end);
}

/* Each call does a bounded amount of work, whatever the host sends; none of it becomes a frame. */
static void test_a_flood_of_garbage(void)
{
    struct jp_can_frame frame;
    char garbage[1000];
    size_t sent = 0;
    int far_end;

    open_link(&adapter, pty_name);
    far_end = open_far_end();
    expect_answer(far_end, "O\r", "\r");
    for (size_t i = 0; i < sizeof garbage; i++) {
        garbage[i] = "t1\r2\xFF\rz?"[i % 8];
    }
    while (sent < 2000000) {
        const ssize_t written = write(far_end, garbage, sizeof garbage);

        sent += written > 0 ? (size_t)written : 0;
        TEST_ASSERT_FALSE(receive_from(&adapter, &frame));
        (void)tcflush(far_end, TCIFLUSH);
    }
    while (wait_on(&adapter, 20 * MS)) {
        TEST_FAIL();
    }
    (void)close(far_end);
    await_state(&adapter, JP_CAN_DOWN);
    open_link(&host, slcan_name);
    await_state(&host, JP_CAN_ON);
    check_both_talk();
}

/* ---- Floods of frames ---- */

/* Sends until there is no room; returns the number of frames. */
static uint32_t flood(struct jp_can_link *link)
{
    uint32_t sent = 0;
    enum jp_status status;

    do {
        status = send_to(link, sent % 0x800);
        sent += status == JP_OK ? 1U : 0U;
    } while (status == JP_OK && sent < 1000000);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, status);
    return sent;
}

static void check_flood(struct jp_can_link *from, struct jp_can_link *to)
{
    struct jp_can_frame frame;
    const uint32_t sent = flood(from);

    TEST_ASSERT_TRUE(sent < 20000);
    TEST_ASSERT_EQUAL_INT(JP_ERR_BUSY, send_to(from, 1));
    TEST_ASSERT_EQUAL_INT(JP_CAN_ON, state_of(from));
    for (uint32_t i = 0; i < sent; i++) {
        while (!wait_on(to, 0)) {
            TEST_ASSERT_FALSE(wait_on(from, 0));
        }
        TEST_ASSERT_TRUE(receive_from(to, &frame));
        TEST_ASSERT_EQUAL_HEX32(i % 0x800, frame.id);
        TEST_ASSERT_EQUAL_HEX8((uint8_t)(i % 0x800), frame.data[7]);
    }
    TEST_ASSERT_FALSE(wait_on(to, 20 * MS));
}

static void test_what_a_peer_does_not_read_is_refused_and_nothing_taken_is_lost(void)
{
    open_both();
    check_flood(&adapter, &host);
    check_flood(&host, &adapter);
    check_both_talk();
}

static void test_a_host_that_never_reads_blocks_no_adapter(void)
{
    struct jp_can_frame frame;
    int far_end;

    open_link(&adapter, pty_name);
    far_end = open_far_end();
    TEST_ASSERT_TRUE(write(far_end, "O\r", 2) == 2);
    await_state(&adapter, JP_CAN_ON);
    (void)flood(&adapter);
    TEST_ASSERT_TRUE(write(far_end, "t1230\r", 6) == 6);
    TEST_ASSERT_TRUE(wait_on(&adapter, LATER_US));
    TEST_ASSERT_TRUE(receive_from(&adapter, &frame));
    TEST_ASSERT_EQUAL_HEX32(0x123, frame.id);
    (void)close(far_end);
    await_state(&adapter, JP_CAN_DOWN);
    open_link(&host, slcan_name);
    await_state(&host, JP_CAN_ON);
    await_state(&adapter, JP_CAN_ON);
    while (wait_on(&host, 20 * MS)) {
        TEST_ASSERT_TRUE(receive_from(&host, &frame));
    }
    check_both_talk();
}

int main(void)
{
    if (!make_folder()) {
        return 1;
    }
    UNITY_BEGIN();
    run_tests();
    (void)rmdir(folder);
    return UNITY_END();
}
