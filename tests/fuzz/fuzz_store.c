/**
 * The store of parameters on flash that holds anything: slots that are right, slots that are nearly so, and any words.
 * What it returns as a record stands whole in one of its slots; what it wrote it finds again; what it was writing when
 * power failed leaves the old record or the new one. A record that fits no robot is refused.
 */
#include <setjmp.h>

#include "hal/storage/parameters.h"
#include "tests/fuzz/fuzz_input.h"

#define NOR_WORDS (4U * JP_STORE_SLOT_WORDS)
#define SLOTS     (NOR_WORDS / JP_STORE_SLOT_WORDS)
#define IDENTITY  0x12345678U

#include "tests/support/nor_flash.h"

static struct nor_flash nor;
static struct jp_flash flash;
static struct jp_store store;
static jmp_buf power;

static void power_off(void)
{
    longjmp(power, 1);
}

static uint16_t draw_record(struct fuzz_input *input, uint8_t record[JP_STORE_LENGTH_MAX])
{
    const uint16_t length = (uint16_t)(1U + fuzz_below(input, JP_STORE_LENGTH_MAX));

    memset(record, fuzz_u8(input), JP_STORE_LENGTH_MAX);
    fuzz_fill(input, record, fuzz_below(input, 16) % length);
    return length;
}

static void put_sound_slot(struct fuzz_input *input)
{
    uint8_t record[JP_STORE_LENGTH_MAX];
    const uint16_t length = draw_record(input, record);
    const unsigned sector = fuzz_below(input, 2);
    const uint32_t slot = fuzz_below(input, SLOTS);

    for (unsigned i = 0; i < JP_STORE_SLOT_WORDS; i++) {
        nor.sectors[sector][slot * JP_STORE_SLOT_WORDS + i] = (struct nor_word){.value = NOR_ERASED};
    }
    nor_put_slot(&nor, sector, slot, fuzz_bool(input) ? fuzz_u8(input) : fuzz_u32(input), record, length);
}

static void draw_flash(struct fuzz_input *input)
{
    nor_start(&nor, UINT64_C(1) + fuzz_u16(input));
    nor.power_off = power_off;
    nor.mood = fuzz_below(input, NOR_MOODY + 1U);
    flash = nor_interface(&nor);
    for (unsigned left = fuzz_below(input, 9); left > 0U; left--) {
        put_sound_slot(input);
    }
    for (unsigned left = fuzz_below(input, 9); left > 0U; left--) {
        struct nor_word *word = &nor.sectors[fuzz_below(input, 2)][fuzz_below(input, NOR_WORDS)];

        fuzz_fill(input, word, sizeof *word);
    }
}

/** Whether a slot may be read as this record, whichever way its unstable bits go. */
static bool may_be(const struct nor_word *words, const uint8_t *record, uint16_t length)
{
    static struct nor_flash wanted;
    const struct nor_word *own = wanted.sectors[0];

    if (((words[2].value ^ length) & ~words[2].unstable) != 0U) {
        return false;
    }
    nor_start(&wanted, 1);
    nor_put_slot(&wanted, 0, 0, words[1].value, record, length);

    /* Where the generation wavers so does the CRC. */
    const unsigned last = words[1].unstable != 0U ? JP_STORE_SLOT_WORDS - 2U : JP_STORE_SLOT_WORDS - 1U;

    for (unsigned i = 0; i < last; i++) {
        if (((words[i].value ^ own[i].value) & ~words[i].unstable) != 0U) {
            return false;
        }
    }
    return true;
}

static bool stands_whole(const uint8_t *record, uint16_t length)
{
    bool whole = false;

    for (unsigned slot = 0; slot < 2U * SLOTS && !whole; slot++) {
        whole = may_be(&nor.sectors[slot / SLOTS][slot % SLOTS * JP_STORE_SLOT_WORDS], record, length);
    }
    return whole;
}

/** What the store shows; 0: nothing. */
static uint16_t look(uint8_t record[JP_STORE_LENGTH_MAX])
{
    const uint8_t *shown = NULL;
    uint16_t length = 0;
    const enum jp_status status = jp_store_read(&store, &shown, &length);

    fuzz_require(status == JP_OK || status == JP_ERR_EMPTY, "a status of a store");
    if (status == JP_ERR_EMPTY) {
        return 0;
    }
    fuzz_require(length >= 1U && length <= JP_STORE_LENGTH_MAX, "the length of a record");
    memcpy(record, shown, length);
    return length;
}

static void check_parameters(const uint8_t *record, uint16_t length)
{
    struct jp_parameters parameters;
    uint8_t again[JP_PARAMETERS_LENGTH];
    const char *field = NULL;
    uint32_t identity = IDENTITY;

    if (length >= 8U) {
        memcpy(&identity, record + 4, sizeof identity);
    }
    if (jp_parameters_decode(&parameters, identity, record, length, &field) != JP_OK) {
        fuzz_require(field != NULL && field[0] != '\0', "a refusal without a name");
        return;
    }
    fuzz_require(jp_parameters_check(&parameters, &field) == JP_OK, "parameters out of range");
    jp_parameters_encode(&parameters, identity, again);
    fuzz_require(length == JP_PARAMETERS_LENGTH && memcmp(record, again, length) == 0, "other parameters");
}

static void open_store(void)
{
    uint8_t record[JP_STORE_LENGTH_MAX];
    const enum jp_status status = jp_store_open(&store, &flash);
    const uint16_t length = look(record);

    fuzz_require(status == (length == 0U ? JP_ERR_EMPTY : JP_OK), "opening says something else");
    fuzz_require(length == 0U || stands_whole(record, length), "a record that was not written whole");
    check_parameters(record, length);
}

/** Power may fail within; then the old record or the new one is there. */
static void write_record(struct fuzz_input *input)
{
    static uint8_t old[JP_STORE_LENGTH_MAX], record[JP_STORE_LENGTH_MAX], found[JP_STORE_LENGTH_MAX];
    const uint16_t length = draw_record(input, record);
    const uint16_t old_length = look(old);

    nor.cut_step = fuzz_bool(input) ? nor.steps + 1U + fuzz_below(input, 128) : 0U;
    nor.cut = (struct nor_cut){.done = fuzz_below(input, 9), .unstable = fuzz_below(input, 9)};
    if (setjmp(power) == 0) {
        const enum jp_status status = jp_store_write(&store, record, length);
        const uint16_t now = look(found);

        nor.cut_step = 0;
        fuzz_require(status == JP_OK || status == JP_ERR_HARDWARE, "the status of a write");
        fuzz_require(status != JP_OK || (now == length && memcmp(found, record, length) == 0), "another record");
        fuzz_require(status == JP_OK || (now == old_length && memcmp(found, old, now) == 0), "a failed write changed");
        return;
    }
    nor.cut_step = 0;
    open_store();

    const uint16_t now = look(found);

    fuzz_require((now == old_length && memcmp(found, old, now) == 0) ||
                     (now == length && memcmp(found, record, now) == 0) || nor.mood != 0U,
                 "neither the old record nor the new one");
}

static void settle(void)
{
    static uint8_t before[JP_STORE_LENGTH_MAX], after[JP_STORE_LENGTH_MAX];
    const uint16_t length = look(before);

    (void)jp_store_settle(&store);
    fuzz_require(look(after) == length && memcmp(before, after, length) == 0, "settling changed the record");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};

    draw_flash(&input);
    open_store();
    for (unsigned left = 16; left > 0U && fuzz_more(&input); left--) {
        switch (fuzz_below(&input, 3)) {
        case 0:
            open_store();
            break;
        case 1:
            settle();
            break;
        default:
            write_record(&input);
            break;
        }
    }
    return 0;
}
