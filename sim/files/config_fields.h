/**
 * Configuration files by a table of their fields: a key with its path, a type, a range and a unit. Each error is one
 * line on stderr: file, key or line, what, what to do.
 */
#ifndef JOULEPATH_SIM_FILES_CONFIG_FIELDS_H
#define JOULEPATH_SIM_FILES_CONFIG_FIELDS_H

#include <libconfig.h>
#include <stdbool.h>
#include <stddef.h>

/** Bytes of a robot's name with its end: small letters, digits or '_', as C names its tables. */
#define CONFIG_NAME_SIZE 32

/** Bytes of a field's label with its end. */
#define CONFIG_LABEL_SIZE 64

/** What a robot is whose file names no type. */
#define CONFIG_BALANCER "balancer"

enum config_field_type {
    CONFIG_FIELD_REAL,  /**< a double */
    CONFIG_FIELD_WHOLE, /**< an int */
    CONFIG_FIELD_TEXT,  /**< a char[] that is not empty */
    CONFIG_FIELD_LIST   /**< whose elements the caller reads */
};

/** A number, an array of them, or a text of the file, and where it goes. */
struct config_field {
    const char *key; /**< name, or group.name */
    size_t offset;   /**< in the struct that is loaded */
    size_t count;    /**< 1; of an array its length; of a text its bytes with its end */
    enum config_field_type type;
    double min; /**< inclusive */
    double max;
    const char *unit;
    bool is_optional; /**< without it the struct keeps what it has */
};

/** A kind of file. That of a robot has a type and a name besides its fields. */
struct config_kind {
    const char *type;   /**< of the robot; NULL: no robot */
    size_t name_offset; /**< in the struct, of its char[CONFIG_NAME_SIZE] */
    const struct config_field *fields;
    size_t field_count;
};

/** Loads exactly the fields of the kind. False after an error: *target is not to be used. */
bool config_fields_load(const char *path, const struct config_kind *kind, void *target);

/** The same of a file that is parsed already (config_file.h). */
bool config_fields_read(const char *path, const config_t *config, const struct config_kind *kind, void *target);

/** Checks the numbers of a struct that was made otherwise; an error begins with `source`. */
bool config_fields_check(const char *source, const struct config_kind *kind, const void *target);

/** The type of the robot that a file describes. False after an error. */
bool config_fields_type(const char *path, char type[CONFIG_NAME_SIZE]);

/** Says that a robot's file is of another type than `needed`. */
void config_fields_refuse_type(const char *path, const char *type, const char *needed);

/** Marks every optional number as left out. */
void config_fields_leave_out(const struct config_kind *kind, void *target);

/** Whether a number is marked so; config_fields_check() lets it pass. */
bool config_field_is_left_out(const void *target, const struct config_field *field, size_t index);

/** The key of a field; of an array with [index]. */
void config_field_label(const struct config_field *field, size_t index, char label[CONFIG_LABEL_SIZE]);

/** Element `index` of a field that is a number or an array of them. */
double config_field_value(const void *target, const struct config_field *field, size_t index);

#endif
