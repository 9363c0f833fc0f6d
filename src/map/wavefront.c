#include <joulepath/wavefront.h>
#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"

enum { WORD_BITS = 32, MARGIN_DIVISOR = 4, CLEARED_CELLS = 384, LOOKS_PER_CELL = 128 };

static size_t words_per_row(uint16_t width)
{
    return ((size_t)width + WORD_BITS - 1) / WORD_BITS;
}

static size_t cells_of(uint16_t width, uint16_t height)
{
    return (size_t)width * height;
}

static size_t values_size(uint16_t width, uint16_t height)
{
    return jp_block_align(cells_of(width, height) * sizeof(uint16_t));
}

static size_t high_size(uint16_t width, uint16_t height, enum jp_wave_format format)
{
    return format == JP_WAVE_3_BYTES ? jp_block_align(cells_of(width, height)) : 0U;
}

static size_t dirty_size(uint16_t width, uint16_t height)
{
    return words_per_row(width) * height * sizeof(uint32_t);
}

size_t jp_wavefront_size(uint16_t width, uint16_t height, enum jp_wave_format format)
{
    return values_size(width, height) + high_size(width, height, format) + jp_block_align(dirty_size(width, height));
}

void jp_wavefront_init(struct jp_wavefront *wave, uint16_t width, uint16_t height, enum jp_wave_format format,
                       void *block)
{
    uint8_t *after_values = (uint8_t *)block + values_size(width, height);

    (void)memset(wave, 0, sizeof *wave);
    wave->width = width;
    wave->height = height;
    wave->not_reached = (UINT32_C(1) << (8U * (unsigned)format)) - 1U;
    wave->values = block;
    wave->high = format == JP_WAVE_3_BYTES ? after_values : NULL;
    wave->dirty = (uint32_t *)(void *)(after_values + high_size(width, height, format));
}

static void start_row(struct jp_wavefront *wave)
{
    wave->column = wave->is_backward ? (uint16_t)(wave->width - 1U) : 0U;
}

static void start_sweep(struct jp_wavefront *wave, uint32_t threshold)
{
    wave->threshold = threshold;
    wave->lowest = wave->not_reached;
    wave->has_changed = false;
    wave->is_backward = !wave->is_backward;
    wave->row = wave->is_backward ? wave->last_row : wave->first_row;
    start_row(wave);
}

void jp_wavefront_start(struct jp_wavefront *wave, uint32_t step, uint16_t target_x, uint16_t target_y)
{
    wave->step = step;
    wave->target_x = target_x;
    wave->target_y = target_y;
    wave->horizon = jp_wavefront_value_max(wave);
    wave->clear_row = 0;
    wave->is_backward = true; /* the first sweep goes forward */
}

void jp_wavefront_clear(struct jp_wavefront *wave)
{
    const uint16_t left = (uint16_t)(wave->height - wave->clear_row);
    const uint16_t most = (uint16_t)((unsigned)CLEARED_CELLS / wave->width + 1U);
    const uint16_t rows = most < left ? most : left;
    const size_t first = cells_of(wave->width, wave->clear_row);
    const size_t cells = cells_of(wave->width, rows);

    (void)memset(&wave->values[first], 0xFF, cells * sizeof *wave->values);
    if (wave->high != NULL) {
        (void)memset(&wave->high[first], 0xFF, cells);
    }
    (void)memset(&wave->dirty[words_per_row(wave->width) * wave->clear_row], 0, dirty_size(wave->width, rows));
    wave->clear_row = (uint16_t)(wave->clear_row + rows);
    if (jp_wavefront_is_clear(wave)) {
        wave->first_row = wave->height;
        wave->last_row = 0;
        start_sweep(wave, wave->step);
        wave->has_changed = true; /* the root is yet to come: sweep again */
    }
}

static void mark(struct jp_wavefront *wave, int32_t x, int32_t y)
{
    wave->dirty[(size_t)y * words_per_row(wave->width) + (size_t)x / WORD_BITS] |= UINT32_C(1)
                                                                                   << ((uint32_t)x % WORD_BITS);
    if (y < (int32_t)wave->first_row) {
        wave->first_row = (uint16_t)y;
    }
    if (y > (int32_t)wave->last_row) {
        wave->last_row = (uint16_t)y;
    }
}

void jp_wavefront_lower(struct jp_wavefront *wave, int32_t x, int32_t y, uint32_t value)
{
    const size_t cell = (size_t)y * wave->width + (size_t)x;

    wave->values[cell] = (uint16_t)(value & UINT16_MAX);
    if (wave->high != NULL) {
        wave->high[cell] = (uint8_t)(value >> 16U);
    }
    mark(wave, x, y);
}

void jp_wavefront_touch(struct jp_wavefront *wave, int32_t x, int32_t y)
{
    if (jp_wavefront_value(wave, x, y) != wave->not_reached) {
        mark(wave, x, y);
    }
}

void jp_wavefront_resume(struct jp_wavefront *wave)
{
    start_sweep(wave, wave->step);
}

static uint32_t add_limited(const struct jp_wavefront *wave, uint32_t a, uint32_t b)
{
    const uint32_t most = jp_wavefront_value_max(wave);

    return a + b > most ? most : a + b;
}

/** Begins the next sweep: at the same threshold while cells are handed out, else at the next dirty value. False when
 * the wave has stopped. */
static bool next_sweep(struct jp_wavefront *wave)
{
    if (wave->has_changed) {
        start_sweep(wave, wave->threshold);
        return true;
    }
    const uint32_t target = jp_wavefront_value(wave, wave->target_x, wave->target_y);

    if (wave->horizon == jp_wavefront_value_max(wave) && target <= wave->threshold) {
        wave->horizon = add_limited(wave, target, target / (uint32_t)MARGIN_DIVISOR + wave->step);
    }
    if (wave->lowest == wave->not_reached || wave->lowest > wave->horizon) {
        return false;
    }
    start_sweep(wave, add_limited(wave, wave->lowest, wave->step));
    return true;
}

/** The next bit of a word in the direction of the sweep. */
static uint32_t next_bit(const struct jp_wavefront *wave, uint32_t word)
{
    return wave->is_backward ? WORD_BITS - 1U - JP_LEADING_ZEROS(word) : JP_TRAILING_ZEROS(word);
}

/** Those of a word that this sweep has yet to look at, in the word that it is in. */
static uint32_t unseen(const struct jp_wavefront *wave)
{
    const uint32_t bit = wave->column % (uint32_t)WORD_BITS;

    return wave->is_backward ? UINT32_MAX >> (WORD_BITS - 1U - bit) : UINT32_MAX << bit;
}

/** Goes on to the next word of the row. False at its end. */
static bool next_word(struct jp_wavefront *wave)
{
    const unsigned word = wave->column / (unsigned)WORD_BITS;

    if (wave->is_backward ? word == 0U : word + 1U == words_per_row(wave->width)) {
        return false;
    }
    wave->column = (uint16_t)(wave->is_backward ? word * WORD_BITS - 1U : (word + 1U) * WORD_BITS);
    return true;
}

/** The next dirty cell of the present word whose value is up to the threshold. False: none. */
static bool next_in_word(struct jp_wavefront *wave, int32_t *x)
{
    const unsigned first = wave->column / (unsigned)WORD_BITS * WORD_BITS;
    uint32_t *word = &wave->dirty[(size_t)wave->row * words_per_row(wave->width) + first / WORD_BITS];

    uint32_t rest = *word & unseen(wave);

    while (rest != 0U) {
        const uint32_t bit = next_bit(wave, rest);
        const uint32_t value = jp_wavefront_value(wave, (int32_t)(first + bit), wave->row);

        rest &= ~(UINT32_C(1) << bit);
        if (value <= wave->threshold) {
            *word &= ~(UINT32_C(1) << bit);
            wave->column = (uint16_t)(first + bit);
            *x = wave->column;
            return true;
        }
        if (value < wave->lowest) {
            wave->lowest = value;
        }
        wave->looks++;
    }
    return false;
}

/** The next dirty cell of the present row whose value is up to the threshold. False: none. */
static bool next_in_row(struct jp_wavefront *wave, int32_t *x)
{
    do {
        if (next_in_word(wave, x)) {
            return true;
        }
    } while (next_word(wave));
    return false;
}

/** True when the sweep has looked at all rows that may hold dirty cells. */
static bool has_passed(const struct jp_wavefront *wave)
{
    return wave->is_backward ? wave->row < (int32_t)wave->first_row : wave->row > (int32_t)wave->last_row;
}

/** A row has been looked through in vain: that takes time, too. */
static void count_row(struct jp_wavefront *wave, unsigned *cells)
{
    wave->looks = (uint16_t)(wave->looks + words_per_row(wave->width));
    while (wave->looks >= LOOKS_PER_CELL && *cells > 0U) {
        wave->looks = (uint16_t)(wave->looks - LOOKS_PER_CELL);
        --*cells;
    }
}

enum jp_wave_step jp_wavefront_next(struct jp_wavefront *wave, unsigned *cells, int32_t *x, int32_t *y)
{
    while (*cells > 0U) {
        if (has_passed(wave)) {
            if (!next_sweep(wave)) {
                return JP_WAVE_STOPPED;
            }
        } else if (next_in_row(wave, x)) {
            *y = wave->row;
            wave->has_changed = true;
            --*cells;
            return JP_WAVE_CELL;
        } else {
            wave->row += wave->is_backward ? -1 : 1;
            start_row(wave);
            count_row(wave, cells);
        }
    }
    return JP_WAVE_WAITING;
}

bool jp_wavefront_is_exhausted(const struct jp_wavefront *wave)
{
    return wave->lowest == wave->not_reached;
}
