/**
 * Rough scenes of 60 × 60 m from a seed: hills, steep ground, rocks, walls with gaps, unknown patches, and a task.
 *
 * Integers only and no libc, so that a seed gives the same scene on a PC and on the target benches. Ground that is
 * free slopes at most 15° in every unit step of the lattice; steeper ground is occupied. Occupied and unknown cells
 * take up 8…15 % of the area. Start and goal lie 40…65 m apart on opposite sides, with 2 m of free ground around, and
 * a way at least 1.4 m wide leads from one to the other even where unknown cells may not be driven over.
 */
#ifndef JOULEPATH_TESTS_SUPPORT_SCENE_H
#define JOULEPATH_TESTS_SUPPORT_SCENE_H

#include <joulepath/terrain.h>

#define SCENE_SIDE       300         /* cells */
#define SCENE_RESOLUTION JP_Q16(0.2) /* m */

/** Bytes of the map of a scene. */
#define SCENE_TERRAIN_SIZE                                                                                             \
    (2 * SCENE_SIDE * ((SCENE_SIDE + 31) / 32) * sizeof(uint32_t) + SCENE_SIDE * SCENE_SIDE * sizeof(jp_elevation))

/** The bench drives the scenes of the seeds SCENE_BENCH_FIRST…SCENE_BENCH_FIRST + SCENE_BENCH_COUNT − 1. */
#define SCENE_BENCH_FIRST 1
#define SCENE_BENCH_COUNT 20

#define SCENE_HEADINGS 16

struct scene_pose {
    uint16_t x;      /**< cell */
    uint16_t y;      /**< cell */
    uint8_t heading; /**< 0…SCENE_HEADINGS − 1 */
};

struct scene_task {
    struct scene_pose start;
    struct scene_pose goal;
};

/** The map of every scene; the caller may let the robot drive over unknown cells. */
extern const struct jp_terrain_config scene_terrain_config;

/** Fills a map that was initialised with scene_terrain_config. Needs 25 KB of stack. Work: some ten times all cells. */
void scene_generate(uint32_t seed, struct jp_terrain *terrain, struct scene_task *task);

#endif
