#include "src/local/patrol_glide.h"

#include "src/base/plane.h"
#include "src/local/patrol_price.h"
#include "src/local/patrol_room.h"
#include "src/local/patrol_state.h"
#include "src/local/patrol_turn.h"

/* The robot steers to what is this far ahead on its path, m. */
#define AIM_DISTANCE 0.35f

/* The turn after a glide into a goal keeps this, m. */
#define CLEARANCE_MIN 0.03f

/* Between the poses that are checked, m, and how far a glide is looked ahead at its beginning. */
#define STEP_LENGTH 0.1f
#define STEPS_MAX   25U

/* A glide along the path ends within this of its direction, rad. */
#define ALONG 0.17f

/* Wheels keep this from their steering limit, rad: they follow behind what is asked. */
#define STEERING_MARGIN 0.1f

/* A wheel's axis is led askew by so much at the start and at the end of a glide at most, rad: from there the rest of
 * the turn takes little way. */
#define ASKEW_MARGIN 0.15f

/* A wheel that may be steered either way keeps its way within this, rad. */
#define ALIKE_MARGIN 0.04f

/* A glide into a goal begins at this distance at most, and so much farther for each radian, m; nearer, it turns less.
 */
#define IN_DISTANCE         0.3f
#define IN_PER_RADIAN       0.9f
#define IN_PER_RADIAN_LEAST 0.6f

/* Tangent of the angle by which a wheel is steered in a cycle at most, half of what would make it stop for it, and
 * the least part of a change that is asked for at once. */
#define STEERED_MAX 0.27f
#define SHARE_MIN   0.1f

/* A glide from a stand begins straight on, until it has come so far, m: the wheels are steered alike meanwhile. */
#define SET_OFF_DISTANCE 0.015f
#define SET_OFF_SPEED    0.1f

/* It turns faster at first, so that it comes to the goal with its heading. */
#define EARLIER 1.3f

/* A glide into the goal begins so long before the last moment at which its turn does not slow the robot down, s. */
#define DUE 0.15f

#define TURN_PER_UNIT (2.0f * JP_PLANE_PI / 4294967296.0f)
#define Q24           (1.0f / (float)JP_Q24_ONE)

/* ---- Geometry ---- */

static float larger(float a, float b)
{
    return a > b ? a : b;
}

static float smaller(float a, float b)
{
    return a < b ? a : b;
}

/* Of a wheel from the centre, m. */
static float arm_of(const struct jp_patrol *patrol)
{
    const struct jp_four_wheel_config *const wheels = &patrol->config.wheels;

    return 0.5f * jp_plane_length((float)wheels->wheelbase * Q24, (float)wheels->track * Q24);
}

/* Angle between heading and way that the wheels can take without a turn, rad. */
static float askew_limit(const struct jp_patrol_config *config)
{
    return (float)config->wheels.steering_limit * TURN_PER_UNIT - STEERING_MARGIN;
}

/* From beyond it, a wheel would rather be steered the other way round, and roll backwards. */
float jp_patrol_askew_max(const struct jp_patrol_config *config)
{
    const float limit = askew_limit(config);

    return smaller(limit - ASKEW_MARGIN, JP_PLANE_PI - limit - STEERING_MARGIN - ALIKE_MARGIN);
}

/* What the robot may turn in a metre of its way, rad: as long as no wheel comes to its limit. */
static float turn_per_metre(const struct jp_patrol *patrol, float askew)
{
    const float left = smaller(askew_limit(&patrol->config) - jp_plane_magnitude(askew), 0.5f * JP_PLANE_PI);

    return jp_plane_sine(larger(left, 0.0f)) / arm_of(patrol);
}

static struct jp_plane_point point_at(const struct jp_patrol *patrol, uint16_t i)
{
    if (i + 1U < patrol->internal.path_count) {
        return jp_patrol_path_point(&patrol->internal.path[i]);
    }
    return (struct jp_plane_point){patrol->internal.goal.pose.x, patrol->internal.goal.pose.y};
}

/* Direction from a pose to the path ahead; *next moves on along it. */
static float direction_from(const struct jp_patrol *patrol, const struct jp_plane_pose *pose, uint16_t *next)
{
    struct jp_plane_point aim = point_at(patrol, *next);

    while (*next + 1U < patrol->internal.path_count &&
           jp_plane_length(aim.x - pose->x, aim.y - pose->y) < AIM_DISTANCE) {
        (*next)++;
        aim = point_at(patrol, *next);
    }
    return jp_plane_bearing(aim.x - pose->x, aim.y - pose->y);
}

static float goal_distance(const struct jp_patrol *patrol, const struct jp_plane_pose *pose)
{
    return jp_plane_length(patrol->internal.goal.pose.x - pose->x, patrol->internal.goal.pose.y - pose->y);
}

/* ---- Ahead ---- */

/* A glide as it is foreseen. */
struct glide {
    struct jp_plane_pose pose;
    float clearance; /* that is kept, m */
    uint16_t next;
    float heading; /* at its end, where it leads to the goal */
    bool is_to_goal;
    bool is_begun;
    float speed; /* m/s */
};

static float turn_of(const struct jp_patrol *patrol, const struct glide *glide, float askew, float step)
{
    const float remaining = glide->is_to_goal ? jp_plane_wrap(glide->heading - glide->pose.heading) : askew;
    const float away = larger(goal_distance(patrol, &glide->pose), step);
    const float due = glide->is_to_goal ? EARLIER * remaining * step / away : remaining;
    const float most = step * smaller(turn_per_metre(patrol, askew), patrol->config.turn_rate / glide->speed);

    return jp_plane_clamp(due, -most, most);
}

/* Of `steps` ahead, those before the first that is not free; all where the glide ends before. */
static unsigned free_steps(const struct jp_patrol *patrol, struct glide glide, unsigned steps)
{
    for (unsigned i = 1; i <= steps; i++) {
        const float direction = direction_from(patrol, &glide.pose, &glide.next);
        const float askew = jp_plane_wrap(direction - glide.pose.heading);
        const float step = smaller(STEP_LENGTH, goal_distance(patrol, &glide.pose));
        const struct jp_plane_point way = jp_plane_direction(direction);

        /* At the goal there is no direction to it. */
        if (step < 0.5f * STEP_LENGTH || (!glide.is_to_goal && jp_plane_magnitude(askew) < ALONG)) {
            return steps;
        }
        if (jp_plane_magnitude(askew) > askew_limit(&patrol->config)) {
            return glide.is_begun ? steps : i - 1U;
        }
        glide.pose.heading += turn_of(patrol, &glide, askew, step);
        glide.pose.x += step * way.x;
        glide.pose.y += step * way.y;
        if (jp_patrol_clearance_later(patrol, &glide.pose, (float)i * STEP_LENGTH / glide.speed) < glide.clearance) {
            return i - 1U;
        }
    }
    return steps;
}

static struct glide glide_from(const struct jp_patrol *patrol, const struct jp_plane_pose *pose)
{
    const bool is_begun = patrol->state == JP_PATROL_GLIDING;
    const float now = jp_patrol_clearance(patrol, &patrol->pose) - JP_PATROL_CLEARANCE_NOISE;

    return (struct glide){.pose = *pose,
                          .clearance = is_begun ? patrol->internal.glide_least
                                                : jp_plane_clamp(now, 0.0f, patrol->config.glide_clearance),
                          .next = patrol->internal.path_next,
                          .heading = patrol->internal.glide_heading,
                          .is_to_goal = patrol->internal.is_gliding_to_goal,
                          .is_begun = is_begun,
                          .speed = patrol->config.teb.speed_max};
}

unsigned jp_patrol_foresee_glide(const struct jp_patrol *patrol, struct jp_plane_pose *poses, unsigned most)
{
    struct glide glide = glide_from(patrol, &patrol->pose);
    unsigned count = 0;

    while (count < most && goal_distance(patrol, &glide.pose) > 0.5f * STEP_LENGTH) {
        const float direction = direction_from(patrol, &glide.pose, &glide.next);
        const float askew = jp_plane_wrap(direction - glide.pose.heading);
        const float step = smaller(STEP_LENGTH, goal_distance(patrol, &glide.pose));
        const struct jp_plane_point way = jp_plane_direction(direction);

        glide.pose.heading += turn_of(patrol, &glide, askew, step);
        glide.pose.x += step * way.x;
        glide.pose.y += step * way.y;
        poses[count] = glide.pose;
        count++;
    }
    return count;
}

static bool is_free(const struct jp_patrol *patrol, const struct glide *glide)
{
    return free_steps(patrol, *glide, STEPS_MAX) == STEPS_MAX;
}

static void begin(struct jp_patrol *patrol, const struct glide *glide, bool is_standing)
{
    if (!jp_patrol_trust_path(patrol)) {
        jp_patrol_stand(patrol);
        return;
    }
    patrol->internal.glide_heading = glide->heading;
    patrol->internal.glide_least = glide->clearance - JP_PATROL_CLEARANCE_NOISE;
    patrol->internal.is_setting_off = is_standing;
    patrol->internal.step_target = (struct jp_plane_point){patrol->pose.x, patrol->pose.y};
    patrol->internal.is_gliding_to_goal = glide->is_to_goal;
    jp_patrol_enter(patrol, JP_PATROL_GLIDING, JP_PATROL_NONE);
    jp_patrol_glide(patrol);
}

/* ---- Choice ---- */

/* The part of an angle that a glide can take, with its sign. */
static float askew_part(const struct jp_patrol_config *config, float angle)
{
    const float most = jp_patrol_askew_max(config);

    return jp_plane_clamp(angle, -most, most);
}

/* From a speed until it stands a distance farther on, as fast as it can, s. */
static float time_to_stop(const struct jp_patrol *patrol, float speed, float away)
{
    const float acceleration = patrol->config.teb.acceleration;
    const float ramps = away * acceleration + 0.5f * speed * speed;
    const float peak = smaller(jp_plane_square_root(ramps), larger(patrol->config.teb.speed_max, speed));

    /* Nearer than it takes to brake: as if it braked harder, over the whole distance. */
    return peak < speed ? 2.0f * away / speed
                        : (2.0f * peak - speed) / acceleration + (ramps - peak * peak) / (acceleration * peak);
}

/* The most that a glide into the goal may turn: what the robot has time for while it drives in. Where a turn in place
 * is saved altogether, it may also take as long as that. */
static float turn_in_time(const struct jp_patrol *patrol, float seconds, bool is_whole)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const float ramps = config->turn_rate / config->turn_acceleration;

    return config->turn_rate *
           (is_whole ? seconds + jp_patrol_in_place(config) / config->steering_rate : seconds - ramps);
}

/* The glide into the goal, if it is near enough: from a pose, along a direction, at a speed. */
static bool leads_in(const struct jp_patrol *patrol, const struct jp_patrol_window *window, float direction,
                     float speed, struct glide *glide)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const struct jp_patrol_goal *const goal = &patrol->internal.goal;
    const float away = goal_distance(patrol, &glide->pose);
    const float whole = jp_plane_wrap(goal->pose.heading - direction);
    const float turned = askew_part(config, whole);
    const bool is_whole = jp_plane_magnitude(whole - turned) < config->heading_tolerance;
    const float turn = jp_plane_wrap(direction + turned - glide->pose.heading);
    const float seconds = time_to_stop(patrol, speed, away);
    const float most = smaller(away / IN_PER_RADIAN_LEAST, turn_in_time(patrol, seconds, is_whole));
    const float due =
        seconds - DUE - jp_plane_magnitude(turn) / config->turn_rate - config->turn_rate / config->turn_acceleration;

    glide->heading = jp_plane_wrap(glide->pose.heading + jp_plane_clamp(turn, -most, most));
    glide->is_to_goal = window->is_goal && !goal->is_heading_free && most > ALONG && due < 0.0f;
    return glide->is_to_goal;
}

float jp_patrol_set_off_rest(const struct jp_patrol_config *config, float angle, float part)
{
    const float rest = jp_plane_magnitude(angle - part);

    return rest < jp_plane_larger(config->heading_tolerance, JP_PATROL_ROUGHLY) ? 0.0f : rest;
}

static float set_off_price(const struct jp_patrol_config *config, float angle, float part)
{
    const float first = jp_patrol_set_off_rest(config, angle, part);

    return jp_patrol_turn_price(config, first) +
           jp_patrol_steering_price(config, jp_plane_magnitude(part), first > 0.0f);
}

/* All that it can, or as much as the wheels stand askew after a turn in place. */
float jp_patrol_set_off_part(const struct jp_patrol_config *config, float angle)
{
    const float in_place = jp_patrol_in_place(config);
    const float most = askew_part(config, angle);
    const float alike = jp_plane_clamp(most, -in_place, in_place);
    const float part = set_off_price(config, angle, alike) < set_off_price(config, angle, most) ? alike : most;

    return set_off_price(config, angle, part) < set_off_price(config, angle, 0.0f) ? part : 0.0f;
}

float jp_patrol_set_off_length(float part)
{
    return IN_PER_RADIAN * jp_plane_magnitude(part);
}

float jp_patrol_glide_in_part(const struct jp_patrol_config *config, float angle, float length)
{
    const float most = smaller(jp_patrol_askew_max(config), larger(length, 0.0f) / IN_PER_RADIAN_LEAST);

    return jp_plane_clamp(angle, -most, most);
}

bool jp_patrol_set_off(struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const float askew = jp_plane_wrap(window->direction - patrol->pose.heading);
    const float part = jp_patrol_set_off_part(config, askew);
    struct glide glide = glide_from(patrol, &patrol->pose);

    if (config->strategy != (uint8_t)JP_PATROL_BY_COST || !(jp_plane_magnitude(part) > 0.0f)) {
        return false;
    }
    glide.pose.heading = jp_plane_wrap(window->direction - part);
    (void)leads_in(patrol, window, window->direction, patrol->config.teb.speed_max, &glide);
    if (!is_free(patrol, &glide)) {
        return false;
    }
    if (jp_patrol_set_off_rest(config, askew, part) > 0.0f) {
        jp_patrol_turn_to(patrol, glide.pose.heading);
    } else {
        glide.pose.heading = patrol->pose.heading;
        begin(patrol, &glide, true);
    }
    return true;
}

/* As it turns it comes to a stand within twice the tolerance of the goal: so much is kept there, m, but where it could
 * not turn in place there instead. */
static float end_clearance(const struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const struct jp_plane_pose *const goal = &patrol->internal.goal.pose;
    const struct jp_plane_pose end = {goal->x, goal->y, window->direction};
    float turn;

    return jp_patrol_find_turn(patrol, &end, goal->heading, config->turn_clearance, &turn)
               ? smaller(2.0f * config->position_tolerance, config->glide_clearance)
               : CLEARANCE_MIN;
}

bool jp_patrol_glide_in(struct jp_patrol *patrol, const struct jp_patrol_window *window)
{
    struct glide glide = glide_from(patrol, &patrol->pose);

    if (!patrol->config.turns_in_place || patrol->config.strategy != (uint8_t)JP_PATROL_BY_COST ||
        !leads_in(patrol, window, window->direction,
                  jp_plane_length(patrol->internal.command.forward, patrol->internal.sideways), &glide)) {
        return false;
    }
    const struct jp_plane_pose end = {patrol->internal.goal.pose.x, patrol->internal.goal.pose.y, glide.heading};

    const float at_end = jp_patrol_clearance(patrol, &end) - JP_PATROL_CLEARANCE_NOISE;
    float rest;

    glide.clearance = smaller(glide.clearance, at_end);
    if (at_end < end_clearance(patrol, window) || !is_free(patrol, &glide) ||
        !jp_patrol_find_turn(patrol, &end, patrol->internal.goal.pose.heading, CLEARANCE_MIN, &rest)) {
        return false;
    }
    begin(patrol, &glide, false);
    return true;
}

bool jp_patrol_can_glide_in(const struct jp_patrol *patrol)
{
    uint16_t i = (uint16_t)(patrol->internal.path_count - 1U);
    struct jp_plane_pose at = patrol->internal.goal.pose;
    struct glide glide = glide_from(patrol, &patrol->pose);

    if (patrol->config.strategy != (uint8_t)JP_PATROL_BY_COST) {
        return false;
    }
    while (i > patrol->internal.path_next && goal_distance(patrol, &at) < IN_DISTANCE + IN_PER_RADIAN) {
        const struct jp_plane_point point = point_at(patrol, --i);

        at.x = point.x;
        at.y = point.y;
    }
    glide.next = i;
    at.heading = direction_from(patrol, &at, &glide.next);
    glide.pose = at;
    glide.clearance = patrol->config.glide_clearance;
    glide.heading = patrol->internal.goal.pose.heading;
    glide.is_to_goal = true;

    const float turn = jp_plane_magnitude(jp_plane_wrap(glide.heading - at.heading));

    return turn < jp_patrol_askew_max(&patrol->config) && IN_PER_RADIAN_LEAST * turn <= goal_distance(patrol, &at) &&
           is_free(patrol, &glide);
}

/* ---- A cycle ---- */

/* As the robot turns on its way its outer wheels go faster than it does, and slow down faster: above 0, m/s². */
static float gentle_braking(const struct jp_patrol *patrol, float speed, float turn_rate)
{
    const struct jp_patrol_config *const config = &patrol->config;

    return config->teb.acceleration / config->people.braking * jp_patrol_braking(config, speed, turn_rate);
}

/* The turn that is left may go on as it does now, or must be faster. */
static float stopping_speed(const struct jp_patrol *patrol, float now, float away, float turn)
{
    const float by_now = gentle_braking(patrol, larger(now, SET_OFF_SPEED), patrol->internal.command.turn_rate);
    const float by_way = gentle_braking(patrol, away, turn);

    return jp_patrol_stopping_speed(&patrol->config, smaller(by_now, by_way), away);
}

/* Fastest now, so that the robot can stop at the goal, and come to it turned. */
static float speed_of(const struct jp_patrol *patrol, float now, float away, float remaining)
{
    const struct jp_patrol_config *const config = &patrol->config;
    const float turn = patrol->internal.is_gliding_to_goal ? jp_plane_magnitude(remaining) : 0.0f;
    const float rising = now + config->teb.acceleration * config->period;
    const float turning = turn > ALONG ? config->turn_rate * away / turn : config->teb.speed_max;

    return smaller(smaller(rising, stopping_speed(patrol, now, away, turn)), smaller(config->teb.speed_max, turning));
}

/* Where the robot will be when the wheels do what is asked of them now. */
static struct jp_plane_pose after_latency(const struct jp_patrol *patrol)
{
    const float latency = patrol->config.latency;
    const struct jp_plane_pose way = {latency * patrol->internal.command.forward, latency * patrol->internal.sideways,
                                      latency * patrol->internal.command.turn_rate};

    return jp_plane_compose(&patrol->pose, &way);
}

/* From now until the robot slows down, s: what is decided in the next cycle acts after the latency, and the wheels
 * lag behind. */
static float delay(const struct jp_patrol *patrol)
{
    return patrol->config.latency + 2.0f * patrol->config.period;
}

/* Whether the wheels are still steered for the glide, at a stand. */
static bool is_setting_off(const struct jp_patrol *patrol)
{
    const struct jp_plane_point *const from = &patrol->internal.step_target;

    return patrol->internal.is_setting_off &&
           jp_plane_length(patrol->pose.x - from->x, patrol->pose.y - from->y) < SET_OFF_DISTANCE;
}

/* Velocity of the chassis in its own frame. */
struct chassis_motion {
    float forward;
    float left;
    float turn_rate;
};

static struct chassis_motion commanded(const struct jp_patrol *patrol)
{
    return (struct chassis_motion){patrol->internal.command.forward, patrol->internal.sideways,
                                   patrol->internal.command.turn_rate};
}

static struct chassis_motion between(const struct chassis_motion *from, const struct chassis_motion *to, float share)
{
    return (struct chassis_motion){from->forward + share * (to->forward - from->forward),
                                   from->left + share * (to->left - from->left),
                                   from->turn_rate + share * (to->turn_rate - from->turn_rate)};
}

/* Velocity of a wheel's contact. */
static struct jp_plane_point contact(const struct jp_patrol *patrol, const struct chassis_motion *motion,
                                     unsigned wheel)
{
    const float x = (wheel < (unsigned)JP_REAR_LEFT ? 0.5f : -0.5f) * (float)patrol->config.wheels.wheelbase * Q24;
    const float y = (wheel % 2U == 0U ? 0.5f : -0.5f) * (float)patrol->config.wheels.track * Q24;

    return (struct jp_plane_point){motion->forward - motion->turn_rate * y, motion->left + motion->turn_rate * x};
}

/* Whether no wheel is asked to turn so far at once that it would have to stop for it. */
static bool can_steer(const struct jp_patrol *patrol, const struct chassis_motion *from,
                      const struct chassis_motion *to)
{
    for (unsigned wheel = 0; wheel < (unsigned)JP_WHEELS; wheel++) {
        const struct jp_plane_point a = contact(patrol, from, wheel);
        const struct jp_plane_point b = contact(patrol, to, wheel);

        if (jp_plane_magnitude(a.x * b.y - a.y * b.x) > STEERED_MAX * (a.x * b.x + a.y * b.y)) {
            return false;
        }
    }
    return true;
}

static struct chassis_motion slowed(const struct chassis_motion *motion, float speed)
{
    const float now = jp_plane_length(motion->forward, motion->left);
    const float share = now > speed ? speed / now : 1.0f;

    return (struct chassis_motion){share * motion->forward, share * motion->left, share * motion->turn_rate};
}

/* As near to a motion as the wheels can follow in a cycle; at a stand they are steered first. Slower needs no steering.
 */
static struct chassis_motion steered(const struct jp_patrol *patrol, const struct chassis_motion *wanted)
{
    const struct chassis_motion before = commanded(patrol);
    const struct chassis_motion now = slowed(&before, jp_plane_length(wanted->forward, wanted->left));
    struct chassis_motion next = *wanted;
    float share = 1.0f;

    while (share > SHARE_MIN && !can_steer(patrol, &now, &next)) {
        share *= 0.5f;
        next = between(&now, wanted, share);
    }
    return next;
}

/* Above 0, m/s². */
static float braking_of(const struct jp_patrol *patrol, float speed, float turn_rate)
{
    return smaller(jp_patrol_braking(&patrol->config, speed, turn_rate), patrol->config.teb.acceleration);
}

/* What the robot keeps as it stops from a motion, its wheels at the angles that they have then, m. */
static float stop_clearance(const struct jp_patrol *patrol, const struct chassis_motion *motion)
{
    const float speed = jp_plane_length(motion->forward, motion->left);
    const float braking = speed > 0.0f ? 0.5f * speed / braking_of(patrol, speed, motion->turn_rate) : 0.0f;
    const float seconds = braking + delay(patrol);
    const unsigned steps = (unsigned)(seconds * speed / STEP_LENGTH) + 1U;
    const float step = seconds / (float)steps;
    const struct jp_plane_pose part = {step * motion->forward, step * motion->left, step * motion->turn_rate};
    struct jp_plane_pose pose = patrol->pose;
    float least = JP_OBSTACLE_NONE;

    for (unsigned i = 1; i <= steps; i++) {
        pose = jp_plane_compose(&pose, &part);
        least = smaller(least, jp_patrol_clearance_later(patrol, &pose, 2.0f * step * (float)i));
    }
    return least;
}

/* Along the glide at a speed, as far as the wheels follow. */
static struct chassis_motion motion_at(const struct jp_patrol *patrol, const struct glide *glide, float direction,
                                       float speed)
{
    const float askew = jp_plane_wrap(direction - glide->pose.heading);
    const float away = goal_distance(patrol, &glide->pose);
    const float remaining = glide->is_to_goal ? jp_plane_wrap(glide->heading - glide->pose.heading) : askew;
    const float early =
        EARLIER * jp_plane_magnitude(remaining) * speed / larger(away, patrol->config.position_tolerance);
    const float stopping =
        jp_patrol_stopping_speed(&patrol->config, patrol->config.turn_acceleration, jp_plane_magnitude(remaining));
    const float due = glide->is_to_goal ? smaller(early, stopping) : stopping;
    const float most = smaller(due, smaller(speed * turn_per_metre(patrol, askew), patrol->config.turn_rate));
    const float change = patrol->config.turn_acceleration * patrol->config.period;
    const float before = patrol->internal.command.turn_rate;
    const struct chassis_motion wanted = {
        speed * jp_plane_cosine(askew), speed * jp_plane_sine(askew),
        jp_plane_clamp(remaining < 0.0f ? -most : most, before - change, before + change)};

    return steered(patrol, &wanted);
}

/* A glide along the path that has its direction leads no farther. */
static bool is_at_end(const struct glide *glide, float direction)
{
    return !glide->is_to_goal && jp_plane_magnitude(jp_plane_wrap(direction - glide->pose.heading)) < ALONG;
}

/* As fast as is wanted where the robot can stop from there. Else it brakes along the glide, where that keeps more than
 * to brake with its wheels as they are: false where it does not. */
static bool move(struct jp_patrol *patrol, const struct glide *glide, float direction, float wanted)
{
    const float now = jp_plane_length(patrol->internal.command.forward, patrol->internal.sideways);
    const float stop = now * (0.5f * now / patrol->config.teb.acceleration + delay(patrol));
    const unsigned least = (unsigned)(stop / STEP_LENGTH) + 1U;
    const unsigned ahead = least + 2U;
    struct chassis_motion next = motion_at(patrol, glide, direction, wanted);

    if (free_steps(patrol, *glide, ahead) < ahead || stop_clearance(patrol, &next) < 0.5f * glide->clearance) {
        const float slower = now - patrol->config.teb.acceleration * patrol->config.period;
        const struct chassis_motion as_now = commanded(patrol);
        struct glide braked = *glide;

        braked.clearance = smaller(glide->clearance, larger(stop_clearance(patrol, &as_now), 0.0f));
        next = motion_at(patrol, glide, direction, larger(slower, 0.0f));
        if (slower <= 0.0f || free_steps(patrol, braked, least) < least ||
            (is_at_end(glide, direction) && stop_clearance(patrol, &next) < 0.0f)) {
            return false;
        }
    }
    patrol->internal.command = (struct jp_plane_speed){next.forward, next.turn_rate};
    patrol->internal.sideways = next.left;
    return true;
}

/* No farther askew than all wheels are steered forwards: one that rolled backwards, as it may after a turn in place,
 * would have to be steered round on the way. */
static void set_off_along(struct jp_patrol *patrol, float askew)
{
    const float part = askew_part(&patrol->config, askew);

    patrol->internal.command = (struct jp_plane_speed){SET_OFF_SPEED * jp_plane_cosine(part), 0.0f};
    patrol->internal.sideways = SET_OFF_SPEED * jp_plane_sine(part);
}

void jp_patrol_glide(struct jp_patrol *patrol)
{
    const struct jp_plane_pose pose = after_latency(patrol);
    const float now = jp_plane_length(patrol->internal.command.forward, patrol->internal.sideways);
    struct glide glide = glide_from(patrol, &pose);
    uint16_t next;

    if (jp_patrol_advance(patrol)) {
        patrol->internal.unmoved = 0;
        patrol->internal.tries = 0;
    }
    next = patrol->internal.path_next;

    const float direction = direction_from(patrol, &pose, &next);
    const float askew = jp_plane_wrap(direction - pose.heading);
    const float away = goal_distance(patrol, &patrol->pose);
    const float remaining = jp_plane_wrap(glide.heading - pose.heading);

    if (3.0f * away < patrol->config.position_tolerance ||
        (!glide.is_to_goal && jp_plane_magnitude(askew) < ALONG &&
         jp_plane_magnitude(patrol->internal.command.turn_rate) * arm_of(patrol) <= 0.5f * STEERED_MAX * now)) {
        jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
        patrol->internal.command.forward = now;
        return;
    }
    if (jp_plane_magnitude(askew) > askew_limit(&patrol->config) + STEERING_MARGIN) {
        jp_patrol_stand(patrol);
        jp_patrol_enter(patrol, JP_PATROL_DRIVING, JP_PATROL_NONE);
        return;
    }
    if (is_setting_off(patrol)) {
        set_off_along(patrol, askew);
        return;
    }
    if (!move(patrol, &glide, direction, speed_of(patrol, now, away, remaining))) {
        jp_patrol_wait(patrol, JP_PATROL_BLOCKED);
    }
}
