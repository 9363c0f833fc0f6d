#include "hal/linux/periodic.h"

#include <errno.h>
#include <time.h>

#define NS_A_SECOND 1000000000
#define NS_A_US     1000

static int64_t monotonic_ns(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * NS_A_SECOND + now.tv_nsec;
}

int64_t jp_monotonic_us(void)
{
    return monotonic_ns() / NS_A_US;
}

void jp_periodic_start(struct jp_periodic *periodic, uint32_t period_ns)
{
    *periodic = (struct jp_periodic){.period_ns = period_ns, .next_ns = monotonic_ns() + period_ns};
}

static void sleep_until(int64_t time_ns)
{
    const struct timespec time = {.tv_sec = (time_t)(time_ns / NS_A_SECOND), .tv_nsec = (long)(time_ns % NS_A_SECOND)};

    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, NULL) == EINTR) {
    }
}

static void note_lateness(struct jp_periodic *periodic, int64_t lateness_us)
{
    const uint32_t lateness = lateness_us < UINT32_MAX ? (uint32_t)lateness_us : UINT32_MAX;

    if (lateness > periodic->worst_lateness_us) {
        periodic->worst_lateness_us = lateness;
    }
}

uint64_t jp_periodic_wait(struct jp_periodic *periodic)
{
    int64_t lateness_ns;
    uint64_t missed;

    sleep_until(periodic->next_ns);
    lateness_ns = monotonic_ns() - periodic->next_ns;
    missed = (uint64_t)lateness_ns / periodic->period_ns;
    periodic->ticks++;
    periodic->missed += missed;
    periodic->next_ns += (int64_t)(missed + 1U) * periodic->period_ns;
    note_lateness(periodic, lateness_ns / NS_A_US);
    return missed;
}
