#include <joulepath/navigator.h>

#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/navigate/navigator_frame.h"
#include "src/navigate/navigator_ledger.h"
#include "src/navigate/navigator_route.h"
#include "src/navigate/navigator_seen.h"
#include "src/navigate/navigator_state.h"
#include "src/navigate/navigator_survey.h"

/** A robot faces a leg whose direction is nearer than this, turn/2³²: half a degree. */
#define FACING ((int32_t)5965233)

/** Turns on the spot for one leg; what is left then is left. */
#define TURNS_MAX 8U

/* The drive. */

static bool is_leg_clear(const struct jp_navigator *navigator, unsigned leg, const struct jp_point *from)
{
    return jp_course_is_clear(&navigator->internal.course, leg, from);
}

/** The first leg that the map does not let the robot drive any more; the count of legs when there is none. */
static uint16_t blocked_leg(struct jp_navigator *navigator, const struct jp_place *place)
{
    const uint16_t count = navigator->internal.course.count;
    const uint16_t leg = navigator->internal.leg;

    if (!jp_navigator_has_map_changed(navigator) || leg == count) {
        return count;
    }
    const struct jp_point here = jp_frame_left_of_leg(navigator, leg, &place->point);

    if (!is_leg_clear(navigator, leg, &here)) {
        return leg;
    }
    for (uint16_t next = leg + 1U; next < count; next++) {
        const struct jp_point begin = jp_frame_leg_begin(navigator, next);
        if (!is_leg_clear(navigator, next, &begin)) {
            return next;
        }
    }
    jp_navigator_see_map(navigator);
    return count;
}

/** To the next leg; at the goal to the nearest of its headings. */
static jp_angle heading_ahead(const struct jp_navigator *navigator, const struct jp_place *place)
{
    const struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_lattice *lattice = jp_planner_lattice(navigator->config.planner);

    if (internal->leg < internal->course.count) {
        return jp_frame_direction(&place->point, &navigator->config.legs[internal->leg].end);
    }
    return internal->goal.headings == JP_ANY_HEADING
               ? place->heading
               : lattice->heading[jp_frame_nearest_heading(lattice, internal->goal.headings, place->heading)];
}

/** The robot looks where it shall. */
static void end_turn(struct jp_navigator *navigator)
{
    if (navigator->internal.leg < navigator->internal.course.count) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_DRIVING, JP_NAVIGATOR_NO_REASON);
    } else {
        jp_ledger_end(navigator);
        jp_navigator_enter(navigator, JP_NAVIGATOR_ARRIVED, JP_NAVIGATOR_NO_REASON);
    }
}

static void face(struct jp_navigator *navigator, const struct jp_place *place, enum jp_vehicle_phase phase)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_vehicle *vehicle = navigator->config.vehicle;
    const jp_angle heading = heading_ahead(navigator, place);

    if (phase != JP_VEHICLE_STANDING) {
        return;
    }
    if (blocked_leg(navigator, place) < internal->course.count) {
        jp_navigator_plan_anew(navigator, JP_NAVIGATOR_BLOCKED);
    } else if (internal->turns == TURNS_MAX || jp_is_between((int32_t)(heading - place->heading), -FACING, FACING)) {
        end_turn(navigator);
    } else {
        internal->turns++;
        internal->has_moved = true;
        (void)jp_navigator_accepts(
            navigator, vehicle->turn(vehicle->context, heading - internal->origin.heading, jp_frame_ground(navigator)));
    }
}

static bool is_astray(const struct jp_navigator *navigator, const struct jp_place *place)
{
    const uint16_t leg = navigator->internal.leg;
    const jp_q16 room = navigator->config.margin + navigator->config.legs[leg].aside;

    return jp_absolute32(jp_frame_along_leg(navigator, leg, &place->point).y) > room;
}

/** A robot that slid aside as it turned drives the leg from where it stands, if there is room. */
static void bend_course(struct jp_navigator *navigator, const struct jp_place *place)
{
    const uint16_t leg = navigator->internal.leg;

    if (is_astray(navigator, place) && is_leg_clear(navigator, leg, &place->point)) {
        jp_course_begin_at(&navigator->internal.course, leg, &place->point);
    }
}

static void begin_drive(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_vehicle *vehicle = navigator->config.vehicle;

    bend_course(navigator, place);
    const uint16_t count = jp_survey_write_run(navigator, internal->leg);

    internal->was_told = true;
    internal->has_moved = true;
    internal->run_end = (uint16_t)(internal->leg + count);
    const struct jp_vehicle_run run = {.targets = internal->targets,
                                       .count = count,
                                       .slower = navigator->config.legs[internal->run_end - 1U].slower,
                                       .ground = jp_frame_ground(navigator)};

    (void)jp_navigator_accepts(navigator, vehicle->follow(vehicle->context, &run));
}

/** It was stopped on its way, or switched off and on: more than a cell is left of its run. */
static bool stands_short(const struct jp_navigator *navigator, const struct jp_place *place)
{
    const unsigned last = navigator->internal.run_end - 1U;
    const struct jp_terrain *terrain = jp_planner_terrain(navigator->config.planner);

    return jp_frame_along_leg(navigator, last, &place->point).x < -terrain->config.resolution;
}

static void end_drive(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    internal->leg = internal->run_end;
    jp_navigator_enter(navigator, JP_NAVIGATOR_TURNING, JP_NAVIGATOR_NO_REASON);
}

static void drive(struct jp_navigator *navigator, const struct jp_place *place, enum jp_vehicle_phase phase)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    if (!internal->was_told) {
        /* It may sway since it was seen to stand. */
        if (phase == JP_VEHICLE_STANDING) {
            begin_drive(navigator, place);
        }
        return;
    }
    if (internal->leg + 1U < internal->run_end && jp_frame_along_leg(navigator, internal->leg, &place->point).x > 0) {
        internal->leg++;
    }
    if (phase == JP_VEHICLE_STANDING && stands_short(navigator, place)) {
        jp_navigator_plan_anew(navigator, JP_NAVIGATOR_ASTRAY);
    } else if (phase == JP_VEHICLE_STANDING) {
        end_drive(navigator);
    } else if (blocked_leg(navigator, place) < internal->run_end) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_BRAKING, JP_NAVIGATOR_BLOCKED);
    } else if (is_astray(navigator, place)) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_BRAKING, JP_NAVIGATOR_ASTRAY);
    } else {
        /* The way ahead is clear. */
    }
}

/** Plans anew meanwhile; a search that has a route takes it on when the robot stands somewhat farther. */
static void brake(struct jp_navigator *navigator, const struct jp_place *place, enum jp_vehicle_phase phase)
{
    const struct jp_vehicle *vehicle = navigator->config.vehicle;

    if (!navigator->internal.was_told) {
        navigator->internal.was_told = true;
        navigator->internal.has_route = false;
        vehicle->stop(vehicle->context);
        (void)jp_route_begin(navigator, place);
    } else if (phase == JP_VEHICLE_STANDING) {
        jp_navigator_plan_anew(navigator, navigator->reason);
    } else if (!navigator->internal.has_route) {
        (void)jp_route_think(navigator);
    } else {
        /* It rolls still. */
    }
}

static bool is_under_way(enum jp_navigator_state state)
{
    return state >= JP_NAVIGATOR_PLANNING && state <= JP_NAVIGATOR_BRAKING;
}

static void go_on(struct jp_navigator *navigator, const struct jp_vehicle_view *view)
{
    const struct jp_place place = jp_frame_place(navigator, view);

    switch (navigator->state) {
    case JP_NAVIGATOR_PLANNING:
        jp_route_search(navigator, &place);
        break;
    case JP_NAVIGATOR_PROVING:
        jp_route_prove(navigator);
        break;
    case JP_NAVIGATOR_JOINING:
        jp_route_join(navigator, &place);
        break;
    case JP_NAVIGATOR_TURNING:
        face(navigator, &place, view->phase);
        break;
    case JP_NAVIGATOR_DRIVING:
        drive(navigator, &place, view->phase);
        break;
    default:
        brake(navigator, &place, view->phase);
        break;
    }
}

/** False: what the vehicle does ends the leg, or the way to the goal. */
static bool goes_on(struct jp_navigator *navigator, const struct jp_vehicle_view *view, enum jp_status status)
{
    const bool is_driven = navigator->state == JP_NAVIGATOR_DRIVING && navigator->internal.was_told;

    if (view->phase == JP_VEHICLE_OFF) {
        jp_navigator_fail(navigator, JP_NAVIGATOR_OFF);
        return false;
    }
    if (is_driven && status == JP_ERR_ZERO_LENGTH) {
        /* What it follows is at the next waypoint already, by chance. */
        navigator->internal.run_end = (uint16_t)(navigator->internal.leg + 1U);
        end_drive(navigator);
        return false;
    }
    return !is_driven || jp_navigator_accepts(navigator, status);
}

enum jp_navigator_state jp_navigator_work(struct jp_navigator *navigator)
{
    const struct jp_vehicle *vehicle = navigator->config.vehicle;
    const enum jp_status status = vehicle->work(vehicle->context);
    const struct jp_vehicle_view view = jp_frame_look(navigator);

    if (is_under_way(navigator->state) && goes_on(navigator, &view, status)) {
        go_on(navigator, &view);
    }
    return navigator->state;
}

/* Requests. */

size_t jp_navigator_way_size(const struct jp_terrain_config *config)
{
    return jp_lattice_way_size(config);
}

static const char *missing(const struct jp_navigator_config *config)
{
    if (config->planner == NULL) {
        return "planner";
    }
    if (config->vehicle == NULL) {
        return "vehicle";
    }
    return config->slice == 0U ? "slice" : NULL;
}

/** Of a map that the planner has taken. */
static bool is_seen_too_small(const struct jp_navigator_config *config)
{
    return config->seen != NULL &&
           config->seen_size < jp_navigator_seen_size(&jp_planner_terrain(config->planner)->config);
}

enum jp_status jp_navigator_init(struct jp_navigator *navigator, const struct jp_navigator_config *config,
                                 const struct jp_place *origin, const char **field)
{
    if (navigator == NULL || config == NULL || origin == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = missing(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    if (is_seen_too_small(config)) {
        *field = "seen_size";
        return JP_ERR_CONFIG;
    }
    const struct jp_course_config course = {.terrain = jp_planner_terrain(config->planner),
                                            .radius = config->radius,
                                            .margin = config->margin,
                                            .legs = config->legs,
                                            .legs_max = config->legs_max};

    *navigator = (struct jp_navigator){.config = *config, .internal = {.origin = *origin}};
    navigator->internal.ground = jp_frame_make_ground(navigator);
    jp_seen_start(navigator);
    return jp_course_init(&navigator->internal.course, &course, field);
}

enum jp_status jp_navigator_go_along(struct jp_navigator *navigator, const struct jp_goal *goal,
                                     const struct jp_pose_field *field)
{
    const enum jp_status status = jp_navigator_go(navigator, goal);

    if (status == JP_OK) {
        navigator->internal.field = field;
    }
    return status;
}

enum jp_status jp_navigator_go(struct jp_navigator *navigator, const struct jp_goal *goal)
{
    if (navigator == NULL || goal == NULL) {
        return JP_ERR_ARGUMENT;
    }
    const enum jp_vehicle_phase phase = jp_frame_look(navigator).phase;
    const enum jp_status status =
        phase == JP_VEHICLE_OFF ? JP_ERR_STATE : jp_planner_set_goal(navigator->config.planner, goal);

    if (status == JP_OK) {
        navigator->replans = 0;
        navigator->status = JP_OK;
        navigator->internal.asked = *goal;
        navigator->internal.goal = *goal;
        navigator->internal.field = NULL;
        navigator->internal.forgets = 0;
        jp_ledger_begin(navigator);
        jp_navigator_enter(navigator, phase == JP_VEHICLE_STANDING ? JP_NAVIGATOR_PLANNING : JP_NAVIGATOR_BRAKING,
                           JP_NAVIGATOR_NO_REASON);
    }
    return status;
}

void jp_navigator_stop(struct jp_navigator *navigator)
{
    navigator->config.vehicle->stop(navigator->config.vehicle->context);
    jp_navigator_enter(navigator, JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
}

enum jp_status jp_navigator_set_cell(struct jp_navigator *navigator, int32_t x, int32_t y, enum jp_cell cell)
{
    return jp_seen_set_cell(navigator, x, y, cell);
}

/* What is known. */

struct jp_place jp_navigator_place(const struct jp_navigator *navigator)
{
    const struct jp_vehicle_view view = jp_frame_look(navigator);

    return jp_frame_place(navigator, &view);
}

const struct jp_course_leg *jp_navigator_legs(const struct jp_navigator *navigator, uint16_t *count)
{
    const struct jp_navigator_internal *internal = &navigator->internal;

    *count = jp_navigator_has_course(navigator) ? (uint16_t)(internal->course.count - internal->leg) : 0U;
    return &navigator->config.legs[internal->leg];
}

enum jp_status jp_navigator_progress(const struct jp_navigator *navigator, struct jp_progress *progress)
{
    return jp_ledger_expected(navigator, progress) ? JP_OK : JP_ERR_NO_PLAN;
}
