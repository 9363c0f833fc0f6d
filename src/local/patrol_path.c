#include "src/local/patrol_path.h"

#include "src/base/plane.h"

/* The path this far ahead gives the direction to drive in, m. */
#define AIM_DISTANCE 0.5f

struct jp_plane_point jp_patrol_path_point(const struct jp_point *point)
{
    return (struct jp_plane_point){(float)point->x * (1.0f / (float)JP_Q16_ONE),
                                   (float)point->y * (1.0f / (float)JP_Q16_ONE)};
}

static float square_distance(const struct jp_patrol *patrol, uint16_t i)
{
    const struct jp_plane_point point = jp_patrol_path_point(&patrol->internal.path[i]);
    const float dx = point.x - patrol->pose.x;
    const float dy = point.y - patrol->pose.y;

    return dx * dx + dy * dy;
}

bool jp_patrol_advance(struct jp_patrol *patrol)
{
    uint16_t i = (uint16_t)(patrol->internal.path_next + 1U);
    bool has_moved = false;
    float reach = 0.0f;

    /* The path may come back near itself, so only what is within the horizon counts. */
    while (i < patrol->internal.path_count && reach < patrol->config.horizon) {
        const struct jp_plane_point a = jp_patrol_path_point(&patrol->internal.path[i - 1U]);
        const struct jp_plane_point b = jp_patrol_path_point(&patrol->internal.path[i]);

        reach += jp_plane_length(b.x - a.x, b.y - a.y);
        if (square_distance(patrol, i) <= square_distance(patrol, patrol->internal.path_next)) {
            patrol->internal.path_next = i;
            has_moved = true;
        }
        i++;
    }
    return has_moved;
}

void jp_patrol_look_ahead(const struct jp_patrol *patrol, float horizon, struct jp_patrol_window *window)
{
    const uint16_t last = (uint16_t)(patrol->internal.path_count - 1U);
    const uint16_t first = patrol->internal.path_next > 0U ? (uint16_t)(patrol->internal.path_next - 1U) : 0U;
    struct jp_plane_point point = jp_patrol_path_point(&patrol->internal.path[first]);
    struct jp_plane_point aim = jp_patrol_path_point(&patrol->internal.path[first + 1U]);
    float length = 0.0f;
    uint16_t i = first;

    window->direction = 0.0f;
    while (i < last && length < horizon) {
        const struct jp_plane_point next = jp_patrol_path_point(&patrol->internal.path[i + 1U]);

        length += jp_plane_length(next.x - point.x, next.y - point.y);
        window->end.heading = jp_plane_bearing(next.x - point.x, next.y - point.y);
        point = next;
        i++;
        if (length <= AIM_DISTANCE) {
            aim = next;
        }
    }
    window->first = first;
    window->count = (uint16_t)(i - first + 1U);
    window->end.x = point.x;
    window->end.y = point.y;
    window->is_goal = i == last;
    window->distance = jp_plane_square_root(square_distance(patrol, patrol->internal.path_next));
    window->direction = jp_plane_bearing(aim.x - patrol->pose.x, aim.y - patrol->pose.y);
}
