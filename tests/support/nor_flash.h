/**
 * Two sectors of NOR flash as they are while power fails: programming only clears bits; a cut word or sector holds any
 * mix of old and new bits, and some of them read differently each time; worn bits do not change any more.
 *
 * The including test defines NOR_WORDS, the words of a sector.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_NOR_FLASH_H
#define JOULEPATH_TESTS_SUPPORT_NOR_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "hal/storage/store.h"
#include "tests/support/random.h"

#define NOR_ERASED 0xFFFFFFFFU
#define NOR_MOODY  9U

struct nor_word {
    uint32_t value;
    uint32_t unstable; /**< bits that read as anything */
    uint32_t worn;     /**< bits that stay as they are */
};

/** What is left of a word or a sector whose change was cut: each bit is done, unstable, or as before. */
struct nor_cut {
    unsigned done;     /**< share of bits, of 8 */
    unsigned unstable; /**< share of the others, of 8 */
};

struct nor_flash {
    struct nor_word sectors[2][NOR_WORDS];
    uint64_t random;        /**< not 0 */
    unsigned mood;          /**< share of the unstable bits that read 1, of 8; NOR_MOODY: another one at each read */
    unsigned long steps;    /**< words programmed and sectors erased so far */
    unsigned long erases;   /**< of these */
    unsigned long cut_step; /**< the step that is cut; 0: none */
    struct nor_cut cut;
    void (*power_off)(void); /**< does not return */
    bool refuses;            /**< worn bits are reported, too: JP_ERR_HARDWARE */
};

static inline uint32_t nor_random(struct nor_flash *nor)
{
    return (uint32_t)(random_next(&nor->random) >> 32);
}

/** Bits that are 1 with a probability of `share` / 8. */
static inline uint32_t nor_bits(struct nor_flash *nor, unsigned share)
{
    uint32_t bits = 0;

    if (share >= 8U) {
        return NOR_ERASED;
    }
    for (unsigned i = 0; i < 3U; i++) {
        bits = (share >> i & 1U) != 0U ? bits | nor_random(nor) : bits & nor_random(nor);
    }
    return bits;
}

static inline uint32_t nor_read(void *context, unsigned sector, uint32_t offset)
{
    struct nor_flash *nor = (struct nor_flash *)context;
    const struct nor_word *word = &nor->sectors[sector][offset / 4U];

    if (word->unstable == 0U) {
        return word->value;
    }
    return (word->value & ~word->unstable) |
           (word->unstable & nor_bits(nor, nor->mood == NOR_MOODY ? nor_random(nor) % NOR_MOODY : nor->mood));
}

/** Takes the bits of `mask` to those of `value`. False: a worn one did not follow. */
static inline bool nor_change(struct nor_word *word, uint32_t value, uint32_t mask)
{
    const uint32_t change = mask & ~word->worn;

    word->value = (word->value & ~change) | (value & change);
    word->unstable &= ~change;
    return ((word->value ^ value) & mask) == 0U;
}

static inline void nor_change_partly(struct nor_flash *nor, struct nor_word *word, uint32_t value, uint32_t mask)
{
    const uint32_t moving = mask & (word->unstable | (word->value ^ value));
    const uint32_t done = moving & nor_bits(nor, nor->cut.done);

    (void)nor_change(word, value, done);
    word->unstable |= moving & ~done & nor_bits(nor, nor->cut.unstable) & ~word->worn;
}

static inline bool nor_is_cut(struct nor_flash *nor)
{
    nor->steps++;
    return nor->steps == nor->cut_step;
}

static inline enum jp_status nor_program(void *context, unsigned sector, uint32_t offset, uint32_t value)
{
    struct nor_flash *nor = (struct nor_flash *)context;
    struct nor_word *word = &nor->sectors[sector][offset / 4U];
    bool took;

    if (nor_is_cut(nor)) {
        nor_change_partly(nor, word, 0, ~value);
        nor->power_off();
    }
    took = nor_change(word, 0, ~value);
    return took || !nor->refuses ? JP_OK : JP_ERR_HARDWARE;
}

static inline enum jp_status nor_erase(void *context, unsigned sector)
{
    struct nor_flash *nor = (struct nor_flash *)context;
    const bool is_cut = nor_is_cut(nor);
    bool took = true;

    nor->erases++;
    for (size_t i = 0; i < NOR_WORDS; i++) {
        struct nor_word *word = &nor->sectors[sector][i];

        if (is_cut) {
            nor_change_partly(nor, word, NOR_ERASED, NOR_ERASED);
        } else {
            took = nor_change(word, NOR_ERASED, NOR_ERASED) && took;
        }
    }
    if (is_cut) {
        nor->power_off();
    }
    return took || !nor->refuses ? JP_OK : JP_ERR_HARDWARE;
}

/** New and erased. */
static inline void nor_start(struct nor_flash *nor, uint64_t seed)
{
    memset(nor, 0, sizeof *nor);
    nor->random = seed;
    for (size_t i = 0; i < NOR_WORDS; i++) {
        nor->sectors[0][i].value = NOR_ERASED;
        nor->sectors[1][i].value = NOR_ERASED;
    }
}

static inline struct jp_flash nor_interface(struct nor_flash *nor)
{
    return (struct jp_flash){
        .context = nor,
        .sector_size = 4U * NOR_WORDS,
        .read = nor_read,
        .program = nor_program,
        .erase = nor_erase,
    };
}

/** A slot as hal/storage/store.c's comment describes it, in words of its own. */
static inline void nor_put_slot(struct nor_flash *nor, unsigned sector, uint32_t slot, uint32_t generation,
                                const uint8_t *record, uint32_t length)
{
    struct nor_word *words = &nor->sectors[sector][JP_STORE_SLOT_WORDS * slot];
    const uint32_t crc_word = JP_STORE_SLOT_WORDS - 2U;
    uint32_t crc = NOR_ERASED;

    words[0].value = 0x3153504AU;
    words[1].value = generation;
    words[2].value = length;
    for (uint32_t i = 0; i < length; i++) {
        words[3U + i / 4U].value ^= (uint32_t)(record[i] ^ 0xFFU) << (8U * (i % 4U));
    }
    for (uint32_t bit = 0; bit < 32U * crc_word; bit++) {
        const uint32_t low = crc ^ (words[bit / 32U].value >> (bit % 32U));

        crc = (crc >> 1) ^ ((low & 1U) != 0U ? 0xEDB88320U : 0U);
    }
    words[crc_word].value = ~crc;
    words[crc_word + 1U].value = 0x2144454CU;
}

#endif
