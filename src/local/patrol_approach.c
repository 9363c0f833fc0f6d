#include "src/local/patrol_approach.h"

#include "src/base/plane.h"
#include "src/local/patrol_marks.h"

#define TURN_STEPS      36
#define STRAIGHT_STEP   0.05f /* m */
#define STRAIGHT_MARGIN 0.02f /* m */

static bool can_turn_at(const struct jp_terrain *map, const struct jp_footprint *footprint,
                        const struct jp_plane_pose *place, float margin)
{
    struct jp_plane_pose pose = *place;

    for (int i = 0; i < TURN_STEPS; i++) {
        pose.heading = 2.0f * JP_PLANE_PI * (float)i / (float)TURN_STEPS;
        if (!jp_patrol_fits(map, footprint, &pose, margin)) {
            return false;
        }
    }
    return true;
}

static struct jp_plane_pose behind(const struct jp_plane_pose *goal, float distance)
{
    const struct jp_plane_pose back = {-distance, 0.0f, 0.0f};

    return jp_plane_compose(goal, &back);
}

static bool is_straight_free(const struct jp_terrain *map, const struct jp_footprint *footprint,
                             const struct jp_plane_pose *goal, float length)
{
    const int steps = (int)(length / STRAIGHT_STEP) + 1;

    for (int i = 0; i < steps; i++) {
        const float share = (float)i / (float)steps;
        const struct jp_plane_pose pose = behind(goal, length * share);

        if (!jp_patrol_fits(map, footprint, &pose, STRAIGHT_MARGIN)) {
            return false;
        }
    }
    return true;
}

static bool find_approach(const struct jp_terrain *map, const struct jp_footprint *footprint,
                          const struct jp_plane_pose *goal, float margin, struct jp_plane_pose *approach)
{
    static const float distances[] = {0.6f, 0.8f, 1.0f, 1.3f, 1.6f, 2.0f}; /* m */

    for (size_t i = 0; i < sizeof distances / sizeof distances[0]; i++) {
        *approach = behind(goal, distances[i]);
        if (can_turn_at(map, footprint, approach, margin) && is_straight_free(map, footprint, goal, distances[i])) {
            return true;
        }
    }
    return false;
}

bool jp_patrol_choose_approach(const struct jp_terrain *map, const struct jp_footprint *footprint,
                               const struct jp_plane_pose *goal, struct jp_plane_pose *approach)
{
    /* The most that there is, m. */
    static const float margins[] = {0.10f, 0.06f, 0.03f};

    for (size_t i = 0; i < sizeof margins / sizeof margins[0]; i++) {
        if (can_turn_at(map, footprint, goal, margins[i])) {
            return false;
        }
        if (find_approach(map, footprint, goal, margins[i], approach)) {
            return true;
        }
    }
    return false;
}
