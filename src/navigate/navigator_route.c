#include "src/navigate/navigator_route.h"

#include "src/base/integer.h"
#include "src/base/point.h"
#include "src/map/capsule.h"
#include "src/navigate/navigator_frame.h"
#include "src/navigate/navigator_goal.h"
#include "src/navigate/navigator_ledger.h"
#include "src/navigate/navigator_state.h"
#include "src/navigate/navigator_survey.h"

/** Cells round the robot in which a place to plan from is looked for. */
#define PLACES_ROUND 4

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

bool jp_route_begin(struct jp_navigator *navigator, const struct jp_place *place)
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

enum jp_answer jp_route_think(struct jp_navigator *navigator)
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

    jp_navigator_see_map(navigator);
    internal->search = JP_NAVIGATOR_WAY;
    if (status == JP_OK) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_PROVING, navigator->reason);
    } else {
        jp_navigator_fail(navigator, JP_NAVIGATOR_MEMORY);
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
    if (navigator->internal.search == JP_NAVIGATOR_ROUTE || jp_navigator_has_map_changed(navigator)) {
        begin_way(navigator);
    } else if (navigator->internal.search == JP_NAVIGATOR_ROUTE_ONLY) {
        jp_navigator_fail(navigator, JP_NAVIGATOR_MEMORY);
    } else {
        jp_navigator_enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
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
    return jp_route_begin(navigator, place);
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
        jp_navigator_enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
    } else {
        /* It may sway still. */
    }
}

/** Who sees for it has as long as it would wait for a route. */
static void look_round(struct jp_navigator *navigator)
{
    navigator->internal.spent += navigator->config.slice;
    if (is_late(navigator)) {
        jp_navigator_plan_anew(navigator, navigator->reason);
    }
}

void jp_route_search(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    if (!internal->was_told && !begin_search(navigator, place)) {
        jp_navigator_give_up(navigator, JP_NAVIGATOR_FAILED, JP_NAVIGATOR_HEMMED_IN);
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
    const enum jp_answer answer = jp_route_think(navigator);
    const bool is_idle = jp_planner_is_idle(navigator->config.planner);

    if (answer == JP_ANSWER_UNREACHABLE) {
        jp_navigator_give_up(navigator, JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATOR_NO_REASON);
    } else if (takes_route(navigator)) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
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
    jp_navigator_enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    navigator->internal.search = search;
    navigator->internal.was_told = true;
}

/** A robot on its way takes the way; one that has not begun yet waits for something better. */
static void look_for_way(struct jp_navigator *navigator)
{
    switch (jp_lattice_way_work(&navigator->internal.way, (unsigned)navigator->config.slice * WAY_LOOKS)) {
    case JP_WAY_FOUND:
        if (navigator->replans > 0U) {
            jp_navigator_enter(navigator, JP_NAVIGATOR_JOINING, navigator->reason);
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
        jp_navigator_give_up(navigator, JP_NAVIGATOR_UNREACHABLE, JP_NAVIGATOR_NO_REASON);
        break;
    default:
        break;
    }
}

void jp_route_prove(struct jp_navigator *navigator)
{
    if (jp_navigator_has_map_changed(navigator)) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
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
        jp_navigator_enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
    } else {
        jp_navigator_fail(navigator, reason);
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
        jp_ledger_add_course(navigator);
        jp_navigator_enter(navigator, JP_NAVIGATOR_TURNING, navigator->reason);
    } else if (status == JP_ERR_BLOCKED) {
        fail_to_join(navigator, JP_NAVIGATOR_NO_ROOM);
    } else if (status != JP_WORKING) {
        (void)jp_navigator_accepts(navigator, status);
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

void jp_route_join(struct jp_navigator *navigator, const struct jp_place *place)
{
    struct jp_navigator_internal *internal = &navigator->internal;

    if (!internal->was_told) {
        internal->was_told = true;
        jp_navigator_see_map(navigator);
        jp_survey_start(navigator);
        begin_course(navigator, place);
    }
    if (jp_navigator_has_map_changed(navigator)) {
        jp_navigator_enter(navigator, JP_NAVIGATOR_PLANNING, navigator->reason);
        return;
    }
    switch (work_on_course(navigator)) {
    case JP_COURSE_FOUND:
        if (internal->course.count == 0U) {
            internal->leg = 0;
            jp_navigator_enter(navigator, JP_NAVIGATOR_TURNING, JP_NAVIGATOR_NO_REASON);
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
