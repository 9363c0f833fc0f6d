/** A progress bar on stderr: redrawn on a terminal, silent elsewhere. */
#ifndef JOULEPATH_SIM_BASE_PROGRESS_H
#define JOULEPATH_SIM_BASE_PROGRESS_H

#include <stddef.h>

/** Shows `done` of `total`; cheap enough for each step: it draws only what changes; one bar at a time. */
void progress_show(const char *what, size_t done, size_t total);

/** Clears the bar. */
void progress_end(void);

#endif
