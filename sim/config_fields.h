/** Configuration files of groups of numbers, described by a table of fields; each error is one clear line. */
#ifndef JOULEPATH_SIM_CONFIG_FIELDS_H
#define JOULEPATH_SIM_CONFIG_FIELDS_H

#include <stdbool.h>
#include <stddef.h>

/** Bytes of a robot's name with its end: small letters, digits or '_'. */
#define CONFIG_NAME_SIZE 32

enum config_field_type { CONFIG_FIELD_REAL, CONFIG_FIELD_WHOLE };

/** A number in a group of the file and where it goes: a double or, of a whole number, an int. */
struct config_field {
    const char *key; /**< group.name */
    size_t offset;   /**< in the struct that is loaded */
    enum config_field_type type;
    double min; /**< inclusive */
    double max;
    const char *unit;
};

/**
 * Loads a file with type = "`type`", a name, and exactly the fields of the table into `target`. False after one line
 * on stderr (file, key or line, what, what to do); then neither `name` nor *target is to be used.
 */
bool config_fields_load(const char *path, const char *type, const struct config_field *fields, size_t count,
                        char name[CONFIG_NAME_SIZE], void *target);

#endif
