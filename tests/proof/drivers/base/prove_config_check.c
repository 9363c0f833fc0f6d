/** The core's own check of any configuration by a table with fields of each width. */
#include "src/base/config_check.c"

#include "tests/proof/any.h"

struct config {
    int32_t word;
    int32_t words[3];
    uint16_t half;
    uint8_t byte;
};

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct config, member, low, high)

int main(void)
{
    static const struct jp_config_field fields[] = {FIELD(word, INT32_MIN, INT32_MAX), FIELD(words, 0, 1),
                                                    FIELD(half, 0, 5), FIELD(byte, 1, 2)};
    struct config config;
    const char *field;

    ANY(config);
    (void)jp_config_check(any_bool() ? &config : NULL, fields, JP_CONFIG_COUNT(fields), any_bool() ? &field : NULL);
    ARRIVED();
    return 0;
}
