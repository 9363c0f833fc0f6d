/**
 * Least costs over a grid, propagated from a root: the common part of energy_field.h and guide_field.h.
 * Internal: here only because struct jp_planner holds it.
 *
 * Cells whose values have fallen are marked and handed out, about in the order of their values, until none is left
 * below the horizon, in sweeps to and fro; the caller relaxes their neighbours. So a wave grows from a root, and so it
 * is repaired when values fall later. There is no queue: two or three bytes and one bit a cell, and the same work in
 * slices as at once. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_WAVEFRONT_H
#define JOULEPATH_WAVEFRONT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of a value. */
enum jp_wave_format { JP_WAVE_2_BYTES = 2, JP_WAVE_3_BYTES = 3 };

/** The members are private. */
struct jp_wavefront {
    uint16_t *values;     /**< their low 16 bits */
    uint8_t *high;        /**< their high 8 bits; null: values of two bytes */
    uint32_t not_reached; /**< the largest value of the format; that below it is the largest of a cell */
    uint32_t *dirty;      /**< cells whose values have fallen since they were handed out */
    uint16_t width;
    uint16_t height;
    uint32_t step;      /**< growth of the threshold */
    uint32_t threshold; /**< cells up to it are handed out */
    uint32_t lowest;    /**< lowest dirty value above the threshold that this sweep has seen */
    uint32_t horizon;   /**< values up to it are final when the wave has stopped */
    bool has_changed;   /**< this sweep has handed out a cell */
    bool is_backward;   /**< this sweep goes from the last row and column to the first, as every other one */
    int32_t row;        /**< where this sweep is */
    uint16_t column;
    uint16_t clear_row; /**< rows from here on are yet to be cleared */
    uint16_t looks;     /**< at words of bits, and at cells above the threshold, that are not counted yet */
    uint16_t first_row; /**< rows that may hold dirty cells */
    uint16_t last_row;
    uint16_t target_x;
    uint16_t target_y;
};

/** Bytes for a grid, a multiple of 8. */
size_t jp_wavefront_size(uint16_t width, uint16_t height, enum jp_wave_format format);

/** Binds a wave to its grid and to jp_wavefront_size() bytes aligned to 8. */
void jp_wavefront_init(struct jp_wavefront *wave, uint16_t width, uint16_t height, enum jp_wave_format format,
                       void *block);

/** The largest value of a cell: sums beyond it are limited to it. */
static inline uint32_t jp_wavefront_value_max(const struct jp_wavefront *wave)
{
    return wave->not_reached - 1U;
}

/** Starts anew: all cells must be cleared next. `step`, above 0, is about the difference of neighbouring values. The
 *  wave will stop a quarter beyond the target's value. Constant time. */
void jp_wavefront_start(struct jp_wavefront *wave, uint32_t step, uint16_t target_x, uint16_t target_y);

static inline bool jp_wavefront_is_clear(const struct jp_wavefront *wave)
{
    return wave->clear_row == wave->height;
}

/** Clears some rows; after the last no cell is reached, and the root can be lowered. Work: 1 KiB, or a row. */
void jp_wavefront_clear(struct jp_wavefront *wave);

/** Value of a cell of the grid; wave->not_reached where the wave has not been. Constant time. */
static inline uint32_t jp_wavefront_value(const struct jp_wavefront *wave, int32_t x, int32_t y)
{
    const size_t cell = (size_t)y * wave->width + (size_t)x;

    return wave->values[cell] | (wave->high != NULL ? (uint32_t)wave->high[cell] << 16U : 0U);
}

/** Lowers the value of a cell, which will be handed out. Constant time. */
void jp_wavefront_lower(struct jp_wavefront *wave, int32_t x, int32_t y, uint32_t value);

/** Marks a cell to be handed out again, if it has been reached. Constant time. */
void jp_wavefront_touch(struct jp_wavefront *wave, int32_t x, int32_t y);

/** After touching: begins again with the lowest values. Constant time. */
void jp_wavefront_resume(struct jp_wavefront *wave);

enum jp_wave_step { JP_WAVE_CELL, JP_WAVE_WAITING, JP_WAVE_STOPPED };

/** Hands out a cell whose neighbours are to be relaxed; or waits for more budget; or has stopped. *cells counts down
 * for a cell, and for every 128 looks in vain. */
enum jp_wave_step jp_wavefront_next(struct jp_wavefront *wave, unsigned *cells, int32_t *x, int32_t *y);

/** True when the wave stopped because nothing was left to reach: a cell that is not reached cannot be. */
bool jp_wavefront_is_exhausted(const struct jp_wavefront *wave);

#ifdef __cplusplus
}
#endif

#endif
