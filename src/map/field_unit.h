/** The unit in which a field keeps its values. */
#ifndef JOULEPATH_MAP_FIELD_UNIT_H
#define JOULEPATH_MAP_FIELD_UNIT_H

#include <joulepath/lattice.h>
#include <joulepath/wavefront.h>

/** Cost of a level step along an axis. */
static inline jp_cost field_level_step(const struct jp_lattice *lattice, enum jp_cost_kind kind)
{
    return jp_move_cost(&lattice->move_costs[kind][JP_MOVE_AXIS], 0);
}

/** Bits to drop from a cost so that the cost of so many level paths across the map fits a value of the wave. */
static inline uint8_t field_shift(const struct jp_wavefront *wave, const struct jp_lattice *lattice,
                                  enum jp_cost_kind kind, const struct jp_terrain_config *map, unsigned level_paths)
{
    const uint32_t range = ((uint32_t)map->width + map->height) * field_level_step(lattice, kind) * level_paths;
    uint8_t shift = 0;

    while (range >> shift > jp_wavefront_value_max(wave)) {
        shift++;
    }
    return shift;
}

/** A sum of values, limited to the largest. */
static inline uint32_t field_value(const struct jp_wavefront *wave, uint32_t sum)
{
    const uint32_t most = jp_wavefront_value_max(wave);

    return sum < most ? sum : most;
}

/** Coarse cells that hold so many cells. */
static inline uint16_t field_coarse(uint16_t cells, unsigned scale)
{
    return (uint16_t)((cells + scale - 1U) / scale);
}

/** Counts looks that have been taken before. False when none are owed: *looks are for new ones. */
static inline bool field_pays(uint32_t *debt, unsigned *looks)
{
    const uint32_t paid = *debt < *looks ? *debt : *looks;

    *debt -= paid;
    *looks -= paid;
    return paid > 0U;
}

#endif
