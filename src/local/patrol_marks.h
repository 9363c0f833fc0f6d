/** A map with what scans have seen on it, and where the robot fits there. Private to the patrol. */
#ifndef JOULEPATH_LOCAL_PATROL_MARKS_H
#define JOULEPATH_LOCAL_PATROL_MARKS_H

#include <joulepath/obstacles.h>
#include <joulepath/terrain.h>

/** Side of a cell, m. */
float jp_patrol_cell(const struct jp_terrain *map);

/** The cell that a coordinate, m, lies in. */
int32_t jp_patrol_cell_at(const struct jp_terrain *map, float coordinate);

/** What the beams from one to before another went through from the scanner's pose is as on the given map again. Work:
 *  cells along the beams, each as far as the map is long. */
void jp_patrol_clear_ways(const struct jp_terrain *given, struct jp_terrain *marked, const struct jp_scan *scan,
                          const struct jp_plane_pose *scanner, uint16_t first, uint16_t end);

/** Then, marks what the scan saw at the ends of all beams; one within the tolerance of their error, m, but no more than
 * a cell, from what stands on the given map is that. Work: a few cells at each end. */
void jp_patrol_mark_ends(const struct jp_terrain *given, struct jp_terrain *marked, const struct jp_scan *scan,
                         const struct jp_plane_pose *scanner, float tolerance);

/** Whether the footprint with a margin, m, is free at a pose. Work: the cells under it. */
bool jp_patrol_fits(const struct jp_terrain *map, const struct jp_footprint *footprint,
                    const struct jp_plane_pose *pose, float margin);

#endif
