#include <joulepath/course.h>

#include <stddef.h>

#include "src/base/point.h"
#include "src/map/capsule.h"
#include "src/map/line_cost.h"

/** So many steps in a row are looked at beyond one that no line leads to. */
#define MISSES_MAX 8U

/** In which less room is looked for, of a cell. */
#define ROOM_STEPS 8

/** Of a capsule, cells. */
#define RADIUS_MAX 64

/** m. Nearer places are the same: a robot that turns on the spot may get from one to the other. */
#define SAME_MAX JP_Q16(0.03)

/** Saves a line that cannot be driven. */
#define TOO_STEEP (-INT64_MAX)

static struct jp_point centre_of(const struct jp_course *course, const struct jp_lattice_pose *pose)
{
    const jp_q16 cell = course->config.terrain->config.resolution;

    return (struct jp_point){(jp_q16)(((int64_t)2 * pose->x + 1) * cell / 2),
                             (jp_q16)(((int64_t)2 * pose->y + 1) * cell / 2)};
}

static const char *wrong_field(const struct jp_course_config *config)
{
    if (config->terrain == NULL) {
        return "terrain";
    }
    const int64_t cell = config->terrain->config.resolution;

    if (4 * (int64_t)config->radius < cell || config->radius > 32 * cell) {
        return "radius";
    }
    if (config->margin < 0 || config->margin > 16 * cell) {
        return "margin";
    }
    if (config->legs == NULL) {
        return "legs";
    }
    return config->legs_max == 0U ? "legs_max" : NULL;
}

enum jp_status jp_course_init(struct jp_course *course, const struct jp_course_config *config, const char **field)
{
    if (course == NULL || config == NULL || field == NULL) {
        return JP_ERR_ARGUMENT;
    }
    *field = wrong_field(config);
    if (*field != NULL) {
        return JP_ERR_CONFIG;
    }
    *course = (struct jp_course){.config = *config};
    return JP_OK;
}

static bool is_route(enum jp_answer answer)
{
    return answer == JP_ANSWER_OPTIMAL || answer == JP_ANSWER_WITHIN_BOUND || answer == JP_ANSWER_PARTIAL;
}

/** Not all lines of a length cost alike. */
static bool has_prices(const struct jp_course *course)
{
    const struct jp_terrain_config *ground = &course->config.terrain->config;

    return ground->has_elevation || ground->has_classes;
}

/** To the end of the next primitive of the plan that leads elsewhere. False: the others turn where they are. */
static bool follow_plan(const struct jp_course *course, struct jp_course_place *place)
{
    const struct jp_planner *planner = course->internal.planner;

    while (place->step < jp_planner_plan(planner)->step_count) {
        const struct jp_lattice_pose before = place->pose;
        const struct jp_primitive *primitive = jp_planner_step(planner, place->step, &place->pose);

        place->step++;
        if (has_prices(course)) {
            place->cost += (int64_t)jp_lattice_energy(course->internal.lattice, JP_COST_PHYSICAL,
                                                      course->config.terrain, primitive, before.x, before.y);
        }
        if (place->pose.x != before.x || place->pose.y != before.y) {
            return true;
        }
    }
    return false;
}

static bool follow_way(const struct jp_lattice_way *way, struct jp_course_place *place)
{
    struct jp_way_cell cell = {place->pose.x, place->pose.y};
    const bool has_next = jp_lattice_way_next(way, &cell);

    place->pose.x = cell.x;
    place->pose.y = cell.y;
    return has_next;
}

/** To the next cell. */
static bool follow_field(const struct jp_pose_field *field, struct jp_course_place *place)
{
    const struct jp_lattice_pose before = place->pose;
    bool has_next;

    do {
        has_next = jp_pose_field_next(field, &place->pose);
    } while (has_next && place->pose.x == before.x && place->pose.y == before.y);
    /* What is left falls as the way grows. */
    place->cost = -(int64_t)jp_pose_field_cost(field, place->pose.x, place->pose.y, place->pose.heading);
    return has_next;
}

/** To the next place of the route. False: it ends here. */
static bool follow(const struct jp_course *course, struct jp_course_place *place)
{
    const struct jp_course_internal *internal = &course->internal;

    if (internal->planner != NULL) {
        return follow_plan(course, place);
    }
    return internal->way != NULL ? follow_way(internal->way, place) : follow_field(internal->field, place);
}

static bool leads_on(const struct jp_course *course, const struct jp_course_place *place)
{
    struct jp_course_place next = *place;

    return follow(course, &next);
}

/** The map has changed since the field was made, so that its way ends before the root. */
static bool is_cut_off(const struct jp_course *course, const struct jp_course_place *place)
{
    const struct jp_pose_field *field = course->internal.field;

    return field != NULL && jp_pose_field_cost(field, place->pose.x, place->pose.y, place->pose.heading) != 0U;
}

/** From a waypoint on, which is where `place` is. */
static void begin_leg(struct jp_course *course, const struct jp_point *from, const struct jp_course_place *place)
{
    struct jp_course_internal *internal = &course->internal;

    internal->from = *from;
    internal->first = *place;
    internal->has_best = false;
    internal->misses = 0;
    internal->margin = course->config.margin;
    if (!leads_on(course, place)) {
        course->answer = is_cut_off(course, place) ? JP_COURSE_NO_ROOM : JP_COURSE_FOUND;
    }
    internal->candidate = internal->first;
}

static bool is_clear(const struct jp_course *course, const struct jp_point *from, const struct jp_point *to,
                     jp_q16 radius)
{
    const int64_t cell = course->config.terrain->config.resolution;
    const struct jp_capsule capsule = {.from = *from, .to = *to, .radius = radius};

    return jp_distance(from, to) <= JP_COURSE_REACH * cell && radius <= RADIUS_MAX * cell &&
           jp_capsule_is_clear(course->config.terrain, &capsule);
}

static void add_leg(struct jp_course *course)
{
    const struct jp_course_place best = course->internal.best;
    const struct jp_point end = centre_of(course, &best.pose);
    struct jp_course_leg *leg = &course->config.legs[course->count];

    if (course->count == course->config.legs_max) {
        course->answer = JP_COURSE_TOO_LONG;
        return;
    }
    *leg = (struct jp_course_leg){.end = end, .margin = course->internal.margin};
    course->count++;
    begin_leg(course, &end, &best);
    leg->is_stop = course->answer == JP_COURSE_FOUND;
}

/** The end of the next step; false: there is none, or none is worth a look. */
static bool advance(struct jp_course *course)
{
    struct jp_course_internal *internal = &course->internal;

    return internal->misses < MISSES_MAX && follow(course, &internal->candidate);
}

/** By a line to the candidate, against the route to it; a way has no price. */
static int64_t saving_to(const struct jp_course *course, const struct jp_point *to)
{
    const struct jp_course_internal *internal = &course->internal;
    const jp_cost cost = jp_line_cost(internal->lattice, course->config.terrain, &internal->from, to);

    if (cost == JP_COST_MAX) {
        return TOO_STEEP;
    }
    return internal->way == NULL ? internal->candidate.cost - internal->first.cost - (int64_t)cost : 0;
}

/** A clear line becomes the best, unless another one saves more. One that is too steep is taken for a step of the route
 *  only, which the lattice allows. */
static void take(struct jp_course *course, const struct jp_point *to)
{
    struct jp_course_internal *internal = &course->internal;
    const int64_t saving = has_prices(course) ? saving_to(course, to) : 0;

    if (saving == TOO_STEEP) {
        internal->misses++;
    } else {
        internal->misses = 0;
    }
    if (!internal->has_best || (saving > TOO_STEEP && saving >= internal->saving)) {
        internal->best = internal->candidate;
        internal->saving = saving;
        internal->has_best = true;
    }
}

static void look(struct jp_course *course)
{
    struct jp_course_internal *internal = &course->internal;
    const struct jp_point to = centre_of(course, &internal->candidate.pose);

    if (jp_distance(&internal->from, &to) > SAME_MAX &&
        is_clear(course, &internal->from, &to, jp_add(course->config.radius, internal->margin))) {
        take(course, &to);
    } else {
        internal->misses++;
    }
}

/** No line was found. From where the robot is, which nobody chose, the margin may be less. */
static void retry(struct jp_course *course)
{
    struct jp_course_internal *internal = &course->internal;
    const jp_q16 room = course->count == 0U ? jp_course_room(course, &internal->start) : internal->margin;

    if (room < internal->margin) {
        internal->candidate = internal->first;
        internal->margin = room;
        internal->misses = 0;
        look(course);
    } else {
        course->answer = JP_COURSE_NO_ROOM;
    }
}

static void start_at(struct jp_course *course, const struct jp_point *start, const struct jp_course_place *first)
{
    course->internal.start = *start;
    course->count = 0;
    course->answer = JP_COURSE_JOINING;
    begin_leg(course, start, first);
    look(course);
}

enum jp_status jp_course_start(struct jp_course *course, const struct jp_planner *planner, const struct jp_point *start)
{
    if (course == NULL || planner == NULL || start == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const struct jp_plan *plan = jp_planner_plan(planner);

    if (!is_route(plan->answer)) {
        return JP_ERR_NO_PLAN;
    }

    course->internal = (struct jp_course_internal){.planner = planner, .lattice = jp_planner_lattice(planner)};
    start_at(course, start, &(struct jp_course_place){.pose = plan->start});
    return JP_OK;
}

enum jp_status jp_course_start_on_way(struct jp_course *course, const struct jp_lattice_way *way,
                                      const struct jp_way_cell *from, const struct jp_point *start)
{
    if (course == NULL || way == NULL || from == NULL || start == NULL) {
        return JP_ERR_ARGUMENT;
    }
    course->internal = (struct jp_course_internal){.way = way, .lattice = way->lattice};
    start_at(course, start, &(struct jp_course_place){.pose = {.x = from->x, .y = from->y}});
    return JP_OK;
}

enum jp_status jp_course_start_on_field(struct jp_course *course, const struct jp_pose_field *field,
                                        const struct jp_lattice_pose *from, const struct jp_point *start)
{
    if (course == NULL || field == NULL || from == NULL || start == NULL) {
        return JP_ERR_ARGUMENT;
    }

    const jp_cost cost = jp_pose_field_cost(field, from->x, from->y, from->heading);

    if (cost == JP_COST_MAX) {
        return JP_ERR_NO_PLAN;
    }
    course->internal = (struct jp_course_internal){.field = field, .lattice = field->lattice};
    start_at(course, start, &(struct jp_course_place){.pose = *from, .cost = -(int64_t)cost});
    return JP_OK;
}

enum jp_course_answer jp_course_work(struct jp_course *course)
{
    if (course->answer != JP_COURSE_JOINING) {
        return course->answer;
    }
    if (advance(course)) {
        look(course);
    } else if (course->internal.has_best) {
        add_leg(course);
    } else {
        retry(course);
    }
    return course->answer;
}

struct jp_point jp_course_begin(const struct jp_course *course, unsigned index)
{
    return index == 0U ? course->internal.start : course->config.legs[index - 1U].end;
}

void jp_course_begin_at(struct jp_course *course, unsigned index, const struct jp_point *begin)
{
    if (index == 0U) {
        course->internal.start = *begin;
    } else {
        course->config.legs[index - 1U].end = *begin;
    }
}

/** Where the robot gets to that goes beyond the end of a leg. */
static struct jp_point beyond(const struct jp_course *course, unsigned index)
{
    const struct jp_course_leg *leg = &course->config.legs[index];
    const struct jp_point begin = jp_course_begin(course, index);
    const jp_angle direction = jp_atan2(jp_sub(leg->end.y, begin.y), jp_sub(leg->end.x, begin.x));

    return (struct jp_point){jp_add(leg->end.x, jp_multiply_shift(leg->beyond, jp_cos(direction), 31)),
                             jp_add(leg->end.y, jp_multiply_shift(leg->beyond, jp_sin(direction), 31))};
}

jp_q16 jp_course_room(const struct jp_course *course, const struct jp_point *from)
{
    const jp_q16 radius = course->config.radius;
    const jp_q16 cell = course->config.terrain->config.resolution;
    const jp_q16 least = radius - cell / 4 < cell ? cell / 4 - radius : -cell;
    const jp_q16 step = cell < ROOM_STEPS ? 1 : cell / ROOM_STEPS;
    jp_q16 room = 0;

    while (room > least && !is_clear(course, from, from, jp_add(radius, room))) {
        room = jp_sub(room, step);
    }
    return room > least ? room : least;
}

bool jp_course_is_clear(const struct jp_course *course, unsigned index, const struct jp_point *from)
{
    const struct jp_course_leg *leg = &course->config.legs[index];
    const struct jp_point end = beyond(course, index);

    return is_clear(course, from, &end, jp_add(jp_add(course->config.radius, leg->margin), leg->aside));
}
