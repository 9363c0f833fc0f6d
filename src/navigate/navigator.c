#include <joulepath/navigator.h>

#include <joulepath/count.h>
#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/map/capsule.h"
#include "src/navigate/navigator_frame.h"
#include "src/navigate/navigator_goal.h"
#include "src/navigate/navigator_seen.h"
#include "src/navigate/navigator_survey.h"

/** Cells round the robot in which a place to plan from is looked for. */
#define PLACES_ROUND 4

/** A robot faces a leg whose direction is nearer than this, turn/2³²: half a degree. */
#define FACING ((int32_t)5965233)

/** What takes about as long as an expansion: looks for a way, cells of a proof; and expansions that take as long
 *  as a line of a course, and as a leg of a survey. */
#define WAY_LOOKS       20U
#define PROOF_CELLS     5U
#define LINE_EXPANSIONS 5U
#define LEG_EXPANSIONS  5U

/** A robot that has not begun yet has so many times the patience. */
#define FIRST_PATIENCE 4U

/** m. A robot that stays as near to a point stands there. */
#define STILL_MAX JP_Q16(0.003)

/** Turns on the spot for one leg; what is left then is left. */
#define TURNS_MAX 8U

/* States. */

static void enter(struct jp_navigator *navigator, enum jp_navigator_state state, enum jp_navigator_reason reason)
{
    navigator->state = state;
    navigator->reason = reason;
    navigator->internal.was_told = false;
    navigator->internal.turns = 0;
}

static void fail(struct jp_navigator *navigator, enum jp_navigator_reason reason)
{
    enter(navigator, JP_NAVIGATOR_FAILED, reason);
}

/** The vehicle's failures end the way to the goal. */
static bool accepts(struct jp_navigator *navigator, enum jp_status status)
{
    if (status != JP_OK) {
        navigator->status = status;
        navigator->config.vehicle->stop(navigator->config.vehicle->context);
        fail(navigator, JP_NAVIGATOR_VEHICLE);
    }
    return status == JP_OK;
}

static void plan_anew(struct jp_navigator *navigator, enum jp_navigator_reason reason)
{
    navigator->replans = jp_one_more16(navigator->replans);
    enter(navigator, JP_NAVIGATOR_PLANNING, reason);
}

/** It cannot reach the goal by what it has seen; if that may mislead it, it forgets it, and looks again. */
static void give_up(struct jp_navigator *navigator, enum jp_navigator_state state, enum jp_navigator_reason reason)
{
    if (!jp_seen_may_mislead(navigator)) {
        enter(navigator, state, reason);
        return;
    }
    jp_seen_forget(navigator);
    enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    navigator->internal.was_told = true;
    navigator->internal.spent = 0;
    navigator->internal.search = JP_NAVIGATOR_LOOK_ROUND;
}

/* Planning. */

/** True when the robot can get from where it is to a cell near it in a straight line, no nearer to anything than it is.
 */
static bool can_reach(const struct jp_navigator *navigator, const struct jp_place *place,
                      const struct jp_lattice_pose *pose)
{
    const struct jp_terrain *terrain = jp_planner_terrain(navigator->config.planner);
    const jp_q16 cell = terrain->config.resolution;
    const struct jp_point centre = {pose->x * cell + cell / 2, pose->y * cell + cell / 2};
    const jp_q16 room = jp_course_room(&navigator->internal.course, &place->point);
    const struct jp_capsule capsule = {.from = place->point, .to = centre, .radius = navigator->config.radius + room};

    return jp_capsule_is_clear(terrain, &capsule);
}

/** Plans from the cell where the robot is, or from one near it when it stands nearer to obstacles than the planner lets
 *  it. False: there is none. */
static bool set_start(struct jp_navigator *navigator, const struct jp_place *place)
{
    const jp_q16 cell = jp_planner_terrain(navigator->config.planner)->config.resolution;
    const int32_t x = place->point.x / cell;
    const int32_t y = place->point.y / cell;
    const uint8_t heading =
        jp_frame_nearest_heading(jp_planner_lattice(navigator->config.planner), JP_ANY_HEADING, place->heading);

    for (int32_t ring = 0; ring <= PLACES_ROUND; ring++) {
        for (int32_t i = 0; i < (2 * ring + 1) * (2 * ring + 1); i++) {
            const int32_t dx = i % (2 * ring + 1) - ring;
            const int32_t dy = i / (2 * ring + 1) - ring;
            const struct jp_lattice_pose pose = {(int16_t)(x + dx), (int16_t)(y + dy), heading};
            const bool is_on_ring = jp_absolute32(dx) == ring || jp_absolute32(dy) == ring;

            if (is_on_ring && (ring == 0 || can_reach(navigator, place, &pose)) &&
                jp_planner_set_start(navigator->config.planner, &pose) == JP_OK) {
                navigator->internal.start = (struct jp_way_cell){pose.x, pose.y};
                navigator->internal.stand = place->point;
                return true;
            }
        }
    }
    return false;
}

static void see_map(struct jp_navigator *navigator)
{
    navigator->internal.map_seen = jp_planner_terrain(navigator->config.planner)->version;
}

static bool has_map_changed(const struct jp_navigator *navigator)
{
    return navigator->internal.map_seen != jp_planner_terrain(navigator->config.planner)->version;
}

/** A slice of the planner. */
static enum jp_answer think(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    struct jp_planner *planner = navigator->config.planner;
    const enum jp_answer answer = jp_planner_work(planner, navigator->config.slice);

    if (answer == JP_ANSWER_STALE) {
        jp_planner_restart(planner);
    }
    internal->has_route = answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND;
    internal->spent += navigator->config.slice;
    return answer;
}

/** The planner has no route to the goal. */
static void begin_way(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_planner *planner = navigator->config.planner;
    const struct jp_way_cell goal = {internal->goal.x, internal->goal.y};
    const enum jp_status status =
        jp_lattice_way_start(&internal->way, jp_planner_lattice(planner), jp_planner_terrain(planner), &internal->start,
                             &goal, navigator->config.way_block, navigator->config.way_size);

    see_map(navigator);
    internal->search = JP_NAVIGATOR_WAY;
    if (status == JP_OK) {
        enter(navigator, JP_NAVIGATOR_PROVING, navigator->reason);
    } else {
        fail(navigator, JP_NAVIGATOR_MEMORY);
    }
}

static bool is_late(const struct jp_navigator *navigator)
{
    return navigator->internal.spent >= navigator->config.patience;
}

static bool is_late_for_first(const struct jp_navigator *navigator)
{
    return navigator->internal.spent / FIRST_PATIENCE >= navigator->config.patience;
}

/** A robot that has not begun yet waits for what is better than the first route. */
static bool takes_route(const struct jp_navigator *navigator)
{
    const bool is_on_its_way = navigator->replans > 0U;

    return navigator->internal.has_route &&
           (is_on_its_way || is_late_for_first(navigator) || jp_planner_is_idle(navigator->config.planner));
}

static bool can_look_for_way(const struct jp_navigator *navigator)
{
    return navigator->internal.search == JP_NAVIGATOR_ROUTE && navigator->config.way_block != NULL;
}

/** The planner has done what it can. */
static void do_without_route(struct jp_navigator *navigator)
{
    if (navigator->internal.search == JP_NAVIGATOR_ROUTE || has_map_changed(navigator)) {
        begin_way(navigator);
    } else if (navigator->internal.search == JP_NAVIGATOR_ROUTE_ONLY) {
        fail(navigator, JP_NAVIGATOR_MEMORY);
    } else {
        enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
    }
}

/** Its pose on the lattice, from which was planned last. */
static struct jp_lattice_pose start_pose(const struct jp_navigator *navigator, const struct jp_place *place)
{
    const struct jp_navigator_internal *internal = &navigator->internal;

    return (struct jp_lattice_pose){
        internal->start.x, internal->start.y,
        jp_frame_nearest_heading(jp_planner_lattice(navigator->config.planner), JP_ANY_HEADING, place->heading)};
}

/** The field is finished and leads from where the robot is. */
static bool has_field(const struct jp_navigator *navigator, const struct jp_place *place)
{
    const struct jp_lattice_pose pose = start_pose(navigator, place);

    return navigator->internal.field != NULL &&
           jp_pose_field_cost(navigator->internal.field, pose.x, pose.y, pose.heading) != JP_COST_MAX;
}

/** A goal that was blocked since is moved to where the robot still covers it, and back once it is free. */
static void adapt_goal(struct jp_navigator *navigator)
{
    const struct jp_goal goal = jp_navigator_choose_goal(navigator);
    const bool is_another = goal.x != navigator->internal.goal.x || goal.y != navigator->internal.goal.y;

    if (is_another && jp_planner_set_goal(navigator->config.planner, &goal) == JP_OK) {
        navigator->internal.goal = goal;
    }
}

static bool begin_search(struct jp_navigator *navigator, const struct jp_place *place)
{
    adapt_goal(navigator);
    navigator->internal.was_told = true;
    navigator->internal.spent = 0;
    navigator->internal.search = JP_NAVIGATOR_ROUTE;
    return set_start(navigator, place);
}

/** Nothing is searched; but a robot that sways may be seen to stand where it turns round: it shall be where it is for
 * as long as it would wait for a route. */
static void await_stand(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    internal->spent += navigator->config.slice;
    if (jp_distance(&place->point, &internal->stand) > STILL_MAX) {
        internal->was_told = false;
    } else if (is_late(navigator)) {
        internal->search = JP_NAVIGATOR_FIELD;
        enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
    } else {
        /* It may sway still. */
    }
}

/** Who sees for it has as long as it would wait for a route. */
static void look_round(struct jp_navigator *navigator)
{
    navigator->internal.spent += navigator->config.slice;
    if (is_late(navigator)) {
        plan_anew(navigator, navigator->reason);
    }
}

static void search(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    if (!internal->was_told && !begin_search(navigator, place)) {
        give_up(navigator, JP_NAVIGATOR_FAILED, JP_NAVIGATOR_HEMMED_IN);
        return;
    }
    if (internal->search == JP_NAVIGATOR_LOOK_ROUND) {
        look_round(navigator);
        return;
    }
    if (has_field(navigator, place)) {
        await_stand(navigator, place);
        return;
    }
    const enum jp_answer answer = think(navigator);
    const bool is_idle = jp_planner_is_idle(navigator->config.planner);

    if (answer == JP_ANSWER_UNREACHABLE) {
        give_up(navigator, JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATOR_NO_REASON);
    } else if (takes_route(navigator)) {
        enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
    } else if (!internal->has_route && is_idle) {
        do_without_route(navigator);
    } else if (!internal->has_route && is_late(navigator) && can_look_for_way(navigator)) {
        begin_way(navigator);
    } else {
        /* It goes on searching. */
    }
}

/* Proving. */

/** No way of unit steps leads to the goal. */
static void begin_proof(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_planner *planner = navigator->config.planner;

    /* The block is large enough for a way, and so for the proof. */
    (void)jp_reach_start(&internal->reach, jp_planner_lattice(planner), jp_planner_terrain(planner), internal->start.x,
                         internal->start.y, internal->goal.x, internal->goal.y, navigator->config.way_block,
                         navigator->config.way_size);
    internal->search = JP_NAVIGATOR_PROOF;
}

/** The planner goes on where it was. */
static void resume_search(struct jp_navigator *navigator, enum jp_navigator_search search)
{
    enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    navigator->internal.search = search;
    navigator->internal.was_told = true;
}

/** A robot on its way takes the way; one that has not begun yet waits for something better. */
static void look_for_way(struct jp_navigator *navigator)
{
    switch (jp_lattice_way_work(&navigator->internal.way, (unsigned)navigator->config.slice * WAY_LOOKS)) {
    case JP_WAY_FOUND:
        if (navigator->replans > 0U) {
            enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
        } else {
            resume_search(navigator, JP_NAVIGATOR_ROUTE_OR_WAY);
        }
        break;
    case JP_WAY_NONE:
        begin_proof(navigator);
        break;
    default:
        break;
    }
}

/** Curves may lead where unit steps do not. */
static void look_for_proof(struct jp_navigator *navigator)
{
    switch (jp_reach_work(&navigator->internal.reach, (unsigned)navigator->config.slice * PROOF_CELLS)) {
    case JP_REACH_CONNECTED:
        resume_search(navigator, JP_NAVIGATOR_ROUTE_ONLY);
        break;
    case JP_REACH_NONE:
        give_up(navigator, JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATOR_NO_REASON);
        break;
    default:
        break;
    }
}

static void prove(struct jp_navigator *navigator)
{
    if (has_map_changed(navigator)) {
        enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    } else if (navigator->internal.search == JP_NAVIGATOR_WAY) {
        look_for_way(navigator);
    } else {
        look_for_proof(navigator);
    }
}

/* Joining. */

/** A field whose lines have no room is of no use. */
static void fail_to_join(struct jp_navigator *navigator, enum jp_navigator_reason reason)
{
    if (navigator->internal.search == JP_NAVIGATOR_FIELD) {
        navigator->internal.field = NULL;
        enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    } else {
        fail(navigator, reason);
    }
}

static void survey(struct jp_navigator *navigator, const struct jp_place *place)
{
    enum jp_status status = JP_WORKING;

    for (unsigned i = 0; i <= navigator->config.slice / LEG_EXPANSIONS && status == JP_WORKING; i++) {
        status = jp_survey_work(navigator, place);
    }
    if (status == JP_OK) {
        navigator->internal.leg = 0;
        enter(navigator, JP_NAVIGATOR_TURNING, navigator->reason);
    } else if (status == JP_ERR_BLOCKED) {
        fail_to_join(navigator, JP_NAVIGATOR_NO_ROOM);
    } else if (status != JP_WORKING) {
        (void)accepts(navigator, status);
    } else {
        /* There are legs left. */
    }
}

/** A field that has been started anew since leads nowhere. */
static void begin_course(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_lattice_pose pose = start_pose(navigator, place);

    if (internal->search == JP_NAVIGATOR_FIELD) {
        internal->course.answer = JP_COURSE_NO_ROOM;
        (void)jp_course_start_on_field(&internal->course, internal->field, &pose, &internal->stand);
    } else if (internal->has_route) {
        (void)jp_course_start(&internal->course, navigator->config.planner, &internal->stand);
    } else {
        (void)jp_course_start_on_way(&internal->course, &internal->way, &internal->start, &internal->stand);
    }
}

/** Some of its lines. */
static enum jp_course_answer work_on_course(struct jp_navigator *navigator)
{
    enum jp_course_answer answer = JP_COURSE_JOINING;

    for (unsigned i = 0; i <= navigator->config.slice / LINE_EXPANSIONS && answer == JP_COURSE_JOINING; i++) {
        answer = jp_course_work(&navigator->internal.course);
    }
    return answer;
}

static void join(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    if (!internal->was_told) {
        internal->was_told = true;
        see_map(navigator);
        jp_survey_start(navigator);
        begin_course(navigator, place);
    }
    if (has_map_changed(navigator)) {
        enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
        return;
    }
    switch (work_on_course(navigator)) {
    case JP_COURSE_FOUND:
        if (internal->course.count == 0U) {
            internal->leg = 0;
            enter(navigator, JP_NAVIGATOR_TURNING, JP_NAVIGATOR_NO_REASON);
        } else {
            survey(navigator, place);
        }
        break;
    case JP_COURSE_NO_ROOM:
        fail_to_join(navigator, JP_NAVIGATOR_NO_ROOM);
        break;
    case JP_COURSE_TOO_LONG:
        fail_to_join(navigator, JP_NAVIGATOR_TOO_LONG);
        break;
    default:
        break;
    }
}

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

    if (!has_map_changed(navigator) || leg == count) {
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
    see_map(navigator);
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

/** What a robot does that looks where it shall. */
static enum jp_navigator_state after_turn(const struct jp_navigator *navigator)
{
    const struct jp_navigator_internal *internal = &navigator->internal;

    return internal->leg < internal->course.count ? JP_NAVIGATOR_DRIVING : JP_NAVIGATOR_ARRIVED;
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
        plan_anew(navigator, JP_NAVIGATOR_BLOCKED);
    } else if (internal->turns == TURNS_MAX || jp_is_between((int32_t)(heading - place->heading), -FACING, FACING)) {
        enter(navigator, after_turn(navigator), JP_NAVIGATOR_NO_REASON);
    } else {
        internal->turns++;
        internal->has_moved = true;
        (void)accepts(navigator,
                      vehicle->turn(vehicle->context, heading - internal->origin.heading, jp_frame_ground(navigator)));
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

    (void)accepts(navigator, vehicle->follow(vehicle->context, &run));
}

static void end_drive(struct jp_navigator *navigator)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    internal->leg = internal->run_end;
    enter(navigator, JP_NAVIGATOR_TURNING, JP_NAVIGATOR_NO_REASON);
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
    if (phase == JP_VEHICLE_STANDING) {
        end_drive(navigator);
    } else if (blocked_leg(navigator, place) < internal->run_end) {
        enter(navigator, JP_NAVIGATOR_BRAKING, JP_NAVIGATOR_BLOCKED);
    } else if (is_astray(navigator, place)) {
        enter(navigator, JP_NAVIGATOR_BRAKING, JP_NAVIGATOR_ASTRAY);
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
        (void)set_start(navigator, place);
    } else if (phase == JP_VEHICLE_STANDING) {
        plan_anew(navigator, navigator->reason);
    } else if (!navigator->internal.has_route) {
        (void)think(navigator);
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
        search(navigator, &place);
        break;
    case JP_NAVIGATOR_PROVING:
        prove(navigator);
        break;
    case JP_NAVIGATOR_JOINING:
        join(navigator, &place);
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
        fail(navigator, JP_NAVIGATOR_OFF);
        return false;
    }
    if (is_driven && status == JP_ERR_ZERO_LENGTH) {
        /* What it follows is at the next waypoint already, by chance. */
        navigator->internal.run_end = (uint16_t)(navigator->internal.leg + 1U);
        end_drive(navigator);
        return false;
    }
    return !is_driven || accepts(navigator, status);
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
        enter(navigator, phase == JP_VEHICLE_STANDING ? JP_NAVIGATOR_PLANNING : JP_NAVIGATOR_BRAKING,
              JP_NAVIGATOR_NO_REASON);
    }
    return status;
}

void jp_navigator_stop(struct jp_navigator *navigator)
{
    navigator->config.vehicle->stop(navigator->config.vehicle->context);
    enter(navigator, JP_NAVIGATOR_IDLE, JP_NAVIGATOR_TOLD);
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

static bool has_course(const struct jp_navigator *navigator)
{
    return navigator->state == JP_NAVIGATOR_TURNING || navigator->state == JP_NAVIGATOR_DRIVING;
}

const struct jp_course_leg *jp_navigator_legs(const struct jp_navigator *navigator, uint16_t *count)
{
    const struct jp_navigator_internal *internal = &navigator->internal;

    *count = has_course(navigator) ? (uint16_t)(internal->course.count - internal->leg) : 0U;
    return &navigator->config.legs[internal->leg];
}

/** Of a quantity of the whole course, what belongs to the length that is left. */
static jp_q16 share(jp_q16 whole, int64_t left, int64_t length)
{
    return length > 0 ? jp_saturate32((int64_t)whole * (left < length ? left : length) / length) : 0;
}

enum jp_status jp_navigator_progress(const struct jp_navigator *navigator, struct jp_progress *progress)
{
    const struct jp_navigator_internal *internal = &navigator->internal;
    const struct jp_place place = jp_navigator_place(navigator);
    int64_t whole = 0;
    int64_t left = 0;

    if (!has_course(navigator)) {
        return JP_ERR_NO_PLAN;
    }
    for (uint16_t i = 0; i < internal->course.count; i++) {
        const struct jp_point begin = jp_frame_leg_begin(navigator, i);
        const struct jp_point *end = &navigator->config.legs[i].end;

        whole += jp_distance(&begin, end);
        if (i >= internal->leg) {
            left += jp_distance(i == internal->leg ? &place.point : &begin, end);
        }
    }
    *progress = (struct jp_progress){
        .length = jp_saturate32(left),
        .duration = share(internal->duration, left, whole),
        .energy = {share(internal->energy.energy, left, whole), share(internal->energy.deviation, left, whole)}};
    return JP_OK;
}
