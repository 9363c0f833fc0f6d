#include "src/local/patrol_yield.h"

#include "src/base/plane.h"
#include "src/local/patrol_glide.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_turn.h"

/* What is foreseen, s, and how finely; by who has waited for people for long, less: they must stop in time, but may
 * have to stop where somebody walks. */
#define HORIZON           4.0f
#define HORIZON_IMPATIENT 2.5f
#define PATIENT           5.0f
#define IMPATIENT         30.0f
#define STEP              0.25f
#define STEPS             16U

/* From somebody's change of mind until the tracker knows, s; so much longer of who stands. */
#define NOTICE          0.3f
#define NOTICE_STANDING 0.2f

/* What a distance may err by, m: nearer, the robot may be touched. */
#define TOUCH 0.08f

/* Of a radius over what is seen of it: beams miss the rims, so that the middle of what is seen lies before its own. */
#define WHOLE 1.4f

/* Nobody alone is larger, m; sightings until a motion is heeded, of who was first seen where nothing had been too, and
 * scans without one for which it still is. */
#define PERSON_MAX    0.35f
#define SIGHTINGS_MIN 4U
#define ARRIVED_MIN   2U
#define UNSEEN_MAX    5U

/* Who seems to set off is faster than so many standard deviations of the velocity along an axis. */
#define LIKELY 2.0f

/* Nearer than standing still by this is nearer, m: rounding. */
#define NEARER 0.002f

/* By which it passes before somebody, s. */
#define GAP 0.5f

/* Beyond this the uncertainty of a direction grows no further, s. */
#define SPREAD_TIME 0.5f

/* Towards things the robot is the slower the nearer it comes to what it keeps from them. Where there is no more, it
 * passes them creeping, in m/s, but no nearer than the laser and its own control are exact, m. */
#define CREEP         0.1f
#define CLEARANCE_MIN 0.03f

/* Of the highest speed: at less it may come nearer to who stays, and at how much as near as to things. */
#define SLOW     0.5f
#define CREEPING 0.15f

/* Slower than this the robot stands, m/s. */
#define STANDING 0.05f

/* Cycles of braking that are asked of the wheels at once: more than they can. */
#define BRAKED_PERIODS 2.0f

/* m/s */
#define UNLIMITED 1000.0f

/* A slower turn does not end, rad/s. */
#define LEAST 1.0e-3f

/* ---- The robot ---- */

/* What it plans: poses, and the way to each as its outermost point goes, m. */
struct yield_course {
    struct jp_plane_pose poses[JP_TEB_POSES_MAX];
    float way[JP_TEB_POSES_MAX];
    float speed[JP_TEB_POSES_MAX]; /* to the next pose at most, m/s */
    unsigned count;
};

static float reach_of(const struct jp_footprint *footprint)
{
    return jp_plane_length(jp_plane_larger(footprint->front, footprint->rear), footprint->half_width);
}

/* Of the outermost point. */
static float way_between(const struct jp_footprint *footprint, const struct jp_plane_pose *a,
                         const struct jp_plane_pose *b)
{
    const float turn = jp_plane_wrap(b->heading - a->heading);

    return jp_plane_length(b->x - a->x, b->y - a->y) + reach_of(footprint) * jp_plane_magnitude(turn);
}

static void add_pose(const struct jp_patrol *patrol, struct yield_course *course, const struct jp_plane_pose *pose)
{
    const unsigned i = course->count;

    course->way[i] =
        i > 0U ? course->way[i - 1U] + way_between(&patrol->config.teb.footprint, &course->poses[i - 1U], pose) : 0.0f;
    course->poses[i] = *pose;
    course->speed[i] = UNLIMITED;
    course->count++;
}

/* A band plans to be slow where somebody walks. */
static void lay_out_band(const struct jp_teb *teb, const struct jp_patrol *patrol, struct yield_course *course)
{
    for (unsigned i = 1; i < teb->count; i++) {
        add_pose(patrol, course, &teb->poses[i].pose);
        course->speed[i - 1U] =
            jp_plane_larger(way_between(&teb->config.footprint, &teb->poses[i - 1U].pose, &teb->poses[i].pose) /
                                teb->poses[i - 1U].interval,
                            STANDING);
    }
}

/* Until a step or a turn in place, as fast as it is commanded, has come to its end, s. */
static float time_left(const struct jp_patrol *patrol)
{
    const struct jp_patrol_internal *const internal = &patrol->internal;
    const float speed = jp_plane_length(internal->command.forward, internal->sideways);

    if (patrol->state == JP_PATROL_STEPPING && speed > 0.0f) {
        return jp_plane_length(internal->step_target.x - patrol->pose.x, internal->step_target.y - patrol->pose.y) /
               speed;
    }
    if (patrol->state == JP_PATROL_TURNING) {
        return jp_plane_magnitude(internal->turn_remaining) /
               jp_plane_larger(jp_plane_magnitude(internal->command.turn_rate), LEAST);
    }
    return STEP * (float)STEPS;
}

static void lay_out_command(const struct jp_patrol *patrol, struct yield_course *course)
{
    struct jp_plane_pose pose = patrol->pose;
    float left = time_left(patrol);

    for (unsigned i = 0; i < STEPS && left > 0.0f; i++) {
        const float time = jp_plane_smaller(left, STEP);
        const struct jp_plane_pose step = {time * patrol->internal.command.forward, time * patrol->internal.sideways,
                                           time * patrol->internal.command.turn_rate};

        pose = jp_plane_compose(&pose, &step);
        add_pose(patrol, course, &pose);
        left -= time;
    }
}

static void lay_out_glide(const struct jp_patrol *patrol, struct yield_course *course)
{
    const unsigned count = jp_patrol_foresee_glide(patrol, &course->poses[1], JP_TEB_POSES_MAX - 1U);

    for (unsigned i = 1; i <= count; i++) {
        const struct jp_plane_pose pose = course->poses[i];

        add_pose(patrol, course, &pose);
    }
}

/* As the band plans, or the glide leads on; else as the command does. */
static void lay_out(const struct jp_patrol *patrol, struct yield_course *course)
{
    course->count = 0;
    add_pose(patrol, course, &patrol->pose);
    if (patrol->state == JP_PATROL_DRIVING) {
        lay_out_band(&patrol->teb, patrol, course);
    } else if (patrol->state == JP_PATROL_GLIDING) {
        lay_out_glide(patrol, course);
    } else {
        lay_out_command(patrol, course);
    }
}

/* The pose before a place on the way. */
static unsigned index_at(const struct yield_course *course, float way)
{
    unsigned i = 0;

    while (i + 2U < course->count && course->way[i + 1U] < way) {
        i++;
    }
    return i;
}

static struct jp_plane_pose pose_at(const struct yield_course *course, float way)
{
    const unsigned i = index_at(course, way);

    if (course->count < 2U) {
        return course->poses[0];
    }

    const float length = course->way[i + 1U] - course->way[i];
    const float share = length > 0.0f ? jp_plane_clamp((way - course->way[i]) / length, 0.0f, 1.0f) : 0.0f;
    const struct jp_plane_pose *const a = &course->poses[i];
    const struct jp_plane_pose *const b = &course->poses[i + 1U];

    return (struct jp_plane_pose){a->x + share * (b->x - a->x), a->y + share * (b->y - a->y),
                                  a->heading + share * jp_plane_wrap(b->heading - a->heading)};
}

/* How it drives on: from a speed now to another, which it keeps. */
struct profile {
    float now;
    float then;
    float acceleration;
    float latency;
};

static float speed_after(const struct profile *profile, float time)
{
    const float changed = profile->acceleration * jp_plane_larger(time - profile->latency, 0.0f);

    return profile->then > profile->now ? jp_plane_smaller(profile->now + changed, profile->then)
                                        : jp_plane_larger(profile->now - changed, profile->then);
}

/* ---- People ---- */

static bool is_person(const struct jp_patrol *patrol, const struct jp_mover *mover)
{
    return mover->pace > 0.0f && mover->standing < patrol->config.people.stays;
}

/* From the present place along the walk, after a time in which somebody at a speed stops, turns round and walks back
 * at their pace, m. */
static float way_back(float speed, float pace, float acceleration, float time)
{
    const float to_stop = speed / acceleration;
    const float to_pace = pace / acceleration;

    if (time < to_stop) {
        return speed * time - 0.5f * acceleration * time * time;
    }
    const float stopped = 0.5f * speed * to_stop;
    const float back = time - to_stop;

    return back < to_pace ? stopped - 0.5f * acceleration * back * back
                          : stopped - 0.5f * pace * to_pace - pace * (back - to_pace);
}

/* From the present place, after a time in which somebody at a speed goes on, and speeds up to their pace, m. */
static float way_on(float speed, float pace, float acceleration, float time)
{
    const float faster = jp_plane_larger(pace - speed, 0.0f);
    const float speeding_up = jp_plane_smaller(time, faster / acceleration);

    return speed * time + faster * (time - speeding_up) + 0.5f * acceleration * speeding_up * speeding_up;
}

/* Where somebody may be after a time, along their walk, m: if they turned round as late as the robot could no longer
 * stop in time, or when they were last seen, and if they go on, and so much later. */
static void find_place(const struct jp_patrol *patrol, const struct jp_mover *mover, float time, float stop, float gap,
                       struct jp_obstacle *place)
{
    const struct jp_patrol_people *const people = &patrol->config.people;
    const float unseen = (float)mover->misses * patrol->config.period;
    const float measured = jp_plane_length(mover->velocity.x, mover->velocity.y);
    const bool is_walking = measured > patrol->config.movers.speed_min;
    const float speed = is_walking ? measured : 0.0f;
    const struct jp_plane_point along =
        is_walking ? (struct jp_plane_point){mover->velocity.x / speed, mover->velocity.y / speed} : mover->walk;
    const float notice = is_walking ? 0.0f : NOTICE_STANDING;
    const float late = jp_plane_smaller(time, stop + notice) + unseen;
    const float turned = way_back(speed, mover->pace, people->acceleration, late);
    const float back = speed * (time - late) + turned;
    const float on = is_walking ? way_on(speed, mover->pace, people->acceleration, time + gap) : -turned;
    const float deviation = jp_plane_square_root(mover->speed_variance);

    place->vertices[0] = (struct jp_plane_point){mover->centre.x + back * along.x, mover->centre.y + back * along.y};
    place->vertices[1] = (struct jp_plane_point){mover->centre.x + on * along.x, mover->centre.y + on * along.y};
    place->vertex_count = 2;
    place->radius = WHOLE * mover->radius + deviation * jp_plane_smaller(time, SPREAD_TIME);
}

/* ---- Both ---- */

/* What comes of driving on in some way. */
struct yield_outlook {
    bool is_free;
    float nearest; /* distance from where people may be while the robot moves, or has not stood for long, m */
};

/* From the moment at which the robot is to brake until nobody can touch it but who walks into it, s. */
static float time_to_rest(const struct jp_patrol *patrol, float speed)
{
    return patrol->config.latency + speed / patrol->config.people.braking + patrol->config.people.rest;
}

/* Who stays may begin to walk: the nearer the robot is, the slower it moves. */
static float clearance_at(const struct jp_patrol *patrol, float speed)
{
    const float share = (speed / patrol->config.teb.speed_max - CREEPING) / (SLOW - CREEPING);

    return patrol->config.people.clearance * jp_plane_clamp(share, 0.0f, 1.0f);
}

/* Who moves as people do without having left their place yet: a thing that the robot passes seems to for a moment, so
 * that this is soon forgotten. */
static bool may_be_setting_off(const struct jp_patrol *patrol, const struct jp_mover *mover)
{
    const float speed = jp_plane_length(mover->velocity.x, mover->velocity.y);

    return mover->radius < PERSON_MAX && mover->sightings >= (mover->has_come ? ARRIVED_MIN : SIGHTINGS_MIN) &&
           mover->misses <= UNSEEN_MAX && speed > patrol->config.movers.speed_min &&
           speed * speed > LIKELY * LIKELY * mover->speed_variance;
}

/* Of those who are nobody who may walk on. */
static bool is_stander(const struct jp_mover *mover)
{
    return mover->pace > 0.0f && mover->misses == 0U;
}

/* How near it may come to who stays, and how near it does; creeping, as near as to any thing. */
static void look_at_stander(const struct jp_patrol *patrol, const struct jp_mover *mover,
                            const struct jp_plane_pose *pose, float speed, struct yield_outlook *outlook)
{
    const struct jp_footprint *const footprint = &patrol->config.teb.footprint;
    struct jp_obstacle place = {.vertex_count = 1, .radius = mover->radius};

    place.vertices[0] = mover->centre;

    const float distance = jp_obstacle_distance(footprint, pose, &place, NULL);
    const float clearance = clearance_at(patrol, speed);

    if (clearance > 0.0f && distance < clearance &&
        distance < jp_obstacle_distance(footprint, &patrol->pose, &place, NULL) - NEARER) {
        outlook->is_free = false;
        outlook->nearest = jp_plane_smaller(distance, outlook->nearest);
    }
}

/* Of who has waited for people: 0 at first, 1 in the end. */
static float impatience(const struct jp_patrol *patrol)
{
    return jp_plane_clamp((patrol->internal.yielded - PATIENT) / (IMPATIENT - PATIENT), 0.0f, 1.0f);
}

/* That is kept from who walks: where people walk to and fro so near that it cannot leave with more, what it keeps from
 * things. */
static float walker_clearance(const struct jp_patrol *patrol)
{
    const float most = patrol->config.people.clearance;

    return most - impatience(patrol) * jp_plane_larger(most - JP_PATROL_CLEARANCE, 0.0f);
}

/* At somebody who walks, or may, from a pose after a time. */
static void look_at_walker(const struct jp_patrol *patrol, const struct jp_mover *mover,
                           const struct jp_plane_pose *pose, float time, float stop, struct yield_outlook *outlook)
{
    const struct jp_footprint *const footprint = &patrol->config.teb.footprint;
    struct jp_obstacle place;

    find_place(patrol, mover, time, stop, GAP * (1.0f - impatience(patrol)), &place);

    const float distance = jp_obstacle_distance(footprint, pose, &place, NULL);

    if (distance < TOUCH || (distance < walker_clearance(patrol) &&
                             distance < jp_obstacle_distance(footprint, &patrol->pose, &place, NULL) - NEARER)) {
        outlook->is_free = false;
    }
    if (distance < outlook->nearest) {
        find_place(patrol, mover, time, stop, 0.0f, &place);
        outlook->nearest = jp_plane_smaller(jp_obstacle_distance(footprint, pose, &place, NULL), outlook->nearest);
    }
}

/* At a pose after a time, at a speed. */
static void look_at(const struct jp_patrol *patrol, const struct jp_plane_pose *pose, float time, float speed,
                    struct yield_outlook *outlook)
{
    const float stop = NOTICE + time_to_rest(patrol, speed);

    for (unsigned i = 0; i < patrol->movers.count; i++) {
        const struct jp_mover *const mover = &patrol->movers.movers[i];

        if (is_person(patrol, mover) || may_be_setting_off(patrol, mover)) {
            look_at_walker(patrol, mover, pose, time, stop, outlook);
        } else if (is_stander(mover)) {
            look_at_stander(patrol, mover, pose, speed, outlook);
        } else {
            /* A thing. */
        }
    }
}

static struct yield_outlook look_along(const struct jp_patrol *patrol, const struct yield_course *course,
                                       const struct profile *profile, float horizon)
{
    struct yield_outlook outlook = {true, JP_OBSTACLE_NONE};
    float before = profile->now;
    float past = 0.0f;
    float way = 0.0f;

    for (unsigned i = 1; i <= STEPS && STEP * (float)(i - 1U) < horizon; i++) {
        const float time = jp_plane_smaller(STEP * (float)i, horizon);
        const float planned = course->speed[index_at(course, way)];
        const float speed = jp_plane_smaller(speed_after(profile, time), planned);

        way += 0.5f * (time - past) * (speed + before);
        before = speed;
        past = time;

        const struct jp_plane_pose pose = pose_at(course, way);

        look_at(patrol, &pose, time, speed, &outlook);
    }
    return outlook;
}

static bool sees_anybody(const struct jp_patrol *patrol)
{
    for (unsigned i = 0; i < patrol->movers.count; i++) {
        if (patrol->movers.movers[i].pace > 0.0f || may_be_setting_off(patrol, &patrol->movers.movers[i])) {
            return true;
        }
    }
    return false;
}

/* Who may walk on: they make way sometime. */
static bool sees_people(const struct jp_patrol *patrol)
{
    for (unsigned i = 0; i < patrol->movers.count; i++) {
        if (is_person(patrol, &patrol->movers.movers[i])) {
            return true;
        }
    }
    return false;
}

static float speed_of(const struct jp_patrol *patrol, float forward, float sideways, float turn_rate)
{
    return jp_plane_length(forward, sideways) + reach_of(&patrol->config.teb.footprint) * jp_plane_magnitude(turn_rate);
}

/* How near it comes to people until it has stood for a rest, the notice apart that keeps it from getting there; one
 * that stands already is not asked to do anything. */
static float nearest_if_braked(const struct jp_patrol *patrol, const struct yield_course *course, float now)
{
    const struct profile profile = {now, 0.0f, patrol->config.people.braking, patrol->config.latency};

    return now < STANDING ? JP_OBSTACLE_NONE
                          : look_along(patrol, course, &profile, time_to_rest(patrol, now) - NOTICE).nearest;
}

/* Never less than it takes to be at rest after somebody has turned round. */
static float horizon_of(const struct jp_patrol *patrol, float speed)
{
    return jp_plane_larger(HORIZON - (HORIZON - HORIZON_IMPATIENT) * impatience(patrol),
                           NOTICE + time_to_rest(patrol, speed));
}

/* The highest speed that is safe; where none is, 0, unless the robot would be touched before it is at rest, and would
 * not at another speed: then that at which it stays farthest from people. */
static float safe_speed(const struct jp_patrol *patrol, float now)
{
    /* Of the highest speed. */
    static const float shares[] = {1.0f, 0.75f, 0.5f, 0.3f, CREEPING};
    struct yield_course course;
    float best = 0.0f;

    lay_out(patrol, &course);

    const float if_braked = nearest_if_braked(patrol, &course, now);
    float nearest = jp_plane_larger(if_braked, TOUCH);

    for (unsigned i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        const float speed = patrol->config.teb.speed_max * shares[i];
        const struct profile profile = {now, speed, patrol->config.teb.acceleration, patrol->config.latency};
        const float horizon = horizon_of(patrol, jp_plane_larger(now, speed));
        const struct yield_outlook outlook = look_along(patrol, &course, &profile, horizon);

        if (outlook.is_free) {
            return speed;
        }
        if (outlook.nearest > nearest) {
            nearest = outlook.nearest;
            best = speed;
        }
    }
    return if_braked > TOUCH ? 0.0f : best;
}

/* The command slowed down to a speed, with its curve kept. */
static void slow_down(struct jp_patrol *patrol, float wanted, float speed)
{
    const float share = jp_plane_smaller(speed / wanted, 1.0f);

    patrol->internal.command.forward *= share;
    patrol->internal.command.turn_rate *= share;
    patrol->internal.sideways *= share;
}

/* In a glide what is asked is not 0 while it moves, but less than wheels that brake as hard as they can reach: at 0
 * they would no longer be steered, and lead it off the glide along the curve of that moment, where nothing says that it
 * is free. */
static float braked(const struct jp_patrol *patrol, const struct jp_plane_speed *speed, float now)
{
    const float forward = jp_plane_magnitude(speed->forward);

    if (patrol->state != JP_PATROL_GLIDING || forward <= STANDING) {
        return 0.0f;
    }

    const float braking = jp_patrol_braking(&patrol->config, forward, speed->turn_rate);

    return now * jp_plane_larger(1.0f - BRAKED_PERIODS * patrol->config.period * braking / forward, 0.0f);
}

/* Where the robot is once it has gone so far as it goes now, m. */
static struct jp_plane_pose pose_after(const struct jp_patrol *patrol, float wanted, float way)
{
    const float time = way / wanted;
    const struct jp_plane_pose step = {time * patrol->internal.command.forward, time * patrol->internal.sideways,
                                       time * patrol->internal.command.turn_rate};

    return jp_plane_compose(&patrol->pose, &step);
}

/* The nearer something is on its way, the slower: it could stop before it came nearer than in a turn on the spot. What
 * it passes at the same distance does not slow it. */
static void heed_clearance(struct jp_patrol *patrol)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const float wanted = jp_plane_length(patrol->internal.command.forward, patrol->internal.sideways);

    if (wanted <= 0.0f) {
        return;
    }

    const float braking = jp_patrol_braking(config, wanted, patrol->internal.command.turn_rate);
    const float delay = config->latency + 0.5f * config->period;
    const float way = wanted * (delay + 0.5f * wanted / braking);
    const struct jp_plane_pose stopped = pose_after(patrol, wanted, way);
    const float here = jp_patrol_clearance(patrol, &patrol->pose);
    const float nearer = here - jp_patrol_clearance(patrol, &stopped);

    if (nearer > 0.0f) {
        const float whole = jp_plane_larger(way * (here - JP_PATROL_CLEARANCE) / nearer, 0.0f);
        const float least = jp_plane_larger(way * (here - CLEARANCE_MIN) / nearer, 0.0f);

        slow_down(patrol, wanted,
                  jp_plane_larger(jp_patrol_stopping_speed(config, braking, whole),
                                  jp_plane_smaller(jp_patrol_stopping_speed(config, braking, least), CREEP)));
    }
}

float jp_patrol_speed_beside(const struct jp_patrol_config *config, float distance)
{
    const float most = config->teb.speed_max;

    return distance < JP_PATROL_CLEARANCE ? jp_plane_smaller(CREEP, most) : most;
}

/* What it drives is worth half as much: who creeps on gains little. */
static void count_wait(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    const float period = patrol->config.period;
    const bool stands = patrol->internal.is_yielding && jp_patrol_is_standing(speed);

    patrol->internal.yielded = jp_plane_larger(patrol->internal.yielded + (stands ? period : -0.5f * period), 0.0f);
}

void jp_patrol_yield(struct jp_patrol *patrol, const struct jp_plane_speed *speed)
{
    heed_clearance(patrol);

    const bool was_yielding = patrol->internal.is_yielding;
    const struct jp_plane_speed *const command = &patrol->internal.command;
    const float wanted = speed_of(patrol, command->forward, patrol->internal.sideways, command->turn_rate);

    /* Who has yielded and stands, for whatever reason now, would get on without people. */
    patrol->internal.is_yielding =
        (patrol->state == JP_PATROL_WAITING || (was_yielding && wanted <= 0.0f)) && sees_people(patrol);
    if (wanted > 0.0f && sees_anybody(patrol)) {
        const float now = speed_of(patrol, speed->forward, patrol->internal.sideways_before, speed->turn_rate);
        const float safe = safe_speed(patrol, now);

        if (safe < wanted) {
            slow_down(patrol, wanted, jp_plane_larger(safe, braked(patrol, speed, now)));
            patrol->internal.is_yielding = sees_people(patrol);
            patrol->counts.yields += was_yielding || !patrol->internal.is_yielding ? 0U : 1U;
        }
    }
    patrol->internal.sideways_before = patrol->internal.sideways;
    count_wait(patrol, speed);
}
