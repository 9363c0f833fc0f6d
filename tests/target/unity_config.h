/** Sends the output of the assertions to the host of the emulator. Read by unity.h. */
#ifndef UNITY_CONFIG_H
#define UNITY_CONFIG_H

#include "tests/target/target.h"

#ifndef UNITY_OUTPUT_CHAR
#define UNITY_OUTPUT_CHAR(c) target_putchar(c)
#define UNITY_OUTPUT_FLUSH() target_flush()
#endif

#define UNITY_EXCLUDE_FLOAT
#define UNITY_EXCLUDE_STDIO_H

#endif
