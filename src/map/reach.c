#include <joulepath/reach.h>

#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"

#define WORD_BITS 32U

static uint32_t words_for(const struct jp_terrain_config *config)
{
    return ((uint32_t)config->width * config->height + WORD_BITS - 1U) / WORD_BITS;
}

size_t jp_reach_size(const struct jp_terrain_config *config)
{
    return jp_terrain_size(config) == 0U ? 0U : 2U * sizeof(uint32_t) * words_for(config);
}

static uint32_t cell_at(const struct jp_reach *reach, int32_t x, int32_t y)
{
    return (uint32_t)y * reach->terrain->config.width + (uint32_t)x;
}

static void mark(uint32_t *bits, uint32_t cell)
{
    bits[cell / WORD_BITS] |= UINT32_C(1) << (cell % WORD_BITS);
}

static bool is_marked(const uint32_t *bits, uint32_t cell)
{
    return ((bits[cell / WORD_BITS] >> (cell % WORD_BITS)) & 1U) != 0U;
}

static void reach_cell(struct jp_reach *reach, uint32_t cell)
{
    mark(reach->reached, cell);
    reach->has_news = true;
    if (cell == reach->target) {
        reach->answer = JP_REACH_CONNECTED;
    }
}

enum jp_status jp_reach_start(struct jp_reach *reach, const struct jp_lattice *lattice,
                              const struct jp_terrain *terrain, int32_t x, int32_t y, int32_t target_x,
                              int32_t target_y, void *block, size_t size)
{
    if (reach == NULL || lattice == NULL || terrain == NULL || block == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (size < jp_reach_size(&terrain->config)) {
        return JP_ERR_MEMORY;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    if (!jp_terrain_contains(terrain, x, y) || !jp_terrain_contains(terrain, target_x, target_y)) {
        return JP_ERR_OUTSIDE;
    }
    *reach = (struct jp_reach){.lattice = lattice,
                               .terrain = terrain,
                               .reached = block,
                               .done = (uint32_t *)block + words_for(&terrain->config),
                               .words = words_for(&terrain->config)};
    (void)memset(block, 0, jp_reach_size(&terrain->config));
    reach->target = cell_at(reach, target_x, target_y);
    reach_cell(reach, cell_at(reach, x, y));
    return JP_OK;
}

/** To the cells to which a primitive may lead from one. */
static void spread(struct jp_reach *reach, uint32_t cell)
{
    const uint32_t x = cell % reach->terrain->config.width;
    const uint32_t y = cell / reach->terrain->config.width;

    mark(reach->done, cell);
    for (unsigned i = 0; i < JP_MOVE_DIRECTIONS; i++) {
        const int32_t u = (int32_t)x + jp_move_offsets[i].dx;
        const int32_t v = (int32_t)y + jp_move_offsets[i].dy;

        if (jp_terrain_contains(reach->terrain, u, v) && !is_marked(reach->reached, cell_at(reach, u, v)) &&
            jp_lattice_is_open(reach->lattice, reach->terrain, u, v)) {
            reach_cell(reach, cell_at(reach, u, v));
        }
    }
}

/** The next word; after the last the first, unless nothing was found since. */
static void advance(struct jp_reach *reach)
{
    reach->cursor++;
    if (reach->cursor == reach->words) {
        reach->cursor = 0;
        reach->answer = reach->has_news ? JP_REACH_WORKING : JP_REACH_NONE;
        reach->has_news = false;
    }
}

enum jp_reach_answer jp_reach_work(struct jp_reach *reach, unsigned cells)
{
    for (unsigned i = 0; i < cells && reach->answer == JP_REACH_WORKING; i++) {
        const uint32_t open = reach->reached[reach->cursor] & ~reach->done[reach->cursor];

        if (open != 0U) {
            spread(reach, reach->cursor * WORD_BITS + JP_TRAILING_ZEROS(open));
        } else {
            advance(reach);
        }
    }
    return reach->answer;
}
