/** Files of a fuzz target's input, for readers that say what is wrong in one line on stderr. */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_FILE_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_FILE_H

#include <sys/mman.h>
#include <unistd.h>

#include "tests/fuzz/fuzz_input.h"

#define FUZZ_LINE_MAX 4096

/** Loads a file with this content. */
static inline void fuzz_file_load(const uint8_t *bytes, size_t size, bool (*load)(const char *path))
{
    static char said[FUZZ_LINE_MAX];
    FILE *const own = stderr;
    char path[64];
    const int file = memfd_create("fuzz", 0);

    fuzz_require(file >= 0 && write(file, bytes, size) == (ssize_t)size, "no memory for a file");
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    memset(said, 0, sizeof said);
    stderr = fmemopen(said, sizeof said - 1U, "w");

    const bool taken = load(path);

    (void)fclose(stderr);
    stderr = own;
    (void)close(file);

    const size_t length = strlen(said);
    const char *end = memchr(said, '\n', sizeof said);

    fuzz_require(!taken || length == 0U, "words about a file that is taken");
    fuzz_require(taken || (length > 1U && end == said + length - 1U), "not one line about a file that is refused");
}

#endif
