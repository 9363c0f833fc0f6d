#include "sim/base/progress.h"

#include <stdint.h>
#include <stdio.h>
#include <unistd.h>

#define BAR_WIDTH 40

/** What was shown last, so that a terminal is asked for and drawn on only when it changes. */
static size_t shown = SIZE_MAX;

void progress_show(const char *what, size_t done, size_t total)
{
    static const char bar[] = "########################################";
    size_t percent = done * 100 / total;
    int filled = (int)(percent * BAR_WIDTH / 100);

    if (percent == shown) {
        return;
    }
    shown = percent;
    if (isatty(STDERR_FILENO) != 0) {
        (void)fprintf(stderr, "\r%-24s [%-*.*s] %3zu %%", what, BAR_WIDTH, filled, bar, percent);
    }
}

void progress_end(void)
{
    shown = SIZE_MAX;
    if (isatty(STDERR_FILENO) != 0) {
        (void)fprintf(stderr, "\r%*s\r", BAR_WIDTH + 36, "");
    }
}
