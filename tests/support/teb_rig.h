/** A band with its task, path and obstacles for the tests of the TEB. */
#ifndef JOULEPATH_TESTS_SUPPORT_TEB_RIG_H
#define JOULEPATH_TESTS_SUPPORT_TEB_RIG_H

#include <joulepath/teb.h>
#include <string.h>

#include "src/base/plane.h"
#include "tests/support/band_rig.h"
#include "tests/support/near.h"
#include "tests/target/random.h"

enum { RIG_PATH_MAX = 32 };

static struct jp_teb teb;
static struct jp_obstacles obstacles;
static struct jp_point path[RIG_PATH_MAX];
static struct jp_teb_task task;
static uint32_t random_state;

static inline void rig_init(const struct jp_teb_config *config)
{
    const char *field = NULL;

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_teb_init(&teb, config, &field));
}

/** From point to point; start and goal at its ends, along the first and the last chord. */
static inline void rig_path(const struct jp_plane_point *points, unsigned count)
{
    const struct jp_plane_point *const last = &points[count - 1U];

    for (unsigned i = 0; i < count; i++) {
        path[i] = rig_path_point(points[i].x, points[i].y);
    }
    task = (struct jp_teb_task){
        .start = {points[0].x, points[0].y, jp_plane_bearing(points[1].x - points[0].x, points[1].y - points[0].y)},
        .goal = {last->x, last->y, jp_plane_bearing(last->x - last[-1].x, last->y - last[-1].y)},
        .path = path,
        .path_count = (uint16_t)count,
    };
}

static inline void rig_straight(float length)
{
    const struct jp_plane_point points[] = {{0.0f, 0.0f}, {length, 0.0f}};

    rig_path(points, 2);
}

/** Settings of rig_band(), a straight way of 5 m and no obstacles. */
static inline void rig_reset(void)
{
    const struct jp_teb_config config = rig_band();
    const struct jp_plane_point centre = {0.0f, 0.0f};

    random_state = 1;
    rig_init(&config);
    rig_straight(5.0f);
    jp_obstacles_clear(&obstacles, &centre);
}

static inline void rig_disc(float x, float y, float radius)
{
    const struct jp_obstacle disc = {.vertices = {{x, y}}, .vertex_count = 1, .radius = radius};

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &disc));
}

static inline void rig_box(float left, float bottom, float right, float top)
{
    const struct jp_obstacle box = {
        .vertices = {{left, bottom}, {right, bottom}, {right, top}, {left, top}},
        .vertex_count = 4,
    };

    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add(&obstacles, &box));
}

/** Evenly within −most…most. */
static inline float rig_random(float most)
{
    return most * ((float)(int32_t)target_random(&random_state) * 0x1p-31f);
}

#endif
