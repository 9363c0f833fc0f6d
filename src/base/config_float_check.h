/** The check of a configuration whose numbers are of single precision: config_check.h for them. Private to
 *  libjoulepath_float. */
#ifndef JOULEPATH_BASE_CONFIG_FLOAT_CHECK_H
#define JOULEPATH_BASE_CONFIG_FLOAT_CHECK_H

#include "src/base/config_check.h"

/** A float, or a number of 2 bytes or 1 without sign. JP_CONFIG_FIELD() makes an entry. */
struct jp_config_float_field {
    const char *name; /**< with its path */
    float low;
    float high;
    uint16_t offset; /**< in the configuration */
    uint16_t bytes;
};

/** As jp_config_check(). What is not a number is out of its range. */
enum jp_status jp_config_float_check(const void *config, const struct jp_config_float_field *fields, size_t count,
                                     const char **field);

#endif
