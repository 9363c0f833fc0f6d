/** Discs and walls that a synthetic scanner sees, and the tracks of what moves among them. */
#ifndef JOULEPATH_TESTS_SUPPORT_MOVERS_RIG_H
#define JOULEPATH_TESTS_SUPPORT_MOVERS_RIG_H

#include <joulepath/movers.h>

#include "src/base/plane.h"

#include "tests/support/near.h"

#define PERIOD 0.1f /* s */
#define RADIUS 0.25f

/* How well a disc within 4 m is tracked. Beams miss its rims, so the middle of what is seen lies in front of its own.
 */
#define PLACE_ERROR 0.12f /* m */
#define SPEED_ERROR 0.25f /* m/s */

enum {
    BEAMS = 720,
    DISCS_MAX = JP_MOVERS_MAX + 2,
    WALLS_MAX = 5,
    SETTLED = 25,
    NOTICED = 5, /* scans in which it is known that somebody walks at 1 m/s */
    SIGHTINGS_MIN = 4,
    MISSES_MAX = 5,
    WALKER_MISSES_MAX = 24
};

/* Misses that one counts as where the beams look through the place. */
#define GONE 3U

struct disc {
    struct jp_plane_point centre;
    float radius;
};

struct wall {
    struct jp_plane_point from;
    struct jp_plane_point to;
};

static const struct jp_plane_pose origin = {0.0f, 0.0f, 0.0f};

static float ranges[BEAMS];
static struct jp_scan scan;
static struct jp_scan_config scan_config;
static struct jp_movers_config config;
static struct jp_movers movers;
static struct jp_obstacles obstacles;
static struct jp_plane_pose sensor;
static struct disc discs[DISCS_MAX];
static unsigned disc_count;
static struct wall walls[WALLS_MAX];
static unsigned wall_count;

/* A whole turn around a sensor on an empty plane; the scan begins and ends behind it. */
static inline void movers_rig_start(void)
{
    scan = (struct jp_scan){ranges, BEAMS, -JP_PLANE_PI, 2.0f * JP_PLANE_PI / BEAMS};
    scan_config = (struct jp_scan_config){.range_max = 10.0f, .gap = 0.3f, .tolerance = 0.04f, .beams_min = 3};
    config = (struct jp_movers_config){
        .extent = 0.9f, .range = 10.0f, .speed_min = 0.3f, .speed_max = 2.0f, .margin = 0.35f};
    sensor = origin;
    disc_count = 0;
    wall_count = 0;
    jp_movers_clear(&movers);
}

/* ---- The scanner ---- */

static inline struct disc *put_disc(float x, float y, float radius)
{
    discs[disc_count] = (struct disc){{x, y}, radius};
    disc_count++;
    return &discs[disc_count - 1U];
}

static inline void put_wall(float x1, float y1, float x2, float y2)
{
    walls[wall_count] = (struct wall){{x1, y1}, {x2, y2}};
    wall_count++;
}

static inline void put_box(float left, float low, float right, float high)
{
    put_wall(left, low, right, low);
    put_wall(right, low, right, high);
    put_wall(right, high, left, high);
    put_wall(left, high, left, low);
}

/* 0: beside it. */
static inline float range_of_wall(const struct wall *wall, struct jp_plane_point beam)
{
    const struct jp_plane_point from = {wall->from.x - sensor.x, wall->from.y - sensor.y};
    const struct jp_plane_point along = {wall->to.x - wall->from.x, wall->to.y - wall->from.y};
    const float across = beam.x * along.y - beam.y * along.x;
    const float range = (from.x * along.y - from.y * along.x) / across;
    const float share = (from.x * beam.y - from.y * beam.x) / across;

    return range > 0.0f && share >= 0.0f && share <= 1.0f ? range : 0.0f;
}

static inline float nearer(float range, float other)
{
    return other > 0.0f && !(range > 0.0f && range < other) ? other : range;
}

static inline float range_of_disc(const struct disc *disc, struct jp_plane_point beam)
{
    const struct jp_plane_point way = {disc->centre.x - sensor.x, disc->centre.y - sensor.y};
    const float along = way.x * beam.x + way.y * beam.y;
    const float across = way.x * beam.y - way.y * beam.x;
    const float square = disc->radius * disc->radius - across * across;

    return along > 0.0f && square > 0.0f ? along - jp_plane_square_root(square) : 0.0f;
}

static inline void take_scan(void)
{
    for (unsigned i = 0; i < scan.count; i++) {
        const struct jp_plane_point beam =
            jp_plane_direction(sensor.heading + scan.first_angle + (float)i * scan.angle_step);

        ranges[i] = 0.0f;
        for (unsigned k = 0; k < disc_count; k++) {
            ranges[i] = nearer(ranges[i], range_of_disc(&discs[k], beam));
        }
        for (unsigned k = 0; k < wall_count; k++) {
            ranges[i] = nearer(ranges[i], range_of_wall(&walls[k], beam));
        }
    }
}

static inline void update(void)
{
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_movers_update(&movers, &config, &scan_config, &scan, &sensor, PERIOD));
}

static inline void look(void)
{
    take_scan();
    update();
}

/* Scans of a disc that walks. */
static inline void walk(struct disc *disc, struct jp_plane_point velocity, unsigned scans)
{
    for (unsigned i = 0; i < scans; i++) {
        look();
        disc->centre.x += PERIOD * velocity.x;
        disc->centre.y += PERIOD * velocity.y;
    }
}

static inline void see_shapes(void)
{
    const struct jp_plane_point here = {sensor.x, sensor.y};

    jp_obstacles_clear(&obstacles, &here);
    TEST_ASSERT_EQUAL_INT(JP_OK, jp_obstacles_add_scan(&obstacles, &scan_config, &scan, &sensor));
    jp_movers_mark(&movers, &config, &obstacles);
}

static inline bool is_marked(const struct jp_obstacle *shape)
{
    return jp_plane_length(shape->velocity.x, shape->velocity.y) > 0.0f || shape->margin > 0.0f;
}

static inline unsigned marked(void)
{
    unsigned count = 0;

    for (unsigned i = 0; i < obstacles.count; i++) {
        count += is_marked(&obstacles.shapes[i]) ? 1U : 0U;
    }
    return count;
}

/* A beam a degree, as the patrol robot's laser has. */
static inline void see_coarsely(void)
{
    config.extent = 2.0f;
    scan.count = BEAMS / 2;
    scan.angle_step = 4.0f * JP_PLANE_PI / BEAMS;
}

static inline bool has_walked(unsigned i)
{
    return movers.movers[i].pace > 0.0f;
}

/* The track whose velocity is nearest to one, of those near a place; null: there is none. */
static inline const struct jp_mover *track_of(const struct disc *disc, struct jp_plane_point velocity)
{
    const struct jp_mover *nearest = NULL;

    for (unsigned i = 0; i < movers.count; i++) {
        const struct jp_mover *const mover = &movers.movers[i];

        if (jp_plane_square_between(mover->centre, disc->centre) < 0.4f * 0.4f &&
            (nearest == NULL || jp_plane_square_between(mover->velocity, velocity) <
                                    jp_plane_square_between(nearest->velocity, velocity))) {
            nearest = mover;
        }
    }
    return nearest;
}

#endif
