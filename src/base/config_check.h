/** The check of a configuration: a table of its fields and what each may be. Private to the core. */
#ifndef JOULEPATH_BASE_CONFIG_CHECK_H
#define JOULEPATH_BASE_CONFIG_CHECK_H

#include <joulepath/status.h>
#include <stddef.h>
#include <stdint.h>

/** A number of 4 bytes, of 2 or 1 without sign, or an array of 4 bytes each. One of 4 bytes without sign is at most
 *  INT32_MAX when `low` is not negative. */
struct jp_config_field {
    const char *name; /**< with its path */
    int32_t low;
    int32_t high;
    uint16_t offset; /**< in the configuration */
    uint16_t bytes;
};

/** An entry of the table: a member of `type`. */
#define JP_CONFIG_FIELD_NAMED(name, type, member, least, most)                                                         \
    {                                                                                                                  \
        name, (least), (most), (uint16_t)offsetof(type, member), (uint16_t)sizeof(((type *)NULL)->member)              \
    }

/** Its name follows `path`. */
#define JP_CONFIG_FIELD(path, type, member, least, most) JP_CONFIG_FIELD_NAMED(path #member, type, member, least, most)

#define JP_CONFIG_COUNT(fields) (sizeof(fields) / sizeof(fields)[0])

/** Ticks a second of the control interrupt, in every module that it calls. */
#define JP_TICK_RATE_MIN 100
#define JP_TICK_RATE_MAX 10000

/** JP_ERR_CONFIG: *field names the first one out of its range. JP_ERR_ARGUMENT: `config` or `field` is null. JP_OK:
 *  *field is null; how fields must relate is for the caller to check. */
enum jp_status jp_config_check(const void *config, const struct jp_config_field *fields, size_t count,
                               const char **field);

/** What a check returns that finds the field `name` to be wrong. */
static inline enum jp_status jp_config_refuse(const char *name, const char **field)
{
    *field = name;
    return JP_ERR_CONFIG;
}

#endif
