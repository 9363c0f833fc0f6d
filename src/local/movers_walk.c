#include "src/local/movers_walk.h"

#include <stddef.h>

#include "src/base/plane.h"

/* Nobody alone is larger, m. */
#define PERSON_MAX 0.35f

/* A walker is faster than so many standard deviations of its velocity along an axis; one that has left its place, too,
 * than so many. */
#define SIGNIFICANT 2.5f
#define LIKELY      1.5f

/* Sightings until it can be said to walk. */
#define SIGHTINGS_MIN 4U

/* An object that appears so near beside somebody who walks goes with them, m. */
#define TOGETHER 0.5f

/* After so many sightings it is known whether it does. */
#define COMPANION_SIGHTINGS 10U

/* Share by which the direction of a walk follows what is measured. */
#define WALK_SHARE 0.3f

/* By which a pace falls to what is measured: who slows down may speed up again. */
#define PACE_SHARE 0.02f

/* What is seen of a thing that stands shifts by less than this share of its radius, and so many m more. */
#define SIZE_SHARE 0.8f
#define LEFT       0.1f

bool jp_mover_has_walked(const struct jp_mover *mover)
{
    return mover->pace > 0.0f;
}

static float speed_of(const struct jp_mover *mover)
{
    return jp_plane_length(mover->velocity.x, mover->velocity.y);
}

/* Than things are, and than so many standard deviations. */
static bool is_faster(const struct jp_mover *mover, const struct jp_movers_config *config, float deviations)
{
    const float speed = speed_of(mover);

    return speed > config->speed_min && speed * speed > deviations * deviations * mover->speed_variance;
}

bool jp_mover_is_walking(const struct jp_mover *mover, const struct jp_movers_config *config)
{
    return is_faster(mover, config, SIGNIFICANT);
}

/* Farther than what is seen of a thing that stands shifts as the robot moves. */
static bool has_left(const struct jp_mover *mover)
{
    const float reach = SIZE_SHARE * mover->largest + LEFT;

    return jp_plane_square_between(mover->centre, mover->origin) > reach * reach;
}

/* Twice the area of the triangle; above 0 where its corners turn to the left. */
static float turn_of(struct jp_plane_point a, struct jp_plane_point b, struct jp_plane_point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Whether a place lies between a sensor and the chord of what it saw from right to left, clearly before the chord. */
static bool is_before(struct jp_plane_point sensor, struct jp_plane_point right, struct jp_plane_point left,
                      struct jp_plane_point place)
{
    const float chord = jp_plane_length(left.x - right.x, left.y - right.y);

    return turn_of(sensor, right, place) >= 0.0f && turn_of(sensor, place, left) >= 0.0f &&
           turn_of(right, left, place) > JP_MOVER_CLEARLY * chord;
}

/* Whether it is where nothing was, or nothing is where it was. What is seen of a thing that stands may shift as the
 * robot moves, but the place of what was seen stays taken, and that which the beams went through stays empty. */
static bool has_changed_place(const struct jp_mover *mover, const struct jp_mover_thing *thing,
                              const struct jp_scan_view *view)
{
    for (unsigned i = 0; i < JP_MOVER_POINTS; i++) {
        if (jp_mover_is_empty(view, mover->seen[i])) {
            return true;
        }
        for (unsigned k = 1; k < JP_MOVER_POINTS; k++) {
            if (is_before(mover->seen_from, mover->seen[k - 1U], mover->seen[k], thing->seen[i])) {
                return true;
            }
        }
    }
    return false;
}

/* Whether all of something is seen, and no less than before: of what is larger than a person one side may go out of
 * sight as another one comes. */
static bool is_steady(const struct jp_mover *mover, const struct jp_mover_thing *thing)
{
    return thing->radius < PERSON_MAX ||
           (jp_mover_thing_is_whole(thing) && mover->own - thing->radius < JP_MOVER_SHARED);
}

void jp_mover_judge_companion(struct jp_mover *mover, const struct jp_movers_config *config)
{
    if (mover->is_companion && mover->alone >= COMPANION_SIGHTINGS) {
        if (jp_mover_is_walking(mover, config) || has_left(mover)) {
            mover->is_companion = false;
        } else if (speed_of(mover) < config->speed_min) {
            mover->is_companion = false;
            mover->pace = 0.0f;
            mover->walk = (struct jp_plane_point){0.0f, 0.0f};
        }
    }
}

/* Who has walked, or is where nothing was, or no longer where they were. Several who walk side by side shift as one
 * before the other, but all of them come to where nothing was. */
static bool may_walk(const struct jp_mover *mover, const struct jp_movers_config *config,
                     const struct jp_mover_thing *thing, const struct jp_scan_view *view)
{
    if (jp_mover_has_walked(mover)) {
        return jp_mover_is_walking(mover, config);
    }
    return is_faster(mover, config, LIKELY) &&
           (thing->has_come || (is_steady(mover, thing) && has_left(mover) && has_changed_place(mover, thing, view)));
}

/* Who turns round walks in the other direction at once, and at no time across their line. */
static void take_direction(struct jp_mover *mover, float speed, float share)
{
    const bool has_turned = mover->velocity.x * mover->walk.x + mover->velocity.y * mover->walk.y < 0.0f;
    const float kept = has_turned ? share - 1.0f : 1.0f - share;
    const float x = kept * mover->walk.x + share * mover->velocity.x / speed;
    const float y = kept * mover->walk.y + share * mover->velocity.y / speed;
    const float length = jp_plane_length(x, y);

    mover->walk = (struct jp_plane_point){x / length, y / length};
}

/* Whether who was seen to move does walk: what is seen of several who stand together shifts as they do in their places.
 */
static bool walks_on(const struct jp_mover *mover)
{
    const float reach = SIZE_SHARE * mover->radius + LEFT;

    return mover->radius < PERSON_MAX || jp_plane_square_between(mover->centre, mover->stood) > reach * reach;
}

void jp_mover_note_walk(struct jp_mover *mover, const struct jp_movers_config *config,
                        const struct jp_mover_thing *thing, const struct jp_scan_view *view)
{
    const float speed = speed_of(mover);

    if (mover->sightings >= SIGHTINGS_MIN && may_walk(mover, config, thing, view)) {
        const float share = jp_mover_has_walked(mover) ? WALK_SHARE : 1.0f;

        take_direction(mover, speed, share);
        mover->pace += (speed > mover->pace ? share : PACE_SHARE) * (speed - mover->pace);
        if (walks_on(mover)) {
            mover->standing = 0.0f;
            mover->stood = mover->centre;
        }
    }
}

const struct jp_mover *jp_movers_companion(const struct jp_movers *movers, const struct jp_mover_thing *thing)
{
    for (unsigned i = 0; i < movers->count; i++) {
        const struct jp_mover *const mover = &movers->movers[i];
        const float reach = mover->radius + thing->radius + TOGETHER;

        if (jp_mover_has_walked(mover) && jp_plane_square_between(mover->centre, thing->centre) < reach * reach) {
            return mover;
        }
    }
    return NULL;
}

/* Whether somebody who walks is no longer seen because they are seen as one with somebody who stands. */
static bool is_with(const struct jp_mover *walker, const struct jp_mover *stander)
{
    const float reach = stander->radius + walker->own;

    return walker->misses > 0U && jp_mover_has_walked(walker) && stander->misses == 0U && stander->alone == 0U &&
           !jp_mover_has_walked(stander) && stander->own < PERSON_MAX &&
           jp_plane_square_between(walker->centre, stander->centre) < reach * reach;
}

void jp_movers_join(struct jp_movers *movers)
{
    for (unsigned i = 0; i < movers->count; i++) {
        for (unsigned k = 0; k < movers->count; k++) {
            const struct jp_mover *const walker = &movers->movers[i];
            struct jp_mover *const stander = &movers->movers[k];

            if (is_with(walker, stander)) {
                stander->walk = walker->walk;
                stander->pace = walker->pace;
                stander->standing = 0.0f;
                stander->is_companion = true;
            }
        }
    }
}
