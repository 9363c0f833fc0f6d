/**
 * A store whose power may fail at any step, and what it may hold then: the record that was certain, or one of those
 * whose writing was cut since. Records are told by their serial number; 0 is none.
 *
 * The including test defines NOR_WORDS, the words of a sector, and RIG_LENGTH, the least bytes of a record.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_STORE_RIG_H
#define JOULEPATH_TESTS_SUPPORT_STORE_RIG_H

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/nor_flash.h"

#define RIG_POSSIBLE_MAX 64U
#define RIG_REOPENINGS   4U /* cut words read differently each time */

struct rig {
    struct nor_flash nor;
    struct jp_flash flash;
    struct jp_store store;
    uint32_t certain;
    uint32_t possible[RIG_POSSIBLE_MAX];
    size_t possible_count;
    unsigned long cuts;
    unsigned long violations; /**< findings of neither old nor new */
};

enum rig_outcome { RIG_DONE, RIG_FAILED, RIG_CUT };

static jmp_buf rig_power;

static inline void rig_power_off(void)
{
    longjmp(rig_power, 1);
}

/** The record of a serial number: every byte, and the length too, depends on it. */
static inline uint16_t rig_record(uint32_t serial, uint8_t bytes[JP_STORE_LENGTH_MAX])
{
    const uint16_t length = (uint16_t)(RIG_LENGTH + serial % 9U);
    uint32_t mixed = serial;

    for (unsigned i = 0; i < length; i++) {
        bytes[i] = (uint8_t)(i < 4U ? serial >> (8U * i) : mixed >> 24);
        mixed = mixed * 1664525U + 1013904223U;
    }
    return length;
}

static inline bool rig_is_possible(const struct rig *rig, uint32_t serial)
{
    bool possible = serial == rig->certain;

    for (size_t i = 0; i < rig->possible_count; i++) {
        possible = possible || serial == rig->possible[i];
    }
    return possible;
}

/** The serial number of the whole record in `bytes`; false: it is a mix. */
static inline bool rig_identify(const uint8_t *bytes, uint16_t length, uint32_t *serial)
{
    uint8_t expected[JP_STORE_LENGTH_MAX];

    *serial = (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    return *serial != 0U && rig_record(*serial, expected) == length && memcmp(bytes, expected, length) == 0;
}

static inline void rig_violation(struct rig *rig, const char *what, uint32_t serial)
{
    rig->violations++;
    fprintf(stderr, "%s: found %u, certain is %u, %zu possible\n", what, serial, rig->certain, rig->possible_count);
}

/** What the store shows now, 0 when it is empty. */
static inline uint32_t rig_look(struct rig *rig)
{
    const uint8_t *bytes = NULL;
    uint16_t length = 0;
    uint32_t serial = 0;
    const enum jp_status status = jp_store_read(&rig->store, &bytes, &length);

    if (status == JP_OK && !rig_identify(bytes, length, &serial)) {
        rig_violation(rig, "a mix", serial);
    } else if (status != JP_OK && status != JP_ERR_EMPTY) {
        rig_violation(rig, "not to be read", 0);
    } else if (!rig_is_possible(rig, serial)) {
        rig_violation(rig, "neither old nor new", serial);
    }
    return serial;
}

/** Power on, several times. */
static inline uint32_t rig_open(struct rig *rig)
{
    uint32_t serial = 0;

    rig->nor.cut_step = 0;
    for (unsigned i = 0; i < RIG_REOPENINGS; i++) {
        enum jp_status status;

        rig->nor.mood = nor_random(&rig->nor) % (NOR_MOODY + 1U);
        status = jp_store_open(&rig->store, &rig->flash);
        serial = rig_look(rig);
        if (status != (serial == 0U ? JP_ERR_EMPTY : JP_OK)) {
            rig_violation(rig, "opening says something else", serial);
        }
    }
    return serial;
}

static inline void rig_start(struct rig *rig, uint64_t seed)
{
    nor_start(&rig->nor, seed);
    rig->nor.power_off = rig_power_off;
    rig->flash = nor_interface(&rig->nor);
    rig->certain = 0;
    rig->possible_count = 0;
    (void)rig_open(rig);
}

/** Power will fail at the `ahead`-th step from now. */
static inline void rig_cut_in(struct rig *rig, unsigned long ahead, struct nor_cut cut)
{
    rig->nor.cut_step = rig->nor.steps + ahead;
    rig->nor.cut = cut;
}

static inline struct nor_cut rig_random_cut(struct rig *rig)
{
    return (struct nor_cut){.done = nor_random(&rig->nor) % 9U, .unstable = nor_random(&rig->nor) % 9U};
}

static inline void rig_become_certain(struct rig *rig, uint32_t serial)
{
    rig->certain = serial;
    rig->possible_count = 0;
}

static inline void rig_become_possible(struct rig *rig, uint32_t serial)
{
    if (rig->possible_count == RIG_POSSIBLE_MAX) {
        fprintf(stderr, "store_rig.h: more than %u writes were cut in a row\n", RIG_POSSIBLE_MAX);
        exit(1);
    }
    rig->possible[rig->possible_count++] = serial;
}

/** After a cut the store must be opened again. */
static inline enum rig_outcome rig_write(struct rig *rig, uint32_t serial)
{
    uint8_t bytes[JP_STORE_LENGTH_MAX];
    const uint16_t length = rig_record(serial, bytes);
    const uint32_t before = rig_look(rig);

    if (setjmp(rig_power) != 0) {
        rig->cuts++;
        rig_become_possible(rig, serial);
        return RIG_CUT;
    }
    if (jp_store_write(&rig->store, bytes, length) == JP_OK) {
        rig_become_certain(rig, serial);
        (void)rig_look(rig);
        return RIG_DONE;
    }
    if (rig_look(rig) != before) {
        rig_violation(rig, "a failed write changed the record", serial);
    }
    rig_become_possible(rig, serial);
    return RIG_FAILED;
}

/** What is found is certain then, but for an empty store, to which a record that was being written may still come. */
static inline enum rig_outcome rig_settle(struct rig *rig)
{
    const uint32_t serial = rig_look(rig);

    if (setjmp(rig_power) != 0) {
        rig->cuts++;
        return RIG_CUT;
    }
    if (jp_store_settle(&rig->store) != JP_OK) {
        return RIG_FAILED;
    }
    if (serial != 0U) {
        rig_become_certain(rig, serial);
    }
    (void)rig_look(rig);
    return RIG_DONE;
}

#endif
