#include "hal/linux/error_text.h"

#include <stdarg.h>
#include <stdio.h>

bool jp_error_text(char *error, unsigned size, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(error, size, format, arguments);
    va_end(arguments);
    return false;
}
