/** Learned parameters in a file, where a board has flash: the record of hal/storage/parameters.h. */
#ifndef JOULEPATH_SIM_FILES_PARAMETERS_FILE_H
#define JOULEPATH_SIM_FILES_PARAMETERS_FILE_H

#include "hal/storage/parameters.h"

/** What to start with, and what was found; no file: nothing was stored. False after one line on stderr: it cannot be
 *  read. */
bool parameters_file_load(const char *path, uint32_t identity, struct jp_parameters *parameters,
                          enum jp_stored *stored);

/** Replaces the file whole or not at all. False after one line on stderr. */
bool parameters_file_save(const char *path, uint32_t identity, const struct jp_parameters *parameters);

#endif
