/** Distances from the walls of a map. Private to the localiser. */
#ifndef JOULEPATH_LOCAL_WALL_FIELD_H
#define JOULEPATH_LOCAL_WALL_FIELD_H

#include <joulepath/localiser.h>

/** Distances are held up to so many cells. */
#define JP_WALL_FIELD_REACH 15.8f

/** What the field says at a point. */
struct jp_wall_distance {
    float distance;                 /**< from the nearest edge of a wall, m; below 0 inside */
    struct jp_plane_point gradient; /**< of the distance: away from the wall, of length 1 or less */
};

/** Fills the field from the occupied cells of a map; everything off the map is a wall. `column`: a byte a row. */
void jp_wall_field_make(struct jp_wall_field *field, const struct jp_terrain *map, int8_t *column);

/** Between the middles of four cells; false where no edge of a wall is within reach, and off the map. */
bool jp_wall_field_find(const struct jp_wall_field *field, struct jp_plane_point point,
                        struct jp_wall_distance *distance);

/** Of the cell around a point, m, without sign; the reach or more: unknown. */
float jp_wall_field_near(const struct jp_wall_field *field, struct jp_plane_point point);

/** From a point in a direction to the first wall, m; `range_max` if there is none before. Work: two steps a cell at
 *  most. */
float jp_wall_field_ray(const struct jp_wall_field *field, struct jp_plane_point from, struct jp_plane_point along,
                        float range_max);

#endif
