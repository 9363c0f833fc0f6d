#include "sim/scenes/contact.h"

#include <math.h>

#include "sim/base/strict_math.h"

#define SECOND     1.0  /* s */
#define TRY_STEP   0.1  /* between instants at which the robot might have braked, s */
#define DRIVE_STEP 0.01 /* of driving again, s */

void contact_keep(struct contact_history *history, const struct contact_moment *moment)
{
    history->moments[history->next] = *moment;
    history->next = (history->next + 1) % CONTACT_MOMENTS;
    history->count = history->count < CONTACT_MOMENTS ? history->count + 1 : history->count;
}

/* From the oldest on. */
static const struct contact_moment *moment_at(const struct contact_history *history, size_t i)
{
    return &history->moments[(history->next + CONTACT_MOMENTS - history->count + i) % CONTACT_MOMENTS];
}

static const struct contact_moment *last_of(const struct contact_history *history)
{
    return moment_at(history, history->count - 1);
}

/* The first moment that is not before a time. */
static size_t index_at(const struct contact_history *history, double time)
{
    size_t i = 0;

    while (i + 1 < history->count && moment_at(history, i)->time < time - 1e-9) {
        i++;
    }
    return i;
}

/* How far any point of the robot has moved at most, m. */
static double way_between(const struct contact_robot *robot, const struct planar_pose *from,
                          const struct planar_pose *to)
{
    return strict_hypot(to->x - from->x, to->y - from->y) +
           strict_hypot(robot->half_length, robot->half_width) * fabs(planar_wrap(to->heading - from->heading));
}

static struct planar_point into_frame(const struct planar_pose *pose, const struct planar_point *point)
{
    const struct planar_pose there = {point->x, point->y, 0};
    const struct planar_pose at = planar_between(pose, &there);

    return (struct planar_point){at.x, at.y};
}

static double limited(double value, double limit)
{
    return fmin(fmax(value, -limit), limit);
}

/* Nearest point of the robot to a person, in its frame. */
static struct planar_point nearest_point(const struct contact_robot *robot, const struct planar_point *there)
{
    return (struct planar_point){limited(there->x, robot->half_length), limited(there->y, robot->half_width)};
}

static double distance_of(const struct contact_robot *robot, const struct planar_pose *pose,
                          const struct planar_point *person, double radius)
{
    const struct planar_point there = into_frame(pose, person);
    const struct planar_point nearest = nearest_point(robot, &there);

    return strict_hypot(there.x - nearest.x, there.y - nearest.y) - radius;
}

static bool has_moved(const struct contact_history *history, const struct contact_robot *robot)
{
    const struct contact_moment *const last = last_of(history);
    double most = 0;

    for (size_t i = index_at(history, last->time - SECOND); i < history->count; i++) {
        most = fmax(most, way_between(robot, &moment_at(history, i)->robot, &last->robot));
    }
    return most > CONTACT_MOVED;
}

static bool has_moved_into(const struct contact_history *history, const struct contact_robot *robot,
                           const struct contact_person *person)
{
    const struct contact_moment *const last = last_of(history);
    const struct planar_point *const at = &last->people[person->index];
    const struct planar_point there = into_frame(&last->robot, at);
    const struct planar_point touched = nearest_point(robot, &there);
    const struct planar_point now = planar_place(&last->robot, touched);
    const double length = strict_hypot(at->x - now.x, at->y - now.y);
    double most = 0;

    for (size_t i = index_at(history, last->time - SECOND); i < history->count && length > 0; i++) {
        const struct planar_point then = planar_place(&moment_at(history, i)->robot, touched);

        most = fmax(most, ((now.x - then.x) * (at->x - now.x) + (now.y - then.y) * (at->y - now.y)) / length);
    }
    return length == 0 || most > CONTACT_MOVED;
}

/* ---- Driven again ---- */

/* A robot that brakes from a moment on, on the way that it took. */
struct braked {
    const struct contact_history *history;
    const struct contact_robot *robot;
    const struct contact_person *person;
    size_t reached; /* the moment whose pose it has passed */
    double beyond;  /* so far, m */
    double speed;
};

static double step_length(const struct braked *braked, size_t i)
{
    return way_between(braked->robot, &moment_at(braked->history, i)->robot, &moment_at(braked->history, i + 1)->robot);
}

static double speed_at(const struct braked *braked, size_t i)
{
    const size_t from = i > 0 ? i - 1 : i;
    const size_t to = i + 1 < braked->history->count ? i + 1 : i;
    double way = 0;

    for (size_t k = from; k < to; k++) {
        way += step_length(braked, k);
    }
    return way / (moment_at(braked->history, to)->time - moment_at(braked->history, from)->time);
}

/* Drives on for a way, but not beyond where the robot was at a moment. */
static void drive_on(struct braked *braked, double way, size_t most)
{
    braked->beyond += way;
    while (braked->reached < most && braked->beyond >= step_length(braked, braked->reached)) {
        braked->beyond -= step_length(braked, braked->reached);
        braked->reached++;
    }
    if (braked->reached >= most) {
        braked->beyond = 0;
    }
}

static struct planar_pose pose_of(const struct braked *braked)
{
    const struct planar_pose from = moment_at(braked->history, braked->reached)->robot;

    if (braked->beyond <= 0) {
        return from;
    }
    const struct planar_pose to = moment_at(braked->history, braked->reached + 1)->robot;
    const double share = braked->beyond / step_length(braked, braked->reached);

    return (struct planar_pose){from.x + share * (to.x - from.x), from.y + share * (to.y - from.y),
                                from.heading + share * planar_wrap(to.heading - from.heading)};
}

/* As it was, and after the touch as it would go on. */
static struct planar_point person_at(const struct braked *braked, double time)
{
    const struct contact_moment *const last = last_of(braked->history);
    const size_t index = braked->person->index;

    if (time <= last->time) {
        return moment_at(braked->history, index_at(braked->history, time))->people[index];
    }
    return (struct planar_point){last->people[index].x + (time - last->time) * braked->person->velocity.x,
                                 last->people[index].y + (time - last->time) * braked->person->velocity.y};
}

static bool is_touched(const struct braked *braked, double time)
{
    const struct planar_pose pose = pose_of(braked);
    const struct planar_point at = person_at(braked, time);

    return distance_of(braked->robot, &pose, &at, braked->person->radius) < CONTACT_NEAR;
}

/* Whether it would have stood for a second before it is touched, had it braked from a moment on. */
static bool helps(struct braked braked, size_t from)
{
    double time = moment_at(braked.history, from)->time;
    double stands = 0;

    braked.reached = from;
    braked.speed = speed_at(&braked, from);
    while (stands < SECOND) {
        const double slower = fmax(braked.speed - braked.robot->deceleration * DRIVE_STEP, 0);

        time += DRIVE_STEP;
        drive_on(&braked, (braked.speed + slower) / 2 * DRIVE_STEP, index_at(braked.history, time));
        stands += braked.speed == 0 ? DRIVE_STEP : 0;
        braked.speed = slower;
        if (is_touched(&braked, time)) {
            return false;
        }
    }
    return true;
}

static bool is_avoidable(const struct contact_history *history, const struct contact_robot *robot,
                         const struct contact_person *person)
{
    const double last = last_of(history)->time;
    const double first = fmax(person->since, last - CONTACT_HISTORY);
    const struct braked braked = {.history = history, .robot = robot, .person = person};

    for (int i = 0; first + i * TRY_STEP < last; i++) {
        if (helps(braked, index_at(history, first + i * TRY_STEP))) {
            return true;
        }
    }
    return false;
}

struct contact_verdict contact_judge(const struct contact_history *history, const struct contact_robot *robot,
                                     const struct contact_person *person)
{
    return (struct contact_verdict){.has_moved = has_moved(history, robot),
                                    .moved_into = has_moved_into(history, robot, person),
                                    .avoidable = is_avoidable(history, robot, person)};
}
