#include "src/base/config_float_check.h"

#include <stdbool.h>
#include <string.h>

#include "src/base/plane.h"

static float number_at(const void *place, unsigned bytes)
{
    float number;
    uint16_t half;
    uint8_t byte;

    if (bytes == sizeof byte) {
        (void)memcpy(&byte, place, sizeof byte);
        return (float)byte;
    }
    if (bytes == sizeof half) {
        (void)memcpy(&half, place, sizeof half);
        return (float)half;
    }
    (void)memcpy(&number, place, sizeof number);
    return number;
}

static bool is_within(const struct jp_config_float_field *field, const uint8_t *config)
{
    return jp_plane_is_between(number_at(&config[field->offset], field->bytes), field->low, field->high);
}

enum jp_status jp_config_float_check(const void *config, const struct jp_config_float_field *fields, size_t count,
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
