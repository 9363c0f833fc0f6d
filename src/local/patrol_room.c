#include "src/local/patrol_room.h"

#include <stddef.h>

#include "src/base/plane.h"
#include "src/local/patrol_price.h"

/* Between the poses that are checked, rad and m. */
#define SWEEP_STEP 0.09f
#define WAY_STEP   0.05f

/* Nearer than now by less is not nearer, m: rounding, as both are of one scan. */
#define NEARER 0.001f

/* Of the tolerance of scans: as a robot's file has that, four times the laser's noise, it is thrice the noise. */
#define SAFE 0.75f

/* Steps that are tried, m and rad. */
#define STEP_LENGTH  0.15f
#define STEP_LENGTHS 5U
#define STEP_ANGLE   (JP_PLANE_PI / 6.0f)
#define STEP_ANGLES  12U

/* Of them, those that are not backwards: the paper's robot takes no other. */
#define STEP_ANGLES_AHEAD 7U

float jp_patrol_clearance(const struct jp_patrol *patrol, const struct jp_plane_pose *pose)
{
    return jp_obstacles_distance(&patrol->obstacles, &patrol->config.teb.footprint, pose) +
           0.5f * patrol->config.scan.tolerance;
}

float jp_patrol_least_clearance(const struct jp_patrol *patrol)
{
    const float now = jp_patrol_clearance(patrol, &patrol->pose) - NEARER;

    return jp_plane_clamp(now, 0.0f, SAFE * patrol->config.scan.tolerance);
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

static float distance_from(const struct jp_patrol *patrol, const struct jp_plane_pose *pose, uint8_t shape)
{
    return jp_obstacle_distance(&patrol->config.teb.footprint, pose, &patrol->obstacles.shapes[shape], NULL) +
           0.5f * patrol->config.scan.tolerance;
}

/* From each thing the clearance, or no less than at another pose but for a slack: what is nearest there says nothing of
 * the others. */
static bool keeps_there(const struct jp_patrol *patrol, const struct jp_plane_pose *pose,
                        const struct jp_plane_pose *from, float clearance, float slack)
{
    for (uint8_t i = 0; i < patrol->obstacles.count; i++) {
        const float distance = distance_from(patrol, pose, i);

        if (distance < clearance && distance < distance_from(patrol, from, i) - slack) {
            return false;
        }
    }
    return true;
}

static bool keeps_clearance(const struct jp_patrol *patrol, const struct jp_plane_pose *from,
                            const struct jp_plane_pose *step, float clearance, float slack)
{
    const unsigned parts = (unsigned)(jp_plane_length(step->x, step->y) / WAY_STEP) + 1U;

    for (unsigned i = 1; i <= parts; i++) {
        const float share = (float)i / (float)parts;
        const struct jp_plane_pose part = {share * step->x, share * step->y, 0.0f};
        const struct jp_plane_pose pose = jp_plane_compose(from, &part);

        if (!keeps_there(patrol, &pose, from, clearance, slack)) {
            return false;
        }
    }
    return true;
}

bool jp_patrol_is_step_free_from(const struct jp_patrol *patrol, const struct jp_plane_pose *from,
                                 const struct jp_plane_pose *step, float clearance)
{
    return keeps_clearance(patrol, from, step, clearance, JP_PATROL_CLEARANCE_NOISE);
}

bool jp_patrol_is_step_free(const struct jp_patrol *patrol, const struct jp_plane_pose *step, float clearance)
{
    return jp_patrol_is_step_free_from(patrol, &patrol->pose, step, clearance);
}

/* From straight ahead to both sides in turn, at last straight back. */
static float step_angle(unsigned i)
{
    const unsigned pair = (i + 1U) / 2U;
    const float angle = (float)pair * STEP_ANGLE;

    return i % 2U == 0U ? angle : -angle;
}

static bool is_by_cost(const struct jp_patrol *patrol)
{
    return patrol->config.strategy == (uint8_t)JP_PATROL_BY_COST;
}

/* From a pose with another heading to a place. */
static struct jp_plane_pose way_into(const struct jp_plane_pose *from, float heading, const struct jp_plane_pose *to)
{
    const struct jp_plane_pose turned = {from->x, from->y, heading};
    const struct jp_plane_pose there = jp_plane_relative(&turned, to);

    return (struct jp_plane_pose){there.x, there.y, 0.0f};
}

static float price_of(const struct jp_patrol_config *config, const struct jp_plane_pose *step)
{
    return jp_patrol_step_price(config, jp_plane_magnitude(jp_plane_bearing(step->x, step->y)),
                                jp_plane_length(step->x, step->y));
}

/* Of a step, of the turn after it, and of the step into where the search leads. */
static float search_price(const struct jp_patrol *patrol, const struct jp_patrol_step_search *search,
                          const struct jp_plane_pose *step)
{
    const struct jp_plane_pose there = jp_plane_compose(&patrol->pose, step);
    const float turn = jp_plane_magnitude(jp_plane_wrap(search->heading - patrol->pose.heading));
    const float price = price_of(&patrol->config, step) + jp_patrol_turn_price(&patrol->config, turn);

    if (search->into == NULL) {
        return price;
    }
    const struct jp_plane_pose in = way_into(&there, search->heading, search->into);

    return price + price_of(&patrol->config, &in);
}

/* It keeps the clearance, or gets no nearer where it has less, and leads to where there is room. */
static bool is_step_good(const struct jp_patrol *patrol, const struct jp_patrol_step_search *search,
                         const struct jp_plane_pose *step)
{
    const struct jp_plane_pose there = jp_plane_compose(&patrol->pose, step);
    float turn;

    if (!keeps_clearance(patrol, &patrol->pose, step, search->clearance, 0.0f) ||
        !jp_patrol_find_turn(patrol, &there, search->heading, search->clearance, &turn)) {
        return false;
    }
    if (search->into == NULL) {
        return true;
    }
    const struct jp_plane_pose turned = {there.x, there.y, search->heading};
    const struct jp_plane_pose in = way_into(&there, search->heading, search->into);

    return jp_plane_length(in.x, in.y) < search->into_reach &&
           jp_patrol_is_step_free_from(patrol, &turned, &in, search->into_clearance);
}

bool jp_patrol_find_step(const struct jp_patrol *patrol, const struct jp_patrol_step_search *search,
                         struct jp_plane_point *target)
{
    const unsigned angles = is_by_cost(patrol) ? STEP_ANGLES : STEP_ANGLES_AHEAD;
    float least = JP_OBSTACLE_NONE;
    bool is_found = false;

    for (unsigned i = 0; i < STEP_LENGTHS * angles && !(is_found && !is_by_cost(patrol)); i++) {
        const unsigned ring = i / angles + 1U;
        const float length = (float)ring * STEP_LENGTH;
        const float angle = step_angle(i % angles);
        const struct jp_plane_pose step = {length * jp_plane_cosine(angle), length * jp_plane_sine(angle), 0.0f};
        const float price = search_price(patrol, search, &step);

        if ((!is_found || price < least) && is_step_good(patrol, search, &step)) {
            const struct jp_plane_pose there = jp_plane_compose(&patrol->pose, &step);

            least = price;
            is_found = true;
            *target = (struct jp_plane_point){there.x, there.y};
        }
    }
    return is_found;
}
