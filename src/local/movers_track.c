#include "src/local/movers_track.h"

#include <joulepath/count.h>
#include <string.h>

#include "src/base/plane.h"
#include "src/local/movers_walk.h"

/* Standard deviation of the middle of an object by what is seen of it, m: of one that stands free, and of one that is
 * partly hidden, by its free rim. */
#define PLACE_ERROR  0.025f
#define HIDDEN_ERROR 0.08f

/* Of somebody of whom no more was seen than a part, m. */
#define PERSON_RADIUS 0.2f

/* Of the velocity of an object that was never seen before, m/s, and of its changes, m/s²: people start and stop within
 * a step. */
#define SPEED_ERROR  1.0f
#define ACCELERATION 2.0f

/* The share by which a track takes the size over, in a scan, of what is seen of it and somebody else as one, and that
 * by which a radius follows what is measured. */
#define SHARED_SHARE 0.05f
#define RADIUS_SHARE 0.3f

/* A radius that falls by so much at once is that of another group, m. */
#define PARTED 0.1f

/* Of its velocity that is kept then. */
#define PARTED_SPEED 0.8f

/* A track that was not seen in the last scan is as good as so much farther away, m: who was hidden by somebody is not
 * who is seen now. */
#define UNSEEN 0.2f

/* Misses until a track is dropped: of an object, and of somebody who walks. */
#define MISSES_MAX        5U
#define WALKER_MISSES_MAX 24U

/* Misses that one counts as when the beams look through the place. */
#define GONE 3U

void jp_movers_predict(struct jp_movers *movers, float period)
{
    const float change = ACCELERATION * period;

    for (unsigned i = 0; i < movers->count; i++) {
        struct jp_mover *const mover = &movers->movers[i];

        mover->centre.x += period * mover->velocity.x;
        mover->centre.y += period * mover->velocity.y;
        mover->place_variance += period * (2.0f * mover->covariance + period * mover->speed_variance) +
                                 0.25f * period * period * change * change;
        mover->covariance += period * mover->speed_variance + 0.5f * period * change * change;
        mover->speed_variance += change * change;
        mover->standing += period;
        mover->misses++;
    }
}

/* From a track to an object, for the choice among tracks. */
static float square_to(const struct jp_mover *mover, const struct jp_mover_thing *thing)
{
    const float square = jp_plane_square_between(mover->centre, thing->centre);

    return mover->misses > 1U ? square + UNSEEN * UNSEEN : square;
}

struct jp_mover *jp_movers_match(struct jp_movers *movers, const struct jp_mover_thing *thing, float gate)
{
    struct jp_mover *nearest = NULL;
    float least = 0.0f;

    for (unsigned i = 0; i < movers->count; i++) {
        struct jp_mover *const mover = &movers->movers[i];
        const float square = square_to(mover, thing);

        if (mover->misses > 0U && jp_plane_square_between(mover->centre, thing->centre) < gate * gate &&
            (nearest == NULL || square < least)) {
            least = square;
            nearest = mover;
        }
    }
    return nearest;
}

static struct jp_plane_point limited(struct jp_plane_point velocity, float speed_max)
{
    const float speed = jp_plane_length(velocity.x, velocity.y);
    const float share = speed > speed_max ? speed_max / speed : 1.0f;

    return (struct jp_plane_point){share * velocity.x, share * velocity.y};
}

/* It was seen as one with somebody else, and no longer is: what is seen of it says nothing of how it moves. */
static void part(struct jp_mover *mover, const struct jp_mover_thing *thing)
{
    mover->origin.x += thing->centre.x - mover->centre.x;
    mover->origin.y += thing->centre.y - mover->centre.y;
    mover->centre = thing->centre;
    mover->velocity.x *= PARTED_SPEED;
    mover->velocity.y *= PARTED_SPEED;
    mover->own = thing->radius;
}

/* Where along what is seen of a thing the middle of an object of a radius may be, from the middle of the thing, m: at
 * one place if the thing is as large; of one that is smaller, as a box is from its other side, no rim need be the
 * object's.
 */
static void find_span(const struct jp_mover_thing *thing, float radius, float *low, float *high)
{
    const float inner = thing->radius - radius;
    const bool is_shared = inner > JP_MOVER_SHARED;

    if (jp_mover_thing_is_whole(thing)) {
        *high = jp_plane_magnitude(inner) > JP_MOVER_SHARED ? jp_plane_magnitude(inner) : 0.0f;
        *low = -*high;
    } else if (thing->is_free[0]) {
        *low = -inner;
        *high = is_shared ? inner : -inner;
    } else {
        *high = inner;
        *low = is_shared ? -inner : inner;
    }
}

/* Of an object of a radius, by what is seen of it: the place that is nearest to where it was foreseen. */
static struct jp_plane_point middle_of(const struct jp_mover_thing *thing, float radius, struct jp_plane_point foreseen)
{
    const struct jp_plane_point off = {foreseen.x - thing->centre.x, foreseen.y - thing->centre.y};
    float low;
    float high;

    find_span(thing, radius, &low, &high);

    const float along = jp_plane_clamp(off.x * thing->across.x + off.y * thing->across.y, low, high);

    return (struct jp_plane_point){thing->centre.x + along * thing->across.x,
                                   thing->centre.y + along * thing->across.y};
}

/* From where it was foreseen to where it is. Of somebody who is seen as one with others no more is known than that it
 * is among them. */
static struct jp_plane_point innovation_of(const struct jp_mover *mover, const struct jp_mover_thing *thing)
{
    const struct jp_plane_point middle = middle_of(thing, mover->own, mover->centre);
    const struct jp_plane_point way = {middle.x - mover->centre.x, middle.y - mover->centre.y};
    const float length = jp_plane_length(way.x, way.y);
    const float larger = thing->radius - mover->own;
    const float slack = larger > JP_MOVER_SHARED || (jp_mover_thing_is_whole(thing) && larger < -JP_MOVER_SHARED)
                            ? JP_MOVER_SHARED
                            : 0.0f;
    const float share = length > slack ? 1.0f - slack / length : 0.0f;

    return (struct jp_plane_point){share * way.x, share * way.y};
}

/* By which its radius alone follows that of all that is seen: of a companion, who is known to be seen with somebody
 * else, not at all. */
static float own_share(const struct jp_mover *mover, bool is_shared)
{
    if (!is_shared) {
        return RADIUS_SHARE;
    }
    return mover->is_companion ? 0.0f : SHARED_SHARE;
}

/* How large it is alone, and as it is seen: of what is partly hidden the largest part lately. */
static void take_radius(struct jp_mover *mover, const struct jp_mover_thing *thing)
{
    const float larger = thing->radius - mover->own;
    const bool is_shared = larger > JP_MOVER_SHARED;

    if (jp_mover_thing_is_whole(thing)) {
        mover->own += own_share(mover, is_shared) * larger;
        mover->radius = thing->radius;
    } else {
        mover->radius += RADIUS_SHARE * (jp_plane_larger(thing->radius, mover->own) - mover->radius);
        mover->radius = jp_plane_larger(thing->radius, mover->radius);
    }
    mover->largest = jp_plane_larger(mover->radius, mover->largest);
    mover->alone = is_shared ? 0U : jp_one_more8(mover->alone);
    mover->misses = 0;
}

void jp_mover_correct(struct jp_mover *mover, const struct jp_mover_thing *thing, float speed_max)
{
    const float error = jp_mover_thing_is_whole(thing) ? PLACE_ERROR : HIDDEN_ERROR;
    const float inverse = 1.0f / (mover->place_variance + error * error);
    const float place_gain = mover->place_variance * inverse;
    const float speed_gain = mover->covariance * inverse;

    if (jp_mover_thing_is_whole(thing) && mover->own - thing->radius > PARTED) {
        part(mover, thing);
        take_radius(mover, thing);
        return;
    }

    const struct jp_plane_point way = innovation_of(mover, thing);

    mover->centre.x += place_gain * way.x;
    mover->centre.y += place_gain * way.y;
    mover->velocity.x += speed_gain * way.x;
    mover->velocity.y += speed_gain * way.y;
    mover->velocity = limited(mover->velocity, speed_max);
    mover->speed_variance -= speed_gain * mover->covariance;
    mover->covariance -= place_gain * mover->covariance;
    mover->place_variance -= place_gain * mover->place_variance;
    take_radius(mover, thing);
    mover->sightings = jp_one_more8(mover->sightings);
}

/* The place of a new track: a free one, else that of the farthest thing that never walked, if it is farther than the
 * new one; null: there is none. */
static struct jp_mover *place_for(struct jp_movers *movers, const struct jp_mover_thing *thing,
                                  struct jp_plane_point sensor)
{
    struct jp_mover *place = NULL;
    float farthest = jp_plane_square_between(thing->centre, sensor);

    if (movers->count < JP_MOVERS_MAX) {
        movers->count++;
        return &movers->movers[movers->count - 1U];
    }
    for (unsigned i = 0; i < movers->count; i++) {
        const float square = jp_plane_square_between(movers->movers[i].centre, sensor);

        if (!jp_mover_has_walked(&movers->movers[i]) && square > farthest) {
            farthest = square;
            place = &movers->movers[i];
        }
    }
    return place;
}

void jp_movers_begin(struct jp_movers *movers, const struct jp_mover_thing *thing, struct jp_plane_point sensor)
{
    const struct jp_mover *const beside = jp_movers_companion(movers, thing);
    struct jp_mover track = {.speed_variance = SPEED_ERROR * SPEED_ERROR};

    if (beside != NULL) {
        track = *beside;
    }
    track.is_companion = beside != NULL;
    track.has_come = thing->has_come;
    track.own = jp_mover_thing_is_whole(thing) ? thing->radius : jp_plane_larger(thing->radius, PERSON_RADIUS);
    track.centre = middle_of(thing, track.own, thing->centre);
    track.origin = track.centre;
    track.radius = thing->radius;
    track.largest = thing->radius;
    track.seen_from = sensor;
    (void)memcpy(track.seen, thing->seen, sizeof track.seen);
    track.place_variance = PLACE_ERROR * PLACE_ERROR;
    track.covariance = 0.0f;
    track.standing = 0.0f;
    track.stood = track.centre;
    track.sightings = 1;
    track.alone = 1;
    track.misses = 0;

    struct jp_mover *const place = place_for(movers, thing, sensor);

    if (place != NULL) {
        *place = track;
    }
}

/* Whether a beam looks through the place of an object. */
static bool is_seen_through(const struct jp_scan_view *view, const struct jp_mover *mover)
{
    const float distance = jp_plane_length(mover->centre.x - view->first.x, mover->centre.y - view->first.y);
    const uint32_t beam = jp_scan_beam_towards(view, mover->centre);

    return beam < view->scan->count && jp_scan_reaches(view, beam, distance + mover->radius);
}

void jp_movers_miss(struct jp_movers *movers, const struct jp_scan_view *view)
{
    for (unsigned i = 0; i < movers->count; i++) {
        struct jp_mover *const mover = &movers->movers[i];

        if (mover->misses > 0U && is_seen_through(view, mover)) {
            mover->misses = (uint8_t)(mover->misses + GONE - 1U);
        }
    }
}

void jp_movers_forget(struct jp_movers *movers)
{
    uint8_t kept = 0;

    for (unsigned i = 0; i < movers->count; i++) {
        const struct jp_mover *const mover = &movers->movers[i];

        if (mover->misses <= (jp_mover_has_walked(mover) ? WALKER_MISSES_MAX : MISSES_MAX)) {
            movers->movers[kept] = *mover;
            kept++;
        }
    }
    movers->count = kept;
}
