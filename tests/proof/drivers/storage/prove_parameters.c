// eva: -eva-slevel-function main:30,jp_parameters_check:30
/** Any record of any length, any parameters; what is encoded is what passed. */
#include "hal/storage/parameters.h"
#include "tests/proof/any.h"

int main(void)
{
    static uint8_t record[JP_PARAMETERS_LENGTH];
    struct jp_parameters parameters;
    struct jp_parameters others;
    const uint32_t identity = any_unsigned(UINT32_MAX);
    const char *field;

    ANY(record);
    ANY(others);
    (void)jp_parameters_decode(&others, identity, record, (uint16_t)any_unsigned(JP_PARAMETERS_LENGTH), &field);
    (void)jp_parameters_start(&parameters, identity, record, (uint16_t)any_unsigned(JP_PARAMETERS_LENGTH));
    if (jp_parameters_check(&others, &field) == JP_OK) {
        (void)jp_parameters_differ(&parameters, &others);
    }
    jp_parameters_default(&parameters);
    jp_parameters_encode(&others, identity, record);
    ARRIVED();
    return 0;
}
