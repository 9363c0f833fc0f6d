#include "hal/storage/store.h"

#include <stddef.h>
#include <string.h>

#include "hal/storage/crc32.h"

/*
 * A slot, in words: MARK, generation, length, the record, unused words as erased, CRC of all before it, SEAL. They are
 * programmed in this order, so each stands firm when the next one is begun. MARK is the same in every record: when it
 * was cut but reads as erased, the next record programs the same bits again.
 */
enum { WORD_MARK, WORD_GENERATION, WORD_LENGTH, WORD_RECORD, WORD_CRC = JP_STORE_SLOT_WORDS - 2, WORD_SEAL };

#define ERASED 0xFFFFFFFFU
#define MARK   0x3153504AU /* "JPS1" */
#define SEAL   0x2144454CU

#define PLACES_IN_SECTOR 2U

_Static_assert(JP_STORE_LENGTH_MAX == 4U * (WORD_CRC - WORD_RECORD), "the record fills the slot");

/** A slot as it was read once: unstable words do not change any more. */
struct slot {
    uint32_t words[JP_STORE_SLOT_WORDS];
};

static uint32_t slot_count(const struct jp_store *store)
{
    return store->flash->sector_size / JP_STORE_SLOT_SIZE;
}

static uint32_t word_offset(uint32_t slot, unsigned word)
{
    return slot * JP_STORE_SLOT_SIZE + 4U * word;
}

static void put_word(uint8_t bytes[4], uint32_t word)
{
    for (unsigned i = 0; i < 4U; i++) {
        bytes[i] = (uint8_t)(word >> (8U * i));
    }
}

static uint32_t slot_crc(const struct slot *slot)
{
    uint32_t crc = 0;
    uint8_t bytes[4];

    for (unsigned i = 0; i < WORD_CRC; i++) {
        put_word(bytes, slot->words[i]);
        crc = jp_crc32(crc, bytes, sizeof bytes);
    }
    return crc;
}

/* ---- Reading ---- */

static void read_slot(const struct jp_flash *flash, unsigned sector, uint32_t number, struct slot *slot)
{
    for (unsigned i = 0; i < JP_STORE_SLOT_WORDS; i++) {
        slot->words[i] = flash->read(flash->context, sector, word_offset(number, i));
    }
}

static bool is_erased(const struct slot *slot)
{
    uint32_t all = ERASED;

    for (unsigned i = 0; i < JP_STORE_SLOT_WORDS; i++) {
        all &= slot->words[i];
    }
    return all == ERASED;
}

static bool is_whole(const struct slot *slot)
{
    const uint32_t length = slot->words[WORD_LENGTH];

    return slot->words[WORD_MARK] == MARK && length > 0U && length <= JP_STORE_LENGTH_MAX &&
           slot->words[WORD_CRC] == slot_crc(slot);
}

/** What a sector holds. */
struct scan {
    bool found;   /**< the slot is its last whole one */
    bool torn;    /**< behind that there is something else */
    uint32_t end; /**< the first slot with nothing in it nor behind it */
    uint32_t number;
    struct slot slot;
};

/** From the end of the log back to its last whole slot. */
static void scan_sector(const struct jp_store *store, unsigned sector, struct scan *scan)
{
    scan->found = false;
    scan->torn = false;
    scan->end = 0;
    scan->number = 0;
    for (uint32_t left = slot_count(store); left > 0U && !scan->found; left--) {
        scan->number = left - 1U;
        read_slot(store->flash, sector, scan->number, &scan->slot);
        if (is_erased(&scan->slot)) {
            continue;
        }
        scan->end = scan->end == 0U ? left : scan->end;
        scan->found = is_whole(&scan->slot);
        scan->torn = scan->torn || !scan->found;
    }
}

static bool is_newer(const struct scan *scan, const struct jp_store *store)
{
    return store->length == 0U || (int32_t)(scan->slot.words[WORD_GENERATION] - store->generation) > 0;
}

/** Makes the sector the present one. */
static void adopt(struct jp_store *store, unsigned sector, const struct scan *scan)
{
    const struct slot *slot = &scan->slot;

    store->sector = (uint8_t)sector;
    store->slot = scan->number;
    store->next = scan->end;
    store->generation = slot->words[WORD_GENERATION];
    store->length = (uint16_t)slot->words[WORD_LENGTH];
    store->sealed = slot->words[WORD_SEAL] == SEAL;
    store->tail_torn = scan->torn;
    for (unsigned i = 0; i < JP_STORE_LENGTH_MAX / 4U; i++) {
        put_word(store->record + 4U * i, slot->words[WORD_RECORD + i]);
    }
}

enum jp_status jp_store_open(struct jp_store *store, const struct jp_flash *flash)
{
    bool garbage[2];
    struct scan scan;

    if (store == NULL || flash == NULL || flash->sector_size < JP_STORE_SLOT_SIZE) {
        return JP_ERR_ARGUMENT;
    }
    /* An empty store stands before generation 0, which is to begin in sector 0. */
    *store = (struct jp_store){.flash = flash, .generation = UINT32_MAX, .sector = 1, .sealed = true};
    store->next = slot_count(store);
    for (unsigned sector = 0; sector < 2U; sector++) {
        scan_sector(store, sector, &scan);
        garbage[sector] = scan.torn && !scan.found;
        if (scan.found && is_newer(&scan, store)) {
            adopt(store, sector, &scan);
        }
    }
    /* A sector without a whole record may hold the beginning of the next generation, whose CRC may fit another time. */
    store->other_torn = store->length > 0U && garbage[1U - store->sector];
    return store->length > 0U ? JP_OK : JP_ERR_EMPTY;
}

enum jp_status jp_store_read(const struct jp_store *store, const uint8_t **record, uint16_t *length)
{
    if (store == NULL || record == NULL || length == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *record = store->record;
    *length = store->length;
    return store->length > 0U ? JP_OK : JP_ERR_EMPTY;
}

/* ---- Writing ---- */

static void make_slot(struct slot *slot, uint32_t generation, const uint8_t *record, uint16_t length)
{
    for (unsigned i = 0; i < JP_STORE_SLOT_WORDS; i++) {
        slot->words[i] = ERASED;
    }
    slot->words[WORD_MARK] = MARK;
    slot->words[WORD_GENERATION] = generation;
    slot->words[WORD_LENGTH] = length;
    for (unsigned i = 0; i < length; i++) {
        const unsigned shift = 8U * (i % 4U);
        uint32_t *word = &slot->words[WORD_RECORD + i / 4U];

        *word = (*word & ~(0xFFU << shift)) | ((uint32_t)record[i] << shift);
    }
    slot->words[WORD_CRC] = slot_crc(slot);
    slot->words[WORD_SEAL] = SEAL;
}

/** Programs and reads back words `first` to before `end`. */
static enum jp_status program_words(const struct jp_flash *flash, unsigned sector, uint32_t number,
                                    const struct slot *slot, unsigned first, unsigned end)
{
    for (unsigned i = first; i < end; i++) {
        const uint32_t offset = word_offset(number, i);

        if (slot->words[i] != ERASED && flash->program(flash->context, sector, offset, slot->words[i]) != JP_OK) {
            return JP_ERR_HARDWARE;
        }
    }
    for (unsigned i = first; i < end; i++) {
        if (flash->read(flash->context, sector, word_offset(number, i)) != slot->words[i]) {
            return JP_ERR_HARDWARE;
        }
    }
    return JP_OK;
}

static enum jp_status program_slot(const struct jp_flash *flash, unsigned sector, uint32_t number,
                                   const struct slot *slot)
{
    enum jp_status status = program_words(flash, sector, number, slot, 0, WORD_SEAL);

    return status != JP_OK ? status : program_words(flash, sector, number, slot, WORD_SEAL, JP_STORE_SLOT_WORDS);
}

/** To the next slot of the present sector, which has one. */
static enum jp_status append(struct jp_store *store, const uint8_t *record, uint16_t length)
{
    struct slot slot;
    enum jp_status status;

    make_slot(&slot, store->generation, record, length);
    status = program_slot(store->flash, store->sector, store->next, &slot);
    if (status == JP_OK) {
        store->slot = store->next;
        store->sealed = true;
        store->tail_torn = false;
    }
    store->next++;
    return status;
}

/** To the other sector, which becomes the present one. After a failure it is torn. */
static enum jp_status change_sector(struct jp_store *store, const uint8_t *record, uint16_t length)
{
    const unsigned other = 1U - store->sector;
    struct slot slot;

    store->other_torn = true;
    store->erases++;
    if (store->flash->erase(store->flash->context, other) != JP_OK) {
        return JP_ERR_HARDWARE;
    }
    make_slot(&slot, store->generation + 1U, record, length);
    if (program_slot(store->flash, other, 0, &slot) != JP_OK) {
        return JP_ERR_HARDWARE;
    }
    store->sector = (uint8_t)other;
    store->generation++;
    store->slot = 0;
    store->next = 1;
    store->tail_torn = false;
    store->other_torn = false;
    return JP_OK;
}

/** Where there is room. The other sector may hold the only firm record until the present one does. */
static enum jp_status place(struct jp_store *store, const uint8_t *record, uint16_t length)
{
    for (unsigned i = 0; i < PLACES_IN_SECTOR && !store->other_torn && store->next < slot_count(store); i++) {
        if (append(store, record, length) == JP_OK) {
            return JP_OK;
        }
    }
    return store->sealed ? change_sector(store, record, length) : JP_ERR_HARDWARE;
}

/** Programs the record found once more, in its place, since it was perhaps cut; where that fails a copy must do. */
static void seal(struct jp_store *store)
{
    struct slot slot;

    make_slot(&slot, store->generation, store->record, store->length);
    store->sealed = program_slot(store->flash, store->sector, store->slot, &slot) == JP_OK;
}

enum jp_status jp_store_settle(struct jp_store *store)
{
    if (store == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (store->length == 0U) {
        return JP_OK;
    }
    if (!store->sealed) {
        seal(store);
    }
    return !store->sealed || store->tail_torn || store->other_torn ? place(store, store->record, store->length) : JP_OK;
}

static bool is_present(const struct jp_store *store, const uint8_t *record, uint16_t length)
{
    bool equal = length == store->length;

    for (unsigned i = 0; i < length && equal; i++) {
        equal = record[i] == store->record[i];
    }
    return equal;
}

enum jp_status jp_store_write(struct jp_store *store, const uint8_t *record, uint16_t length)
{
    enum jp_status status;

    if (store == NULL || record == NULL || length == 0U || length > JP_STORE_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    status = jp_store_settle(store);
    if (status == JP_OK && !is_present(store, record, length)) {
        status = place(store, record, length);
        if (status == JP_OK) {
            memcpy(store->record, record, length);
            store->length = length;
        }
    }
    return status;
}
