/** What jp_config_check() promises, for the analyser: a configuration is refused, any may be, or each field of it is
 *  within its range. It reads fields in their places, which tells the analyser their ranges; the core reads copies. */
#include "src/base/config_check.h"

#include <stdbool.h>

#include "tests/proof/any.h"

static bool is_within(const struct jp_config_field *field, const uint8_t *place)
{
    switch (field->bytes) {
    case sizeof(uint8_t):
        return *place >= field->low && *place <= field->high;
    case sizeof(uint16_t):
        return *(const uint16_t *)place >= field->low && *(const uint16_t *)place <= field->high;
    default:
        return *(const int32_t *)place >= field->low && *(const int32_t *)place <= field->high;
    }
}

/** Returns only if it is. */
static void require_within(const struct jp_config_field *field, const uint8_t *place)
{
    while (!is_within(field, place)) {
    }
}

enum jp_status jp_config_check(const void *config, const struct jp_config_field *fields, size_t count,
                               const char **field)
{
    if (config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (any_bool()) {
        return jp_config_refuse(fields[any_unsigned(count - 1U)].name, field);
    }
    /*@ loop unroll 64; */
    for (size_t i = 0; i < count; i++) {
        /*@ loop unroll 64; */
        for (unsigned at = 0; at < fields[i].bytes; at += (unsigned)sizeof(int32_t)) {
            require_within(&fields[i], (const uint8_t *)config + fields[i].offset + at);
        }
    }
    *field = NULL;
    return JP_OK;
}
