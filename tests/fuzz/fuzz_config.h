/** What every check promises of the configuration that it is given, and ranges of what comes out. */
#ifndef JOULEPATH_TESTS_FUZZ_FUZZ_CONFIG_H
#define JOULEPATH_TESTS_FUZZ_FUZZ_CONFIG_H

#include <joulepath/status.h>

#include "tests/fuzz/fuzz_input.h"

/** The verdict of a check, or of an init with nothing else to refuse: one that refuses names the field. */
static inline bool fuzz_accepted(enum jp_status status, const char *field)
{
    fuzz_require(status == JP_OK || (status == JP_ERR_CONFIG && field != NULL && field[0] != '\0'), "a nameless field");
    return status == JP_OK;
}

static inline bool fuzz_within(int32_t x, int32_t limit)
{
    return x <= limit && x >= -limit;
}

#endif
