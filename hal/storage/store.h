/**
 * A record of parameters in flash that survives power loss at every moment of a write.
 *
 * Two sectors take turns. Records are appended to one as to a log; when it is full, the other one is erased and takes
 * the next record. A record is never touched until a newer one is whole, so that there is always the old one or the new
 * one. What is guarded against:
 *
 *   torn word     a word whose programming was cut may read as any mix of old and new bits, another one each time. The
 *                 last word of a record, its seal, is programmed when all others stand firm; a record without it may
 *                 have a CRC that fits only now and then, so it is programmed again before anything relies on it.
 *   torn erase    the sector holds anything, and what looks erased may not be: only one that was erased since the
 *                 store was opened, right before its first record, is taken for erased.
 *   worn words    a record is read back; one that did not take is given up, and the next place is tried.
 *
 * All calls are for the background loop with motors off: an erase stops some parts for half a second. Call
 * jp_store_open(), jp_store_read(), and once writing is allowed jp_store_settle().
 */
#ifndef JOULEPATH_HAL_STORAGE_STORE_H
#define JOULEPATH_HAL_STORAGE_STORE_H

#include <stdbool.h>
#include <stdint.h>

#include <joulepath/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Two equal sectors of NOR flash, 0 and 1. An erased word reads 0xFFFFFFFF; programming turns bits from 1 to 0, also in
 * a word that was programmed before. Offsets are in bytes from the sector's start, multiples of 4, within sector_size.
 */
struct jp_flash {
    void *context;        /**< handed to each function */
    uint32_t sector_size; /**< bytes; at least JP_STORE_SLOT_SIZE */

    uint32_t (*read)(void *context, unsigned sector, uint32_t offset);

    /** Returns when the word stands firm. JP_ERR_HARDWARE: it may read as anything between old and new. */
    enum jp_status (*program)(void *context, unsigned sector, uint32_t offset, uint32_t word);

    /** Returns when the whole sector is erased. JP_ERR_HARDWARE: it may hold anything. */
    enum jp_status (*erase)(void *context, unsigned sector);
};

#define JP_STORE_SLOT_WORDS 64U
#define JP_STORE_SLOT_SIZE  (4U * JP_STORE_SLOT_WORDS) /**< bytes of flash a record */
#define JP_STORE_LENGTH_MAX (JP_STORE_SLOT_SIZE - 20U) /**< bytes of a record; the rest is its frame */

/** The newest record and where the next one goes. Its members are private but for those with a comment. */
struct jp_store {
    const struct jp_flash *flash;
    uint32_t generation; /**< of the present sector: changes of sector so far, wrapping */
    uint32_t erases;     /**< begun since jp_store_open() */
    uint32_t slot;
    uint32_t next;
    uint16_t length;
    uint8_t sector;
    bool sealed;
    bool tail_torn;
    bool other_torn;
    uint8_t record[JP_STORE_LENGTH_MAX];
};

/**
 * Finds the newest whole record; reads only. flash is kept by pointer.
 * JP_ERR_EMPTY: there is none, and jp_store_write() makes the first. JP_ERR_ARGUMENT: a pointer is null or a sector is
 * smaller than a record. Worst case, sectors full of garbage: each word is read twice, and one CRC a slot.
 */
enum jp_status jp_store_open(struct jp_store *store, const struct jp_flash *flash);

/**
 * The record: `length` bytes from `*record`, which stay until the next write. JP_ERR_EMPTY: there is none.
 */
enum jp_status jp_store_read(const struct jp_store *store, const uint8_t **record, uint16_t *length);

/**
 * Makes final what a cut write left in the balance: without it the record found may at the next opening be the one
 * before again, or the one that was being written. Writes nothing unless a write or an erase was cut, then at most a
 * record and an erase. JP_OK also for an empty store. JP_ERR_HARDWARE: the flash did not take it; the record can still
 * be read.
 */
enum jp_status jp_store_settle(struct jp_store *store);

/**
 * Stores a record, 1…JP_STORE_LENGTH_MAX bytes; one that is equal to the present one is not written again. Settles
 * first. At most seven records are programmed, and two sectors erased. JP_ERR_ARGUMENT: a pointer is null or the length
 * out of range. JP_ERR_HARDWARE: the flash did not take it, at two places in the present sector and one in the other;
 * the store goes on with the old record, and the next opening finds the old one or the new one.
 */
enum jp_status jp_store_write(struct jp_store *store, const uint8_t *record, uint16_t length);

#ifdef __cplusplus
}
#endif

#endif
