#include "src/map/barred_steps.h"

#include <string.h>

#include "src/base/compiler.h"
#include "src/map/terrain_cells.h"

#define WORD_BITS 32U

static uint32_t words_of(const struct jp_terrain *terrain)
{
    return (terrain->config.width + WORD_BITS - 1U) / WORD_BITS;
}

/** Of a row of the map 32 cells: what is blocked. Beyond its sides all is. */
static uint32_t blocked_word(const struct jp_terrain *terrain, int32_t row, int32_t word)
{
    const int32_t over = (word + 1) * (int32_t)WORD_BITS - (int32_t)terrain->config.width;

    if (word < 0 || over >= (int32_t)WORD_BITS) {
        return UINT32_MAX;
    }
    return terrain->blocked[(size_t)row * terrain->stride + (size_t)word] |
           (over > 0 ? ~(UINT32_MAX >> (uint32_t)over) : 0U);
}

/** Of 32 cells, before 32 others, those from which on one of so many, up to 32, is blocked. */
static uint32_t blocked_within(uint32_t cells, uint32_t next, uint32_t count)
{
    uint32_t any = cells;
    uint32_t any_next = next;

    for (uint32_t joined = 1; joined < count && (any | any_next) != 0U;) {
        const uint32_t more = joined < count - joined ? joined : count - joined;

        any |= any >> more | any_next << (WORD_BITS - more);
        any_next |= any_next >> more;
        joined += more;
    }
    return any;
}

/** Of a row of cells those from which a run of cells, up to 32 from (dx, 0) on, is blocked. */
static void bar_by_run(const struct jp_terrain *terrain, int32_t y, int32_t dx, uint32_t count, uint32_t *barred)
{
    const uint32_t bit = (uint32_t)dx % WORD_BITS;
    const int32_t first = (dx - (int32_t)bit) / (int32_t)WORD_BITS;
    uint32_t cells = blocked_word(terrain, y, first + 1);
    uint32_t near = blocked_within(blocked_word(terrain, y, first), cells, count);

    for (uint32_t i = 0; i < words_of(terrain); i++) {
        const uint32_t next = blocked_word(terrain, y, first + (int32_t)i + 2);
        const uint32_t far = blocked_within(cells, next, count);

        barred[i] |= (uint32_t)(((uint64_t)far << WORD_BITS | near) >> bit);
        near = far;
        cells = next;
    }
}

/** Of a row of cells those from which, moved by (dx, dy), a span is blocked. */
static void bar_by_span(const struct jp_terrain *terrain, const struct jp_span *span, struct jp_cell_offset moved,
                        int32_t y, uint32_t *barred)
{
    const int32_t row = y + moved.dy + span->y;

    if (!terrain_contains(terrain, 0, row)) {
        (void)memset(barred, 0xFF, words_of(terrain) * sizeof *barred);
        return;
    }
    for (int32_t done = 0; done <= span->last - span->first; done += (int32_t)WORD_BITS) {
        const int32_t left = span->last - span->first - done + 1;

        bar_by_run(terrain, row, moved.dx + span->first + done, left < (int32_t)WORD_BITS ? (uint32_t)left : WORD_BITS,
                   barred);
    }
}

/** Sets bits at those cells of a row on the map. */
static void set_bits(const struct jp_terrain *terrain, const uint32_t *cells, uint16_t bits, uint16_t *row)
{
    const uint32_t width = terrain->config.width;

    for (uint32_t x = 0; x < width; x += WORD_BITS) {
        const uint32_t on_map = width - x < WORD_BITS ? ~(UINT32_MAX << (width - x)) : UINT32_MAX;

        for (uint32_t rest = cells[x / WORD_BITS] & on_map; rest != 0U; rest &= rest - 1U) {
            row[x + JP_TRAILING_ZEROS(rest)] |= bits;
        }
    }
}

void jp_barred_steps(const struct jp_lattice *lattice, const struct jp_terrain *terrain,
                     const struct jp_pose_step *step, int32_t y, uint16_t bits, uint16_t *row)
{
    const struct jp_primitive *primitive = step->primitive;
    uint32_t barred[JP_TERRAIN_SIDE_MAX / WORD_BITS];

    (void)memset(barred, primitive == NULL ? 0xFF : 0, words_of(terrain) * sizeof barred[0]);
    for (unsigned i = 0; primitive != NULL && i < primitive->span_count; i++) {
        bar_by_span(terrain, &lattice->spans[primitive->first_span + i], step->begin, y, barred);
    }
    set_bits(terrain, barred, bits, row);
}
