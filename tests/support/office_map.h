/** An office for property tests of laser, scan matching and world: a corridor, rooms with doorways, desks. */
#ifndef JOULEPATH_TESTS_SUPPORT_OFFICE_MAP_H
#define JOULEPATH_TESTS_SUPPORT_OFFICE_MAP_H

#include <joulepath/terrain.h>

#include "sim/base/random.h"

#define OFFICE_CELL   0.05 /* m */
#define OFFICE_WIDTH  480  /* cells */
#define OFFICE_HEIGHT 280
#define OFFICE_ROOM   120 /* width of a room, cells */
#define OFFICE_DOOR   24  /* cells */
#define OFFICE_LOW    120 /* the corridor's walls, cells from the south */
#define OFFICE_HIGH   160
#define OFFICE_PLANES (2 * OFFICE_HEIGHT * ((OFFICE_WIDTH + 31) / 32))

struct office {
    struct jp_terrain terrain;
    _Alignas(8) uint32_t block[OFFICE_PLANES];
};

/** Fills the cells x0…x1, y0…y1. */
static inline void office_fill(struct office *office, int x0, int y0, int x1, int y1, enum jp_cell cell)
{
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            (void)jp_terrain_set_cell(&office->terrain, x, y, cell);
        }
    }
}

/** Free ground alone. False: the map's memory is too small. */
static inline bool office_empty(struct office *office)
{
    static const struct jp_terrain_config config = {
        .width = OFFICE_WIDTH, .height = OFFICE_HEIGHT, .resolution = JP_Q16(OFFICE_CELL)};
    const char *field;

    if (jp_terrain_init(&office->terrain, &config, office->block, sizeof office->block, &field) != JP_OK) {
        return false;
    }
    office_fill(office, 0, 0, OFFICE_WIDTH - 1, OFFICE_HEIGHT - 1, JP_CELL_FREE);
    return true;
}

/** Desks away from the rooms' middle, where the doorways are. */
static inline void office_desks(struct office *office, struct random *random, int left, int low)
{
    for (int side = 0; side < 2; side++) {
        const int x = left + (side == 0 ? 6 : 80) + (int)random_uniform(random, 0, 8);
        const int y = low + 20 + (int)random_uniform(random, 0, 50);
        office_fill(office, x, y, x + 20 + (int)random_uniform(random, 0, 8),
                    y + 12 + (int)random_uniform(random, 0, 20), JP_CELL_OCCUPIED);
    }
}

/** Four rooms on either side of the corridor, each with a doorway in its middle. False as office_empty(). */
static inline bool office_make(struct office *office, struct random *random)
{
    if (!office_empty(office)) {
        return false;
    }
    office_fill(office, 0, 0, OFFICE_WIDTH - 1, 1, JP_CELL_OCCUPIED);
    office_fill(office, 0, OFFICE_HEIGHT - 2, OFFICE_WIDTH - 1, OFFICE_HEIGHT - 1, JP_CELL_OCCUPIED);
    office_fill(office, 0, 0, 1, OFFICE_HEIGHT - 1, JP_CELL_OCCUPIED);
    office_fill(office, OFFICE_WIDTH - 2, 0, OFFICE_WIDTH - 1, OFFICE_HEIGHT - 1, JP_CELL_OCCUPIED);
    office_fill(office, 0, OFFICE_LOW - 2, OFFICE_WIDTH - 1, OFFICE_LOW - 1, JP_CELL_OCCUPIED);
    office_fill(office, 0, OFFICE_HIGH, OFFICE_WIDTH - 1, OFFICE_HIGH + 1, JP_CELL_OCCUPIED);
    for (int left = 0; left < OFFICE_WIDTH; left += OFFICE_ROOM) {
        const int door = left + OFFICE_ROOM / 2 - OFFICE_DOOR / 2;
        office_fill(office, left, 0, left + 1, OFFICE_LOW - 1, JP_CELL_OCCUPIED);
        office_fill(office, left, OFFICE_HIGH, left + 1, OFFICE_HEIGHT - 1, JP_CELL_OCCUPIED);
        office_fill(office, door, OFFICE_LOW - 2, door + OFFICE_DOOR, OFFICE_LOW - 1, JP_CELL_FREE);
        office_fill(office, door, OFFICE_HIGH, door + OFFICE_DOOR, OFFICE_HIGH + 1, JP_CELL_FREE);
        office_desks(office, random, left, 0);
        office_desks(office, random, left, OFFICE_HIGH + 2);
    }
    return true;
}

#endif
