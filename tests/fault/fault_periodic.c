/* The periodic loop: it keeps to the multiples of its period, and counts what it misses. Time is the test's: it passes
 * in sleeps and where a test lets it pass. */
#include <errno.h>
#include <time.h>

#include "hal/linux/periodic.h"
#include "unity.h"

#define MS_NS     1000000
#define SECOND_NS 1000000000
#define START_NS  5123456789

static struct jp_periodic periodic;
static int64_t now_ns;
static int64_t late_ns;      /* how long after its time a sleep ends */
static unsigned interrupts;  /* signals that are still to end a sleep before its time */
static int64_t interrupt_ns; /* after so long */

void setUp(void)
{
    now_ns = START_NS;
    late_ns = 0;
    interrupts = 0;
}

void tearDown(void)
{
}

/* In place of the C library's. */
int clock_gettime(clockid_t clock, struct timespec *time)
{
    TEST_ASSERT_EQUAL_INT(CLOCK_MONOTONIC, clock);
    *time = (struct timespec){.tv_sec = (time_t)(now_ns / SECOND_NS), .tv_nsec = (long)(now_ns % SECOND_NS)};
    return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const struct timespec *time, struct timespec *left)
{
    const int64_t end_ns = (int64_t)time->tv_sec * SECOND_NS + time->tv_nsec;

    TEST_ASSERT_EQUAL_INT(CLOCK_MONOTONIC, clock);
    TEST_ASSERT_EQUAL_INT(TIMER_ABSTIME, flags);
    TEST_ASSERT_NULL(left);
    TEST_ASSERT_TRUE(time->tv_nsec >= 0 && time->tv_nsec < SECOND_NS);
    if (interrupts > 0 && now_ns + interrupt_ns < end_ns) {
        interrupts--;
        now_ns += interrupt_ns;
        return EINTR;
    }
    now_ns = (end_ns > now_ns ? end_ns : now_ns) + late_ns;
    return 0;
}

static void test_the_clock_counts_microseconds(void)
{
    TEST_ASSERT_EQUAL_INT64(5123456, jp_monotonic_us());
    now_ns += 211;
    TEST_ASSERT_EQUAL_INT64(5123457, jp_monotonic_us());
}

static void test_a_wait_ends_with_its_period(void)
{
    jp_periodic_start(&periodic, 2 * MS_NS);
    for (int i = 1; i <= 100; i++) {
        TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
        TEST_ASSERT_EQUAL_INT64(START_NS + i * 2 * MS_NS, now_ns);
    }
    TEST_ASSERT_EQUAL_UINT64(100, periodic.ticks);
    TEST_ASSERT_EQUAL_UINT64(0, periodic.missed);
    TEST_ASSERT_EQUAL_UINT32(0, periodic.worst_lateness_us);
}

static void test_work_within_the_period_does_not_lengthen_it(void)
{
    jp_periodic_start(&periodic, 20 * MS_NS);
    for (int i = 1; i <= 20; i++) {
        now_ns += i * MS_NS - 1;
        TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
        TEST_ASSERT_EQUAL_INT64(START_NS + i * 20 * MS_NS, now_ns);
    }
}

/* A sleep may end late, as on a machine with more to do: that does not add up. */
static void test_late_ends_are_noted_and_do_not_add_up(void)
{
    jp_periodic_start(&periodic, 10 * MS_NS);
    for (int i = 1; i <= 9; i++) {
        late_ns = i * MS_NS;
        TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
        TEST_ASSERT_EQUAL_INT64(START_NS + i * 11 * MS_NS, now_ns);
        TEST_ASSERT_EQUAL_UINT32(1000 * i, periodic.worst_lateness_us);
    }
    late_ns = MS_NS;
    TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
    TEST_ASSERT_EQUAL_UINT32(9000, periodic.worst_lateness_us);
}

/* A period counts as missed when it is over before the wait ends. */
static void test_a_long_tick_misses_periods(void)
{
    static const struct {
        int64_t took_ns;
        uint64_t missed;
    } ticks[] = {{10 * MS_NS, 0}, {20 * MS_NS - 1, 0}, {20 * MS_NS, 1}, {55 * MS_NS, 4}, {1000 * MS_NS, 99}};

    for (size_t i = 0; i < sizeof ticks / sizeof ticks[0]; i++) {
        setUp();
        jp_periodic_start(&periodic, 10 * MS_NS);
        now_ns += ticks[i].took_ns;
        TEST_ASSERT_EQUAL_UINT64(ticks[i].missed, jp_periodic_wait(&periodic));
        TEST_ASSERT_EQUAL_UINT64(ticks[i].missed, periodic.missed);
        TEST_ASSERT_EQUAL_UINT64(1, periodic.ticks);
        TEST_ASSERT_EQUAL_UINT32((ticks[i].took_ns - 10 * MS_NS) / 1000, periodic.worst_lateness_us);
    }
    for (int i = 0; i < 3; i++) {
        now_ns += 35 * MS_NS;
        (void)jp_periodic_wait(&periodic);
    }
    TEST_ASSERT_EQUAL_UINT64(99 + 2 + 3 + 2, periodic.missed);
    TEST_ASSERT_EQUAL_UINT64(4, periodic.ticks);
}

/* After a pause the loop does not run faster to catch up: the next wait ends at the next multiple. */
static void test_the_grid_stays_after_a_pause(void)
{
    jp_periodic_start(&periodic, 10 * MS_NS);
    now_ns += 33 * MS_NS;
    TEST_ASSERT_EQUAL_UINT64(2, jp_periodic_wait(&periodic));
    TEST_ASSERT_EQUAL_INT64(START_NS + 33 * MS_NS, now_ns);
    for (int i = 4; i < 7; i++) {
        TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
        TEST_ASSERT_EQUAL_INT64(START_NS + i * 10 * MS_NS, now_ns);
    }
}

static void test_signals_do_not_end_a_wait(void)
{
    interrupts = 49;
    interrupt_ns = MS_NS;
    jp_periodic_start(&periodic, 50 * MS_NS);
    TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
    TEST_ASSERT_EQUAL_UINT(0, interrupts);
    TEST_ASSERT_EQUAL_INT64(START_NS + 50 * MS_NS, now_ns);
}

static void test_the_shortest_and_the_longest_period(void)
{
    jp_periodic_start(&periodic, 1);
    late_ns = 12345;
    TEST_ASSERT_EQUAL_UINT64(12345, jp_periodic_wait(&periodic));
    late_ns = 0;
    jp_periodic_start(&periodic, UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT64(0, jp_periodic_wait(&periodic));
    TEST_ASSERT_EQUAL_INT64(START_NS + 1 + 12345 + UINT32_MAX, now_ns);
}

static void test_lateness_saturates(void)
{
    jp_periodic_start(&periodic, MS_NS);
    late_ns = (int64_t)UINT32_MAX * 1000 + 1000;
    (void)jp_periodic_wait(&periodic);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, periodic.worst_lateness_us);
}
