/** Robot files that are spoilt in one line of a sound one. */
#ifndef JOULEPATH_TESTS_SUPPORT_BAD_CONFIG_H
#define JOULEPATH_TESTS_SUPPORT_BAD_CONFIG_H

#include "tests/support/bad_file.h"

static char sound[BAD_FILE_MAX];

/* libconfig loses the text of a string without an end. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libconfig";
}

/** The sound file with the line that sets `key` (group.name) replaced; `line` may be "". */
static inline void write_with_line(const char *key, const char *line)
{
    char group[64];
    char name[64];
    const char *dot = strchr(key, '.');
    (void)snprintf(group, sizeof group, "\n%.*s: {", (int)(dot - key), key);
    (void)snprintf(name, sizeof name, " %s = ", dot + 1);
    const char *start = strstr(sound, group);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, key);
    start = strstr(start, name);
    TEST_ASSERT_NOT_NULL_MESSAGE(start, key);
    write_replaced(sound, start + 1, strchr(start, '\n'), line);
}

#endif
