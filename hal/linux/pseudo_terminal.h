/** A new pseudo-terminal whose far end has a name of the user's choice: a symbolic link. */
#ifndef JOULEPATH_HAL_LINUX_PSEUDO_TERMINAL_H
#define JOULEPATH_HAL_LINUX_PSEUDO_TERMINAL_H

#include <stdbool.h>

/** Longest path of the link and of what it leads to, with the ending zero. */
#define JP_PSEUDO_TERMINAL_PATH 256U

struct jp_pseudo_terminal {
    int descriptor; /**< of the near end, non-blocking; the terminal is in raw mode */
    char path[JP_PSEUDO_TERMINAL_PATH];
    char far_end[JP_PSEUDO_TERMINAL_PATH];
};

/**
 * Makes the terminal and the link. False after one line in `error` (at most `size` bytes): there is something else at
 * `path`, or what the system says. A link that leads nowhere was left by a process that was killed, and is replaced.
 */
bool jp_pseudo_terminal_open(struct jp_pseudo_terminal *terminal, const char *path, char *error, unsigned size);

/** Removes the link, if it is still this terminal's. The descriptor stays the caller's. */
void jp_pseudo_terminal_unlink(const struct jp_pseudo_terminal *terminal);

#endif
