#include <joulepath/patrol_forecast.h>
#include <stddef.h>

#include "src/base/integer.h"
#include "src/base/plane.h"
#include "src/local/patrol_glide.h"
#include "src/local/patrol_path.h"
#include "src/local/patrol_price.h"

/* Shorter pieces of a path have no direction, m. */
#define SHORT 0.005f

/* A path that is longer than from its start to the goal by this is not straight. */
#define STRAIGHT 1.01f

/* The path this far ahead gives the direction to set off in, m. */
#define AHEAD 0.5f

/* Legs that the prior counts as, and after which one counts 1/e; what a first leg may miss. */
#define PRIOR_LEGS  1.0f
#define MEMORY      8.0f
#define FIRST_ERROR 0.2f

/* A leg that is farther from its forecast than so many deviations counts as if it were so far: somebody was in the
 * way. */
#define GATE 2.0f

/* Of what a plan takes, whatever is learned of the robot. */
#define RATIO_MIN 0.25f

#define TURN_PER_UNIT (2.0f * JP_PLANE_PI / 4294967296.0f)

/* A leg that is summed up. */
struct planned_leg {
    const struct jp_patrol_config *config;
    const struct jp_four_wheel_energy_model *model;
    const struct jp_patrol_plan *plan;
    struct jp_four_wheel_drive drive;
    float duration;
    float length;    /* of the path, m */
    float room;      /* of it, where it may glide into the goal, m */
    float speed;     /* now */
    float askew;     /* angle of the wheels from straight on as it stands, all alike, rad */
    bool has_turned; /* in place: they stand as for that */
    jp_q24 grade;    /* of the piece that is driven */
};

static float smaller(float a, float b)
{
    return a < b ? a : b;
}

static jp_q24 to_q24(float value)
{
    return (jp_q24)(jp_plane_clamp(value, -8.0f, 8.0f) * (float)JP_Q24_ONE);
}

static jp_q16 to_q16(float value)
{
    const float scaled = smaller(value, 255.0f) * (float)JP_Q16_ONE;

    return (jp_q16)scaled;
}

static void add(struct planned_leg *leg, float start, float end, float turn_rate, float travel, float seconds)
{
    const struct jp_four_wheel_piece piece = {
        .start = {to_q24(start), 0, to_q24(turn_rate)},
        .end = {to_q24(end), 0, to_q24(turn_rate)},
        .grade = leg->grade,
        .travel = to_q16(travel),
        .duration = to_q16(seconds),
    };

    if (jp_four_wheel_energy_add(leg->model, &leg->drive, &piece) == JP_OK) {
        leg->duration += seconds;
    }
}

static void stand(struct planned_leg *leg, float seconds)
{
    add(leg, 0.0f, 0.0f, 0.0f, 0.0f, seconds);
}

/* The wheels at a stand: by an angle on the mean, and that which goes farthest. */
static void steer(struct planned_leg *leg, float mean, float farthest)
{
    const float rate = (float)leg->config->wheels.steering_step * TURN_PER_UNIT * (float)leg->plan->tick_rate;

    add(leg, 0.0f, 0.0f, 0.0f, (float)JP_WHEELS * mean, farthest / rate);
}

/* To a way that is askew. For a turn in place half of the wheels stand to one side, half to the other. */
static void steer_askew(struct planned_leg *leg, float askew)
{
    const float in_place = leg->has_turned ? jp_patrol_in_place(leg->config) : 0.0f;

    steer(leg, jp_plane_larger(askew, in_place), askew + in_place);
    leg->has_turned = false;
}

/* In place by an angle of 0 or more, at its mean rate: what is asked acts after the latency, and is seen to have come
 * to its end a cycle later. */
static void turn(struct planned_leg *leg, float angle)
{
    const struct jp_patrol_config *const config = leg->config;
    const float in_place = jp_patrol_in_place(config);
    const float seconds = jp_patrol_turn_seconds(config, angle);

    if (angle > 0.0f) {
        steer(leg, jp_plane_larger(leg->askew, in_place), leg->askew + in_place);
        add(leg, 0.0f, 0.0f, angle / seconds, 0.0f, seconds);
        stand(leg, config->latency + config->period);
        leg->has_turned = true;
    }
}

static bool glides(const struct planned_leg *leg)
{
    return leg->config->strategy == (uint8_t)JP_PATROL_BY_COST;
}

static struct jp_plane_point point_of(const struct jp_patrol_plan *plan, unsigned i)
{
    return jp_patrol_path_point(&plan->path[i]);
}

static float direction_ahead(const struct jp_patrol_plan *plan)
{
    const struct jp_plane_point start = point_of(plan, 0);
    uint16_t i = 1;

    while (i + 1U < plan->path_count &&
           jp_plane_length(point_of(plan, i).x - start.x, point_of(plan, i).y - start.y) < AHEAD) {
        i++;
    }
    return jp_plane_bearing(point_of(plan, i).x - start.x, point_of(plan, i).y - start.y);
}

static float path_length(const struct jp_patrol_plan *plan)
{
    float length = 0.0f;

    for (uint16_t i = 1; i < plan->path_count; i++) {
        length += jp_plane_length(point_of(plan, i).x - point_of(plan, i - 1U).x,
                                  point_of(plan, i).y - point_of(plan, i - 1U).y);
    }
    return length;
}

static void set_off(struct planned_leg *leg)
{
    const struct jp_patrol_plan *const plan = leg->plan;
    const float off = jp_plane_magnitude(jp_plane_wrap(direction_ahead(plan) - plan->start.heading));

    if (leg->config->turns_in_place && off > leg->config->turn_first) {
        const float part = glides(leg) ? jp_patrol_set_off_part(leg->config, off) : 0.0f;

        turn(leg, jp_patrol_set_off_rest(leg->config, off, part));
        steer_askew(leg, part);
        leg->room -= jp_patrol_set_off_length(part);
    }
}

/* Part of a piece in which the speed changes evenly. `bend`: its turn by the metre. */
static void drive_part(struct planned_leg *leg, float start, float end, float length, float bend)
{
    const float mean = 0.5f * (start + end);

    if (length > 0.0f) {
        add(leg, start, end, bend * mean, 0.0f, length / mean);
    }
}

/* From one point to another, with a length between them. */
static jp_q24 grade_between(const struct planned_leg *leg, struct jp_plane_point from, struct jp_plane_point to,
                            float length)
{
    const struct jp_terrain *const ground = leg->plan->ground;

    if (ground == NULL) {
        return 0;
    }
    const struct jp_point start = {(jp_q16)(from.x * (float)JP_Q16_ONE), (jp_q16)(from.y * (float)JP_Q16_ONE)};
    const struct jp_point end = {(jp_q16)(to.x * (float)JP_Q16_ONE), (jp_q16)(to.y * (float)JP_Q16_ONE)};
    const float rise = (float)(jp_terrain_height(ground, &end) - jp_terrain_height(ground, &start));

    return to_q24(jp_plane_clamp(rise / ((float)JP_Q16_ONE * length), -1.0f, 1.0f));
}

/* A piece of the path by its length, its turn and what is left after it: the robot speeds up to what the piece lets it,
 * and slows down for what comes. */
static void drive_piece(struct planned_leg *leg, float length, float turned, float left)
{
    const struct jp_teb_config *const teb = &leg->config->teb;
    const float doubled = 2.0f * teb->acceleration;
    const float bend = turned / length;
    const float sharp = jp_plane_magnitude(bend);
    const float bent = sharp > teb->turn_rate_max / teb->speed_max ? teb->turn_rate_max / sharp : teb->speed_max;
    const float now = leg->speed * leg->speed;
    const float risen = jp_plane_square_root(now + doubled * length);
    const float stopping = jp_plane_square_root(doubled * left);
    const float next = smaller(smaller(risen, stopping), bent);
    const float peak = jp_plane_square_root(0.5f * (doubled * length + now + next * next));
    const float top = smaller(jp_plane_larger(bent, leg->speed), peak);
    const float rise = (top * top - now) / doubled;
    const float fall = (top * top - next * next) / doubled;

    if (rise < 0.0f) { /* it comes faster than it could slow down from within the piece */
        drive_part(leg, leg->speed, next, length, bend);
    } else {
        drive_part(leg, leg->speed, top, rise, bend);
        drive_part(leg, top, top, length - rise - fall, bend);
        drive_part(leg, top, next, fall, bend);
    }
    leg->speed = next;
}

/* At a stand: what is asked of the wheels acts after the latency, and once a period. So the robot stands as it sets
 * off, and creeps as long before it stops. */
static void set_going(struct planned_leg *leg)
{
    stand(leg, 2.0f * leg->config->latency + leg->config->period);
}

/* Direction of the path at its end. */
static float drive(struct planned_leg *leg)
{
    const struct jp_patrol_plan *const plan = leg->plan;
    float left = leg->length;
    float heading = direction_ahead(plan);
    struct jp_plane_point from = point_of(plan, 0);

    set_going(leg);
    for (uint16_t i = 1; i < plan->path_count; i++) {
        const struct jp_plane_point to = point_of(plan, i);
        const float length = jp_plane_length(to.x - from.x, to.y - from.y);

        if (length > SHORT) {
            const float direction = jp_plane_bearing(to.x - from.x, to.y - from.y);

            left -= length;
            leg->grade = grade_between(leg, from, to, length);
            drive_piece(leg, length, i > 1U ? jp_plane_wrap(direction - heading) : 0.0f, left > 0.0f ? left : 0.0f);
            heading = direction;
            from = to;
        }
    }
    leg->grade = 0;
    return heading;
}

/* From a heading at the goal, with the wheels askew. */
static void turn_to_goal(struct planned_leg *leg, float heading, bool glides_in)
{
    const struct jp_patrol_goal *const goal = &leg->plan->goal;

    if (!goal->is_heading_free && leg->config->turns_in_place) {
        const float off = jp_plane_magnitude(jp_plane_wrap(goal->pose.heading - heading));
        const float glided = glides_in ? jp_patrol_glide_in_part(leg->config, off, leg->room) : 0.0f;

        leg->askew += glided;
        turn(leg, off - glided > leg->config->heading_tolerance ? off - glided : 0.0f);
    }
}

/* Where it has no room to turn at the goal, its path ends before it: it has turned there, and drives straight in. */
static void drive_in(struct planned_leg *leg)
{
    const struct jp_patrol_plan *const plan = leg->plan;
    const struct jp_plane_point end = point_of(plan, plan->path_count - 1U);
    const float away = jp_plane_length(plan->goal.pose.x - end.x, plan->goal.pose.y - end.y);

    if (away > leg->config->position_tolerance) {
        const struct jp_plane_point goal = {plan->goal.pose.x, plan->goal.pose.y};

        leg->speed = 0.0f;
        steer_askew(leg, 0.0f);
        set_going(leg);
        leg->grade = grade_between(leg, end, goal, away);
        drive_piece(leg, away, 0.0f, 0.0f);
    }
}

/* Whether the robot steps to its goal, with the heading that it has: straight on, as the path is. */
static bool steps(const struct planned_leg *leg, struct jp_patrol_near_goal *way)
{
    const struct jp_patrol_plan *const plan = leg->plan;
    const struct jp_plane_point start = point_of(plan, 0);
    const struct jp_plane_point end = point_of(plan, plan->path_count - 1U);
    const float direction = direction_ahead(plan);
    const float then = jp_plane_magnitude(jp_plane_wrap(plan->goal.pose.heading - direction));
    const float error = jp_plane_magnitude(jp_plane_wrap(plan->goal.pose.heading - plan->start.heading));

    *way =
        (struct jp_patrol_near_goal){.away = jp_plane_length(plan->goal.pose.x - start.x, plan->goal.pose.y - start.y),
                                     .first = jp_plane_magnitude(jp_plane_wrap(direction - plan->start.heading)),
                                     .then = plan->goal.is_heading_free ? 0.0f : then,
                                     .error = plan->goal.is_heading_free ? 0.0f : error};
    return glides(leg) && leg->config->turns_in_place && way->first > leg->config->turn_first &&
           jp_plane_length(plan->goal.pose.x - end.x, plan->goal.pose.y - end.y) < leg->config->position_tolerance &&
           leg->length < STRAIGHT * way->away && jp_patrol_is_step_cheapest(leg->config, way);
}

/* A wheel that points backwards rolls backwards. */
static void step(struct planned_leg *leg, const struct jp_patrol_near_goal *way)
{
    const float speed = leg->config->step_speed;

    leg->askew = smaller(way->first, JP_PLANE_PI - way->first);
    steer_askew(leg, leg->askew);
    set_going(leg);
    drive_part(leg, speed, speed, leg->length, 0.0f);
    turn_to_goal(leg, leg->plan->start.heading, false);
}

/* Whoever stands at the end of the path has only to turn. */
static void stay(struct planned_leg *leg)
{
    turn_to_goal(leg, leg->plan->start.heading, false);
    drive_in(leg);
}

static void set_off_and_drive(struct planned_leg *leg)
{
    set_off(leg);
    turn_to_goal(leg, drive(leg), glides(leg));
    drive_in(leg);
}

enum jp_status jp_patrol_plan_energy(const struct jp_patrol_config *config,
                                     const struct jp_four_wheel_energy_model *model, const struct jp_patrol_plan *plan,
                                     struct jp_four_wheel_drive *drive_sum, float *duration)
{
    if (config == NULL || model == NULL || plan == NULL || drive_sum == NULL || duration == NULL ||
        plan->path == NULL || plan->path_count < 2U || plan->tick_rate == 0U) {
        return JP_ERR_ARGUMENT;
    }
    struct planned_leg leg = {
        .config = config, .model = model, .plan = plan, .drive = *drive_sum, .length = path_length(plan)};
    struct jp_patrol_near_goal way;

    leg.room = leg.length;

    if (leg.length < config->position_tolerance) {
        stay(&leg);
    } else if (steps(&leg, &way)) {
        step(&leg, &way);
    } else {
        set_off_and_drive(&leg);
    }
    *drive_sum = leg.drive;
    *duration += leg.duration;
    return JP_OK;
}

float jp_patrol_plan_ratio(const struct jp_four_wheel_drive *plan, const jp_q16 before[JP_FOUR_WHEEL_FACTORS],
                           const jp_q16 after[JP_FOUR_WHEEL_FACTORS])
{
    const float energy = (float)jp_saturate32(plan->energy);
    float more = 0.0f;

    for (unsigned i = 0; i < (unsigned)JP_FOUR_WHEEL_FACTORS; i++) {
        more += (float)jp_saturate32(plan->change[i]) * ((float)after[i] / (float)before[i] - 1.0f);
    }
    return energy > 0.0f ? jp_plane_larger(1.0f + more / energy, RATIO_MIN) : 1.0f;
}

/* ---- Pace ---- */

float jp_patrol_pace_factor(const struct jp_patrol_pace *pace, float prior)
{
    const float legs = smaller((float)pace->legs, MEMORY);

    if (pace->legs == 0U) {
        return prior;
    }
    return (pace->driven / pace->planned * legs + PRIOR_LEGS * prior) / (legs + PRIOR_LEGS);
}

float jp_patrol_pace_deviation(const struct jp_patrol_pace *pace)
{
    const float legs = smaller((float)pace->legs, MEMORY);

    return jp_plane_square_root((pace->square * legs + PRIOR_LEGS * FIRST_ERROR * FIRST_ERROR) / (legs + PRIOR_LEGS));
}

void jp_patrol_pace_learn(struct jp_patrol_pace *pace, float prior, float planned, float driven)
{
    const float expected = planned * jp_patrol_pace_factor(pace, prior);
    const float most = GATE * jp_patrol_pace_deviation(pace);
    const float missed = jp_plane_clamp(driven / expected - 1.0f, -most, most);
    const float legs = smaller((float)pace->legs, MEMORY - 1.0f);
    const float kept = 1.0f - 1.0f / MEMORY;

    pace->square += (missed * missed - pace->square) / (legs + 1.0f);
    pace->planned = kept * pace->planned + planned;
    pace->driven = kept * pace->driven + expected * (1.0f + missed);
    pace->legs = pace->legs < UINT32_MAX ? pace->legs + 1U : pace->legs;
}
