/** Robot files whose type is "four_wheel": four steered and driven wheels, a laser scanner, and how the robot is
 * driven. */
#ifndef JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_FILE_H
#define JOULEPATH_SIM_FOUR_WHEEL_FOUR_WHEEL_FILE_H

#include <joulepath/four_wheel.h>

#include "sim/four_wheel/four_wheel_constants.h"

/** Of struct four_wheel_file. */
extern const struct config_kind four_wheel_kind;

/**
 * Reads and checks a robot file. On failure prints one line on stderr (file, key or line, what, what to do), returns
 * false, and *robot is not to be used.
 */
bool four_wheel_file_load(const char *path, struct four_wheel_file *robot);

/** What the core needs of it, for FOUR_WHEEL_RATE_HZ. jp_four_wheel_check() accepts that of every robot that loads. */
struct jp_four_wheel_config four_wheel_config(const struct four_wheel_file *robot);

#endif
