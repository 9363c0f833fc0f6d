#include "src/local/patrol_turn.h"

#include "src/base/plane.h"
#include "src/local/patrol_path.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_state.h"

/* Slower than this the robot stands, m/s and rad/s. */
#define STANDSTILL_SPEED     0.03f
#define STANDSTILL_TURN_RATE 0.05f

/* A turn is checked for as far as it needs to stop, after this time, s, and this angle. */
#define TURN_FORESIGHT 0.25f
#define TURN_MARGIN    0.05f /* rad */

/* Clearances that are tried for a turn, from the one that is wanted to the least. */
#define TURN_TRIES 5U

/* Lengths of a step along the path that are tried, each half of the one before. */
#define STEP_TRIES 4U

/* Steps back that are tried, each so much longer, m. */
#define STEP_BACKS 5U
#define STEP_BACK  0.2f

/* A step ends this near its target; one to the goal is at most so long where nobody asks what it costs, m. */
#define STEP_TOLERANCE 0.03f
#define STEP_REACH     0.4f

/* Free cycles in a row before the robot goes on. Their number doubles after each attempt without progress, so that the
 * robot does not try again and again where the path is free only now and then. */
#define FREE_CYCLES 3U
#define TRIES_MAX   8U

/* Times that it makes room without progress. */
#define ROOMS_MAX 2U

#define Q24 (1.0f / (float)JP_Q24_ONE)

float jp_patrol_stopping_speed(const struct jp_patrol_config *config, float deceleration, float distance)
{
    const float delay = config->latency + 0.5f * config->period;

    return deceleration * (jp_plane_square_root(delay * delay + 2.0f * distance / deceleration) - delay);
}

float jp_patrol_braking(const struct jp_patrol_config *config, float speed, float turn_rate)
{
    const float half_turn = 0.5f * jp_plane_magnitude(turn_rate) * Q24;
    const float along = half_turn * (float)config->wheels.track; /* of the outer wheels besides, m/s */
    const float across = half_turn * (float)config->wheels.wheelbase;

    return config->people.braking * speed / jp_plane_length(speed + along, across);
}

bool jp_patrol_is_standing(const struct jp_plane_speed *speed)
{
    return jp_plane_magnitude(speed->forward) < STANDSTILL_SPEED &&
           jp_plane_magnitude(speed->turn_rate) < STANDSTILL_TURN_RATE;
}

float jp_patrol_step_clearance(const struct jp_patrol_config *config)
{
    return config->strategy == (uint8_t)JP_PATROL_BY_COST ? 0.5f * config->glide_clearance : config->turn_clearance;
}

static bool find_goal_with(struct jp_patrol *patrol, float clearance)
{
    const struct jp_plane_pose remaining = jp_plane_relative(&patrol->pose, &patrol->internal.goal.pose);
    const struct jp_plane_pose step = {remaining.x, remaining.y, 0.0f};
    const float away = jp_plane_length(remaining.x, remaining.y);

    patrol->internal.step_target = (struct jp_plane_point){patrol->internal.goal.pose.x, patrol->internal.goal.pose.y};
    patrol->internal.step_clearance = clearance;
    return away > STEP_TOLERANCE &&
           (patrol->config.strategy == (uint8_t)JP_PATROL_BY_COST
                ? away < patrol->config.horizon
                : away < STEP_REACH && remaining.x > -STEP_TOLERANCE) &&
           jp_patrol_is_step_free(patrol, &step, clearance);
}

bool jp_patrol_find_step_to_goal(struct jp_patrol *patrol)
{
    return find_goal_with(patrol, jp_patrol_step_clearance(&patrol->config));
}

/* That a turn keeps, and a step where there is no other way. */
static float least_clearance(const struct jp_patrol *patrol)
{
    return jp_plane_larger(patrol->config.turn_clearance, jp_patrol_least_clearance(patrol));
}

bool jp_patrol_find_last_step(struct jp_patrol *patrol)
{
    return jp_patrol_find_step_to_goal(patrol) || find_goal_with(patrol, least_clearance(patrol));
}

bool jp_patrol_trust_path(struct jp_patrol *patrol)
{
    if (patrol->state != JP_PATROL_WAITING) {
        return true;
    }
    patrol->internal.free_cycles++;
    if (patrol->internal.free_cycles < FREE_CYCLES << patrol->internal.tries) {
        return false;
    }
    if (patrol->internal.tries < TRIES_MAX && !patrol->internal.is_yielding) {
        patrol->internal.tries++;
    }
    return true;
}

static struct jp_plane_pose step_left(const struct jp_patrol *patrol)
{
    const struct jp_plane_pose target = {patrol->internal.step_target.x, patrol->internal.step_target.y,
                                         patrol->pose.heading};

    return jp_plane_relative(&patrol->pose, &target);
}

/* Of what is left of a step, above 0. */
static void command_step(struct jp_patrol *patrol, const struct jp_plane_pose *remaining)
{
    const float away = jp_plane_length(remaining->x, remaining->y);
    const float stopping = away / (2.0f * patrol->config.period);
    const float rate = jp_plane_smaller(stopping, patrol->config.step_speed) / away;

    patrol->internal.command.forward = rate * remaining->x;
    patrol->internal.sideways = rate * remaining->y;
}

/* Who waits for people has to ask for a motion to learn that they have made way. */
void jp_patrol_begin_step(struct jp_patrol *patrol)
{
    const struct jp_plane_pose remaining = step_left(patrol);

    patrol->internal.turns_after_step = false;
    if (jp_patrol_trust_path(patrol)) {
        jp_patrol_enter(patrol, JP_PATROL_STEPPING, JP_PATROL_NONE);
    }
    jp_patrol_stand(patrol);
    if (patrol->state == JP_PATROL_STEPPING && patrol->internal.is_yielding) {
        command_step(patrol, &remaining);
    }
}

/* The wheels are steered at once. */
static void start_turn(struct jp_patrol *patrol, float angle)
{
    const float most =
        jp_plane_smaller(patrol->config.turn_acceleration * patrol->config.period, patrol->config.turn_rate);

    jp_patrol_stand(patrol);
    patrol->internal.command.turn_rate = angle < 0.0f ? -most : most;
}

static void begin_turn(struct jp_patrol *patrol, float heading, float angle)
{
    if (jp_patrol_trust_path(patrol)) {
        patrol->internal.turn_target = heading;
        patrol->internal.turn_remaining = angle;
        jp_patrol_enter(patrol, JP_PATROL_TURNING, JP_PATROL_NONE);
        start_turn(patrol, angle);
    } else {
        jp_patrol_stand(patrol);
    }
}

bool jp_patrol_turn_before_step(struct jp_patrol *patrol)
{
    const struct jp_plane_pose *const goal = &patrol->internal.goal.pose;
    const struct jp_plane_pose turned = {patrol->pose.x, patrol->pose.y, goal->heading};
    const struct jp_plane_pose remaining = jp_plane_relative(&turned, goal);
    const struct jp_plane_pose step = {remaining.x, remaining.y, 0.0f};
    const float clearance = jp_patrol_step_clearance(&patrol->config);
    float angle;

    if (patrol->config.strategy != (uint8_t)JP_PATROL_BY_COST || patrol->internal.goal.is_heading_free ||
        !jp_patrol_find_turn(patrol, &patrol->pose, goal->heading, clearance, &angle) ||
        jp_plane_magnitude(angle) <= JP_PATROL_ROUGHLY ||
        !jp_patrol_is_step_free_from(patrol, &turned, &step, clearance)) {
        return false;
    }
    begin_turn(patrol, goal->heading, angle);
    return true;
}

/* A place with room for the turn; at the goal one from where the robot then steps into it. The way there keeps as much
 * as it was found with. */
static bool find_room(struct jp_patrol *patrol, float heading, float clearance)
{
    struct jp_patrol_step_search search = {.heading = heading, .clearance = clearance};

    if (patrol->internal.is_arriving) {
        search.into = &patrol->internal.goal.pose;
        search.into_clearance = jp_patrol_step_clearance(&patrol->config);
        search.into_reach = STEP_REACH;
    }
    patrol->internal.step_clearance = jp_plane_smaller(clearance, jp_patrol_step_clearance(&patrol->config));
    return jp_patrol_find_step(patrol, &search, &patrol->internal.step_target);
}

/* The turn on the spot, else after a step to where there is room for it. */
static bool turn_with(struct jp_patrol *patrol, float heading, float clearance)
{
    float angle;

    if (jp_patrol_find_turn(patrol, &patrol->pose, heading, clearance, &angle)) {
        begin_turn(patrol, heading, angle);
        return true;
    }
    if (find_room(patrol, heading, clearance)) {
        jp_patrol_begin_step(patrol);
        return true;
    }
    return false;
}

/* Once for the braking and what follows it. */
static void count_room(struct jp_patrol *patrol)
{
    if (!patrol->internal.is_making_room) {
        patrol->internal.is_making_room = true;
        patrol->internal.rooms++;
        patrol->internal.room_next = patrol->internal.path_next;
    }
}

bool jp_patrol_make_room(struct jp_patrol *patrol, float heading, bool is_standing)
{
    const bool may = patrol->internal.is_making_room || patrol->internal.rooms < ROOMS_MAX;
    float angle;
    const bool turns = jp_patrol_find_turn(patrol, &patrol->pose, heading, JP_PATROL_CLEARANCE, &angle) &&
                       jp_plane_magnitude(angle) > JP_PATROL_ROUGHLY;

    if (!may || (!turns && !find_room(patrol, heading, JP_PATROL_CLEARANCE))) {
        return false;
    }
    jp_patrol_stand(patrol);
    count_room(patrol);
    if (is_standing && turns) {
        begin_turn(patrol, heading, angle);
    } else if (is_standing) {
        jp_patrol_begin_step(patrol);
        patrol->internal.turns_after_step = true;
        patrol->internal.turn_target = heading;
    } else {
        /* It brakes. */
    }
    return true;
}

/* The point of the path so far ahead, m, or its last one. */
static struct jp_plane_point point_ahead(const struct jp_patrol *patrol, float way)
{
    uint16_t i = patrol->internal.path_next;
    struct jp_plane_point point = jp_patrol_path_point(&patrol->internal.path[i]);

    for (float left = way; left > 0.0f && i + 1U < patrol->internal.path_count; i++) {
        const struct jp_plane_point next = jp_patrol_path_point(&patrol->internal.path[i + 1U]);

        left -= jp_plane_length(next.x - point.x, next.y - point.y);
        point = next;
    }
    return point;
}

static bool is_step_to_free(const struct jp_patrol *patrol, const struct jp_plane_pose *from,
                            const struct jp_plane_point *target, float clearance)
{
    const struct jp_plane_pose there = {target->x, target->y, from->heading};
    const struct jp_plane_pose step = jp_plane_relative(from, &there);

    return jp_plane_length(step.x, step.y) > STEP_TOLERANCE &&
           jp_patrol_is_step_free_from(patrol, from, &step, clearance);
}

/* The step along the path, with the heading as it is, such as backwards out of an aisle that is too narrow to turn in:
 * as far as the robot comes in the time for which it may wait. */
static bool find_step_along(const struct jp_patrol *patrol, const struct jp_plane_pose *from, float clearance,
                            struct jp_plane_point *target)
{
    const struct jp_patrol_config *const config = &patrol->config;
    float way = config->step_speed * config->period * (float)config->waits_max;
    bool is_found = false;

    for (unsigned i = 0; i < STEP_TRIES && !is_found; i++) {
        *target = point_ahead(patrol, way);
        is_found = is_step_to_free(patrol, from, target, clearance);
        way *= 0.5f;
    }
    return is_found;
}

/* The step back, the way that it has come, to where one along the path is free: a path is planned for a disc, which
 * gets out from between things where the robot cannot. */
static bool find_step_back(const struct jp_patrol *patrol, float clearance, struct jp_plane_point *target)
{
    bool is_found = false;

    for (unsigned i = 1; i <= STEP_BACKS && !is_found; i++) {
        const struct jp_plane_pose back = {-(float)i * STEP_BACK, 0.0f, 0.0f};
        const struct jp_plane_pose there = jp_plane_compose(&patrol->pose, &back);
        struct jp_plane_point along;

        *target = (struct jp_plane_point){there.x, there.y};
        is_found =
            jp_patrol_is_step_free(patrol, &back, clearance) && find_step_along(patrol, &there, clearance, &along);
    }
    return is_found;
}

/* Out of where there is no room to turn. */
static bool find_step_out(struct jp_patrol *patrol, float least)
{
    struct jp_patrol_internal *const self = &patrol->internal;

    if (patrol->config.strategy != (uint8_t)JP_PATROL_BY_COST || self->is_arriving) {
        return false;
    }
    self->step_clearance = jp_patrol_step_clearance(&patrol->config);
    if (find_step_along(patrol, &patrol->pose, self->step_clearance, &self->step_target)) {
        return true;
    }
    self->step_clearance = least;
    return find_step_along(patrol, &patrol->pose, least, &self->step_target) ||
           find_step_back(patrol, least, &self->step_target);
}

/* With the clearance that is wanted where there is a place with it, else with as much as there is. */
void jp_patrol_turn_to(struct jp_patrol *patrol, float heading)
{
    const float least = least_clearance(patrol);
    const float more = jp_plane_larger(patrol->config.teb.clearance - least, 0.0f);

    for (unsigned i = 0; i < TURN_TRIES; i++) {
        const float share = 1.0f - (float)i / (float)(TURN_TRIES - 1U);

        if (turn_with(patrol, heading, least + share * more)) {
            return;
        }
    }
    if ((patrol->internal.is_arriving && jp_patrol_find_last_step(patrol)) || find_step_out(patrol, least)) {
        jp_patrol_begin_step(patrol);
    } else {
        patrol->counts.infeasible++;
        jp_patrol_wait(patrol, JP_PATROL_BLOCKED);
    }
}

/* Updates the remaining angle. Of the angles to the target heading, which differ by whole turns, it is the one nearest
 * to the angle before: the turn may be the longer one of the two directions. */
static float update_turn(struct jp_patrol *patrol)
{
    const float remaining = patrol->internal.turn_target - patrol->pose.heading;

    patrol->internal.turn_remaining += jp_plane_wrap(remaining - patrol->internal.turn_remaining);
    return patrol->internal.turn_remaining;
}

static void end_turn(struct jp_patrol *patrol)
{
    jp_patrol_stand(patrol);
    jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
}

void jp_patrol_turn(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const float remaining = update_turn(patrol);
    const float angle = jp_plane_magnitude(remaining);
    const float exactly = 0.5f * config->heading_tolerance;
    const bool is_there =
        angle < (patrol->internal.is_arriving ? exactly : jp_plane_larger(exactly, JP_PATROL_ROUGHLY));

    if (is_there && jp_plane_magnitude(speed->turn_rate) < STANDSTILL_TURN_RATE) {
        end_turn(patrol);
        return;
    }
    /* An obstacle in the part of the turn that is needed to stop ends the turn. */
    const float rate_now = jp_plane_magnitude(patrol->internal.command.turn_rate);
    const float ahead = rate_now * (TURN_FORESIGHT + 0.5f * rate_now / config->turn_acceleration) + TURN_MARGIN;

    if (!jp_patrol_is_turn_free(patrol, &patrol->pose, jp_plane_clamp(remaining, -ahead, ahead),
                                least_clearance(patrol))) {
        jp_patrol_wait(patrol, JP_PATROL_BLOCKED);
        return;
    }

    const float stopping = jp_patrol_stopping_speed(config, config->turn_acceleration, angle);
    const float rising =
        jp_plane_magnitude(patrol->internal.command.turn_rate) + config->turn_acceleration * config->period;
    const float slower = stopping < config->turn_rate ? stopping : config->turn_rate;
    const float rate = is_there ? 0.0f : slower < rising ? slower : rising;

    patrol->internal.command = (struct jp_plane_speed){0.0f, remaining < 0.0f ? -rate : rate};
}

/* Turns to where the step made room for it, or drives on. */
static void end_step(struct jp_patrol *patrol)
{
    const float heading = patrol->internal.turn_target;
    float angle;

    if (patrol->internal.turns_after_step &&
        jp_patrol_find_turn(patrol, &patrol->pose, heading, JP_PATROL_CLEARANCE, &angle)) {
        begin_turn(patrol, heading, angle);
    } else {
        jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
    }
}

/* What the step keeps on its way: scans that differ do not stop it, but for the least. */
static float kept_clearance(const struct jp_patrol *patrol)
{
    const float found = patrol->internal.step_clearance;

    return jp_plane_larger(found - JP_PATROL_CLEARANCE_NOISE,
                           jp_plane_smaller(found, jp_patrol_least_clearance(patrol)));
}

void jp_patrol_step(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const struct jp_plane_pose remaining = step_left(patrol);
    const float away = jp_plane_length(remaining.x, remaining.y);

    jp_patrol_stand(patrol);
    if (patrol->internal.is_yielding && !patrol->internal.is_arriving && jp_patrol_is_standing(speed)) {
        /* Somebody was in the way of a turn, and will not be for ever: what is best is another question by then. */
        jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
    } else if (away < STEP_TOLERANCE) {
        if (jp_patrol_is_standing(speed)) {
            end_step(patrol);
        }
    } else if (!jp_patrol_is_step_free(patrol, &remaining, kept_clearance(patrol))) {
        jp_patrol_wait(patrol, JP_PATROL_BLOCKED);
    } else {
        command_step(patrol, &remaining);
    }
}
