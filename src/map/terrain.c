#include <joulepath/terrain.h>
#include <string.h>

#include "src/base/block.h"
#include "src/base/config_check.h"
#include "src/map/terrain_cells.h"

enum { WORD_BITS = 32 };

#define CELLS_PER_CLASS_BYTE 4U

_Static_assert(JP_GROUND_CLASSES == 4U, "a class has two bits");

/** Steeper ground is as steep, rise over run. */
#define SLOPE_MAX JP_Q24(64)

static size_t words_per_row(const struct jp_terrain_config *config)
{
    return (config->width + (size_t)WORD_BITS - 1U) / WORD_BITS;
}

static size_t plane_words(const struct jp_terrain_config *config)
{
    return words_per_row(config) * config->height;
}

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_terrain_config, member, low, high)

static enum jp_status check(const struct jp_terrain_config *config, const char **field)
{
    static const struct jp_config_field fields[] = {
        FIELD(width, 1, JP_TERRAIN_SIDE_MAX),
        FIELD(height, 1, JP_TERRAIN_SIDE_MAX),
        FIELD(resolution, 1, INT32_MAX),
        FIELD(cost_shift, 0, JP_CELL_COST_SHIFT_MAX),
    };

    return jp_config_check(config, fields, JP_CONFIG_COUNT(fields), field);
}

static size_t elevation_bytes(const struct jp_terrain_config *config, size_t cells)
{
    return config->has_elevation ? cells * sizeof(jp_elevation) : 0U;
}

static size_t class_bytes(size_t cells)
{
    return (cells + CELLS_PER_CLASS_BYTE - 1U) / CELLS_PER_CLASS_BYTE;
}

size_t jp_terrain_size(const struct jp_terrain_config *config)
{
    const char *field;

    if (check(config, &field) != JP_OK) {
        return 0;
    }
    const size_t cells = (size_t)config->width * config->height;

    return 2U * plane_words(config) * sizeof(uint32_t) + elevation_bytes(config, cells) +
           (config->has_costs ? cells : 0U) + (config->has_classes ? class_bytes(cells) : 0U);
}

enum jp_status jp_terrain_init(struct jp_terrain *terrain, const struct jp_terrain_config *config, void *block,
                               size_t size, const char **field)
{
    if (terrain == NULL || config == NULL || block == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (check(config, field) != JP_OK) {
        return JP_ERR_CONFIG;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    if (size < jp_terrain_size(config)) {
        return JP_ERR_MEMORY;
    }
    const size_t words = plane_words(config);
    const size_t cells = (size_t)config->width * config->height;
    terrain->config = *config;
    terrain->version = 0;
    terrain->stride = (uint16_t)words_per_row(config);
    terrain->blocked = block;
    terrain->unknown = &terrain->blocked[words];
    uint8_t *rest = (uint8_t *)(void *)&terrain->unknown[words];
    terrain->elevation = config->has_elevation ? (jp_elevation *)(void *)rest : NULL;
    rest = &rest[elevation_bytes(config, cells)];
    terrain->costs = config->has_costs ? rest : NULL;
    terrain->classes = config->has_classes ? &rest[config->has_costs ? cells : 0U] : NULL;
    (void)memset(terrain->blocked, config->unknown_is_free ? 0 : 0xFF, words * sizeof(uint32_t));
    (void)memset(terrain->unknown, 0xFF, words * sizeof(uint32_t));
    if (terrain->elevation != NULL) {
        (void)memset(terrain->elevation, 0, cells * sizeof(jp_elevation));
    }
    if (terrain->costs != NULL) {
        (void)memset(terrain->costs, 0, cells);
    }
    if (terrain->classes != NULL) {
        (void)memset(terrain->classes, 0, class_bytes(cells));
    }
    return JP_OK;
}

bool jp_terrain_contains(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return terrain_contains(terrain, x, y);
}

static size_t word_of(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return (size_t)y * terrain->stride + (size_t)x / WORD_BITS;
}

static uint32_t bit_of(int32_t x)
{
    return UINT32_C(1) << ((uint32_t)x % WORD_BITS);
}

static void set_bit(uint32_t *word, uint32_t bit, bool value)
{
    *word = value ? *word | bit : *word & ~bit;
}

enum jp_status jp_terrain_set_cell(struct jp_terrain *terrain, int32_t x, int32_t y, enum jp_cell cell)
{
    if (cell != JP_CELL_FREE && cell != JP_CELL_OCCUPIED && cell != JP_CELL_UNKNOWN) {
        return JP_ERR_ARGUMENT;
    }
    if (!terrain_contains(terrain, x, y)) {
        return JP_ERR_OUTSIDE;
    }
    const size_t word = word_of(terrain, x, y);
    const bool unknown = cell == JP_CELL_UNKNOWN;
    set_bit(&terrain->blocked[word], bit_of(x),
            cell == JP_CELL_OCCUPIED || (unknown && !terrain->config.unknown_is_free));
    set_bit(&terrain->unknown[word], bit_of(x), unknown);
    terrain->version++;
    return JP_OK;
}

enum jp_status jp_terrain_set_elevation(struct jp_terrain *terrain, int32_t x, int32_t y, jp_elevation elevation)
{
    if (terrain->elevation == NULL) {
        return JP_ERR_STATE;
    }
    if (!terrain_contains(terrain, x, y)) {
        return JP_ERR_OUTSIDE;
    }
    terrain->elevation[(size_t)y * terrain->config.width + (size_t)x] = elevation;
    terrain->version++;
    return JP_OK;
}

enum jp_status jp_terrain_set_cost(struct jp_terrain *terrain, int32_t x, int32_t y, uint8_t cost)
{
    if (terrain->costs == NULL) {
        return JP_ERR_STATE;
    }
    if (!jp_terrain_contains(terrain, x, y)) {
        return JP_ERR_OUTSIDE;
    }
    terrain->costs[(size_t)y * terrain->config.width + (size_t)x] = cost;
    terrain->version++;
    return JP_OK;
}

enum jp_status jp_terrain_set_class(struct jp_terrain *terrain, int32_t x, int32_t y, uint8_t ground)
{
    if (ground >= JP_GROUND_CLASSES) {
        return JP_ERR_ARGUMENT;
    }
    if (terrain->classes == NULL) {
        return JP_ERR_STATE;
    }
    if (!terrain_contains(terrain, x, y)) {
        return JP_ERR_OUTSIDE;
    }
    const size_t cell = (size_t)y * terrain->config.width + (size_t)x;
    const unsigned shift = 2U * (unsigned)(cell % CELLS_PER_CLASS_BYTE);
    uint8_t *byte = &terrain->classes[cell / CELLS_PER_CLASS_BYTE];

    *byte = (uint8_t)((*byte & ~(3U << shift)) | ((uint32_t)ground << shift));
    terrain->version++;
    return JP_OK;
}

enum jp_cell jp_terrain_cell(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    if (!terrain_contains(terrain, x, y)) {
        return JP_CELL_OCCUPIED;
    }
    const size_t word = word_of(terrain, x, y);
    if ((terrain->unknown[word] & bit_of(x)) != 0U) {
        return JP_CELL_UNKNOWN;
    }
    return (terrain->blocked[word] & bit_of(x)) != 0U ? JP_CELL_OCCUPIED : JP_CELL_FREE;
}

jp_elevation jp_terrain_elevation(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return (jp_elevation)terrain_elevation(terrain, x, y);
}

/** Between which two middles of cells of a row or a column a place lies. */
struct between {
    int32_t low;
    int32_t share; /* of the way from the one to the next, Q16; 0 at the last */
};

static struct between middles(jp_q16 place, jp_q16 cell, int32_t count)
{
    const int64_t last = (int64_t)(count - 1) * 65536;
    const int64_t cells = (int64_t)place * 65536 / cell - 32768;
    const int64_t within = cells < 0 ? 0 : cells;
    const int32_t at = (int32_t)(within < last ? within : last);
    const int32_t low = at / 65536;

    return (struct between){low, at % 65536};
}

/** Along a row, elevation in Q16. */
static int64_t height_in_row(const struct jp_terrain *terrain, const struct between *across, int32_t y)
{
    const int64_t west = terrain_elevation(terrain, across->low, y);
    const int64_t east = terrain_elevation(terrain, across->low + 1, y);

    return west * 65536 + (east - west) * across->share;
}

jp_q16 jp_terrain_height(const struct jp_terrain *terrain, const struct jp_point *point)
{
    const struct jp_terrain_config *config = &terrain->config;
    const struct between across = middles(point->x, config->resolution, config->width);
    const struct between up = middles(point->y, config->resolution, config->height);
    const int64_t south = height_in_row(terrain, &across, up.low);
    const int64_t north = height_in_row(terrain, &across, up.low + 1);

    return (jp_q16)((south * 65536 + (north - south) * up.share) / ((int64_t)JP_ELEVATION_ONE * 65536));
}

/** Rise over run between two cells of a map, `cells` apart. */
static jp_q24 slope_between(const struct jp_terrain *terrain, int32_t low, int32_t high, int32_t cells)
{
    const int64_t rise = (int64_t)(high - low) * (JP_Q16_ONE / JP_ELEVATION_ONE);
    const int64_t run = (int64_t)cells * terrain->config.resolution;

    return cells == 0 ? 0 : jp_clamp32(jp_saturate32(rise * JP_Q24_ONE / run), -SLOPE_MAX, SLOPE_MAX);
}

static bool is_steep(const struct jp_terrain *terrain, int32_t x, int32_t y, jp_q24 steepest)
{
    const int32_t width = terrain->config.width;
    const int32_t height = terrain->config.height;
    const int32_t west = x > 0 ? x - 1 : x;
    const int32_t east = x + 1 < width ? x + 1 : x;
    const int32_t south = y > 0 ? y - 1 : y;
    const int32_t north = y + 1 < height ? y + 1 : y;
    const int64_t across =
        slope_between(terrain, terrain_elevation(terrain, west, y), terrain_elevation(terrain, east, y), east - west);
    const int64_t up = slope_between(terrain, terrain_elevation(terrain, x, south),
                                     terrain_elevation(terrain, x, north), north - south);

    return across * across + up * up > (int64_t)steepest * steepest;
}

uint32_t jp_terrain_block_steep(struct jp_terrain *terrain, jp_q24 steepest)
{
    const int32_t width = terrain->config.width;
    const int32_t height = terrain->config.height;
    uint32_t blocked = 0;

    for (int32_t y = 0; y < height; y++) {
        for (int32_t x = 0; x < width; x++) {
            if (jp_terrain_cell(terrain, x, y) == JP_CELL_FREE && is_steep(terrain, x, y, steepest)) {
                (void)jp_terrain_set_cell(terrain, x, y, JP_CELL_OCCUPIED);
                blocked++;
            }
        }
    }
    return blocked;
}

uint8_t jp_terrain_cost(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return terrain_cost(terrain, x, y);
}

uint8_t jp_terrain_class(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    return terrain_class(terrain, x, y);
}

static bool is_row_clear(const uint32_t *row, uint32_t first, uint32_t last)
{
    const uint32_t end = last / WORD_BITS;
    const uint32_t until_last = UINT32_MAX >> (WORD_BITS - 1U - last % WORD_BITS);
    uint32_t from_first = UINT32_MAX << (first % WORD_BITS);

    for (uint32_t word = first / WORD_BITS; word < end; word++) {
        if ((row[word] & from_first) != 0U) {
            return false;
        }
        from_first = UINT32_MAX;
    }
    return (row[end] & from_first & until_last) == 0U;
}

bool jp_terrain_is_clear(const struct jp_terrain *terrain, const struct jp_span *spans, size_t count, int32_t x,
                         int32_t y)
{
    for (size_t i = 0; i < count; i++) {
        const int32_t row = y + spans[i].y;
        const int32_t first = x + spans[i].first;
        const int32_t last = x + spans[i].last;

        if (!terrain_contains(terrain, first, row) || last >= (int32_t)terrain->config.width ||
            !is_row_clear(&terrain->blocked[(size_t)row * terrain->stride], (uint32_t)first, (uint32_t)last)) {
            return false;
        }
    }
    return true;
}
