#include <joulepath/movers.h>

#include "src/base/plane.h"
#include "src/local/movers_past.h"
#include "src/local/movers_track.h"
#include "src/local/movers_walk.h"

/* Gate of the association: largest distance from the predicted place beyond what speed_max allows, m. */
#define GATE 0.15f

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

static bool is_config(const struct jp_movers_config *config)
{
    return config->extent > 0.0f && config->speed_min > 0.0f &&
           jp_plane_is_between(config->range, RANGE_MIN, RANGE_MAX) &&
           jp_plane_is_between(config->speed_max, config->speed_min, JP_OBSTACLE_SPEED_MAX) &&
           jp_plane_is_between(config->margin, 0.0f, JP_OBSTACLE_MARGIN_MAX);
}

static void follow(struct jp_movers *movers, const struct jp_movers_config *config, const struct jp_mover_thing *thing,
                   const struct jp_scan_view *view, float period)
{
    const struct jp_plane_point sensor = {view->first.x, view->first.y};
    struct jp_mover *const mover = jp_movers_match(movers, thing, GATE + period * config->speed_max);

    if (mover != NULL) {
        jp_mover_correct(mover, thing, config->speed_max);
        jp_mover_judge_companion(mover, config);
        jp_mover_note_walk(mover, config, thing, view);
    } else {
        jp_movers_begin(movers, thing, sensor);
    }
}

void jp_movers_clear(struct jp_movers *movers)
{
    movers->count = 0;
    movers->past[0].count = 0;
    movers->past[1].count = 0;
    movers->past_age = 0.0f;
}

enum jp_status jp_movers_update(struct jp_movers *movers, const struct jp_movers_config *config,
                                const struct jp_scan_config *scan_config, const struct jp_scan *scan,
                                const struct jp_plane_pose *sensor, float period)
{
    struct jp_scan_view view;
    struct jp_scan_run run;
    struct jp_mover_thing thing;

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
    jp_movers_predict(movers, period);
    for (unsigned beam = 0; jp_scan_next_run(&view, beam, &run); beam = run.last + 1U) {
        if (jp_mover_find_thing(&view, &run, config->extent, &thing)) {
            thing.has_come = jp_movers_has_come(movers, view.config, &thing);
            follow(movers, config, &thing, &view, period);
        }
    }
    jp_movers_join(movers);
    jp_movers_miss(movers, &view);
    jp_movers_forget(movers);
    jp_movers_keep_scan(movers, &view, period);
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
        if (jp_mover_has_walked(&movers->movers[i]) && jp_mover_is_walking(&movers->movers[i], config)) {
            for (unsigned k = 0; k < obstacles->count; k++) {
                mark(&movers->movers[i], config->margin, &obstacles->shapes[k]);
            }
        }
    }
}
