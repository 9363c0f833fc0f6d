#include "sim/scenes/walker.h"

#include <math.h>

#include "sim/base/strict_math.h"

/* Whoever is slower, for a robot that shifts as it stands, has not gone on, m/s. */
#define PUSHING 0.1

static double length_of(const struct walker *walker)
{
    return strict_hypot(walker->to.x - walker->from.x, walker->to.y - walker->from.y);
}

void walker_begin(const struct walker *walker, struct walker_state *state)
{
    *state = (struct walker_state){.direction = 1, .rests_until = walker->starts};
}

/* Along its direction to the end of the line. */
static double way_left(const struct walker *walker, const struct walker_state *state)
{
    return state->direction > 0 ? length_of(walker) - state->along : state->along;
}

static bool must_stop_for_end(const struct walker *walker, const struct walker_state *state)
{
    return way_left(walker, state) <= state->speed * state->speed / (2 * WALKER_ACCELERATION);
}

static bool is_act_due(const struct walker *walker, const struct walker_state *state)
{
    return state->act < walker->act_count && state->time >= walker->acts[state->act].time;
}

static void turn_round(struct walker_state *state)
{
    state->direction = -state->direction;
    state->since = state->time;
}

/* Stands now: what comes next. */
static void rest(const struct walker *walker, struct walker_state *state)
{
    state->speed = 0;
    state->is_slowing = false;
    if (is_act_due(walker, state)) {
        const struct walker_act *act = &walker->acts[state->act++];

        state->rests_until = state->time + act->rest;
        if (act->turns) {
            turn_round(state);
        }
    } else if (!walker->stays || state->direction < 0) {
        state->rests_until = state->time + walker->pause;
        turn_round(state);
    } else {
        state->rests_until = INFINITY;
    }
}

static void slow_down(const struct walker *walker, struct walker_state *state, double seconds)
{
    const double speed = fabs(state->speed) - WALKER_ACCELERATION * seconds;

    if (!state->is_slowing) {
        state->is_slowing = true;
        state->since = state->time;
    }
    if (speed <= 0) {
        rest(walker, state);
    } else {
        state->speed = state->direction * speed;
    }
}

static void speed_up(const struct walker *walker, struct walker_state *state, double seconds)
{
    const double speed = fabs(state->speed) + WALKER_ACCELERATION * seconds;

    if (state->speed == 0) {
        state->since = state->time;
    }
    state->speed = state->direction * fmin(speed, walker->speed);
}

struct walker_state walker_next(const struct walker *walker, const struct walker_state *state, double seconds)
{
    struct walker_state next = *state;
    const double before = state->speed;

    next.time += seconds;
    if (next.time < next.rests_until) {
        return next;
    }
    if (must_stop_for_end(walker, &next) || is_act_due(walker, &next)) {
        slow_down(walker, &next, seconds);
    } else {
        speed_up(walker, &next, seconds);
    }
    next.along = fmin(fmax(next.along + (before + next.speed) / 2 * seconds, 0), length_of(walker));
    next.blocked = fabs(next.speed) > PUSHING ? 0 : next.blocked;
    return next;
}

struct walker_state walker_blocked(const struct walker_state *state, double seconds)
{
    struct walker_state next = *state;

    next.time += seconds;
    next.speed = 0;
    next.is_slowing = false;
    next.blocked += seconds;
    if (next.blocked >= WALKER_PATIENCE) {
        next.blocked = 0;
        turn_round(&next);
    }
    return next;
}

static struct planar_point direction_of(const struct walker *walker)
{
    const double length = length_of(walker);

    return (struct planar_point){(walker->to.x - walker->from.x) / length, (walker->to.y - walker->from.y) / length};
}

struct planar_point walker_place(const struct walker *walker, const struct walker_state *state)
{
    const struct planar_point along = direction_of(walker);

    return (struct planar_point){walker->from.x + state->along * along.x, walker->from.y + state->along * along.y};
}

struct planar_point walker_velocity(const struct walker *walker, const struct walker_state *state)
{
    const struct planar_point along = direction_of(walker);

    return (struct planar_point){state->speed * along.x, state->speed * along.y};
}
