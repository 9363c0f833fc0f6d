#include "src/base/config_check.h"

#include <stdbool.h>
#include <string.h>

static int32_t number_at(const void *place, unsigned bytes)
{
    int32_t number;
    uint16_t half;
    uint8_t byte;

    if (bytes == sizeof byte) {
        (void)memcpy(&byte, place, sizeof byte);
        return byte;
    }
    if (bytes == sizeof half) {
        (void)memcpy(&half, place, sizeof half);
        return half;
    }
    (void)memcpy(&number, place, sizeof number);
    return number;
}

static bool is_within(const struct jp_config_field *field, const uint8_t *config)
{
    for (unsigned at = 0; at < field->bytes; at += (unsigned)sizeof(int32_t)) {
        const int32_t number = number_at(&config[field->offset + at], field->bytes);

        if (number < field->low || number > field->high) {
            return false;
        }
    }
    return true;
}

enum jp_status jp_config_check(const void *config, const struct jp_config_field *fields, size_t count,
                               const char **field)
{
    if (config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    for (size_t i = 0; i < count; i++) {
        if (!is_within(&fields[i], config)) {
            return jp_config_refuse(fields[i].name, field);
        }
    }
    *field = NULL;
    return JP_OK;
}
