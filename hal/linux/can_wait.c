#include "hal/linux/can_wait.h"

#include <time.h>

#include "hal/linux/periodic.h"

/** How often fetch() looks after the bus while nothing arrives, µs. */
#define SLICE_US 10000

#define US_A_SECOND 1000000
#define NS_A_US     1000

/** False: a signal came. */
static bool wait_slice(const struct jp_can_source *source, int64_t us)
{
    const struct timespec time = {.tv_sec = (time_t)(us / US_A_SECOND), .tv_nsec = (long)(us % US_A_SECOND * NS_A_US)};
    struct pollfd descriptor = source->descriptor(source->context);

    return ppoll(&descriptor, 1, &time, NULL) >= 0;
}

bool jp_can_wait(const struct jp_can_source *source, int64_t timeout_us)
{
    const int64_t start = jp_monotonic_us();

    while (!source->fetch(source->context)) {
        const int64_t left = timeout_us < 0 ? SLICE_US : timeout_us - (jp_monotonic_us() - start);

        if (left <= 0 || !wait_slice(source, left < SLICE_US ? left : SLICE_US)) {
            return false;
        }
    }
    return true;
}
