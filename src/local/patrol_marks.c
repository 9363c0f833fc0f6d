#include "src/local/patrol_marks.h"

#include "src/base/plane.h"
#include "src/map/clearance.h"

/* Beyond this many cells nothing is on a map, nor on one that a path is planned on. */
#define MAP_MAX   ((float)JP_TERRAIN_SIDE_MAX + 2.0f)
#define CELLS_MAX 1100.0f

float jp_patrol_cell(const struct jp_terrain *map)
{
    return (float)map->config.resolution / (float)JP_Q16_ONE;
}

static float cells_of(const struct jp_terrain *map, float length, float most)
{
    return jp_plane_clamp(length / jp_patrol_cell(map), -most, most);
}

int32_t jp_patrol_cell_at(const struct jp_terrain *map, float coordinate)
{
    const float cells = cells_of(map, coordinate, MAP_MAX);
    const int32_t whole = (int32_t)cells;

    return (float)whole > cells ? whole - 1 : whole;
}

/* A beam that hit something. */
struct beam {
    struct jp_plane_point origin;
    struct jp_plane_point direction;
    float range;
};

static bool find_beam(const struct jp_scan *scan, const struct jp_plane_pose *scanner, uint16_t index,
                      struct beam *beam)
{
    const float bearing = scan->first_angle + (float)index * scan->angle_step;

    beam->origin = (struct jp_plane_point){scanner->x, scanner->y};
    beam->direction = jp_plane_direction(scanner->heading + bearing);
    beam->range = scan->ranges[index];
    return beam->range > 0.0f && jp_plane_is_finite(beam->range);
}

static void find_cell(const struct jp_terrain *map, const struct beam *beam, float along, int32_t *x, int32_t *y)
{
    *x = jp_patrol_cell_at(map, beam->origin.x + along * beam->direction.x);
    *y = jp_patrol_cell_at(map, beam->origin.y + along * beam->direction.y);
}

/* Longest distance on the map, m: a beam is followed no farther. */
static float reach_of(const struct jp_terrain *map)
{
    return jp_patrol_cell(map) * (float)(map->config.width + map->config.height);
}

static int32_t steps_of(float length)
{
    const int32_t whole = (int32_t)length;

    return (float)whole < length ? whole + 1 : whole;
}

/* Up to where its end may be. */
static void clear_along(const struct jp_terrain *given, struct jp_terrain *marked, const struct beam *beam,
                        float tolerance)
{
    const float side = jp_patrol_cell(given);
    const float range = jp_plane_clamp(beam->range, 0.0f, reach_of(given));
    const int32_t steps = steps_of((range - tolerance) / (0.5f * side));

    for (int32_t i = 0; i < steps; i++) {
        int32_t x;
        int32_t y;

        find_cell(given, beam, 0.5f * side * (float)i, &x, &y);
        (void)jp_terrain_set_cell(marked, x, y, jp_terrain_cell(given, x, y));
    }
}

/* Whether anything stands on the map in the square of twice the reach around a point. */
static bool is_beside(const struct jp_terrain *map, struct jp_plane_point point, float reach)
{
    const int32_t right = jp_patrol_cell_at(map, point.x + reach);
    const int32_t top = jp_patrol_cell_at(map, point.y + reach);

    for (int32_t y = jp_patrol_cell_at(map, point.y - reach); y <= top; y++) {
        for (int32_t x = jp_patrol_cell_at(map, point.x - reach); x <= right; x++) {
            if (jp_terrain_cell(map, x, y) == JP_CELL_OCCUPIED) {
                return true;
            }
        }
    }
    return false;
}

static struct jp_plane_point point_at(const struct beam *beam, float range)
{
    return (struct jp_plane_point){beam->origin.x + range * beam->direction.x,
                                   beam->origin.y + range * beam->direction.y};
}

/* A thing is behind its face: where this is the border of a cell, noise must not put it into the free one before it. */
static void mark_end(const struct jp_terrain *given, struct jp_terrain *marked, const struct beam *beam,
                     float tolerance)
{
    const float reach = jp_plane_smaller(tolerance, jp_patrol_cell(given));

    if (!is_beside(given, point_at(beam, beam->range), reach)) {
        const struct jp_plane_point behind = point_at(beam, beam->range + reach);

        (void)jp_terrain_set_cell(marked, jp_patrol_cell_at(given, behind.x), jp_patrol_cell_at(given, behind.y),
                                  JP_CELL_OCCUPIED);
    }
}

void jp_patrol_clear_ways(const struct jp_terrain *given, struct jp_terrain *marked, const struct jp_scan *scan,
                          const struct jp_plane_pose *scanner, float tolerance, uint16_t first, uint16_t end)
{
    struct beam beam;

    for (uint16_t i = first; i < end; i++) {
        if (find_beam(scan, scanner, i, &beam)) {
            clear_along(given, marked, &beam, tolerance);
        }
    }
}

void jp_patrol_mark_ends(const struct jp_terrain *given, struct jp_terrain *marked, const struct jp_scan *scan,
                         const struct jp_plane_pose *scanner, float tolerance)
{
    struct beam beam;

    for (uint16_t i = 0; i < scan->count; i++) {
        if (find_beam(scan, scanner, i, &beam)) {
            mark_end(given, marked, &beam, tolerance);
        }
    }
}

static jp_cells_q20 to_q20(const struct jp_terrain *map, float length)
{
    return (jp_cells_q20)(cells_of(map, length, CELLS_MAX) * (float)JP_CELLS_ONE);
}

bool jp_patrol_fits(const struct jp_terrain *map, const struct jp_footprint *footprint,
                    const struct jp_plane_pose *pose, float margin)
{
    const struct jp_plane_pose ahead = {0.5f * (footprint->front - footprint->rear), 0.0f, 0.0f};
    const struct jp_plane_pose centre = jp_plane_compose(pose, &ahead);
    const struct jp_box box = {.x = to_q20(map, centre.x),
                               .y = to_q20(map, centre.y),
                               .heading = jp_plane_angle(centre.heading),
                               .half_length = to_q20(map, 0.5f * (footprint->front + footprint->rear) + margin),
                               .half_width = to_q20(map, footprint->half_width + margin)};

    return jp_box_is_clear(map, &box);
}
