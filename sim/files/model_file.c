#include "sim/files/model_file.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "sim/base/error.h"

#define B_COUNT 2

/* A field of struct jp_energy_model: a number, or a list of them. */
struct field {
    const char *key;
    size_t offset;
    size_t count;
};

static const struct field fields[] = {
    {"a", offsetof(struct jp_energy_model, a), JP_ENERGY_TERMS},
    {"b", offsetof(struct jp_energy_model, b), B_COUNT},
    {"electronics_power", offsetof(struct jp_energy_model, electronics_power), 1},
    {"settling_time", offsetof(struct jp_energy_model, settling_time), 1},
    {"voltage_per_speed", offsetof(struct jp_energy_model, voltage_per_speed), 1},
    {"voltage_per_turn_rate", offsetof(struct jp_energy_model, voltage_per_turn_rate), 1},
    {"motor_resistance", offsetof(struct jp_energy_model, motor_resistance), 1},
};
static const size_t field_count = sizeof fields / sizeof fields[0];

static json_t *read_json(const char *path)
{
    json_error_t error;
    json_t *root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);

    if (root == NULL && error.line < 1) {
        error_line("%s; give identified, published or a file of an energy model", error.text);
    } else if (root == NULL) {
        error_line("%s: line %d: %s; an energy model is a JSON object", path, error.line, error.text);
    }
    return root;
}

/* Out of the format it is out of every range too. */
static jp_q16 to_q16(double value)
{
    return (jp_q16)lrint(fmax(INT32_MIN, fmin(INT32_MAX, value * JP_Q16_ONE)));
}

static bool read_number(const char *path, const struct field *field, const json_t *value, jp_q16 *number)
{
    if (!json_is_number(value)) {
        error_line("%s: %s: must be %s; give the fields of struct jp_energy_model", path, field->key,
                   field->count > 1 ? "a list of numbers" : "a number");
        return false;
    }
    *number = to_q16(json_number_value(value));
    return true;
}

static bool read_list(const char *path, const struct field *field, const json_t *list, jp_q16 *numbers)
{
    if (json_array_size(list) != field->count) {
        error_line("%s: %s: must be a list of %zu numbers", path, field->key, field->count);
        return false;
    }
    for (size_t i = 0; i < field->count; i++) {
        if (!read_number(path, field, json_array_get(list, i), &numbers[i])) {
            return false;
        }
    }
    return true;
}

static bool read_field(const char *path, const struct field *field, const json_t *root, struct jp_energy_model *model)
{
    jp_q16 *numbers = (jp_q16 *)((char *)model + field->offset);
    const json_t *value = json_object_get(root, field->key);

    return field->count > 1 ? read_list(path, field, value, numbers) : read_number(path, field, value, numbers);
}

static bool knows(const char *path, const char *key)
{
    for (size_t i = 0; i < field_count; i++) {
        if (strcmp(fields[i].key, key) == 0) {
            return true;
        }
    }
    error_line("%s: %s: no field of struct jp_energy_model; leave it out", path, key);
    return false;
}

static bool check(const char *path, const struct jp_energy_model *model)
{
    const char *field = NULL;

    if (jp_energy_model_check(model, &field) != JP_OK) {
        error_line("%s: %s: out of the range in joulepath/energy.h; correct it", path, field);
        return false;
    }
    return true;
}

static bool read_model(const char *path, json_t *root, struct jp_energy_model *model)
{
    const char *key;
    json_t *value;

    json_object_foreach(root, key, value)
    {
        if (!knows(path, key)) {
            return false;
        }
    }
    for (size_t i = 0; i < field_count; i++) {
        if (!read_field(path, &fields[i], root, model)) {
            return false;
        }
    }
    return check(path, model);
}

bool model_file_load(const char *path, struct jp_energy_model *model)
{
    json_t *root = read_json(path);
    const bool is_read = root != NULL && read_model(path, root, model);

    json_decref(root);
    return is_read;
}

static json_t *json_q16(jp_q16 value)
{
    return json_real((double)value / JP_Q16_ONE);
}

static json_t *json_list(const jp_q16 *numbers, size_t count)
{
    json_t *list = json_array();

    for (size_t i = 0; i < count; i++) {
        (void)json_array_append_new(list, json_q16(numbers[i]));
    }
    return list;
}

json_t *model_file_json(const struct jp_energy_model *model)
{
    json_t *root = json_object();

    for (size_t i = 0; i < field_count; i++) {
        const jp_q16 *numbers = (const jp_q16 *)((const char *)model + fields[i].offset);
        (void)json_object_set_new(root, fields[i].key,
                                  fields[i].count > 1 ? json_list(numbers, fields[i].count) : json_q16(*numbers));
    }
    return root;
}
