#include "src/navigate/waypoint_arc.h"

#include "src/trajectory/segment_arc.h"

/** 2⁻³² turn in rad, Q60. */
#define RADIANS_Q60 ((int64_t)1686629713)

#define STEPS_A_CELL 10

/** Pose at step i of n. */
static struct jp_box pose_at(const struct jp_waypoint_arc *arc, int64_t i, int64_t n)
{
    const int32_t half_turn = (int32_t)(arc->turn * i / n / 2);
    struct jp_arc shape;

    jp_arc_at(half_turn, &shape);

    const int32_t chord = (int32_t)((arc->length * i / n * shape.sinc) >> 29);
    const jp_angle bearing = arc->heading + (jp_angle)half_turn;

    return (struct jp_box){.x = arc->x + jp_multiply_shift(chord, jp_cos(bearing), 31),
                           .y = arc->y + jp_multiply_shift(chord, jp_sin(bearing), 31),
                           .heading = bearing + (jp_angle)half_turn};
}

static int64_t steps_of(const struct jp_waypoint_footprint *footprint, const struct jp_waypoint_arc *arc)
{
    const int64_t square = (int64_t)footprint->half_length * footprint->half_length +
                           (int64_t)footprint->half_width * footprint->half_width;
    const int64_t radius = (int64_t)jp_square_root((uint64_t)square) + footprint->margin;
    const int64_t turn = arc->turn < 0 ? -arc->turn : arc->turn;
    const int64_t way = arc->length + ((radius * ((turn * RADIANS_Q60) >> 36)) >> 24);

    return (way * STEPS_A_CELL + JP_CELLS_ONE - 1) / JP_CELLS_ONE;
}

bool jp_waypoint_arc_is_clear(const struct jp_terrain *terrain, const struct jp_waypoint_footprint *footprint,
                              const struct jp_waypoint_arc *arc)
{
    const int64_t steps = steps_of(footprint, arc);
    const int64_t parts = steps > 0 ? steps : 1;

    for (int64_t i = 0; i <= steps; i++) {
        struct jp_box box = pose_at(arc, i, parts);

        box.half_length = footprint->half_length + footprint->margin;
        box.half_width = footprint->half_width + footprint->margin;
        if (!jp_box_is_clear(terrain, &box)) {
            return false;
        }
    }
    return true;
}

static jp_elevation elevation_at(const struct jp_terrain *terrain, jp_cells_q20 x, jp_cells_q20 y)
{
    return jp_terrain_elevation(terrain, x >> 20, y >> 20);
}

bool jp_waypoint_arc_slopes(const struct jp_terrain *terrain, const struct jp_slope_cost *step,
                            const struct jp_waypoint_arc *arc, int64_t *cost)
{
    const int64_t cells = (arc->length + JP_CELLS_ONE - 1) / JP_CELLS_ONE;
    const int64_t steps = terrain->config.has_elevation ? cells : 0;
    const int64_t level = jp_move_cost(step, 0);
    jp_elevation before = elevation_at(terrain, arc->x, arc->y);

    *cost = 0;
    for (int64_t i = 1; i <= steps; i++) {
        const struct jp_box pose = pose_at(arc, i, steps);
        const jp_elevation here = elevation_at(terrain, pose.x, pose.y);
        const jp_cost move = jp_move_cost(step, (int32_t)here - before);

        if (move == JP_COST_MAX) {
            return false;
        }
        *cost += (int64_t)move - level;
        before = here;
    }
    return true;
}
