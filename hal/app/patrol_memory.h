/**
 * Memory of a robot that finds its way with the patrol's planner (patrol_mission.h), as large as the build says: maps
 * of at most JP_PATROL_CELLS cells. Ten bytes a cell are the planner's, one the localiser's, two bits each the map's
 * and its copy's. It may lie in two parts of a controller's memory.
 */
#ifndef JOULEPATH_HAL_APP_PATROL_MEMORY_H
#define JOULEPATH_HAL_APP_PATROL_MEMORY_H

#include "hal/app/ecu_patrol.h"
#include "hal/app/navigation.h"

/** As many as a hall of 25 × 20 m has of 0.05 m. */
#ifndef JP_PATROL_CELLS
#define JP_PATROL_CELLS 200000
#endif

/** Side of a cell of its maps, m. */
#define JP_PATROL_RESOLUTION JP_Q16(0.05)

/** Points of a path, 0.1 m apart, and its turns. */
#define JP_PATROL_POINTS_MAX 1024U
#define JP_PATROL_TURNS_MAX  128U

/** Bytes that a map, and what is made of it, take beside its cells: rows that end within a word, and the tables of a
 *  mission. */
#define JP_PATROL_MAP_SPARE   4096
#define JP_PATROL_BLOCK_SPARE 90112

struct jp_patrol_map {
    uint64_t words[(JP_PATROL_CELLS / 4 + JP_PATROL_MAP_SPARE) / 8];
};

struct jp_patrol_block {
    uint64_t words[(JP_PATROL_CELLS / 2 * 21 + JP_PATROL_CELLS / 2 + JP_PATROL_BLOCK_SPARE) / 8];
};

/** Where its maps go. */
static inline struct jp_map_room jp_patrol_map_room(struct jp_patrol_map *map)
{
    return (struct jp_map_room){.block = map->words, .size = sizeof map->words, .resolution = JP_PATROL_RESOLUTION};
}

#endif
