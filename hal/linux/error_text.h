/** The one line that says why something could not be opened. */
#ifndef JOULEPATH_HAL_LINUX_ERROR_TEXT_H
#define JOULEPATH_HAL_LINUX_ERROR_TEXT_H

#include <stdbool.h>

/** Writes at most `size` bytes. Always false, so that a failing function can return it. */
bool jp_error_text(char *error, unsigned size, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
