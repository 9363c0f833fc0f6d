/** The order in which the poses of a field are dealt with. Private to the core. */
#ifndef JOULEPATH_MAP_POSE_WAVE_H
#define JOULEPATH_MAP_POSE_WAVE_H

#include <joulepath/pose_field.h>

/** Bytes for a map, a multiple of 8. */
size_t jp_pose_wave_size(const struct jp_terrain_config *map);

/** Binds a wave to its map and to jp_pose_wave_size() bytes aligned to 8. */
void jp_pose_wave_init(struct jp_pose_wave *wave, const struct jp_terrain_config *map, void *block);

/** Starts anew: all rows must be cleared next. The wave will stop at values beyond `limit`, which is below
 *  JP_COST_MAX − 1. Constant time. */
void jp_pose_wave_start(struct jp_pose_wave *wave, uint32_t step, jp_cost limit);

/** No pose of a row is reached any more. Work: a row. */
void jp_pose_wave_clear_row(struct jp_pose_wave *wave, uint16_t y);

enum jp_pose_wave_step { JP_POSE_WAVE_CELL, JP_POSE_WAVE_WAITING, JP_POSE_WAVE_STOPPED };

/** A cell, and some of its headings: bits. */
struct jp_pose_group {
    int32_t x;
    int32_t y;
    uint32_t headings;
};

/** Hands out the poses of a cell from which motions are to be relaxed; or waits for more budget; or has stopped.
 *  *poses counts down for what is looked at in vain. */
enum jp_pose_wave_step jp_pose_wave_next(struct jp_pose_wave *wave, unsigned *poses, struct jp_pose_group *group);

static inline size_t pose_cell(const struct jp_pose_wave *wave, int32_t x, int32_t y)
{
    return (size_t)y * wave->width + (size_t)x;
}

static inline jp_cost pose_value(const struct jp_pose_wave *wave, size_t cell, unsigned heading)
{
    const size_t pose = cell * (size_t)JP_HEADINGS + heading;

    return wave->low[pose] | (uint32_t)wave->high[pose] << 16U;
}

/** The value of a pose that is dealt with at once. */
static inline void pose_settle(struct jp_pose_wave *wave, size_t cell, unsigned heading, jp_cost value)
{
    const size_t pose = cell * (size_t)JP_HEADINGS + heading;

    wave->low[pose] = (uint16_t)(value & UINT16_MAX);
    wave->high[pose] = (uint8_t)(value >> 16U);
}

/** Of a cell those headings, bits, are dealt with. */
static inline void pose_deal(struct jp_pose_wave *wave, size_t cell, uint32_t headings)
{
    wave->fresh[cell] &= (uint16_t)~headings;
}

/** Lowers the value of a pose, which will be handed out; `y` is the row of its cell. */
static inline void pose_lower(struct jp_pose_wave *wave, size_t cell, int32_t y, unsigned heading, jp_cost value)
{
    pose_settle(wave, cell, heading, value);
    wave->fresh[cell] |= (uint16_t)(1U << heading);
    if (value < wave->row_least[y]) {
        wave->row_least[y] = value;
    }
}

#endif
