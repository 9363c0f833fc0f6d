#include "progress.h"

#include <stdio.h>
#include <unistd.h>

#define BAR_WIDTH 40

void progress_show(const char *what, size_t done, size_t total)
{
    static const char bar[] = "########################################";
    size_t before = done == 0 ? 0 : (done - 1) * 100 / total;
    size_t percent = done * 100 / total;
    int filled = (int)(percent * BAR_WIDTH / 100);

    if ((done != 0 && percent == before) || isatty(STDERR_FILENO) == 0) {
        return;
    }
    (void)fprintf(stderr, "\r%-24s [%-*.*s] %3zu %%", what, BAR_WIDTH, filled, bar, percent);
}

void progress_end(void)
{
    if (isatty(STDERR_FILENO) != 0) {
        (void)fprintf(stderr, "\r%*s\r", BAR_WIDTH + 36, "");
    }
}
