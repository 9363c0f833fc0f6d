#include "hal/storage/battery_store.h"

#include <stddef.h>

_Static_assert(JP_BATTERY_STORE_LENGTH <= JP_STORE_LENGTH_MAX, "the record fits the store");

static const enum jp_battery_unknown lasting[JP_BATTERY_LASTING] = {
    JP_BATTERY_CHARGE, JP_BATTERY_RESISTANCE, JP_BATTERY_SLOWNESS, JP_BATTERY_CAPACITY, JP_BATTERY_OFFSET};

static uint8_t *append(uint8_t *end, uint64_t number, unsigned size)
{
    for (unsigned i = 0; i < size; i++) {
        end[i] = (uint8_t)(number >> (8U * i));
    }
    return end + size;
}

static uint64_t take(const uint8_t **bytes, unsigned size)
{
    uint64_t number = 0;

    for (unsigned i = 0; i < size; i++) {
        number |= (uint64_t)(*bytes)[i] << (8U * i);
    }
    *bytes += size;
    return number;
}

void jp_battery_state_encode(const struct jp_battery_state *state, uint8_t record[JP_BATTERY_STORE_LENGTH])
{
    uint8_t *end = record;

    end = append(end, JP_BATTERY_STORE_VERSION, 4);
    end = append(end, state->identity, 4);
    end = append(end, (uint64_t)state->charge, 8);
    end = append(end, (uint64_t)state->capacity, 8);
    end = append(end, (uint64_t)state->filter.resistance, 8);
    end = append(end, (uint64_t)state->filter.slowness, 8);
    end = append(end, (uint64_t)state->filter.offset, 8);
    for (unsigned i = 0; i < JP_BATTERY_LASTING; i++) {
        for (unsigned j = i; j < JP_BATTERY_LASTING; j++) {
            end = append(end, (uint64_t)state->filter.covariance[lasting[i]][lasting[j]], 8);
        }
    }
}

static void decode_numbers(struct jp_battery_state *state, const uint8_t *bytes)
{
    state->identity = (uint32_t)take(&bytes, 4);
    state->charge = (jp_charge)take(&bytes, 8);
    state->capacity = (jp_charge)take(&bytes, 8);
    state->filter.resistance = (int64_t)take(&bytes, 8);
    state->filter.slowness = (int64_t)take(&bytes, 8);
    state->filter.offset = (int64_t)take(&bytes, 8);
    for (unsigned i = 0; i < JP_BATTERY_LASTING; i++) {
        for (unsigned j = i; j < JP_BATTERY_LASTING; j++) {
            const int64_t covariance = (int64_t)take(&bytes, 8);

            state->filter.covariance[lasting[i]][lasting[j]] = covariance;
            state->filter.covariance[lasting[j]][lasting[i]] = covariance;
        }
    }
}

enum jp_status jp_battery_state_decode(struct jp_battery_state *state, const uint8_t *record, uint16_t length,
                                       const char **field)
{
    if (state == NULL || record == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = NULL;
    if (length >= 4U && take(&record, 4) != JP_BATTERY_STORE_VERSION) {
        *field = "version";
    } else if (length != JP_BATTERY_STORE_LENGTH) {
        *field = "length";
    } else {
        *state = (struct jp_battery_state){.charge = 0};
        state->filter.covariance[JP_BATTERY_POLARISATION][JP_BATTERY_POLARISATION] = 1;
        state->filter.covariance[JP_BATTERY_CURVE][JP_BATTERY_CURVE] = 1;
        decode_numbers(state, record);
    }
    return *field == NULL ? JP_OK : JP_ERR_CONFIG;
}

enum jp_status jp_battery_state_load(struct jp_battery_state *state, const struct jp_store *store, const char **field)
{
    const uint8_t *record = NULL;
    uint16_t length = 0;
    const enum jp_status status = jp_store_read(store, &record, &length);

    return status == JP_OK ? jp_battery_state_decode(state, record, length, field) : status;
}

enum jp_status jp_battery_state_save(const struct jp_battery_state *state, struct jp_store *store)
{
    uint8_t record[JP_BATTERY_STORE_LENGTH];

    jp_battery_state_encode(state, record);
    return jp_store_write(store, record, sizeof record);
}
