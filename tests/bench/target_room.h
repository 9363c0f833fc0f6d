/** The room in which benches of the patrol robot measure on targets: walls around it, a cupboard, columns, a wall with
 * a door. */
#ifndef JOULEPATH_TESTS_BENCH_TARGET_ROOM_H
#define JOULEPATH_TESTS_BENCH_TARGET_ROOM_H

#include <joulepath/terrain.h>

/* Cells of 0.05 m. */
enum { WIDTH = 200, HEIGHT = 160 };

static struct jp_terrain target_map;
static uint64_t map_block[WIDTH * HEIGHT / 8];

static inline void target_room_fill(int x0, int y0, int x1, int y1, enum jp_cell cell)
{
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            (void)jp_terrain_set_cell(&target_map, x, y, cell);
        }
    }
}

/** The wall begins at this row, south of which it leaves a way. */
static inline enum jp_status target_room_make(int wall)
{
    const struct jp_terrain_config terrain = {.width = WIDTH, .height = HEIGHT, .resolution = JP_Q16(0.05)};
    const char *field;
    const enum jp_status made = jp_terrain_init(&target_map, &terrain, map_block, sizeof map_block, &field);

    target_room_fill(0, 0, WIDTH, HEIGHT, JP_CELL_OCCUPIED);
    target_room_fill(3, 3, WIDTH - 3, HEIGHT - 3, JP_CELL_FREE);
    target_room_fill(140, 3, 165, 20, JP_CELL_OCCUPIED);
    target_room_fill(40, 100, 48, 108, JP_CELL_OCCUPIED);
    target_room_fill(70, 40, 78, 48, JP_CELL_OCCUPIED);
    target_room_fill(118, wall, 122, HEIGHT - 3, JP_CELL_OCCUPIED);
    return made;
}

#endif
