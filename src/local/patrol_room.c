#include "src/local/patrol_room.h"

#include <stddef.h>

#include "src/base/plane.h"

/* Between the poses that are checked, rad and m. */
#define SWEEP_STEP 0.09f
#define WAY_STEP   0.05f

/* Of clearances between scans, m. */
#define NOISE 0.01f

/* Steps that are tried, m and rad. */
#define STEP_LENGTH  0.15f
#define STEP_LENGTHS 5U
#define STEP_ANGLE   (JP_PLANE_PI / 6.0f)
#define STEP_ANGLES  7U

float jp_patrol_clearance(const struct jp_patrol *patrol, const struct jp_plane_pose *pose)
{
    return jp_obstacles_distance(&patrol->obstacles, &patrol->config.teb.footprint, pose) +
           0.5f * patrol->config.scan.tolerance;
}

float jp_patrol_clearance_later(const struct jp_patrol *patrol, const struct jp_plane_pose *pose, float time)
{
    float least = JP_OBSTACLE_NONE;

    for (uint8_t i = 0; i < patrol->obstacles.count; i++) {
        const struct jp_obstacle *const shape = &patrol->obstacles.shapes[i];
        const struct jp_plane_pose there = {pose->x - time * shape->velocity.x, pose->y - time * shape->velocity.y,
                                            pose->heading};
        const float distance =
            jp_obstacle_distance(&patrol->config.teb.footprint, &there, shape, NULL) - time * shape->margin;

        least = distance < least ? distance : least;
    }
    return least + 0.5f * patrol->config.scan.tolerance;
}

bool jp_patrol_is_turn_free(const struct jp_patrol *patrol, const struct jp_plane_pose *from, float angle,
                            float clearance)
{
    const unsigned steps = (unsigned)(jp_plane_magnitude(angle) / SWEEP_STEP) + 1U;
    const float step = angle / (float)steps;
    struct jp_plane_pose pose = *from;

    for (unsigned i = 0; i <= steps; i++) {
        const float time = (float)i * jp_plane_magnitude(step) / patrol->config.turn_rate;

        if (jp_patrol_clearance_later(patrol, &pose, time) < clearance) {
            return false;
        }
        pose.heading += step;
    }
    return true;
}

bool jp_patrol_find_turn(const struct jp_patrol *patrol, const struct jp_plane_pose *from, float heading,
                         float clearance, float *angle)
{
    const float shorter = jp_plane_wrap(heading - from->heading);
    const float longer = shorter > 0.0f ? shorter - 2.0f * JP_PLANE_PI : shorter + 2.0f * JP_PLANE_PI;

    *angle = shorter;
    if (jp_patrol_is_turn_free(patrol, from, shorter, clearance)) {
        return true;
    }
    *angle = longer;
    return jp_patrol_is_turn_free(patrol, from, longer, clearance);
}

bool jp_patrol_is_step_free_from(const struct jp_patrol *patrol, const struct jp_plane_pose *from,
                                 const struct jp_plane_pose *step, float clearance)
{
    const unsigned parts = (unsigned)(jp_plane_length(step->x, step->y) / WAY_STEP) + 1U;
    const float now = jp_patrol_clearance(patrol, from) - NOISE;
    const float least = now < clearance ? now : clearance;

    for (unsigned i = 1; i <= parts; i++) {
        const float share = (float)i / (float)parts;
        const struct jp_plane_pose part = {share * step->x, share * step->y, 0.0f};
        const struct jp_plane_pose pose = jp_plane_compose(from, &part);

        if (jp_patrol_clearance(patrol, &pose) < least) {
            return false;
        }
    }
    return true;
}

bool jp_patrol_is_step_free(const struct jp_patrol *patrol, const struct jp_plane_pose *step, float clearance)
{
    return jp_patrol_is_step_free_from(patrol, &patrol->pose, step, clearance);
}

/* From straight ahead to both sides in turn. */
static float step_angle(unsigned i)
{
    const unsigned pair = (i + 1U) / 2U;
    const float angle = (float)pair * STEP_ANGLE;

    return i % 2U == 0U ? angle : -angle;
}

bool jp_patrol_find_step(const struct jp_patrol *patrol, float heading, float clearance, struct jp_plane_point *target)
{
    for (unsigned i = 0; i < STEP_LENGTHS * STEP_ANGLES; i++) {
        const unsigned ring = i / STEP_ANGLES + 1U;
        const float length = (float)ring * STEP_LENGTH;
        const float angle = step_angle(i % STEP_ANGLES);
        const struct jp_plane_pose step = {length * jp_plane_cosine(angle), length * jp_plane_sine(angle), 0.0f};
        const struct jp_plane_pose there = jp_plane_compose(&patrol->pose, &step);
        float turn;

        if (jp_patrol_is_step_free(patrol, &step, clearance) &&
            jp_patrol_find_turn(patrol, &there, heading, clearance, &turn)) {
            *target = (struct jp_plane_point){there.x, there.y};
            return true;
        }
    }
    return false;
}
