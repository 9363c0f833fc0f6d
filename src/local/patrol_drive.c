#include "src/local/patrol_drive.h"

#include "src/base/plane.h"
#include "src/local/patrol_glide.h"
#include "src/local/patrol_path.h"
#include "src/local/patrol_price.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_sense.h"
#include "src/local/patrol_state.h"
#include "src/local/patrol_turn.h"

/* A command is good when the robot could hold it for so long at least, s, which is looked at in so many poses, and
 * every so many m. */
#define COMMAND_TIME  0.3f
#define COMMAND_STEPS 3U
#define WAY_STEP      0.1f

/* The pose of the band that says where it leads to; every band has it. */
#define SOON 2U

/* Of the speed that the band wants, those that are tried. */
#define SHARES 5U

/* Cycles in which a band that stands may begin to move. */
#define STILL_CYCLES 5U

static float goal_heading_error(const struct jp_patrol *patrol)
{
    return patrol->internal.goal.is_heading_free
               ? 0.0f
               : jp_plane_magnitude(jp_plane_wrap(patrol->internal.goal.pose.heading - patrol->pose.heading));
}

static float goal_distance(const struct jp_patrol *patrol)
{
    return jp_plane_length(patrol->internal.goal.pose.x - patrol->pose.x,
                           patrol->internal.goal.pose.y - patrol->pose.y);
}

/* True within a third of the tolerance of the goal, or within the tolerance once the goal is passed or the robot
 * stands. From then on the robot first comes to a stand. */
static bool is_at_goal(const struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_plane_pose there = jp_plane_relative(&patrol->pose, &patrol->internal.goal.pose);
    const float away = jp_plane_length(there.x, there.y);
    const float tolerance = patrol->config.position_tolerance;
    const bool is_heading_due =
        !patrol->config.turns_in_place && goal_heading_error(patrol) > patrol->config.heading_tolerance;

    return patrol->internal.is_arriving ||
           (!is_heading_due && away < tolerance &&
            (3.0f * away < tolerance || there.x <= 0.0f || jp_patrol_is_standing(speed)));
}

/* Whether any heading will do to reach the end of the window: the robot turns there afterwards. */
static bool may_turn_at_goal(const struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    const struct jp_plane_pose there = {patrol->internal.goal.pose.x, patrol->internal.goal.pose.y,
                                        window->end.heading};
    float angle;

    return patrol->internal.goal.is_heading_free ||
           (patrol->config.turns_in_place && jp_patrol_find_turn(patrol, &there, patrol->internal.goal.pose.heading,
                                                                 patrol->config.turn_clearance, &angle));
}

/* Where a pose will be when the wheels do what is asked of them now. */
static struct jp_plane_pose after_latency(const struct jp_patrol *patrol, const struct jp_plane_pose *pose,
                                          const struct jp_plane_speed *speed)
{
    const float latency = patrol->config.latency;
    const struct jp_plane_pose half_turn = {0.0f, 0.0f, 0.5f * latency * speed->turn_rate};
    const struct jp_plane_pose way = {latency * speed->forward, 0.0f, half_turn.heading};
    const struct jp_plane_pose middle = jp_plane_compose(pose, &half_turn);

    return jp_plane_compose(&middle, &way);
}

static struct jp_teb_task task_of(const struct jp_patrol *patrol, const struct jp_patrol_window *window,
                                  const struct jp_plane_speed *speed)
{
    struct jp_teb_task task = {
        .start = after_latency(patrol, &patrol->pose, speed),
        .measured = after_latency(patrol, &patrol->internal.laser, speed),
        .is_measured = patrol->internal.is_measured,
        .speed = *speed,
        .goal = window->end,
        .goal_speed = window->is_goal ? 0.0f : patrol->config.teb.speed_max,
        .path = &patrol->internal.path[window->first],
        .path_count = window->count,
    };

    if (window->is_goal) {
        task.is_heading_free = may_turn_at_goal(patrol, window);
        if (!task.is_heading_free) {
            task.goal = patrol->internal.goal.pose;
        } else {
            task.goal.x = patrol->internal.goal.pose.x;
            task.goal.y = patrol->internal.goal.pose.y;
        }
    }
    return task;
}

/* The least distance from anything until the robot has stopped from this speed, on its curve. */
static float clearance_until_stop(const struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const float forward = jp_plane_magnitude(speed->forward);
    const float braking =
        forward > 0.0f ? 0.5f * forward / jp_patrol_braking(&patrol->config, forward, speed->turn_rate) : 0.0f;
    const float seconds = jp_plane_larger(COMMAND_TIME, patrol->config.latency + patrol->config.period + braking);
    const unsigned steps = (unsigned)(seconds * forward / WAY_STEP) + COMMAND_STEPS;
    const float part = seconds / (float)steps;
    const struct jp_plane_pose step = {speed->forward * part, 0.0f, speed->turn_rate * part};
    struct jp_plane_pose pose = patrol->pose;
    float least = JP_OBSTACLE_NONE;

    for (unsigned i = 0; i < steps; i++) {
        pose = jp_plane_compose(&pose, &step);
        least = jp_plane_smaller(jp_patrol_clearance(patrol, &pose), least);
    }
    return least;
}

/* Slows the command down to where the robot could stop. False: it could from none. */
static bool heed_stop(const struct jp_patrol *patrol, struct jp_plane_speed *speed)
{
    const struct jp_plane_speed wanted = *speed;

    for (unsigned i = 0; i < SHARES; i++) {
        const float share = 1.0f - (float)i / (float)SHARES;

        *speed = (struct jp_plane_speed){share * wanted.forward, share * wanted.turn_rate};
        if (clearance_until_stop(patrol, speed) >= jp_patrol_least_clearance(patrol)) {
            return true;
        }
    }
    return false;
}

/* Fastest forward or backward speed now: speeding up takes a while, and at the goal the robot must stop. */
static float speed_limit(const struct jp_patrol *patrol)
{
    const float acceleration = patrol->config.teb.acceleration;
    const float rising = jp_plane_magnitude(patrol->internal.command.forward) + acceleration * patrol->config.period;
    const float stopping = jp_patrol_stopping_speed(&patrol->config, acceleration, goal_distance(patrol));

    return rising < stopping ? rising : stopping;
}

/* The speed limited to what is reachable in a cycle, on the same curve. */
static struct jp_plane_speed reachable(const struct jp_patrol *patrol, const struct jp_plane_speed *wanted)
{
    const float limit = speed_limit(patrol);
    const float speed = jp_plane_magnitude(wanted->forward);

    if (speed <= limit) {
        return *wanted;
    }
    return (struct jp_plane_speed){wanted->forward * (limit / speed), wanted->turn_rate * (limit / speed)};
}

/* Along the mean of its first steps, unless that cuts a corner that its first step alone does not. */
static struct jp_plane_speed speed_along_band(const struct jp_patrol *patrol)
{
    const struct jp_plane_speed mean = reachable(patrol, &patrol->band.speed);
    const struct jp_plane_speed first = reachable(patrol, &patrol->band.first);
    const float kept = jp_plane_smaller(jp_patrol_clearance(patrol, &patrol->pose), patrol->config.glide_clearance);
    const float by_mean = clearance_until_stop(patrol, &mean);

    return by_mean < kept && by_mean < clearance_until_stop(patrol, &first) ? first : mean;
}

static bool is_anything_moving(const struct jp_patrol *patrol)
{
    float fastest = 0.0f;

    for (uint8_t i = 0; i < patrol->obstacles.count; i++) {
        const struct jp_plane_point *const velocity = &patrol->obstacles.shapes[i].velocity;

        fastest = jp_plane_larger(fastest, jp_plane_length(velocity->x, velocity->y));
    }
    return fastest > 0.0f;
}

/* A robot that stands and whose band would not move it does not get on by waiting for the band. Among people the band
 * may stand although they have passed: it is laid anew, and may stand again while they have not. */
static bool has_band_stalled(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const bool stands = jp_patrol_is_standing(speed) && jp_patrol_is_standing(&patrol->band.speed);

    patrol->internal.still = stands ? (uint16_t)(patrol->internal.still + 1U) : 0U;
    if (patrol->internal.still <= STILL_CYCLES) {
        return false;
    }
    if (patrol->internal.is_yielding || is_anything_moving(patrol)) {
        jp_teb_clear(&patrol->teb);
        patrol->internal.still = 0U;
        return false;
    }
    return true;
}

/* Plans the band and takes its speed. False, with *reason, when there is none to drive. */
static bool plan_band(struct jp_patrol *patrol, const struct jp_patrol_window *window,
                      const struct jp_plane_speed *speed, enum jp_patrol_reason *reason)
{
    /* While it waited the wheels slowed down by themselves. */
    if (patrol->state == JP_PATROL_WAITING) {
        patrol->internal.command = *speed;
    }

    const struct jp_teb_task task = task_of(patrol, window, speed);
    const enum jp_status status = jp_teb_plan(&patrol->teb, &task, &patrol->obstacles, &patrol->band);

    jp_patrol_correct_pose(patrol);
    if (status == JP_OK && !has_band_stalled(patrol, speed)) {
        struct jp_plane_speed next = speed_along_band(patrol);

        if (heed_stop(patrol, &next)) {
            patrol->internal.command = next;
            return true;
        }
    }
    patrol->counts.infeasible++;
    *reason = status == JP_ERR_BLOCKED ? JP_PATROL_IN_COLLISION : JP_PATROL_BLOCKED;
    return false;
}

/* The band leads the robot nearer to something than it has to come: it plans what wheels cannot do at once, as its
 * limits are soft. */
static bool is_cornered(const struct jp_patrol *patrol)
{
    const float here = jp_patrol_clearance(patrol, &patrol->pose) - JP_PATROL_CLEARANCE_NOISE;

    return patrol->config.turns_in_place &&
           clearance_until_stop(patrol, &patrol->internal.command) < jp_plane_smaller(here, JP_PATROL_CLEARANCE);
}

/* Since it last made room. */
static bool has_left_corner(const struct jp_patrol *patrol)
{
    const struct jp_patrol_internal *const internal = &patrol->internal;
    const struct jp_plane_point from = jp_patrol_path_point(&internal->path[internal->room_next]);
    const struct jp_plane_point to = jp_patrol_path_point(&internal->path[internal->path_next]);

    return jp_plane_length(to.x - from.x, to.y - from.y) > patrol->config.teb.radius_min;
}

/* Where the band leads to. */
static float band_heading(const struct jp_patrol *patrol)
{
    return patrol->teb.poses[SOON].pose.heading;
}

static bool must_turn_first(const struct jp_patrol *patrol, const struct jp_patrol_window *window,
                            const struct jp_plane_speed *speed)
{
    return patrol->config.turns_in_place && jp_patrol_is_standing(speed) &&
           jp_plane_magnitude(jp_plane_wrap(window->direction - patrol->pose.heading)) > patrol->config.turn_first;
}

static bool is_step_cheapest(const struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    const struct jp_patrol_goal *const goal = &patrol->internal.goal;
    const struct jp_patrol_near_goal near = {
        .away = goal_distance(patrol),
        .first = jp_plane_magnitude(jp_plane_wrap(window->direction - patrol->pose.heading)),
        .then =
            goal->is_heading_free ? 0.0f : jp_plane_magnitude(jp_plane_wrap(goal->pose.heading - window->direction)),
        .error = goal_heading_error(patrol)};

    return patrol->config.strategy != (uint8_t)JP_PATROL_BY_COST || jp_patrol_is_step_cheapest(&patrol->config, &near);
}

/* Of a robot that stands: with the heading that it has, or that of the goal, if that is free and takes least. */
static bool step_to_goal(struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    if (!is_step_cheapest(patrol, window)) {
        return false;
    }
    if (jp_patrol_find_step_to_goal(patrol)) {
        jp_patrol_begin_step(patrol);
        return true;
    }
    return jp_patrol_turn_before_step(patrol);
}

static void turn_first(struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    if (!step_to_goal(patrol, window) && !jp_patrol_set_off(patrol, window)) {
        jp_patrol_turn_to(patrol, window->direction);
    }
}

/* A band keeps more from things than a step needs: before a goal between things it may stand. One that stands near
 * something turns, or steps to where it can. */
static void wait_or_step(struct jp_patrol *patrol, const struct jp_patrol_window *window,
                         const struct jp_plane_speed *speed, enum jp_patrol_reason reason)
{
    const bool may_step = reason == JP_PATROL_BLOCKED && patrol->config.turns_in_place && jp_patrol_is_standing(speed);
    const bool is_near = jp_patrol_clearance(patrol, &patrol->pose) < JP_PATROL_CLEARANCE;

    if (may_step && window->is_goal && step_to_goal(patrol, window)) {
        /* Or turns before it. */
    } else if (may_step && window->is_goal && jp_patrol_find_last_step(patrol)) {
        jp_patrol_begin_step(patrol);
    } else if (may_step && is_near) {
        jp_patrol_turn_to(patrol, window->direction);
    } else {
        jp_patrol_wait(patrol, reason);
    }
}

static void arrive(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    patrol->internal.is_arriving = true;
    jp_patrol_stand(patrol);
    if (!jp_patrol_is_standing(speed)) {
        return;
    }
    if (goal_heading_error(patrol) > patrol->config.heading_tolerance) {
        jp_patrol_turn_to(patrol, patrol->internal.goal.pose.heading);
    } else if (goal_distance(patrol) <= patrol->config.position_tolerance) {
        jp_patrol_enter(patrol, JP_PATROL_ARRIVED, JP_PATROL_NONE);
    } else if (jp_patrol_find_last_step(patrol)) {
        jp_patrol_begin_step(patrol);
    } else {
        jp_patrol_wait(patrol, JP_PATROL_BLOCKED);
    }
}

void jp_patrol_drive(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    struct jp_patrol_window window;
    enum jp_patrol_reason reason = JP_PATROL_NONE;

    if (is_at_goal(patrol, speed)) {
        jp_patrol_correct_pose(patrol);
        arrive(patrol, speed);
        return;
    }
    if (jp_patrol_advance(patrol)) {
        patrol->internal.unmoved = 0;
        patrol->internal.tries = 0;
        patrol->internal.rooms = has_left_corner(patrol) ? 0U : patrol->internal.rooms;
    }
    jp_patrol_look_ahead(patrol, patrol->config.horizon, &window);
    if (window.distance > patrol->config.horizon) {
        jp_patrol_wait(patrol, JP_PATROL_OFF_PATH);
    } else if (must_turn_first(patrol, &window, speed)) {
        jp_patrol_correct_pose(patrol);
        turn_first(patrol, &window);
    } else if (jp_patrol_glide_in(patrol, &window)) {
        jp_patrol_correct_pose(patrol);
    } else if (!plan_band(patrol, &window, speed, &reason)) {
        wait_or_step(patrol, &window, speed, reason);
    } else if (is_cornered(patrol) && jp_patrol_make_room(patrol, band_heading(patrol), jp_patrol_is_standing(speed))) {
        /* It brakes, or turns or steps to where it can go on. */
    } else if (!jp_patrol_trust_path(patrol)) {
        jp_patrol_stand(patrol);
    } else {
        jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
    }
}
