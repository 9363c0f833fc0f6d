/** Files that a loader must refuse with one clear line on stderr, which names the file and the culprit. */
#ifndef JOULEPATH_TESTS_SUPPORT_BAD_FILE_H
#define JOULEPATH_TESTS_SUPPORT_BAD_FILE_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/captured.h"

#define BAD_FILE_MAX 16384

static char folder[] = "/tmp/bad_file.XXXXXX";
static char path[64]; /* of the file that the test writes */
static bool (*bad_file_load)(const char *name);

/** Before the tests: a folder for the file `name`, and what loads it. */
static inline void bad_file_begin(const char *name, bool (*load)(const char *name))
{
    if (mkdtemp(folder) == NULL) {
        perror(folder);
        exit(1);
    }
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    bad_file_load = load;
}

static inline void bad_file_end(void)
{
    (void)remove(path);
    (void)rmdir(folder);
}

/** A new file each time: replacing the content of an old one makes some file systems wait for the disk. */
static inline void write_file(const char *text, size_t size)
{
    (void)remove(path);
    FILE *file = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL(file);
    TEST_ASSERT_TRUE(fwrite(text, 1, size, file) == size);
    TEST_ASSERT_TRUE(fclose(file) == 0);
}

static inline size_t read_file(const char *name, char *text, size_t size)
{
    FILE *file = fopen(name, "rb");
    TEST_ASSERT_NOT_NULL(file);
    const size_t length = fread(text, 1, size - 1, file);
    text[length] = '\0';
    (void)fclose(file);
    return length;
}

/** `text` with its part from `start` to `end` replaced. */
static inline void write_replaced(const char *text, const char *start, const char *end, const char *by)
{
    char replaced[BAD_FILE_MAX + 256];
    const int length = snprintf(replaced, sizeof replaced, "%.*s%s%s", (int)(start - text), text, by, end);
    TEST_ASSERT_TRUE(length > 0 && (size_t)length < sizeof replaced);
    write_file(replaced, (size_t)length);
}

static inline bool load(const char *name)
{
    capture_begin();
    const bool loaded = bad_file_load(name);
    capture_end();
    return loaded;
}

static inline void check_one_line(const char *name)
{
    const char *end = strchr(errors, '\n');
    TEST_ASSERT_TRUE_MESSAGE(strncmp(errors, name, strlen(name)) == 0, errors);
    TEST_ASSERT_TRUE_MESSAGE(end != NULL && end[1] == '\0', errors);
}

static inline void check_refused(const char *name, const char *culprit)
{
    TEST_ASSERT_FALSE_MESSAGE(load(name), culprit);
    check_one_line(name);
    TEST_ASSERT_TRUE_MESSAGE(strstr(errors, culprit) != NULL, errors);
}

#endif
