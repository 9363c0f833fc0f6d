// eva: -eva-slevel-function main:20
/** Any flash: any words that it reads, also when they are read again, and programs and erases that fail at any time.
 * Any records, any number of openings; what of parameters and of a battery is stored, too. */
#include "hal/storage/battery_store.h"
#include "hal/storage/parameters.h"

#include "tests/proof/any.h"

static struct jp_store store;

static uint32_t read_word(void *context, unsigned sector, uint32_t offset)
{
    (void)context;
    (void)sector;
    (void)offset;
    return any_unsigned(UINT32_MAX);
}

static enum jp_status program(void *context, unsigned sector, uint32_t offset, uint32_t word)
{
    (void)context;
    (void)sector;
    (void)offset;
    (void)word;
    return any_bool() ? JP_OK : JP_ERR_HARDWARE;
}

static enum jp_status erase(void *context, unsigned sector)
{
    (void)context;
    (void)sector;
    return any_bool() ? JP_OK : JP_ERR_HARDWARE;
}

static void use_records(void)
{
    static uint8_t record[JP_STORE_LENGTH_MAX];
    const uint8_t *stored;
    uint16_t length;

    ANY(record);
    (void)jp_store_read(&store, &stored, &length);
    (void)jp_store_settle(&store);
    (void)jp_store_write(&store, record, (uint16_t)any_unsigned(JP_STORE_LENGTH_MAX));
}

static void use_parameters(void)
{
    struct jp_parameters parameters;
    const uint32_t identity = any_unsigned(UINT32_MAX);
    const char *field;

    (void)jp_parameters_load(&parameters, identity, &store, &field);
    ANY(parameters);
    (void)jp_parameters_save(&parameters, identity, &store, &field);
}

static void use_battery(void)
{
    struct jp_battery_state state;
    const char *field;

    (void)jp_battery_state_load(&state, &store, &field);
    ANY(state);
    (void)jp_battery_state_save(&state, &store);
}

int main(void)
{
    const struct jp_flash flash = {
        .sector_size = any_unsigned(UINT32_MAX), .read = read_word, .program = program, .erase = erase};
    const enum jp_status opened = jp_store_open(&store, &flash);

    if (opened != JP_OK && opened != JP_ERR_EMPTY) {
        return 0;
    }
    ANY_TIMES
    {
        use_records();
        use_parameters();
        use_battery();
        (void)jp_store_open(&store, &flash);
    }
    ARRIVED();
    return 0;
}
