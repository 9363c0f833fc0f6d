#include "src/navigate/navigator_seen.h"

#include <joulepath/count.h>
#include <string.h>

/** So often on the way to a goal. */
#define FORGETS_MAX 3U

/** Two bits a cell. */
#define CELLS_PER_BYTE 4U
#define CELL_MASK      3U

static const struct jp_terrain *map_of(const struct jp_navigator *navigator)
{
    return jp_planner_terrain(navigator->config.planner);
}

static size_t bytes_per_row(const struct jp_terrain_config *map)
{
    return ((size_t)map->width + CELLS_PER_BYTE - 1U) / CELLS_PER_BYTE;
}

size_t jp_navigator_seen_size(const struct jp_terrain_config *map)
{
    return bytes_per_row(map) * map->height;
}

static uint8_t *byte_of(const struct jp_navigator *navigator, uint32_t x, uint32_t y)
{
    return &navigator->config.seen[y * bytes_per_row(&map_of(navigator)->config) + x / CELLS_PER_BYTE];
}

static unsigned shift_of(uint32_t x)
{
    return 2U * (x % CELLS_PER_BYTE);
}

/** What it was before the robot saw it, and one more; 0: it is so still. */
static unsigned entry_at(const struct jp_navigator *navigator, uint32_t x, uint32_t y)
{
    return ((unsigned)*byte_of(navigator, x, y) >> shift_of(x)) & CELL_MASK;
}

static void set_entry(const struct jp_navigator *navigator, uint32_t x, uint32_t y, unsigned entry)
{
    uint8_t *byte = byte_of(navigator, x, y);

    *byte = (uint8_t)((*byte & ~(CELL_MASK << shift_of(x))) | (entry << shift_of(x)));
}

void jp_seen_start(struct jp_navigator *navigator)
{
    if (navigator->config.seen != NULL) {
        (void)memset(navigator->config.seen, 0, jp_navigator_seen_size(&map_of(navigator)->config));
    }
}

enum jp_status jp_seen_set_cell(struct jp_navigator *navigator, int32_t x, int32_t y, enum jp_cell cell)
{
    const enum jp_cell before = jp_terrain_cell(map_of(navigator), x, y);
    const enum jp_status status = jp_planner_set_cell(navigator->config.planner, x, y, cell);

    if (status == JP_OK && navigator->config.seen != NULL) {
        const unsigned entry = entry_at(navigator, (uint32_t)x, (uint32_t)y);
        const unsigned was = entry == 0U ? (unsigned)before + 1U : entry;

        set_entry(navigator, (uint32_t)x, (uint32_t)y, was == (unsigned)cell + 1U ? 0U : was);
    }
    return status;
}

bool jp_seen_may_mislead(const struct jp_navigator *navigator)
{
    const struct jp_navigator_internal *internal = &navigator->internal;

    return navigator->config.seen != NULL && internal->has_moved && internal->forgets < FORGETS_MAX;
}

static void take_back(struct jp_navigator *navigator, uint32_t x, uint32_t y)
{
    const unsigned entry = entry_at(navigator, x, y);

    if (entry != 0U) {
        const unsigned was = entry - 1U;

        (void)jp_seen_set_cell(navigator, (int32_t)x, (int32_t)y, (enum jp_cell)was);
    }
}

void jp_seen_forget(struct jp_navigator *navigator)
{
    const struct jp_terrain_config *map = &map_of(navigator)->config;

    for (uint32_t y = map->height; y > 0U; y--) {
        for (uint32_t x = map->width; x > 0U; x--) {
            take_back(navigator, x - 1U, y - 1U);
        }
    }
    navigator->forgets++;
    navigator->internal.forgets++;
    navigator->internal.has_moved = false;
}
