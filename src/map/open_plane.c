#include "src/map/open_plane.h"

enum { WORD_BITS = 32 };

static int32_t words_of(const struct jp_terrain_config *config)
{
    return ((int32_t)config->width + WORD_BITS - 1) / WORD_BITS;
}

size_t jp_open_plane_size(const struct jp_terrain_config *config)
{
    return (size_t)words_of(config) * config->height * sizeof(uint32_t);
}

/** Those of the 32 cells of a word of a row that are on the map. */
static uint32_t on_map(const struct jp_terrain *terrain, int32_t word)
{
    const int32_t left = (int32_t)terrain->config.width - word * WORD_BITS;

    return left < WORD_BITS ? UINT32_MAX >> (WORD_BITS - left) : UINT32_MAX;
}

/** Cells that are not blocked. */
static uint32_t free_word(const struct jp_terrain *terrain, int32_t word, int32_t y)
{
    if ((uint32_t)word >= terrain->stride || (uint32_t)y >= terrain->config.height) {
        return 0;
    }
    return ~terrain->blocked[(size_t)y * terrain->stride + (size_t)word] & on_map(terrain, word);
}

static int32_t floor_word(int32_t x)
{
    return (x - (int32_t)((uint32_t)x % WORD_BITS)) / WORD_BITS;
}

/** 32 bits of two words, from bit `x` of the first on. */
static uint32_t join(uint32_t first, uint32_t second, int32_t x)
{
    const uint32_t shift = (uint32_t)x % WORD_BITS;

    return shift == 0U ? first : (first >> shift) | (second << (WORD_BITS - shift));
}

static uint32_t free_cells(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    const int32_t word = floor_word(x);

    return join(free_word(terrain, word, y), free_word(terrain, word + 1, y), x);
}

unsigned jp_open_plane_make_row(uint32_t *plane, const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                                int32_t y)
{
    const int32_t words = words_of(&terrain->config);
    unsigned looks = 0;

    for (int32_t word = 0; word < words; word++) {
        uint32_t open = on_map(terrain, word);

        for (unsigned i = 0; i < lattice->core.span_count; i++) {
            const struct jp_span *span = &lattice->spans[lattice->core.first_span + i];

            for (int32_t x = (int32_t)span->first; x <= (int32_t)span->last; x++) {
                open &= free_cells(terrain, word * WORD_BITS + x, y + span->y);
                looks++;
            }
        }
        plane[(size_t)y * (size_t)words + (size_t)word] = open;
    }
    return looks;
}

static uint32_t open_word(const uint32_t *plane, const struct jp_terrain *terrain, int32_t word, int32_t y)
{
    const int32_t words = words_of(&terrain->config);

    return (uint32_t)word < (uint32_t)words && (uint32_t)y < terrain->config.height
               ? plane[(size_t)y * (size_t)words + (size_t)word]
               : 0U;
}

uint32_t jp_open_plane_look(const uint32_t *plane, const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    const int32_t word = floor_word(x);

    return join(open_word(plane, terrain, word, y), open_word(plane, terrain, word + 1, y), x);
}
