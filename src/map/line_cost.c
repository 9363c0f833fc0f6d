#include "src/map/line_cost.h"

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/map/terrain_cells.h"

/** Of a point, in units of jp_elevation. */
static int32_t elevation_at(const struct jp_terrain *terrain, const struct jp_point *point)
{
    return jp_terrain_height(terrain, point) / (JP_Q16_ONE / JP_ELEVATION_ONE);
}

/** What the ground at a place takes more, in 1/JP_GROUND_ONE. */
static int64_t share_at(const struct jp_lattice *lattice, const struct jp_terrain *terrain, jp_q16 x, jp_q16 y)
{
    const jp_q16 cell = terrain->config.resolution;

    return lattice->ground[terrain_class(terrain, x / cell, y / cell)].straight;
}

/** From the middle of a robot that drives along the line to its left wheels, m. */
static struct jp_point side_along(const struct jp_lattice *lattice, const struct jp_point *from,
                                  const struct jp_point *to, jp_q16 length)
{
    if (length == 0) {
        return (struct jp_point){0, 0};
    }
    return (struct jp_point){(jp_q16)(-(int64_t)(to->y - from->y) * lattice->half_track / length),
                             (jp_q16)((int64_t)(to->x - from->x) * lattice->half_track / length)};
}

/** What a cell of the line takes more by the ground under the wheels of both sides, rounded down as that of a move. */
static int64_t more_at(const struct jp_lattice *lattice, const struct jp_terrain *terrain, const struct jp_point *point,
                       const struct jp_point *side, int64_t level)
{
    if (terrain->classes == NULL) {
        return 0;
    }
    return level *
           (share_at(lattice, terrain, point->x + side->x, point->y + side->y) +
            share_at(lattice, terrain, point->x - side->x, point->y - side->y)) /
           (2 * (int64_t)JP_GROUND_ONE);
}

jp_cost jp_line_cost(const struct jp_lattice *lattice, const struct jp_terrain *terrain, const struct jp_point *from,
                     const struct jp_point *to)
{
    const struct jp_slope_cost *step = &lattice->move_costs[JP_COST_PHYSICAL][JP_MOVE_AXIS];
    const jp_q16 cell = terrain->config.resolution;
    const jp_q16 length = jp_distance(from, to);
    const int32_t steps = length / cell + 1;
    const int64_t level = jp_move_cost(step, 0);
    int64_t cost = level * length / cell;
    const struct jp_point side = side_along(lattice, from, to, length);
    int64_t more = 0;
    int32_t before = elevation_at(terrain, from);

    for (int32_t i = 1; i <= steps; i++) {
        const struct jp_point point = {from->x + (int32_t)((int64_t)(to->x - from->x) * i / steps),
                                       from->y + (int32_t)((int64_t)(to->y - from->y) * i / steps)};
        const int32_t here = elevation_at(terrain, &point);
        const jp_cost move = jp_move_cost(step, here - before);

        if (move == JP_COST_MAX) {
            return JP_COST_MAX;
        }
        cost += (int64_t)move - level;
        more += more_at(lattice, terrain, &point, &side, level);
        before = here;
    }
    cost += more * length / cell / steps;
    return cost > 0 ? (jp_cost)cost : 0U;
}
