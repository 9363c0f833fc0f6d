/* Stands in for sim/base/error.c. */
#include "tools/python/native/errors.h"

#include <stdarg.h>
#include <stdio.h>

#include "sim/base/error.h"

static _Thread_local char last[1024];

void error_line(const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(last, sizeof last, format, arguments);
    va_end(arguments);
}

const char *errors_last(void)
{
    return last;
}

void errors_forget(void)
{
    last[0] = '\0';
}
