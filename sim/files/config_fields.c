#include "sim/files/config_fields.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "sim/base/error.h"
#include "sim/files/config_file.h"

/* What stands for a whole number that is left out; for a real one it is NaN. */
#define LEFT_OUT INT_MIN

/* A key that is longer is no misspelt one. */
#define KEY_LENGTH_MAX 64

/* ---- Values ---- */

void config_field_label(const struct config_field *field, size_t index, char label[CONFIG_LABEL_SIZE])
{
    if (field->count > 1) {
        (void)snprintf(label, CONFIG_LABEL_SIZE, "%s[%zu]", field->key, index);
    } else {
        (void)snprintf(label, CONFIG_LABEL_SIZE, "%s", field->key);
    }
}

double config_field_value(const void *target, const struct config_field *field, size_t index)
{
    const char *base = (const char *)target + field->offset;

    if (field->type == CONFIG_FIELD_WHOLE) {
        int whole;
        memcpy(&whole, base + index * sizeof whole, sizeof whole);
        return whole;
    }
    double real;
    memcpy(&real, base + index * sizeof real, sizeof real);
    return real;
}

static void store(void *target, const struct config_field *field, size_t index, double value)
{
    char *base = (char *)target + field->offset;

    if (field->type == CONFIG_FIELD_WHOLE) {
        const int whole = (int)value;
        memcpy(base + index * sizeof whole, &whole, sizeof whole);
    } else {
        memcpy(base + index * sizeof value, &value, sizeof value);
    }
}

static const char *noun(const struct config_field *field)
{
    return field->type == CONFIG_FIELD_WHOLE ? "a whole number" : "a number";
}

static bool check_value(const char *source, const struct config_field *field, size_t index, double value)
{
    const bool fits = field->type == CONFIG_FIELD_REAL || value == floor(value);

    if (fits && value >= field->min && value <= field->max) {
        return true;
    }
    char key[CONFIG_LABEL_SIZE];
    config_field_label(field, index, key);
    error_line("%s: %s = %.10g: must be %s from %.10g to %.10g %s; correct the value", source, key, value, noun(field),
               field->min, field->max, field->unit);
    return false;
}

static bool is_number(const struct config_field *field)
{
    return field->type == CONFIG_FIELD_REAL || field->type == CONFIG_FIELD_WHOLE;
}

void config_fields_leave_out(const struct config_kind *kind, void *target)
{
    for (size_t i = 0; i < kind->field_count; i++) {
        const struct config_field *field = &kind->fields[i];

        for (size_t j = 0; is_number(field) && field->is_optional && j < field->count; j++) {
            store(target, field, j, field->type == CONFIG_FIELD_WHOLE ? LEFT_OUT : (double)NAN);
        }
    }
}

bool config_field_is_left_out(const void *target, const struct config_field *field, size_t index)
{
    const double value = config_field_value(target, field, index);

    return field->is_optional && (isnan(value) || (field->type == CONFIG_FIELD_WHOLE && value == LEFT_OUT));
}

bool config_fields_check(const char *source, const struct config_kind *kind, const void *target)
{
    for (size_t i = 0; i < kind->field_count; i++) {
        const struct config_field *field = &kind->fields[i];

        for (size_t j = 0; is_number(field) && j < field->count; j++) {
            if (!config_field_is_left_out(target, field, j) &&
                !check_value(source, field, j, config_field_value(target, field, j))) {
                return false;
            }
        }
    }
    return true;
}

/* ---- Loading a field ---- */

static bool load_element(const char *path, const struct config_field *field, config_setting_t *setting, size_t index,
                         void *target)
{
    double value;

    if (!config_file_number(setting, &value)) {
        char key[CONFIG_LABEL_SIZE];
        config_field_label(field, index, key);
        error_line("%s: %s (line %u): must be %s in %s; correct the value", path, key,
                   config_setting_source_line(setting), noun(field), field->unit);
        return false;
    }
    if (!check_value(path, field, index, value)) {
        return false;
    }
    store(target, field, index, value);
    return true;
}

static bool load_text(const char *path, const struct config_field *field, const config_setting_t *setting, void *target)
{
    const char *text = setting == NULL ? NULL : config_setting_get_string(setting);

    if (text == NULL || text[0] == '\0' || strlen(text) >= field->count) {
        error_line("%s: %s: missing or no text of 1 to %zu characters; write %s = \"…\";", path, field->key,
                   field->count - 1, field->key);
        return false;
    }
    memcpy((char *)target + field->offset, text, strlen(text) + 1);
    return true;
}

static bool load_array(const char *path, const struct config_field *field, const config_setting_t *setting,
                       void *target)
{
    if (!config_setting_is_list(setting) || config_setting_length(setting) != (int)field->count) {
        error_line("%s: %s (line %u): must be an array of %zu numbers; write [a, b, …]", path, field->key,
                   config_setting_source_line(setting), field->count);
        return false;
    }
    for (size_t i = 0; i < field->count; i++) {
        if (!load_element(path, field, config_setting_get_elem(setting, (unsigned)i), i, target)) {
            return false;
        }
    }
    return true;
}

static bool load_field(const char *path, const struct config_field *field, const config_t *config, void *target)
{
    config_setting_t *setting = config_lookup(config, field->key);

    if (field->type == CONFIG_FIELD_LIST || (setting == NULL && field->is_optional)) {
        return true;
    }
    if (field->type == CONFIG_FIELD_TEXT) {
        return load_text(path, field, setting, target);
    }
    if (setting == NULL) {
        error_line("%s: %s: missing; add %s from %.10g to %.10g %s", path, field->key, noun(field), field->min,
                   field->max, field->unit);
        return false;
    }
    return field->count == 1 ? load_element(path, field, setting, 0, target) : load_array(path, field, setting, target);
}

/* ---- Keys ---- */

/* Levenshtein's distance from a to the first characters of b. */
static size_t edit_distance(const char *a, const char *b, size_t length)
{
    size_t row[KEY_LENGTH_MAX + 1];

    if (length > KEY_LENGTH_MAX) {
        return SIZE_MAX;
    }
    for (size_t j = 0; j <= length; j++) {
        row[j] = j;
    }
    for (size_t i = 0; a[i] != '\0'; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length; j++) {
            const size_t replaced = diagonal + (a[i] != b[j]);
            const size_t shorter = (row[j] < row[j + 1] ? row[j] : row[j + 1]) + 1;
            diagonal = row[j + 1];
            row[j + 1] = replaced < shorter ? replaced : shorter;
        }
    }
    return row[length];
}

/* Of the keys, or of the groups when it is in none. Returns its length. */
static size_t find_nearest(const struct config_kind *kind, const char *key, const char **nearest)
{
    const char *end = strchr(key, '.') == NULL ? "." : "";
    size_t least = SIZE_MAX;

    for (size_t i = 0; i < kind->field_count; i++) {
        const char *candidate = kind->fields[i].key;
        const size_t distance = edit_distance(key, candidate, strcspn(candidate, end));

        if (distance < least) {
            least = distance;
            *nearest = candidate;
        }
    }
    return strcspn(*nearest, end);
}

static bool is_key(const struct config_kind *kind, const char *key)
{
    for (size_t i = 0; i < kind->field_count; i++) {
        if (strcmp(key, kind->fields[i].key) == 0) {
            return true;
        }
    }
    return kind->type != NULL && (strcmp(key, "name") == 0 || strcmp(key, "type") == 0);
}

static bool is_group(const struct config_kind *kind, const char *key)
{
    const size_t length = strlen(key);

    for (size_t i = 0; i < kind->field_count; i++) {
        if (strncmp(key, kind->fields[i].key, length) == 0 && kind->fields[i].key[length] == '.') {
            return true;
        }
    }
    return false;
}

/* One setting of the file: known, and a group exactly where one belongs. */
static bool check_setting(const char *path, const struct config_kind *kind, const config_setting_t *setting,
                          const char *key)
{
    const unsigned line = config_setting_source_line(setting);

    if (is_group(kind, key)) {
        if (config_setting_is_group(setting)) {
            return true;
        }
        error_line("%s: %s (line %u): must be a group; write %s: { … };", path, key, line, key);
        return false;
    }
    if (is_key(kind, key)) {
        return true;
    }

    const char *nearest = "";
    const size_t length = find_nearest(kind, key, &nearest);

    error_line("%s: %s (line %u): unknown key; remove it, or write %.*s", path, key, line, (int)length, nearest);
    return false;
}

static bool check_keys(const char *path, const struct config_kind *kind, const config_setting_t *root)
{
    for (int i = 0; i < config_setting_length(root); i++) {
        const config_setting_t *group = config_setting_get_elem(root, (unsigned)i);
        const char *name = config_setting_name(group);

        if (!check_setting(path, kind, group, name)) {
            return false;
        }
        for (int j = 0; is_group(kind, name) && j < config_setting_length(group); j++) {
            const config_setting_t *setting = config_setting_get_elem(group, (unsigned)j);
            char key[2 * KEY_LENGTH_MAX];

            (void)snprintf(key, sizeof key, "%s.%s", name, config_setting_name(setting));
            if (!check_setting(path, kind, setting, key)) {
                return false;
            }
        }
    }
    return true;
}

/* ---- Robots ---- */

static bool read_type(const char *path, const config_t *config, char type[CONFIG_NAME_SIZE])
{
    const config_setting_t *setting = config_lookup(config, "type");
    const char *text = setting == NULL ? CONFIG_BALANCER : config_setting_get_string(setting);

    if (text == NULL || strlen(text) >= CONFIG_NAME_SIZE) {
        error_line("%s: type: must be a short text, such as \"" CONFIG_BALANCER "\"; correct it", path);
        return false;
    }
    memcpy(type, text, strlen(text) + 1);
    return true;
}

void config_fields_refuse_type(const char *path, const char *type, const char *needed)
{
    error_line("%s: type: %s robot%s; needs a %s; give the file of one", path, type,
               strcmp(type, CONFIG_BALANCER) == 0 ? " (as without a type)" : "", needed);
}

static bool check_type(const char *path, const struct config_kind *kind, const config_t *config)
{
    char type[CONFIG_NAME_SIZE];

    if (!read_type(path, config, type)) {
        return false;
    }
    if (strcmp(type, kind->type) != 0) {
        config_fields_refuse_type(path, type, kind->type);
        return false;
    }
    return true;
}

static bool load_name(const char *path, const config_t *config, char *target)
{
    const char *name;

    if (config_lookup_string(config, "name", &name) != CONFIG_TRUE) {
        error_line("%s: name: missing or no text; add name = \"…\";", path);
        return false;
    }
    const size_t length = strlen(name);
    if (length == 0 || length >= CONFIG_NAME_SIZE || strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_") != length) {
        error_line("%s: name = \"%s\": must be 1 to %d small letters, digits or '_'; correct the name", path, name,
                   CONFIG_NAME_SIZE - 1);
        return false;
    }
    memcpy(target, name, length + 1);
    return true;
}

/* ---- Files ---- */

bool config_fields_read(const char *path, const config_t *config, const struct config_kind *kind, void *target)
{
    if ((kind->type != NULL && !check_type(path, kind, config)) ||
        !check_keys(path, kind, config_root_setting(config)) ||
        (kind->type != NULL && !load_name(path, config, (char *)target + kind->name_offset))) {
        return false;
    }
    for (size_t i = 0; i < kind->field_count; i++) {
        if (!load_field(path, &kind->fields[i], config, target)) {
            return false;
        }
    }
    return true;
}

bool config_fields_load(const char *path, const struct config_kind *kind, void *target)
{
    config_t config;

    config_init(&config);
    const bool loaded = config_file_parse(path, &config) && config_fields_read(path, &config, kind, target);
    config_destroy(&config);
    return loaded;
}

bool config_fields_type(const char *path, char type[CONFIG_NAME_SIZE])
{
    config_t config;

    config_init(&config);
    const bool has_type = config_file_parse(path, &config) && read_type(path, &config, type);
    config_destroy(&config);
    return has_type;
}
