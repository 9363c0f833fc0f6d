#include "config_fields.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "config_file.h"
#include "error.h"

static void store(const struct config_field *field, double value, void *target)
{
    char *place = (char *)target + field->offset;

    if (field->type == CONFIG_FIELD_WHOLE) {
        const int whole = (int)value;
        memcpy(place, &whole, sizeof whole);
    } else {
        memcpy(place, &value, sizeof value);
    }
}

static bool load_field(const char *path, const struct config_field *field, const config_t *config, void *target)
{
    const config_setting_t *setting = config_lookup(config, field->key);
    double value;
    if (setting == NULL || !config_file_number(setting, &value)) {
        error_line("%s: %s: missing, or not a number; write %.10g to %.10g %s", path, field->key, field->min,
                   field->max, field->unit);
        return false;
    }
    if (!(value >= field->min && value <= field->max)) {
        error_line("%s: %s = %.10g: must be %.10g to %.10g %s; correct the value", path, field->key, value, field->min,
                   field->max, field->unit);
        return false;
    }
    if (field->type == CONFIG_FIELD_WHOLE && value != floor(value)) {
        error_line("%s: %s = %.10g: must be a whole number; correct the value", path, field->key, value);
        return false;
    }
    store(field, value, target);
    return true;
}

static bool is_known(const struct config_field *fields, size_t count, const char *group, const char *name)
{
    char key[64];
    (void)snprintf(key, sizeof key, "%s.%s", group, name);
    for (size_t i = 0; i < count; i++) {
        if (strcmp(fields[i].key, key) == 0) {
            return true;
        }
    }
    return false;
}

static bool check_group(const char *path, const config_setting_t *group, const struct config_field *fields,
                        size_t count)
{
    const char *name = config_setting_name(group);

    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *member = config_setting_get_elem(group, (unsigned)i);
        if (!is_known(fields, count, name, config_setting_name(member))) {
            error_line("%s: %s.%s (line %u): unknown key; remove it", path, name, config_setting_name(member),
                       config_setting_source_line(member));
            return false;
        }
    }
    return true;
}

/* All members of all groups are known, and beside the groups there are only the type and the name. */
static bool check_keys(const char *path, const config_t *config, const struct config_field *fields, size_t count)
{
    const config_setting_t *root = config_root_setting(config);

    for (int i = 0; i < config_setting_length(root); i++) {
        const config_setting_t *setting = config_setting_get_elem(root, (unsigned)i);
        const char *name = config_setting_name(setting);
        if (config_setting_is_group(setting)) {
            if (!check_group(path, setting, fields, count)) {
                return false;
            }
        } else if (strcmp(name, "type") != 0 && strcmp(name, "name") != 0) {
            error_line("%s: %s (line %u): unknown key; remove it", path, name, config_setting_source_line(setting));
            return false;
        }
    }
    return true;
}

static bool load_name(const char *path, const char *type, const config_t *config, char target[CONFIG_NAME_SIZE])
{
    const char *found;
    const char *name;
    if (config_lookup_string(config, "type", &found) != CONFIG_TRUE || strcmp(found, type) != 0) {
        error_line("%s: type: must be \"%s\"; correct it, or give another robot file", path, type);
        return false;
    }
    if (config_lookup_string(config, "name", &name) != CONFIG_TRUE) {
        error_line("%s: name: missing, or no text; write name = \"…\";", path);
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

static bool load(const char *path, const char *type, config_t *config, const struct config_field *fields, size_t count,
                 char name[CONFIG_NAME_SIZE], void *target)
{
    if (!config_file_parse(path, config) || !load_name(path, type, config, name) ||
        !check_keys(path, config, fields, count)) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (!load_field(path, &fields[i], config, target)) {
            return false;
        }
    }
    return true;
}

bool config_fields_load(const char *path, const char *type, const struct config_field *fields, size_t count,
                        char name[CONFIG_NAME_SIZE], void *target)
{
    config_t config;
    config_init(&config);
    const bool loaded = load(path, type, &config, fields, count, name, target);
    config_destroy(&config);
    return loaded;
}
