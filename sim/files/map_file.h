/** Maps from the JSON files that tools/design/import_map.py writes; its help describes them. */
#ifndef JOULEPATH_SIM_FILES_MAP_FILE_H
#define JOULEPATH_SIM_FILES_MAP_FILE_H

#include <joulepath/terrain.h>

#define MAP_FILE_NAME_SIZE 64
#define MAP_FILE_NOTE_SIZE 512

/** What the ground of a class is like in the simulator, against that of the robot file. */
struct map_ground {
    char name[MAP_FILE_NAME_SIZE]; /**< may be empty */
    double rolling;                /**< resistance, times as much; 1/16…16 */
    double friction;               /**< times as much; 1/16…1 */
};

struct map_file {
    struct jp_terrain terrain;
    void *block; /**< of the terrain */
    char name[MAP_FILE_NAME_SIZE];
    char note[MAP_FILE_NOTE_SIZE];                /**< where it comes from; may be empty */
    double origin[3];                             /**< south-west corner: x, y, m, and yaw, rad */
    struct map_ground grounds[JP_GROUND_CLASSES]; /**< alike where the file does not say */
};

/** Loads a map; the robot may not drive over its unknown cells. False after one line on stderr: file, what, what to do;
 *  then there is nothing to free. */
bool map_file_load(const char *path, struct map_file *map);

void map_file_free(struct map_file *map);

#endif
