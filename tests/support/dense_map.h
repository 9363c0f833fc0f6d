/** Dense maps from a seed, with obstacles that the map does not show, and a task on them. */
#ifndef JOULEPATH_TESTS_SUPPORT_DENSE_MAP_H
#define JOULEPATH_TESTS_SUPPORT_DENSE_MAP_H

#include <joulepath/planner.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/random.h"
#include "sim/skid_steer/skid_hills.h"

#define DENSE_MAP_SIDE_MAX 192

/** A map as the robot has it, and the world as it is. */
struct dense_map {
    struct jp_terrain map;
    struct jp_terrain world;
    void *blocks[2];
    struct jp_lattice_pose start;
    struct jp_goal goal;
};

static inline unsigned dense_map_draw(struct random *random, unsigned low, unsigned high)
{
    return low + (unsigned)(random_uniform(random, 0, 1) * (high - low + 1));
}

static inline void dense_map_block(struct jp_terrain *terrain, unsigned x, unsigned y, unsigned width, unsigned height)
{
    for (unsigned v = y; v < y + height; v++) {
        for (unsigned u = x; u < x + width; u++) {
            (void)jp_terrain_set_cell(terrain, (int32_t)u, (int32_t)v, JP_CELL_OCCUPIED);
        }
    }
}

static inline bool dense_map_init(struct jp_terrain *terrain, void **block, const struct jp_terrain_config *config)
{
    const char *field;
    const size_t size = jp_terrain_size(config);

    *block = aligned_alloc(8, (size + 7) / 8 * 8);
    return *block != NULL && jp_terrain_init(terrain, config, *block, size, &field) == JP_OK;
}

/** Boxes, at random, on a share of the ground. */
static inline void dense_map_fill(struct random *random, struct jp_terrain *terrain, double share)
{
    const unsigned width = terrain->config.width;
    const unsigned height = terrain->config.height;
    double covered = 0;

    for (unsigned y = 0; y < height; y++) {
        for (unsigned x = 0; x < width; x++) {
            (void)jp_terrain_set_cell(terrain, (int32_t)x, (int32_t)y,
                                      x == 0 || y == 0 || x == width - 1 || y == height - 1 ? JP_CELL_OCCUPIED
                                                                                            : JP_CELL_FREE);
        }
    }
    while (covered < share * width * height) {
        const bool is_wall = random_uniform(random, 0, 1) < 0.3;
        const unsigned a = is_wall ? dense_map_draw(random, 10, 30) : dense_map_draw(random, 1, 8);
        const unsigned b = is_wall ? 1 : dense_map_draw(random, 1, 8);
        const bool is_turned = random_uniform(random, 0, 1) < 0.5;

        dense_map_block(terrain, dense_map_draw(random, 0, width - 1), dense_map_draw(random, 0, height - 1),
                        is_turned ? b : a, is_turned ? a : b);
        covered += (double)a * b;
    }
}

/** What the map does not show: boxes, none within a metre of the start. */
static inline void dense_map_hide(struct random *random, struct dense_map *dense, unsigned count)
{
    const struct jp_terrain_config *config = &dense->map.config;
    const int away = (int)(JP_Q16(1.0) / config->resolution) + 6;

    while (count > 0) {
        const unsigned x = dense_map_draw(random, 1, config->width - 8U);
        const unsigned y = dense_map_draw(random, 1, config->height - 8U);

        if (abs((int)x - dense->start.x) > away || abs((int)y - dense->start.y) > away) {
            dense_map_block(&dense->world, x, y, dense_map_draw(random, 1, 6), dense_map_draw(random, 1, 6));
            count--;
        }
    }
}

static inline bool dense_map_place(struct random *random, const struct jp_lattice *lattice,
                                   const struct jp_terrain *terrain, struct jp_lattice_pose *pose)
{
    for (unsigned i = 0; i < 10000; i++) {
        *pose = (struct jp_lattice_pose){(int16_t)dense_map_draw(random, 0, terrain->config.width - 1U),
                                         (int16_t)dense_map_draw(random, 0, terrain->config.height - 1U),
                                         (uint8_t)dense_map_draw(random, 0, JP_HEADINGS - 1)};
        if (jp_lattice_can_stand(lattice, terrain, pose->x, pose->y, pose->heading)) {
            return true;
        }
    }
    return false;
}

/** Waves whose slopes add up to an angle up to `degrees`, evenly drawn. */
static inline void dense_map_raise(struct random *random, struct jp_terrain *terrain, double degrees)
{
    const double cell = (double)terrain->config.resolution / JP_Q16_ONE;
    const struct skid_hills hills = skid_random_hills_within(random, degrees);

    for (int32_t y = 0; y < terrain->config.height; y++) {
        for (int32_t x = 0; x < terrain->config.width; x++) {
            const struct skid_ground_point point = skid_on_hills(&hills, (x + 0.5) * cell, (y + 0.5) * cell);
            (void)jp_terrain_set_elevation(terrain, x, y, (jp_elevation)lround(point.elevation * JP_ELEVATION_ONE));
        }
    }
}

/** The map of a seed: 80 to 192 cells a side, 8 to 20 % of it blocked, 3 to 10 boxes hidden; start and goal are at
 * least a third of the side apart; `degrees` above 0: on hills up to so steep. False: no memory, or no room for the
 * robot. */
static inline bool dense_map_make(struct dense_map *dense, const struct jp_lattice *lattice, double degrees,
                                  uint64_t seed)
{
    struct random random;
    struct jp_terrain_config config = {.resolution = lattice->resolution, .has_elevation = degrees > 0};
    struct jp_lattice_pose goal;

    random_init(&random, seed);
    config.width = (uint16_t)dense_map_draw(&random, 80, DENSE_MAP_SIDE_MAX);
    config.height = (uint16_t)dense_map_draw(&random, 80, DENSE_MAP_SIDE_MAX);
    *dense = (struct dense_map){0};
    if (!dense_map_init(&dense->map, &dense->blocks[0], &config) ||
        !dense_map_init(&dense->world, &dense->blocks[1], &config)) {
        return false;
    }
    dense_map_fill(&random, &dense->map, 0.08 + 0.12 * random_uniform(&random, 0, 1));
    if (degrees > 0) {
        dense_map_raise(&random, &dense->map, degrees);
    }
    do {
        if (!dense_map_place(&random, lattice, &dense->map, &dense->start) ||
            !dense_map_place(&random, lattice, &dense->map, &goal)) {
            return false;
        }
    } while (3 * (abs(goal.x - dense->start.x) + abs(goal.y - dense->start.y)) < config.width);
    dense->goal = (struct jp_goal){goal.x, goal.y, JP_ANY_HEADING};
    memcpy(dense->blocks[1], dense->blocks[0], jp_terrain_size(&config));
    dense_map_hide(&random, dense, dense_map_draw(&random, 3, 10));
    return true;
}

static inline void dense_map_free(struct dense_map *dense)
{
    free(dense->blocks[0]);
    free(dense->blocks[1]);
}

#endif
