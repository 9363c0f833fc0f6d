/** The record that outlives a reset, on a host: a file that keeps it when the process is killed. */
#ifndef JOULEPATH_HAL_LINUX_RETAINED_FILE_H
#define JOULEPATH_HAL_LINUX_RETAINED_FILE_H

#include <stdbool.h>

#include "hal/app/retained.h"

struct jp_retained_file {
    int descriptor;
    struct jp_retained *retained; /**< the file's content: what is written here is in the file */
};

/**
 * Maps the file, which is made with zeros (no record) if there is none. False after one line in `error` (at most
 * `size` bytes): not a regular file, of another size, in use by another process, or what the system says.
 */
bool jp_retained_file_open(struct jp_retained_file *file, const char *path, char *error, unsigned size);

/** The file stays. */
void jp_retained_file_close(struct jp_retained_file *file);

#endif
