#include <joulepath/count.h>
#include <joulepath/movers.h>
#include <string.h>

#include "src/base/plane.h"
#include "src/local/scan_runs.h"

/* Standard deviation of the middle of an object by what is seen of it, m: of one that stands free, and of one that is
 * partly hidden, by its free rim. */
#define PLACE_ERROR  0.025f
#define HIDDEN_ERROR 0.08f

/* Of somebody of whom no more was seen than a part, m. */
#define PERSON_RADIUS 0.2f

/* Nobody alone is larger, m. */
#define PERSON_MAX 0.35f

/* Of the velocity of an object that was never seen before, m/s, and of its changes, m/s²: people start and stop within
 * a step. */
#define SPEED_ERROR  1.0f
#define ACCELERATION 2.0f

/* A walker is faster than so many standard deviations of its velocity along an axis; one that has left its place, too,
 * than so many. */
#define SIGNIFICANT 2.5f
#define LIKELY      1.5f

/* From a beam to the one before it; unsigned numbers wrap. */
#define BACK 0xFFFFFFFFU

/* Sightings until it can be said to walk. */
#define SIGHTINGS_MIN 4U

/* Gate of the association: largest distance from the predicted place beyond what speed_max allows, m. */
#define GATE 0.15f

/* An object that appears so near beside somebody who walks goes with them, m. */
#define TOGETHER 0.5f

/* After so many sightings it is known whether it does. */
#define COMPANION_SIGHTINGS 10U

/* What is seen is larger than a track by so much: somebody else is seen with it as one, m. The share by which the track
 * takes that size over in a scan, and that by which a radius follows what is measured. */
#define SHARED       0.05f
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

/* Share by which the direction of a walk follows what is measured. */
#define WALK_SHARE 0.3f

/* By which a pace falls to what is measured: who slows down may speed up again. */
#define PACE_SHARE 0.02f

/* What is seen of a thing that stands shifts by less than this share of its radius, and so many m more. */
#define SIZE_SHARE 0.8f
#define LEFT       0.1f

/* A beam that ends so far behind a place, or a place so far before what was seen, is beyond what pose and laser err by,
 * m. */
#define CLEARLY 0.15f

/* As much farther away a surface may go on than its last two points say, which err by centimetres. */
#define STEEPER 1.5f

/* A shorter run is a point, m. */
#define LEAST 1.0e-4f

/* Which tell how a surface goes on. */
#define POINTS_MIN 2U

/* Misses that one counts as when the beams look through the place. */
#define GONE 3U

/* The shapes of an object may extend so far beyond its radius, m. */
#define RIM 0.15f

/* m */
#define RANGE_MIN 0.001f
#define RANGE_MAX 1000.0f

/* s */
#define PERIOD_MIN 0.001f
#define PERIOD_MAX 10.0f

/* After a longer period nobody is known again, s. */
#define STALE 0.5f

/* An object in this scan. */
struct thing {
    struct jp_plane_point centre;
    float radius;
    struct jp_plane_point across;                /* from its right end to the left one, of length 1 */
    bool is_free[2];                             /* on the right, on the left */
    struct jp_plane_point seen[JP_MOVER_POINTS]; /* of its surface, from right to left */
};

static bool is_config(const struct jp_movers_config *config)
{
    return config->extent > 0.0f && config->speed_min > 0.0f &&
           jp_plane_is_between(config->range, RANGE_MIN, RANGE_MAX) &&
           jp_plane_is_between(config->speed_max, config->speed_min, JP_OBSTACLE_SPEED_MAX) &&
           jp_plane_is_between(config->margin, 0.0f, JP_OBSTACLE_MARGIN_MAX);
}

/* Whether the surface that ends at a beam may go on beyond the next one that works: a wall along which the scanner
 * looks has no rim where its points lie far apart. The beam meets the line through the last two points at some range,
 * or never; one that ends clearly behind it has passed it. */
static bool may_go_on(const struct jp_scan_view *view, unsigned end, unsigned step, float range)
{
    unsigned inner = end - step;

    while (!jp_scan_is_point(view, inner)) {
        inner -= step;
    }

    const struct jp_plane_point from = jp_scan_point(view, inner);
    const struct jp_plane_point rim = jp_scan_point(view, end);
    const struct jp_plane_point beam =
        jp_plane_direction(view->first.heading + (float)(end + step) * view->scan->angle_step);
    const struct jp_plane_point along = {rim.x - from.x, rim.y - from.y};
    const float nearing = beam.x * along.y - beam.y * along.x;
    const float away = (rim.x - view->first.x) * along.y - (rim.y - view->first.y) * along.x;
    const float beyond = range - view->scan->ranges[end] - CLEARLY;

    /* Both sides times `nearing`, above 0 where the beam meets the line in front of the sensor. */
    return nearing * away <= 0.0f ||
           beyond * jp_plane_magnitude(nearing) <=
               STEEPER * (jp_plane_magnitude(away) - view->scan->ranges[end] * jp_plane_magnitude(nearing));
}

/* Whether the next beam beside a run that works, in the direction of a step, sees past it: farther away, or nothing.
 * The ends of a scan hide what is beside them. */
static bool is_past(const struct jp_scan_view *view, unsigned end, unsigned step)
{
    unsigned beside = end + step;

    while (beside < view->scan->count && !(view->scan->ranges[beside] >= 0.0f)) {
        beside += step;
    }
    if (beside >= view->scan->count) {
        return false;
    }

    const float range = jp_scan_is_point(view, beside) ? view->scan->ranges[beside] : view->config->range_max;

    return range > view->scan->ranges[end] && !may_go_on(view, end, step, range);
}

/* Evenly within it. */
static void take_points(const struct jp_scan_view *view, const struct jp_scan_run *run,
                        struct jp_plane_point points[JP_MOVER_POINTS])
{
    for (unsigned i = 0; i < JP_MOVER_POINTS; i++) {
        unsigned beam = run->first + (i + 1U) * (run->last - run->first) / (JP_MOVER_POINTS + 1U);

        while (!jp_scan_is_point(view, beam)) {
            beam++;
        }
        points[i] = jp_scan_point(view, beam);
    }
}

/* Along what is seen of a thing; nowhere where that is a point. */
static struct jp_plane_point across_of(struct jp_plane_point first, struct jp_plane_point last)
{
    const float length = jp_plane_larger(jp_plane_length(last.x - first.x, last.y - first.y), LEAST);

    return (struct jp_plane_point){(last.x - first.x) / length, (last.y - first.y) / length};
}

static bool find_thing(const struct jp_scan_view *view, const struct jp_scan_run *run, float extent,
                       struct thing *thing)
{
    const struct jp_plane_point first = jp_scan_point(view, run->first);
    const struct jp_plane_point last = jp_scan_point(view, run->last);
    const float square = jp_plane_square_between(first, last);

    if (run->points < view->config->beams_min || run->points < POINTS_MIN || square > extent * extent) {
        return false;
    }
    thing->is_free[0] = is_past(view, run->first, BACK);
    thing->is_free[1] = is_past(view, run->last, 1U);
    if (!thing->is_free[0] && !thing->is_free[1]) {
        return false;
    }
    thing->centre = (struct jp_plane_point){0.5f * (first.x + last.x), 0.5f * (first.y + last.y)};
    thing->radius = 0.5f * jp_plane_square_root(square);
    thing->across = across_of(first, last);
    take_points(view, run, thing->seen);
    return true;
}

static bool is_whole(const struct thing *thing)
{
    return thing->is_free[0] && thing->is_free[1];
}

/* ---- Tracks ---- */

static bool has_walked(const struct jp_mover *mover)
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

static void predict(struct jp_movers *movers, float period)
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
static float square_to(const struct jp_mover *mover, const struct thing *thing)
{
    const float square = jp_plane_square_between(mover->centre, thing->centre);

    return mover->misses > 1U ? square + UNSEEN * UNSEEN : square;
}

/* The nearest track without an object in this scan; null when none is within the gate. */
static struct jp_mover *match(struct jp_movers *movers, const struct thing *thing, float gate)
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
static void part(struct jp_mover *mover, const struct thing *thing)
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
static void find_span(const struct thing *thing, float radius, float *low, float *high)
{
    const float inner = thing->radius - radius;
    const bool is_shared = inner > SHARED;

    if (is_whole(thing)) {
        *high = jp_plane_magnitude(inner) > SHARED ? jp_plane_magnitude(inner) : 0.0f;
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
static struct jp_plane_point middle_of(const struct thing *thing, float radius, struct jp_plane_point foreseen)
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
static struct jp_plane_point innovation_of(const struct jp_mover *mover, const struct thing *thing)
{
    const struct jp_plane_point middle = middle_of(thing, mover->own, mover->centre);
    const struct jp_plane_point way = {middle.x - mover->centre.x, middle.y - mover->centre.y};
    const float length = jp_plane_length(way.x, way.y);
    const float larger = thing->radius - mover->own;
    const float slack = larger > SHARED || (is_whole(thing) && larger < -SHARED) ? SHARED : 0.0f;
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
static void take_radius(struct jp_mover *mover, const struct thing *thing)
{
    const float larger = thing->radius - mover->own;
    const bool is_shared = larger > SHARED;

    if (is_whole(thing)) {
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

static void correct(struct jp_mover *mover, const struct thing *thing, float speed_max)
{
    const float error = is_whole(thing) ? PLACE_ERROR : HIDDEN_ERROR;
    const float inverse = 1.0f / (mover->place_variance + error * error);
    const float place_gain = mover->place_variance * inverse;
    const float speed_gain = mover->covariance * inverse;

    if (is_whole(thing) && mover->own - thing->radius > PARTED) {
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

/* Farther than what is seen of a thing that stands shifts as the robot moves. */
static bool has_left(const struct jp_mover *mover)
{
    const float reach = SIZE_SHARE * mover->largest + LEFT;

    return jp_plane_square_between(mover->centre, mover->origin) > reach * reach;
}

/* The beam towards a place; may be beyond those of the scan. */
static uint32_t beam_towards(const struct jp_scan_view *view, struct jp_plane_point place)
{
    const float bearing = jp_plane_bearing(place.x - view->first.x, place.y - view->first.y);
    const float angle = jp_plane_wrap(bearing - view->first.heading);
    const float turned = angle < 0.0f ? angle + 2.0f * JP_PLANE_PI : angle;

    return (uint32_t)(turned / view->scan->angle_step);
}

/* One that saw nothing tells no more than that nothing is within range. */
static bool reaches(const struct jp_scan_view *view, uint32_t beam, float distance)
{
    const float range = view->scan->ranges[beam] == 0.0f ? view->config->range_max : view->scan->ranges[beam];

    return range > distance && jp_plane_is_finite(range);
}

/* Whether what was at a place has gone: the beams on both sides of it end clearly behind it. */
static bool is_empty(const struct jp_scan_view *view, struct jp_plane_point place)
{
    const float distance = jp_plane_length(place.x - view->first.x, place.y - view->first.y) + CLEARLY;
    const uint32_t beam = beam_towards(view, place);

    return beam + 1U < view->scan->count && reaches(view, beam, distance) && reaches(view, beam + 1U, distance);
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
           turn_of(right, left, place) > CLEARLY * chord;
}

/* Whether it is where nothing was, or nothing is where it was. What is seen of a thing that stands may shift as the
 * robot moves, but the place of what was seen stays taken, and that which the beams went through stays empty. */
static bool has_changed_place(const struct jp_mover *mover, const struct thing *thing, const struct jp_scan_view *view)
{
    for (unsigned i = 0; i < JP_MOVER_POINTS; i++) {
        if (is_empty(view, mover->seen[i])) {
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
static bool is_steady(const struct jp_mover *mover, const struct thing *thing)
{
    return thing->radius < PERSON_MAX || (is_whole(thing) && mover->own - thing->radius < SHARED);
}

/* Who was taken for one who walks because somebody else does stands, if it is no faster than a thing once it has been
 * seen alone often enough to tell. */
static void judge_companion(struct jp_mover *mover, const struct jp_movers_config *config)
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

/* Who has walked, or is where nothing was, or no longer where they were. */
static bool may_walk(const struct jp_mover *mover, const struct jp_movers_config *config, const struct thing *thing,
                     const struct jp_scan_view *view)
{
    if (has_walked(mover)) {
        return jp_mover_is_walking(mover, config);
    }
    return is_faster(mover, config, LIKELY) && is_steady(mover, thing) && has_left(mover) &&
           has_changed_place(mover, thing, view);
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

/* Remembers how it walks, if it does. */
static void note_walk(struct jp_mover *mover, const struct jp_movers_config *config, const struct thing *thing,
                      const struct jp_scan_view *view)
{
    const float speed = speed_of(mover);

    if (mover->sightings >= SIGHTINGS_MIN && may_walk(mover, config, thing, view)) {
        const float share = has_walked(mover) ? WALK_SHARE : 1.0f;

        take_direction(mover, speed, share);
        mover->pace += (speed > mover->pace ? share : PACE_SHARE) * (speed - mover->pace);
        if (walks_on(mover)) {
            mover->standing = 0.0f;
            mover->stood = mover->centre;
        }
    }
}

/* Who walks beside a place, in a group that was seen as one; null: nobody. */
static const struct jp_mover *companion(const struct jp_movers *movers, const struct thing *thing)
{
    for (unsigned i = 0; i < movers->count; i++) {
        const struct jp_mover *const mover = &movers->movers[i];
        const float reach = mover->radius + thing->radius + TOGETHER;

        if (has_walked(mover) && jp_plane_square_between(mover->centre, thing->centre) < reach * reach) {
            return mover;
        }
    }
    return NULL;
}

/* The place of a new track: a free one, else that of the farthest thing that never walked, if it is farther than the
 * new one; null: there is none. */
static struct jp_mover *place_for(struct jp_movers *movers, const struct thing *thing, struct jp_plane_point sensor)
{
    struct jp_mover *place = NULL;
    float farthest = jp_plane_square_between(thing->centre, sensor);

    if (movers->count < JP_MOVERS_MAX) {
        movers->count++;
        return &movers->movers[movers->count - 1U];
    }
    for (unsigned i = 0; i < movers->count; i++) {
        const float square = jp_plane_square_between(movers->movers[i].centre, sensor);

        if (!has_walked(&movers->movers[i]) && square > farthest) {
            farthest = square;
            place = &movers->movers[i];
        }
    }
    return place;
}

static void begin(struct jp_movers *movers, const struct thing *thing, struct jp_plane_point sensor)
{
    const struct jp_mover *const beside = companion(movers, thing);
    struct jp_mover track = {.speed_variance = SPEED_ERROR * SPEED_ERROR};

    if (beside != NULL) {
        track = *beside;
    }
    track.is_companion = beside != NULL;
    track.own = is_whole(thing) ? thing->radius : jp_plane_larger(thing->radius, PERSON_RADIUS);
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

static void follow(struct jp_movers *movers, const struct jp_movers_config *config, const struct thing *thing,
                   const struct jp_scan_view *view, float period)
{
    const struct jp_plane_point sensor = {view->first.x, view->first.y};
    struct jp_mover *const mover = match(movers, thing, GATE + period * config->speed_max);

    if (mover != NULL) {
        correct(mover, thing, config->speed_max);
        judge_companion(mover, config);
        note_walk(mover, config, thing, view);
    } else {
        begin(movers, thing, sensor);
    }
}

/* Whether a beam looks through the place of an object. */
static bool is_seen_through(const struct jp_scan_view *view, const struct jp_mover *mover)
{
    const float distance = jp_plane_length(mover->centre.x - view->first.x, mover->centre.y - view->first.y);
    const uint32_t beam = beam_towards(view, mover->centre);

    return beam < view->scan->count && reaches(view, beam, distance + mover->radius);
}

/* Whether somebody who walks is no longer seen because they are seen as one with somebody who stands. */
static bool is_with(const struct jp_mover *walker, const struct jp_mover *stander)
{
    const float reach = stander->radius + walker->own;

    return walker->misses > 0U && has_walked(walker) && stander->misses == 0U && stander->alone == 0U &&
           !has_walked(stander) && stander->own < PERSON_MAX &&
           jp_plane_square_between(walker->centre, stander->centre) < reach * reach;
}

/* What is seen of them together remembers how they walk: who walks out of it on any side is then known. */
static void join(struct jp_movers *movers)
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

static void miss(struct jp_movers *movers, const struct jp_scan_view *view)
{
    for (unsigned i = 0; i < movers->count; i++) {
        struct jp_mover *const mover = &movers->movers[i];

        if (mover->misses > 0U && is_seen_through(view, mover)) {
            mover->misses = (uint8_t)(mover->misses + GONE - 1U);
        }
    }
}

static void forget(struct jp_movers *movers)
{
    uint8_t kept = 0;

    for (unsigned i = 0; i < movers->count; i++) {
        const struct jp_mover *const mover = &movers->movers[i];

        if (mover->misses <= (has_walked(mover) ? WALKER_MISSES_MAX : MISSES_MAX)) {
            movers->movers[kept] = *mover;
            kept++;
        }
    }
    movers->count = kept;
}

/* ---- Calls ---- */

void jp_movers_clear(struct jp_movers *movers)
{
    movers->count = 0;
}

enum jp_status jp_movers_update(struct jp_movers *movers, const struct jp_movers_config *config,
                                const struct jp_scan_config *scan_config, const struct jp_scan *scan,
                                const struct jp_plane_pose *sensor, float period)
{
    struct jp_scan_view view;
    struct jp_scan_run run;
    struct thing thing;

    if (movers == NULL || config == NULL || scan_config == NULL || !is_config(config) ||
        !(period >= PERIOD_MIN && period <= PERIOD_MAX)) {
        return JP_ERR_ARGUMENT;
    }

    struct jp_scan_config far_config = *scan_config;

    far_config.range_max = config->range;

    const enum jp_status status = jp_scan_open(&view, &far_config, scan, sensor);

    if (status != JP_OK) {
        return status;
    }
    if (period > STALE) {
        jp_movers_clear(movers);
    }
    predict(movers, period);
    for (unsigned beam = 0; jp_scan_next_run(&view, beam, &run); beam = run.last + 1U) {
        if (find_thing(&view, &run, config->extent, &thing)) {
            follow(movers, config, &thing, &view, period);
        }
    }
    join(movers);
    miss(movers, &view);
    forget(movers);
    return JP_OK;
}

/* Gives the mover's velocity to a shape that lies within it; the walls beside it are longer. */
static void mark(const struct jp_mover *mover, float margin, struct jp_obstacle *shape)
{
    const struct jp_plane_point *const last = &shape->vertices[shape->vertex_count - 1U];
    const struct jp_plane_point middle = {0.5f * (shape->vertices[0].x + last->x),
                                          0.5f * (shape->vertices[0].y + last->y)};
    const float reach = mover->radius + RIM;

    if (jp_plane_square_between(middle, mover->centre) < reach * reach &&
        jp_plane_square_between(middle, *last) < reach * reach) {
        shape->velocity = mover->velocity;
        shape->margin = margin;
    }
}

void jp_movers_mark(const struct jp_movers *movers, const struct jp_movers_config *config,
                    struct jp_obstacles *obstacles)
{
    for (unsigned i = 0; i < movers->count; i++) {
        if (has_walked(&movers->movers[i]) && jp_mover_is_walking(&movers->movers[i], config)) {
            for (unsigned k = 0; k < obstacles->count; k++) {
                mark(&movers->movers[i], config->margin, &obstacles->shapes[k]);
            }
        }
    }
}
