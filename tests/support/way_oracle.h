/** The fewest unit steps from every cell of a map to a goal, by a relaxation of all cells until nothing changes: an
 *  oracle of ways. */
#ifndef JOULEPATH_TESTS_SUPPORT_WAY_ORACLE_H
#define JOULEPATH_TESTS_SUPPORT_WAY_ORACLE_H

#include <joulepath/lattice_way.h>
#include <stddef.h>

#include "unity.h"

enum { WAY_ORACLE_CELLS = 800, WAY_ORACLE_FAR = 9999 };

static int16_t way_oracle_steps[WAY_ORACLE_CELLS]; /* row by row */

static inline const struct jp_primitive *way_oracle_step(const struct jp_lattice *lattice, unsigned heading)
{
    for (unsigned i = lattice->first_from[heading]; i < lattice->first_from[heading + 1U]; i++) {
        const struct jp_primitive *primitive = &lattice->primitives[i];

        if (primitive->end == heading && primitive->move_count == 1U && primitive->dx == jp_move_offsets[heading].dx &&
            primitive->dy == jp_move_offsets[heading].dy) {
            return primitive;
        }
    }
    return NULL;
}

static inline bool way_oracle_can_step(const struct jp_lattice *lattice, const struct jp_terrain *ground, int32_t x,
                                       int32_t y, unsigned heading)
{
    const struct jp_primitive *step = way_oracle_step(lattice, heading);

    return step != NULL && jp_lattice_cost(lattice, JP_COST_PHYSICAL, ground, step, x, y) != JP_COST_MAX;
}

static inline int16_t *way_oracle_at(const struct jp_terrain *ground, int32_t x, int32_t y)
{
    return &way_oracle_steps[y * ground->config.width + x];
}

/** The neighbours of a cell, which it can be driven to and from; true when one is nearer than it was. */
static inline bool way_oracle_relax(const struct jp_lattice *lattice, const struct jp_terrain *ground, int32_t x,
                                    int32_t y)
{
    const int16_t farther = (int16_t)(*way_oracle_at(ground, x, y) + 1);
    bool has_changed = false;

    for (unsigned heading = 0; heading < JP_MOVE_DIRECTIONS; heading++) {
        const int32_t u = x + jp_move_offsets[heading].dx;
        const int32_t v = y + jp_move_offsets[heading].dy;

        if (jp_terrain_contains(ground, u, v) && *way_oracle_at(ground, u, v) > farther &&
            way_oracle_can_step(lattice, ground, x, y, heading) &&
            way_oracle_can_step(lattice, ground, u, v, (heading + JP_MOVE_DIRECTIONS / 2U) % JP_MOVE_DIRECTIONS)) {
            *way_oracle_at(ground, u, v) = farther;
            has_changed = true;
        }
    }
    return has_changed;
}

static inline void way_oracle_solve(const struct jp_lattice *lattice, const struct jp_terrain *ground,
                                    const struct jp_way_cell *goal)
{
    const int32_t cells = ground->config.width * ground->config.height;
    bool has_changed = true;

    TEST_ASSERT_LESS_OR_EQUAL_INT32(WAY_ORACLE_CELLS, cells);
    for (int32_t i = 0; i < cells; i++) {
        way_oracle_steps[i] = WAY_ORACLE_FAR;
    }
    *way_oracle_at(ground, goal->x, goal->y) = 0;
    while (has_changed) {
        has_changed = false;
        for (int32_t i = 0; i < cells; i++) {
            if (way_oracle_steps[i] < WAY_ORACLE_FAR) {
                has_changed = way_oracle_relax(lattice, ground, i % ground->config.width, i / ground->config.width) ||
                              has_changed;
            }
        }
    }
}

/** Follows a way that was found; each of its steps must lead one step nearer, and the last to the goal. */
static inline void way_oracle_expect(const struct jp_terrain *ground, const struct jp_lattice_way *way,
                                     struct jp_way_cell cell)
{
    int left = *way_oracle_at(ground, cell.x, cell.y);

    while (jp_lattice_way_next(way, &cell)) {
        left--;
        TEST_ASSERT_EQUAL_INT(left, *way_oracle_at(ground, cell.x, cell.y));
    }
    TEST_ASSERT_EQUAL_INT(0, left);
}

#endif
