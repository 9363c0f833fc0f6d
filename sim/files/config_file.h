/** Reading libconfig files with one clear line for each error. */
#ifndef JOULEPATH_SIM_FILES_CONFIG_FILE_H
#define JOULEPATH_SIM_FILES_CONFIG_FILE_H

#include <libconfig.h>
#include <stdbool.h>

/** Parses a file into an initialised configuration. Its arrays become lists, whose numbers may be whole and real. False
 * after one line on stderr: file, line, what, what to do. */
bool config_file_parse(const char *path, config_t *config);

/** The value of a whole or real number; false when the setting is neither. */
bool config_file_number(const config_setting_t *setting, double *value);

#endif
