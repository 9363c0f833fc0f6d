#include "src/map/pose_wave.h"

#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"

/** What is looked at in vain while a pose is dealt with. */
#define LOOKS_PER_POSE 32U

static size_t cells_of(const struct jp_terrain_config *map)
{
    return (size_t)map->width * map->height;
}

/** Low and high bits of the values, and the fresh headings. */
static size_t cell_size(void)
{
    return (size_t)JP_HEADINGS * (sizeof(uint16_t) + sizeof(uint8_t)) + sizeof(uint16_t);
}

size_t jp_pose_wave_size(const struct jp_terrain_config *map)
{
    return jp_block_align(map->height * sizeof(uint32_t)) + jp_block_align(cells_of(map) * cell_size());
}

void jp_pose_wave_init(struct jp_pose_wave *wave, const struct jp_terrain_config *map, void *block)
{
    const size_t poses = cells_of(map) * (size_t)JP_HEADINGS;

    (void)memset(wave, 0, sizeof *wave);
    wave->width = map->width;
    wave->height = map->height;
    wave->row_least = block;
    wave->low = (uint16_t *)(void *)((uint8_t *)block + jp_block_align(map->height * sizeof(uint32_t)));
    wave->fresh = &wave->low[poses];
    wave->high = (uint8_t *)&wave->fresh[cells_of(map)];
}

static jp_cost up_to_limit(const struct jp_pose_wave *wave, jp_cost value)
{
    return value < wave->limit ? value : wave->limit;
}

void jp_pose_wave_start(struct jp_pose_wave *wave, uint32_t step, jp_cost limit)
{
    wave->step = step;
    wave->limit = limit;
    wave->threshold = up_to_limit(wave, step);
    wave->row = wave->height;
    wave->direction = -1;   /* the first sweep goes forward */
    wave->has_taken = true; /* the root is yet to come: sweep */
}

void jp_pose_wave_clear_row(struct jp_pose_wave *wave, uint16_t y)
{
    const size_t cell = pose_cell(wave, 0, y);
    const size_t poses = wave->width * (size_t)JP_HEADINGS;

    (void)memset(&wave->low[cell * (size_t)JP_HEADINGS], 0xFF, poses * sizeof *wave->low);
    (void)memset(&wave->high[cell * (size_t)JP_HEADINGS], 0xFF, poses);
    (void)memset(&wave->fresh[cell], 0, wave->width * sizeof *wave->fresh);
    wave->row_least[y] = JP_COST_MAX;
}

static bool is_row(const struct jp_pose_wave *wave)
{
    return wave->row >= 0 && wave->row < (int32_t)wave->height;
}

static void note_left(struct jp_pose_wave *wave, jp_cost value)
{
    wave->left = value < wave->left ? value : wave->left;
}

/** Goes on to a row that may hold fresh poses up to the threshold, if one is left. */
static void seek_row(struct jp_pose_wave *wave)
{
    while (is_row(wave) && wave->row_least[wave->row] > wave->threshold) {
        note_left(wave, wave->row_least[wave->row]);
        wave->row += wave->direction;
        wave->looks++;
    }
    wave->column = wave->direction > 0 ? 0 : (int32_t)wave->width - 1;
    if (is_row(wave)) {
        wave->row_least[wave->row] = JP_COST_MAX;
    }
}

/** Begins the next sweep: at the same threshold while poses are taken, else at the least fresh value. False when the
 *  wave has stopped. */
static bool next_sweep(struct jp_pose_wave *wave)
{
    if (!wave->has_taken) {
        if (wave->left > wave->limit) {
            return false;
        }
        wave->threshold = up_to_limit(wave, wave->left + wave->step);
    }
    wave->left = JP_COST_MAX;
    wave->has_taken = false;
    wave->direction = -wave->direction;
    wave->row = wave->direction > 0 ? 0 : (int32_t)wave->height - 1;
    seek_row(wave);
    return true;
}

/** Goes on to a cell of the row that has fresh poses. False: none is left. */
static bool seek_cell(struct jp_pose_wave *wave)
{
    const uint16_t *fresh = &wave->fresh[pose_cell(wave, 0, wave->row)];
    const int32_t end = wave->direction > 0 ? (int32_t)wave->width : -1;
    int32_t column = wave->column;

    while (column != end && fresh[column] == 0U) {
        column += wave->direction;
    }
    wave->looks += (uint32_t)(column > wave->column ? column - wave->column : wave->column - column);
    wave->column = column;
    return column != end;
}

/** The fresh headings of a cell whose values are up to the threshold: bits. */
static uint32_t due_headings(struct jp_pose_wave *wave, size_t cell)
{
    jp_cost *least = &wave->row_least[wave->row];
    uint32_t due = 0;

    for (uint32_t rest = wave->fresh[cell]; rest != 0U; rest &= rest - 1U) {
        const unsigned heading = JP_TRAILING_ZEROS(rest);
        const jp_cost value = pose_value(wave, cell, heading);

        if (value <= wave->threshold) {
            due |= UINT32_C(1) << heading;
        } else {
            *least = value < *least ? value : *least;
        }
        wave->looks++;
    }
    return due;
}

static void count_looks(struct jp_pose_wave *wave, unsigned *poses)
{
    while (wave->looks >= LOOKS_PER_POSE && *poses > 0U) {
        wave->looks -= LOOKS_PER_POSE;
        --*poses;
    }
}

enum jp_pose_wave_step jp_pose_wave_next(struct jp_pose_wave *wave, unsigned *poses, struct jp_pose_group *group)
{
    while (*poses > 0U) {
        if (!is_row(wave)) {
            if (!next_sweep(wave)) {
                return JP_POSE_WAVE_STOPPED;
            }
        } else if (!seek_cell(wave)) {
            note_left(wave, wave->row_least[wave->row]);
            wave->row += wave->direction;
            seek_row(wave);
        } else {
            *group = (struct jp_pose_group){wave->column, wave->row,
                                            due_headings(wave, pose_cell(wave, wave->column, wave->row))};
            wave->column += wave->direction;
            if (group->headings != 0U) {
                wave->has_taken = true;
                return JP_POSE_WAVE_CELL;
            }
        }
        count_looks(wave, poses);
    }
    return JP_POSE_WAVE_WAITING;
}
