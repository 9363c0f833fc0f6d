/**
 * What is known of a battery, kept over power-off: a record of fixed bytes, little-endian, in a store of its own
 * (store.h), which guards it by a CRC. What passes while the robot is off, polarisation and the error of the curve at
 * the present charge, is not kept: jp_battery_restore() begins them anew.
 *
 * All calls are for the background loop.
 */
#ifndef JOULEPATH_HAL_STORAGE_BATTERY_STORE_H
#define JOULEPATH_HAL_STORAGE_BATTERY_STORE_H

#include <joulepath/battery.h>

#include "hal/storage/store.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Of the record's format; one more with every change of it. */
#define JP_BATTERY_STORE_VERSION 1U

/** Unknowns that last, of which a half of their covariance is kept. */
#define JP_BATTERY_LASTING 5U

/** Bytes of the record: version, identity of the cells, five numbers, covariance. */
#define JP_BATTERY_STORE_LENGTH (4U + 4U + 8U * 5U + 8U * (JP_BATTERY_LASTING * (JP_BATTERY_LASTING + 1U) / 2U))

void jp_battery_state_encode(const struct jp_battery_state *state, uint8_t record[JP_BATTERY_STORE_LENGTH]);

/**
 * The state of a record; its numbers jp_battery_restore() checks. JP_ERR_CONFIG: *field says what does not fit:
 * "version" (another format) or "length"; *state is not written. JP_ERR_ARGUMENT: a pointer is null.
 */
enum jp_status jp_battery_state_decode(struct jp_battery_state *state, const uint8_t *record, uint16_t length,
                                       const char **field);

/** That of an open store. As jp_battery_state_decode(), and JP_ERR_EMPTY: nothing is stored. */
enum jp_status jp_battery_state_load(struct jp_battery_state *state, const struct jp_store *store, const char **field);

/** Stores it. As jp_store_write(). */
enum jp_status jp_battery_state_save(const struct jp_battery_state *state, struct jp_store *store);

#ifdef __cplusplus
}
#endif

#endif
