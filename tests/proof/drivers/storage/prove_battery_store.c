/** Any record of any length, any state. */
#include "hal/storage/battery_store.h"
#include "tests/proof/any.h"

int main(void)
{
    static uint8_t record[JP_BATTERY_STORE_LENGTH];
    struct jp_battery_state state;
    const char *field;

    ANY(record);
    ANY(state);
    jp_battery_state_encode(&state, record);
    ANY(record);
    (void)jp_battery_state_decode(&state, record, (uint16_t)any_unsigned(JP_BATTERY_STORE_LENGTH), &field);
    ARRIVED();
    return 0;
}
