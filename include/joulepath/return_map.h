/**
 * Return map: for every cell of a map the least cost of driving there from a pose, and from there home.
 *
 * Out and back are two fields (pose_field.h), as what rises on the way out falls on the way back; where they meet the
 * robot turns round, which is charged, too. With what a way of a cost takes (jp_home_expect()) and what is left in the
 * battery it says which cells can be reached and returned from: those up to the cost of jp_home_farthest().
 *
 * It grows in slices. Memory: twice that of a pose field, 9 MiB for 300 × 300 cells. Nothing here is for ISRs.
 */
#ifndef JOULEPATH_RETURN_MAP_H
#define JOULEPATH_RETURN_MAP_H

#include <joulepath/pose_field.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The members are private. */
struct jp_return_map {
    struct jp_pose_field out;
    struct jp_pose_field back;
};

/** Bytes for a map; 0 when its configuration is out of range. Constant time. */
size_t jp_return_map_size(const struct jp_terrain_config *config);

/** Binds it to a lattice, whose physical costs count, a map and `size` bytes of the caller. Failures as
 *  jp_pose_field_init(). Constant time. */
enum jp_status jp_return_map_init(struct jp_return_map *map, const struct jp_lattice *lattice,
                                  const struct jp_terrain *terrain, void *block, size_t size);

/** Starts anew: from a pose to everywhere and home to cell (x, y), each up to costs of `limit`. Failures as
 *  jp_pose_field_start(); JP_ERR_ARGUMENT also: no such heading. Work: that of two of it. */
enum jp_status jp_return_map_start(struct jp_return_map *map, const struct jp_lattice_pose *from, int32_t x, int32_t y,
                                   jp_cost limit);

/** Continues over at most so many poses. True when done. */
bool jp_return_map_work(struct jp_return_map *map, unsigned poses);

/** Least cost to a cell and home; JP_COST_MAX where either cannot be had up to the limit, and until
 *  jp_return_map_work() has returned true. JP_HEADINGS looks at each field. */
jp_cost jp_return_map_cost(const struct jp_return_map *map, int32_t x, int32_t y);

#ifdef __cplusplus
}
#endif

#endif
