#include <joulepath/teb.h>

#include <string.h>

#include "src/base/config_float_check.h"
#include "src/base/plane.h"
#include "src/local/obstacle_distance.h"
#include "src/local/teb_band.h"
#include "src/local/teb_residuals.h"
#include "src/local/teb_solve.h"

/* Of Levenberg and Marquardt. */
#define DAMPING_START 0.1f
#define DAMPING_MIN   1.0e-5f
#define DAMPING_MAX   1.0e4f
#define DAMPING_DOWN  0.5f
#define DAMPING_UP    3.0f

/* Of the reference interval. */
#define INTERVAL_MIN_SHARE 0.1f

/* Of a heading in one step, rad. */
#define STEP_TURN_MAX 900.0f

/* Poses farther away than this are not needed now: an obstacle there may go, s. */
#define FORESIGHT 1.5f

/* Steps whose mean is the speed to drive at; every band has so many. */
#define SPEED_STEPS 2U

#define ZERO_LENGTH 1.0e-3f

/* What the configuration may be. */
#define LEAST            1.0e-3f
#define VALUE_MAX        1.0e6f
#define ROUNDS_MAX       8.0f
#define STEPS_MAX        16.0f
#define HYSTERESIS_SHARE 0.9f /* of the interval */

/* ---- Configuration ---- */

#define FIELD(member, low, high) JP_CONFIG_FIELD("", struct jp_teb_config, member, low, high)

static enum jp_status check(const struct jp_teb_config *config, const char **field)
{
    static const struct jp_config_float_field fields[] = {
        FIELD(speed_max, LEAST, VALUE_MAX),
        FIELD(reverse_max, LEAST, VALUE_MAX),
        FIELD(turn_rate_max, LEAST, VALUE_MAX),
        FIELD(acceleration, LEAST, VALUE_MAX),
        FIELD(turn_acceleration, LEAST, VALUE_MAX),
        FIELD(radius_min, 0.0f, VALUE_MAX),
        FIELD(footprint.front, 0.0f, VALUE_MAX),
        FIELD(footprint.rear, 0.0f, VALUE_MAX),
        FIELD(footprint.half_width, LEAST, VALUE_MAX),
        FIELD(clearance, 0.0f, VALUE_MAX),
        FIELD(interval, LEAST, VALUE_MAX),
        FIELD(hysteresis, LEAST, VALUE_MAX),
        FIELD(rounds, 1.0f, ROUNDS_MAX),
        FIELD(steps, 1.0f, STEPS_MAX),
        FIELD(weights.nonholonomic, 0.0f, VALUE_MAX),
        FIELD(weights.speed, 0.0f, VALUE_MAX),
        FIELD(weights.turn_rate, 0.0f, VALUE_MAX),
        FIELD(weights.turn_radius, 0.0f, VALUE_MAX),
        FIELD(weights.acceleration, 0.0f, VALUE_MAX),
        FIELD(weights.turn_acceleration, 0.0f, VALUE_MAX),
        FIELD(weights.obstacle, 0.0f, VALUE_MAX),
        FIELD(weights.path, 0.0f, VALUE_MAX),
        FIELD(weights.second, 0.0f, VALUE_MAX),
        FIELD(weights.metre, 0.0f, VALUE_MAX),
        FIELD(weights.drag, 0.0f, VALUE_MAX),
        FIELD(weights.no_reversing, 0.0f, VALUE_MAX),
        FIELD(weights.wheel_odometry, 0.0f, VALUE_MAX),
        FIELD(weights.laser_odometry, 0.0f, VALUE_MAX),
    };
    const enum jp_status status = jp_config_float_check(config, fields, JP_CONFIG_COUNT(fields), field);

    if (status == JP_OK && config->hysteresis > HYSTERESIS_SHARE * config->interval) {
        return jp_config_refuse("hysteresis", field);
    }
    return status;
}

static struct jp_teb_weights weights_of(const struct jp_teb_config *config)
{
    const float per_interval = 1.0f / (config->interval * config->interval);
    struct jp_teb_weights weights = config->weights;

    weights.speed *= per_interval;
    weights.turn_rate *= per_interval;
    weights.turn_radius *= per_interval;
    weights.no_reversing *= per_interval;
    return weights;
}

enum jp_status jp_teb_init(struct jp_teb *teb, const struct jp_teb_config *config, const char **field)
{
    if (teb == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = check(config, field);

    if (status != JP_OK) {
        return status;
    }
    (void)memset(teb, 0, sizeof *teb);
    teb->config = *config;
    teb->internal.weights = weights_of(config);
    teb->internal.root_nonholonomic = jp_plane_square_root(config->weights.nonholonomic);
    return JP_OK;
}

void jp_teb_clear(struct jp_teb *teb)
{
    teb->count = 0;
}

/* ---- Optimisation ---- */

/* A step of the equations may be anything; a heading that turns farther cannot be wrapped. */
static bool can_move(const struct jp_teb *teb)
{
    for (unsigned i = 0; i < teb->count; i++) {
        if (!jp_plane_is_within(teb->internal.factor[i].step.heading, STEP_TURN_MAX)) {
            return false;
        }
    }
    return true;
}

static void move_band(struct jp_teb *teb)
{
    const float least = INTERVAL_MIN_SHARE * teb->config.interval;

    for (unsigned i = 0; i < teb->count; i++) {
        const struct jp_teb_row *const step = &teb->internal.factor[i].step;
        struct jp_teb_pose *const pose = &teb->poses[i];
        const float interval = pose->interval + step->interval;
        const struct jp_plane_pose to = {pose->pose.x + step->x, pose->pose.y + step->y,
                                         jp_plane_wrap(pose->pose.heading + step->heading)};

        jp_teb_set_pose(pose, &to);
        pose->interval = interval < least ? least : interval;
    }
}

/* The band and its terms, which were summed up last. */
static void keep_band(struct jp_teb *teb)
{
    (void)memcpy(teb->internal.kept, teb->poses, teb->count * sizeof teb->poses[0]);
    teb->internal.kept_terms ^= 1U;
}

static void put_band_back(struct jp_teb *teb)
{
    (void)memcpy(teb->poses, teb->internal.kept, teb->count * sizeof teb->poses[0]);
}

/* One step from the band that is kept; true when it lowered the cost. A cost that is not a number never does. */
static bool take_step(struct jp_teb *teb, float *cost)
{
    float after = *cost;

    if (jp_teb_solve(teb) && can_move(teb)) {
        move_band(teb);
        after = jp_teb_linearise(teb, *cost);
    }
    if (!(after < *cost)) {
        put_band_back(teb);
        return false;
    }
    keep_band(teb);
    *cost = after;
    return true;
}

static void take_steps(struct jp_teb *teb, struct jp_teb_result *result)
{
    for (unsigned step = 0; step < teb->config.steps && teb->internal.work < JP_TEB_WORK_MAX; step++) {
        float factor = DAMPING_DOWN;

        result->steps++;
        if (!take_step(teb, &result->cost)) {
            result->steps_rejected++;
            factor = DAMPING_UP;
        }
        teb->internal.damping = jp_plane_clamp(teb->internal.damping * factor, DAMPING_MIN, DAMPING_MAX);
    }
}

static void optimise(struct jp_teb *teb, struct jp_teb_result *result)
{
    teb->internal.damping = DAMPING_START;
    teb->internal.work = 0;
    /* Once: a new pose costs steps until it fits. */
    jp_teb_resize(teb);
    for (unsigned round = 0; round < teb->config.rounds && teb->internal.work < JP_TEB_WORK_MAX; round++) {
        jp_teb_find_feet(teb);
        jp_teb_find_obstacles(teb);
        result->cost = jp_teb_linearise(teb, FLT_MAX);
        keep_band(teb);
        take_steps(teb, result);
    }
}

/* ---- Result ---- */

static bool stands(const struct jp_obstacle *shape)
{
    return !(shape->velocity.x < 0.0f || shape->velocity.x > 0.0f || shape->velocity.y < 0.0f ||
             shape->velocity.y > 0.0f);
}

/* Of what stands; features that were nearest from the last pose are tried first. */
static float clearance_at(struct jp_teb *teb, unsigned i, float time, uint8_t *features)
{
    float least = JP_OBSTACLE_NONE;

    for (unsigned shape = 0; shape < teb->internal.obstacles->count; shape++) {
        if (stands(&teb->internal.obstacles->shapes[shape])) {
            const float away = jp_teb_distance(teb, i, shape, time, &features[shape], NULL);

            least = away < least ? away : least;
        }
    }
    return least;
}

/* Of the band as far as it matters now. */
static void measure_band(struct jp_teb *teb, struct jp_teb_result *result)
{
    uint8_t features[JP_OBSTACLES_MAX];

    (void)memset(features, (int)JP_FEATURE_UNKNOWN, sizeof features);
    result->clearance = JP_OBSTACLE_NONE;
    result->duration = 0.0f;
    for (unsigned i = 0; i < teb->count; i++) {
        if (result->duration <= FORESIGHT && result->clearance >= -JP_TEB_OVERLAP_MAX) {
            const float away = clearance_at(teb, i, result->duration, features);

            result->clearance = away < result->clearance ? away : result->clearance;
        }
        result->duration += i + 1U < teb->count ? teb->poses[i].interval : 0.0f;
    }
}

/* Length of a step along the mean of its headings. */
static float step_length(const struct jp_teb_pose *from, const struct jp_teb_pose *to)
{
    const float c = 0.5f * (from->cosine + to->cosine);
    const float s = 0.5f * (from->sine + to->sine);

    return c * (to->pose.x - from->pose.x) + s * (to->pose.y - from->pose.y);
}

/* Mean over the first steps: one alone passes on all noise of where the robot is, more cut corners. */
static struct jp_plane_speed first_speed(const struct jp_teb *teb, unsigned steps)
{
    const struct jp_teb_pose *const poses = teb->poses;
    const float reverse = teb->config.weights.no_reversing > 0.0f ? 0.0f : teb->config.reverse_max;
    float length = 0.0f;
    float turn = 0.0f;
    float duration = 0.0f;

    for (unsigned i = 0; i < steps; i++) {
        length += step_length(&poses[i], &poses[i + 1U]);
        turn += jp_plane_wrap(poses[i + 1U].pose.heading - poses[i].pose.heading);
        duration += poses[i].interval;
    }

    const float forward = jp_plane_clamp(length / duration, -reverse, teb->config.speed_max);
    const float by_radius =
        teb->config.radius_min > 0.0f ? jp_plane_magnitude(forward) / teb->config.radius_min : VALUE_MAX;
    const float turn_max = by_radius < teb->config.turn_rate_max ? by_radius : teb->config.turn_rate_max;

    return (struct jp_plane_speed){forward, jp_plane_clamp(turn / duration, -turn_max, turn_max)};
}

/* ---- A cycle ---- */

static bool is_task_sound(const struct jp_teb *teb, const struct jp_teb_task *task)
{
    return jp_plane_is_pose(&task->start) && jp_plane_is_pose(&task->goal) &&
           (!task->is_measured || jp_plane_is_pose(&task->measured)) &&
           jp_plane_is_between(task->speed.forward, -VALUE_MAX, VALUE_MAX) &&
           jp_plane_is_between(task->speed.turn_rate, -VALUE_MAX, VALUE_MAX) &&
           jp_plane_is_between(task->goal_speed, 0.0f, teb->config.speed_max) && task->path != NULL &&
           task->path_count >= 2U;
}

enum jp_status jp_teb_plan(struct jp_teb *teb, const struct jp_teb_task *task, const struct jp_obstacles *obstacles,
                           struct jp_teb_result *result)
{
    if (teb == NULL || task == NULL || obstacles == NULL || result == NULL || !is_task_sound(teb, task)) {
        return JP_ERR_ARGUMENT;
    }
    (void)memset(result, 0, sizeof *result);
    result->start = task->start;
    if (jp_plane_length(task->goal.x - task->start.x, task->goal.y - task->start.y) < ZERO_LENGTH) {
        return JP_ERR_ZERO_LENGTH;
    }
    teb->internal.task = *task;
    teb->internal.obstacles = obstacles;
    if (jp_obstacles_distance(obstacles, &teb->config.footprint, &task->start) < -JP_TEB_OVERLAP_MAX) {
        jp_teb_clear(teb);
        return JP_ERR_BLOCKED;
    }

    jp_teb_fit_band(teb);
    optimise(teb, result);
    measure_band(teb, result);
    if (result->clearance < -JP_TEB_OVERLAP_MAX || !jp_plane_is_finite(result->cost)) {
        jp_teb_clear(teb);
        return JP_ERR_INFEASIBLE;
    }
    result->start = teb->poses[0].pose;
    result->speed = first_speed(teb, SPEED_STEPS);
    result->first = first_speed(teb, 1U);
    return JP_OK;
}
