/**
 * A robot's constants, read from a libconfig file (sim/robots/). Keys carry their unit; one table of fields drives
 * loading, checking and printing.
 */
#ifndef JOULEPATH_SIM_BALANCER_ROBOT_FILE_H
#define JOULEPATH_SIM_BALANCER_ROBOT_FILE_H

#include "sim/balancer/robot_constants.h"

/** The file's fields. */
extern const struct config_kind robot_kind;

/**
 * Reads and checks a robot file. On failure prints one line on stderr (file, key or line, what, what to do), returns
 * false, and *robot is not to be used.
 */
bool robot_file_load(const char *path, struct robot_file *robot);

/** The same checks of a robot that was made otherwise. On failure prints one line on stderr that begins with `source`.
 */
bool robot_file_check(const char *source, const struct robot_file *robot);

#endif
