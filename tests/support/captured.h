/** What is said on stderr between two calls. */
#ifndef JOULEPATH_TESTS_SUPPORT_CAPTURED_H
#define JOULEPATH_TESTS_SUPPORT_CAPTURED_H

#include <stdio.h>
#include <unistd.h>

#include "unity.h"

static char errors[4096];
static FILE *captured_file;
static int captured_stderr;

static inline void capture_begin(void)
{
    (void)fflush(stderr);
    captured_file = tmpfile();
    TEST_ASSERT_NOT_NULL(captured_file);
    captured_stderr = dup(STDERR_FILENO);
    (void)dup2(fileno(captured_file), STDERR_FILENO);
}

/** Leaves what was said in `errors`. */
static inline void capture_end(void)
{
    (void)fflush(stderr);
    (void)dup2(captured_stderr, STDERR_FILENO);
    (void)close(captured_stderr);
    rewind(captured_file);
    errors[fread(errors, 1, sizeof errors - 1, captured_file)] = '\0';
    (void)fclose(captured_file);
}

#endif
