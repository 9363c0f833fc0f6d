/* The periodic loop: it keeps to the multiples of its period, and counts what it misses. */
#include <signal.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "hal/linux/periodic.h"
#include "unity.h"

#define MS_NS 1000000
#define MS_US 1000

static struct jp_periodic periodic;

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_the_clock_counts_microseconds(void)
{
    struct timespec now;
    const int64_t before = jp_monotonic_us();

    (void)usleep(20 * MS_US);
    TEST_ASSERT_TRUE(jp_monotonic_us() - before >= 20 * MS_US);
    TEST_ASSERT_TRUE(clock_gettime(CLOCK_MONOTONIC, &now) == 0);
    TEST_ASSERT_INT64_WITHIN(MS_US * MS_US, (int64_t)now.tv_sec * MS_US * MS_US + now.tv_nsec / 1000,
                             jp_monotonic_us());
}

/* On a machine with more to do than this some periods are missed: they count, and the time is still right. */
static void test_ticks_and_missed_periods_are_all_periods(void)
{
    int64_t start;
    int64_t lasted;
    uint64_t missed = 0;

    start = jp_monotonic_us();
    jp_periodic_start(&periodic, 2 * MS_NS);
    for (int i = 0; i < 100; i++) {
        missed += jp_periodic_wait(&periodic);
    }
    lasted = jp_monotonic_us() - start;
    TEST_ASSERT_EQUAL_UINT64(100, periodic.ticks);
    TEST_ASSERT_EQUAL_UINT64(missed, periodic.missed);
    TEST_ASSERT_TRUE(lasted >= (int64_t)(periodic.ticks + periodic.missed) * 2 * MS_US);
    TEST_ASSERT_TRUE(lasted / (2 * MS_US) <= (int64_t)(periodic.ticks + periodic.missed) + 50);
}

static void test_work_within_the_period_does_not_lengthen_it(void)
{
    const int64_t start = jp_monotonic_us();
    int64_t periods;
    int64_t lasted;

    jp_periodic_start(&periodic, 20 * MS_NS);
    for (int i = 0; i < 20; i++) {
        (void)usleep(10 * MS_US);
        (void)jp_periodic_wait(&periodic);
    }
    lasted = jp_monotonic_us() - start;
    periods = (int64_t)(periodic.ticks + periodic.missed);
    TEST_ASSERT_TRUE(lasted >= periods * 20 * MS_US);
    TEST_ASSERT_TRUE(lasted < periods * 20 * MS_US + 20 * 5 * MS_US);
}

static void test_a_long_tick_misses_periods(void)
{
    uint64_t missed;

    jp_periodic_start(&periodic, 10 * MS_NS);
    (void)jp_periodic_wait(&periodic);
    periodic.missed = 0;
    periodic.worst_lateness_us = 0;
    (void)usleep(55 * MS_US);
    missed = jp_periodic_wait(&periodic);
    TEST_ASSERT_TRUE(missed >= 4);
    TEST_ASSERT_EQUAL_UINT64(missed, periodic.missed);
    TEST_ASSERT_TRUE(periodic.worst_lateness_us >= 40 * MS_US);
    TEST_ASSERT_TRUE(periodic.worst_lateness_us / (10 * MS_US) == missed);
    TEST_ASSERT_EQUAL_UINT64(2, periodic.ticks);
}

/* After a pause the loop does not run faster to catch up: the next wait ends at the next multiple. */
static void test_the_grid_stays_after_a_pause(void)
{
    int64_t first_ns;
    int64_t before_ns;

    jp_periodic_start(&periodic, 10 * MS_NS);
    first_ns = periodic.next_ns;
    (void)usleep(33 * MS_US);
    for (int i = 0; i < 3; i++) {
        before_ns = jp_monotonic_us() * 1000;
        (void)jp_periodic_wait(&periodic);
        TEST_ASSERT_TRUE((periodic.next_ns - first_ns) % (10 * MS_NS) == 0);
        TEST_ASSERT_TRUE(periodic.next_ns > before_ns);
    }
}

static volatile sig_atomic_t alarms;

static void count_alarm(int number)
{
    (void)number;
    alarms++;
}

static void test_signals_do_not_end_a_wait(void)
{
    const struct sigaction action = {.sa_handler = count_alarm};
    const struct itimerval often = {.it_value = {.tv_usec = MS_US}, .it_interval = {.tv_usec = MS_US}};
    const struct itimerval never = {.it_value = {.tv_usec = 0}};
    const int64_t start = jp_monotonic_us();

    (void)sigaction(SIGALRM, &action, NULL);
    (void)setitimer(ITIMER_REAL, &often, NULL);
    jp_periodic_start(&periodic, 50 * MS_NS);
    (void)jp_periodic_wait(&periodic);
    (void)setitimer(ITIMER_REAL, &never, NULL);
    TEST_ASSERT_TRUE(jp_monotonic_us() - start >= 50 * MS_US);
    TEST_ASSERT_TRUE(alarms > 1);
}

static void test_the_shortest_and_the_longest_period(void)
{
    jp_periodic_start(&periodic, 1);
    for (int i = 0; i < 10; i++) {
        TEST_ASSERT_TRUE(jp_periodic_wait(&periodic) < 4000000000U);
    }
    jp_periodic_start(&periodic, UINT32_MAX);
    TEST_ASSERT_TRUE(periodic.next_ns / 1000 - jp_monotonic_us() > 4290000);
}
