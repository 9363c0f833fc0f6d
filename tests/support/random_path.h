/** Random paths: primitives of a lattice one after the other, as plans are made of, on a map with slopes or hills. */
#ifndef JOULEPATH_TESTS_SUPPORT_RANDOM_PATH_H
#define JOULEPATH_TESTS_SUPPORT_RANDOM_PATH_H

#include <joulepath/lattice_path.h>
#include <math.h>

#include "sim/base/random.h"
#include "unity.h"

enum {
    RANDOM_PATH_SIDE = 400, /* cells of the map */
    RANDOM_PATH_PIECES = 128,
    RANDOM_PATH_STEPS_MAX = 96
};

struct random_path {
    struct jp_lattice_path path;
    struct jp_path_piece pieces[RANDOM_PATH_PIECES];
    const struct jp_primitive *steps[RANDOM_PATH_STEPS_MAX];
    struct jp_lattice_pose from[RANDOM_PATH_STEPS_MAX];
    unsigned step_count;
};

static uint64_t random_path_block[RANDOM_PATH_SIDE * RANDOM_PATH_SIDE / 2];

/** A plane that rises along x and y, rise over run, about level in its middle. */
static inline void random_path_slope(struct jp_terrain *terrain, double cell, double slope_x, double slope_y)
{
    const struct jp_terrain_config config = {
        .width = RANDOM_PATH_SIDE,
        .height = RANDOM_PATH_SIDE,
        .resolution = (jp_q16)lrint(cell * 65536),
        .has_elevation = true,
    };
    const char *field = "";

    TEST_ASSERT_EQUAL_INT(JP_OK,
                          jp_terrain_init(terrain, &config, random_path_block, sizeof random_path_block, &field));
    for (int32_t y = 0; y < RANDOM_PATH_SIDE; y++) {
        for (int32_t x = 0; x < RANDOM_PATH_SIDE; x++) {
            const double metres = cell * (slope_x * (x - RANDOM_PATH_SIDE / 2) + slope_y * (y - RANDOM_PATH_SIDE / 2));

            (void)jp_terrain_set_elevation(terrain, x, y, (jp_elevation)lrint(metres * JP_ELEVATION_ONE));
        }
    }
}

static inline bool random_path_is_inside(const struct jp_lattice_pose *pose)
{
    enum { MARGIN = 20 };

    return pose->x >= MARGIN && pose->y >= MARGIN && pose->x < RANDOM_PATH_SIDE - MARGIN &&
           pose->y < RANDOM_PATH_SIDE - MARGIN;
}

/** Any primitive of the heading; every other time one that goes straight, as most of a plan does. */
static inline const struct jp_primitive *random_primitive(struct random *random, const struct jp_lattice *lattice,
                                                          unsigned heading)
{
    const unsigned first = lattice->first_from[heading];
    const unsigned count = lattice->first_from[heading + 1U] - first;

    for (;;) {
        const unsigned index = (unsigned)random_uniform(random, 0, count);
        const struct jp_primitive *primitive = &lattice->primitives[first + (index < count ? index : 0)];
        const bool is_straight = primitive->move_count == 1 && primitive->start == primitive->end;

        if (is_straight || random_uniform(random, 0, 1) < 0.3) {
            return primitive;
        }
    }
}

/** A walk of `steps` primitives from the middle of the map, or fewer where it comes to its border. */
static inline void random_path_walk(struct random_path *walk, struct random *random, const struct jp_lattice *lattice,
                                    const struct jp_terrain *terrain, unsigned steps)
{
    struct jp_lattice_pose pose = {RANDOM_PATH_SIDE / 2, RANDOM_PATH_SIDE / 2,
                                   (uint8_t)random_uniform(random, 0, JP_HEADINGS)};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_start(&walk->path, walk->pieces, RANDOM_PATH_PIECES));
    for (walk->step_count = 0; walk->step_count < steps && random_path_is_inside(&pose); walk->step_count++) {
        const struct jp_primitive *primitive = random_primitive(random, lattice, pose.heading);

        TEST_ASSERT_EQUAL_INT(JP_OK, jp_lattice_path_add(&walk->path, lattice, terrain, &pose, primitive));
        walk->steps[walk->step_count] = primitive;
        walk->from[walk->step_count] = pose;
        pose.x = (int16_t)(pose.x + primitive->dx);
        pose.y = (int16_t)(pose.y + primitive->dy);
        pose.heading = primitive->end;
    }
}

#endif
