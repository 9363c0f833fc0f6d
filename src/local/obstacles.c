#include <joulepath/obstacles.h>

#include "src/base/plane.h"
#include "src/local/obstacle_distance.h"

static bool is_place(const struct jp_plane_point *point)
{
    return jp_plane_is_within(point->x, JP_PLANE_MAX) && jp_plane_is_within(point->y, JP_PLANE_MAX);
}

/* Whether the way over three vertices turns right. */
static bool turns_right(const struct jp_plane_point *a, const struct jp_plane_point *b, const struct jp_plane_point *c)
{
    return (b->x - a->x) * (c->y - b->y) < (b->y - a->y) * (c->x - b->x);
}

static bool is_motion(const struct jp_obstacle *shape)
{
    return jp_plane_is_within(shape->velocity.x, JP_OBSTACLE_SPEED_MAX) &&
           jp_plane_is_within(shape->velocity.y, JP_OBSTACLE_SPEED_MAX) &&
           jp_plane_is_between(shape->margin, 0.0f, JP_OBSTACLE_MARGIN_MAX);
}

static bool is_shape(const struct jp_obstacle *shape)
{
    const unsigned count = shape->vertex_count;
    bool is_good = count >= 1U && count <= JP_OBSTACLE_VERTICES_MAX &&
                   jp_plane_is_between(shape->radius, 0.0f, JP_PLANE_MAX) && is_motion(shape);

    for (unsigned i = 0; is_good && i < count; i++) {
        is_good = is_place(&shape->vertices[i]);
    }
    for (unsigned i = 0; is_good && i < count; i++) {
        is_good =
            !turns_right(&shape->vertices[i], &shape->vertices[(i + 1U) % count], &shape->vertices[(i + 2U) % count]);
    }
    return is_good;
}

void jp_obstacles_clear(struct jp_obstacles *obstacles, const struct jp_plane_point *centre)
{
    obstacles->count = 0;
    obstacles->dropped = 0;
    obstacles->centre = *centre;
}

/* Where a shape of that distance belongs. */
static unsigned place_of(const struct jp_obstacles *obstacles, float distance)
{
    unsigned place = obstacles->count;

    while (place > 0U && obstacles->distance[place - 1U] > distance) {
        place--;
    }
    return place;
}

static void insert(struct jp_obstacles *obstacles, const struct jp_obstacle *shape, float distance)
{
    const unsigned place = place_of(obstacles, distance);

    if (obstacles->count < JP_OBSTACLES_MAX) {
        obstacles->count++;
    } else {
        obstacles->dropped++;
    }
    for (unsigned i = obstacles->count; i > place + 1U; i--) {
        obstacles->shapes[i - 1U] = obstacles->shapes[i - 2U];
        obstacles->distance[i - 1U] = obstacles->distance[i - 2U];
    }
    if (place < obstacles->count) {
        obstacles->shapes[place] = *shape;
        obstacles->distance[place] = distance;
    }
}

enum jp_status jp_obstacles_add(struct jp_obstacles *obstacles, const struct jp_obstacle *shape)
{
    static const struct jp_footprint point = {0.0f, 0.0f, 0.0f};

    if (obstacles == NULL || shape == NULL || !is_shape(shape)) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_plane_pose centre = {obstacles->centre.x, obstacles->centre.y, 0.0f};
    uint8_t feature = JP_FEATURE_UNKNOWN;

    insert(obstacles, shape,
           jp_obstacle_distance_along(&point, &centre, (struct jp_plane_point){1.0f, 0.0f}, shape, &feature, NULL));
    return JP_OK;
}

float jp_obstacles_distance(const struct jp_obstacles *obstacles, const struct jp_footprint *footprint,
                            const struct jp_plane_pose *pose)
{
    const struct jp_plane_point direction = jp_plane_direction(pose->heading);
    const float longest = jp_plane_larger(footprint->front, footprint->rear);
    const float reach =
        jp_plane_length(pose->x - obstacles->centre.x, pose->y - obstacles->centre.y) + longest + footprint->half_width;
    float nearest = JP_OBSTACLE_NONE;

    /* A shape that cannot be reached from here ends the search: the next ones are farther. */
    for (unsigned i = 0; i < obstacles->count; i++) {
        const float least = obstacles->distance[i] - reach;

        if (least > 0.0f && least > nearest) {
            break;
        }

        uint8_t feature = JP_FEATURE_UNKNOWN;
        const float distance =
            jp_obstacle_distance_along(footprint, pose, direction, &obstacles->shapes[i], &feature, NULL);

        nearest = distance < nearest ? distance : nearest;
    }
    return nearest;
}
