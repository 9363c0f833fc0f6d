#include <joulepath/movers.h>

#include "src/base/plane.h"
#include "src/local/scan_runs.h"

/* Gains of the alpha-beta filter. */
#define POSITION_GAIN 0.6f
#define SPEED_GAIN    0.25f

/* Gate of the association: largest distance from the predicted place beyond what speed_max allows, m. */
#define GATE 0.15f

/* Sightings until a velocity is used, and misses until a track is dropped. */
#define SIGHTINGS_MIN 5U
#define MISSES_MAX    5U

/* The shapes of an object may extend so far beyond its radius, m. */
#define RIM 0.15f

/* s */
#define PERIOD_MIN 0.001f
#define PERIOD_MAX 10.0f

/* An object in this scan. */
struct thing {
    struct jp_plane_point centre;
    struct jp_plane_point ends[2];
    float radius;
};

static bool is_config(const struct jp_movers_config *config)
{
    return config->extent > 0.0f && config->speed_min > 0.0f &&
           jp_plane_is_between(config->speed_max, config->speed_min, JP_OBSTACLE_SPEED_MAX) &&
           jp_plane_is_between(config->margin, 0.0f, JP_OBSTACLE_MARGIN_MAX);
}

/* Whether a beam beside a run sees past it: farther away, or nothing. The ends of a scan hide what is beside them. */
static bool is_past(const struct jp_scan_view *view, unsigned beside, unsigned end)
{
    return beside < view->scan->count &&
           (!jp_scan_is_point(view, beside) || view->scan->ranges[beside] > view->scan->ranges[end]);
}

static bool find_thing(const struct jp_scan_view *view, const struct jp_scan_run *run, float extent,
                       struct thing *thing)
{
    const struct jp_plane_point begin = jp_scan_point(view, run->first);
    const struct jp_plane_point end = jp_scan_point(view, run->last);
    const float square = jp_plane_square_between(begin, end);

    if (run->points < view->config->beams_min || square > extent * extent ||
        !is_past(view, run->first - 1U, run->first) || !is_past(view, run->last + 1U, run->last)) {
        return false;
    }
    thing->centre = (struct jp_plane_point){0.5f * (begin.x + end.x), 0.5f * (begin.y + end.y)};
    thing->ends[0] = begin;
    thing->ends[1] = end;
    thing->radius = 0.5f * jp_plane_square_root(square);
    return true;
}

/* ---- Tracks ---- */

static void move_on(struct jp_plane_point *place, const struct jp_plane_point *velocity, float period)
{
    place->x += period * velocity->x;
    place->y += period * velocity->y;
}

static void predict(struct jp_movers *movers, float period)
{
    for (unsigned i = 0; i < movers->count; i++) {
        struct jp_mover *const mover = &movers->movers[i];

        move_on(&mover->centre, &mover->velocity, period);
        move_on(&mover->ends[0].place, &mover->ends[0].velocity, period);
        move_on(&mover->ends[1].place, &mover->ends[1].velocity, period);
        mover->misses++;
    }
}

/* The nearest track without an object in this scan; null when none is within the gate. */
static struct jp_mover *match(struct jp_movers *movers, const struct thing *thing, float gate)
{
    struct jp_mover *nearest = NULL;
    float least = gate * gate;

    for (unsigned i = 0; i < movers->count; i++) {
        struct jp_mover *const mover = &movers->movers[i];
        const float square = jp_plane_square_between(mover->centre, thing->centre);

        if (mover->misses > 0U && square < least) {
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

static void filter(struct jp_plane_point *place, struct jp_plane_point *velocity, struct jp_plane_point seen,
                   float period, float speed_max)
{
    const float dx = seen.x - place->x;
    const float dy = seen.y - place->y;

    place->x += POSITION_GAIN * dx;
    place->y += POSITION_GAIN * dy;
    velocity->x += SPEED_GAIN * dx / period;
    velocity->y += SPEED_GAIN * dy / period;
    *velocity = limited(*velocity, speed_max);
}

static void correct(struct jp_mover *mover, const struct thing *thing, float period, float speed_max)
{
    filter(&mover->centre, &mover->velocity, thing->centre, period, speed_max);
    for (unsigned i = 0; i < 2U; i++) {
        filter(&mover->ends[i].place, &mover->ends[i].velocity, thing->ends[i], period, speed_max);
    }
    mover->radius = thing->radius;
    mover->misses = 0;
    if (mover->sightings < UINT8_MAX) {
        mover->sightings++;
    }
}

static void follow(struct jp_movers *movers, const struct thing *thing, float period, float speed_max)
{
    struct jp_mover *const mover = match(movers, thing, GATE + period * speed_max);

    if (mover != NULL) {
        correct(mover, thing, period, speed_max);
    } else if (movers->count < JP_MOVERS_MAX) {
        movers->movers[movers->count] = (struct jp_mover){
            .centre = thing->centre,
            .ends = {{.place = thing->ends[0]}, {.place = thing->ends[1]}},
            .radius = thing->radius,
            .sightings = 1,
        };
        movers->count++;
    }
}

static void forget(struct jp_movers *movers)
{
    uint8_t kept = 0;

    for (unsigned i = 0; i < movers->count; i++) {
        if (movers->movers[i].misses <= MISSES_MAX) {
            movers->movers[kept] = movers->movers[i];
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

    if (movers == NULL || config == NULL || !is_config(config) || !(period >= PERIOD_MIN && period <= PERIOD_MAX)) {
        return JP_ERR_ARGUMENT;
    }

    const enum jp_status status = jp_scan_open(&view, scan_config, scan, sensor);

    if (status != JP_OK) {
        return status;
    }
    predict(movers, period);
    for (unsigned beam = 0; jp_scan_next_run(&view, beam, &run); beam = run.last + 1U) {
        if (find_thing(&view, &run, config->extent, &thing)) {
            follow(movers, &thing, period, config->speed_max);
        }
    }
    forget(movers);
    return JP_OK;
}

/* Whether an end goes the way of the centre. */
static bool goes_along(const struct jp_mover *mover, unsigned end, float speed, float speed_min)
{
    const struct jp_plane_point *const velocity = &mover->ends[end].velocity;

    return velocity->x * mover->velocity.x + velocity->y * mover->velocity.y > speed_min * speed;
}

static bool is_moving(const struct jp_mover *mover, float speed_min)
{
    const float speed = jp_plane_length(mover->velocity.x, mover->velocity.y);

    return mover->sightings >= SIGHTINGS_MIN && speed > speed_min && goes_along(mover, 0, speed, speed_min) &&
           goes_along(mover, 1, speed, speed_min);
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
        if (is_moving(&movers->movers[i], config->speed_min)) {
            for (unsigned k = 0; k < obstacles->count; k++) {
                mark(&movers->movers[i], config->margin, &obstacles->shapes[k]);
            }
        }
    }
}
